//! pbrt-v4's stochastic layers [PBRT4, §14.3], the reference for what its files mean: f of two directions, estimated by a
//! walk between interface and base. It follows the light along `wo` into the layer, and connects each event with light
//! along `wi` that was refracted there once. pbrt-v4 takes the interface's own density as a second strategy, and weighs
//! both; the expectation is that of the first alone, wherever the base is no mirror.
//!
//! The closed forms are one function of both directions, so they are compared direction by direction, where
//! [`simulation`](super::simulation) has the sum over all.

use super::direction;
use super::layers::{VARNISH, average};
use super::simulation::{
    Base, Light, Stack, fresnel, henyey_greenstein, henyey_greenstein_value, pair, unshadowed,
};
use crate::bsdf::TransportMode;
use crate::math::{Vec3, warp};
use crate::sampler::{Dimension, Purpose, SampleStream};
use crate::testing::{Battery, means, samples};
use glam::DVec3;
use std::f64::consts::PI;

/// Events after which no walk here has light left.
const ENDLESS: usize = 400;
/// pbrt-v4's `maxdepth`, unless a file says otherwise.
const DEFAULT: usize = 10;
/// Sets of walks for each pair of directions, and walks of a set.
const WALKS: [u64; 2] = [64, 1 << 11];
/// The relative error that the closed form may have.
const TOLERANCE: f64 = 0.01;

impl Stack {
    /// Returns an estimate of f for light along `wi` seen along `wo`, by a walk of at most `most` events.
    fn layered(&self, pair: [DVec3; 2], most: usize, stream: &SampleStream) -> f64 {
        self.interface_value(pair[0], pair[1]) + self.within(pair, most, stream)
    }

    /// Returns the part of f that enters the layer.
    fn within(&self, [wo, wi]: [DVec3; 2], most: usize, stream: &SampleStream) -> f64 {
        let at = |purpose| pair(stream, 0, purpose);
        let (_, seen) = self.interface(wo, self.eta, at(Purpose::Lens));
        let (_, lit) = self.interface(wi, self.eta, at(Purpose::LightDirection));
        let (Some((w, part)), Some(lit)) = (seen, lit) else {
            return 0.0;
        };
        let mut light = Light {
            w,
            part: part / (self.eta * self.eta),
            height: self.thickness,
        };
        let mut within = 0.0;
        for event in 1..=most {
            let u = stream.get_1d(Dimension::at(event, Purpose::Roulette));
            let Some(survivor) = light.roulette(u) else {
                break;
            };
            let (seen, next) = self.layer_event(survivor, lit, pairs(stream, event));
            within += seen;
            let Some(next) = next else {
                break;
            };
            light = next;
        }
        within
    }

    /// What the next event of `light` shows of the light that comes down along `lit`, and how the walk goes on.
    fn layer_event(
        &self,
        light: Light,
        (down, lit): (DVec3, f64),
        [u_flight, u]: [[f64; 2]; 2],
    ) -> (f64, Option<Light>) {
        let Light { w, part, height } = light;
        let way = if w.z > 0.0 {
            self.thickness - height
        } else {
            height
        };
        let left = |way: f64, w: DVec3| libm::exp(-way / w.z.abs());
        let mut part = part;
        if self.albedo > 0.0 {
            let flight = -libm::log(1.0 - u_flight[0]) * w.z.abs();
            if flight < way {
                let height = height + flight.copysign(w.z);
                let part = part * self.albedo;
                let phase = henyey_greenstein_value(w.dot(-down), self.g);
                let seen = part * phase * lit / down.z.abs() * left(self.thickness - height, down);
                let w = henyey_greenstein(w, self.g, u);
                return (seen, Some(Light { w, part, height }));
            }
        } else {
            part *= left(way, w);
        }
        if w.z < 0.0 {
            let seen = part * lit * left(self.thickness, down) * self.base.value();
            let next = self.base.reflect(-w, u).map(|(w, reflectance)| Light {
                w,
                part: part * reflectance,
                height: 0.0,
            });
            return (seen, next);
        }
        let (reflected, _) = self.interface(w, 1.0 / self.eta, u);
        let next = reflected.map(|(w, share)| Light {
            w: -w,
            part: part * share,
            height: self.thickness,
        });
        (0.0, next)
    }

    /// Returns f of the interface's own reflection; zero where it is smooth.
    fn interface_value(&self, wo: DVec3, wi: DVec3) -> f64 {
        if self.alpha <= 0.0 {
            return 0.0;
        }
        let m = (wo + wi).normalize();
        let a2 = self.alpha * self.alpha;
        let slope = (m.x * m.x + m.y * m.y) / a2 + m.z * m.z;
        let d = 1.0 / (PI * a2 * slope * slope);
        let lambda = |w: DVec3| 1.0 / unshadowed(self.alpha, DVec3::Z, w) - 1.0;
        let g2 = 1.0 / (1.0 + lambda(wo) + lambda(wi));
        fresnel(wo.dot(m), self.eta).0 * d * g2 / (4.0 * wo.z * wi.z)
    }
}

impl Base {
    /// Returns f of the base.
    fn value(self) -> f64 {
        match self {
            Self::Diffuse(reflectance) => reflectance / PI,
            Self::Metal { .. } => unreachable!("metal is compared by its reflectance"),
        }
    }
}

fn pairs(stream: &SampleStream, event: usize) -> [[f64; 2]; 2] {
    [Purpose::Scatter, Purpose::Lens].map(|purpose| pair(stream, event, purpose))
}

/// Returns the pairs of directions: steep, oblique, grazing, and near the mirrored one.
fn directions() -> [[Vec3; 2]; 4] {
    [
        [direction(1.0, 0.0), direction(0.6, 1.0)],
        [direction(0.7, 0.3), direction(0.5, 2.8)],
        [direction(0.15, 0.3), direction(0.8, 1.4)],
        [direction(0.4, 0.0), direction(0.4, 3.0)],
    ]
}

#[test]
fn a_varnish_shows_what_stochastic_layers_of_any_depth_do() {
    let mut battery = Battery::new("f of varnish and of stochastic layers");
    for (eta, alpha, rho, thickness) in [
        (1.5, 0.0, 0.5, 0.01),
        (1.5, 0.0, 0.9, 0.3),
        (1.5, 0.1, 0.5, 0.01),
        (1.5, 0.3, 0.9, 0.01),
        (1.5, 0.3, 0.2, 0.0),
        (1.8, 0.5, 0.8, 0.1),
    ] {
        let stack = Stack {
            eta,
            alpha,
            thickness,
            base: Base::Diffuse(rho),
            ..VARNISH
        };
        let bsdf = stack.bsdf();
        for (i, [wo, wi]) in directions().into_iter().enumerate() {
            let closed = f64::from(bsdf.eval(wo, wi, TransportMode::Radiance).f[0]);
            let case = format!("{}, pair {i}", stack.name());
            let both = [wo, wi].map(Vec3::as_dvec3);
            let walked = means(&case, WALKS, |stream| stack.layered(both, ENDLESS, stream));
            battery.mean_within(&case, walked, closed, TOLERANCE);
        }
    }
    battery.check();
}

/// Returns the reflectance of `stack` over all directions, by f of stochastic layers that end after `most` events.
fn layered_reflectance(stack: &Stack, most: usize) -> f64 {
    let n = 1 << 16;
    let name = stack.name();
    let drawn = samples(&name, n).map(|stream| {
        let get = |purpose| warp::cosine_hemisphere(stream.get_2d(Dimension::at(1000, purpose)));
        let [wo, wi] = [Purpose::Lens, Purpose::Scatter].map(|purpose| get(purpose).as_dvec3());
        if wo.z.min(wi.z) < 1e-6 {
            return 0.0;
        }
        let (reflected, _) = stack.interface(wo, stack.eta, pair(&stream, 1001, Purpose::Lens));
        let part = reflected.map_or(0.0, |(_, part)| part);
        part + PI * stack.within([wo, wi], most, &stream)
    });
    drawn.sum::<f64>() / n as f64
}

/// Where coats are darker than in renderers whose interfaces are clear and let light through as if they were smooth:
/// `thickness` and facets are pbrt-v4's model, and the end of its walks makes it darker than bidir.
#[test]
fn the_darkness_of_coats_is_pbrts_own() {
    for (rho, alpha) in [
        (0.5, 0.0),
        (0.5, 0.1),
        (0.5, 0.3),
        (0.9, 0.0),
        (0.9, 0.1),
        (0.9, 0.3),
    ] {
        let stack = |alpha, thickness| Stack {
            alpha,
            thickness,
            base: Base::Diffuse(rho),
            ..VARNISH
        };
        let closed = |stack: &Stack| average(&stack.bsdf());
        let (clear, deep, own) = (stack(0.0, 0.0), stack(0.0, 0.01), stack(alpha, 0.01));
        let [clear, deep, here] = [clear, deep, own].each_ref().map(closed);
        let [endless, ended] = [ENDLESS, DEFAULT].map(|most| layered_reflectance(&own, most));
        if std::env::var_os("BIDIR_TEST_SHOW").is_some() {
            println!(
                "darkness,{rho},{alpha},{clear:.4},{deep:.4},{here:.4},{endless:.4},{ended:.4}"
            );
        }
        assert!(
            (here / endless - 1.0).abs() < 0.012,
            "{rho} {alpha}: {here} {endless}"
        );
        assert!(ended < endless && deep < clear, "{rho} {alpha}");
    }
}

#[test]
fn a_layer_without_interface_shows_its_base() {
    let stack = Stack {
        eta: 1.0,
        thickness: 0.0,
        ..VARNISH
    };
    let [wo, wi] = directions()[1].map(Vec3::as_dvec3);
    let stream = samples("matched", 1).next().expect("one sample");
    let value = stack.layered([wo, wi], DEFAULT, &stream);
    assert!((value - 0.5 / PI).abs() < 1e-9, "{value}");
}

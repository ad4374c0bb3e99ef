//! pbrt-v4's stochastic layers [PBRT4, §14.3], the reference for what its files mean: f of two directions, estimated by a
//! walk between interface and base. It follows the light along `wo` into the layer, and connects each event with light
//! along `wi` that was refracted there once. pbrt-v4 takes the interface's own density as a second strategy, and weighs
//! both; the expectation is that of the first alone, wherever the base is no mirror.
//!
//! The closed forms are one function of both directions, so they are compared direction by direction, where
//! [`simulation`](super::simulation) has the sum over all.

use super::direction;
use super::simulation::{
    Base, Light, Met, Stack, fresnel, henyey_greenstein_value, pair, unshadowed,
};
use crate::bsdf::TransportMode;
use crate::math::Vec3;
use crate::sampler::{Purpose, SampleStream};
use crate::testing::{Battery, means};
use glam::DVec3;
use std::f64::consts::PI;

/// Events after which no walk here has light left.
const ENDLESS: usize = 400;
/// Sets of walks for each pair of directions, and walks of a set.
const WALKS: [u64; 2] = [64, 1 << 11];
/// The relative error that the closed form may have.
const TOLERANCE: f64 = 0.01;

impl Stack {
    /// Returns an estimate of f for light along `wi` seen along `wo`, by a walk.
    fn layered(&self, pair: [DVec3; 2], stream: &SampleStream) -> f64 {
        self.interface_value(pair[0], pair[1]) + self.within(pair, stream)
    }

    /// Returns the part of f that enters the layer.
    fn within(&self, [wo, wi]: [DVec3; 2], stream: &SampleStream) -> f64 {
        let at = |purpose| pair(stream, 0, purpose);
        let (_, seen) = self.interface(wo, self.eta, at(Purpose::Lens));
        let (_, lit) = self.interface(wi, self.eta, at(Purpose::LightDirection));
        let (Some((w, part)), Some(lit)) = (seen, lit) else {
            return 0.0;
        };
        let mut state = Some(Light {
            w,
            part: part / (self.eta * self.eta),
            height: self.thickness,
        });
        let mut within = 0.0;
        for event in 1..=ENDLESS {
            let Some((met, next)) = state.and_then(|light| self.event(light, stream, event)) else {
                break;
            };
            within += self.shown(&met, lit);
            state = next;
        }
        within
    }

    /// Returns what an event shows of the light that comes down along `lit`.
    fn shown(&self, met: &Met, (down, lit): (DVec3, f64)) -> f64 {
        let left = |way: f64| lit * libm::exp(-way / down.z.abs());
        match *met {
            Met::Particle(Light { w, part, height }) => {
                let phase = henyey_greenstein_value(w.dot(-down), self.g);
                part * phase / down.z.abs() * left(self.thickness - height)
            }
            Met::Base(part) => part * left(self.thickness) * self.base.value(),
            Met::Interface(_) => 0.0,
        }
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
        let stack = Stack::varnish([eta, alpha], rho, thickness);
        let bsdf = stack.bsdf();
        for (i, [wo, wi]) in directions().into_iter().enumerate() {
            let closed = f64::from(bsdf.eval(wo, wi, TransportMode::Radiance).f[0]);
            let case = format!("{}, pair {i}", stack.name());
            let both = [wo, wi].map(Vec3::as_dvec3);
            let walked = means(&case, WALKS, |stream| stack.layered(both, stream));
            battery.mean_within(&case, walked, closed, TOLERANCE);
        }
    }
    battery.check();
}

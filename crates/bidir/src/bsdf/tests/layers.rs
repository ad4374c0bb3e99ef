//! Layered materials against a walk between their surfaces, which decides by chance at each: the
//! albedo of both, over roughness, angle and base. `BIDIR_TEST_SHOW` prints the tables of
//! docs/data/layer-albedos.csv.

use super::{direction, numbers};
use crate::bsdf::coat::{Layer, Reflections};
use crate::bsdf::microfacet::Ggx;
use crate::bsdf::{
    Bsdf, CoatedConductor, CoatedDiffuse, CoatedMetal, Conductor, Dielectric, Diffuse, Filling,
    TransportMode,
};
use crate::math::{Frame, PI, Vec2, Vec3, safe_sqrt, sin_cos, sqr};
use crate::sampler::{Dimension, Domain, Purpose, SampleStream, Sampler, SamplerKind};
use crate::spectrum::Spectrum;
use std::fmt::Write;

/// Index of all layers here.
const ETA: f32 = 1.5;
/// The events of a walk: more than any that carries light out has.
const MAX_DEPTH: usize = 200;

/// What a walk goes through. All is grey.
#[derive(Clone, Copy)]
struct Stack {
    coat: Ggx,
    base: Bsdf,
    thickness: f32,
    albedo: f32,
    g: f32,
}

impl Stack {
    /// The part of light from `wo` that walks carry out of the layer.
    fn albedo_of_walks(&self, wo: Vec3) -> f32 {
        let n = 1 << 15;
        let sampler = Sampler::new(SamplerKind::Sobol, 7);
        let walk = |i| self.walk(wo, &sampler.stream(Domain::Camera, 0, i));
        let sum: f64 = (0..n).filter_map(walk).map(f64::from).sum();
        (sum / n as f64) as f32
    }

    /// What one walk carries out. None: nothing.
    fn walk(&self, wo: Vec3, stream: &SampleStream) -> Option<f32> {
        let (mut w, mut weight) = self.interface(wo, stream, 0)?;
        if w.z > 0.0 {
            return Some(weight);
        }
        let mut height = self.thickness;
        for step in 1..=MAX_DEPTH {
            let (u_free, u_phase) = {
                let at = |purpose| Dimension::at(step, purpose);
                (
                    stream.get_1d(at(Purpose::Roulette)),
                    stream.get_2d(at(Purpose::Lens)),
                )
            };
            let free = -libm::logf(1.0 - u_free) * w.z.abs();
            let to_surface = if w.z > 0.0 {
                self.thickness - height
            } else {
                height
            };
            if self.albedo == 0.0 {
                weight *= libm::expf(-to_surface / w.z.abs());
            } else if free < to_surface {
                height += free.copysign(w.z);
                weight *= self.albedo;
                w = henyey_greenstein(w, self.g, u_phase);
                continue;
            }
            if w.z > 0.0 {
                height = self.thickness;
                let (next, passed) = self.interface(-w, stream, step)?;
                weight *= passed;
                if next.z > 0.0 {
                    return Some(weight);
                }
                w = next;
            } else {
                height = 0.0;
                let u = stream.get_2d(Dimension::at(step, Purpose::Scatter));
                let drawn = self.base.sample(-w, TransportMode::Importance, || 0.5, u)?;
                weight *= drawn.weight[0];
                w = drawn.wi;
            }
        }
        None
    }

    fn interface(&self, wo: Vec3, stream: &SampleStream, step: usize) -> Option<(Vec3, f32)> {
        let coat = Dielectric {
            eta: ETA,
            ggx: self.coat,
        };
        let u_lobe = stream.get_1d(Dimension::at(step, Purpose::Lobe));
        let u = stream.get_2d(Dimension::at(step, Purpose::LightDirection));
        let drawn = coat.sample(wo, TransportMode::Importance, u_lobe, u)?;
        Some((drawn.wi, drawn.weight[0]))
    }
}

/// The direction after scattering of what goes along `w`.
fn henyey_greenstein(w: Vec3, g: f32, u: Vec2) -> Vec3 {
    let cos = if g.abs() < 1e-3 {
        1.0 - 2.0 * u.x
    } else {
        (1.0 + sqr(g) - sqr((1.0 - sqr(g)) / (1.0 + g - 2.0 * g * u.x))) / (2.0 * g)
    };
    let (sin_phi, cos_phi) = sin_cos(2.0 * PI * u.y);
    let sin = safe_sqrt(1.0 - sqr(cos));
    Frame::from_z(w).to_world(Vec3::new(sin * cos_phi, sin * sin_phi, cos))
}

/// The part of light from `wo` that draws of `bsdf` scatter.
fn albedo_of_draws(bsdf: &Bsdf, wo: Vec3) -> f32 {
    let n = 1 << 15;
    let sampler = Sampler::new(SamplerKind::Sobol, 3);
    let draw = |i| {
        let (u_lobe, u) = numbers(&sampler.stream(Domain::Camera, 1, i));
        bsdf.sample(wo, TransportMode::Importance, || u_lobe, u)
    };
    let weights = (0..n)
        .filter_map(draw)
        .map(|drawn| f64::from(drawn.weight[0]));
    (weights.sum::<f64>() / n as f64) as f32
}

fn filling(thickness: f32, albedo: f32, g: f32) -> Filling {
    Filling {
        thickness,
        albedo: Spectrum::splat(albedo),
        g,
    }
}

fn varnish(alpha: f32, rho: f32, filling: &Filling) -> Bsdf {
    let (layer, ggx) = (Layer::new(ETA, alpha), Ggx::new(alpha, alpha));
    let rho = Spectrum::splat(rho);
    Bsdf::CoatedDiffuse(CoatedDiffuse::new(&layer, ggx, filling, rho))
}

fn lacquer(alpha: f32, metal_alpha: f32, index: [f32; 2], filling: &Filling) -> Bsdf {
    let layer = Layer::new(ETA, alpha);
    let reflections = Reflections::new(&layer, [alpha, metal_alpha]);
    let metal = CoatedMetal {
        eta: Spectrum::splat(index[0] / ETA),
        k: Spectrum::splat(index[1] / ETA),
        ggx: Ggx::new(metal_alpha, metal_alpha),
    };
    let ggx = Ggx::new(alpha, alpha);
    Bsdf::CoatedConductor(CoatedConductor::new(
        (&layer, &reflections),
        ggx,
        filling,
        metal,
    ))
}

/// A line of the table: the albedos of the closed form and of walks, from three directions. Returns
/// the largest difference.
fn compare(name: &str, bsdf: &Bsdf, stack: &Stack) -> f32 {
    let mut line = format!("| {name} |");
    let mut largest = 0.0f32;
    for cos in [0.2, 0.6, 1.0] {
        let wo = direction(cos, 0.3);
        let [closed, walked] = [albedo_of_draws(bsdf, wo), stack.albedo_of_walks(wo)];
        let _ = write!(line, " {closed:.3} | {walked:.3} |");
        largest = largest.max((closed - walked).abs());
    }
    if std::env::var_os("BIDIR_TEST_SHOW").is_some() {
        println!("{line}");
    }
    largest
}

#[track_caller]
fn check_varnish([alpha, rho]: [f32; 2], filling: &Filling, tolerance: f32) {
    let stack = Stack {
        coat: Ggx::new(alpha, alpha),
        base: Bsdf::Diffuse(Diffuse {
            reflectance: Spectrum::splat(rho),
        }),
        thickness: filling.thickness,
        albedo: filling.albedo[0],
        g: filling.g,
    };
    let bsdf = varnish(alpha, rho, filling);
    let Filling { thickness, g, .. } = filling;
    let name = format!(
        "{alpha} | {rho} | {thickness} | {} | {g}",
        filling.albedo[0]
    );
    let difference = compare(&name, &bsdf, &stack);
    assert!(difference < tolerance, "{name}: {difference}");
}

#[test]
fn a_varnish_scatters_what_walks_between_its_surfaces_do() {
    for alpha in [0.0, 0.1, 0.3, 0.6, 1.0] {
        for rho in [0.2, 0.5, 0.9] {
            check_varnish([alpha, rho], &filling(0.01, 0.0, 0.0), 0.008);
        }
    }
    // Thick layers: facets bend light to longer ways than the surface's own normal does.
    check_varnish([0.0, 0.5], &filling(0.5, 0.0, 0.0), 0.008);
    check_varnish([0.3, 0.5], &filling(0.5, 0.0, 0.0), 0.02);
    // Layers that scatter are an approximation.
    check_varnish([0.0, 0.5], &filling(0.01, 0.9, 0.0), 0.01);
    check_varnish([0.0, 0.5], &filling(0.3, 0.9, 0.0), 0.06);
    check_varnish([0.3, 0.1], &filling(0.3, 0.9, 0.5), 0.06);
}

#[track_caller]
fn check_lacquer(alphas: [f32; 2], index: [f32; 2], filling: &Filling, tolerance: f32) {
    let stack = Stack {
        coat: Ggx::new(alphas[0], alphas[0]),
        base: Bsdf::Conductor(Conductor {
            eta: Spectrum::splat(index[0] / ETA),
            k: Spectrum::splat(index[1] / ETA),
            ggx: Ggx::new(alphas[1], alphas[1]),
        }),
        thickness: filling.thickness,
        albedo: filling.albedo[0],
        g: filling.g,
    };
    let bsdf = lacquer(alphas[0], alphas[1], index, filling);
    let [coat, metal] = alphas;
    let name = format!(
        "{coat} | {metal} | {} + {}i | {}",
        index[0], index[1], filling.thickness
    );
    let difference = compare(&name, &bsdf, &stack);
    assert!(difference < tolerance, "{name}: {difference}");
}

#[test]
fn a_lacquer_scatters_about_what_walks_between_its_surfaces_do() {
    // Silver, and copper in blue light.
    for index in [[0.125, 3.34], [1.17, 2.39]] {
        check_lacquer([0.0, 0.0], index, &filling(0.01, 0.0, 0.0), 0.005);
        for metal in [0.1, 0.3, 0.6] {
            check_lacquer([0.0, metal], index, &filling(0.01, 0.0, 0.0), 0.02);
        }
        for alphas in [[0.1, 0.0], [0.1, 0.3], [0.3, 0.1], [0.3, 0.3], [0.6, 0.3]] {
            check_lacquer(alphas, index, &filling(0.01, 0.0, 0.0), 0.02);
        }
    }
}

/// Checks that a white base under a layer that absorbs nothing scatters between `least` and all of
/// the light from every direction.
#[track_caller]
fn check_furnace(bsdf: &Bsdf, least: f32, case: &str) {
    let mut line = format!("| {case} |");
    for cos in [0.05, 0.1, 0.2, 0.4, 0.7, 1.0] {
        let part = albedo_of_draws(bsdf, direction(cos, 0.3));
        let _ = write!(line, " {part:.3} |");
        assert!(
            (least..1.003).contains(&part),
            "{case}, cosine {cos}: {part}"
        );
    }
    if std::env::var_os("BIDIR_TEST_SHOW").is_some() {
        println!("{line}");
    }
}

#[test]
fn white_bases_under_clear_layers_vanish_in_a_furnace_but_for_light_between_facets() {
    let clear = filling(0.0, 0.0, 0.0);
    let diffuser = filling(0.5, 1.0, 0.0);
    for (alpha, least) in [
        (0.0, 0.997),
        (0.05, 0.9),
        (0.1, 0.8),
        (0.3, 0.5),
        (0.6, 0.3),
        (1.0, 0.2),
    ] {
        let case = format!("varnish {alpha}");
        check_furnace(&varnish(alpha, 1.0, &clear), least, &case);
        check_furnace(&varnish(alpha, 1.0, &diffuser), least, &case);
        let case = format!("lacquer {alpha} over 0.3");
        let white = [0.0, 1.0];
        check_furnace(&lacquer(alpha, 0.3, white, &clear), least * 0.6, &case);
    }
    let white = [0.0, 1.0];
    check_furnace(&lacquer(0.0, 0.0, white, &clear), 0.999, "all smooth");
}

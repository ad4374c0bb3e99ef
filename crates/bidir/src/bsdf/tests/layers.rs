//! Layered materials against a walk between their surfaces, which decides by chance at each: the
//! albedo of both, over roughness, angle and base. `BIDIR_TEST_SHOW` prints the tables of
//! docs/data/layer-albedos.csv.

use super::simulation::{Base, Stack};
use super::{direction, numbers};
use crate::testing::samples;
use crate::bsdf::coat::{Layer, Reflections, Slab};
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

/// The part of light from `wo` that draws of `bsdf` scatter.
fn albedo_of_draws(bsdf: &Bsdf, wo: Vec3) -> f32 {
    let n = 1 << 16;
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
    let slab = Slab::new(&layer, filling.thickness, filling.g);
    let filled = slab.tables(&layer, &[filling.albedo[0]])[0];
    let rho = Spectrum::splat(rho);
    Bsdf::CoatedDiffuse(CoatedDiffuse::new(&layer, ggx, &[filled; 4], rho))
}

fn lacquer(alpha: f32, metal_alpha: f32, index: [f32; 2], filling: &Filling) -> Bsdf {
    let layer = Layer::new(ETA, alpha);
    let reflections = Reflections::new(&layer, metal_alpha, filling.thickness);
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

#[test]
fn survey() {
    let n = 1u64 << std::env::var("LOGN").map_or(15, |s| s.parse().unwrap());
    let cosines = [0.1f32, 0.3, 0.6, 1.0];
    let go = |name: String, bsdf: Bsdf, stack: Stack| {
        let mut line = format!("{name:44}");
        for cos in cosines {
            let wo = direction(cos, 0.3);
            let closed = f64::from(albedo_of_draws(&bsdf, wo));
            let d = glam::DVec3::new(f64::from(wo.x), f64::from(wo.y), f64::from(wo.z));
            let (mut s, mut s2, mut e) = (0.0, 0.0, 0.0);
            for st in samples(&name, n) {
                let l = stack.walk(d, &st);
                s += l.all / n as f64;
                s2 += l.all * l.all / n as f64;
                e += l.early / n as f64;
            }
            let sd = ((s2 - s * s) / n as f64).sqrt();
            let _ = write!(line, " | {:.4} {:.4} {:+.2}% ±{:.2}% p{:+.1}%", closed, s, (closed / s - 1.0) * 100.0, sd / s * 100.0, (e / s - 1.0) * 100.0);
        }
        println!("{line}");
    };
    for (alpha, rho, eta, f) in [
        (0.0, 0.2, 1.5, (0.01, 0.0, 0.0)),
        (0.0, 0.9, 1.5, (0.01, 0.0, 0.0)),
        (0.05, 0.5, 1.5, (0.01, 0.0, 0.0)),
        (0.1, 0.2, 1.5, (0.01, 0.0, 0.0)),
        (0.1, 0.9, 1.5, (0.01, 0.0, 0.0)),
        (0.1, 0.9, 1.5, (0.0, 0.0, 0.0)),
        (0.3, 0.2, 1.5, (0.01, 0.0, 0.0)),
        (0.3, 0.9, 1.5, (0.01, 0.0, 0.0)),
        (0.3, 0.9, 1.5, (0.0, 0.0, 0.0)),
        (0.6, 0.5, 1.5, (0.01, 0.0, 0.0)),
        (1.0, 0.2, 1.5, (0.01, 0.0, 0.0)),
        (1.0, 0.9, 1.5, (0.01, 0.0, 0.0)),
        (1.0, 0.9, 1.5, (0.0, 0.0, 0.0)),
        (0.3, 0.9, 1.2, (0.01, 0.0, 0.0)),
        (0.3, 0.9, 2.0, (0.01, 0.0, 0.0)),
        (0.0, 0.9, 1.5, (0.5, 0.0, 0.0)),
        (0.3, 0.9, 1.5, (0.5, 0.0, 0.0)),
        (0.3, 0.9, 1.5, (2.0, 0.0, 0.0)),
        (0.0, 0.5, 1.5, (0.01, 0.9, 0.0)),
        (0.0, 0.5, 1.5, (0.3, 0.9, 0.0)),
        (0.3, 0.1, 1.5, (0.3, 0.9, 0.5)),
        (0.3, 0.1, 1.5, (2.0, 0.9, 0.5)),
        (0.1, 0.0, 1.5, (2.0, 1.0, -0.3)),
    ] {
        let (thickness, albedo, g) = f;
        let layer = Layer::new(eta, alpha);
        let ggx = Ggx::new(alpha, alpha);
        let filled = Slab::new(&layer, thickness, g).tables(&layer, &[albedo])[0];
        let bsdf = Bsdf::CoatedDiffuse(CoatedDiffuse::new(&layer, ggx, &[filled; 4], Spectrum::splat(rho)));
        let stack = Stack { eta: f64::from(eta), alpha: f64::from(alpha), thickness: f64::from(thickness), albedo: f64::from(albedo), g: f64::from(g), base: Base::Diffuse(f64::from(rho)) };
        go(format!("varnish {alpha} {rho} {eta} {f:?}"), bsdf, stack);
    }
    for index in [[0.125, 3.34], [1.17, 2.39]] {
        for (alphas, t) in [([0.0, 0.0], 0.01), ([0.0, 0.1], 0.01), ([0.0, 0.3], 0.01), ([0.0, 0.3], 0.5), ([0.0, 0.6], 0.01), ([0.0, 1.0], 0.01), ([0.1, 0.0], 0.01), ([0.1, 0.3], 0.01), ([0.3, 0.0], 0.01), ([0.3, 0.1], 0.01), ([0.3, 0.3], 0.01), ([0.3, 0.3], 0.5), ([0.6, 0.3], 0.01), ([1.0, 0.3], 0.01), ([0.3, 1.0], 0.01)] {
            let bsdf = lacquer(alphas[0], alphas[1], index, &filling(t, 0.0, 0.0));
            let eta = f64::from(ETA);
            let stack = Stack { eta, alpha: f64::from(alphas[0]), thickness: f64::from(t), albedo: 0.0, g: 0.0,
              base: Base::Metal { eta: f64::from(index[0]) / eta, k: f64::from(index[1]) / eta, alpha: f64::from(alphas[1]) } };
            go(format!("lacquer {alphas:?} {index:?} {t}"), bsdf, stack);
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

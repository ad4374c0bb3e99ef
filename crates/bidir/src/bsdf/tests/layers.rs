//! Layered materials against a simulation between their surfaces ([`Stack`]): the reflectance of both,
//! over index, roughness, angle, base and filling. `BIDIR_TEST_SHOW` prints the tables of
//! docs/data/layer-albedos.csv.

use super::simulation::{Base, Leaving, Stack};
use super::{direction, numbers};
use crate::bsdf::coat::{Layer, Reflections, Slab};
use crate::bsdf::microfacet::Ggx;
use crate::bsdf::{
    Bsdf, CoatedConductor, CoatedDiffuse, CoatedMetal, InterlayerMedium, TransportMode,
};
use crate::math::Vec3;
use crate::sampler::{Domain, Sampler, SamplerKind};
use crate::spectrum::Spectrum;
use crate::testing::{Battery, means};
use std::fmt::Write;

/// The relative error of a reflectance that a closed form may have where it is exact.
const TOLERANCE: f64 = 0.005;
/// Sets of walks for each direction, and walks of a set.
const WALKS: [u64; 2] = [64, 1 << 8];
/// The same where facets lose much of the light by chance.
const WALKS_OF_ROUGH: [u64; 2] = [64, 1 << 12];
/// The same for a table.
const WALKS_SHOWN: [u64; 2] = [64, 1 << 10];
const COSINES: [f32; 3] = [0.2, 0.6, 1.0];

/// A clear layer of the default thickness.
const VARNISH: Stack = Stack {
    eta: 1.5,
    alpha: 0.0,
    thickness: 0.01,
    albedo: 0.0,
    g: 0.0,
    base: Base::Diffuse(0.5),
};

impl Stack {
    /// Returns a clear layer over a diffuse base.
    pub(super) fn varnish([eta, alpha]: [f64; 2], rho: f64, thickness: f64) -> Self {
        Self {
            eta,
            alpha,
            thickness,
            base: Base::Diffuse(rho),
            ..VARNISH
        }
    }

    /// Returns the closed form of it.
    pub(super) fn bsdf(&self) -> Bsdf {
        let layer = Layer::new(self.eta as f32, self.alpha as f32);
        let ggx = Ggx::new(self.alpha as f32, self.alpha as f32);
        let filling = InterlayerMedium {
            thickness: self.thickness as f32,
            albedo: Spectrum::splat(self.albedo as f32),
            g: self.g as f32,
        };
        match self.base {
            Base::Diffuse(rho) => {
                let slab = Slab::new(&layer, filling.thickness, filling.g);
                let filled = slab.tables(&layer, &[filling.albedo[0]])[0];
                let (all, rho) = ([filled; 4], Spectrum::splat(rho as f32));
                Bsdf::CoatedDiffuse(CoatedDiffuse::new(&layer, ggx, &all, &filled, rho))
            }
            Base::Metal { eta, k, alpha } => {
                let [eta, k] = [eta, k].map(|index| Spectrum::splat(index as f32));
                let reflections = Reflections::new(&layer, alpha as f32, filling.thickness);
                let facets = Ggx::new(alpha as f32, alpha as f32);
                let metal = CoatedMetal {
                    eta,
                    k,
                    ggx: facets,
                };
                let lacquered = CoatedConductor::new(&layer, &reflections, ggx, &filling, metal);
                Bsdf::CoatedConductor(lacquered)
            }
        }
    }

    /// Returns a name, and the first columns of the table.
    pub(super) fn name(&self) -> String {
        let (eta, alpha) = (self.eta, self.alpha);
        let filling = format!("{},{},{}", self.thickness, self.albedo, self.g);
        match self.base {
            Base::Diffuse(rho) => format!("coateddiffuse,{eta},{alpha},{rho},,,{filling}"),
            Base::Metal {
                eta: n,
                k,
                alpha: metal,
            } => {
                let index = format!("{:.3}+{:.3}i", n * eta, k * eta);
                format!("coatedconductor,{eta},{alpha},,{metal},{index},{filling}")
            }
        }
    }

    /// Returns the means of what walks of light with cosine `cos` carry out: all, or early.
    fn walked(&self, cos: f32, walks: [u64; 2], part: fn(Leaving) -> f64) -> Vec<f64> {
        let wo = direction(cos, 0.3).as_dvec3();
        let case = format!("{}, {cos}", self.name());
        means(&case, walks, |stream| part(self.walk(wo, stream))).collect()
    }
}

/// Returns the part of the light from `wo` that draws of `bsdf` scatter.
fn albedo_of_draws(bsdf: &Bsdf, wo: Vec3) -> f32 {
    let n = 1 << 14;
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

/// Returns the reflectances of the closed form of `stack`, one for each of [`COSINES`]; prints a line of the
/// table: from each direction the closed form, walks, and walks that end as pbrt-v4's do.
fn reflectances(stack: &Stack) -> [f64; 3] {
    let bsdf = stack.bsdf();
    let closed = COSINES.map(|cos| f64::from(albedo_of_draws(&bsdf, direction(cos, 0.3))));
    if std::env::var_os("BIDIR_TEST_SHOW").is_some() {
        let mut line = stack.name();
        for (cos, closed) in COSINES.into_iter().zip(closed) {
            let mean = |part| {
                let means = stack.walked(cos, WALKS_SHOWN, part);
                means.iter().sum::<f64>() / means.len() as f64
            };
            let (all, early) = (mean(|leaving| leaving.all), mean(|leaving| leaving.early));
            let _ = write!(line, ",{closed:.4},{all:.4},{early:.4}");
        }
        println!("{line}");
    }
    closed
}

/// Adds a comparison of `stack` with walks from the directions of `cosines`.
fn compare(battery: &mut Battery, stack: &Stack, cosines: &[f32], walks: [u64; 2]) {
    for (cos, closed) in COSINES.into_iter().zip(reflectances(stack)) {
        if cosines.contains(&cos) {
            let walked = stack.walked(cos, walks, |leaving| leaving.all);
            let case = format!("{}, cosine {cos}", stack.name());
            battery.mean_within(&case, walked.into_iter(), closed, TOLERANCE);
        }
    }
}

#[test]
fn a_varnish_reflects_what_walks_between_its_surfaces_do() {
    let mut battery = Battery::new("reflectance of varnish");
    for (eta, alpha, rho, thickness, cosines, walks) in [
        (1.5, 0.0, 0.5, 0.0, &COSINES[..], WALKS),
        (1.5, 0.0, 0.9, 0.0, &COSINES, WALKS),
        (1.5, 0.0, 0.2, 0.01, &COSINES, WALKS),
        (1.5, 0.0, 0.5, 0.01, &COSINES, WALKS),
        (1.5, 0.0, 0.9, 0.01, &COSINES, WALKS),
        (1.3, 0.0, 0.9, 0.01, &COSINES, WALKS),
        (1.5, 0.0, 0.9, 0.5, &COSINES, WALKS),
        (1.5, 0.05, 0.5, 0.01, &COSINES, WALKS),
        (1.5, 0.1, 0.9, 0.01, &COSINES, WALKS),
        (1.5, 0.3, 0.2, 0.01, &[0.2], WALKS_OF_ROUGH),
        (1.2, 0.3, 0.9, 0.01, &[0.6], WALKS_OF_ROUGH),
        (2.0, 0.3, 0.9, 0.01, &[0.2], WALKS_OF_ROUGH),
        (1.5, 0.3, 0.9, 0.5, &[0.2], WALKS_OF_ROUGH),
        (1.5, 0.6, 0.5, 0.1, &[0.6], WALKS_OF_ROUGH),
        (1.5, 1.0, 0.9, 0.01, &[0.2], WALKS_OF_ROUGH),
    ] {
        let stack = Stack::varnish([eta, alpha], rho, thickness);
        compare(&mut battery, &stack, cosines, walks);
    }
    // Thin haze.
    let haze = Stack {
        albedo: 0.9,
        ..VARNISH
    };
    compare(&mut battery, &haze, &COSINES, WALKS);
    battery.check();
}

/// Checks that no reflectance of `stack` is further than `bound`, as a relative error, from the walks'.
#[track_caller]
fn check_within(stack: &Stack, bound: f64) {
    for (cos, closed) in COSINES.into_iter().zip(reflectances(stack)) {
        let walked = stack.walked(cos, WALKS, |leaving| leaving.all);
        let walked = walked.iter().sum::<f64>() / walked.len() as f64;
        let error = closed / walked - 1.0;
        let name = stack.name();
        assert!(error.abs() < bound, "{name}, cosine {cos}: {error:+.4}");
    }
}

#[test]
fn a_layer_that_scatters_reflects_about_what_walks_do() {
    for (alpha, rho, thickness, albedo, g) in [
        (0.0, 0.5, 0.3, 0.9, 0.0),
        (0.3, 0.1, 0.3, 0.9, 0.5),
        (0.3, 0.1, 2.0, 0.9, 0.5),
        (0.1, 0.0, 2.0, 1.0, -0.3),
    ] {
        let stack = Stack {
            albedo,
            g,
            ..Stack::varnish([1.5, alpha], rho, thickness)
        };
        check_within(&stack, 0.04);
    }
}

#[test]
fn a_lacquer_reflects_about_what_walks_between_its_surfaces_do() {
    // Silver, and copper in blue light.
    for (n, k) in [(0.125, 3.34), (1.17, 2.39)] {
        let check = |[alpha, metal]: [f64; 2], thickness, bound| {
            let base = Base::Metal {
                eta: n / VARNISH.eta,
                k: k / VARNISH.eta,
                alpha: metal,
            };
            let stack = Stack {
                alpha,
                thickness,
                base,
                ..VARNISH
            };
            check_within(&stack, bound);
        };
        check([0.0, 0.0], 0.01, 0.005);
        check([0.0, 0.1], 0.01, 0.015);
        check([0.0, 0.3], 0.01, 0.015);
        check([0.0, 0.3], 0.5, 0.03);
        check([0.1, 0.0], 0.01, 0.03);
        check([0.1, 0.3], 0.01, 0.02);
        check([0.3, 0.1], 0.01, 0.03);
        check([0.3, 0.3], 0.01, 0.03);
        check([0.3, 0.3], 0.5, 0.05);
        check([0.6, 0.3], 0.01, 0.04);
        check([1.0, 0.3], 0.01, 0.06);
    }
}

/// Checks that a white base under a layer that absorbs nothing scatters between `least` and all of
/// the light from every direction.
#[track_caller]
fn check_furnace(stack: &Stack, least: f32) {
    let (bsdf, name) = (stack.bsdf(), stack.name());
    for cos in [0.05, 0.1, 0.2, 0.4, 0.7, 1.0] {
        let part = albedo_of_draws(&bsdf, direction(cos, 0.3));
        let is_kept = (least..1.003).contains(&part);
        assert!(is_kept, "{name}, cosine {cos}: {part}");
    }
}

#[test]
fn white_bases_under_clear_layers_vanish_in_a_furnace_but_for_light_between_facets() {
    let white = |alpha, thickness, base| Stack {
        alpha,
        thickness,
        albedo: if thickness > 0.0 { 1.0 } else { 0.0 },
        base,
        ..VARNISH
    };
    let metal = |alpha| Base::Metal {
        eta: 0.0,
        k: 1.0,
        alpha,
    };
    for (alpha, least) in [
        (0.0, 0.997),
        (0.05, 0.9),
        (0.1, 0.8),
        (0.3, 0.5),
        (0.6, 0.3),
        (1.0, 0.2),
    ] {
        for thickness in [0.0, 0.5] {
            check_furnace(&white(alpha, thickness, Base::Diffuse(1.0)), least);
        }
        check_furnace(&white(alpha, 0.0, metal(0.3)), least * 0.6);
    }
    check_furnace(&white(0.0, 0.0, metal(0.0)), 0.999);
}

/// Returns the part of even light that draws of `bsdf` scatter: ∫ 2μ albedo dμ.
fn average(bsdf: &Bsdf) -> f64 {
    let n = 64;
    let cos = |i: u8| ((f32::from(i) + 0.5) / f32::from(n)).sqrt();
    let albedos = (0..n).map(|i| f64::from(albedo_of_draws(bsdf, direction(cos(i), 0.3))));
    albedos.sum::<f64>() / f64::from(n)
}

/// The figures of docs/reference/pbrt.md, over a coat that is clear and lets light through as if it were smooth.
#[test]
fn coats_are_as_dark_as_the_page_says() {
    let reflectance =
        |alpha, thickness| average(&Stack::varnish([1.5, alpha], 0.5, thickness).bsdf());
    for (alpha, expected) in [(0.1, 0.92), (0.3, 0.79)] {
        let ratio = reflectance(alpha, 0.01) / reflectance(0.0, 0.0);
        assert!((ratio - expected).abs() < 0.01, "{alpha}: {ratio}");
    }
}

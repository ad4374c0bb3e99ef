use super::{cases, direction, directions, numbers};
use crate::bsdf::microfacet::Ggx;
use crate::bsdf::{Bsdf, Conductor, Dielectric, Diffuse, TransportMode};
use crate::math::Vec3;
use crate::spectrum::Spectrum;
use crate::testing::samples;

/// The part of the light from `wo` that is scattered, by lane, and the largest weight.
fn scattered(bsdf: &Bsdf, wo: Vec3, case: &str) -> ([f64; 4], f32) {
    let n = 1 << 14;
    let (mut sum, mut largest) = ([0.0; 4], 0.0f32);
    for sample in samples(case, n) {
        let (u_lobe, u) = numbers(&sample);
        if let Some(drawn) = bsdf.sample(wo, TransportMode::Importance, || u_lobe, u) {
            largest = largest.max(drawn.weight.max_lane());
            for (sum, weight) in sum.iter_mut().zip(drawn.weight.0) {
                *sum += f64::from(weight) / n as f64;
            }
        }
    }
    (sum, largest)
}

#[test]
fn no_draw_gains_energy() {
    for (name, bsdf, wo) in cases() {
        let (sum, largest) = scattered(&bsdf, wo, &name);
        // Lobes of a layer are drawn by about what they scatter.
        let is_layered = matches!(
            bsdf,
            Bsdf::CoatedDiffuse(_) | Bsdf::CoatedConductor(_) | Bsdf::Principled(_)
        );
        let bound = if is_layered { 4.0 } else { 1.0 + 1e-4 };
        assert!(largest <= bound, "{name}: weight {largest}");
        assert!(
            sum.iter().all(|&lane| (0.0..=1.0 + 1e-4).contains(&lane)),
            "{name}: {sum:?}"
        );
    }
}

/// Checks that a surface that absorbs nothing scatters between `least` and all of the light, from
/// every direction: in an even surrounding of radiance 1 it shows at least `least`.
#[track_caller]
fn check_furnace(bsdf: &Bsdf, least: f64) {
    for (from, wo) in directions() {
        let (sum, _) = scattered(bsdf, wo, from);
        for lane in sum {
            assert!(
                lane >= least && lane <= 1.0 + 1e-5,
                "{bsdf:?}, {from}: {lane}"
            );
        }
    }
}

/// A metal that reflects all light: no real part of the index.
fn white_metal(alpha: f32) -> Bsdf {
    let (eta, k) = (Spectrum::ZERO, Spectrum::ONE);
    Bsdf::Conductor(Conductor {
        eta,
        k,
        ggx: Ggx::new(alpha, alpha),
    })
}

fn glass(eta: f32, alpha: f32) -> Bsdf {
    Bsdf::Dielectric(Dielectric {
        eta,
        ggx: Ggx::new(alpha, alpha),
    })
}

#[test]
fn white_surfaces_vanish_in_a_furnace_but_for_light_between_facets() {
    // One draw in ten million falls on the rim and is dropped.
    check_furnace(
        &Bsdf::Diffuse(Diffuse {
            reflectance: Spectrum::ONE,
        }),
        1.0 - 2e-4,
    );
    check_furnace(&white_metal(0.0), 1.0 - 1e-5);
    check_furnace(&glass(1.5, 0.0), 1.0 - 1e-5);
    check_furnace(&glass(0.7, 0.0), 1.0 - 1e-5);
    // Light that a second facet would scatter again is lost.
    check_furnace(&white_metal(0.05), 0.9);
    check_furnace(&white_metal(0.3), 0.75);
    check_furnace(&white_metal(1.0), 0.3);
    check_furnace(&glass(1.5, 0.05), 0.9);
    check_furnace(&glass(1.5, 0.3), 0.75);
    check_furnace(&glass(1.5, 1.0), 0.4);
}

/// At α = 1 along the normal the facets' density is `cosθ_m/π`, and the part that leaves at once is
/// ∫ c/(1+c) dc over `c = cosθ_i` in `[0, 1]`.
#[test]
fn the_roughest_metal_has_its_analytic_albedo() {
    let (sum, _) = scattered(&white_metal(1.0), Vec3::Z, "roughest");
    assert!(
        (sum[0] - (1.0 - std::f64::consts::LN_2)).abs() < 0.01,
        "{}",
        sum[0]
    );
}

/// ∫ f cosθ dω by quadrature is what the draws say.
#[test]
fn a_grid_of_values_holds_the_energy_of_the_draws() {
    let wo = direction(0.6, 0.4);
    for bsdf in [white_metal(0.4), glass(1.5, 0.4), glass(0.8, 0.5)] {
        let n = 600;
        let mut integral = 0.0;
        for i in 0..n * n {
            let z = 1.0 - 2.0 * ((i / n) as f32 + 0.5) / n as f32;
            let phi = std::f32::consts::TAU * ((i % n) as f32 + 0.5) / n as f32;
            let wi = direction(z, phi);
            let f = bsdf.eval(wo, wi, TransportMode::Importance).f[0];
            integral += f64::from(f * z.abs()) * 4.0 * std::f64::consts::PI / f64::from(n * n);
        }
        let (sum, _) = scattered(&bsdf, wo, "quadrature");
        assert!(
            (integral - sum[0]).abs() < 0.01,
            "{bsdf:?}: {integral} instead of {}",
            sum[0]
        );
    }
}

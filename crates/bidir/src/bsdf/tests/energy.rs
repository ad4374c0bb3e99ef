use super::{cases, direction, directions, numbers};
use crate::bsdf::microfacet::Ggx;
use crate::bsdf::{Bsdf, Conductor, Dielectric, Diffuse, FacetScattering, TransportMode};
use crate::math::Vec3;
use crate::sampler::SampleStream;
use crate::spectrum::Spectrum;
use crate::testing::{check_near, means, samples};

/// Returns the part of the light from `wo` that is scattered, by lane, and the largest weight.
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

/// A mean of 64 sets of points, and its standard error.
struct Estimate {
    mean: f64,
    error: f64,
}

impl Estimate {
    /// Returns the mean less and plus five standard errors, and rounding.
    fn bounds(&self) -> [f64; 2] {
        let noise = 5.0 * self.error + 1e-4;
        [self.mean - noise, self.mean + noise]
    }
}

/// Estimates the part of the light from `wo` that is scattered, in one lane, where weights differ.
fn scattered_often(bsdf: &Bsdf, wo: Vec3, lane: usize, case: &str) -> Estimate {
    let n = 64;
    let weight = |sample: &SampleStream| {
        let (u_lobe, u) = numbers(sample);
        let drawn = bsdf.sample(wo, TransportMode::Importance, || u_lobe, u);
        drawn.map_or(0.0, |drawn| f64::from(drawn.weight[lane]))
    };
    let sets: Vec<f64> = means(case, [n, 2048], weight).collect();
    let mean = sets.iter().sum::<f64>() / n as f64;
    let squares: f64 = sets.iter().map(|set| (set - mean) * (set - mean)).sum();
    let error = squares.sqrt() / n as f64;
    Estimate { mean, error }
}

#[test]
fn no_draw_gains_energy() {
    for (name, bsdf, wo) in cases() {
        let (sum, largest) = scattered(&bsdf, wo, &name);
        // Lobes of a layer are drawn by about what they scatter.
        let is_multiple = name.contains("multiple");
        let bound = match bsdf {
            Bsdf::CoatedDiffuse(_) | Bsdf::CoatedConductor(_) | Bsdf::Principled(_) => 4.0,
            _ if is_multiple => 4.0,
            _ => 1.0 + 1e-4,
        };
        assert!(largest <= bound, "{name}: weight {largest}");
        for (lane, part) in sum.into_iter().enumerate() {
            // Weights of more than one lobe differ, so that their mean is known less well.
            let [least, most] = if is_multiple {
                scattered_often(&bsdf, wo, lane, &name).bounds()
            } else {
                [part; 2]
            };
            assert!(most - least < 0.03, "{name}: {least} to {most} is blind");
            assert!(part >= 0.0 && least <= 1.0 + 1e-4, "{name}: {least}");
        }
    }
}

/// Checks that a surface that absorbs nothing scatters between `least` and all of the light, from
/// every direction: in an even surrounding of radiance 1 it shows at least `least`.
#[track_caller]
fn check_furnace(bsdf: &Bsdf, least: f64) {
    for (from, wo) in directions() {
        let (sum, _) = scattered(bsdf, wo, from);
        let is_kept = |lane: &f64| (least..=1.0 + 1e-5).contains(lane);
        assert!(sum.iter().all(is_kept), "{bsdf:?}, {from}: {sum:?}");
    }
}

/// Returns a metal that reflects all light: no real part of the index.
fn white_metal(x: f32, y: f32, scattering: FacetScattering) -> Bsdf {
    let (eta, k) = (Spectrum::ZERO, Spectrum::ONE);
    Bsdf::Conductor(Conductor::new(eta, k, Ggx::new(x, y), scattering))
}

fn glass(eta: f32, alpha: f32, scattering: FacetScattering) -> Bsdf {
    Bsdf::Dielectric(Dielectric::new(eta, Ggx::new(alpha, alpha), scattering))
}

/// Checks that `bsdf`, which absorbs nothing, scatters all light but for the part `slack`, from every direction.
#[track_caller]
fn check_white(bsdf: &Bsdf, slack: f64, azimuths: &[f32], case: &str) {
    for cos in [0.05f32, 0.1, 0.3, 0.6, 1.0, -0.05, -0.2, -0.6, -1.0] {
        for &phi in azimuths {
            let [least, most] = scattered_often(bsdf, direction(cos, phi), 0, case).bounds();
            let case = format!("{case}, cosine {cos}, azimuth {phi}");
            assert!(most - least < 0.03, "{case}: {least} to {most} is blind");
            assert!(most >= 1.0 - slack, "{case}: at most {most}");
            assert!(least <= 1.0, "{case}: at least {least}");
        }
    }
}

/// The slopes of roughness 0.2 to 1, and some between.
const SLOPES: [f32; 8] = [0.04, 0.1, 0.16, 0.25, 0.36, 0.5, 0.64, 1.0];

#[test]
fn white_metal_whose_facets_scatter_often_vanishes_in_a_furnace() {
    let metal = |x, y| white_metal(x, y, FacetScattering::Multiple);
    for alpha in SLOPES {
        let name = format!("metal of slope {alpha}");
        check_white(&metal(alpha, alpha), 0.008, &[0.8], &name);
    }
    for [x, y] in [[0.5, 0.1], [0.1, 0.5], [0.6, 0.2], [1.0, 0.3], [0.15, 0.05]] {
        let name = format!("metal of slopes {x} and {y}");
        check_white(&metal(x, y), 0.05, &[0.0, 0.8, 1.6], &name);
    }
}

#[test]
fn glass_whose_facets_scatter_often_vanishes_in_a_furnace() {
    let check = |eta, alpha, slack| {
        let name = format!("glass of {eta}, slope {alpha}");
        let glass = glass(eta, alpha, FacetScattering::Multiple);
        check_white(&glass, slack, &[0.8], &name);
    };
    for eta in [1.33, 1.5, 2.4, 1.0 / 1.5] {
        for alpha in SLOPES {
            check(eta, alpha, 0.032);
        }
    }
    // Beyond the fitted indices there is less of it, and never too much.
    for eta in [1.0 + 1e-3, 1.1, 3.5, 10.0, 1e3] {
        check(eta, 0.5, 0.7);
    }
}

/// Rough metal gets more saturated: light that leaves after two facets took their colour twice.
#[test]
fn coloured_metal_takes_its_colour_at_each_facet() {
    let reflectance = 0.5f64;
    // An index so large that the reflectance is the same at all but grazing angles: ((n-1)/(n+1))² with k = 0.
    let root = reflectance.sqrt();
    let eta = Spectrum::splat(((1.0 + root) / (1.0 - root)) as f32);
    let ggx = Ggx::new(1.0, 1.0);
    let metal = |scattering| Bsdf::Conductor(Conductor::new(eta, Spectrum::ZERO, ggx, scattering));
    let [single, multiple] = [FacetScattering::Single, FacetScattering::Multiple]
        .map(|scattering| scattered_often(&metal(scattering), Vec3::Z, 0, "grey"));
    // Along the normal one facet loses ln 2, on average 0.588 of the light: Σ F̄ⁿ (1 - 0.588) 0.588ⁿ⁻², n ≥ 2, F̄ = 0.486.
    let gained = multiple.mean - single.mean;
    let noise = 5.0 * libm::hypot(multiple.error, single.error);
    let expected = std::f64::consts::LN_2 * 0.486 * 0.486 * 0.412 / (1.0 - 0.486 * 0.588);
    // The series takes light to be as likely to leave after the third facet as after the second.
    check_near(gained, expected, 0.005 + noise, "gained");
}

#[test]
fn white_surfaces_vanish_in_a_furnace_but_for_light_between_facets() {
    let reflectance = Spectrum::ONE;
    // One draw in ten million falls on the rim and is dropped.
    check_furnace(&Bsdf::Diffuse(Diffuse { reflectance }), 1.0 - 2e-4);
    let single = FacetScattering::Single;
    check_furnace(&glass(0.7, 0.0, single), 1.0 - 1e-5);
    // Light that a second facet would scatter again is lost.
    for (alpha, of_metal, of_glass) in [
        (0.0, 1.0 - 1e-5, 1.0 - 1e-5),
        (0.05, 0.9, 0.9),
        (0.3, 0.75, 0.75),
        (1.0, 0.3, 0.4),
    ] {
        check_furnace(&white_metal(alpha, alpha, single), of_metal);
        check_furnace(&glass(1.5, alpha, single), of_glass);
    }
}

/// At α = 1 along the normal the facets' density is `cosθ_m/π`, and the part that leaves at once is
/// ∫ c/(1+c) dc over `c = cosθ_i` in `[0, 1]`.
#[test]
fn the_roughest_metal_has_its_analytic_albedo() {
    let metal = white_metal(1.0, 1.0, FacetScattering::Single);
    let (sum, _) = scattered(&metal, Vec3::Z, "roughest");
    check_near(sum[0], 1.0 - std::f64::consts::LN_2, 0.01, "roughest");
}

/// ∫ f cosθ dω by quadrature is what the draws say.
#[test]
fn a_grid_of_values_holds_the_energy_of_the_draws() {
    let (wo, single) = (direction(0.6, 0.4), FacetScattering::Single);
    for bsdf in [
        white_metal(0.4, 0.4, single),
        glass(1.5, 0.4, single),
        glass(0.8, 0.5, single),
    ] {
        let n = 600;
        let values = (0..n * n).map(|i| {
            let z = 1.0 - 2.0 * ((i / n) as f32 + 0.5) / n as f32;
            let phi = std::f32::consts::TAU * ((i % n) as f32 + 0.5) / n as f32;
            let f = bsdf
                .eval(wo, direction(z, phi), TransportMode::Importance)
                .f[0];
            f64::from(f * z.abs())
        });
        let integral = values.sum::<f64>() * 4.0 * std::f64::consts::PI / f64::from(n * n);
        let (sum, _) = scattered(&bsdf, wo, "quadrature");
        check_near(integral, sum[0], 0.01, format!("{bsdf:?}"));
    }
}

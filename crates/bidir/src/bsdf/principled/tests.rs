use super::{Principled, PrincipledCoat, PrincipledParameters, Thickness, sheen, under};
use crate::bsdf::microfacet::Ggx;
use crate::bsdf::tests::numbers;
use crate::bsdf::{Bsdf, CoatedConductor, TransportMode, fresnel};
use crate::math::{PI, Vec2, Vec3, sqr, warp};
use crate::sampler::{Domain, Sampler, SamplerKind};
use crate::spectrum::Spectrum;

fn direction(cos: f32) -> Vec3 {
    Vec3::new((1.0 - sqr(cos)).sqrt(), 0.0, cos)
}

const SLOPES: [f32; 8] = [0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0];
const COSINES: [f32; 8] = [0.01, 0.05, 0.1, 0.2, 0.4, 0.6, 0.8, 1.0];

/// Returns the centres of the cells of a square grid.
fn grid(n: usize) -> impl Iterator<Item = Vec2> {
    let at = move |i: usize| (i as f32 + 0.5) / n as f32;
    (0..n * n).map(move |i| Vec2::new(at(i % n), at(i / n)))
}

/// The bounds are above what they bound, and not far above.
#[test]
fn facets_reflect_no_more_than_the_bound_says() {
    let n = 400;
    for alpha in SLOPES {
        let ggx = Ggx::new(alpha, alpha);
        for cos in COSINES {
            let wo = direction(cos);
            let weights = grid(n).filter_map(|u| {
                let wi = ggx.sample_mirror(wo, u)?;
                let m = (wo + wi).normalize();
                Some(f64::from(
                    fresnel::schlick(wo.dot(m)) * ggx.g2(wo, wi) / ggx.g1(wo),
                ))
            });
            let exact = (weights.sum::<f64>() / (n * n) as f64) as f32;
            let bound = under::facet_weight(cos, alpha);
            assert!(
                bound >= exact - 5e-3,
                "{alpha} {cos}: {bound} below {exact}"
            );
            assert!(bound <= exact + 0.2, "{alpha} {cos}: {bound} above {exact}");
        }
    }
}

#[test]
fn the_mean_of_the_bound_is_no_more_than_that_of_its_values() {
    for alpha in SLOPES {
        let at = |i: u16| (f32::from(i) + 0.5) / 1000.0;
        let sum: f32 = (0..1000)
            .map(|i| 2.0 * at(i) * under::facet_weight(at(i), alpha))
            .sum();
        let (mean, bound) = (sum / 1000.0, under::mean_facet_weight(alpha));
        assert!(
            bound <= mean + 1e-4 && bound >= 0.6 * mean,
            "{alpha}: {bound} {mean}"
        );
    }
}

#[test]
fn cloth_reflects_no_more_than_the_bound_says() {
    let n = 400;
    for alpha in [0.1, 0.15, 0.25, 0.4, 0.6, 0.8, 1.0] {
        for cos in COSINES {
            let wo = direction(cos);
            let values = grid(n).map(|u| {
                // Closer to the rim, where most of it is: cosθ = x².
                let wi = warp::uniform_cone(u, 1.0);
                let (from, z) = (wi.z.max(1e-6), sqr(wi.z));
                let scale = ((1.0 - sqr(z)) / (1.0 - sqr(wi.z)).max(1e-9)).sqrt();
                let wi = Vec3::new(wi.x * scale, wi.y * scale, z);
                f64::from(sheen::eval(wo, wi, alpha) * z * 2.0 * from * 2.0 * PI)
            });
            let exact = (values.sum::<f64>() / (n * n) as f64) as f32;
            let bound = under::sheen_albedo(cos, alpha);
            assert!(
                bound >= exact - 2e-3,
                "{alpha} {cos}: {bound} below {exact}"
            );
            assert!(
                bound <= exact + 0.2 && bound < 1.0,
                "{alpha} {cos}: {bound} above {exact}"
            );
        }
    }
}

/// All light that leaves towards all sides, by draws of importance.
fn scattered(bsdf: &Principled, wo: Vec3) -> f64 {
    let n = 1 << 15;
    let bsdf = Bsdf::Principled(*bsdf);
    let sampler = Sampler::new(SamplerKind::Sobol, 3);
    let drawn = (0..n).filter_map(|index| {
        let (u_lobe, u) = numbers(&sampler.stream(Domain::Camera, 1, index));
        bsdf.sample(wo, TransportMode::Importance, || u_lobe, u)
    });
    drawn.map(|drawn| f64::from(drawn.weight[0])).sum::<f64>() / n as f64
}

#[track_caller]
fn check_furnace(parameters: &PrincipledParameters, least: f64) {
    let bsdf = Principled::new(parameters);
    for cos in [0.05, 0.1, 0.3, 0.6, 1.0, -0.05, -0.2, -1.0] {
        let sum = scattered(&bsdf, direction(cos));
        assert!(
            sum <= 1.004 && sum >= least,
            "{parameters:?} at {cos}: {sum}"
        );
    }
}

/// In an even surrounding nothing white is brighter than it, and little is much darker.
#[test]
fn white_surfaces_gain_nothing_in_a_furnace() {
    let white = |alpha| PrincipledParameters::plain(Spectrum::ONE, Ggx::new(alpha, alpha));
    let coat = |cover, alpha| PrincipledCoat { cover, alpha };
    for (alpha, least) in [
        (0.0, 0.98),
        (0.05, 0.9),
        (0.1, 0.9),
        (0.3, 0.85),
        (0.6, 0.85),
        (1.0, 0.85),
    ] {
        let plain = white(alpha);
        check_furnace(&plain, least);
        check_furnace(
            &PrincipledParameters {
                metallic: 0.5,
                ..plain
            },
            least * 0.6,
        );
        check_furnace(
            &PrincipledParameters {
                diffuse_transmission: 0.7,
                ..plain
            },
            least,
        );
        for (cover, slope) in [(1.0, 0.0), (0.5, 0.1), (1.0, 0.5)] {
            let coat = coat(cover, slope);
            check_furnace(&PrincipledParameters { coat, ..plain }, 0.75);
            check_furnace(
                &PrincipledParameters {
                    coat,
                    metallic: 1.0,
                    ..plain
                },
                0.85,
            );
        }
        for thickness in [Thickness::ThinWalled, Thickness::Solid] {
            let clear = PrincipledParameters {
                transmission: 1.0,
                thickness,
                ..plain
            };
            check_furnace(&clear, 0.95);
            check_furnace(
                &PrincipledParameters {
                    transmission: 0.5,
                    coat: coat(1.0, 0.2),
                    ..clear
                },
                0.75,
            );
        }
        for sheen_alpha in [0.1, 0.3, 1.0] {
            let sheen = Spectrum::ONE;
            check_furnace(
                &PrincipledParameters {
                    sheen,
                    sheen_alpha,
                    ..plain
                },
                0.4,
            );
        }
    }
}

/// White metal, and what else absorbs nothing, keeps all light at any roughness: from 0.2 to 1, brushed or not, as a
/// mirror of `ior` 0, as a pane and as a solid.
#[test]
fn white_facets_vanish_in_a_furnace() {
    for roughness in [0.2f32, 0.4, 0.6, 0.8, 1.0] {
        let alpha = sqr(roughness);
        let plain = PrincipledParameters::plain(Spectrum::ONE, Ggx::new(alpha, alpha));
        let metal = PrincipledParameters {
            metallic: 1.0,
            ..plain
        };
        check_furnace(&metal, 0.985);
        let brushed = Ggx::new(alpha + (1.0 - alpha) * 0.25, alpha);
        check_furnace(
            &PrincipledParameters {
                ggx: brushed,
                ..metal
            },
            0.94,
        );
        check_furnace(&PrincipledParameters { ior: 0.0, ..plain }, 0.985);
        for (specular, least) in [(1.0, 0.95), (0.5, 0.65)] {
            let glass = PrincipledParameters {
                transmission: 1.0,
                specular,
                ..plain
            };
            check_furnace(&glass, 0.975);
            let thickness = Thickness::Solid;
            check_furnace(&PrincipledParameters { thickness, ..glass }, least);
        }
    }
}

/// Light that a coat throws back to white metal leaves in the end: as bright as the metal alone along the mirrored
/// direction.
#[test]
fn a_smooth_coat_over_smooth_white_metal_loses_nothing() {
    let lacquered = PrincipledParameters {
        metallic: 1.0,
        coat: PrincipledCoat {
            cover: 1.0,
            alpha: 0.0,
        },
        ..PrincipledParameters::plain(Spectrum::ONE, Ggx::new(0.0, 0.0))
    };
    check_furnace(&lacquered, 0.985);
}

/// A principled BSDF is no larger than the largest of the others, as all vertices keep one.
#[test]
fn it_makes_no_vertex_larger() {
    assert!(size_of::<Principled>() <= size_of::<CoatedConductor>());
    assert_eq!(size_of::<Bsdf>(), 160);
}

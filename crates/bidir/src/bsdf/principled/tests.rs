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

/// Checks that a bound is above the mean of values over the cells of a grid, and not far above.
#[track_caller]
fn check_bound(bound: f32, slack: f32, case: [f32; 2], value: impl Fn(Vec2) -> Option<f32>) {
    let n = 400;
    let values = grid(n).filter_map(value).map(f64::from);
    let exact = (values.sum::<f64>() / (n * n) as f64) as f32;
    let range = exact - slack..=exact + 0.2;
    assert!(range.contains(&bound), "{case:?}: {bound} bounds {exact}");
}

#[test]
fn facets_reflect_no_more_than_the_bound_says() {
    for alpha in SLOPES {
        let ggx = Ggx::new(alpha, alpha);
        for cos in COSINES {
            let wo = direction(cos);
            let bound = under::facet_weight(cos, alpha);
            check_bound(bound, 5e-3, [alpha, cos], |u| {
                let wi = ggx.sample_mirror(wo, u)?;
                let m = (wo + wi).normalize();
                Some(fresnel::schlick(wo.dot(m)) * ggx.g2(wo, wi) / ggx.g1(wo))
            });
        }
    }
}

#[test]
fn the_mean_of_the_bound_is_no_more_than_that_of_its_values() {
    for alpha in SLOPES {
        let at = |i: u16| (f32::from(i) + 0.5) / 1000.0;
        let values = (0..1000).map(|i| 2.0 * at(i) * under::facet_weight(at(i), alpha));
        let (mean, bound) = (
            values.sum::<f32>() / 1000.0,
            under::mean_facet_weight(alpha),
        );
        let range = 0.6 * mean..=mean + 1e-4;
        assert!(range.contains(&bound), "{alpha}: {bound} {mean}");
    }
}

#[test]
fn cloth_reflects_no_more_than_the_bound_says() {
    for alpha in [0.1, 0.15, 0.25, 0.4, 0.6, 0.8, 1.0] {
        for cos in COSINES {
            let wo = direction(cos);
            let bound = under::sheen_albedo(cos, alpha);
            assert!(bound < 1.0, "{alpha} {cos}: {bound}");
            check_bound(bound, 2e-3, [alpha, cos], |u| {
                // Closer to the rim, where most of it is: cosθ = x².
                let wi = warp::uniform_cone(u, 1.0);
                let (from, z) = (wi.z.max(1e-6), sqr(wi.z));
                let scale = ((1.0 - sqr(z)) / (1.0 - sqr(wi.z)).max(1e-9)).sqrt();
                let wi = Vec3::new(wi.x * scale, wi.y * scale, z);
                Some(sheen::eval(wo, wi, alpha) * z * 2.0 * from * 2.0 * PI)
            });
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

/// Checks what is left of the light in an even surrounding, of `plain` with changes.
#[track_caller]
fn check_furnace(
    plain: PrincipledParameters,
    least: f64,
    change: impl FnOnce(&mut PrincipledParameters),
) {
    let mut parameters = plain;
    change(&mut parameters);
    let bsdf = Principled::new(&parameters);
    for cos in [0.05, 0.1, 0.3, 0.6, 1.0, -0.05, -0.2, -1.0] {
        let sum = scattered(&bsdf, direction(cos));
        let is_kept = (least..=1.004).contains(&sum);
        assert!(is_kept, "{parameters:?} at {cos}: {sum}");
    }
}

fn white(alpha: f32) -> PrincipledParameters {
    PrincipledParameters::plain(Spectrum::ONE, Ggx::new(alpha, alpha))
}

/// In an even surrounding nothing white is brighter than it, and little is much darker.
#[test]
fn white_surfaces_gain_nothing_in_a_furnace() {
    for (alpha, least) in [
        (0.0, 0.98),
        (0.05, 0.9),
        (0.1, 0.9),
        (0.3, 0.85),
        (0.6, 0.85),
        (1.0, 0.85),
    ] {
        let plain = white(alpha);
        check_furnace(plain, least, |_| ());
        check_furnace(plain, least * 0.6, |it| it.metallic = 0.5);
        check_furnace(plain, least, |it| it.diffuse_transmission = 0.7);
        for (cover, alpha) in [(1.0, 0.0), (0.5, 0.1), (1.0, 0.5)] {
            let coat = PrincipledCoat { cover, alpha };
            check_furnace(plain, 0.75, |it| it.coat = coat);
            check_furnace(plain, 0.85, |it| (it.coat, it.metallic) = (coat, 1.0));
        }
        for thickness in [Thickness::ThinWalled, Thickness::Solid] {
            check_furnace(plain, 0.95, |it| {
                (it.thickness, it.transmission) = (thickness, 1.0);
            });
            let (cover, alpha) = (1.0, 0.2);
            check_furnace(plain, 0.75, |it| {
                (it.thickness, it.transmission) = (thickness, 0.5);
                it.coat = PrincipledCoat { cover, alpha };
            });
        }
        for alpha in [0.1, 0.3, 1.0] {
            let sheen = Spectrum::ONE;
            check_furnace(plain, 0.4, |it| (it.sheen, it.sheen_alpha) = (sheen, alpha));
        }
    }
}

/// White metal, and what else absorbs nothing, keeps all light at any roughness: from 0.2 to 1, brushed or not, as a
/// mirror of `ior` 0, as a pane and as a solid.
#[test]
fn white_facets_vanish_in_a_furnace() {
    for roughness in [0.2f32, 0.4, 0.6, 0.8, 1.0] {
        let alpha = sqr(roughness);
        let plain = white(alpha);
        check_furnace(plain, 0.985, |it| it.metallic = 1.0);
        let brushed = Ggx::new(alpha + (1.0 - alpha) * 0.25, alpha);
        check_furnace(plain, 0.94, |it| (it.metallic, it.ggx) = (1.0, brushed));
        check_furnace(plain, 0.985, |it| it.ior = 0.0);
        for (specular, least) in [(1.0, 0.95), (0.5, 0.65)] {
            for (thickness, least) in [(Thickness::ThinWalled, 0.975), (Thickness::Solid, least)] {
                check_furnace(plain, least, |it| {
                    (it.transmission, it.specular, it.thickness) = (1.0, specular, thickness);
                });
            }
        }
    }
}

/// Light that a coat throws back to white metal leaves in the end: as bright as the metal alone along the mirrored
/// direction.
#[test]
fn a_smooth_coat_over_smooth_white_metal_loses_nothing() {
    let (cover, alpha) = (1.0, 0.0);
    check_furnace(white(0.0), 0.985, |it| {
        (it.metallic, it.coat) = (1.0, PrincipledCoat { cover, alpha });
    });
}

/// A principled BSDF is no larger than the largest of the others, as all vertices keep one.
#[test]
fn it_makes_no_vertex_larger() {
    assert!(size_of::<Principled>() <= size_of::<CoatedConductor>());
    assert_eq!(size_of::<Bsdf>(), 160);
}

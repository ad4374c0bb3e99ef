//! Scenes whose image is known.

use crate::common::prelude::*;
use bidir::film::{Filter, FilterKind};
use bidir::integrator::CandidateCount;
use bidir::path::PathRoulette;
use bidir::select::ShadowRays;
use bidir::shape::Disk;

/// The inside of a sphere that reflects ρ of what it receives and emits 1 - ρ: radiance 1
/// everywhere.
fn closed_sphere_of(mut builder: ShotBuilder, reflectance: Rgb) -> Shot {
    let wall = builder.material(diffuse(reflectance));
    let inside = Sphere::new(Affine3A::IDENTITY, 2.0, Orientation::Reversed);
    let emitted = emission(reflectance.map(|rho| 1.0 - rho));
    builder.shape(Shape::Sphere(inside), wall, emitted);
    builder.build()
}

fn closed_sphere() -> Shot {
    closed_sphere_of(builder(8, 0.0), [0.5; 3])
}

/// Checks that an estimator has a known expectation everywhere, and that the same test would see
/// a bias of 2 %.
#[track_caller]
fn check_expectation(name: &str, a: &Replicates, expected: f64) {
    check_agree(name, a, &a.exactly([expected; 3]), &[WHOLE, 4]);
}

/// Passes of an estimator in the closed sphere: the light tracer, whose splats are few, needs
/// `most` of them.
fn passes(integrator: IntegratorKind, most: u64) -> u64 {
    match integrator {
        IntegratorKind::Light => most,
        _ => most / 8,
    }
}

/// The estimators by name, without the choice of one of them.
fn estimators() -> impl Iterator<Item = (&'static str, IntegratorKind)> {
    let all = IntegratorKind::NAMES.into_iter();
    all.filter(|(_, kind)| *kind != IntegratorKind::Auto)
}

/// ½ⁿ.
fn halved(n: u32) -> f64 {
    1.0 / f64::from(1u32 << n)
}

/// Checks each estimator in the closed sphere, by settings that `change` changes, at a limit of depth: radiance after
/// d scatterings is ½ + ¼ + … = 1 - ½^(d+1).
#[track_caller]
fn check_closed_sphere(case: &str, depth: u32, most: u64, change: impl Fn(&mut Settings)) {
    let scene = closed_sphere();
    for (name, integrator) in estimators() {
        let mut settings = settings(integrator, Some(depth));
        change(&mut settings);
        let result = replicates(&scene, &settings, passes(integrator, most));
        check_expectation(&format!("{name}, {case}"), &result, 1.0 - halved(depth + 1));
    }
}

#[test]
fn a_closed_sphere_has_radiance_one() {
    let scene = closed_sphere();
    for (name, integrator) in IntegratorKind::NAMES {
        let passes = passes(integrator, 4096);
        let result = replicates(&scene, &settings(integrator, None), passes);
        check_expectation(name, &result, 1.0);
    }
}

#[test]
fn every_limit_of_depth_cuts_the_same_paths() {
    for depth in [0, 1, 3] {
        check_closed_sphere(&format!("depth {depth}"), depth, 5120, |_| ());
    }
}

#[test]
fn roulette_does_not_change_the_mean() {
    let roulettes = "albedo:0 albedo:2 throughput:0 throughput:3 off";
    for name in roulettes.split(' ') {
        let roulette = name.parse::<PathRoulette>().expect("a roulette");
        check_closed_sphere(name, 8, 4096, |settings| settings.path.roulette = roulette);
    }
}

/// Much light of such a room comes by more than 64 vertices: of these paths not all pairs are
/// connected, and few samples train.
#[test]
#[ignore = "minutes: just nightly"]
fn rooms_that_reflect_nearly_all_light_are_as_bright_by_every_estimator() {
    let scene = closed_sphere_of(builder(8, 0.0), [0.97; 3]);
    let render = |integrator, passes| {
        let mut settings = settings(integrator, None);
        settings.set_integrator(integrator);
        replicates(&scene, &settings, passes)
    };
    let bdpt = render(IntegratorKind::Bdpt, 512);
    let lvc = render(IntegratorKind::Lvc, 1024);
    for (name, result) in [("bdpt", &bdpt), ("lvc", &lvc)] {
        check_agree(name, result, &result.exactly([1.0; 3]), &[WHOLE]);
    }
    check_agree("lvc and bdpt", &lvc, &bdpt, &[WHOLE]);
}

/// Comparisons that need millions of samples.
mod statistics {
    use super::*;

    /// Checks that the mean of a closed sphere with roulette on and off is the known one, 1 - ρ^(d+1)
    /// after d scatterings, where a bias of `bias` would show. Passes are those of path tracing and of
    /// bidirectional path tracing.
    #[track_caller]
    fn check_roulette(scene: &Shot, reflectance: Rgb, passes: [u64; 2], bias: f64) {
        let depth = 2;
        for roulette in ["albedo:0", "throughput:0", "off"] {
            let integrators = [IntegratorKind::Path, IntegratorKind::Bdpt];
            for (integrator, passes) in integrators.into_iter().zip(passes) {
                let mut settings = settings(integrator, Some(depth));
                settings.path.roulette = roulette.parse::<PathRoulette>().expect("a roulette");
                let result = replicates(scene, &settings, passes);
                let radiance = |rho: f32| 1.0 - libm::pow(f64::from(rho), f64::from(depth + 1));
                let exact = result.exactly(reflectance.map(radiance));
                let name = format!("{integrator:?}, {roulette}");
                check_agree_to(&name, &result, &exact, &[WHOLE], bias);
            }
        }
    }

    #[test]
    #[ignore = "statistics: .ci/run statistics"]
    fn roulette_changes_the_mean_by_less_than_a_thousandth() {
        let scene = closed_sphere_of(builder(32, 0.0), [0.5; 3]);
        check_roulette(&scene, [0.5; 3], [4096, 2048], 0.001);
    }

    #[test]
    #[ignore = "statistics: .ci/run statistics"]
    fn roulette_keeps_colours_under_a_filter_with_negative_lobes() {
        let mitchell = FilterKind::Mitchell {
            b: 1.0 / 3.0,
            c: 1.0 / 3.0,
        };
        let filter = Filter::new(mitchell, Vec2::splat(2.0));
        let colours = [0.3, 0.5, 0.6];
        let scene = closed_sphere_of(builder_with(32, 0.0, filter), colours);
        check_roulette(&scene, colours, [2048, 1280], 0.002);
    }
}

/// An object in an environment of radiance 1 that absorbs nothing: it cannot be seen.
fn furnace(add: impl Fn(&mut ShotBuilder)) -> Shot {
    let mut builder = builder(8, 0.0);
    builder.sky([1.0; 3]);
    add(&mut builder);
    builder.build()
}

#[test]
fn white_objects_vanish_in_a_white_environment() {
    let materials = [("white", diffuse([1.0; 3])), ("glass", glass(0.0))];
    for (name, material) in materials {
        let scene = furnace(|builder| {
            builder.add(sphere(Vec3::Z, 1.0), material.clone());
        });
        for integrator in FROM_THE_CAMERA {
            let result = replicates(&scene, &settings(integrator, None), 1024);
            check_expectation(&format!("{name}, {integrator:?}"), &result, 1.0);
        }
    }
}

#[test]
fn an_empty_scene_shows_the_environment() {
    let scene = furnace(|_| ());
    for integrator in FROM_THE_CAMERA {
        let result = replicates(&scene, &settings(integrator, None), 512);
        check_expectation(&format!("{integrator:?}"), &result, 1.0);
    }
    // Few rays from infinity meet the lens's view: only the mean of the film is sharp.
    let result = replicates(&scene, &settings(IntegratorKind::Light, None), 32768);
    check_expectation("light", &result, 1.0);
}

#[test]
fn a_ring_light_over_a_floor_gives_its_form_factor() {
    // Under the middle of a ring at height h: L = ρ L_e (r²/(r² + h²) - i²/(i² + h²)) for radii
    // r and i. The camera looks through the ring at the spot below.
    let (radius, inner, height, rho) = (0.5f32, 0.02f32, 1.0f32, 0.6f32);
    let mut builder = builder(2, 0.0);
    builder.camera(narrow_camera(Vec3::ZERO, 2, 0.004));
    let wall = builder.material(diffuse([rho; 3]));
    let spot = quad(Vec3::new(-0.5, -0.5, height), Vec3::X, Vec3::Y);
    builder.shape(spot, wall, None);
    let (radii, front) = ([inner, radius], Orientation::Natural);
    let ring = Disk::new(Affine3A::IDENTITY, 0.0, radii, 2.0 * PI, front);
    builder.shape(Shape::Disk(ring), wall, emission([2.0; 3]));
    let scene = builder.build();
    let disk = |r: f32| f64::from(r * r / (r * r + height * height));
    let expected = f64::from(rho) * 2.0 * (disk(radius) - disk(inner));
    for integrator in FROM_THE_CAMERA {
        let result = replicates(&scene, &settings(integrator, Some(1)), 8192);
        check_expectation(&format!("{integrator:?}"), &result, expected);
    }
}

#[test]
fn rough_surfaces_lose_but_never_gain() {
    for (name, material) in [("metal", metal(0.4)), ("glass", glass(0.4))] {
        let scene = furnace(|builder| {
            builder.add(sphere(Vec3::Z, 1.0), material.clone());
        });
        for integrator in FROM_THE_CAMERA {
            let result = replicates(&scene, &settings(integrator, None), 1024);
            let mean = result.mean();
            assert!(mean < 1.0 && mean > 0.75, "{name}: {mean}");
        }
    }
}

#[test]
fn selection_keeps_the_closed_sphere() {
    use IntegratorKind::{Bdpt, Lvc};
    let few = CandidateCount::of(8);
    for (integrator, rule, candidates) in [
        (Bdpt, "per-light-vertex", few),
        (Bdpt, "per-camera-vertex", few),
        (Bdpt, "per-pair", few),
        (Bdpt, "ray-roulette", few),
        (Bdpt, "budget:2", few),
        (Lvc, "budget:2", few),
        (Lvc, "per-light-vertex", CandidateCount::new(8, 2)),
    ] {
        let mut settings = settings(integrator, Some(8));
        settings.shadow_rays = rule.parse::<ShadowRays>().expect("a rule");
        settings.lvc.candidates = candidates;
        let result = replicates(&closed_sphere(), &settings, 1024);
        check_expectation(&format!("{integrator}, {rule}"), &result, 1.0 - halved(9));
    }
}

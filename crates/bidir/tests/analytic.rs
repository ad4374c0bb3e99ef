//! Scenes whose image is known.

mod common;

use bidir::driver::Settings;
use bidir::integrator::IntegratorKind;
use bidir::light::{InfiniteLight, Light};
use bidir::math::{Affine3A, PI, Vec3};
use bidir::path::{PathRoulette, PathSettings};
use bidir::scene::{Scene, SceneBuilder};
use bidir::select::ShadowRays;
use bidir::shape::{Disk, Orientation, Shape, Sphere};
use common::statistics::{FINE, Replicates, check_agree, replicates};
use common::{builder, diffuse, emission, glass, metal, narrow_camera, quad, sphere};

fn settings(integrator: IntegratorKind, max_depth: Option<u32>) -> Settings {
    Settings {
        integrator,
        path: PathSettings {
            max_depth,
            ..PathSettings::default()
        },
        ..Settings::default()
    }
}

/// The inside of a sphere that emits ½ and reflects ½ of what it receives: radiance 1 everywhere.
fn closed_sphere() -> Scene {
    let mut builder = builder(8, 0.0);
    let half = builder.material(diffuse([0.5; 3]));
    let inside = Sphere::new(Affine3A::IDENTITY, 2.0, Orientation::Reversed);
    builder.shape(Shape::Sphere(inside), half, emission([0.5; 3]));
    builder.build().expect("the scene is valid")
}

/// Checks that an estimator has a known expectation everywhere, and that the same test would see
/// a bias of 2 %.
#[track_caller]
fn check_expectation(name: &str, a: &Replicates, expected: f64) {
    let exact = vec![vec![expected; a[0].len()]; a.len()];
    check_agree(name, a, &exact, FINE);
}

/// ½ⁿ.
fn halved(n: u32) -> f64 {
    1.0 / f64::from(1u32 << n)
}

#[test]
fn a_closed_sphere_has_radiance_one() {
    let scene = closed_sphere();
    for (name, integrator) in IntegratorKind::NAMES {
        let result = replicates(&scene, &settings(integrator, None), 256, 4);
        check_expectation(name, &result, 1.0);
    }
}

#[test]
fn every_limit_of_depth_cuts_the_same_paths() {
    // Radiance after d scatterings: ½ + ¼ + … = 1 - ½^(d+1).
    let scene = closed_sphere();
    for depth in [0, 1, 3] {
        let expected = 1.0 - halved(depth + 1);
        for (name, integrator) in IntegratorKind::NAMES {
            let settings = settings(integrator, Some(depth));
            let result = replicates(&scene, &settings, 128, 8);
            check_expectation(&format!("{name}, depth {depth}"), &result, expected);
        }
    }
}

#[test]
fn roulette_does_not_change_the_mean() {
    let scene = closed_sphere();
    for roulette in [
        "albedo:0",
        "albedo:2",
        "throughput:0",
        "throughput:3",
        "off",
    ] {
        for (name, integrator) in IntegratorKind::NAMES {
            let mut settings = settings(integrator, Some(8));
            settings.path.roulette = roulette.parse::<PathRoulette>().expect("a roulette");
            let result = replicates(&scene, &settings, 128, 8);
            let expected = 1.0 - halved(9);
            check_expectation(&format!("{name}, {roulette}"), &result, expected);
        }
    }
}

#[test]
fn roulette_changes_the_mean_by_less_than_a_thousandth() {
    // The closed sphere has little variance: here a bias of 0.1 % would show.
    let scene = closed_sphere();
    let exact = vec![vec![1.0 - halved(3); 4]; 16];
    for roulette in ["albedo:0", "throughput:0", "off"] {
        for (integrator, passes) in [(IntegratorKind::Path, 4096), (IntegratorKind::Bdpt, 4096)] {
            let mut settings = settings(integrator, Some(2));
            settings.path.roulette = roulette.parse::<PathRoulette>().expect("a roulette");
            let result = replicates(&scene, &settings, passes, 8);
            check_agree(
                &format!("{integrator:?}, {roulette}"),
                &result,
                &exact,
                0.001,
            );
        }
    }
}

/// An object in an environment of radiance 1 that absorbs nothing: it cannot be seen.
fn furnace(add: impl Fn(&mut SceneBuilder)) -> Scene {
    let mut builder = builder(8, 0.0);
    builder.light(Light::Infinite(InfiniteLight::constant([1.0; 3])));
    add(&mut builder);
    builder.build().expect("the scene is valid")
}

#[test]
fn white_objects_vanish_in_a_white_environment() {
    let materials = [("white", diffuse([1.0; 3])), ("glass", glass(0.0))];
    for (name, material) in materials {
        let scene = furnace(|builder| {
            let material = builder.material(material.clone());
            builder.shape(sphere(Vec3::new(0.0, 0.0, 1.0), 1.0), material, None);
        });
        for integrator in [IntegratorKind::Path, IntegratorKind::Bdpt] {
            let result = replicates(&scene, &settings(integrator, None), 512, 4);
            check_expectation(&format!("{name}, {integrator:?}"), &result, 1.0);
        }
    }
}

#[test]
fn an_empty_scene_shows_the_environment() {
    let scene = furnace(|_| ());
    for integrator in [IntegratorKind::Path, IntegratorKind::Bdpt] {
        let result = replicates(&scene, &settings(integrator, None), 64, 8);
        check_expectation(&format!("{integrator:?}"), &result, 1.0);
    }
    // Few rays from infinity meet the lens's view: only the mean of the film is sharp.
    let result = replicates(&scene, &settings(IntegratorKind::Light, None), 8192, 8);
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
    builder.shape(Shape::Mesh(spot), wall, None);
    let ring = [inner, radius];
    let ring = Disk::new(
        Affine3A::IDENTITY,
        0.0,
        ring,
        2.0 * PI,
        Orientation::Natural,
    );
    builder.shape(Shape::Disk(ring), wall, emission([2.0; 3]));
    let scene = builder.build().expect("the scene is valid");
    let disk = |r: f32| f64::from(r * r / (r * r + height * height));
    let expected = f64::from(rho) * 2.0 * (disk(radius) - disk(inner));
    for integrator in [IntegratorKind::Path, IntegratorKind::Bdpt] {
        let result = replicates(&scene, &settings(integrator, Some(1)), 512, 2);
        check_expectation(&format!("{integrator:?}"), &result, expected);
    }
}

#[test]
fn rough_surfaces_lose_but_never_gain() {
    for (name, material) in [("metal", metal(0.4)), ("glass", glass(0.4))] {
        let scene = furnace(|builder| {
            let material = builder.material(material.clone());
            builder.shape(sphere(Vec3::new(0.0, 0.0, 1.0), 1.0), material, None);
        });
        for integrator in [IntegratorKind::Path, IntegratorKind::Bdpt] {
            let result = replicates(&scene, &settings(integrator, None), 64, 8);
            let mean = result.iter().map(|r| r[r.len() - 1]).sum::<f64>() / result.len() as f64;
            assert!(mean < 1.0 && mean > 0.75, "{name}: {mean}");
        }
    }
}

#[test]
fn selection_keeps_the_closed_sphere() {
    let scene = closed_sphere();
    for rule in [
        "per-light-vertex",
        "per-camera-vertex",
        "per-pair",
        "ray-roulette",
        "budget:2",
    ] {
        let mut settings = settings(IntegratorKind::Bdpt, Some(8));
        settings.shadow_rays = rule.parse::<ShadowRays>().expect("a rule");
        let result = replicates(&scene, &settings, 128, 8);
        check_expectation(rule, &result, 1.0 - halved(9));
    }
}

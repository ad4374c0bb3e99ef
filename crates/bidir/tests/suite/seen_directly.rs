//! Light that is seen directly: hits of the light, and its light image.

use crate::common::prelude::*;
use bidir::camera::{Camera, Orthographic, OrthographicSettings};
use bidir::film::Picture;
use bidir::path::MisHeuristic;

const BIDIRECTIONAL: [IntegratorKind; 2] = [IntegratorKind::Bdpt, IntegratorKind::Lvc];

/// One pass, whose light subpaths are few.
fn picture(scene: &Shot, integrator: IntegratorKind, mis: MisHeuristic, seed: u64) -> Picture {
    let mut settings = Settings {
        seed,
        ..Settings::default()
    };
    settings.set_integrator(integrator);
    settings.path.mis = mis;
    scene.film(&settings, 1, 0).develop()
}

#[track_caller]
fn check_sky(scene: &Shot, integrator: IntegratorKind, mis: MisHeuristic) {
    for radiance in picture(scene, integrator, mis, 0).pixels.as_flattened() {
        let is_even = (radiance - 2.0).abs() < 1e-3;
        assert!(is_even, "{integrator} {mis:?}: {radiance}");
    }
}

/// The light image of a sky varies with the number of its light subpaths, hits of it do not.
#[test]
fn a_sky_has_no_noise() {
    let mut builder = builder(8, 0.0);
    builder.sky([2.0; 3]);
    let scene = builder.build();
    for integrator in BIDIRECTIONAL {
        for mis in [MisHeuristic::Balance, MisHeuristic::Power] {
            check_sky(&scene, integrator, mis);
        }
    }
}

/// Parallel rays from infinity and a sky make no connection: camera rays alone see the sky, also under uniform
/// weights, which cut no light image off.
#[test]
fn parallel_rays_see_the_whole_sky() {
    let mut builder = builder(8, 0.0);
    let settings = OrthographicSettings {
        world_from_camera: Affine3A::IDENTITY,
        resolution: Vec2::splat(8.0),
        screen: [Vec2::new(-1.5, 1.5), Vec2::new(1.5, -1.5)],
    };
    let camera = Orthographic::new(&settings).expect("the camera is rigid");
    builder.camera(Camera::Orthographic(camera));
    builder.sky([2.0; 3]);
    let scene = builder.build();
    for (_, mis) in MisHeuristic::NAMES {
        check_sky(&scene, IntegratorKind::Bdpt, mis);
    }
}

/// Hits find a lamp that fills less than a millionth of a pixel in as few samples.
#[test]
fn a_small_lamp_is_in_every_picture() {
    let mut builder = builder(8, 0.0);
    let black = builder.material(metal(0.5));
    let lamp = sphere(Vec3::ZERO, 1e-4);
    builder.shape(lamp, black, emission([1e6; 3]));
    let scene = builder.build();
    for integrator in BIDIRECTIONAL {
        for seed in 0..4 {
            let picture = picture(&scene, integrator, MisHeuristic::Balance, seed);
            let sum: f32 = picture.pixels.as_flattened().iter().sum();
            assert!(sum > 0.0, "{integrator:?}, seed {seed}");
        }
    }
}

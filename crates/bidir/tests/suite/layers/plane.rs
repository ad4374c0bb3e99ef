//! Features of a plane, all of which are known, and what pixels cost.

use super::{FEATURES, layer, settings};
use crate::common::prelude::*;
use bidir::driver::Progress;
use bidir::film::{Aov, LayerImage};
use bidir::math::DVec3;
use bidir::scene::RenderSpace;
use std::sync::atomic::{AtomicU64, Ordering};

/// A plane at z = 1 that covers the left five eighths of the view of a camera at z = -1.8.
fn plane() -> Shot {
    plane_in(RenderSpace::WORLD)
}

/// The same where these numbers are those of another space.
fn plane_in(space: RenderSpace) -> Shot {
    let mut builder = builder(4, 0.0);
    builder.space(space);
    let plane = parallelogram(Vec3::new(-9.0, -9.0, 1.0), Vec3::Y * 18.0, Vec3::X * 9.42);
    builder.add(tilted(plane, Vec3::ZERO), diffuse([0.8, 0.4, 0.2]));
    builder.sky([1.0; 3]);
    builder.build()
}

/// The values of a pixel in the layer with this name and first channel.
fn at(images: &[LayerImage], name: &str, channel: &str, pixel: usize) -> Vec<f32> {
    let image = layer(images, name, channel);
    let n = image.channels.len();
    image.data[pixel * n..(pixel + 1) * n].to_vec()
}

#[track_caller]
fn check_near(values: &[f32], expected: &[f32]) {
    let fits = values.len() == expected.len();
    let mut pairs = values.iter().zip(expected);
    let is_near = pairs.all(|(a, b)| (a - b).abs() < 2e-3);
    assert!(fits && is_near, "{values:?}, not {expected:?}");
}

/// Checks pixel 4, the first of the second row; the view is 0.6 wide at distance 1.
#[track_caller]
fn check_surface(images: &[LayerImage]) {
    let at = |name: &str, channel: &str| at(images, name, channel, 4);
    for (name, channel, expected) in [
        ("Albedo", "R", &[0.8, 0.4, 0.2][..]),
        ("N", "X", &[0.0, 0.0, -1.0]),
        ("Ns", "X", &[0.0, 0.0, -1.0]),
        ("", "Z", &[2.8]),
        ("", "Coverage", &[1.0]),
        ("", "Samples", &[64.0]),
    ] {
        check_near(&at(name, channel), expected);
    }
    let position = Vec3::from_slice(&at("P", "X"));
    check_near(&[position.z], &[1.0]);
    let centre = Vec3::new(-0.45 * 2.8, 0.15 * 2.8, 1.0);
    assert!((position - centre).length() < 0.15, "{position:?}");
    assert!(at("", "Rays")[0] >= 64.0);
}

/// Checks pixel 6, half of which is sky, which counts for no depth.
#[track_caller]
fn check_edge(images: &[LayerImage]) {
    check_near(&at(images, "", "Z", 6), &[2.8]);
    let coverage = at(images, "", "Coverage", 6)[0];
    assert!((coverage - 0.5).abs() < 0.1, "{coverage}");
}

/// Checks pixel 7, which is sky.
#[track_caller]
fn check_sky(images: &[LayerImage]) {
    let images_of_surfaces = [
        ("Albedo", "R"),
        ("P", "X"),
        ("N", "X"),
        ("", "Z"),
        ("", "Coverage"),
    ];
    for (name, channel) in images_of_surfaces {
        let values = at(images, name, channel, 7);
        assert!(values.iter().all(|v| *v == 0.0), "{name} {channel}");
    }
}

#[test]
fn features_of_a_plane_are_known() {
    let scene = plane();
    for (_, integrator) in IntegratorKind::NAMES {
        let settings = settings(integrator, Layers::new(&FEATURES, &[], 0));
        let images = scene.film(&settings, 64, 2).develop_layers();
        check_surface(&images);
        check_edge(&images);
        check_sky(&images);
    }
}

#[test]
fn positions_and_depths_are_those_of_the_world() {
    let space = RenderSpace {
        origin: DVec3::new(2048.0, 0.0, -512.0),
        unit: 4.0,
    };
    let [here, there] = [RenderSpace::WORLD, space].map(|space| {
        let scene = plane_in(space);
        let layers = Layers::new(&[Aov::Position, Aov::Depth], &[], 0);
        let settings = settings(IntegratorKind::Path, layers);
        let images = scene.film(&settings, 16, 1).develop_layers();
        let position = Vec3::from_slice(&at(&images, "P", "X", 4));
        (position, at(&images, "", "Z", 4)[0])
    });
    let expected = space.world_point(here.0).as_vec3();
    let is_near = there.0.distance(expected) < 1e-2;
    assert!(is_near, "{there:?}, not {expected}");
    check_near(&[there.1], &[4.0 * here.1]);
}

#[test]
fn variance_is_that_of_the_mean() {
    let scene = plane();
    let settings = settings(IntegratorKind::Path, Layers::new(&[Aov::Variance], &[], 0));
    let film = scene.film(&settings, 64, 2);
    let (picture, images) = (film.develop(), film.develop_layers());
    let data = |name| &layer(&images, name, "R").data;
    let [absolute, relative] = ["Variance", "RelativeVariance"].map(data);
    assert_eq!(*absolute, picture.variance.concat());
    for (i, mean) in picture.pixels.concat().into_iter().enumerate() {
        let (variance, relative) = (absolute[i], relative[i]);
        assert!((relative * mean * mean - variance).abs() <= 1e-6 * variance);
    }
    assert!(absolute.iter().any(|variance| *variance > 0.0));
}

/// A clock that is a millisecond later whenever it is looked at.
#[derive(Default)]
struct Clock(AtomicU64);

impl Progress for Clock {
    fn advance(&self, _samples: u64) {}

    fn nanoseconds(&self) -> u64 {
        self.0.fetch_add(1_000_000, Ordering::Relaxed)
    }
}

#[test]
fn time_is_looked_at_where_it_is_kept() {
    let mut builder = builder(4, 0.0);
    let wall = builder.material(diffuse([0.5; 3]));
    add_walls(&mut builder, wall);
    let scene = builder.build();
    for (aov, looks) in [(Aov::Time, 3 * 16 * 2), (Aov::Rays, 0)] {
        let settings = settings(IntegratorKind::Path, Layers::new(&[aov], &[], 0));
        let mut session = scene.session(settings, 1);
        let clock = Clock::default();
        (0..3).for_each(|_| assert!(session.step(&clock)));
        assert_eq!(clock.0.into_inner(), looks * 1_000_000);
        if aov == Aov::Time {
            let images = session.film().develop_layers();
            let seconds = &layer(&images, "", "Time").data;
            let is_right = seconds.iter().all(|pixel| (pixel - 3e-3).abs() < 1e-6);
            assert!(is_right, "{seconds:?}");
        }
    }
}

//! What a film keeps beside the picture: known features of a plane, parts that add up, and groups of
//! lights that are what the lights alone would give.

mod common;

use bidir::driver::{Progress, Resources, Session, Settings, render};
use bidir::film::{Aov, Film, LayerImage, Layers, MergeError, Picture};
use bidir::integrator::IntegratorKind;
use bidir::light::{InfiniteLight, Light};
use bidir::math::Vec3;
use bidir::scene::{DEFAULT_GROUP, ENVIRONMENT_GROUP, Scene};
use bidir::shape::Shape;
use bidir::spectrum::Rgb;
use common::statistics::{WHOLE, check_agree, replicates, replicates_of};
use common::{add_walls, builder, diffuse, emission, quad, sphere};
use std::sync::atomic::{AtomicU64, Ordering};

fn settings(integrator: IntegratorKind, layers: Layers) -> Settings {
    Settings {
        integrator,
        layers,
        ..Settings::default()
    }
}

fn film(scene: &Scene, settings: &Settings, passes: u64, threads: usize) -> Film {
    let resources = Resources {
        threads,
        ..Resources::default()
    };
    render(scene, settings, passes, &resources).expect("the film is small")
}

fn layer<'a>(images: &'a [LayerImage], name: &str, channel: &str) -> &'a LayerImage {
    let is_it = |image: &&LayerImage| image.name == name && image.channels[0] == channel;
    images.iter().find(is_it).expect("the layer is kept")
}

/// A group of lights of the lit room.
#[derive(Clone, Copy, PartialEq)]
enum Lamp {
    Ceiling,
    Ball,
    Sky,
}

/// A room without a front wall, seen from outside, of which some lamps are on.
fn lit_room(size: u32, lamps: &[Lamp]) -> Scene {
    let mut builder = builder(size, 0.0);
    let wall = builder.material(diffuse([0.7, 0.5, 0.3]));
    let back = quad(Vec3::new(-2.0, -2.0, 2.0), Vec3::Y * 4.0, Vec3::X * 4.0);
    builder.shape(Shape::Mesh(back), wall, None);
    let floor = quad(Vec3::new(-2.0, -2.0, 2.0), Vec3::X * 4.0, Vec3::Z * -2.0);
    builder.shape(Shape::Mesh(floor), wall, None);
    let lit = |lamp, radiance| emission(radiance).filter(|_| lamps.contains(&lamp));
    builder.light_group(Some("ceiling"));
    let panel = quad(Vec3::new(-0.7, 1.9, 0.5), Vec3::X * 1.4, Vec3::Z);
    builder.shape(
        Shape::Mesh(panel),
        wall,
        lit(Lamp::Ceiling, [6.0, 2.0, 1.0]),
    );
    builder.light_group(None);
    let ball = sphere(Vec3::new(0.9, -0.4, 0.8), 0.3);
    builder.shape(ball, wall, lit(Lamp::Ball, [2.0, 3.0, 9.0]));
    if lamps.contains(&Lamp::Sky) {
        builder.light(Light::Infinite(InfiniteLight::constant([0.2, 0.4, 0.3])));
    }
    builder.build().expect("the room is valid")
}

const LAMPS: [Lamp; 3] = [Lamp::Ceiling, Lamp::Ball, Lamp::Sky];

#[test]
fn lights_are_in_groups_by_name_or_by_kind() {
    let scene = lit_room(2, &LAMPS);
    let expected = ["ceiling", DEFAULT_GROUP, ENVIRONMENT_GROUP];
    assert_eq!(scene.group_names(), expected);
    let groups: Vec<_> = (0..3).map(|light| scene.light_group(light)).collect();
    assert_eq!(groups, [0, 1, 2]);
}

/// Checks that images of the parts add up to the picture, up to the rounding of their values.
#[track_caller]
fn check_sum(picture: &Picture, parts: &[LayerImage]) {
    for (i, pixel) in picture.pixels.iter().flatten().enumerate() {
        let sum: f32 = parts.iter().map(|part| part.data[i]).sum();
        let tolerance = 1e-5 * pixel.abs() + 1e-9;
        assert!((sum - pixel).abs() < tolerance, "{i}: {sum}, not {pixel}");
    }
}

#[test]
fn parts_add_up_to_the_picture_and_leave_it_alone() {
    let scene = lit_room(8, &LAMPS);
    for (name, integrator) in IntegratorKind::NAMES {
        let layers = Layers::new(&[], scene.group_names(), 4);
        let film = |layers| film(&scene, &settings(integrator, layers), 16, 2);
        let (plain, kept) = (film(Layers::default()), film(layers));
        let picture = kept.develop();
        assert_eq!(plain.develop(), picture, "{name}");
        let images = kept.develop_layers();
        let (groups, strategies) = images.split_at(3);
        assert_eq!(groups[2].name, "lightgroup.environment");
        check_sum(&picture, groups);
        check_sum(&picture, strategies);
        assert!(
            groups
                .iter()
                .all(|group| group.data.iter().any(|v| *v > 0.0))
        );
        assert!(
            layer(strategies, "longer", "R")
                .data
                .iter()
                .any(|v| *v > 0.0),
            "{name}"
        );
    }
}

#[test]
fn a_group_is_what_its_lights_alone_would_give() {
    let scene = lit_room(8, &LAMPS);
    let layers = Layers::new(&[], scene.group_names(), 0);
    let groups = LAMPS.into_iter().zip(scene.group_names());
    for (integrator, passes) in [(IntegratorKind::Path, 32768), (IntegratorKind::Bdpt, 16384)] {
        let settings = settings(integrator, layers.clone());
        for (lamp, group) in groups.clone() {
            let name = format!("lightgroup.{group}");
            let pick = |film: &Film| -> Vec<Rgb> {
                let images = film.develop_layers();
                let data = &layer(&images, &name, "R").data;
                data.as_chunks::<3>().0.to_vec()
            };
            let of_group = replicates_of(&scene, &settings, passes, pick);
            let alone = replicates(&lit_room(8, &[lamp]), &Settings::default(), passes);
            let name = format!("{integrator:?}, {name}");
            check_agree(&name, &of_group, &alone, &[WHOLE, 2]);
        }
    }
}

const FEATURES: [Aov; 9] = [
    Aov::Albedo,
    Aov::Position,
    Aov::Normal,
    Aov::ShadingNormal,
    Aov::Depth,
    Aov::Coverage,
    Aov::Samples,
    Aov::Variance,
    Aov::Rays,
];

/// A plane at z = 1 that covers the left five eighths of the view of a camera at z = -1.8.
fn plane() -> Scene {
    let mut builder = builder(4, 0.0);
    let material = builder.material(diffuse([0.8, 0.4, 0.2]));
    let plane = quad(Vec3::new(-9.0, -9.0, 1.0), Vec3::Y * 18.0, Vec3::X * 9.42);
    let plane = common::tilt(plane, Vec3::ZERO);
    builder.shape(Shape::Mesh(plane), material, None);
    builder.light(Light::Infinite(InfiniteLight::constant([1.0; 3])));
    builder.build().expect("the plane is valid")
}

#[test]
fn features_of_a_plane_are_known() {
    let scene = plane();
    for (name, integrator) in IntegratorKind::NAMES {
        let settings = settings(integrator, Layers::new(&FEATURES, &[], 0));
        let images = film(&scene, &settings, 64, 2).develop_layers();
        let at = |name: &str, channel: &str, pixel: usize| {
            let image = layer(&images, name, channel);
            let n = image.channels.len();
            image.data[pixel * n..(pixel + 1) * n].to_vec()
        };
        let near = |values: Vec<f32>, expected: &[f32]| {
            let pairs = values.iter().zip(expected);
            let fits = pairs.clone().all(|(a, b)| (a - b).abs() < 2e-3);
            assert!(
                fits && values.len() == expected.len(),
                "{name}: {values:?}, not {expected:?}"
            );
        };
        // Pixel 4 is the first of the second row; the view is 0.6 wide at distance 1.
        near(at("Albedo", "R", 4), &[0.8, 0.4, 0.2]);
        near(at("N", "X", 4), &[0.0, 0.0, -1.0]);
        near(at("Ns", "X", 4), &[0.0, 0.0, -1.0]);
        near(at("", "Z", 4), &[2.8]);
        near(at("", "Coverage", 4), &[1.0]);
        near(at("", "Samples", 4), &[64.0]);
        let position = at("P", "X", 4);
        near(vec![position[2]], &[1.0]);
        let centre = Vec3::new(-0.45 * 2.8, 0.15 * 2.8, 1.0);
        assert!(
            (Vec3::from_slice(&position) - centre).length() < 0.15,
            "{name}: {position:?}"
        );
        assert!(at("", "Rays", 4)[0] >= 64.0, "{name}");
        // Pixel 6 is half sky, which counts for no depth.
        near(at("", "Z", 6), &[2.8]);
        let coverage = at("", "Coverage", 6)[0];
        assert!((coverage - 0.5).abs() < 0.1, "{name}: {coverage}");
        // Pixel 7 is the sky.
        for (layer, channel) in [
            ("Albedo", "R"),
            ("P", "X"),
            ("N", "X"),
            ("", "Z"),
            ("", "Coverage"),
        ] {
            assert!(
                at(layer, channel, 7).iter().all(|v| *v == 0.0),
                "{name}: {layer} {channel}"
            );
        }
    }
}

#[test]
fn variance_is_that_of_the_mean() {
    let scene = plane();
    let settings = settings(IntegratorKind::Path, Layers::new(&[Aov::Variance], &[], 0));
    let film = film(&scene, &settings, 64, 2);
    let (picture, images) = (film.develop(), film.develop_layers());
    let (absolute, relative) = (
        layer(&images, "Variance", "R"),
        layer(&images, "RelativeVariance", "R"),
    );
    let flat = |pixels: &[Rgb]| pixels.concat();
    assert_eq!(absolute.data, flat(&picture.variance));
    for ((mean, variance), relative) in flat(&picture.pixels)
        .iter()
        .zip(&absolute.data)
        .zip(&relative.data)
    {
        assert!((relative * mean * mean - variance).abs() <= 1e-6 * variance);
    }
    assert!(absolute.data.iter().any(|variance| *variance > 0.0));
}

#[test]
fn layers_have_the_same_bits_in_any_order() {
    let scene = common::room(0.1);
    let layers = Layers::new(&FEATURES, scene.group_names(), 5);
    for (name, integrator) in IntegratorKind::NAMES {
        let settings = settings(integrator, layers.clone());
        let one = film(&scene, &settings, 4, 1);
        assert!(one == film(&scene, &settings, 4, 3), "{name}");
        let mut session =
            Session::new(&scene, settings, &Resources::default()).expect("the film is small");
        session.start_at(2);
        (0..2).for_each(|_| assert!(session.step(&())));
        let mut merged = session.into_film();
        let first = film(
            &scene,
            &Settings {
                layers: layers.clone(),
                integrator,
                ..Settings::default()
            },
            2,
            2,
        );
        merged.merge(&first).expect("other passes");
        assert!(merged == one, "{name}");
    }
}

#[test]
fn films_of_other_layers_are_not_merged() {
    let scene = common::room(0.1);
    let film = |aov| {
        film(
            &scene,
            &settings(IntegratorKind::Path, Layers::new(&[aov], &[], 0)),
            1,
            1,
        )
    };
    let mut depth = film(Aov::Depth);
    assert_eq!(depth.merge(&film(Aov::Albedo)), Err(MergeError::Layers));
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
    let scene = builder.build().expect("the walls are valid");
    for (aov, looks) in [(Aov::Time, 3 * 16 * 2), (Aov::Rays, 0)] {
        let settings = settings(IntegratorKind::Path, Layers::new(&[aov], &[], 0));
        let resources = Resources {
            threads: 1,
            ..Resources::default()
        };
        let mut session = Session::new(&scene, settings, &resources).expect("the film is small");
        let clock = Clock::default();
        (0..3).for_each(|_| assert!(session.step(&clock)));
        assert_eq!(clock.0.into_inner(), looks * 1_000_000);
        if aov == Aov::Time {
            let images = session.film().develop_layers();
            let seconds = &layer(&images, "", "Time").data;
            assert!(
                seconds.iter().all(|pixel| (pixel - 3e-3).abs() < 1e-6),
                "{seconds:?}"
            );
        }
    }
}

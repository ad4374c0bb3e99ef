//! What a film keeps beside the picture: known features of a plane, parts that add up, and groups of
//! lights that are what the lights alone would give.

mod common;

use bidir::driver::{Progress, Resources, Session, Settings, render};
use bidir::film::{Aov, Film, LayerImage, Layers, MergeError, Picture};
use bidir::integrator::IntegratorKind;
use bidir::light::{InfiniteLight, Light};
use bidir::math::Vec3;
use bidir::path::Strategy;
use bidir::sampler::SamplerKind;
use bidir::scene::{DEFAULT_GROUP, ENVIRONMENT_GROUP, Scene};
use bidir::select::ShadowRays;
use bidir::shape::Shape;
use bidir::spectrum::{Rgb, luminance};
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

/// Bidirectional path tracing with these strategies, and raw images of paths of four vertices.
fn with_raw(strategies: &str) -> Settings {
    let mut settings = settings(IntegratorKind::Bdpt, Layers::new(&[], &[], 4).with_raw());
    settings.path.strategies = strategies.parse().expect("a list of strategies");
    settings
}

fn pixels(film: &Film, part: Option<usize>) -> Vec<Rgb> {
    let part = part.expect("the strategy has an image");
    film.part_pixels(part).collect()
}

#[test]
fn a_raw_image_is_what_its_strategy_alone_would_give() {
    let scene = lit_room(8, &LAMPS);
    let all = film(&scene, &with_raw("all"), 16, 2);
    for strategy in all.layers().kept_strategies() {
        let raw = pixels(&all, all.layers().raw_part(strategy));
        // No walk depends on the strategies that take part, so both have the same samples.
        let alone = film(&scene, &with_raw(&strategy.to_string()), 16, 2).develop();
        for (a, b) in raw.iter().flatten().zip(alone.pixels.iter().flatten()) {
            assert!((a - b).abs() <= 1e-4 * b, "{strategy}: {a}, not {b}");
        }
        assert!(
            alone.pixels.iter().flatten().any(|v| *v > 0.0),
            "{strategy}"
        );
    }
}

#[test]
fn raw_images_do_not_depend_on_the_choice_of_shadow_rays() {
    let scene = lit_room(8, &LAMPS);
    let chosen = Settings {
        shadow_rays: ShadowRays::PerPair,
        ..with_raw("all")
    };
    let strategy = Strategy::new(1, 2);
    let raw = |film: &Film| pixels(film, film.layers().raw_part(strategy));
    let raw = replicates_of(&scene, &chosen, 16384, raw);
    let alone = replicates(&scene, &with_raw("s1t2"), 16384);
    check_agree("s1t2, one ray per pair", &raw, &alone, &[WHOLE]);
}

#[test]
fn what_has_all_the_weight_is_its_raw_image() {
    let scene = lit_room(8, &LAMPS);
    for (s, t) in [(0, 3), (1, 2), (2, 1), (2, 2)] {
        let strategy = Strategy::new(s, t);
        let film = film(&scene, &with_raw(&strategy.to_string()), 4, 2);
        let layers = film.layers();
        let weighted = pixels(&film, layers.weighted_part(strategy));
        assert_eq!(pixels(&film, layers.raw_part(strategy)), weighted);
        assert_eq!(film.develop().pixels, weighted, "{strategy}");
    }
}

#[test]
fn strategies_vary_as_their_images_do_from_pass_to_pass() {
    const PASSES: u64 = 512;
    let scene = lit_room(4, &LAMPS);
    let settings = Settings {
        sampler: SamplerKind::Independent,
        ..with_raw("all")
    };
    let session = |first: u64, passes: u64| {
        let resources = Resources::default();
        let session = Session::new(&scene, settings.clone(), &resources);
        let mut session = session.expect("the film is small");
        session.start_at(first);
        (0..passes).for_each(|_| assert!(session.step(&())));
        session
    };
    let images: Vec<Film> = (0..PASSES)
        .map(|pass| session(pass, 1).into_film())
        .collect();
    for told in session(0, PASSES).strategy_moments() {
        let values = images.iter().map(|film| {
            let pixels = pixels(film, film.layers().weighted_part(told.strategy));
            let values = pixels.into_iter().map(|pixel| f64::from(luminance(pixel)));
            values.collect::<Vec<_>>()
        });
        let values: Vec<_> = values.collect();
        let of_pixel = |i: usize| {
            let n = PASSES as f64;
            let mean = values.iter().map(|image| image[i]).sum::<f64>() / n;
            let square = values
                .iter()
                .map(|image| (image[i] - mean) * (image[i] - mean));
            (mean, square.sum::<f64>() / (n - 1.0))
        };
        let moments: Vec<_> = (0..16).map(of_pixel).collect();
        let mean = moments.iter().map(|(mean, _)| mean).sum::<f64>() / 16.0;
        let variance = moments.iter().map(|(_, variance)| variance).sum::<f64>() / 16.0;
        // Exact where a sample has a pixel of its own; light paths of a pass meet in pixels.
        let tolerance = if told.strategy.t == 1 { 0.1 } else { 1e-4 };
        let found = told.variance.expect("several passes");
        assert!(
            (found - variance).abs() <= tolerance * variance,
            "{told:?}: {variance}"
        );
        assert!((told.mean - mean).abs() <= 1e-5 * mean, "{told:?}: {mean}");
    }
}

#[test]
fn counters_do_not_depend_on_threads() {
    let scene = lit_room(8, &LAMPS);
    let stats = [1, 3].map(|threads| {
        let resources = Resources {
            threads,
            ..Resources::default()
        };
        let session = Session::new(&scene, with_raw("all"), &resources);
        let mut session = session.expect("the film is small");
        (0..4).for_each(|_| assert!(session.step(&())));
        session.stats().clone()
    });
    assert_eq!(stats[0], stats[1]);
    assert!(stats[0].strategy_images.rows().count() > 6);
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
    let layers = Layers::new(&FEATURES, scene.group_names(), 5).with_raw();
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

//! Groups of lights.

use super::lit_room::{LAMPS, lit_room};
use super::{layer, settings};
use crate::common::prelude::*;
use crate::common::statistics::replicates_of_each;
use bidir::film::{LayerImage, Picture};
use bidir::scene::{DEFAULT_GROUP, ENVIRONMENT_GROUP};

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
        let film = |layers| scene.film(&settings(integrator, layers), 16, 2);
        let (plain, kept) = (film(Layers::default()), film(layers));
        let picture = kept.develop();
        assert_eq!(plain.develop(), picture, "{name}");
        let images = kept.develop_layers();
        let (groups, strategies) = images.split_at(3);
        assert_eq!(groups[2].name, "lightgroup.environment");
        check_sum(&picture, groups);
        check_sum(&picture, strategies);
        for image in groups.iter().chain([layer(strategies, "longer", "R")]) {
            let is_lit = image.data.iter().any(|v| *v > 0.0);
            assert!(is_lit, "{name}, {}", image.name);
        }
    }
}

/// The images of each lamp's group.
fn pictures_of_groups(film: &Film) -> [Vec<Rgb>; 3] {
    let images = film.develop_layers();
    ["ceiling", DEFAULT_GROUP, ENVIRONMENT_GROUP].map(|group| {
        let image = layer(&images, &format!("lightgroup.{group}"), "R");
        image.data.as_chunks::<3>().0.to_vec()
    })
}

#[test]
fn a_group_is_what_its_lights_alone_would_give() {
    let scene = lit_room(8, &LAMPS);
    let layers = Layers::new(&[], scene.group_names(), 0);
    // The smaller and the nearer a lamp, the more its image varies.
    let passes = LAMPS.into_iter().zip([24576, 4096, 1024]);
    let alone: Vec<Replicates> = passes
        .map(|(lamp, passes)| replicates(&lit_room(8, &[lamp]), &Settings::default(), passes))
        .collect();
    for (integrator, passes) in [(IntegratorKind::Path, 40960), (IntegratorKind::Bdpt, 14336)] {
        let settings = settings(integrator, layers.clone());
        let groups = replicates_of_each(&scene, &settings, passes, pictures_of_groups);
        for ((group, alone), name) in groups.iter().zip(&alone).zip(scene.group_names()) {
            let name = format!("{integrator:?}, {name}");
            check_agree(&name, group, alone, &[WHOLE, 2]);
        }
    }
}

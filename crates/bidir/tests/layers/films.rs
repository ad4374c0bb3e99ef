//! Films that keep layers: their bits, and what they can be merged with.

use crate::{FEATURES, common, film, settings};
use bidir::driver::{Resources, Session, Settings};
use bidir::film::{Aov, Layers, MergeError};
use bidir::integrator::IntegratorKind;

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

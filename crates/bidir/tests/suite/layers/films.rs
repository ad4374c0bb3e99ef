//! Films that keep layers: their bits, and what they can be merged with.

use super::{FEATURES, film, settings};
use crate::common;
use bidir::driver::{Resources, Session};
use bidir::film::{Aov, Layers, MergeError};
use bidir::integrator::IntegratorKind;

#[test]
fn layers_have_the_same_bits_in_any_order() {
    let scene = common::room(0.1);
    let layers = Layers::new(&FEATURES, scene.group_names(), 5).with_raw();
    for (name, integrator) in IntegratorKind::NAMES {
        let settings = settings(integrator, layers.clone());
        let one = film(&scene, &settings, 4, 1);
        let resources = Resources {
            threads: 3,
            ..Resources::default()
        };
        let mut session = Session::new(&scene.scene, &scene.view, settings, &resources)
            .expect("the film is small");
        let [mut merged, first] = [2, 0].map(|start| {
            session.start_at(start);
            (0..2).for_each(|_| assert!(session.step(&())));
            session.take_film().expect("the film is small").0
        });
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

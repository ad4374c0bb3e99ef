//! Films that keep layers: their bits, and what they can be merged with.

use super::{FEATURES, settings};
use crate::common::prelude::*;
use crate::common::rooms::room;
use bidir::film::{Aov, MergeError};

#[test]
fn layers_have_the_same_bits_in_any_order() {
    let scene = room(0.1);
    let layers = Layers::new(&FEATURES, scene.group_names(), 5).with_raw();
    for (name, integrator) in IntegratorKind::NAMES {
        let settings = settings(integrator, layers.clone());
        let one = scene.film(&settings, 4, 1);
        let mut session = scene.session(settings, 3);
        let [mut merged, first] = [2, 0].map(|start| {
            session.start_at(start);
            steps(&mut session, 2);
            session.take_film().expect("the film is small").0
        });
        merged.merge(&first).expect("other passes");
        assert!(merged == one, "{name}");
    }
}

#[test]
fn films_of_other_layers_are_not_merged() {
    let scene = room(0.1);
    let film = |aov| {
        let layers = Layers::new(&[aov], &[], 0);
        scene.film(&settings(IntegratorKind::Path, layers), 1, 1)
    };
    let mut depth = film(Aov::Depth);
    assert_eq!(depth.merge(&film(Aov::Albedo)), Err(MergeError::Layers));
}

//! The identity of an experiment: a hash of everything that its records depend on, except their times.

use super::loaded_scene::{LoadedScene, Reference};
use super::settings::texts;
use super::{Experiment, ReferenceSpec};
use crate::image::digest;
use crate::seal::sha256;
use bidir::ESTIMATOR_VERSION;
use std::fmt::Write;

/// Computes the hash of an experiment; `given` holds the existing reference of each scene, if any.
///
/// The hash excludes threads and machine, which change only times.
pub(super) fn identity(
    experiment: &Experiment,
    scenes: &[LoadedScene<'_>],
    given: &[Option<Reference>],
) -> String {
    let mut text = format!(
        "estimator {ESTIMATOR_VERSION}\nseeds {:?}\nmetrics {:?}\nbudgets {:?}\n",
        experiment.seeds, experiment.metrics, experiment.budgets
    );
    for (loaded, given) in scenes.iter().zip(given) {
        let reference = reference(&loaded.spec.reference, given.as_ref());
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "scene {:?} {} {:?} {reference}",
            loaded.spec.name,
            loaded.subject.digest,
            loaded.size(),
        );
        for method in experiment.methods_in(&loaded.spec.name) {
            let settings = texts(&method.request.apply(&loaded.settings));
            let _ = writeln!(text, "method {:?} {settings:?}", method.name);
        }
    }
    sha256(text.as_bytes())
}

/// Identifies an existing reference by its pixels, and any other by the way it is made.
fn reference(spec: &ReferenceSpec, given: Option<&Reference>) -> String {
    match given {
        Some(given) => format!("pixels {}", digest(&[&given.pixels])),
        None => format!("{spec:?}"),
    }
}

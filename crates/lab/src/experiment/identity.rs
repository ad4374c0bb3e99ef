//! What makes an experiment this one: all that its records depend on, but for their times.

use super::settings::texts;
use super::stage::{Reference, Stage};
use super::{Experiment, ReferenceSpec};
use crate::image::digest;
use crate::seal::sha256;
use bidir::ESTIMATOR_VERSION;
use std::fmt::Write;

/// The hash of an experiment; `given` has the references of the scenes that are there before it begins.
///
/// Threads and machine have no part in it: they change times only.
pub(super) fn identity(
    experiment: &Experiment,
    stages: &[Stage<'_>],
    given: &[Option<Reference>],
) -> String {
    let mut text = format!(
        "estimator {ESTIMATOR_VERSION}\nseeds {:?}\nmetrics {:?}\nbudgets {:?}\n",
        experiment.seeds, experiment.metrics, experiment.budgets
    );
    for (stage, given) in stages.iter().zip(given) {
        let reference = reference(&stage.spec.reference, given.as_ref());
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "scene {:?} {} {:?} {reference}",
            stage.spec.name,
            stage.digest,
            stage.size(),
        );
        for method in experiment.methods_in(&stage.spec.name) {
            let settings = texts(&method.changes.apply(&stage.settings));
            let _ = writeln!(text, "method {:?} {settings:?}", method.name);
        }
    }
    sha256(text.as_bytes())
}

/// One that is there is its pixels, wherever it lies; another is how it is made.
fn reference(spec: &ReferenceSpec, given: Option<&Reference>) -> String {
    match given {
        Some(given) => format!("pixels {}", digest(&[&given.pixels])),
        None => format!("{spec:?}"),
    }
}

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
/// Threads and machine are left out, as they change only times.
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
            loaded.digest,
            loaded.size(),
        );
        for method in experiment.methods_in(&loaded.spec.name) {
            let settings = texts(&method.request.apply(&loaded.settings));
            let _ = writeln!(text, "method {:?} {settings:?}", method.name);
        }
    }
    sha256(text.as_bytes())
}

/// The name of the cross-check in hashes, which existing folders of results contain.
const OLD_NAME: &str = "witness";

/// Identifies an existing reference by its pixels, and any other by the way it is made.
fn reference(spec: &ReferenceSpec, given: Option<&Reference>) -> String {
    match (given, spec) {
        (Some(given), _) => format!("pixels {}", digest(&[&given.pixels])),
        (
            None,
            ReferenceSpec::Make {
                spp,
                request,
                cross_check,
            },
        ) => format!("Make {{ spp: {spp}, changes: {request:?}, {OLD_NAME}: {cross_check:?} }}"),
        (None, _) => format!("{spec:?}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bidir::integrator::IntegratorKind;
    use bidir::settings::Request;

    #[test]
    fn made_references_are_identified_as_in_earlier_versions() {
        let request = Request::default();
        let expected = format!(
            "Make {{ spp: 16, changes: {request:?}, witness: Some({:?}) }}",
            IntegratorKind::Lvc
        );
        let spec = ReferenceSpec::Make {
            spp: 16,
            request: Box::new(request),
            cross_check: Some(IntegratorKind::Lvc),
        };
        assert_eq!(reference(&spec, None), expected);
    }
}

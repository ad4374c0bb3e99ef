//! Experiments in parts: each in a folder of its own, with its own records, and all of them one result.

use crate::experiment::{Experiment, ExperimentError, Observer, Outcome, Setup, run as render};
use crate::results::{FORMAT, Record, Results};

/// Runs a part in its folder below that of all.
///
/// Errors: as of [`render`].
pub(crate) fn run(
    experiment: &Experiment,
    folder: &str,
    setup: &Setup,
    observer: &mut dyn Observer,
) -> Result<Outcome, ExperimentError> {
    let setup = Setup {
        folder: setup.folder.join(folder),
        ..setup.clone()
    };
    render(experiment, &setup, observer)
}

/// The result of no part.
pub(crate) fn empty(title: &str, description: &str, setup: &Setup) -> Results {
    Results {
        format: FORMAT,
        title: title.to_owned(),
        description: description.to_owned(),
        program: setup.program.clone(),
        machine: setup.machine.clone(),
        scenes: Vec::new(),
        methods: Vec::new(),
        budgets: Vec::new(),
        records: Vec::new(),
        pyramids: Vec::new(),
        claims: Vec::new(),
    }
}

/// With what a part found in its folder: names of images begin in the folder of all, and `shows` tells
/// of which records they are named at all. Methods and budgets of one name are one.
pub(crate) fn with(
    mut all: Results,
    folder: &str,
    part: Results,
    shows: impl Fn(&Record) -> bool,
) -> Results {
    let moved = |image: String| format!("{folder}/{image}");
    all.machine.threads = part.machine.threads;
    for mut scene in part.scenes {
        scene.reference_image = scene.reference_image.map(moved);
        all.scenes.push(scene);
    }
    for mut record in part.records {
        record.image = record.image.take().filter(|_| shows(&record)).map(moved);
        all.records.push(record);
    }
    for mut pyramid in part.pyramids {
        pyramid.weighted = moved(pyramid.weighted);
        pyramid.raw = moved(pyramid.raw);
        all.pyramids.push(pyramid);
    }
    for method in part.methods {
        if all.methods.iter().all(|known| known.name != method.name) {
            all.methods.push(method);
        }
    }
    for budget in part.budgets {
        if all.budgets.iter().all(|known| known.name != budget.name) {
            all.budgets.push(budget);
        }
    }
    all
}

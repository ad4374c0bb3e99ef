//! Experiments in parts: each in a folder of its own, with its own records, and all of them one result.

use crate::experiment::{
    Experiment, ExperimentError, Observer, Outcome, Setup, claim, run as render,
};
use crate::results::{FORMAT, Record, Results};

/// Makes the folder of all, which is then that of the experiment `name` alone.
///
/// Errors: it cannot be made, or is that of another experiment and not begun anew.
pub(crate) fn begin(name: &str, setup: &Setup) -> Result<(), ExperimentError> {
    let path = setup.folder.clone();
    std::fs::create_dir_all(&path).map_err(|error| ExperimentError::Folder { path, error })?;
    claim(name, setup)
}

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
        pyramid.images = moved(pyramid.images);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::Start;
    use crate::results::Machine;

    #[test]
    fn a_folder_is_of_one_experiment_until_it_is_begun_anew() {
        let folder = tempfile::tempdir().unwrap();
        let mut setup = Setup {
            folder: folder.path().join("out"),
            start: Start::Resume,
            program: "test".to_owned(),
            machine: Machine::default(),
        };
        begin("paper", &setup).unwrap();
        begin("paper", &setup).unwrap();
        let error = begin("beyond", &setup).unwrap_err();
        assert!(matches!(error, ExperimentError::Mismatch(_)), "{error}");
        // Which of its parts are of another program they say themselves.
        setup.program = "another".to_owned();
        begin("paper", &setup).unwrap();
        setup.start = Start::Anew;
        begin("beyond", &setup).unwrap();
        setup.start = Start::Resume;
        assert!(begin("paper", &setup).is_err());
    }
}

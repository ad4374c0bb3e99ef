//! The files that an experiment writes; they never replace a file that it reads.

use super::error::ExperimentError;
use super::loaded_scene::LoadedScene;
use super::run::image_name;
use super::run_set::Setup;
use super::{Experiment, PAGE, ReferenceSpec, journal, pyramid, reference};
use formats::outputs::Output;
use std::path::{Path, PathBuf};

type Result<T> = std::result::Result<T, ExperimentError>;

/// The name of the results file.
pub(super) const RESULTS: &str = "results.json";

/// Fails if the results in `folder` would replace the description `file`.
pub fn check_description(file: &Path, folder: &Path) -> Result<()> {
    check_all([file], &always(folder))
}

/// Fails if a file of the results would replace a file of a scene or of an existing reference, or another
/// file of the results.
pub(super) fn check(
    experiment: &Experiment,
    scenes: &[LoadedScene<'_>],
    setup: &Setup,
) -> Result<()> {
    let mut written = always(&setup.folder);
    let images = scenes.iter().flat_map(|loaded| images(experiment, loaded));
    let strategies = pyramid::files(experiment, scenes);
    written.extend(images.chain(strategies).map(|name| setup.folder.join(name)));
    for loaded in scenes {
        written.extend(reference::written(loaded, setup));
    }
    let given = scenes.iter().flat_map(given);
    let inputs = scenes
        .iter()
        .flat_map(|loaded| loaded.read.inputs.iter().cloned());
    let read: Vec<_> = inputs.chain(given).collect();
    check_all(read.iter().map(PathBuf::as_path), &written)
}

fn check_all<'a>(read: impl IntoIterator<Item = &'a Path>, written: &[PathBuf]) -> Result<()> {
    let files = written.iter().map(|path| Output {
        path,
        flag: Some("--output"),
    });
    let outputs: Vec<_> = files.collect();
    Ok(formats::outputs::check(read, &outputs)?)
}

/// Returns the files that every experiment writes.
fn always(folder: &Path) -> Vec<PathBuf> {
    [journal::FILE, RESULTS, PAGE]
        .map(|name| folder.join(name))
        .into()
}

/// Returns the names of the images of a scene. Only runs with the first seed have images.
fn images(experiment: &Experiment, loaded: &LoadedScene<'_>) -> Vec<String> {
    let renders = experiment.renders(&loaded.spec.name);
    let images = renders.map(|(budget, method)| image_name(loaded.spec, budget, method));
    images.collect()
}

/// Returns the files of an existing reference.
fn given(loaded: &LoadedScene<'_>) -> Vec<PathBuf> {
    match &loaded.spec.reference {
        ReferenceSpec::Existing(path) if path.is_dir() => crate::reference::files(path),
        ReferenceSpec::Existing(path) => vec![path.clone()],
        ReferenceSpec::Make(_) | ReferenceSpec::Of(_) => Vec::new(),
    }
}

//! Settings by their names: those of the flags of `bidir render`.

use crate::error::raise;
use bidir::driver::{Settings, Threads};
use bidir::film::{Aov, Layers};
use bidir::integrator::IntegratorKind;
use bidir::names::UnknownName;
use bidir::settings::Request;
use formats::scene::SceneSettings;
use pyo3::exceptions::PyRuntimeWarning;
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::ffi::CString;

/// Settings that differ from the scene's, as texts.
pub(crate) type Texts = BTreeMap<String, String>;

/// What the file of a scene says, over the defaults.
pub(crate) fn of_scene(scene: &SceneSettings) -> Settings {
    let mut settings = Settings {
        sampler: scene.sampler,
        seed: scene.seed.unwrap_or_default(),
        layers: Layers::new(&scene.aovs, &[], 0),
        ..Settings::new(scene.integrator)
    };
    settings.path.max_depth = Some(scene.max_depth);
    settings
}

/// What a caller wants of a render.
#[derive(FromPyObject)]
pub(crate) struct Wanted {
    /// Of the estimator, by name.
    #[pyo3(item)]
    settings: Texts,
    /// The seed. None: the scene's.
    #[pyo3(item)]
    seed: Option<u64>,
    /// Names of images beside the picture.
    #[pyo3(item)]
    layers: Vec<String>,
    /// The light groups that have images.
    #[pyo3(item)]
    light_groups: Vec<String>,
    /// The most vertices of paths whose strategies have images.
    #[pyo3(item)]
    strategy_layers: usize,
}

/// The settings of a render of a scene whose own are `scene`.
///
/// Errors: a name or value that is not known, as `SettingsError`.
pub(crate) fn resolve(py: Python<'_>, wanted: &Wanted, scene: &Settings) -> PyResult<Settings> {
    let mut settings = changes(py, &wanted.settings)?.apply(scene);
    settings.seed = wanted.seed.unwrap_or(settings.seed);
    let mut aovs = scene.layers.aovs().to_vec();
    for name in &wanted.layers {
        let aov: Result<Aov, UnknownName> = name.parse();
        aovs.push(aov.map_err(|error| raise(py, "SettingsError", &format!("layers: {error}")))?);
    }
    settings.layers = Layers::new(&aovs, &wanted.light_groups, wanted.strategy_layers);
    Ok(settings)
}

/// As many threads as are asked for, with a warning where there are fewer.
///
/// Errors: more than may be asked for, as `SettingsError`.
pub(crate) fn threads_of(py: Python<'_>, asked: usize) -> PyResult<Threads> {
    let most = Threads::MOST;
    if asked > most {
        let message = format!("threads: expected a whole number up to {most}, not {asked}");
        return Err(raise(py, "SettingsError", &message));
    }
    let threads = Threads::new(asked);
    threads.warning().map_or(Ok(()), |text| warn(py, &text))?;
    Ok(threads)
}

/// Warns the caller of the package.
pub(crate) fn warn(py: Python<'_>, text: &str) -> PyResult<()> {
    let text = CString::new(text)?;
    PyErr::warn(py, &py.get_type::<PyRuntimeWarning>(), &text, 2)
}

/// The request of texts.
fn changes(py: Python<'_>, texts: &Texts) -> PyResult<Request> {
    let mut changes = Request::default();
    for (name, value) in texts {
        changes.set(name, value).map_err(|error| {
            let message = format!("{}: {error}", name.replace('-', "_"));
            raise(py, "SettingsError", &message)
        })?;
    }
    Ok(changes)
}

/// The names of the settings that images by an integrator depend on, as flags are spelt.
///
/// Errors: there is no such integrator, as `SettingsError`.
#[pyfunction]
pub(crate) fn settings_of(py: Python<'_>, integrator: &str) -> PyResult<Vec<String>> {
    let kind: Result<IntegratorKind, UnknownName> = integrator.parse();
    let kind = kind.map_err(|error| raise(py, "SettingsError", &error.to_string()))?;
    let texts = lab::experiment::texts(&Settings::new(kind));
    Ok(texts.into_keys().collect())
}

/// Fails where a setting has a value that is not known; returns all of them as they are understood.
#[pyfunction]
pub(crate) fn check_settings(py: Python<'_>, settings: Texts) -> PyResult<Texts> {
    let changes = changes(py, &settings)?;
    Ok(changes.texts())
}

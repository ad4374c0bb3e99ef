//! Settings by the names of the flags of `bidir render`.

use crate::error::raise;
use bidir::driver::{Settings, Threads};
use bidir::film::{Aov, Layers};
use bidir::integrator::IntegratorKind;
use bidir::names::UnknownName;
use bidir::settings::Request;
use pyo3::exceptions::PyRuntimeWarning;
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::ffi::CString;

/// Returns the names of layers in files, by their names in calls.
pub(crate) fn layer_names() -> BTreeMap<&'static str, &'static str> {
    let named = Aov::NAMES.into_iter().filter_map(|(name, aov)| {
        let first = aov.channels().first()?;
        let alone = first.names.first().copied()?;
        Some((
            name,
            if first.layer.is_empty() {
                alone
            } else {
                first.layer
            },
        ))
    });
    named.collect()
}

/// Settings as texts by name.
pub(crate) type Texts = BTreeMap<String, String>;

/// The settings of a render that a caller requests.
#[derive(FromPyObject)]
pub(crate) struct Requested {
    /// Settings of the estimator by name.
    #[pyo3(item)]
    settings: Texts,
    /// The seed. None: the scene's.
    #[pyo3(item)]
    seed: Option<u64>,
    /// Names of layers.
    #[pyo3(item)]
    layers: Vec<String>,
    /// The light groups with layers.
    #[pyo3(item)]
    light_groups: Vec<String>,
    /// The largest number of vertices of paths whose strategies have layers.
    #[pyo3(item)]
    strategy_layers: usize,
}

/// Returns the settings of a render: the requested ones, and else those of its scene.
///
/// Errors: an unknown name or value, as `SettingsError`.
pub(crate) fn resolve(
    py: Python<'_>,
    requested: &Requested,
    scene: &Settings,
) -> PyResult<Settings> {
    let mut settings = request_of(py, &requested.settings)?.apply(scene);
    settings.seed = requested.seed.unwrap_or(settings.seed);
    let mut aovs = scene.layers.aovs().to_vec();
    for name in &requested.layers {
        let aov: Result<Aov, UnknownName> = name.parse();
        aovs.push(aov.map_err(|error| raise(py, "SettingsError", &format!("layers: {error}")))?);
    }
    let groups = &requested.light_groups;
    settings.layers = Layers::new(&aovs, groups, requested.strategy_layers);
    Ok(settings)
}

/// Returns the number of threads, and warns if it was reduced.
///
/// Errors: the number exceeds the limit, as `SettingsError`.
pub(crate) fn threads_of(py: Python<'_>, requested: usize) -> PyResult<Threads> {
    let most = Threads::MOST;
    if requested > most {
        let message = format!("threads: expected a whole number up to {most}, not {requested}");
        return Err(raise(py, "SettingsError", &message));
    }
    let threads = Threads::new(requested);
    threads.warning().map_or(Ok(()), |text| warn(py, &text))?;
    Ok(threads)
}

/// Warns the caller of the package.
pub(crate) fn warn(py: Python<'_>, text: &str) -> PyResult<()> {
    let text = CString::new(text)?;
    PyErr::warn(py, &py.get_type::<PyRuntimeWarning>(), &text, 2)
}

/// Parses settings.
fn request_of(py: Python<'_>, texts: &Texts) -> PyResult<Request> {
    let mut request = Request::default();
    for (name, value) in texts {
        request.set(name, value).map_err(|error| {
            let message = format!("{}: {error}", name.replace('-', "_"));
            raise(py, "SettingsError", &message)
        })?;
    }
    Ok(request)
}

/// Returns the names of the settings that images of an integrator depend on, spelt as flags.
///
/// Errors: the integrator is unknown, as `SettingsError`.
#[pyfunction]
pub(crate) fn settings_of(py: Python<'_>, integrator: &str) -> PyResult<Vec<String>> {
    let parsed: Result<IntegratorKind, UnknownName> = integrator.parse();
    let kind = parsed.map_err(|error| raise(py, "SettingsError", &error.to_string()))?;
    let texts = lab::experiment::texts(&Settings::new(kind));
    Ok(texts.into_keys().collect())
}

/// Checks settings, and returns them in normal form.
///
/// Errors: an unknown name or value, as `SettingsError`.
#[pyfunction]
pub(crate) fn check_settings(py: Python<'_>, settings: Texts) -> PyResult<Texts> {
    Ok(request_of(py, &settings)?.texts())
}

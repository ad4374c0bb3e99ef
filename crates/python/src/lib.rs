//! The native module behind the Python package `bidir`.
//!
//! - It is internal: `python/bidir` has the public classes with their documentation, and
//!   `python/bidir/_bidir.pyi` the types of this module.
//! - Arrays pass as bytes: 32-bit little-endian numbers row by row. Only Python uses numpy.
//! - Long operations let other Python threads run, and check for signals meanwhile (`wait`).
//! - Exceptions are the classes of `bidir.errors` (`error`).

#![expect(
    clippy::needless_pass_by_value,
    reason = "arguments from Python are converted to owned values"
)]

mod cluster;
mod error;
mod experiment;
mod film;
mod image;
mod scene;
mod session;
mod settings;
mod wait;

use pyo3::prelude::*;

/// The native half of `bidir`.
#[pymodule]
mod _bidir {
    #[pymodule_export]
    use super::cluster::{Prepared, machine, render_block};
    #[pymodule_export]
    use super::error::printable_text;
    #[pymodule_export]
    use super::experiment::Experiment;
    #[pymodule_export]
    use super::film::Film;
    #[pymodule_export]
    use super::image::{encode_png, error_map, metric, read_image, read_layers, write_image};
    #[pymodule_export]
    use super::scene::Scene;
    #[pymodule_export]
    use super::session::Session;
    #[pymodule_export]
    use super::settings::{check_settings, settings_of};
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("VERSION", env!("CARGO_PKG_VERSION"))?;
        module.add("ESTIMATOR_VERSION", bidir::ESTIMATOR_VERSION)?;
        module.add("ISA", bidir::scene::Isa::detect().name())?;
        let metrics = lab::metric::Metric::NAMES.map(|(name, _)| name);
        module.add("METRICS", metrics.to_vec())?;
        let layers = bidir::film::Aov::NAMES.map(|(name, _)| name);
        module.add("LAYERS", layers.to_vec())?;
        module.add("LAYER_NAMES", super::settings::layer_names())?;
        let most = bidir::film::Layers::MOST_STRATEGY_VERTICES;
        module.add("MOST_STRATEGY_VERTICES", most)
    }
}

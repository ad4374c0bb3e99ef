//! Experiments on several machines: the functions of the driver and of the nodes.

use crate::error::{of_experiment, raise};
use crate::experiment::{Experiment, Message, Reporter};
use crate::film::bytes;
use crate::image::pixels;
use crate::scene::{MemoryFile, in_memory};
use crate::wait::{beside, wait};
use formats::scene::Files;
use lab::experiment::{self, Block, Done, PreparedScene};
use lab::results::Machine;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::path::PathBuf;

/// Describes this machine, on which times depend. Returns JSON.
#[pyfunction]
pub(crate) fn machine() -> String {
    serde_json::to_string(&Machine::here()).unwrap_or_default()
}

/// An experiment with complete references.
#[pyclass(frozen, module = "bidir._bidir")]
pub(crate) struct Prepared(pub(crate) experiment::Prepared);

/// A scene: name, file, all files; size and pixels of the reference.
type SceneTuple<'py> = (
    String,
    PathBuf,
    Vec<PathBuf>,
    [usize; 2],
    Bound<'py, PyBytes>,
);
/// A record as JSON, and the pixels of its image.
type DoneTuple<'py> = (String, Option<([usize; 2], Bound<'py, PyBytes>)>);

fn wrong(py: Python<'_>, error: &serde_json::Error) -> PyErr {
    raise(
        py,
        "ExperimentError",
        &format!("not a part of an experiment: {error}"),
    )
}

#[pymethods]
impl Prepared {
    /// Returns the scenes.
    #[getter]
    fn scenes<'py>(&self, py: Python<'py>) -> PyResult<Vec<SceneTuple<'py>>> {
        let tuple = |scene: &PreparedScene| {
            let PreparedScene {
                name,
                path,
                files,
                reference,
            } = scene;
            let data = bytes(py, reference.data.as_flattened())?;
            Ok((
                name.clone(),
                path.clone(),
                files.clone(),
                reference.size,
                data,
            ))
        };
        self.0.scenes.iter().map(tuple).collect()
    }

    /// Returns the blocks without a record, as JSON.
    #[getter]
    fn blocks(&self) -> Vec<String> {
        let blocks = self.0.blocks.iter();
        blocks
            .filter_map(|block| serde_json::to_string(block).ok())
            .collect()
    }

    /// Adds the results of `render_block`.
    fn add(&self, py: Python<'_>, done: Vec<DoneTuple<'_>>) -> PyResult<()> {
        let read = |(record, image): DoneTuple<'_>| {
            let image = image.map(|(size, data)| pixels(py, size, data.as_bytes()));
            Ok(Done {
                record: serde_json::from_str(&record).map_err(|error| wrong(py, &error))?,
                image: image.transpose()?,
            })
        };
        let done = done.into_iter().map(read).collect::<PyResult<Vec<_>>>()?;
        let added = beside(py, || self.0.add(done));
        added.map_err(|error| of_experiment(py, &error))
    }
}

/// Renders a block, given as JSON, with the files and the reference of its scene.
#[pyfunction]
pub(crate) fn render_block<'py>(
    py: Python<'py>,
    experiment: &Experiment,
    block: &str,
    files: Vec<MemoryFile>,
    reference: ([usize; 2], Vec<u8>),
) -> PyResult<Vec<DoneTuple<'py>>> {
    let block: Block = serde_json::from_str(block).map_err(|error| wrong(py, &error))?;
    let reference = pixels(py, reference.0, &reference.1)?;
    let files = Files::only(in_memory(files));
    let silent = |_: Python<'_>, _: Message| Ok(());
    let rendered = wait(py, None, silent, |stop, sender| {
        let mut reporter = Reporter::new(stop, sender);
        let experiment = &experiment.experiment;
        experiment::render_block(experiment, &block, &files, &reference, &mut reporter)
    })?;
    let done = rendered.map_err(|error| of_experiment(py, &error))?;
    let tuple = |Done { record, image }| {
        let record = serde_json::to_string(&record).map_err(|error| wrong(py, &error))?;
        let image = match image {
            Some(image) => Some((image.size, bytes(py, image.data.as_flattened())?)),
            None => None,
        };
        Ok((record, image))
    };
    done.unwrap_or_default().into_iter().map(tuple).collect()
}

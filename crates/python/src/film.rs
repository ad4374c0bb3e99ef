//! Films: exact sums, and the images developed from them.

use crate::error::{of_file, raise};
use crate::scene::Scene;
use crate::wait::{beside, try_beside};
use bidir::film::PassSet;
use formats::film::{
    self, FilmFile, counts_by_name, decode, encode, is_film, metadata, read, write,
};
use formats::outputs::{self, Output};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The exact sums of some passes of a render, with the identity of the render.
#[pyclass(frozen, module = "bidir._bidir")]
pub(crate) struct Film {
    file: FilmFile,
    inputs: Inputs,
}

/// The absolute names of the files that were read for a film. Its outputs must not replace them.
pub(crate) type Inputs = BTreeSet<PathBuf>;

/// Makes paths absolute, so that they stay valid if the working directory changes.
pub(crate) fn absolute(paths: impl IntoIterator<Item = PathBuf>) -> Inputs {
    let paths = paths.into_iter();
    paths
        .map(|path| std::path::absolute(&path).unwrap_or(path))
        .collect()
}

/// Converts passes to ranges, each with its exclusive end.
pub(crate) fn ranges(passes: &PassSet) -> Vec<(u64, u64)> {
    let ranges = passes.ranges().iter();
    ranges.map(|range| (range.start, range.end)).collect()
}

/// Converts numbers to bytes.
pub(crate) fn bytes<'py>(py: Python<'py>, numbers: &[f32]) -> PyResult<Bound<'py, PyBytes>> {
    PyBytes::new_with(py, size_of_val(numbers), |bytes| {
        for (to, number) in bytes.chunks_exact_mut(4).zip(numbers) {
            to.copy_from_slice(&number.to_le_bytes());
        }
        Ok(())
    })
}

/// A layer: its name, the names of the channels, their interleaved numbers.
type Layer<'py> = (String, Vec<&'static str>, Bound<'py, PyBytes>);

/// Width and height, the image, the variance, and the layers.
type Developed<'py> = (
    [usize; 2],
    Bound<'py, PyBytes>,
    Bound<'py, PyBytes>,
    Vec<Layer<'py>>,
);

impl Film {
    pub(crate) fn new(file: FilmFile, inputs: Inputs) -> Self {
        Self { file, inputs }
    }

    pub(crate) fn file(&self) -> &FilmFile {
        &self.file
    }

    pub(crate) fn inputs(&self) -> &Inputs {
        &self.inputs
    }

    /// Fails if `path` is one of these files.
    fn check_apart<'a>(
        py: Python<'_>,
        inputs: impl Iterator<Item = &'a PathBuf>,
        path: &Path,
    ) -> PyResult<()> {
        let output = Output { path, flag: None };
        let checked = outputs::check(inputs.map(PathBuf::as_path), &[output]);
        checked.map_err(|error| of_file(py, &error))
    }
}

#[pymethods]
impl Film {
    /// Reads a film file.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let file = try_beside(py, || read(&path))?;
        let inputs = absolute([path]);
        Ok(Self { file, inputs })
    }

    /// Reads the bytes of a film file. Outputs of the film must not replace the files of `scene`.
    #[staticmethod]
    #[pyo3(signature = (data, scene=None))]
    fn from_bytes(py: Python<'_>, data: &[u8], scene: Option<&Scene>) -> PyResult<Self> {
        let file = try_beside(py, || decode(data))?;
        let inputs = scene.map(|scene| scene.inputs.clone()).unwrap_or_default();
        Ok(Self { file, inputs })
    }

    /// Encodes a film file.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let encoded = try_beside(py, || encode(&self.file.header, &self.file.film))?;
        Ok(PyBytes::new(py, &encoded))
    }

    /// Writes a film file; it may replace a film that it was made from.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let others = self.inputs.iter().filter(|input| !is_film(input));
        Self::check_apart(py, others, &path)?;
        try_beside(py, || write(&path, &self.file.header, &self.file.film))
    }

    /// Merges two films.
    fn merged(&self, py: Python<'_>, other: &Self) -> PyResult<Self> {
        let inputs = &self.inputs | &other.inputs;
        let merged = beside(py, || {
            let mut file = self.file.clone();
            file.merge(&other.file).map(|()| file)
        });
        let file = merged.map_err(|error| raise(py, "FilmError", &error.to_string()))?;
        Ok(Self { file, inputs })
    }

    /// Returns true if both have the same passes of the same render, bit for bit.
    fn equals(&self, py: Python<'_>, other: &Self) -> bool {
        let (a, b) = (&self.file, &other.file);
        a.header.identity == b.header.identity && beside(py, || a.film == b.film)
    }

    /// Develops the image and its layers.
    fn develop<'py>(&self, py: Python<'py>) -> PyResult<Developed<'py>> {
        let film = &self.file.film;
        let (picture, layers) = beside(py, || (film.develop(), film.develop_layers()));
        let layers = layers.into_iter().map(|layer| {
            let data = bytes(py, &layer.data)?;
            Ok((layer.name, layer.channels.to_vec(), data))
        });
        Ok((
            [picture.width, picture.height],
            bytes(py, picture.pixels.as_flattened())?,
            bytes(py, picture.variance.as_flattened())?,
            layers.collect::<PyResult<_>>()?,
        ))
    }

    /// Writes the image: as EXR with its layers and attributes, or as PNG without them.
    fn write_image(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        Self::check_apart(py, self.inputs.iter(), &path)?;
        let FilmFile { header, film } = &self.file;
        try_beside(py, || {
            film::Developed::new(film).write(&path, film.settings(), &metadata(header))
        })
    }

    /// Returns the passes, each range with its exclusive end.
    #[getter]
    fn passes(&self) -> Vec<(u64, u64)> {
        ranges(self.file.film.passes())
    }

    /// Returns the hash of everything that the bits depend on, except the passes.
    #[getter]
    fn identity(&self) -> &str {
        &self.file.header.identity
    }

    /// Returns the contents of the identity by name.
    #[getter]
    fn settings(&self) -> BTreeMap<String, String> {
        self.file.header.settings.clone()
    }

    /// Returns the name of the scene file.
    #[getter]
    fn scene(&self) -> String {
        self.file.header.scene_name()
    }

    /// Returns the stopping rule.
    #[getter]
    fn stopping(&self) -> &'static str {
        self.file.header.stopping.name()
    }

    /// Returns the render time. Unit: seconds.
    #[getter]
    fn seconds(&self) -> f64 {
        self.file.header.seconds
    }

    /// Returns the counters by name.
    #[getter]
    fn counts(&self) -> BTreeMap<String, u64> {
        let counts = counts_by_name(&self.file.header).into_iter();
        let parsed = counts.filter_map(|(name, count)| Some((name, count.parse().ok()?)));
        parsed.collect()
    }

    /// Returns the estimated relative error of the image.
    #[getter]
    fn noise(&self, py: Python<'_>) -> f64 {
        beside(py, || self.file.film.develop().relative_error())
    }
}

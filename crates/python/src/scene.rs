//! Scenes.

use crate::error::{of_file, raise};
use crate::film::{Inputs, absolute};
use crate::wait::wait_silently;
use bidir::driver::Settings;
use bidir::film::FilmError;
use formats::scene::{Crop, Files, InMemory, LoadOptions, Loaded, load_from};
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

/// A scene in memory, with the settings of its file.
#[pyclass(frozen, module = "bidir._bidir")]
pub(crate) struct Scene {
    /// The scene that was read.
    pub(crate) loaded: Loaded,
    /// The settings of the file, or else the defaults.
    pub(crate) settings: Settings,
    /// The files on the disk that the scene reads or names.
    pub(crate) inputs: Inputs,
}

/// The names of one file, and its bytes.
pub(crate) type MemoryFile = (Vec<PathBuf>, Vec<u8>);

/// The options of reading a scene.
#[derive(FromPyObject)]
pub(crate) struct Source {
    /// True to replace unsupported features by simpler ones.
    #[pyo3(item)]
    lenient: bool,
    /// Width and height of the film. None: the file gives them.
    #[pyo3(item)]
    size: Option<[u32; 2]>,
    /// Left, top, right, bottom of the rendered rectangle. None: the file gives it.
    #[pyo3(item)]
    crop: Option<[u32; 4]>,
    /// Files in memory, which replace those on the disk.
    #[pyo3(item)]
    memory: Vec<MemoryFile>,
    /// True to ignore the disk and read only files in memory.
    #[pyo3(item)]
    sealed: bool,
}

pub(crate) fn in_memory(files: Vec<MemoryFile>) -> InMemory {
    let mut memory = InMemory::new();
    for (names, bytes) in files {
        let bytes: Arc<[u8]> = bytes.into();
        memory.extend(names.into_iter().map(|name| (name, Arc::clone(&bytes))));
    }
    memory
}

impl Scene {
    /// Returns the error of a film that is too large, at the place that gives its size.
    pub(crate) fn too_large(&self, py: Python<'_>, error: &FilmError) -> PyErr {
        let error = self.loaded.too_large(error);
        let argument = if error.has_place() { "" } else { "size: " };
        raise(py, "RenderError", &format!("{argument}{error}"))
    }
}

#[pymethods]
impl Scene {
    /// Reads a scene; see `bidir.load`.
    #[new]
    fn new(py: Python<'_>, path: PathBuf, source: Source) -> PyResult<Self> {
        let crop = source.crop;
        let options = LoadOptions {
            lenient: source.lenient,
            resolution: source.size,
            crop: crop.map(|[x0, y0, x1, y1]| Crop::Pixels([x0, x1, y0, y1])),
            ..LoadOptions::default()
        };
        let memory = in_memory(source.memory);
        let files = if source.sealed {
            Files::only(memory)
        } else {
            Files::over_disk(memory)
        };
        let read = wait_silently(py, None, |_| load_from(&path, &options, &files))?;
        let loaded = read.map_err(|error| of_file(py, &error))?;
        Ok(Self {
            settings: loaded.settings.render_settings(),
            inputs: absolute(loaded.inputs.iter().cloned()),
            loaded,
        })
    }

    /// Returns the hash of everything read.
    #[getter]
    fn digest(&self) -> String {
        self.loaded.digest.to_string()
    }

    /// Returns the file, as it was named.
    #[getter]
    fn name(&self) -> &str {
        &self.loaded.name
    }

    /// Returns the samples per pixel that the file sets.
    #[getter]
    fn spp(&self) -> u32 {
        self.loaded.settings.samples_per_pixel
    }

    /// Returns warnings about the file.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.loaded.warnings.clone()
    }

    /// Returns the files read, under every name that refers to them.
    #[getter]
    fn files(&self) -> Vec<PathBuf> {
        self.loaded.files.clone()
    }

    /// Returns width and height of the whole film.
    #[getter]
    fn resolution(&self) -> [u32; 2] {
        self.loaded.view.film().resolution
    }

    /// Returns left, top, right, bottom of the rendered rectangle.
    #[getter]
    fn crop(&self) -> [u32; 4] {
        let crop = self.loaded.view.film().crop;
        [crop.min[0], crop.min[1], crop.max[0], crop.max[1]]
    }

    /// Returns the names of the light groups.
    #[getter]
    fn light_groups(&self) -> Vec<String> {
        self.loaded.scene.group_names().to_vec()
    }

    /// Returns the settings of the file by name.
    #[getter]
    fn settings(&self) -> BTreeMap<String, String> {
        lab::experiment::texts(&self.settings)
    }

    /// Returns the counts of the scene's parts by name.
    #[getter]
    fn summary(&self) -> BTreeMap<String, u64> {
        let counts = serde_json::to_value(self.loaded.summary).unwrap_or_default();
        serde_json::from_value(counts).unwrap_or_default()
    }
}

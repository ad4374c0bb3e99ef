//! Scenes.

use crate::error::of_file;
use crate::film::{Inputs, absolute};
use crate::settings;
use crate::wait::wait_silently;
use bidir::driver::Settings;
use formats::scene::{Crop, Files, InMemory, LoadOptions, Summary, load_from};
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

/// A scene that was read, with what else its file says.
#[pyclass(frozen, module = "bidir._bidir")]
pub(crate) struct Scene {
    pub(crate) shared: Arc<bidir::scene::Scene>,
    /// The settings of the file, over the defaults.
    pub(crate) settings: Settings,
    /// The file, as it was named.
    pub(crate) name: String,
    pub(crate) digest: String,
    spp: u64,
    warnings: Vec<String>,
    summary: Summary,
    files: Vec<PathBuf>,
    /// The files on the disk that it reads or names.
    pub(crate) inputs: Inputs,
}

/// Names of one file, and its bytes.
pub(crate) type MemoryFile = (Vec<PathBuf>, Vec<u8>);

/// How a scene is read.
#[derive(FromPyObject)]
pub(crate) struct Source {
    /// Whether something simpler may stand in for what is not supported.
    #[pyo3(item)]
    lenient: bool,
    /// Width and height of the film, instead of the file's.
    #[pyo3(item)]
    size: Option<[u32; 2]>,
    /// Left, top, right, bottom of what is rendered, instead of the file's.
    #[pyo3(item)]
    crop: Option<[u32; 4]>,
    /// Files that are not on the disk, or other than there.
    #[pyo3(item)]
    memory: Vec<MemoryFile>,
    /// Whether others are missing, even if they are on the disk.
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
        let loaded = wait_silently(py, |_| load_from(&path, &options, &files))?;
        let loaded = loaded.map_err(|error| of_file(py, &error))?;
        Ok(Self {
            settings: settings::of_scene(&loaded.settings),
            shared: Arc::new(loaded.scene),
            name: path.display().to_string(),
            digest: loaded.digest.to_string(),
            spp: loaded.settings.samples_per_pixel.into(),
            warnings: loaded.warnings,
            summary: loaded.summary,
            files: loaded.files,
            inputs: absolute(loaded.inputs),
        })
    }

    /// The hash of all that was read.
    #[getter]
    fn digest(&self) -> &str {
        &self.digest
    }

    /// The file, as it was named.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// Samples per pixel that the file asks for.
    #[getter]
    fn spp(&self) -> u64 {
        self.spp
    }

    /// What is odd but no error.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    /// The files that were read, by each name that they were asked for.
    #[getter]
    fn files(&self) -> Vec<PathBuf> {
        self.files.clone()
    }

    /// Width and height of the whole film.
    #[getter]
    fn resolution(&self) -> [u32; 2] {
        self.shared.film().resolution
    }

    /// Left, top, right, bottom of what is rendered.
    #[getter]
    fn crop(&self) -> [u32; 4] {
        let crop = self.shared.film().crop;
        [crop.min[0], crop.min[1], crop.max[0], crop.max[1]]
    }

    /// The groups of lights.
    #[getter]
    fn light_groups(&self) -> Vec<String> {
        self.shared.group_names().to_vec()
    }

    /// The settings of the file, by name.
    #[getter]
    fn settings(&self) -> BTreeMap<String, String> {
        lab::experiment::texts(&self.settings)
    }

    /// What the scene is made of, by name.
    #[getter]
    fn summary(&self) -> BTreeMap<&'static str, u64> {
        let Summary {
            shapes,
            primitives,
            instances,
            materials,
            textures,
            area_lights,
            other_lights,
        } = self.summary;
        let counts = [
            ("shapes", shapes),
            ("instances", instances),
            ("materials", materials),
            ("textures", textures),
            ("area_lights", area_lights),
            ("other_lights", other_lights),
        ];
        let counts = counts.map(|(name, count)| (name, count as u64));
        counts
            .into_iter()
            .chain([("primitives", primitives)])
            .collect()
    }
}

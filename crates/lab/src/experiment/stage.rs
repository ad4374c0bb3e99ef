//! A scene that is ready to be rendered and compared.

use super::error::{ExperimentError, Place};
use super::run::{Event, Observer};
use super::{Experiment, MethodSpec, SceneSource, SceneSpec};
use crate::image::Pixels;
use crate::results::SceneInfo;
use bidir::driver::{Resources, Session, Settings};
use bidir::scene::Scene;
use formats::scene::{Files, LoadOptions};
use std::path::PathBuf;

/// A scene with what its file says.
pub(super) struct Stage<'a> {
    pub(super) spec: &'a SceneSpec,
    pub(super) scene: Scene,
    /// The settings of the file, over the defaults.
    pub(super) settings: Settings,
    pub(super) digest: String,
    /// What is odd in the file but no error.
    pub(super) warnings: Vec<String>,
    /// All files that were read.
    pub(super) files: Vec<PathBuf>,
    /// The files that no output may replace.
    pub(super) inputs: Vec<PathBuf>,
}

/// What the images of a scene are compared with.
#[derive(Clone)]
pub(super) struct Reference {
    pub(super) pixels: Pixels,
    /// How it was made.
    pub(super) words: String,
    /// The image, relative to the folder of the results, if it lies there.
    pub(super) image: Option<String>,
    /// The mean square error of its own. None: nobody knows.
    pub(super) mse: Option<f64>,
    /// Warnings about its files.
    pub(super) warning: Option<String>,
}

impl Reference {
    /// Tells what is odd about its files.
    pub(super) fn warn(&self, observer: &mut dyn Observer) {
        if let Some(warning) = &self.warning {
            observer.tell(Event::Warning(warning));
        }
    }
}

impl<'a> Stage<'a> {
    /// Reads a scene.
    pub(super) fn load(
        experiment: &Experiment,
        spec: &'a SceneSpec,
        files: &Files,
    ) -> Result<Self, ExperimentError> {
        // A room and files in memory are the same on every machine.
        let own = match &spec.source {
            SceneSource::Disk => None,
            SceneSource::Memory(files) => Some(files.clone()),
            SceneSource::Room(room) => Some(room.files()),
        };
        let files = own.as_ref().unwrap_or(files);
        let options = LoadOptions {
            resolution: spec.size.or(experiment.size),
            ..LoadOptions::default()
        };
        let loaded = formats::scene::load_from(&spec.path, &options, files);
        let loaded = loaded.map_err(|error| Place::of_named(spec.places[0].as_ref(), error))?;
        let mut settings = Settings {
            sampler: loaded.settings.sampler,
            ..Settings::default()
        };
        settings.set_integrator(loaded.settings.integrator);
        settings.path.max_depth = Some(loaded.settings.max_depth);
        Ok(Self {
            spec,
            scene: loaded.scene,
            settings,
            digest: loaded.digest.to_string(),
            warnings: loaded.warnings,
            files: loaded.files,
            inputs: loaded.inputs,
        })
    }

    /// The files that another machine needs to be given: none of those in memory.
    pub(super) fn shared_files(&self) -> Vec<PathBuf> {
        if self.spec.source == SceneSource::Disk {
            self.files.clone()
        } else {
            Vec::new()
        }
    }

    /// True where the method is rendered in this scene.
    pub(super) fn has(&self, experiment: &Experiment, method: &MethodSpec) -> bool {
        let mut methods = experiment.methods_in(&self.spec.name);
        methods.any(|other| other.name == method.name)
    }

    /// A session of this scene.
    pub(super) fn session(
        &self,
        settings: Settings,
        threads: usize,
    ) -> Result<Session<'_>, ExperimentError> {
        let resources = Resources {
            threads,
            ..Resources::default()
        };
        let session = Session::new(&self.scene, settings, &resources);
        session.map_err(|error| ExperimentError::Render {
            scene: self.spec.name.clone(),
            error,
        })
    }

    /// Width and height of the images. Unit: pixels.
    pub(super) fn size(&self) -> [usize; 2] {
        let crop = self.scene.film().crop;
        [crop.width() as usize, crop.height() as usize]
    }

    pub(super) fn info(&self, reference: &Reference) -> SceneInfo {
        SceneInfo {
            name: self.spec.name.clone(),
            file: self.spec.file.clone(),
            digest: self.digest.clone(),
            size: self.size(),
            reference: reference.words.clone(),
            reference_image: reference.image.clone(),
            reference_mse: reference.mse,
        }
    }
}

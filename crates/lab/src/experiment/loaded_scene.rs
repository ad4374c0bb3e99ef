//! A scene in memory, and its reference.

use super::error::{ExperimentError, Place};
use super::{Experiment, MethodSpec, SceneSource, SceneSpec};
use crate::image::Pixels;
use crate::results::SceneInfo;
use bidir::driver::{Progress, Resources, SessionError, Settings};
use bidir::film::Layers;
use bidir::integrator::IntegratorKind;
use formats::film::{Render, Subject, TrainingLimits};
use formats::scene::{Files, LoadOptions, Loaded};
use std::path::PathBuf;

/// A scene in memory, with the settings of its file.
pub(super) struct LoadedScene<'a> {
    pub(super) spec: &'a SceneSpec,
    pub(super) subject: Subject,
    /// The settings of the file, or else the defaults.
    pub(super) settings: Settings,
    /// The scene that was read.
    pub(super) read: Loaded,
}

/// The image that all renders of a scene are compared with.
#[derive(Clone)]
pub(super) struct Reference {
    pub(super) pixels: Pixels,
    /// A description of how the reference was made.
    pub(super) words: String,
    /// The image file, relative to the folder of the results. None: it lies elsewhere.
    pub(super) image: Option<String>,
    /// The mean square error of the reference. None: unknown.
    pub(super) mse: Option<f64>,
}

impl<'a> LoadedScene<'a> {
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
        let read = formats::scene::load_from(&spec.path, &options, files);
        let loaded = read.map_err(|error| Place::of_named(spec.file_place.as_ref(), error))?;
        Ok(Self {
            spec,
            subject: Subject {
                name: spec.file.clone(),
                ..loaded.subject()
            },
            // The experiment sets the seeds, and needs no layers.
            settings: Settings {
                seed: 0,
                layers: Layers::default(),
                ..loaded.settings.render_settings()
            },
            read: loaded,
        })
    }

    /// Returns the files that another machine needs: those on the disk.
    pub(super) fn shared_files(&self) -> Vec<PathBuf> {
        if self.spec.source == SceneSource::Disk {
            self.read.files.clone()
        } else {
            Vec::new()
        }
    }

    /// Returns true if the experiment renders the method in this scene.
    pub(super) fn has(&self, experiment: &Experiment, method: &MethodSpec) -> bool {
        let mut methods = experiment.methods_in(&self.spec.name);
        methods.any(|other| other.name == method.name)
    }

    /// Returns the settings of a method in this scene.
    ///
    /// Errors: the method is not bidirectional, so that it lacks the requested `figures`.
    pub(super) fn bidirectional(
        &self,
        method: &MethodSpec,
        figures: &'static str,
    ) -> Result<Settings, ExperimentError> {
        let settings = method.request.apply(&self.settings);
        if settings.integrator == IntegratorKind::Bdpt {
            return Ok(settings);
        }
        let text = format!("its {figures} cannot be measured, as it is not bidirectional here");
        Err(self.refusal(method, text, Some("give the method integrator = \"bdpt\"")))
    }

    /// Returns the error of a method in this scene.
    pub(super) fn refusal(
        &self,
        method: &MethodSpec,
        text: String,
        hint: Option<&'static str>,
    ) -> ExperimentError {
        ExperimentError::Method {
            scene: self.spec.name.clone(),
            method: method.name.clone(),
            text,
            hint,
        }
    }

    /// Begins a render of this scene. None: the host asked to stop during training.
    pub(super) fn begin(
        &self,
        settings: &Settings,
        threads: usize,
        host: &dyn Progress,
    ) -> Result<Option<Render>, ExperimentError> {
        let resources = Resources {
            threads,
            ..Resources::default()
        };
        let limits = TrainingLimits::NONE;
        match self.subject.begin(settings, &resources, limits, host) {
            Ok(render) => Ok(Some(render)),
            Err(SessionError::Stopped) => Ok(None),
            Err(error) => Err(ExperimentError::Render {
                scene: self.spec.name.clone(),
                error,
            }),
        }
    }

    /// Returns width and height of the images. Unit: pixels.
    pub(super) fn size(&self) -> [usize; 2] {
        let crop = self.subject.view.film().crop;
        [crop.width() as usize, crop.height() as usize]
    }

    pub(super) fn info(&self, reference: &Reference) -> SceneInfo {
        SceneInfo {
            name: self.spec.name.clone(),
            file: self.spec.file.clone(),
            digest: self.subject.digest.clone(),
            size: self.size(),
            reference: reference.words.clone(),
            reference_image: reference.image.clone(),
            reference_mse: reference.mse,
        }
    }
}

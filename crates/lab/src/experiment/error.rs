//! Errors of experiments.

use crate::reference;
use bidir::driver::SessionError;
use std::fmt;
use std::path::PathBuf;
use thiserror::Error;

/// The cause why an experiment has no results.
#[derive(Debug, Error)]
pub enum ExperimentError {
    /// The description is invalid.
    #[error("{0}")]
    Description(Fault),
    /// A file named in the description cannot be read.
    #[error("{0}")]
    Absent(Fault),
    /// A scene cannot be read, or a file cannot be read or written.
    #[error(transparent)]
    File(#[from] formats::Error),
    /// The folder of the results cannot be made or read.
    #[error("{}", formats::cannot("make", path, error))]
    Folder {
        /// The folder, or a file in it.
        path: PathBuf,
        /// The system's error.
        error: std::io::Error,
    },
    /// A line of the records is damaged.
    #[error("{}:{line}: damaged: {reason}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The line, counted from 1.
        line: usize,
        /// The kind of damage.
        reason: &'static str,
    },
    /// The folder has the records of another experiment.
    #[error("{}: the records are of another experiment", .0.display())]
    Mismatch(PathBuf),
    /// The folder has records of another machine, or of another program or number of threads.
    #[error("{}: the records differ in machine, program or threads, and their times cannot be \
         compared: {difference}",
        folder.display())]
    Elsewhere {
        /// The folder.
        folder: PathBuf,
        /// The differing parts, each with the recorded value and the present one.
        difference: String,
    },
    /// The image of a reference cannot be used.
    #[error("{}: the reference of `{scene}` has {text}", path.display())]
    Image {
        /// The reference.
        path: PathBuf,
        /// The scene.
        scene: String,
        /// The fault.
        text: String,
        /// The remedy.
        hint: &'static str,
    },
    /// A reference cannot be made or used.
    #[error("the reference of scene `{scene}`: {error}")]
    Reference {
        /// The scene.
        scene: String,
        /// The cause.
        error: reference::Error,
    },
    /// A method cannot be rendered in a scene, or cannot be measured there.
    #[error("scene `{scene}`: method `{method}`: {text}")]
    Method {
        /// The scene.
        scene: String,
        /// The method.
        method: String,
        /// The cause.
        text: String,
        /// The remedy. None: the cause implies it.
        hint: Option<&'static str>,
    },
    /// A scene shares the reference of an unknown scene, of a later one, or of one with another size.
    #[error("scene `{0}`: `reference-of` names no scene before it that has images of its size")]
    NoReference(String),
    /// All scenes of an experiment are missing.
    #[error("there is no scene to render: {0}")]
    NoScenes(String),
    /// A render cannot begin.
    #[error("scene `{scene}`: {error}")]
    Render {
        /// The scene.
        scene: String,
        /// The cause.
        error: SessionError,
    },
}

impl ExperimentError {
    /// Returns true if the estimators of a reference disagree.
    pub(super) fn is_disagreement(&self) -> bool {
        use reference::Error::Disagree;
        matches!(
            self,
            Self::Reference {
                error: Disagree { .. },
                ..
            }
        )
    }

    /// Returns a remedy. None: the message implies it.
    pub fn hint(&self) -> Option<&str> {
        match self {
            Self::Description(fault) | Self::Absent(fault) => fault.hint.as_deref(),
            Self::File(error) => error.hint(),
            Self::Damaged { line: 1, .. } => Some("start over with --restart"),
            Self::Damaged { .. } => {
                Some("remove the line, to have its render repeated, or start over with --restart")
            }
            Self::Mismatch(_) => {
                Some("name another folder with -o, or start over in this one with --restart")
            }
            Self::Elsewhere { .. } => Some(
                "continue there, or with the same --threads; else name another folder with -o, \
                 or start over in this one with --restart",
            ),
            Self::Image { hint, .. } => Some(hint),
            Self::Method { hint, .. } => *hint,
            error if error.is_disagreement() => Some(
                "the reference stays in its folder; take more samples (`reference-spp`) or \
                 another estimator (`reference-cross-check`), or name a `reference` made by \
                 `bidir reference --estimator … --against …`",
            ),
            Self::NoScenes(_) => Some("BIDIR_SCENES names the folder that has pbrt-v4/"),
            _ => None,
        }
    }
}

/// A place in a description.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file.
    pub file: PathBuf,
    /// The line, counted from 1.
    pub line: usize,
    /// The column, counted from 1, in characters.
    pub column: usize,
}

impl Place {
    /// Returns the error at the place that names the file. An error at a place within the file keeps that place.
    pub(super) fn of_named(place: Option<&Self>, error: formats::Error) -> ExperimentError {
        use formats::ErrorKind::{Io, MissingFile};
        let is_absent = matches!(error.kind(), MissingFile | Io) && error.line().is_none();
        match place.filter(|_| is_absent) {
            Some(place) => ExperimentError::Absent(Fault {
                place: place.clone(),
                message: error.message().to_owned(),
                hint: error.hint().map(str::to_owned),
            }),
            None => ExperimentError::File(error),
        }
    }
}

/// A fault in a description. Its text is `file:line:column: message`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The place.
    pub place: Place,
    /// The fault.
    pub message: String,
    /// The remedy.
    pub hint: Option<String>,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Place { file, line, column } = &self.place;
        write!(f, "{}:{line}:{column}: {}", file.display(), self.message)
    }
}

//! Built-in descriptions, with their scenes.

use super::{Experiment, ExperimentError};
use crate::scenes;
use std::path::Path;

/// A built-in description.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Builtin {
    /// The name, which replaces a file name on the command line.
    pub name: &'static str,
    text: &'static str,
}

/// The built-in descriptions: the experiment of 1995, and a comparison of all integrators and their parts.
pub const BUILTIN: [Builtin; 2] = [
    Builtin {
        name: "paper",
        text: include_str!("../../../../experiments/paper.toml"),
    },
    Builtin {
        name: "beyond",
        text: include_str!("../../../../experiments/beyond.toml"),
    },
];

impl Builtin {
    /// Returns the description of this name. None: there is none.
    pub fn named(name: &Path) -> Option<Self> {
        BUILTIN
            .into_iter()
            .find(|builtin| name == Path::new(builtin.name))
    }

    /// Reads the experiment, with the project's scenes in memory.
    ///
    /// Errors: as [`Experiment::read`].
    pub fn experiment(self) -> Result<Experiment, ExperimentError> {
        let file = Path::new("experiments").join(self.name);
        Experiment::read_with(self.text, &file.with_extension("toml"), &scenes::files())
    }
}

//! Descriptions that the program contains, with the scenes that they name.

use super::{Experiment, ExperimentError};
use crate::scenes;
use std::path::Path;

/// A description that needs no file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Builtin {
    /// Its name, which stands for a file.
    pub name: &'static str,
    text: &'static str,
}

/// All of them: the experiment of 1995, and all integrators with each idea behind them.
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
    /// The description of this name. None: there is none.
    pub fn named(name: &Path) -> Option<Self> {
        BUILTIN
            .into_iter()
            .find(|builtin| name == Path::new(builtin.name))
    }

    /// The experiment, with the project's scenes in memory.
    ///
    /// Errors: as of [`Experiment::read`].
    pub fn experiment(self) -> Result<Experiment, ExperimentError> {
        let file = Path::new("experiments").join(self.name);
        Experiment::read_with(self.text, &file.with_extension("toml"), &scenes::files())
    }
}

//! The records so far, on the disk.
//!
//! The first line says whose they are, and of which machine; every other line is a record, or
//! `{"pyramid": ...}`: what was found of strategies. The file is replaced as a whole. Where experiments
//! have parts, it has that line alone in the folder of all.

use super::error::ExperimentError;
use super::run::{Setup, Start};
use crate::results::{Machine, Pyramid, Record};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// The name of the file.
pub(super) const FILE: &str = "records.ndjson";
/// The version of its format.
const FORMAT: u32 = 2;

/// Makes the folder that of the experiment `name`, whose parts have folders and records of their own
/// below it: it then has a journal without records.
///
/// Errors: the folder is that of another experiment, and is not begun anew.
pub(crate) fn claim(name: &str, setup: &Setup) -> Result<(), ExperimentError> {
    let owner = Owner {
        experiment: name.to_owned(),
        program: setup.program.clone(),
        machine: setup.machine.clone(),
    };
    if setup.start == Start::Anew {
        return Journal::begin(&setup.folder, &owner).map(drop);
    }
    match Journal::open(&setup.folder, &owner) {
        Ok(journal) => journal.write(),
        // Parts say themselves what was made elsewhere.
        Err(ExperimentError::Elsewhere { .. }) => Ok(()),
        Err(error) => Err(error),
    }
}

/// The first line.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Head {
    format: u32,
    #[serde(flatten)]
    owner: Owner,
}

/// Whose records they are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Owner {
    /// The hash of everything that records depend on, but for their times.
    pub(super) experiment: String,
    /// The program with its version.
    pub(super) program: String,
    /// What it ran on.
    pub(super) machine: Machine,
}

impl Owner {
    /// In what else than the experiment this one differs from another, on which times depend. None: in
    /// nothing.
    fn difference(&self, here: &Self) -> Option<String> {
        let parts = |owner: &Self| {
            let Machine {
                processor,
                threads,
                isa,
                system,
            } = owner.machine.clone();
            let threads = format!("{threads} threads");
            [owner.program.clone(), processor, threads, isa, system]
        };
        let pairs = parts(self).into_iter().zip(parts(here));
        let different = pairs.filter(|(there, here)| there != here);
        let words: Vec<_> = different
            .map(|(there, here)| format!("{there}, here {here}"))
            .collect();
        (!words.is_empty()).then(|| words.join("; "))
    }
}

/// A line of what was found of strategies.
#[derive(Serialize, Deserialize)]
struct PyramidLine {
    pyramid: Pyramid,
}

/// The records of an experiment.
#[derive(Debug)]
pub(super) struct Journal {
    path: PathBuf,
    text: String,
    records: Vec<Record>,
    pyramids: Vec<Pyramid>,
}

impl Journal {
    /// A journal without records, in place of what is there.
    ///
    /// Errors: it cannot be written.
    pub(super) fn begin(folder: &Path, owner: &Owner) -> Result<Self, ExperimentError> {
        let journal = Self::new(folder, owner);
        journal.write()?;
        Ok(journal)
    }

    fn new(folder: &Path, owner: &Owner) -> Self {
        let head = Head {
            format: FORMAT,
            owner: owner.clone(),
        };
        Self {
            path: folder.join(FILE),
            text: line(&head),
            records: Vec::new(),
            pyramids: Vec::new(),
        }
    }

    /// The journal that is there, or an empty one.
    ///
    /// Errors: it cannot be read, is of another experiment, or of another machine or program: times
    /// that are compared are of one.
    pub(super) fn open(folder: &Path, owner: &Owner) -> Result<Self, ExperimentError> {
        let mut journal = Self::new(folder, owner);
        let text = match std::fs::read_to_string(&journal.path) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(journal),
            Err(error) => {
                let path = journal.path;
                return Err(ExperimentError::Folder { path, error });
            }
        };
        let others = || ExperimentError::Mismatch(folder.to_owned());
        let mut lines = text.lines();
        let head: Option<Head> = lines
            .next()
            .and_then(|line| serde_json::from_str(line).ok());
        let is_same =
            |head: &Head| head.format == FORMAT && head.owner.experiment == owner.experiment;
        let there = head.filter(is_same).ok_or_else(others)?.owner;
        if let Some(difference) = there.difference(owner) {
            let folder = folder.to_owned();
            return Err(ExperimentError::Elsewhere { folder, difference });
        }
        for line in lines {
            if let Ok(PyramidLine { pyramid }) = serde_json::from_str(line) {
                journal.pyramids.push(pyramid);
            } else {
                let record = serde_json::from_str(line).map_err(|_| others())?;
                journal.records.push(record);
            }
        }
        journal.text = text;
        Ok(journal)
    }

    /// The journal of a run that begins.
    pub(super) fn start(setup: &Setup, owner: &Owner) -> Result<Self, ExperimentError> {
        match setup.start {
            Start::Resume => Self::open(&setup.folder, owner),
            Start::Anew => Self::begin(&setup.folder, owner),
        }
    }

    /// Adds a record.
    pub(super) fn add(&mut self, record: Record) -> Result<(), ExperimentError> {
        self.text += &line(&record);
        self.records.push(record);
        self.write()
    }

    /// Adds what was found of strategies.
    pub(super) fn add_pyramid(&mut self, pyramid: Pyramid) -> Result<(), ExperimentError> {
        let found = PyramidLine { pyramid };
        self.text += &line(&found);
        self.pyramids.push(found.pyramid);
        self.write()
    }

    fn write(&self) -> Result<(), ExperimentError> {
        formats::file::replace(&self.path, self.text.as_bytes())?;
        Ok(())
    }

    pub(super) fn records(&self) -> &[Record] {
        &self.records
    }

    pub(super) fn pyramids(&self) -> &[Pyramid] {
        &self.pyramids
    }

    /// Whether there is a record of the same render.
    pub(super) fn has_like(&self, record: &Record) -> bool {
        self.records.iter().any(|other| {
            let key = |record: &Record| {
                let names = [&record.scene, &record.method, &record.budget].map(String::clone);
                (record.seed, names)
            };
            key(other) == key(record)
        })
    }

    pub(super) fn has(&self, cell: &super::cell::Cell<'_>) -> bool {
        self.records.iter().any(|record| cell.is_of(record))
    }
}

fn line(value: &impl Serialize) -> String {
    let text = serde_json::to_string(value);
    text.expect("texts and numbers have a JSON") + "\n"
}

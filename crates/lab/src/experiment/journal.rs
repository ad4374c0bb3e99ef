//! The records so far, on the disk.
//!
//! The first line says whose they are; every other line is a record, or `{"pyramid": ...}`: what was
//! found of strategies. The file is replaced as a whole.

use super::error::ExperimentError;
use crate::results::{Pyramid, Record};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// The name of the file.
const FILE: &str = "records.ndjson";
/// The version of its format.
const FORMAT: u32 = 1;

/// The first line.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Head {
    format: u32,
    /// The hash of everything that records depend on.
    experiment: String,
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
    pub(super) fn begin(folder: &Path, experiment: &str) -> Result<Self, ExperimentError> {
        let journal = Self::new(folder, experiment);
        journal.write()?;
        Ok(journal)
    }

    fn new(folder: &Path, experiment: &str) -> Self {
        let head = Head {
            format: FORMAT,
            experiment: experiment.to_owned(),
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
    /// Errors: it cannot be read, or is of another experiment.
    pub(super) fn open(folder: &Path, experiment: &str) -> Result<Self, ExperimentError> {
        let mut journal = Self::new(folder, experiment);
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
        let head = lines
            .next()
            .and_then(|line| serde_json::from_str(line).ok());
        if head
            != Some(Head {
                format: FORMAT,
                experiment: experiment.to_owned(),
            })
        {
            return Err(others());
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

    pub(super) fn has(&self, cell: &super::cell::Cell<'_>) -> bool {
        self.records.iter().any(|record| {
            record.seed == cell.seed
                && record.scene == cell.stage.spec.name
                && record.method == cell.method.name
                && record.budget == cell.budget.name
        })
    }
}

fn line(value: &impl Serialize) -> String {
    let text = serde_json::to_string(value);
    text.expect("texts and numbers have a JSON") + "\n"
}

/// SHA-256 in hexadecimal.
pub(super) fn hash(text: &str) -> String {
    let mut hash = String::new();
    for byte in Sha256::digest(text.as_bytes()) {
        // Writing to a string cannot fail.
        let _ = write!(hash, "{byte:02x}");
    }
    hash
}

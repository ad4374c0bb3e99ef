//! The file of the records so far.
//!
//! The first line names experiment, program and machine; every other line is a record, or
//! `{"pyramid": ...}` with the figures of strategies. Each line has a checksum. Each write replaces the file.

use super::error::ExperimentError;
use super::run::{Done, write_image};
use super::run_set::{Setup, Start};
use crate::results::{Machine, Pyramid, Record, RunId};
use crate::seal::{self, Seal};
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::path::{Path, PathBuf};

type Result<T> = std::result::Result<T, ExperimentError>;

/// The name of the file.
pub(super) const FILE: &str = "records.ndjson";
/// The version of the file's format.
const FORMAT: u32 = 3;

/// The first line.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Head {
    format: u32,
    #[serde(flatten)]
    key: RecordsKey,
}

/// The origin of records; records with different keys are not comparable.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct RecordsKey {
    /// The hash of everything that records depend on, except their times.
    pub(super) experiment: String,
    /// The program with its version.
    pub(super) program: String,
    /// The machine.
    pub(super) machine: Machine,
}

impl RecordsKey {
    /// Describes the differences of program and machine, which times depend on. None: there are none.
    fn difference(&self, here: &Self) -> Option<String> {
        let parts = |Self {
                         program, machine, ..
                     }: &Self| {
            let threads = format!("{} threads", machine.threads);
            let Machine {
                processor,
                isa,
                system,
                ..
            } = machine;
            [program, processor, &threads, isa, system].map(String::clone)
        };
        let pairs = parts(self).into_iter().zip(parts(here));
        // An unknown processor may be the same one.
        let is_known = |name: &str| name != Machine::UNKNOWN;
        let different =
            pairs.filter(|(there, here)| there != here && is_known(there) && is_known(here));
        let words: Vec<_> = different
            .map(|(there, here)| format!("{there}, here {here}"))
            .collect();
        (!words.is_empty()).then(|| words.join("; "))
    }
}

/// A line after the first.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Line {
    /// The figures of strategies.
    Pyramid {
        pyramid: Pyramid,
    },
    Record(Box<Record>),
}

/// The records of an experiment.
#[derive(Debug)]
pub(super) struct Journal {
    folder: PathBuf,
    text: String,
    records: Vec<Record>,
    pyramids: Vec<Pyramid>,
}

impl Journal {
    fn new(folder: &Path, key: &RecordsKey) -> Self {
        let head = Head {
            format: FORMAT,
            key: key.clone(),
        };
        Self {
            folder: folder.to_owned(),
            text: sealed(&head),
            records: Vec::new(),
            pyramids: Vec::new(),
        }
    }

    /// Reads the existing journal, or creates an empty one.
    ///
    /// Errors: the file cannot be read, is damaged, or belongs to another experiment, or to another machine
    /// or program, whose times would not be comparable.
    pub(super) fn open(folder: &Path, key: &RecordsKey) -> Result<Self> {
        let mut journal = Self::new(folder, key);
        let path = folder.join(FILE);
        match std::fs::read(&path) {
            Ok(bytes) => journal.read(&bytes, key)?,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {}
            Err(error) => return Err(ExperimentError::Folder { path, error }),
        }
        Ok(journal)
    }

    /// Reads the content of the file.
    fn read(&mut self, bytes: &[u8], key: &RecordsKey) -> Result<()> {
        let text = std::str::from_utf8(bytes).map_err(|error| {
            let before = bytes.iter().take(error.valid_up_to());
            let line = 1 + before.filter(|byte| **byte == b'\n').count();
            self.damaged(line, "it is no text")
        })?;
        let mut lines = (1..).zip(text.split_terminator('\n'));
        let (_, head) = lines.next().unwrap_or((1, ""));
        self.read_head(head, key)?;
        lines.try_for_each(|(number, line)| self.read_line(line, number))
    }

    /// Reads the first line.
    fn read_head(&mut self, line: &str, key: &RecordsKey) -> Result<()> {
        let folder = self.folder.clone();
        let others = || ExperimentError::Mismatch(folder.clone());
        if seal::check(line) == Seal::Broken {
            return self.check(line, 1);
        }
        let head: Option<Head> = serde_json::from_str(line).ok();
        let known = head.filter(|head| head.format == FORMAT);
        let there = known.ok_or_else(others)?.key;
        self.check(line, 1)?;
        if there.experiment != key.experiment {
            return Err(others());
        }
        let difference = there.difference(key);
        difference.map_or(Ok(()), |difference| {
            Err(ExperimentError::Elsewhere { folder, difference })
        })
    }

    /// Reads a line with a record or with figures of strategies.
    fn read_line(&mut self, line: &str, number: usize) -> Result<()> {
        self.check(line, number)?;
        match serde_json::from_str(line) {
            Ok(Line::Pyramid { pyramid }) => self.pyramids.push(pyramid),
            Ok(Line::Record(record)) => self.records.push(*record),
            Err(_) => return Err(self.damaged(number, "it is no record")),
        }
        self.text += line;
        self.text.push('\n');
        Ok(())
    }

    /// Compares a line with its checksum.
    fn check(&self, line: &str, number: usize) -> Result<()> {
        match seal::check(line) {
            Seal::Broken => Err(self.damaged(number, "its checksum is that of another text")),
            Seal::Missing => Err(self.damaged(number, "it has no checksum")),
            Seal::Whole => Ok(()),
        }
    }

    fn damaged(&self, line: usize, reason: &'static str) -> ExperimentError {
        let path = self.folder.join(FILE);
        ExperimentError::Damaged { path, line, reason }
    }

    /// Opens or replaces the journal, as the setup asks, when an experiment starts.
    pub(super) fn start(setup: &Setup, key: &RecordsKey) -> Result<Self> {
        match setup.start {
            Start::Resume => Self::open(&setup.folder, key),
            Start::Anew => {
                let journal = Self::new(&setup.folder, key);
                journal.write()?;
                Ok(journal)
            }
        }
    }

    /// Adds a finished run, and writes its image. A record of the same run stays.
    pub(super) fn add(&mut self, done: Done) -> Result<()> {
        let Done { record, image } = done;
        if let (Some(name), Some(pixels)) = (&record.image, &image) {
            write_image(&self.folder.join(name), pixels)?;
        }
        if self.has(record.run()) {
            return Ok(());
        }
        self.text += &sealed(&record);
        self.records.push(record);
        self.write()
    }

    /// Adds figures of strategies.
    pub(super) fn add_pyramid(&mut self, pyramid: Pyramid) -> Result<()> {
        self.text += &sealed(&json!({ "pyramid": pyramid }));
        self.pyramids.push(pyramid);
        self.write()
    }

    fn write(&self) -> Result<()> {
        formats::file::replace(&self.folder.join(FILE), self.text.as_bytes())?;
        Ok(())
    }

    pub(super) fn records(&self) -> &[Record] {
        &self.records
    }

    pub(super) fn pyramids(&self) -> &[Pyramid] {
        &self.pyramids
    }

    /// Returns true if there is a record of the run.
    pub(super) fn has(&self, run: RunId<'_>) -> bool {
        self.records.iter().any(|record| record.run() == run)
    }
}

/// Returns a line with its checksum.
fn sealed(value: &impl Serialize) -> String {
    let text = serde_json::to_string(value);
    seal::sealed(&text.expect("texts and numbers have a JSON")) + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLACE: &str = "out";

    fn key() -> RecordsKey {
        RecordsKey {
            experiment: "a hash".to_owned(),
            program: "bidir 0".to_owned(),
            machine: Machine::default(),
        }
    }

    fn record(seed: u64) -> Record {
        let record = json!({
            "scene": "room", "method": "all", "budget": "2 spp", "seed": seed, "spp": 2,
            "seconds": 0.25, "connections_blocked": 3, "metrics": {"rmse": 0.5},
            "rays": {"camera": 1, "light": 2, "connection": 3, "light_image": 4, "training": 0},
            "efficiency_rays": 0.125, "efficiency_seconds": 16.0, "image": null,
        });
        serde_json::from_value(record).unwrap()
    }

    /// Writes a journal of two records.
    fn written() -> String {
        let journal = Journal::new(Path::new(PLACE), &key());
        journal.text + &sealed(&record(1)) + &sealed(&record(2))
    }

    fn read(bytes: &[u8]) -> Result<Journal> {
        let mut journal = Journal::new(Path::new(PLACE), &key());
        journal.read(bytes, &key())?;
        Ok(journal)
    }

    #[test]
    fn every_flipped_bit_is_an_error_with_its_line() {
        let text = written();
        let journal = read(text.as_bytes()).unwrap();
        assert!(journal.records == [record(1), record(2)] && journal.text == text);
        for bit in (0..8 * (text.len() - 1)).step_by(5) {
            let mut bytes = text.clone().into_bytes();
            bytes[bit / 8] ^= 1 << (bit % 8);
            let before = &text[..bit / 8];
            let expected = 1 + before.matches('\n').count();
            match read(&bytes) {
                Err(ExperimentError::Damaged { line, .. }) => assert_eq!(line, expected),
                // Without a readable checksum, the first line names no experiment.
                Err(ExperimentError::Mismatch(_)) => assert_eq!(expected, 1),
                other => panic!("bit {bit}: {other:?}"),
            }
        }
        for end in 0..text.len() - 1 {
            let whole = read(&text.as_bytes()[..end]).map(|journal| journal.records.len());
            let is_line = text[..end].ends_with('\n') || text[end..].starts_with('\n');
            assert_eq!(whole.is_ok(), is_line && end > 0, "{end}");
        }
    }
}

//! The record of an import: warnings, substitutes, and the files that were read.

use super::LoadOptions;
use super::digest::{Content, DigestBuilder};
use super::reading::Reading;
use crate::bytes::FileBytes;
use crate::error::Result;
use crate::files::Files;
use crate::limits::{FURTHER_WARNINGS, MOST_WARNINGS};
use crate::source::Span;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// A message about something odd that is not an error.
#[derive(Clone, Debug, PartialEq)]
pub struct Warning<P = Span> {
    /// The reason.
    pub message: String,
    /// The place; of several, the first.
    pub place: P,
    /// The number of times it occurred.
    pub count: usize,
}

/// Adds a warning to the list, or counts it if the list has its message.
pub(crate) fn warn<P>(warnings: &mut Vec<Warning<P>>, place: P, message: impl Into<String>) {
    let mut message = message.into();
    if warnings.len() >= MOST_WARNINGS && warnings.iter().all(|known| known.message != message) {
        FURTHER_WARNINGS.clone_into(&mut message);
    }
    match warnings.iter_mut().find(|known| known.message == message) {
        Some(warning) => warning.count += 1,
        None => warnings.push(Warning {
            message,
            place,
            count: 1,
        }),
    }
}

/// Warnings with their places `P`, and the files that were read.
#[derive(Clone)]
pub(crate) struct Log<P> {
    /// True to replace unsupported features by substitutes, with warnings.
    pub(super) lenient: bool,
    pub(crate) warnings: Vec<Warning<P>>,
    /// The messages of those warnings that name a substitute.
    pub(super) substitutes: BTreeSet<String>,
    pub(super) digest: DigestBuilder,
    /// The names of the files that were read.
    pub(super) files: Vec<PathBuf>,
    pub(crate) reading: Reading,
}

impl<P> Log<P> {
    /// Returns the log of a scene whose `texts` take `stored` bytes on the disk.
    pub(crate) fn new(options: &LoadOptions, texts: Vec<PathBuf>, stored: u64) -> Self {
        Self {
            lenient: options.lenient,
            warnings: Vec::new(),
            substitutes: BTreeSet::new(),
            digest: DigestBuilder::new(),
            files: texts,
            reading: Reading::new(stored),
        }
    }

    pub(crate) fn warn(&mut self, place: P, message: impl Into<String>) {
        warn(&mut self.warnings, place, message);
    }

    /// Reads a file and counts it against the limits; [`add`](Self::add) makes it a part of the scene.
    pub(crate) fn read(&mut self, files: &Files, path: &Path, limit: u64) -> Result<Vec<u8>> {
        let FileBytes { bytes, stored } = files.read(path, limit)?;
        let length = bytes.len() as u64;
        let counted = self.reading.file(files.identity(path), stored, length);
        counted.map_err(|error| error.in_file(path))?;
        Ok(bytes)
    }

    /// Adds the bytes of a file to the digest, and the names of the file.
    pub(crate) fn add(
        &mut self,
        content: Content,
        bytes: &[u8],
        names: impl IntoIterator<Item = PathBuf>,
    ) {
        self.digest.add(content, bytes);
        self.files.extend(names);
    }

    /// Returns the warnings for whose messages `is_asked_for` is true, each as `place: message`.
    pub(super) fn texts(
        &self,
        text: impl Fn(&P) -> String,
        is_asked_for: impl Fn(&str) -> bool,
    ) -> Vec<String> {
        let line = |warning: &Warning<P>| {
            let times = match warning.count {
                1 => String::new(),
                count => format!(" ({count} times)"),
            };
            format!("{}: {}{times}", text(&warning.place), warning.message)
        };
        let warnings = self.warnings.iter();
        let asked_for = warnings.filter(|warning| is_asked_for(&warning.message));
        asked_for.map(line).collect()
    }
}

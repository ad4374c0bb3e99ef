//! How much was read for a scene, against the limits.

use crate::error::{Error, ErrorKind, Result};
use crate::image::ImageData;
use crate::limits::{self, Allowance};
use std::collections::BTreeSet;
use std::path::PathBuf;

/// What the files of a scene hold, and what was made of them so far.
#[derive(Debug)]
pub(crate) struct Reading {
    /// Bytes that all files take on the disk, each once.
    stored: u64,
    /// By identity.
    files: BTreeSet<PathBuf>,
    /// Bytes of files that were read before.
    again: u64,
    /// Of all images.
    numbers: u64,
}

impl Reading {
    /// Begins with texts that take `stored` bytes on the disk.
    pub(crate) fn new(stored: u64) -> Self {
        Self {
            stored,
            files: BTreeSet::new(),
            again: 0,
            numbers: 0,
        }
    }

    /// Bytes that all files take on the disk, each once.
    pub(crate) fn stored(&self) -> u64 {
        self.stored
    }

    /// Counts a file of `length` bytes that takes `stored` of them on the disk. Errors: files are read
    /// again and again.
    pub(crate) fn file(&mut self, identity: PathBuf, stored: u64, length: u64) -> Result<()> {
        if self.files.insert(identity) {
            self.stored += stored;
            return Ok(());
        }
        self.again += length;
        self.check((self.again, "bytes that are read again"), limits::FILES_AGAIN)
    }

    /// Counts an image. Errors: all images are too large for their files.
    pub(crate) fn image(&mut self, image: ImageData) -> Result<ImageData> {
        self.numbers += image.data.len() as u64;
        self.check((self.numbers, "numbers of images"), limits::IMAGES)?;
        Ok(image)
    }

    fn check(&self, (count, what): (u64, &str), allowance: Allowance) -> Result<()> {
        let stored = self.stored;
        let most = allowance.of(stored);
        if count <= most {
            return Ok(());
        }
        let message = format!("the scene's {stored} bytes of files stand for more than {most} {what}");
        Err(Error::new(ErrorKind::Limit, message))
    }
}

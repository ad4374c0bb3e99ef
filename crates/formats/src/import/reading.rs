//! Counts the data that are read for a scene, and checks the counts against the limits.

use crate::error::{Error, ErrorKind, Result};
use crate::image::{self, ImageData};
use crate::limits::{self, Allowance};
use std::collections::BTreeSet;
use std::path::PathBuf;

/// The size of the files of a scene, and the amounts that were read from them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Reading {
    /// The size of all files on the disk, each counted once. Unit: bytes.
    pub(crate) stored: u64,
    /// The identities of the files.
    files: BTreeSet<PathBuf>,
    /// The size of all repeated readings of files. Unit: bytes.
    again: u64,
    /// The numbers in all images.
    numbers: u64,
    /// The cells of all grids of NanoVDB files.
    cells: u64,
}

impl Reading {
    /// Starts with texts that have `stored` bytes on the disk.
    pub(crate) fn new(stored: u64) -> Self {
        Self {
            stored,
            ..Self::default()
        }
    }

    /// Counts a file of `length` unpacked bytes that has `stored` bytes on the disk. Errors: files are read too often.
    pub(crate) fn file(&mut self, identity: PathBuf, stored: u64, length: u64) -> Result<()> {
        if self.files.insert(identity) {
            self.stored += stored;
            return Ok(());
        }
        self.again += length;
        let what = "bytes that are read again";
        self.check(self.again, what, limits::FILES_AGAIN)
    }

    /// Counts an image, and returns it. Errors: all images together are too large for their files.
    pub(crate) fn image(&mut self, image: ImageData) -> Result<ImageData> {
        self.numbers += image::numbers(
            [image.width, image.height].map(|n| n as u64),
            image.channels as u64,
        );
        self.check(self.numbers, "numbers of images", limits::IMAGES)?;
        Ok(image)
    }

    /// Counts the cells of a grid, before they are read. Errors: all grids together are too large for their files.
    pub(crate) fn cells(&mut self, count: u64) -> Result<()> {
        self.cells = self.cells.saturating_add(count);
        self.check(self.cells, "cells of grids", limits::VOXELS)
    }

    fn check(&self, count: u64, what: &str, allowance: Allowance) -> Result<()> {
        let stored = self.stored;
        let most = allowance.of(stored);
        if count <= most {
            return Ok(());
        }
        let message =
            format!("the scene's {stored} bytes of files stand for more than {most} {what}");
        Err(Error::new(ErrorKind::Limit, message))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The size of a file counts once, whatever names it is read by.
    #[test]
    fn reading_files_repeatedly_has_a_limit() {
        let mut reading = Reading::new(1000);
        let most = limits::FILES_AGAIN.of(1000 + 50);
        let mut read = |length| reading.file("a.ply".into(), 50, length);
        read(u64::MAX).expect("the first time is free");
        read(most).expect("a file may be read again");
        let error = read(1).expect_err("but not for ever");
        assert_eq!(error.kind(), ErrorKind::Limit);
        assert_eq!(reading.stored, 1050);
    }

    #[test]
    fn all_grids_of_a_scene_share_a_limit() {
        let mut reading = Reading::new(10);
        reading.cells(limits::VOXELS.of(10)).expect("as many");
        let error = reading.cells(1).expect_err("one too many");
        assert!(error.to_string().contains("cells of grids"), "{error}");
    }

    #[test]
    fn all_images_of_a_scene_share_a_limit() {
        let mut reading = Reading::new(0);
        let image = || ImageData {
            width: 1,
            height: 1,
            channels: 3,
            data: vec![0.0; 3],
        };
        assert_eq!(reading.image(image()).unwrap(), image());
        reading.numbers = limits::IMAGES.of(0);
        let error = reading.image(image()).expect_err("one too many");
        assert!(error.to_string().contains("numbers of images"), "{error}");
    }
}

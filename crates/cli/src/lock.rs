//! Locks that keep processes from writing the same film file at once.
//!
//! A process locks the empty file FILE.lock beside the film file. FILE.lock is never removed: else one process might
//! hold the lock of the removed file while another locks a new one. The system releases the lock of a process that
//! ends.

use crate::exit::{Exit, Failure};
use crate::scene_io;
use std::fs::{File, OpenOptions, TryLockError};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The right to write a film file, until it is dropped. None: the file is a device, or the file system has no
/// locks. Even then, writers have different temporary files.
#[derive(Debug)]
pub(crate) struct FilmLock(
    #[expect(dead_code, reason = "an open file holds the lock")] Option<File>,
);

impl FilmLock {
    /// Takes the lock of a film file, and removes temporary files of killed writers.
    ///
    /// Errors: another process has the lock; the lock file cannot be created.
    pub(crate) fn take(film: &Path) -> Result<Self, Failure> {
        // The lock is that of the file itself, whatever link leads to it.
        let film = scene_io::target_of(film);
        // Devices and the like are written to and not replaced.
        if film.exists() && !film.is_file() {
            return Ok(Self(None));
        }
        let name = beside(&film, ".lock");
        let mut options = OpenOptions::new();
        let opened = options.write(true).create(true).truncate(false).open(&name);
        let file = opened.map_err(|error| Failure::io(&name, "write", &error))?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Err(taken(&film)),
            Err(TryLockError::Error(_)) => return Ok(Self(None)),
        }
        for written in [&film, &previous(&film)] {
            scene_io::remove_leftovers(written, Duration::ZERO);
        }
        Ok(Self(Some(file)))
    }
}

/// Returns the name of the previous version of a film file.
pub(crate) fn previous(film: &Path) -> PathBuf {
    beside(film, ".previous")
}

/// Returns the files that a writer of a film file writes: the film file, its lock, and its previous version.
pub(crate) fn files(film: &Path) -> Vec<PathBuf> {
    let target = scene_io::target_of(film);
    let mut files = vec![film.to_owned(), beside(&target, ".lock")];
    let previous = previous(&target);
    // Both may be names of one file, where a writer was killed between two steps.
    if !scene_io::is_same(&previous, &target) {
        files.push(previous);
    }
    files
}

/// Returns `path` with a further ending.
fn beside(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(ending);
    name.into()
}

/// Returns the failure that another process has the lock of this film file.
fn taken(film: &Path) -> Failure {
    let message = format!("{}: another process is writing this file", film.display());
    let hint = "give each process a file of its own; parts of a render can be merged";
    Failure::new(Exit::InputOutput, message).with_hint(hint)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lock_is_taken_once_until_it_is_dropped() {
        let folder = tempfile::tempdir().unwrap();
        let film = folder.path().join("a.film");
        let lock = FilmLock::take(&film).unwrap();
        let failure = FilmLock::take(&film).unwrap_err();
        assert_eq!(failure.exit(), Exit::InputOutput);
        drop(lock);
        FilmLock::take(&film).unwrap();
    }
}

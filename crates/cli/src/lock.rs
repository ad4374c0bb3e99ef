//! Locks that keep processes from writing the same film file at once.
//!
//! The lock is that of the file FILE.lock beside it. The system releases it where the process is
//! killed; the file then stays, empty and harmless, until the next writer ends. A writer removes the
//! file *while it holds the lock*, and one that gets a lock begins anew where the name no longer
//! stands for the locked file. Hence two processes can never both hold it.

use crate::exit::{Exit, Failure};
use crate::scene_io;
use std::fs::{File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

/// The most times that others may remove a lock file while it is being locked.
const ATTEMPTS: u32 = 100;

/// The right to write a film file, as long as it lives.
#[derive(Debug)]
pub(crate) struct FilmLock {
    name: PathBuf,
    /// None: there is nothing to lock, or the file system cannot. Names of temporary files keep
    /// writers apart even there.
    held: Option<File>,
}

impl FilmLock {
    /// Takes the lock of a film file, and removes temporary files of killed writers.
    ///
    /// Errors: another process has it; no file can be made beside the film file.
    pub(crate) fn take(film: &Path) -> Result<Self, Failure> {
        // The lock is that of the file itself, whatever link leads to it.
        let film = scene_io::target_of(film);
        let name = beside(&film, ".lock");
        // Devices and the like are written to and not replaced.
        if film.exists() && !film.is_file() {
            return Ok(Self { name, held: None });
        }
        let unwritable = |error| Failure::io(&name, "write", &error);
        for _ in 0..ATTEMPTS {
            let file = open(&name).map_err(unwritable)?;
            if file.metadata().is_ok_and(|metadata| metadata.len() > 0) {
                return Err(no_lock(&name));
            }
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => return Err(taken(&film)),
                Err(TryLockError::Error(_)) => return Ok(Self { name, held: None }),
            }
            if is_still(&file, &name).map_err(unwritable)? {
                for written in [&film, &previous(&film)] {
                    scene_io::remove_leftovers(written);
                }
                let held = Some(file);
                return Ok(Self { name, held });
            }
        }
        Err(taken(&film))
    }
}

impl Drop for FilmLock {
    fn drop(&mut self) {
        if cfg!(unix) && self.held.is_some() {
            // A file that stays is harmless.
            let _ = std::fs::remove_file(&self.name);
        }
    }
}

/// The name of the film file before this one.
pub(crate) fn previous(film: &Path) -> PathBuf {
    beside(film, ".previous")
}

/// The files that a writer of a film file writes: itself, its lock, and the one before it.
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

/// A name beside `path`.
fn beside(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(ending);
    name.into()
}

/// Another process has the lock of this film file.
fn taken(film: &Path) -> Failure {
    let message = format!("{}: another process is writing this file", film.display());
    let hint = "give each process a file of its own; parts of a render can be merged";
    Failure::new(Exit::InputOutput, message).with_hint(hint)
}

/// The name of the lock is that of a file with content, which would be removed with the lock.
fn no_lock(name: &Path) -> Failure {
    let message = format!("{} is not an empty lock file", name.display());
    let hint = "rename it, or give the film file another name";
    Failure::new(Exit::InputOutput, message).with_hint(hint)
}

/// Opens a lock file, or makes it.
fn open(name: &Path) -> io::Result<File> {
    let mut options = OpenOptions::new();
    options.write(true).create(true).truncate(false).open(name)
}

/// True where the name still stands for the file. It is opened for that, as network file systems look
/// afresh only then.
#[cfg(unix)]
fn is_still(file: &File, name: &Path) -> io::Result<bool> {
    use std::os::unix::fs::MetadataExt;
    let identity = |file: &File| {
        let metadata = file.metadata()?;
        Ok::<_, io::Error>((metadata.dev(), metadata.ino()))
    };
    match File::open(name) {
        Ok(now) => Ok(identity(&now)? == identity(file)?),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(false),
        Err(error) => Err(error),
    }
}

/// Lock files are not removed here, as open files cannot be.
#[cfg(not(unix))]
fn is_still(_file: &File, _name: &Path) -> io::Result<bool> {
    Ok(true)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

    #[test]
    fn a_lock_is_taken_once_and_leaves_nothing_behind() {
        let folder = tempfile::tempdir().unwrap();
        let film = folder.path().join("a.film");
        let lock = FilmLock::take(&film).unwrap();
        let failure = FilmLock::take(&film).unwrap_err();
        assert_eq!(failure.exit(), Exit::InputOutput);
        drop(lock);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
        // A killed process leaves this.
        File::create(beside(&film, ".lock")).unwrap();
        drop(FilmLock::take(&film).unwrap());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn two_never_have_the_lock() {
        let folder = tempfile::tempdir().unwrap();
        let film = folder.path().join("a.film");
        let (is_held, taken) = (AtomicBool::new(false), AtomicU64::new(0));
        let threads = || {
            while taken.load(Ordering::Relaxed) < 500 {
                let Ok(lock) = FilmLock::take(&film) else {
                    continue;
                };
                assert!(!is_held.swap(true, Ordering::SeqCst), "held twice");
                taken.fetch_add(1, Ordering::Relaxed);
                std::thread::yield_now();
                is_held.store(false, Ordering::SeqCst);
                drop(lock);
            }
        };
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(threads);
            }
        });
    }
}

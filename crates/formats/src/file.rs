//! Files that are replaced as a whole: whatever happens, a name stands for all of the old bytes or
//! all of the new.
//!
//! The new bytes go to a temporary file in the same folder, as a rename between file systems is a
//! copy and not one step. They are on the disk before the rename, else a power cut could leave an
//! empty file under the name; then the folder is, so that the rename itself lasts.
//!
//! The temporary file of `NAME` is called `.NAME.bidir-HOST-PROCESS-RANDOM.tmp`, so that the machines
//! that write to a shared folder stay apart, and so that what a killed process left behind says what
//! it was to be and whose it was. Its writer holds its lock, which the system gives back where the
//! process is killed: so the next writer of `NAME` can [`remove_leftovers`] and nothing else.

use crate::error::{Error, Result};
use std::ffi::OsStr;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;
use tempfile::NamedTempFile;

/// No write takes as long: what is older was left behind, on whatever machine.
const OLD: Duration = Duration::from_secs(24 * 60 * 60);
/// The most of a name that is part of a temporary file's name. Unit: bytes; file systems take 255.
const LONGEST_NAME: usize = 128;
/// How often a temporary file may be taken for a leftover before its writer has locked it.
const ATTEMPTS: u32 = 100;

/// Replaces a file, or makes it where there is none. Readers that have it open keep the old bytes.
/// What a link stands for is replaced, not the link; what is no plain file is written to.
pub fn replace(path: &Path, bytes: &[u8]) -> Result<()> {
    replace_with(path, bytes, |_| Ok(()))
}

/// Replaces a file, and gives the old one the name `previous`. Where anything fails, both names
/// stand for what they stood for before.
pub fn replace_keeping(path: &Path, previous: &Path, bytes: &[u8]) -> Result<()> {
    replace_with(path, bytes, |target| {
        if !target.exists() {
            return Ok(());
        }
        // A second name for the old file, which stays when the first is given to the new bytes.
        let name = temporary_for(previous)?.into_temp_path();
        std::fs::remove_file(&name)?;
        std::fs::hard_link(target, &name).or_else(|_| std::fs::copy(target, &name).map(drop))?;
        // Both may be names of one file, where the last writer was killed before its last step: then a
        // rename does nothing, and what it leaves is removed with `name`.
        std::fs::rename(&name, previous)
    })
}

/// Calls `before` with the file that is replaced when the new bytes are on the disk.
fn replace_with(
    path: &Path,
    bytes: &[u8],
    before: impl FnOnce(&Path) -> io::Result<()>,
) -> Result<()> {
    let written = || {
        let target = &target_of(path);
        if is_special(target) {
            return std::fs::write(target, bytes);
        }
        remove_leftovers(target);
        let mut file = temporary_for(target)?;
        file.write_all(bytes)?;
        file.as_file().sync_all()?;
        before(target)?;
        file.persist(target)?;
        sync_folder(folder_of(target))
    };
    written().map_err(|error| Error::io(path, "write", &error))
}

/// The file that a name stands for, through links.
pub fn target_of(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_owned())
}

/// Something that is there and no plain file, such as a device, which a rename would destroy.
fn is_special(path: &Path) -> bool {
    path.metadata()
        .is_ok_and(|metadata| !metadata.is_file() && !metadata.is_dir())
}

/// Says now whether [`replace`] can make its temporary file. Nothing is left behind, not even by who is
/// killed here where the file system has files without names.
pub fn check_replaceable(path: &Path) -> Result<()> {
    let target = target_of(path);
    if is_special(&target) {
        return Ok(());
    }
    let made = tempfile::tempfile_in(folder_of(&target));
    made.map(drop)
        .map_err(|error| Error::io(path, "write", &error))
}

/// The folder that a file is or will be in; `.` for a bare name.
pub fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Removes the temporary files of `path` that killed writers left behind: those of this machine that
/// are not locked, and those of others that are older than a day, as locks may not reach other
/// machines. What cannot be removed stays.
pub fn remove_leftovers(path: &Path) {
    let target = target_of(path);
    let Some(prefix) = target.file_name().map(prefix) else {
        return;
    };
    let Ok(entries) = std::fs::read_dir(folder_of(&target)) else {
        return;
    };
    let host = host();
    for entry in entries.flatten() {
        let name = entry.file_name();
        let Some(writer) = writer_of(&name, &prefix) else {
            continue;
        };
        let file = entry.path();
        if writer == host {
            remove_unlocked(&file);
        } else if is_old(&file) {
            // Whoever else removes it wants the same.
            let _ = std::fs::remove_file(&file);
        }
    }
}

/// Removes a temporary file of this machine where its writer is gone. It is locked meanwhile, so that
/// a writer that has just made it does not take it for its own.
fn remove_unlocked(path: &Path) {
    let Ok(file) = OpenOptions::new().write(true).open(path) else {
        return;
    };
    let is_left = match file.try_lock() {
        Ok(()) => true,
        Err(TryLockError::WouldBlock) => false,
        // There are no locks here.
        Err(TryLockError::Error(_)) => is_old(path),
    };
    if is_left {
        let _ = std::fs::remove_file(path);
    }
}

/// True where a file was last written to so long ago that its writer is gone.
fn is_old(path: &Path) -> bool {
    let changed = path.metadata().and_then(|metadata| metadata.modified());
    let age = changed.ok().and_then(|changed| changed.elapsed().ok());
    age.is_some_and(|age| age > OLD)
}

/// The beginning of the names of temporary files of `name`: names that begin alike may share it.
fn prefix(name: &OsStr) -> String {
    let name = name.to_string_lossy();
    let mut end = name.len().min(LONGEST_NAME);
    while !name.is_char_boundary(end) {
        end -= 1;
    }
    format!(".{}.bidir-", &name[..end])
}

/// The machine that wrote a temporary file. None: the name is no temporary file's with this prefix.
fn writer_of<'a>(name: &'a OsStr, prefix: &str) -> Option<&'a str> {
    let rest = name.to_str()?.strip_prefix(prefix)?;
    let (owner, random) = rest.strip_suffix(".tmp")?.rsplit_once('-')?;
    let (host, process) = owner.rsplit_once('-')?;
    let is_ours = host.chars().all(is_plain)
        && !process.is_empty()
        && process.chars().all(|digit| digit.is_ascii_digit())
        && random.chars().all(|letter| letter.is_ascii_alphanumeric());
    is_ours.then_some(host)
}

/// An empty file beside `target`, locked where that can be, that is removed when it is dropped.
fn temporary_for(target: &Path) -> io::Result<NamedTempFile> {
    let prefix = target.file_name().map_or_else(|| ".bidir-".into(), prefix);
    let prefix = format!("{prefix}{}-{}-", host(), std::process::id());
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(".tmp");
    // A temporary file is private unless told otherwise; an image is as public as any new file.
    #[cfg(unix)]
    let public = std::os::unix::fs::PermissionsExt::from_mode(0o666);
    #[cfg(unix)]
    builder.permissions(public);
    for _ in 0..ATTEMPTS {
        let file = builder.tempfile_in(folder_of(target))?;
        if is_held(file.as_file())? {
            return Ok(file);
        }
    }
    Err(io::ErrorKind::ResourceBusy.into())
}

/// Locks a temporary file that was just made. False: another process takes it for a leftover.
fn is_held(file: &File) -> io::Result<bool> {
    match file.try_lock() {
        Ok(()) => is_linked(file),
        Err(TryLockError::WouldBlock) => Ok(false),
        // Without locks the name alone keeps writers apart.
        Err(TryLockError::Error(_)) => Ok(true),
    }
}

/// Does an open file have a name?
#[cfg(unix)]
fn is_linked(file: &File) -> io::Result<bool> {
    Ok(std::os::unix::fs::MetadataExt::nlink(&file.metadata()?) > 0)
}

/// Open files keep their names here.
#[cfg(not(unix))]
fn is_linked(_file: &File) -> io::Result<bool> {
    Ok(true)
}

/// The name of this machine, as part of a file's name; `host` where it cannot be told.
fn host() -> String {
    let name = std::fs::read_to_string("/proc/sys/kernel/hostname")
        .or_else(|_| std::env::var("COMPUTERNAME"))
        .or_else(|_| std::env::var("HOSTNAME"))
        .unwrap_or_default();
    let plain: String = name.chars().filter(|&c| is_plain(c)).take(64).collect();
    if plain.is_empty() {
        "host".into()
    } else {
        plain
    }
}

/// May this letter be in a machine's name? No dot is, so that names of files cannot be taken for it.
fn is_plain(letter: char) -> bool {
    letter.is_ascii_alphanumeric() || "-_".contains(letter)
}

/// Brings a folder's names to the disk, where its file system and its permissions let it be done.
#[cfg(unix)]
fn sync_folder(folder: &Path) -> io::Result<()> {
    use io::ErrorKind::{InvalidInput, PermissionDenied, Unsupported};
    match File::open(folder).and_then(|folder| folder.sync_all()) {
        Err(error) if matches!(error.kind(), InvalidInput | PermissionDenied | Unsupported) => {
            Ok(())
        }
        synced => synced,
    }
}

/// Folders cannot be opened here; their names are brought to the disk by the system.
#[cfg(not(unix))]
fn sync_folder(_folder: &Path) -> io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ErrorKind;

    #[test]
    fn the_bytes_are_replaced_and_nothing_else_is_left_behind() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out");
        check_replaceable(&path).unwrap();
        replace(&path, b"the old bytes").unwrap();
        replace(&path, b"new").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"new");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn what_fails_leaves_the_old_file_and_no_temporary_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("taken");
        std::fs::create_dir(&path).unwrap();
        assert_eq!(replace(&path, b"new").unwrap_err().kind(), ErrorKind::Io);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        let missing = folder.path().join("missing/out");
        let kinds = [check_replaceable(&missing), replace(&missing, b"new")]
            .map(|result| result.unwrap_err().kind());
        assert_eq!(kinds, [ErrorKind::MissingFile; 2]);
    }

    #[test]
    fn the_old_file_is_kept_under_another_name() {
        let folder = tempfile::tempdir().unwrap();
        let [path, previous] = ["a", "a.previous"].map(|name| folder.path().join(name));
        for (bytes, kept) in [(b"1", None), (b"2", Some(b"1")), (b"3", Some(b"2"))] {
            replace_keeping(&path, &previous, bytes).unwrap();
            assert_eq!(std::fs::read(&path).unwrap(), bytes);
            assert_eq!(
                std::fs::read(&previous).ok().as_deref(),
                kept.map(|b| &b[..])
            );
        }
        // As a writer leaves them that is killed before its last step.
        std::fs::remove_file(&previous).unwrap();
        std::fs::hard_link(&path, &previous).unwrap();
        replace_keeping(&path, &previous, b"4").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"4");
        assert_eq!(std::fs::read(&previous).unwrap(), b"3");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
    }

    #[cfg(unix)]
    #[test]
    fn links_and_devices_stay_what_they_are() {
        let folder = tempfile::tempdir().unwrap();
        let [path, link] = ["a", "link"].map(|name| folder.path().join(name));
        std::fs::write(&path, b"old").unwrap();
        std::os::unix::fs::symlink(&path, &link).unwrap();
        replace(&link, b"new").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"new");
        assert!(link.is_symlink());
        let null = Path::new("/dev/null");
        check_replaceable(null).unwrap();
        replace(null, b"nothing").unwrap();
        assert!(is_special(null));
    }

    #[test]
    fn temporary_names_say_what_and_whose_they_are() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("a.film");
        let files = [(); 2].map(|()| temporary_for(&target).unwrap());
        let names = files.each_ref().map(|file| file.path().to_owned());
        assert_ne!(names[0], names[1]);
        let owner = format!(".a.film.bidir-{}-{}-", host(), std::process::id());
        for name in &names {
            let name = name.file_name().unwrap();
            let text = name.to_str().unwrap();
            let random = text.strip_prefix(&owner).unwrap().strip_suffix(".tmp");
            assert!(random.is_some_and(|random| random.len() == 6), "{text}");
            let prefix = prefix(OsStr::new("a.film"));
            assert_eq!(writer_of(name, &prefix), Some(&*host()));
        }
    }

    #[test]
    fn names_of_any_length_have_temporary_files() {
        let folder = tempfile::tempdir().unwrap();
        for length in [LONGEST_NAME, LONGEST_NAME + 1, 250] {
            let path = folder.path().join("n".repeat(length));
            let left = folder.path().join(leftover(path.file_name().unwrap()));
            File::create(&left).unwrap();
            replace(&path, b"new").unwrap();
            assert!(path.exists() && !left.exists(), "{length}");
        }
    }

    /// The name of a temporary file of `name` that a killed process of this machine left behind.
    fn leftover(name: &OsStr) -> String {
        format!("{}{}-1-aB3dE6.tmp", prefix(name), host())
    }

    #[test]
    fn the_next_writer_removes_the_files_of_killed_ones_and_of_no_living_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let mut living = temporary_for(&path).unwrap();
        living.write_all(b"living").unwrap();
        let left = folder.path().join(leftover(OsStr::new("a.exr")));
        File::create(&left).unwrap();
        replace(&path, b"new").unwrap();
        assert!(!left.exists());
        living.persist(&path).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"living");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn writers_that_remove_leftovers_take_no_file_from_each_other() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        std::thread::scope(|scope| {
            for writer in 0..4u8 {
                let path = &path;
                scope.spawn(move || {
                    for _ in 0..10 {
                        replace(path, &[writer; 100]).unwrap();
                    }
                });
            }
        });
        assert_eq!(std::fs::read(&path).unwrap().len(), 100);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn leftovers_of_the_file_are_removed_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let make = |name: String| {
            let path = folder.path().join(name);
            File::create(&path).unwrap()
        };
        let here = host();
        let old = format!(".a.film.bidir-{here}-x-17-aB3dE6.tmp");
        for name in [
            ".a.film.bidir-HERE-17-aB3dE6.tmp",
            ".a.film.bidir-HERE-1-Z.tmp",
        ] {
            make(name.replace("HERE", &here));
        }
        let day = std::time::SystemTime::now() - OLD - Duration::from_secs(60);
        make(old).set_modified(day).unwrap();
        let others = [
            // Another machine's, which may still be written to.
            ".a.film.bidir-HERE-x-17-aB3dE6.tmp.",
            ".a.film.bidir-HERE-y-17-aB3dE6.tmp",
            // Of other files.
            ".a.bidir-HERE-17-aB3dE6.tmp",
            ".b.film.bidir-HERE-17-aB3dE6.tmp",
            ".a.film.previous.bidir-HERE-17-aB3dE6.tmp",
            ".a.film.bidir-b.bidir-HERE-17-aB3dE6.tmp",
            // No temporary files.
            "a.film",
            ".a.film.bidir-HERE-17-aB3dE6",
            ".a.film.bidir-HERE-x-aB3dE6.tmp",
        ];
        let mut others = others.map(|name| name.replace("HERE", &here));
        for name in &others {
            make(name.clone());
        }
        remove_leftovers(&folder.path().join("a.film"));
        let entries = std::fs::read_dir(folder.path()).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<_> = names.collect();
        names.sort();
        others.sort();
        assert_eq!(names, others);
    }

    #[cfg(unix)]
    #[test]
    fn the_file_is_as_public_as_any_other() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let mode = |name: &str| {
            let metadata = std::fs::metadata(folder.path().join(name)).unwrap();
            metadata.permissions().mode()
        };
        replace(&folder.path().join("replaced"), b"").unwrap();
        std::fs::write(folder.path().join("plain"), b"").unwrap();
        assert_eq!(mode("replaced"), mode("plain"));
    }
}

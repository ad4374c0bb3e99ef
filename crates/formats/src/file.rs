//! Replaces files atomically: at any time, a name stands for all of the old bytes or all of the new.
//!
//! The new bytes go to a temporary file in the same folder, as a rename between file systems is not
//! atomic. They are synced to the disk before the rename, as a power cut could otherwise leave an empty
//! file; then the folder is synced, so that the rename persists.
//!
//! The temporary file of `NAME` is called `.NAME.bidir-HOST-PROCESS-RANDOM.tmp`, so that names of
//! different machines in a shared folder do not collide, and so that a leftover of a killed process shows
//! its file and its writer. The writer holds a lock on it, which the system releases when the process is
//! killed: so the next writer of `NAME` can [`remove_leftovers`] without removing files in use.

use crate::error::{Error, Result};
use bidir::names::nearest;
use std::ffi::OsStr;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;
use tempfile::NamedTempFile;

/// Age at which a temporary file is a leftover on any machine: no write takes as long.
const OLD: Duration = Duration::from_secs(24 * 60 * 60);
/// Maximum length of the part of a name in a temporary file's name. Unit: bytes; file systems allow 255.
const LONGEST_NAME: usize = 128;
/// Number of attempts to lock a new temporary file before another process removes it as a leftover.
const ATTEMPTS: u32 = 100;

/// Replaces or creates a file. Readers that have it open keep the old bytes.
///
/// Of a link, the target is replaced. A device or a pipe is written to.
pub fn replace(path: &Path, bytes: &[u8]) -> Result<()> {
    replace_with(path, bytes, |_| Ok(()))
}

/// Replaces a file, and renames the old one to `previous`. If anything fails, both names keep their files.
pub fn replace_keeping(path: &Path, previous: &Path, bytes: &[u8]) -> Result<()> {
    replace_with(path, bytes, |target| {
        if !target.exists() {
            return Ok(());
        }
        // A second name for the old file, which stays when the new file takes the first name.
        let name = temporary_for(previous)?.into_temp_path();
        std::fs::remove_file(&name)?;
        std::fs::hard_link(target, &name).or_else(|_| std::fs::copy(target, &name).map(drop))?;
        // If the last writer was killed before its last step, both are names of one file. Then the rename
        // does nothing, and `name` is removed when it is dropped.
        std::fs::rename(&name, previous)
    })
}

/// Writes a temporary file, calls `before` with the file to replace, and renames.
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

/// Returns the file that a name stands for, with links resolved.
pub fn target_of(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_owned())
}

/// Returns true for something that a rename would destroy, such as a device or a pipe.
fn is_special(path: &Path) -> bool {
    path.metadata()
        .is_ok_and(|metadata| !metadata.is_file() && !metadata.is_dir())
}

/// Checks that [`replace`] can create its temporary file. Leaves nothing behind; on file systems with
/// unnamed files not even if the process is killed here.
pub fn check_replaceable(path: &Path) -> Result<()> {
    let target = target_of(path);
    if is_special(&target) {
        return Ok(());
    }
    let made = tempfile::tempfile_in(folder_of(&target));
    made.map(drop)
        .map_err(|error| Error::io(path, "write", &error))
}

/// Returns the folder of a file; `.` for a bare name.
pub fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Returns the existing file of a similar name and the same ending, in this folder or one of a similar name. None:
/// no name is near.
pub fn nearest_file(path: &Path) -> Option<PathBuf> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => Some(nearest_folder(folder)?),
        _ => None,
    };
    let name = path.file_name()?;
    let in_folder = |name: &OsStr| folder.as_deref().unwrap_or(Path::new("")).join(name);
    if folder.as_deref() != path.parent() && in_folder(name).is_file() {
        return Some(in_folder(name));
    }
    let has_ending = |near: &Path| near.extension() == path.extension();
    let near = nearest_entry(folder.as_deref(), name, has_ending)?;
    Some(in_folder(near.as_ref()))
}

/// Returns the folder itself if it exists, else one of a similar name. None: no name is near.
fn nearest_folder(folder: &Path) -> Option<PathBuf> {
    if folder.as_os_str().is_empty() || folder.is_dir() {
        return Some(folder.to_owned());
    }
    let parent = nearest_folder(folder.parent()?)?;
    let is_folder = |near: &Path| parent.join(near).is_dir();
    let near = nearest_entry(Some(&parent), folder.file_name()?, is_folder)?;
    Some(parent.join(near))
}

/// Returns the name nearest to `name` among those of a folder's entries that are wanted.
fn nearest_entry(
    folder: Option<&Path>,
    name: &OsStr,
    is_wanted: impl Fn(&Path) -> bool,
) -> Option<String> {
    let folder = folder.filter(|folder| !folder.as_os_str().is_empty());
    let entries = std::fs::read_dir(folder.unwrap_or(Path::new("."))).ok()?;
    let names = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    let mut names: Vec<_> = names.filter(|name| is_wanted(Path::new(name))).collect();
    names.sort();
    let near = nearest(name.to_str()?, names.iter().map(String::as_str))?;
    Some(near.to_owned())
}

/// Removes the temporary files of `path` that killed writers left behind: those of this machine that are
/// not locked, and those of other machines that are older than a day, as locks may not work across
/// machines. Errors are ignored.
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
            // An error means that another process has removed it.
            let _ = std::fs::remove_file(&file);
        }
    }
}

/// Removes a temporary file of this machine if its writer is gone. Locks it first, so that a writer that
/// has just created it notices.
fn remove_unlocked(path: &Path) {
    let Ok(file) = OpenOptions::new().write(true).open(path) else {
        return;
    };
    let is_left = match file.try_lock() {
        Ok(()) => true,
        Err(TryLockError::WouldBlock) => false,
        // The file system has no locks.
        Err(TryLockError::Error(_)) => is_old(path),
    };
    if is_left {
        let _ = std::fs::remove_file(path);
    }
}

/// Returns true if a file was last written so long ago that its writer is gone.
fn is_old(path: &Path) -> bool {
    let changed = path.metadata().and_then(|metadata| metadata.modified());
    let age = changed.ok().and_then(|changed| changed.elapsed().ok());
    age.is_some_and(|age| age > OLD)
}

/// Returns the prefix of the names of temporary files of `name`. Long names that begin alike share it.
fn prefix(name: &OsStr) -> String {
    let name = name.to_string_lossy();
    let mut end = name.len().min(LONGEST_NAME);
    while !name.is_char_boundary(end) {
        end -= 1;
    }
    format!(".{}.bidir-", &name[..end])
}

/// Returns the machine that wrote a temporary file. None: the name is not that of a temporary file with
/// this prefix.
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

/// Creates an empty file beside `target`, locked if possible, which is removed when it is dropped.
fn temporary_for(target: &Path) -> io::Result<NamedTempFile> {
    let prefix = target.file_name().map_or_else(|| ".bidir-".into(), prefix);
    let prefix = format!("{prefix}{}-{}-", host(), std::process::id());
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(".tmp");
    // Temporary files are private by default, but the result has the permissions of any new file.
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

/// Locks a new temporary file. False: another process is removing it as a leftover.
fn is_held(file: &File) -> io::Result<bool> {
    match file.try_lock() {
        Ok(()) => is_linked(file),
        Err(TryLockError::WouldBlock) => Ok(false),
        // Without locks, the random name has to suffice.
        Err(TryLockError::Error(_)) => Ok(true),
    }
}

/// Returns true if an open file still has a name.
#[cfg(unix)]
fn is_linked(file: &File) -> io::Result<bool> {
    Ok(std::os::unix::fs::MetadataExt::nlink(&file.metadata()?) > 0)
}

/// Returns true, as open files keep their names on this system.
#[cfg(not(unix))]
fn is_linked(_file: &File) -> io::Result<bool> {
    Ok(true)
}

/// Returns the name of this machine for file names; `host` if it is unknown.
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

/// Returns true for a character allowed in a machine's name. Dots are not, so that no file name matches.
fn is_plain(letter: char) -> bool {
    letter.is_ascii_alphanumeric() || "-_".contains(letter)
}

/// Syncs a folder to the disk if its file system and permissions allow that.
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

/// Does nothing: this system cannot open folders, and syncs them itself.
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
    fn a_failure_leaves_the_old_file_and_no_temporary_one() {
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
        // The state that a writer leaves when it is killed before its last step.
        std::fs::remove_file(&previous).unwrap();
        std::fs::hard_link(&path, &previous).unwrap();
        replace_keeping(&path, &previous, b"4").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"4");
        assert_eq!(std::fs::read(&previous).unwrap(), b"3");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
    }

    #[cfg(unix)]
    #[test]
    fn links_and_devices_are_not_replaced() {
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
    fn temporary_names_have_the_file_and_its_writer() {
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

    /// Returns the name of a temporary file of `name` that a killed process of this machine left behind.
    fn leftover(name: &OsStr) -> String {
        format!("{}{}-1-aB3dE6.tmp", prefix(name), host())
    }

    #[test]
    fn the_next_writer_removes_only_files_of_killed_writers() {
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
    fn concurrent_writers_do_not_remove_each_others_files() {
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
            // Of another machine, whose writer may be running.
            ".a.film.bidir-HERE-x-17-aB3dE6.tmp.",
            ".a.film.bidir-HERE-y-17-aB3dE6.tmp",
            // Of other files.
            ".a.bidir-HERE-17-aB3dE6.tmp",
            ".b.film.bidir-HERE-17-aB3dE6.tmp",
            ".a.film.previous.bidir-HERE-17-aB3dE6.tmp",
            ".a.film.bidir-b.bidir-HERE-17-aB3dE6.tmp",
            // Not temporary files.
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
    fn the_file_has_the_permissions_of_any_new_file() {
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

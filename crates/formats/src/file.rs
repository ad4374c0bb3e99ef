//! Replaces files atomically: at any time, a file has all of the old bytes or all of the new ones.
//!
//! The new bytes go to a temporary file in the same folder, as a rename between file systems is not
//! atomic. They are synced to the disk before the rename, as a power cut could otherwise leave an empty
//! file; then the folder is synced, so that the rename persists.
//!
//! The temporary file of `NAME` is called `.NAME.bidir-RANDOM.tmp`. So no two writers share one, even on
//! different machines, and the leftover of a killed process shows which file it belongs to. The next writer
//! of `NAME` removes temporary files that nobody has written to for an hour.

use crate::error::{Error, Result};
use bidir::names::nearest;
use std::ffi::OsStr;
use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;
use tempfile::NamedTempFile;

/// Time without a change after which a temporary file is a leftover: no write pauses for so long.
const OLD: Duration = Duration::from_secs(60 * 60);
/// Maximum length of NAME in the name of a temporary file. Unit: bytes; file systems allow 255 in all.
const LONGEST_NAME: usize = 128;

/// Replaces or creates a file. Readers that have it open keep the old bytes.
///
/// Replaces the target of a link. Writes to a device or a pipe.
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
        remove_leftovers(target, OLD);
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

/// Checks that [`replace`] can create its temporary file. Leaves no file behind, on file systems with
/// unnamed files not even if the process is killed during the check.
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

/// Returns the name nearest to `name` among the entries of a folder for which `is_wanted` is true.
fn nearest_entry(
    folder: Option<&Path>,
    name: &OsStr,
    is_wanted: impl Fn(&Path) -> bool,
) -> Option<String> {
    let folder = folder.filter(|folder| !folder.as_os_str().is_empty());
    let entries = std::fs::read_dir(folder.unwrap_or(Path::new("."))).ok()?;
    let all = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    let mut names: Vec<_> = all.filter(|name| is_wanted(Path::new(name))).collect();
    names.sort();
    let near = nearest(name.to_str()?, names.iter().map(String::as_str))?;
    Some(near.to_owned())
}

/// Removes the temporary files of `path` that nobody has written to for at least `age`. Ignores errors.
pub fn remove_leftovers(path: &Path, age: Duration) {
    let target = target_of(path);
    let Some(prefix) = target.file_name().map(prefix) else {
        return;
    };
    let entries = std::fs::read_dir(folder_of(&target));
    for entry in entries.into_iter().flatten().flatten() {
        if is_temporary(&entry.file_name(), &prefix) && is_older(&entry.path(), age) {
            // An error means that another process has removed it.
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

/// Returns true if a file exists and was last written to at least `age` ago, or in the future by this machine's clock.
fn is_older(path: &Path, age: Duration) -> bool {
    let changed = path.metadata().and_then(|metadata| metadata.modified());
    changed.is_ok_and(|changed| changed.elapsed().unwrap_or_default() >= age)
}

/// Returns the prefix of the names of temporary files of `name`. Long names that end alike share it.
fn prefix(name: &OsStr) -> String {
    let name = name.to_string_lossy();
    let mut begin = name.len().saturating_sub(LONGEST_NAME);
    while !name.is_char_boundary(begin) {
        begin += 1;
    }
    format!(".{}.bidir-", &name[begin..])
}

/// Returns true for the name of a temporary file with this prefix.
fn is_temporary(name: &OsStr, prefix: &str) -> bool {
    let rest = name.to_str().and_then(|name| name.strip_prefix(prefix));
    let random = rest.and_then(|rest| rest.strip_suffix(".tmp"));
    random.is_some_and(|random| random.chars().all(|letter| letter.is_ascii_alphanumeric()))
}

/// Creates an empty file beside `target`, which is removed when it is dropped.
fn temporary_for(target: &Path) -> io::Result<NamedTempFile> {
    let prefix = target.file_name().map_or_else(|| ".bidir-".into(), prefix);
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(".tmp");
    // Temporary files are private by default, but the result has the permissions of any new file.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder_of(target))
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
    use std::collections::BTreeSet;
    use std::time::SystemTime;

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
    fn old_temporary_files_of_the_name_are_removed_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let long = "n".repeat(250);
        let make = |name: &str, age: Duration| {
            let file = File::create(folder.path().join(name)).unwrap();
            file.set_modified(SystemTime::now() - age).unwrap();
        };
        for name in [
            ".a.film.bidir-aB3dE6.tmp",
            &format!(".{}.bidir-a.tmp", &long[250 - LONGEST_NAME..]),
        ] {
            make(name, OLD);
        }
        let others = [
            // Of other files.
            ".a.bidir-aB3dE6.tmp",
            ".a.film.bidir-b.bidir-aB3dE6.tmp",
            ".a.film.previous.bidir-aB3dE6.tmp",
            // Not temporary files.
            ".a.film.bidir-aB3dE6",
            ".a.film.bidir-aB3dE6.tmp.",
        ];
        for name in &others {
            make(name, 2 * OLD);
        }
        let young = ".a.film.bidir-Young1.tmp";
        make(young, OLD / 2);
        let names = || {
            let entries = std::fs::read_dir(folder.path()).unwrap();
            let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
            names.collect::<BTreeSet<_>>()
        };
        for name in ["a.film", &long] {
            replace(&folder.path().join(name), b"new").unwrap();
        }
        let mut left: BTreeSet<_> = others.map(str::to_owned).into();
        left.extend(["a.film", &long, young].map(str::to_owned));
        assert_eq!(names(), left);
        remove_leftovers(&folder.path().join("a.film"), Duration::ZERO);
        left.remove(young);
        assert_eq!(names(), left);
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

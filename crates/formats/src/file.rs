//! Files that are replaced as a whole: whatever happens, a name stands for all of the old bytes or
//! all of the new.
//!
//! The new bytes go to a temporary file in the same folder, as a rename between file systems is a
//! copy and not one step. They are on the disk before the rename, else a power cut could leave an
//! empty file under the name; then the folder is, so that the rename itself lasts.
//!
//! The temporary file is called `.bidir-HOST-PROCESS-RANDOM.tmp`, so that the machines that write to
//! a shared folder stay apart, and so that what a killed process left behind says whose it was.

use crate::error::{Error, Result};
use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

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
        let name = temporary_in(folder_of(previous))?.into_temp_path();
        std::fs::remove_file(&name)?;
        std::fs::hard_link(target, &name).or_else(|_| std::fs::copy(target, &name).map(drop))?;
        name.persist(previous)?;
        Ok(())
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
        let folder = folder_of(target);
        let mut file = temporary_in(folder)?;
        file.write_all(bytes)?;
        file.as_file().sync_all()?;
        before(target)?;
        file.persist(target)?;
        sync_folder(folder)
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

/// Says now whether [`replace`] can make its temporary file; nothing is left behind.
pub fn check_replaceable(path: &Path) -> Result<()> {
    let target = target_of(path);
    if is_special(&target) {
        return Ok(());
    }
    let made = temporary_in(folder_of(&target));
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

/// An empty file that is removed when it is dropped.
fn temporary_in(folder: &Path) -> io::Result<NamedTempFile> {
    let prefix = format!(".bidir-{}-{}-", host(), std::process::id());
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(".tmp");
    // A temporary file is private unless told otherwise; an image is as public as any new file.
    #[cfg(unix)]
    let public = std::os::unix::fs::PermissionsExt::from_mode(0o666);
    #[cfg(unix)]
    builder.permissions(public);
    builder.tempfile_in(folder)
}

/// The name of this machine, as part of a file's name; `host` where it cannot be told.
fn host() -> String {
    let name = std::fs::read_to_string("/proc/sys/kernel/hostname")
        .or_else(|_| std::env::var("COMPUTERNAME"))
        .or_else(|_| std::env::var("HOSTNAME"))
        .unwrap_or_default();
    let is_plain = |letter: &char| letter.is_ascii_alphanumeric() || "-_".contains(*letter);
    let plain: String = name.chars().filter(is_plain).take(64).collect();
    if plain.is_empty() {
        "host".into()
    } else {
        plain
    }
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
    fn temporary_names_say_whose_they_are() {
        let folder = tempfile::tempdir().unwrap();
        let files = [(); 2].map(|()| temporary_in(folder.path()).unwrap());
        let names = files.each_ref().map(|file| file.path().to_owned());
        assert_ne!(names[0], names[1]);
        let owner = format!(".bidir-{}-{}-", host(), std::process::id());
        for name in &names {
            let name = name.file_name().unwrap().to_str().unwrap();
            let random = name.strip_prefix(&owner).unwrap().strip_suffix(".tmp");
            assert!(random.is_some_and(|random| random.len() == 6), "{name}");
        }
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

//! Saves images for clients, only into one folder, and never over files that others wrote.

use std::collections::BTreeSet;
use std::fs::{self, OpenOptions};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The longest name. Unit: bytes.
const LONGEST: usize = 200;

/// A folder, and the names of the files that were saved in it.
#[derive(Debug)]
pub(super) struct Saved {
    folder: PathBuf,
    names: BTreeSet<String>,
}

impl Saved {
    pub(super) fn new(folder: PathBuf) -> Self {
        let names = BTreeSet::new();
        Self { folder, names }
    }

    /// Returns the names of the files that were written.
    pub(super) fn into_names(self) -> Vec<String> {
        self.names.into_iter().collect()
    }

    /// Calls `write` to write the file of this name.
    ///
    /// Errors: the name is not valid for an image in this folder, another file has it, or the file cannot be written.
    pub(super) fn save(
        &mut self,
        name: &str,
        write: impl FnOnce(&Path) -> Result<(), String>,
    ) -> Result<(), String> {
        check_name(name)?;
        let path = self.folder.join(name);
        let is_new = !self.names.contains(name);
        if is_new {
            reserve(&path, name)?;
        }
        write(&path).inspect_err(|_| {
            if is_new {
                // The empty file is ours; where it is gone there is nothing to do.
                let _ = fs::remove_file(&path);
            }
        })?;
        self.names.insert(name.to_owned());
        Ok(())
    }
}

/// Refuses names that are too long, have special characters or folders, begin with a dot, or do not end in `.exr`.
fn check_name(name: &str) -> Result<(), String> {
    let is_plain = |c: char| c.is_alphanumeric() || matches!(c, ' ' | '.' | '-' | '_' | '+');
    let is_name = name.len() <= LONGEST && name.chars().all(is_plain) && !name.starts_with('.');
    let is_exr = name
        .strip_suffix(".exr")
        .is_some_and(|stem| !stem.is_empty());
    if is_name && is_exr {
        return Ok(());
    }
    let rule = "letters, digits, spaces, `.`, `-`, `_` and `+`, and `.exr` at the end";
    Err(format!(
        "`{}` is not saved: a name can have {rule}",
        name.escape_debug()
    ))
}

/// Creates an empty file. Errors: the file exists.
fn reserve(path: &Path, name: &str) -> Result<(), String> {
    let made = OpenOptions::new().write(true).create_new(true).open(path);
    made.map(|_| ()).map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => {
            format!("`{name}` exists already and is not replaced: choose another name")
        }
        _ => format!("cannot write `{name}`: {error}"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_do_not_lead_elsewhere() {
        for name in ["a.exr", "room 2.exr", "Zimmer-ä_1.exr"] {
            assert_eq!(check_name(name), Ok(()));
        }
        for name in [
            "", ".exr", "a.png", "a.exr.sh", "../a.exr", "/a.exr", "b/a.exr", "b\\a.exr",
            "c:a.exr", ".a.exr", "a\0.exr", "a\n.exr",
        ] {
            assert!(check_name(name).is_err(), "{name:?}");
        }
        assert!(check_name(&format!("{}.exr", "a".repeat(LONGEST))).is_err());
    }

    #[test]
    fn nothing_of_others_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let mut saved = Saved::new(folder.path().to_owned());
        let write = |text: &'static str| {
            move |path: &Path| fs::write(path, text).map_err(|error| error.to_string())
        };
        fs::write(folder.path().join("theirs.exr"), "theirs").unwrap();
        assert!(saved.save("theirs.exr", write("ours")).is_err());
        saved.save("ours.exr", write("first")).unwrap();
        saved.save("ours.exr", write("second")).unwrap();
        let failed = saved.save("failed.exr", |_| Err("no room".to_owned()));
        assert_eq!(failed, Err("no room".to_owned()));
        let read = |name: &str| fs::read_to_string(folder.path().join(name)).ok();
        assert_eq!(read("theirs.exr").as_deref(), Some("theirs"));
        assert_eq!(read("ours.exr").as_deref(), Some("second"));
        assert_eq!(read("failed.exr"), None);
        assert_eq!(saved.into_names(), ["ours.exr"]);
    }
}

//! Checks that outputs replace neither inputs nor each other.
//!
//! Files are compared by identity: device and inode after all links, so that `a.png`, `./a.png`, a symbolic
//! link and a hard link to it are one file. A file that does not exist yet is identified by its folder's
//! identity and its name. Devices and pipes are written to and never replaced, so they equal no file.
//!
//! A command that writes files calls [`check`] before it renders, as soon as it knows all its inputs.

use crate::error::{Error, ErrorKind, Result};
use crate::file::folder_of;
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// A file that will be written.
#[derive(Clone, Copy, Debug)]
pub struct Output<'a> {
    /// The name of the file.
    pub path: &'a Path,
    /// The flag that names the file. None: there is no flag.
    pub flag: Option<&'a str>,
}

/// Checks that no output replaces one of `inputs` or another output. Inputs that do not exist are ignored.
///
/// Errors: of kind [`ErrorKind::Io`], with both names.
pub fn check<'a>(inputs: impl IntoIterator<Item = &'a Path>, outputs: &[Output<'_>]) -> Result<()> {
    let read: BTreeMap<_, _> = inputs
        .into_iter()
        .filter_map(|path| Some((Identity::of_existing(path)?, path)))
        .collect();
    let mut written: BTreeMap<Identity, &Path> = BTreeMap::new();
    for output in outputs {
        let Some(identity) = Identity::of(output.path) else {
            continue;
        };
        if let Some(input) = read.get(&identity) {
            return Err(refusal(output, "would replace the input", input));
        }
        if let Some(other) = written.insert(identity, output.path) {
            return Err(refusal(output, "would replace the other output", other));
        }
    }
    Ok(())
}

/// Returns true if both names stand for one file.
pub fn is_same(a: &Path, b: &Path) -> bool {
    Identity::of(a).is_some_and(|identity| Some(identity) == Identity::of(b))
}

fn refusal(output: &Output<'_>, does: &str, other: &Path) -> Error {
    let [path, other] = [output.path, other].map(Path::display);
    let message = format!("cannot write `{path}`: it {does} `{other}`");
    let hint = match output.flag {
        Some(flag) => format!("name another file with {flag}"),
        None => "name another file".to_owned(),
    };
    Error::naming(output.path, ErrorKind::Io, message).with_hint(hint)
}

/// The identity of a file.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Identity {
    /// A file or a folder by device and inode.
    Node(u64, u64),
    /// A new file in an existing folder.
    New(Box<Self>, OsString),
    /// A path, if nothing else is known.
    Path(PathBuf),
}

impl Identity {
    /// Returns the identity of a file. None: a device, a pipe or a socket.
    fn of(path: &Path) -> Option<Self> {
        if path.exists() {
            return Self::of_existing(path);
        }
        Some(Self::of_new(path))
    }

    /// Returns the identity of an existing file. None: it does not exist, or is a device, a pipe or a socket.
    fn of_existing(path: &Path) -> Option<Self> {
        let metadata = path.metadata().ok()?;
        let is_plain = metadata.is_file() || metadata.is_dir();
        is_plain.then(|| Self::of_node(path, &metadata))
    }

    fn of_new(path: &Path) -> Self {
        let folder = folder_of(path);
        match (folder.metadata(), path.file_name()) {
            (Ok(metadata), Some(name)) => {
                let folder = Box::new(Self::of_node(folder, &metadata));
                Self::New(folder, name.to_owned())
            }
            _ => Self::Path(std::path::absolute(path).unwrap_or_else(|_| path.to_owned())),
        }
    }

    #[cfg(unix)]
    fn of_node(_path: &Path, metadata: &std::fs::Metadata) -> Self {
        use std::os::unix::fs::MetadataExt;
        Self::Node(metadata.dev(), metadata.ino())
    }

    #[cfg(not(unix))]
    fn of_node(path: &Path, _metadata: &std::fs::Metadata) -> Self {
        Self::Path(crate::file::target_of(path))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[track_caller]
    fn message(inputs: &[&Path], outputs: &[&Path]) -> String {
        let flag = Some("--output");
        let outputs: Vec<_> = outputs.iter().map(|&path| Output { path, flag }).collect();
        let checked = check(inputs.iter().copied(), &outputs);
        checked.map_or_else(|error| error.to_string(), |()| String::new())
    }

    #[test]
    fn an_output_equals_an_input_by_any_of_its_names() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("a.png"), "a").unwrap();
        fs::create_dir(at("sub")).unwrap();
        for name in ["a.png", "./a.png", "sub/../a.png"] {
            let (input, output) = (at("a.png"), at(name));
            let text = message(&[&input], &[&output]);
            let expected = format!(
                "cannot write `{}`: it would replace the input `{}`; name another file with --output",
                output.display(),
                input.display()
            );
            assert_eq!(text, expected);
        }
        assert_eq!(
            message(&[&at("a.png")], &[&at("b.png"), &at("sub/a.png")]),
            ""
        );
        // The input does not exist, so nothing is lost.
        assert_eq!(message(&[&at("none.png")], &[&at("none.png")]), "");
    }

    #[test]
    fn equal_outputs_are_found_before_they_exist() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("sub")).unwrap();
        let text = message(&[], &[&at("a.json"), &at("sub/../a.json")]);
        assert!(text.contains("it would replace the other output"), "{text}");
        assert_ne!(message(&[], &[&at("no/a"), &at("no/./a")]), "");
        assert_eq!(message(&[], &[&at("a.json"), &at("sub/a.json")]), "");
    }

    #[cfg(unix)]
    #[test]
    fn links_are_resolved_and_devices_equal_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("a"), "a").unwrap();
        fs::hard_link(at("a"), at("second")).unwrap();
        std::os::unix::fs::symlink("a", at("link")).unwrap();
        std::os::unix::fs::symlink(".", at("here")).unwrap();
        for name in ["second", "link", "here/a"] {
            assert_ne!(message(&[&at("a")], &[&at(name)]), "", "{name}");
            assert_ne!(message(&[&at(name)], &[&at("a")]), "", "{name}");
            assert!(is_same(&at(name), &at("a")), "{name}");
        }
        assert_ne!(message(&[], &[&at("b"), &at("here/b")]), "");
        let null = Path::new("/dev/null");
        assert_eq!(message(&[null], &[null, null]), "");
    }
}

//! Outputs never replace what is read, nor each other.
//!
//! Files are compared by identity: device and inode after all links, so that `a.png`, `./a.png`, a link
//! to it and a second name of it are one file. A file that is not there yet is its name in the identity of
//! its folder. Devices and pipes are written to and never replaced, so they are equal to nothing.
//!
//! A command that writes files calls [`check`] when it knows all that it reads, before it renders.

use crate::error::{Error, ErrorKind, Result};
use crate::file::folder_of;
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// A file that will be written.
#[derive(Clone, Copy, Debug)]
pub struct Output<'a> {
    /// Its name.
    pub path: &'a Path,
    /// The flag by which another name can be given. None: there is no flag.
    pub flag: Option<&'a str>,
}

/// Fails where an output would replace one of `inputs`, or another output. Inputs that are not there are
/// ignored.
///
/// Errors: of kind [`ErrorKind::Io`], with both names.
pub fn check<'a>(inputs: impl IntoIterator<Item = &'a Path>, outputs: &[Output<'_>]) -> Result<()> {
    let there = inputs.into_iter().filter(|path| path.exists());
    let read: BTreeMap<_, _> = there
        .filter_map(|path| Some((Identity::of(path)?, path)))
        .collect();
    let mut written: BTreeMap<Identity, &Path> = BTreeMap::new();
    for output in outputs {
        let Some(identity) = Identity::of(output.path) else {
            continue;
        };
        if let Some(input) = read.get(&identity) {
            return Err(refused(output, "would replace the input", input));
        }
        if let Some(other) = written.insert(identity, output.path) {
            return Err(refused(output, "would replace the other output", other));
        }
    }
    Ok(())
}

/// True where both names are of one file.
pub fn is_same(a: &Path, b: &Path) -> bool {
    Identity::of(a).is_some_and(|identity| Some(identity) == Identity::of(b))
}

fn refused(output: &Output<'_>, does: &str, other: &Path) -> Error {
    let [path, other] = [output.path, other].map(Path::display);
    let message = format!("cannot write `{path}`: it {does} `{other}`");
    let hint = match output.flag {
        Some(flag) => format!("name another file with {flag}"),
        None => "name another file".to_owned(),
    };
    Error::naming(output.path, ErrorKind::Io, message).with_hint(hint)
}

/// Which file a name stands for.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Identity {
    /// A file or a folder by device and inode.
    Node(u64, u64),
    /// A file that is not there, in a folder that is.
    New(Box<Self>, OsString),
    /// All that is known of it.
    Path(PathBuf),
}

impl Identity {
    /// None: a device, a pipe or a socket.
    fn of(path: &Path) -> Option<Self> {
        match path.metadata() {
            Ok(metadata) if metadata.is_file() || metadata.is_dir() => {
                Some(Self::of_node(path, &metadata))
            }
            Ok(_) => None,
            Err(_) => Some(Self::of_new(path)),
        }
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
    fn said(inputs: &[&Path], outputs: &[&Path]) -> String {
        let flag = Some("--output");
        let outputs: Vec<_> = outputs.iter().map(|&path| Output { path, flag }).collect();
        let checked = check(inputs.iter().copied(), &outputs);
        checked.map_or_else(|error| error.to_string(), |()| String::new())
    }

    #[test]
    fn an_output_is_no_input_by_any_name() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("a.png"), "a").unwrap();
        fs::create_dir(at("sub")).unwrap();
        for name in ["a.png", "./a.png", "sub/../a.png"] {
            let (input, output) = (at("a.png"), at(name));
            let text = said(&[&input], &[&output]);
            let expected = format!(
                "cannot write `{}`: it would replace the input `{}`; name another file with --output",
                output.display(),
                input.display()
            );
            assert_eq!(text, expected);
        }
        assert_eq!(said(&[&at("a.png")], &[&at("b.png"), &at("sub/a.png")]), "");
        // There is nothing to lose.
        assert_eq!(said(&[&at("none.png")], &[&at("none.png")]), "");
    }

    #[test]
    fn outputs_are_not_each_other_before_they_are_there() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("sub")).unwrap();
        let text = said(&[], &[&at("a.json"), &at("sub/../a.json")]);
        assert!(text.contains("it would replace the other output"), "{text}");
        assert_ne!(said(&[], &[&at("no/a"), &at("no/./a")]), "");
        assert_eq!(said(&[], &[&at("a.json"), &at("sub/a.json")]), "");
    }

    #[cfg(unix)]
    #[test]
    fn links_lead_to_one_file_and_devices_are_none() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("a"), "a").unwrap();
        fs::hard_link(at("a"), at("second")).unwrap();
        std::os::unix::fs::symlink("a", at("link")).unwrap();
        std::os::unix::fs::symlink(".", at("here")).unwrap();
        for name in ["second", "link", "here/a"] {
            assert_ne!(said(&[&at("a")], &[&at(name)]), "", "{name}");
            assert_ne!(said(&[&at(name)], &[&at("a")]), "", "{name}");
            assert!(is_same(&at(name), &at("a")), "{name}");
        }
        assert_ne!(said(&[], &[&at("b"), &at("here/b")]), "");
        let null = Path::new("/dev/null");
        assert_eq!(said(&[null], &[null, null]), "");
    }
}

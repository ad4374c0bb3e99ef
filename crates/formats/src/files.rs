//! The source of a scene's files: the disk, or memory.

use crate::bytes::{self, FileBytes};
use crate::error::{Error, Result};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The contents of files by the names under which they are requested.
pub type InMemory = BTreeMap<PathBuf, Arc<[u8]>>;

/// The files of a scene, from memory or the disk. The default is the disk.
///
/// Scenes are sent with all of their files in memory: such a scene is the same on any machine. Names that
/// share one [`Arc`] are names of one file. Bytes are as on the disk: packed, if the name ends in `.gz`.
///
/// ```
/// use bidir_formats::scene::{Files, LoadOptions, load_from};
/// use std::path::{Path, PathBuf};
/// use std::sync::Arc;
///
/// let text = "WorldBegin LightSource \"infinite\"";
/// let name = PathBuf::from("sky.pbrt");
/// let files = Files::only([(name, Arc::from(text.as_bytes()))].into());
/// let loaded = load_from(Path::new("sky.pbrt"), &LoadOptions::default(), &files)?;
/// assert_eq!(loaded.files, [PathBuf::from("sky.pbrt")]);
/// # Ok::<(), bidir_formats::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Files {
    memory: Arc<InMemory>,
    others: Others,
}

/// The treatment of names that are not in memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Others {
    #[default]
    OnDisk,
    Missing,
}

impl Files {
    /// Returns a source with these files only.
    pub fn only(memory: InMemory) -> Self {
        Self {
            memory: Arc::new(memory),
            others: Others::Missing,
        }
    }

    /// Returns a source with these files, and the disk for all other names.
    pub fn over_disk(memory: InMemory) -> Self {
        Self {
            memory: Arc::new(memory),
            others: Others::OnDisk,
        }
    }

    /// True where this name is in memory.
    pub fn has_in_memory(&self, path: &Path) -> bool {
        self.memory.contains_key(path)
    }

    /// Reads a whole file of at most `limit` bytes, and unpacks it if its name ends in `.gz`.
    pub(crate) fn read(&self, path: &Path, limit: u64) -> Result<FileBytes> {
        match (self.memory.get(path), self.others) {
            (Some(stored), _) => bytes::read_stored(stored, path, limit),
            (None, Others::OnDisk) => bytes::read(path, limit),
            (None, Others::Missing) => {
                let error = std::io::ErrorKind::NotFound.into();
                Err(Error::io(path, "open", &error))
            }
        }
    }

    /// Reads a file as [`read`](Self::read) does, or standard input for `-` unless that name is in memory.
    pub(crate) fn read_or_stdin(&self, path: &Path, limit: u64) -> Result<FileBytes> {
        let is_stdin = path.as_os_str() == bytes::STDIN && self.others == Others::OnDisk;
        if is_stdin && !self.memory.contains_key(path) {
            return bytes::read_or_stdin(path, limit);
        }
        self.read(path, limit)
    }

    /// Returns true for a folder on the disk, if names are read from there.
    pub(crate) fn is_folder(&self, path: &Path) -> bool {
        !self.memory.contains_key(path) && self.others == Others::OnDisk && path.is_dir()
    }

    /// Returns true if the file exists.
    pub(crate) fn exists(&self, path: &Path) -> bool {
        let is_on_disk = || self.others == Others::OnDisk && path.exists();
        self.memory.contains_key(path) || is_on_disk()
    }

    /// Returns true if a name stands for a file on the disk, which need not exist.
    pub(crate) fn is_from_disk(&self, path: &Path) -> bool {
        let is_stdin = path.as_os_str() == bytes::STDIN;
        self.others == Others::OnDisk && !is_stdin && !self.memory.contains_key(path)
    }

    /// Returns one name for all names of a file.
    pub(crate) fn identity(&self, path: &Path) -> PathBuf {
        let Some(stored) = self.memory.get(path) else {
            return path.canonicalize().unwrap_or_else(|_| path.to_owned());
        };
        let mut names = self.memory.iter();
        let first = names.find(|(_, other)| Arc::ptr_eq(stored, other));
        first.map_or(path, |(name, _)| name).to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ErrorKind;
    use crate::scene::{LoadOptions, Loaded, load, load_from};

    const SCENE: &str = "WorldBegin\n\
        Include \"part.pbrt\" Include \"sub/../part.pbrt\"\n\
        Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"t.pfm\"\n\
        Material \"diffuse\" \"texture reflectance\" \"t\"\n\
        Shape \"plymesh\" \"string filename\" \"m.ply\"\n";
    const PART: &str = "LightSource \"point\"\n";
    const MESH: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n\
        property float y\nproperty float z\nelement face 1\n\
        property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

    fn contents() -> [(&'static str, Vec<u8>); 4] {
        let mut image = b"PF\n1 1\n-1.0\n".to_vec();
        image.extend([0.5f32; 3].iter().flat_map(|channel| channel.to_le_bytes()));
        [
            ("s.pbrt", SCENE.into()),
            ("part.pbrt", PART.into()),
            ("m.ply", MESH.into()),
            ("t.pfm", image),
        ]
    }

    fn in_memory(folder: &Path, loaded: &Loaded) -> InMemory {
        let mut memory = InMemory::new();
        for (name, bytes) in contents() {
            let bytes: Arc<[u8]> = bytes.into();
            let is_this = |path: &&PathBuf| path.ends_with(name);
            for path in loaded.files.iter().filter(is_this) {
                memory.insert(path.clone(), Arc::clone(&bytes));
            }
            assert!(memory.contains_key(&folder.join(name)), "{name}");
        }
        memory
    }

    #[test]
    fn a_scene_is_the_same_from_memory() {
        let folder = tempfile::tempdir().unwrap();
        for (name, bytes) in contents() {
            std::fs::write(folder.path().join(name), bytes).unwrap();
        }
        std::fs::create_dir(folder.path().join("sub")).unwrap();
        let scene = folder.path().join("s.pbrt");
        let options = LoadOptions::default();
        let there = load(&scene, &options).unwrap();
        // Each file counts under every name by which it was requested.
        assert_eq!(there.files.len(), 5, "{:?}", there.files);
        let memory = in_memory(folder.path(), &there);
        drop(folder);
        let here = load_from(&scene, &options, &Files::only(memory.clone())).unwrap();
        assert_eq!((here.digest, &here.files), (there.digest, &there.files));
        let mut inputs = there.files.clone();
        inputs.sort();
        // Inputs are files on the disk, which outputs must not replace.
        assert_eq!((there.inputs, here.inputs), (inputs, Vec::new()));
        let mut others = memory.clone();
        others.retain(|path, _| !path.ends_with("m.ply"));
        let error = load_from(&scene, &options, &Files::only(others)).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::MissingFile);
        assert_eq!((error.line(), error.column()), (Some(5), Some(35)));
        // Another byte makes another scene.
        let mut changed = memory;
        let part = PART.replace("point", "infinite");
        let part: Arc<[u8]> = part.into_bytes().into();
        let parts = changed
            .iter_mut()
            .filter(|(path, _)| path.ends_with("part.pbrt"));
        parts.for_each(|(_, bytes)| *bytes = Arc::clone(&part));
        let other = load_from(&scene, &options, &Files::only(changed)).unwrap();
        assert_ne!(other.digest, there.digest);
    }

    #[test]
    fn memory_takes_precedence_over_the_disk() {
        let folder = tempfile::tempdir().unwrap();
        let [a, b] = ["a", "b"].map(|name| folder.path().join(name));
        for path in [&a, &b] {
            std::fs::write(path, b"disk").unwrap();
        }
        let memory: InMemory = [(a.clone(), Arc::from(&b"memory"[..]))].into();
        let both = Files::over_disk(memory.clone());
        assert_eq!(both.read(&a, 9).unwrap().bytes, b"memory");
        assert_eq!(both.read(&b, 9).unwrap().bytes, b"disk");
        assert_eq!(both.read(&a, 3).unwrap_err().kind(), ErrorKind::Limit);
        let only = Files::only(memory);
        assert!(both.exists(&b) && only.exists(&a) && !only.exists(&b));
        assert_eq!(only.read(&b, 9).unwrap_err().kind(), ErrorKind::MissingFile);
        let stdin = only.read_or_stdin(Path::new("-"), 9).unwrap_err();
        assert_eq!(stdin.kind(), ErrorKind::MissingFile);
    }
}

//! The search for the library.

use crate::error::DenoiseError;
use libloading::Library;
use std::error::Error;
use std::path::{Path, PathBuf};

/// The environment variable that names the library's file or folder.
pub const VARIABLE: &str = "BIDIR_OIDN";

/// The subfolders that are searched: the folder itself, and those of the project's archives.
const FOLDERS: [&str; 3] = ["", "lib", "bin"];

/// Returns the file names of the library on this system, in the order of the search.
pub fn names() -> &'static [&'static str] {
    if cfg!(windows) {
        &["OpenImageDenoise.dll"]
    } else if cfg!(target_os = "macos") {
        &["libOpenImageDenoise.2.dylib", "libOpenImageDenoise.dylib"]
    } else {
        &["libOpenImageDenoise.so.2", "libOpenImageDenoise.so"]
    }
}

/// A loaded library, not yet checked.
#[derive(Debug)]
pub(crate) struct Found {
    /// The library, never unloaded: its own threads may still run its code.
    pub(crate) library: &'static Library,
    /// Its file, or the name by which the system found it.
    pub(crate) file: PathBuf,
}

/// Loads the library from a file or folder; without one, the library that the system finds.
pub(crate) fn find(named: Option<&Path>) -> Result<Found, DenoiseError> {
    let Some(named) = named else {
        return find_by_system();
    };
    let unusable = |reason: String| DenoiseError::Unusable {
        file: named.to_owned(),
        reason,
    };
    let file = file_of(named).map_err(unusable)?;
    open(&file).map_err(unusable)
}

fn find_by_system() -> Result<Found, DenoiseError> {
    let mut reason = None;
    for name in names() {
        match open(Path::new(name)) {
            Ok(found) => return Ok(found),
            Err(error) => {
                reason.get_or_insert(error);
            }
        }
    }
    Err(DenoiseError::NotFound {
        names: names().to_vec(),
        reason: reason.unwrap_or_default(),
    })
}

/// Resolves a file, or the library's file in a folder. The path is absolute, so that the system does not
/// search elsewhere, and without links, so that the library finds its parts next to it.
fn file_of(named: &Path) -> Result<PathBuf, String> {
    let named = named.canonicalize().map_err(|error| error.to_string())?;
    if !named.is_dir() {
        return Ok(named);
    }
    let files = FOLDERS
        .iter()
        .flat_map(|folder| names().iter().map(move |name| Path::new(folder).join(name)));
    files
        .map(|file| named.join(file))
        .find_map(|file| file.canonicalize().ok())
        .ok_or_else(|| format!("the folder has no {}", names().join(", no ")))
}

/// Loads a library. Errors: the system's message.
fn open(file: &Path) -> Result<Found, String> {
    // SAFETY: loading runs the library's initialisers. The user names the file, or the system provides a
    // library with Open Image Denoise's name, as for any program linked to it.
    let library = unsafe { Library::new(file) }.map_err(|error| reason(&error))?;
    Ok(Found {
        library: Box::leak(Box::new(library)),
        file: file.to_owned(),
    })
}

/// Returns the system's message for an error, or else the error's own.
fn reason(error: &dyn Error) -> String {
    error.source().map_or_else(|| error.to_string(), reason)
}

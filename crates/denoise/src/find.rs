//! Where the library is looked for.

use crate::error::DenoiseError;
use libloading::Library;
use std::error::Error;
use std::path::{Path, PathBuf};

/// The environment variable that names the library's file, or a folder that has it.
pub const VARIABLE: &str = "BIDIR_OIDN";

/// Where a folder has the library: at once, or as the project's archives have it.
const FOLDERS: [&str; 3] = ["", "lib", "bin"];

/// The names by which the system is asked for the library, in this order.
pub fn names() -> &'static [&'static str] {
    if cfg!(windows) {
        &["OpenImageDenoise.dll"]
    } else if cfg!(target_os = "macos") {
        &["libOpenImageDenoise.2.dylib", "libOpenImageDenoise.dylib"]
    } else {
        &["libOpenImageDenoise.so.2", "libOpenImageDenoise.so"]
    }
}

/// A library that was loaded, whichever it is.
#[derive(Debug)]
pub(crate) struct Found {
    /// Never unloaded: threads of its own may still be in its code.
    pub(crate) library: &'static Library,
    /// Its file, or the name that the system found it by.
    pub(crate) file: PathBuf,
}

/// Loads what is named, a file or a folder; without a name, what the system finds.
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

/// The file that is named, or that the folder has; absolute, so that the system does not look for it
/// elsewhere, and without links, so that the library finds its parts beside it.
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

/// Loads a library. Errors: what the system says.
fn open(file: &Path) -> Result<Found, String> {
    // SAFETY: loading runs the library's initialisers. It is the user who names the file, or the
    // system that has the library under Open Image Denoise's name, as for any program linked to it.
    let library = unsafe { Library::new(file) }.map_err(|error| reason(&error))?;
    Ok(Found {
        library: Box::leak(Box::new(library)),
        file: file.to_owned(),
    })
}

/// What is wrong, in the words of the system where it has some.
fn reason(error: &dyn Error) -> String {
    error.source().map_or_else(|| error.to_string(), reason)
}

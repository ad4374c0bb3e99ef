//! Reads scenes of any format, by the ending of the file name.

pub use crate::files::{Files, InMemory};
pub use crate::import::{Crop, Lamp, LoadOptions, Loaded, SceneDigest, SceneSettings, Summary};

use crate::error::{Error, ErrorKind, Result};
use crate::file::nearest_file;
use crate::{gltf, pbrt};
use std::path::Path;

/// Reads a scene with all files that it refers to: glTF 2.0 if the name ends in `.gltf` or `.glb`, else
/// pbrt-v4; `-` is standard input.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Loaded> {
    load_from(path, options, &Files::default())
}

/// Reads a scene as [`load`] does, from `files`.
pub fn load_from(path: &Path, options: &LoadOptions, files: &Files) -> Result<Loaded> {
    let loaded = if gltf::is_gltf(path) {
        gltf::load_from(path, options, files)
    } else {
        pbrt::load_from(path, options, files)
    };
    loaded.map_err(|error| with_nearest(error, path, files))
}

/// Adds the nearest existing name to the error of a missing scene file.
fn with_nearest(error: Error, path: &Path, files: &Files) -> Error {
    let is_scene = error.kind() == ErrorKind::MissingFile && !error.has_place();
    if !is_scene || !files.is_from_disk(path) {
        return error;
    }
    match nearest_file(path) {
        Some(near) => error.with_hint(format!("did you mean `{}`?", near.display())),
        None => error,
    }
}

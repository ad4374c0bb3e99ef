//! Scenes of any format: which one a file has, its name says.

pub use crate::pbrt::{Crop, LoadOptions, Loaded, SceneDigest, SceneSettings, Summary};

use crate::error::Result;
use crate::{gltf, pbrt};
use std::path::Path;

/// Reads a scene with all that it refers to: glTF 2.0 where the name ends in `.gltf` or `.glb`, else
/// pbrt-v4; `-` is standard input.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Loaded> {
    if gltf::is_gltf(path) {
        gltf::load(path, options)
    } else {
        pbrt::load(path, options)
    }
}

//! glTF 2.0: `.gltf` with its files beside it, and `.glb`.
//!
//! The JSON becomes plain structures (`json`) whose extensions have names and types; accessors are
//! checked against the bytes they lie in before anything is taken for them; and what is built is a
//! scene like any other. Faults name their place by the way to it in the JSON.
//!
//! The format lets programs leave out extensions that a file does not require: that is a warning.
//! Features that the format itself demands are refused where the renderer lacks them, and
//! [`LoadOptions::lenient`] accepts a substitute. docs/reference/gltf.md lists all.
//!
//! A file without a camera is seen as a whole, and one without light is lit from behind the viewer
//! (`outside`). Units are taken as they are: nothing is divided by 683 lm/W.

mod accessor;
mod assembly;
mod container;
mod document;
mod json;
mod light;
mod material;
mod mesh;
mod node;
mod outside;
mod place;
mod texture;
mod view;

#[cfg(test)]
mod tests;

use crate::error::Result;
use crate::files::Files;
use crate::import::{self, LoadOptions, Loaded, SceneSettings};
use assembly::Builder;
use bidir::integrator::IntegratorKind;
use bidir::sampler::SamplerKind;
use document::Document;
use std::path::Path;

/// The default settings of a render: the format has none.
const SETTINGS: SceneSettings = SceneSettings {
    integrator: IntegratorKind::Auto,
    max_depth: 12,
    sampler: SamplerKind::Sobol,
    samples_per_pixel: 64,
    seed: None,
    output: None,
    aovs: Vec::new(),
};

/// True for names of files in this format.
pub fn is_gltf(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str());
    extension.is_some_and(|extension| {
        ["gltf", "glb"]
            .iter()
            .any(|known| extension.eq_ignore_ascii_case(known))
    })
}

/// Reads a file with all that it refers to.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Loaded> {
    load_from(path, options, &Files::default())
}

/// The same as [`load`], with files from where `files` says.
pub fn load_from(path: &Path, options: &LoadOptions, files: &Files) -> Result<Loaded> {
    let (document, log) = Document::open(path, options, files)?;
    import::load(&document, options, log, Builder::gather)
}

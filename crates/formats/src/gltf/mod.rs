//! glTF 2.0: `.gltf` with its files beside it, and `.glb`.
//!
//! The JSON is parsed into plain structures (`json`) with typed extensions; accessors are checked against
//! their bytes before memory is reserved for them. Errors have a line, a column and a path in the JSON.
//!
//! The format lets programs ignore extensions that a file does not require: an ignored or simplified
//! feature is a warning. A required feature that the renderer does not support is an error, or with
//! [`LoadOptions::lenient`] replaced by a similar one. docs/reference/gltf.md lists all of them.
//!
//! A file without a camera is shown as a whole (`outside`), or from within if it is closed, and one that is
//! dark is lit from behind the viewer (`outlook`). Units are not converted: nothing is divided by 683 lm/W.

mod accessor;
mod assembly;
mod container;
mod document;
mod json;
mod light;
mod material;
mod mesh;
mod node;
mod outlook;
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
use outlook::{Needs, Outlook};
use std::cell::Cell;
use std::path::Path;

/// The default settings of a render, as the format has none.
const SETTINGS: SceneSettings = SceneSettings {
    integrator: IntegratorKind::Auto,
    max_depth: 12,
    sampler: SamplerKind::Sobol,
    samples_per_pixel: 64,
    seed: None,
    output: None,
    aovs: Vec::new(),
};

/// Returns true for names that end in `.gltf` or `.glb`, in any case.
pub fn is_gltf(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str());
    extension.is_some_and(|extension| {
        ["gltf", "glb"]
            .iter()
            .any(|known| extension.eq_ignore_ascii_case(known))
    })
}

/// Reads a file with all files that it refers to.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Loaded> {
    load_from(path, options, &Files::default())
}

/// Reads a file as [`load`] does, from `files`.
pub fn load_from(path: &Path, options: &LoadOptions, files: &Files) -> Result<Loaded> {
    let (document, log) = Document::open(path, options, files)?;
    let needs = Cell::new(Needs::default());
    let load = |outlook: Outlook| {
        let gather = |context: &mut _| Builder::gather(context, &outlook, &needs);
        import::load(&document, options, log.clone(), gather)
    };
    let loaded = load(Outlook::default())?;
    match outlook::better(&loaded, needs.get()) {
        None => Ok(loaded),
        Some(outlook) => {
            drop(loaded);
            load(outlook)
        }
    }
}

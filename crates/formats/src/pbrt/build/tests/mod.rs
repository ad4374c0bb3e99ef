//! Scenes in a few lines: the built scenes, and errors.

mod accepted;
mod digest;
mod film;
mod lights;
mod materials;
mod media;
mod nested;
mod places;
mod refusals;
mod relief;
mod robust;
mod settings;
mod shapes;
mod textures;
mod views;

use super::{LoadOptions, Loaded, build};
use crate::pbrt::parse_text;
use bidir::scene::Scene;
use std::sync::Arc;

const STRICT: LoadOptions = LoadOptions {
    lenient: false,
    resolution: None,
    crop: None,
    isa: None,
    most_primitives: None,
};
const LENIENT: LoadOptions = LoadOptions {
    lenient: true,
    ..STRICT
};

#[track_caller]
fn load_text(text: &str, options: &LoadOptions) -> Loaded {
    let description = parse_text("s.pbrt", text).unwrap_or_else(|error| panic!("{error}"));
    build(&description, options).unwrap_or_else(|error| panic!("{error}"))
}

#[track_caller]
fn world(text: &str) -> Arc<Scene> {
    load_text(&format!("WorldBegin {text}"), &STRICT).scene
}

#[test]
fn inputs_are_all_named_files_except_the_film() {
    let text = "Film \"rgb\" \"string filename\" \"film.exr\" WorldBegin \
        Attribute \"light\" \"string filename\" \"default.exr\" \
        LightSource \"goniometric\" \"string filename\" \"lamp.exr\"";
    let loaded = load_text(text, &LENIENT);
    let inputs = ["default.exr", "lamp.exr", "s.pbrt"].map(std::path::PathBuf::from);
    let files = vec![inputs[2].clone()];
    assert_eq!((loaded.inputs, loaded.files), (inputs.into(), files));
}

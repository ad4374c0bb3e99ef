//! Scenes in a few lines: what is built of them, and what is refused.

mod digest;
mod film;
mod lights;
mod materials;
mod places;
mod refusals;
mod relief;
mod robust;
mod settings;
mod shapes;
mod textures;
mod views;

use super::{LoadOptions, Loaded, build};
use crate::error::Error;
use crate::pbrt::parse_text;
use bidir::scene::Scene;

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
fn world(text: &str) -> Scene {
    load_text(&format!("WorldBegin {text}"), &STRICT).scene
}

/// Why a scene that can be parsed is refused.
#[track_caller]
fn refusal(text: &str, options: &LoadOptions) -> Error {
    let description = parse_text("s.pbrt", text).unwrap_or_else(|error| panic!("{error}"));
    build(&description, options).expect_err("the scene is wrong")
}

#[track_caller]
fn check(text: &str, expected: &str) {
    assert_eq!(refusal(text, &STRICT).to_string(), expected);
}

#[track_caller]
fn check_world(text: &str, expected: &str) {
    check(&format!("WorldBegin\n{text}"), expected);
}

#[test]
fn inputs_are_all_files_that_are_named_but_the_film_s() {
    let text = "Film \"rgb\" \"string filename\" \"film.exr\" WorldBegin \
        MakeNamedMedium \"m\" \"string type\" \"nanovdb\" \"string filename\" \"smoke.nvdb\" \
        Attribute \"light\" \"string filename\" \"lamp.png\" \
        AreaLightSource \"diffuse\" Shape \"sphere\"";
    let loaded = load_text(text, &LENIENT);
    assert_eq!(
        loaded.inputs,
        ["lamp.png", "smoke.nvdb"].map(Into::into) as [std::path::PathBuf; 2]
    );
    assert!(loaded.files.is_empty());
}

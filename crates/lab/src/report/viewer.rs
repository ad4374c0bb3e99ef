//! The viewer: its controls, and the pixels that its scripts show.
//!
//! The scripts find everything by the ids that stand here.

use super::half::{base64, half_bytes};
use super::{ImageKind, ReportImage};
use crate::markup::{Element, element, script_json};
use crate::metric::ErrorMap;
use serde::Serialize;

/// A scene as the scripts read it.
#[derive(Serialize)]
struct Scene<'a> {
    name: &'a str,
    images: Vec<Image>,
}

/// An image as the scripts read it.
#[derive(Serialize)]
struct Image {
    name: String,
    is_reference: bool,
    width: usize,
    height: usize,
    /// Half floats, low byte first, in base64. Shape: `3 · width · height`.
    halves: String,
    /// Errors times 254, one byte each, and 255 for what is no number, in base64. Shape: `width · height`.
    flip: Option<String>,
}

/// The section with the controls.
pub(super) fn section(images: &[ReportImage]) -> Element {
    let section = super::section("viewer", "Images");
    if images.is_empty() {
        return section.child(element("p").text("No images were kept."));
    }
    let missing = super::flip::missing(images);
    let missing = missing.map(|words| element("p").class("note").text(words));
    section
        .child(element("noscript").child(element("p").text("The viewer needs JavaScript.")))
        .child(choices())
        .child(shown())
        .child(stage())
        .children(missing)
        .child(keys())
}

/// Scenes, images and how they are shown.
fn choices() -> Element {
    let choice = |id, words| labelled(words, element("select").with("id", id));
    let is_split = element("input")
        .with("type", "checkbox")
        .with("id", "is-split");
    let row = || element("div").class("row");
    let images = row()
        .child(choice("scene", "Scene"))
        .child(choice("image-a", "A"))
        .child(choice("image-b", "B"))
        .child(button("flip", "Flip A/B"));
    let painting = row()
        .child(options("layer", "Show", &LAYERS))
        .child(options("curve", "Tone", &CURVES))
        .child(range("exposure", "Exposure", ["-8", "8", "0.25", "0"]));
    let place = row()
        .child(labelled("Divide", is_split))
        .child(range("split", "at", ["0", "1", "0.01", "0.5"]))
        .child(button("zoom-out", "−").with("aria-label", "smaller"))
        .child(element("output").with("id", "zoom"))
        .child(button("zoom-in", "+").with("aria-label", "larger"))
        .child(button("reset", "Reset"));
    element("div")
        .class("controls")
        .children([images, painting, place])
}

const LAYERS: [(&str, &str); 3] = [
    ("image", "image"),
    ("relative", "relative square error"),
    ("flip", "FLIP error (HDR)"),
];

const CURVES: [(&str, &str); 2] = [("srgb", "sRGB"), ("linear", "linear")];

/// What is on the canvas, in words, and its means.
fn shown() -> Element {
    element("p").class("shown").child(
        element("output")
            .with("id", "shown")
            .with("aria-live", "polite"),
    )
}

fn stage() -> Element {
    element("div")
        .child(
            element("canvas")
                .with("id", "canvas")
                .with("tabindex", 0)
                .with("role", "img")
                .with("aria-label", "The chosen image")
                .with("aria-describedby", "keys"),
        )
        .child(
            element("div")
                .with("id", "scale")
                .class("scale")
                .with("hidden", "")
                .child(element("output").with("id", "scale-low"))
                .child(
                    element("canvas")
                        .with("id", "scale-bar")
                        .with("width", 256)
                        .with("height", 1),
                )
                .child(element("output").with("id", "scale-high")),
        )
        .child(
            element("pre")
                .with("id", "values")
                .class("values")
                .text("\n\n\n"),
        )
}

fn keys() -> Element {
    let keys = [
        ("F, Space", "flips between A and B"),
        (
            "1 – 9",
            "shows the first … ninth image of the scene in place of the one that is shown",
        ),
        ("S", "divides the image: A to the left, B to the right"),
        ("E", "shows the next error map"),
        ("[ ]", "darker, brighter by half a stop"),
        ("+ −", "larger, smaller; the wheel with Ctrl does so, too"),
        ("← ↑ → ↓", "move the image, as dragging does"),
        ("R", "puts everything back"),
    ];
    let pair = |(key, meaning): (&str, &str)| {
        [
            element("dt").child(element("kbd").text(key)),
            element("dd").text(meaning),
        ]
    };
    element("details")
        .with("id", "keys")
        .child(element("summary").text("Keys, while the image has the focus"))
        .child(element("dl").children(keys.into_iter().flat_map(pair)))
        .child(element("p").class("note").text(
            "Pixels are stored with 11 bits of precision and up to 65504; pixels that are not \
             numbers are green. Error maps and means in this viewer are computed from these, so \
             their last \
             digits may differ from those in the tables.",
        ))
}

fn labelled(words: &str, control: Element) -> Element {
    element("label")
        .child(element("span").text(words))
        .child(control)
}

fn button(id: &str, words: &str) -> Element {
    element("button")
        .with("type", "button")
        .with("id", id)
        .text(words)
}

fn options(id: &str, words: &str, options: &[(&str, &str)]) -> Element {
    let option = |(value, words): &(&str, &str)| element("option").with("value", value).text(words);
    let select = element("select").with("id", id);
    labelled(words, select.children(options.iter().map(option)))
}

fn range(id: &str, words: &str, [min, max, step, value]: [&str; 4]) -> Element {
    let input = element("input")
        .with("type", "range")
        .with("id", id)
        .with("min", min)
        .with("max", max)
        .with("step", step)
        .with("value", value);
    labelled(words, input).child(element("output").with("id", format!("{id}-value")))
}

/// The pixels of all images, for the scripts.
pub(super) fn data(images: &[ReportImage]) -> Element {
    let mut scenes: Vec<Scene<'_>> = Vec::new();
    for image in images {
        let stored = stored(image);
        match scenes.iter_mut().find(|scene| scene.name == image.scene) {
            Some(scene) => scene.images.push(stored),
            None => scenes.push(Scene {
                name: &image.scene,
                images: vec![stored],
            }),
        }
    }
    let json = serde_json::to_string(&scenes).expect("texts and numbers are JSON");
    element("script")
        .with("type", "application/json")
        .with("id", "images")
        .code(script_json(&json))
}

fn stored(image: &ReportImage) -> Image {
    let name = match &image.kind {
        ImageKind::Reference => "reference".to_owned(),
        ImageKind::Render { method, budget } => format!("{method} · {budget}"),
    };
    let [width, height] = image.pixels.size;
    Image {
        name,
        is_reference: image.kind == ImageKind::Reference,
        width,
        height,
        halves: base64(&half_bytes(&image.pixels.data)),
        flip: image.flip.as_ref().map(flip_bytes),
    }
}

fn flip_bytes(map: &ErrorMap) -> String {
    let byte = |&error: &f64| {
        if error.is_nan() {
            return 255;
        }
        (error.clamp(0.0, 1.0) * 254.0).round() as u8
    };
    base64(&map.data.iter().map(byte).collect::<Vec<_>>())
}

//! The report: the results of an experiment as one self-contained page.
//!
//! [`html`] makes the page. It opens from a file without a network, prints on paper, and has a dark style. It
//! contains the results as JSON, a style and a script. The script consists of the modules in `page/`, some of
//! which the viewer of renders shares (`bundle`). It draws everything: verdicts, settings, claims, tables, plots,
//! strategies, and the viewer that flips between images at the same place. Without scripts, the page shows only
//! the verdicts.
//!
//! *Nothing leaves the page.* Its security policy forbids every request, and allows only the scripts and styles
//! of the page, by their hashes. Texts cannot become markup: the JSON contains no `<`, and the script inserts
//! values only as text.
//!
//! *Pixels* are half floats in base64 (`half`), so that exposure works as on the original: 11 bits of
//! precision, up to 65504. An image takes 8 bytes per pixel, and 1⅓ more if it has a map of FLIP.
//!
//! This module only shows [`Results`]: it measures nothing and concludes nothing.

mod bundle;
mod flip;
mod half;
#[cfg(test)]
mod tests;
mod text;

pub use bundle::module;
pub use flip::add_flip;
pub use text::table_text;

use crate::experiment::analysis::{ReferenceNoise, reference_noise};
use crate::image::Pixels;
use crate::markup::{Element, element, script_json};
use crate::metric::ErrorMap;
use crate::results::{Claim, Plot, Results, Table};
use crate::statistics::RATIOS;
use half::{base64, halves};
use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;

/// The contents of a page.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Report<'a> {
    /// The results.
    pub results: &'a Results,
    /// The tables that belong to no claim.
    pub tables: &'a [Table],
    /// The plots that belong to no claim.
    pub plots: &'a [Plot],
    /// The images to flip between.
    pub images: &'a [ReportImage],
    /// The images of each pyramid of the results, by the names of their layers.
    #[serde(serialize_with = "layers")]
    pub layers: &'a [BTreeMap<String, Pixels>],
    /// The command that repeats the experiment.
    pub command: &'a str,
}

/// An image to flip to.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReportImage {
    /// The name of the scene.
    pub scene: String,
    /// The name of the image, unique in its scene.
    pub name: String,
    /// True if the other images of the scene are compared with this one.
    pub is_reference: bool,
    /// The pixels of the image.
    #[serde(flatten, serialize_with = "coded")]
    pub pixels: Pixels,
    /// FLIP of every pixel; see [`add_flip`]. None: the page shows no map.
    #[serde(serialize_with = "flip_bytes")]
    pub flip: Option<ErrorMap>,
}

const STYLE: &str = include_str!("../../page/report.css");

/// Returns the page. Equal reports give equal bytes.
pub fn html(report: &Report<'_>) -> String {
    let script = bundle::script();
    let head = head(&report.results.title, &script);
    let body = element("body")
        .child(element("noscript").children(without_script(&report.results.claims)))
        .child(data(report))
        .child(element("script").with("type", "module").code(script));
    format!("<!DOCTYPE html>\n<html lang=\"en\">{head}{body}\n</html>\n")
}

/// Returns the element with the data of the page.
fn data(report: &Report<'_>) -> Element {
    let data = Data {
        report,
        noises: reference_noise(report.results).collect(),
        ratios: RATIOS,
        most_flip_pixels: flip::MOST_PIXELS,
    };
    let json = serde_json::to_string(&data).expect("texts and numbers are JSON");
    element("script")
        .with("type", "application/json")
        .with("id", "data")
        .code(script_json(&json))
}

fn head(title: &str, script: &str) -> Element {
    let meta = |name, content: &str| element("meta").with("name", name).with("content", content);
    let policy = element("meta")
        .with("http-equiv", "Content-Security-Policy")
        .with("content", policy(script));
    element("head")
        .child(element("meta").with("charset", "utf-8"))
        .child(policy)
        .child(meta("viewport", "width=device-width, initial-scale=1"))
        .child(meta("color-scheme", "light dark"))
        .child(element("title").text(title))
        .child(element("style").code(STYLE))
}

/// Returns the security policy of the page: it loads, sends and frames nothing, and allows only its style and `script`.
fn policy(script: &str) -> String {
    let hash = |code: &str| base64(&Sha256::digest(code.as_bytes()));
    format!(
        "default-src 'none'; style-src 'sha256-{}'; script-src 'sha256-{}'; \
         base-uri 'none'; form-action 'none'",
        hash(STYLE),
        hash(script)
    )
}

/// Returns the content of the page for browsers that run no scripts.
fn without_script(claims: &[Claim]) -> Vec<Element> {
    let line = |claim: &Claim| {
        let rest = format!(": {} {}", claim.claim, claim.found);
        let verdict = element("b").text(claim.verdict.words());
        element("p").child(verdict).text(rest)
    };
    let notice = "This page needs JavaScript. Its figures are in results.json, too.";
    let notice = element("p").text(notice);
    std::iter::once(notice)
        .chain(claims.iter().map(line))
        .collect()
}

/// The data of a page, in the form that `page/results.js` describes.
#[derive(Serialize)]
struct Data<'a> {
    #[serde(flatten)]
    report: &'a Report<'a>,
    noises: Vec<ReferenceNoise<'a>>,
    ratios: &'static str,
    most_flip_pixels: usize,
}

/// Writes the images of pyramids, by their names.
fn layers<S: Serializer>(
    pyramids: &[BTreeMap<String, Pixels>],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    let coded = pyramids.iter().map(|layers| {
        let layers = layers.iter();
        let coded = layers.map(|(name, pixels)| (name, halves(&pixels.data)));
        coded.collect::<BTreeMap<_, _>>()
    });
    serializer.collect_seq(coded)
}

/// Writes an image as its size and its pixels.
fn coded<S: Serializer>(pixels: &Pixels, serializer: S) -> Result<S::Ok, S::Error> {
    let mut coded = serializer.serialize_struct("Pixels", 2)?;
    coded.serialize_field("size", &pixels.size)?;
    coded.serialize_field("halves", &halves(&pixels.data))?;
    coded.end()
}

/// Writes a byte for each pixel: 254 for an error of 1, 255 for no number.
#[expect(clippy::ref_option, reason = "serde passes a reference to the field")]
fn flip_bytes<S: Serializer>(map: &Option<ErrorMap>, serializer: S) -> Result<S::Ok, S::Error> {
    let byte = |error: &f64| {
        if error.is_nan() {
            return 255;
        }
        (error.clamp(0.0, 1.0) * 254.0).round() as u8
    };
    let coded = |map: &ErrorMap| base64(&map.data.iter().map(byte).collect::<Vec<_>>());
    map.as_ref().map(coded).serialize(serializer)
}

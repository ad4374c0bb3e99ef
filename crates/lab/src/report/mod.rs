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

use crate::experiment::analysis::reference_noise;
use crate::image::Pixels;
use crate::markup::{escaped, script_json};
use crate::metric::ErrorMap;
use crate::results::{Claim, Plot, Results, Table};
use crate::statistics::RATIOS;
use half::{base64, halves};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;

/// The contents of a page.
#[derive(Clone, Copy, Debug)]
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
    pub layers: &'a [BTreeMap<String, Pixels>],
    /// The command that repeats the experiment.
    pub command: &'a str,
}

/// An image to flip to.
#[derive(Clone, Debug, PartialEq)]
pub struct ReportImage {
    /// The name of the scene.
    pub scene: String,
    /// The name of the image, unique in its scene.
    pub name: String,
    /// True if the other images of the scene are compared with this one.
    pub is_reference: bool,
    /// The pixels of the image.
    pub pixels: Pixels,
    /// FLIP of every pixel; see [`add_flip`]. None: the page shows no map.
    pub flip: Option<ErrorMap>,
}

const STYLE: &str = include_str!("../../page/report.css");

/// Returns the page. Equal reports give equal bytes.
pub fn html(report: &Report<'_>) -> String {
    let script = bundle::script();
    format!(
        include_str!("../../page/report.html"),
        policy = policy(&script),
        title = escaped(&report.results.title),
        style = STYLE,
        verdicts = verdicts(&report.results.claims),
        data = script_json(&data(report).to_string()),
        script = script,
    )
}

/// Returns the data of the page, in the form that `page/results.js` describes.
fn data(report: &Report<'_>) -> Value {
    let images = report.images.iter().map(|image| {
        json!({
            "scene": image.scene,
            "name": image.name,
            "is_reference": image.is_reference,
            "size": image.pixels.size,
            "halves": halves(&image.pixels.data),
            "flip": image.flip.as_ref().map(flip_bytes),
        })
    });
    let layers = report.layers.iter().map(|layers| {
        let pairs = layers.iter();
        let coded = pairs.map(|(name, pixels)| (name.as_str(), halves(&pixels.data)));
        coded.collect::<BTreeMap<_, _>>()
    });
    json!({
        "results": report.results,
        "tables": report.tables,
        "plots": report.plots,
        "images": images.collect::<Vec<_>>(),
        "layers": layers.collect::<Vec<_>>(),
        "command": report.command,
        "noises": reference_noise(report.results).collect::<Vec<_>>(),
        "ratios": RATIOS,
        "most_flip_pixels": flip::MOST_PIXELS,
    })
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

/// Returns the verdicts for browsers that run no scripts.
fn verdicts(claims: &[Claim]) -> String {
    let line = |claim: &Claim| {
        let texts = [claim.verdict.words(), &claim.claim, &claim.found].map(escaped);
        let [verdict, statement, found] = texts;
        format!("<p><b>{verdict}</b>: {statement} {found}</p>\n")
    };
    claims.iter().map(line).collect()
}

/// Returns a byte for each pixel in base64: 254 for an error of 1, 255 for no number.
fn flip_bytes(map: &ErrorMap) -> String {
    let byte = |error: &f64| {
        if error.is_nan() {
            return 255;
        }
        (error.clamp(0.0, 1.0) * 254.0).round() as u8
    };
    base64(&map.data.iter().map(byte).collect::<Vec<_>>())
}

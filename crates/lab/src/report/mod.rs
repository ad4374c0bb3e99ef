//! The report: what an experiment found, as one page that needs nothing else.
//!
//! [`html`] makes the page; it opens from a file, on paper, in the dark, without a network. In order:
//!
//! 1. what the experiment is about, and the verdicts of all claims at a glance (`overview`),
//! 2. what was compared, on what, with which settings, seeds and machine (`setting`),
//! 3. each claim: its source, its verdict, what was found, how sure that is, tables and plots (`claims`),
//! 4. more tables and plots,
//! 5. what each strategy does (`strategies`),
//! 6. the viewer, which flips between images at the same place (`viewer`, `*.js`),
//! 7. how to make it again, and what the words mean (`glossary`).
//!
//! *Nothing leaves the page.* Its security policy forbids every request, images but those that stand in
//! the page, and of scripts and styles all but those of this folder, by their hashes. Texts cannot become markup, since the page is a tree
//! until it is written (`markup`).
//!
//! *Numbers* are written to the digits that their intervals give them (`number`), and what is best is
//! marked together with all that cannot be told from it (`table`). *Plots* are SVG: series differ by
//! colour, marker and dashes, and each has its numbers as a table (`plot`, `axis`, `series`).
//!
//! *Pixels* are half floats in base64 (`half`), so that exposure works as on the original: 11 bits of
//! precision, up to 65504. An image takes 8 bytes per pixel, and 1⅓ more where it has a map of FLIP.
//!
//! This module measures nothing and concludes nothing: it shows [`Results`] as they are.

mod axis;
mod claims;
mod flip;
mod glossary;
mod half;
mod legend;
pub(crate) mod number;
mod overview;
mod plot;
mod series;
mod setting;
mod strategies;
mod table;
#[cfg(test)]
mod tests;
mod text;
mod viewer;

pub use flip::add_flip;
pub use text::table_text;

use crate::image::Pixels;
use crate::markup::{Element, element};
use crate::metric::ErrorMap;
use crate::results::{Plot, Results, Table};
use sha2::{Digest, Sha256};

/// All that a page shows.
#[derive(Clone, Copy, Debug)]
pub struct Report<'a> {
    /// What was found.
    pub results: &'a Results,
    /// Tables that belong to no claim.
    pub tables: &'a [Table],
    /// Plots that belong to no claim.
    pub plots: &'a [Plot],
    /// What the viewer shows.
    pub images: &'a [ReportImage],
    /// The contact sheets that the results name.
    pub sheets: &'a [Sheet],
    /// The command that makes the experiment again.
    pub command: &'a str,
}

/// A contact sheet of strategies.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sheet {
    /// Its name in the results.
    pub name: String,
    /// The file.
    pub png: Vec<u8>,
}

/// An image of the viewer; one scene has each kind once.
#[derive(Clone, Debug, PartialEq)]
pub struct ReportImage {
    /// The name of its scene.
    pub scene: String,
    /// What it is.
    pub kind: ImageKind,
    /// Its pixels.
    pub pixels: Pixels,
    /// What FLIP says of every pixel, where the viewer should show it; see [`add_flip`].
    pub flip: Option<ErrorMap>,
}

/// What an image of the viewer is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ImageKind {
    /// What the others of the scene are compared with.
    Reference,
    /// A render.
    Render {
        /// The name of the method.
        method: String,
        /// The name of the budget.
        budget: String,
    },
}

const STYLE: &str = include_str!("report.css");

/// The scripts of the viewer; as one module they share their names with nobody else.
const SCRIPT: &str = concat!(
    include_str!("pixels.js"),
    include_str!("view.js"),
    include_str!("viewer.js"),
    include_str!("selftest.js"),
);

/// The page. The same report gives the same bytes.
pub fn html(report: &Report<'_>) -> String {
    let results = report.results;
    let main = element("main")
        .child(overview::verdicts(&results.claims))
        .child(setting::section(results))
        .child(claims::section(&results.claims))
        .child(others(report))
        .child(strategies::section(results, report.sheets))
        .child(viewer::section(report.images))
        .child(glossary::again(report))
        .child(glossary::section());
    let script = element("script").with("type", "module").code(SCRIPT);
    let before = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">{}\n<body>{}{main}",
        head(&results.title),
        overview::header(report)
    );
    let after = format!(
        "{}{script}\n</body>\n</html>\n",
        viewer::data(report.images)
    );
    let footer = footer(before.len() + after.len());
    [before, footer, after].concat()
}

/// The footer, with the size of the page that it belongs to; `others` is that of all the rest.
fn footer(others: usize) -> String {
    let mut footer = String::new();
    // The size has more digits with the footer than without it at most once.
    for _ in 0..3 {
        footer = overview::footer(others + footer.len()).to_string();
    }
    footer
}

fn head(title: &str) -> Element {
    element("head")
        .child(element("meta").with("charset", "utf-8"))
        .child(
            element("meta")
                .with("http-equiv", "Content-Security-Policy")
                .with("content", policy()),
        )
        .child(
            element("meta")
                .with("name", "viewport")
                .with("content", "width=device-width, initial-scale=1"),
        )
        .child(
            element("meta")
                .with("name", "color-scheme")
                .with("content", "light dark"),
        )
        .child(element("title").text(title))
        .child(element("style").code(STYLE))
}

/// Nothing may be loaded, sent or framed; images are in the page; this style and this script may run, and no other.
fn policy() -> String {
    let hash = |code: &str| half::base64(&Sha256::digest(code.as_bytes()));
    format!(
        "default-src 'none'; style-src 'sha256-{}'; script-src 'sha256-{}'; \
         img-src data:; base-uri 'none'; form-action 'none'",
        hash(STYLE),
        hash(SCRIPT)
    )
}

/// Tables and plots that belong to no claim.
fn others(report: &Report<'_>) -> Element {
    let mut section = section("more", "More tables and plots");
    if report.tables.is_empty() && report.plots.is_empty() {
        section = section.child(element("p").text("There are no others."));
    }
    let plots = report.plots.iter().enumerate();
    section
        .children(report.tables.iter().map(table::table))
        .children(plots.map(|(index, plot)| plot::figure(plot, &format!("plot-{index}"))))
}

/// A section with its heading.
fn section(id: &'static str, heading: &str) -> Element {
    element("section")
        .with("id", id)
        .child(element("h2").text(heading))
}

/// Paragraphs of a text, which empty lines divide.
fn paragraphs(text: &str) -> impl Iterator<Item = Element> + '_ {
    let parts = text.split("\n\n").map(str::trim);
    parts
        .filter(|part| !part.is_empty())
        .map(|part| element("p").text(part))
}

/// Words and what stands for them, as a list.
fn definitions(pairs: impl IntoIterator<Item = (String, String)>) -> Element {
    let pairs = pairs
        .into_iter()
        .flat_map(|(word, meaning)| [element("dt").text(word), element("dd").text(meaning)]);
    element("dl").children(pairs)
}

//! All keys of descriptions, as docs/reference/experiments.md lists them. Tests compare the list with the
//! reader and with the page.

use super::claims::figure_names;
use super::{Experiment, ExperimentError, names as settings};
use crate::metric::Metric;
use std::fmt::Write;
use std::path::Path;
use std::{env, fs};

/// A key of a description.
#[derive(Clone, Copy, Debug)]
struct Key {
    /// Its table; empty for the top of the file.
    table: &'static str,
    /// Its name.
    name: &'static str,
    /// The kind of its value.
    value: &'static str,
    /// Its default, or that it is required.
    default: &'static str,
    /// Its meaning in one sentence.
    meaning: &'static str,
}

const fn key(
    table: &'static str,
    name: &'static str,
    value: &'static str,
    default: &'static str,
    meaning: &'static str,
) -> Key {
    Key {
        table,
        name,
        value,
        default,
        meaning,
    }
}

/// All keys except settings, in the order of the page.
#[rustfmt::skip]
const KEYS: &[Key] = &[
    key("", "title", "text", "`Experiment`", "Title of the report."),
    key("", "description", "text", "none", "A sentence below the title."),
    key("", "size", "`\"WIDTHxHEIGHT\"`", "each scene's", "Size of all images. Unit: pixels."),
    key("", "seeds", "whole number from 1", "10", "Number of seeds."),
    key("", "first-seed", "whole number", "0", "The first seed; the others follow it."),
    key("", "threads", "whole number from 1 to 1024", "one per processor", "Threads of each render, at most 4 per processor."),
    key("", "metrics", "list of [metrics](metrics.md)", "`relmse`, `relmse_trim`", "Metrics in addition to `rmse`."),
    key("", "pyramid", "name of a method", "none", "Renders each strategy (s, t) of this method for the report."),
    key("", "pyramid-spp", "whole number from 2", "64", "Samples per pixel of these images."),
    key("", "pyramid-scenes", "list of names", "all", "Scenes whose strategies are shown."),
    key("settings", "", "", "", "Settings of all methods."),
    key("scene", "file", "path", "required without `room`", "The scene file, relative to the description; it may begin with an environment variable, such as `$BIDIR_SCENES/`."),
    key("scene", "room", "table of `light` (`direct` or `indirect`), `albedo` and `triangles`", "none", "A furnished room that is made instead of a file: the same light with any number of triangles."),
    key("scene", "optional", "`true` or `false`", "`false`", "Leaves the scene out, with a warning, if its file is missing or its reference is contradicted."),
    key("scene", "name", "text", "the file's name", "Name in results; unique."),
    key("scene", "size", "`\"WIDTHxHEIGHT\"`", "`size` above", "Size of its images. Unit: pixels."),
    key("scene", "reference", "path", "none", "An existing reference folder, or an image with finite pixels."),
    key("scene", "reference-of", "name of a scene before it", "none", "Shares the reference of a scene with the same light."),
    key("scene", "reference-spp", "whole number from 1", "none", "Renders a reference with this many samples per pixel; each scene needs one of these three keys."),
    key("scene", "reference-strategies", "as `strategies`", "those of `[settings]`", "Strategies of the rendered reference."),
    key("scene", "reference-cross-check", "`path`, `light` or `lvc`", "`path`", "Integrator that checks the rendered reference."),
    key("method", "name", "text", "required", "Name in results; unique. Ratios are relative to the first method."),
    key("method", "scenes", "list of names", "all", "Scenes in which it is rendered."),
    key("method", "", "", "", "Settings of this method; they replace those of `[settings]`."),
    key("budget", "samples", "whole number from 1", "none", "Samples per pixel."),
    key("budget", "rays", "number above 0", "none", "Rays per pixel. Each budget has exactly one of `samples`, `rays` and `seconds`."),
    key("budget", "seconds", "number above 0", "none", "Render time. Unit: seconds."),
    key("budget", "name", "text", "amount and unit", "Name in results, such as the default `64 spp`; unique."),
    key("budget", "methods", "list of names", "all", "Methods that are rendered under it."),
    key("budget", "scenes", "list of names", "all", "Scenes that are rendered under it."),
    key("contributions", "methods", "list of names", "none", "Methods whose contributions before visibility are measured; they need `integrator = \"bdpt\"`."),
    key("contributions", "scenes", "list of names", "all", "Scenes in which they are measured."),
    key("contributions", "spp", "whole number from 2", "16", "Samples per pixel that are measured."),
    key("claim", "id", "text", "required", "Name in results, in lower case with hyphens; unique."),
    key("claim", "claim", "text", "required", "The statement, in a sentence."),
    key("claim", "source", "text", "`Own claim`", "Its origin."),
    key("claim", "goal", "`true` or `false`", "`false`", "The verdict is `met` or `not met` instead of `reproduced` or `not reproduced`."),
    key("claim", "part", "text", "method and scene", "Name of a number in the result."),
    key("claim", "each", "as `for`", "one number", "The numbers of the claim; all must lie in the range."),
    key("claim", "above", "number", "none", "Lower end of the range; a claim needs `above`, `below`, or both."),
    key("claim", "below", "number", "none", "Upper end of the range."),
    key("table", "claim", "id of a claim", "none", "Shows the table below this claim."),
    key("table", "section", "text", "`Tables`", "Shows it in a section with this title."),
    key("table", "caption", "text", "required", "Sentence above the table."),
    key("table", "each", "as `for`", "one row", "Its rows; a row of which nothing was measured is left out."),
    key("table", "columns", "list of tables", "required", "Each has a `head`, and either a `value` to print or the keys of a number, which it inherits from the table."),
    key("table", "plot", "table of `x`, `curves`, `label` and `log`", "none", "Draws the columns `curves` over the column `x`; `log = \"xy\"` makes both axes logarithmic."),
    key("table", "histogram", "text", "none", "Draws the contributions of each row over this axis."),
    key("quick", "seeds", "whole number from 1", "3", "The most seeds of `--quick`."),
    key("quick", "size", "number above 0", "at most 64 pixels a side", "Factor of the sides of images."),
    key("quick", "samples", "number above 0", "0.125", "Factor of `samples` and `pyramid-spp`."),
    key("quick", "rays", "number above 0", "0.125", "Factor of `rays`."),
    key("quick", "seconds", "number above 0", "0.125", "Factor of `seconds`."),
    key("quick", "references", "number above 0", "0.125", "Factor of `reference-spp`."),
];

/// The keys of a number, in claims, tables and their columns.
#[rustfmt::skip]
const NUMBER: [Key; 7] = [
    key("", "measure", "[measure](#measures)", "required", "The number of each render."),
    key("", "budget", "`samples`, `rays` or `seconds`", "the first of the method", "Kind of the budget of the renders."),
    key("", "scene", "name", "required", "The scene."),
    key("", "method", "name", "required", "The method."),
    key("", "over", "name of a method, or number", "1 in a claim, the plain mean in a table", "Divides the measure, paired by seed; `over = 1` gives the geometric mean with an interval."),
    key("", "gain-over", "name of a method", "none", "The inverse: by which factor this method has more."),
    key("", "than", "name of a scene", "none", "Divides the ratio by the same ratio in this scene."),
];

/// The tables of a description.
const TABLES: [&str; 8] = [
    "settings",
    "scene",
    "method",
    "budget",
    "contributions",
    "claim",
    "table",
    "quick",
];

const PAGE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../docs/reference/experiments.md"
);
const BEGIN: &str = "<!-- generated: experiment keys -->\n";
const MEASURES: &str = "<!-- generated: measures -->\n";
const END: &str = "<!-- end -->\n";

/// Reads a description with an additional line in one of its tables.
fn read(table: &str, line: &str) -> Result<Experiment, ExperimentError> {
    let with = |head: &str, own: &str| {
        let line = if head == table { line } else { "" };
        format!("{own}\n{line}\n")
    };
    let text = [
        with("", ""),
        with("settings", "[settings]"),
        with("scene", "[[scene]]\nfile = \"a.pbrt\"\nreference-spp = 1"),
        with("method", "[[method]]\nname = \"a\""),
        with("budget", "[[budget]]\nsamples = 1"),
        with("contributions", "[contributions]"),
        with("claim", "[[claim]]"),
        with("table", "[[table]]"),
        with("quick", "[quick]"),
    ];
    let text = text.iter().filter(|part| {
        // Claims and tables need more keys than this description has.
        let is_partial = part.starts_with("[[claim]]") || part.starts_with("[[table]]");
        !is_partial || part.contains(line) && !line.is_empty()
    });
    let text: Vec<&str> = text.map(String::as_str).collect();
    Experiment::read(&text.concat(), Path::new("a.toml"))
}

/// Returns the names of a table's keys in alphabetical order.
fn names(table: &str) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for key in KEYS.iter().filter(|key| key.table == table) {
        match key.name {
            "" => names.extend(settings()),
            name => names.push(name.to_owned()),
        }
    }
    if table.is_empty() {
        names.extend(TABLES.map(str::to_owned));
    }
    if ["claim", "table"].contains(&table) {
        names.extend(NUMBER.map(|key| key.name.to_owned()));
    }
    names.sort_unstable();
    names
}

#[test]
fn the_list_has_the_keys_of_the_reader() {
    for table in [""].into_iter().chain(TABLES) {
        // No key resembles this name, so the hint lists all of them.
        let error = read(table, "zzzzzzzzzzzzzzzz = 1").unwrap_err();
        let hint = error.hint().unwrap();
        let known = hint
            .split(", ")
            .map(|name| name.rsplit(' ').next().unwrap());
        let mut known: Vec<String> = known.map(|name| name.replace('`', "")).collect();
        known.sort_unstable();
        assert_eq!(known, names(table), "{table}: {hint}");
    }
}

#[test]
fn the_list_has_the_defaults_of_the_reader() {
    let default = |name| KEYS.iter().find(|key| key.name == name).unwrap().default;
    let experiment = read("", "pyramid = \"a\"").unwrap();
    assert_eq!(default("title"), format!("`{}`", experiment.title));
    assert_eq!(default("seeds"), experiment.seeds.count.to_string());
    assert_eq!(default("first-seed"), experiment.seeds.first.to_string());
    let spp = experiment.pyramid.unwrap().spp;
    assert_eq!(default("pyramid-spp"), spp.to_string());
    let metrics = experiment.metrics.into_iter().map(|metric| {
        let named = Metric::NAMES.iter().find(|(_, other)| *other == metric);
        format!("`{}`", named.unwrap().0)
    });
    assert_eq!(default("metrics"), metrics.collect::<Vec<_>>().join(", "));
}

/// Formats the list of keys for the page.
fn list() -> String {
    let mut text = String::new();
    for table in [""].into_iter().chain(TABLES) {
        match table {
            "" => text += "\nAt the top of the file:\n\n",
            "settings" | "contributions" | "quick" => {
                write!(text, "\n`[{table}]`:\n\n").unwrap();
            }
            "claim" => text += "\n`[[claim]]`, with the keys of a number below:\n\n",
            "table" => {
                text += "\n`[[table]]`, in place of the usual tables, with the keys of a number below:\n\n";
            }
            _ => write!(text, "\n`[[{table}]]`, at least one:\n\n").unwrap(),
        }
        text += "| Key | Value | Default | Meaning |\n|---|---|---|---|\n";
        for key in KEYS.iter().filter(|key| key.table == table) {
            let name = match key.name {
                "" => settings()
                    .iter()
                    .map(|name| format!("`{name}`"))
                    .collect::<Vec<_>>()
                    .join(", "),
                name => format!("`{name}`"),
            };
            let [value, default] = match key.name {
                "" => ["as the [flag](cli.md)", "the scene's"],
                _ => [key.value, key.default],
            };
            writeln!(text, "| {name} | {value} | {default} | {} |", key.meaning).unwrap();
        }
    }
    text += "\nThe keys of a number:\n\n| Key | Value | Default | Meaning |\n|---|---|---|---|\n";
    for key in &NUMBER {
        let (name, value) = (key.name, key.value);
        writeln!(
            text,
            "| `{name}` | {value} | {} | {} |",
            key.default, key.meaning
        )
        .unwrap();
    }
    text + "\n"
}

/// The measures that are no metric, as the page has them.
fn measures() -> String {
    let names = figure_names()
        .into_iter()
        .map(|name| format!("- `{name}`\n"));
    format!("\n{}\n", names.collect::<String>())
}

#[test]
fn the_page_lists_every_key_and_measure() {
    check_page(BEGIN, &list());
    check_page(MEASURES, &measures());
}

/// Compares a generated part of the page with its source; `BIDIR_WRITE_PAGES=1` writes it.
#[track_caller]
fn check_page(begin: &str, expected: &str) {
    let text = fs::read_to_string(PAGE).unwrap();
    let (before, rest) = text.split_once(begin).unwrap();
    let (found, after) = rest.split_once(END).unwrap();
    if env::var_os("BIDIR_WRITE_PAGES").is_some() {
        fs::write(PAGE, [before, begin, expected, END, after].concat()).unwrap();
    } else {
        let how = "BIDIR_WRITE_PAGES=1 cargo test --release -p bidir-lab --lib keys";
        assert!(
            found == expected,
            "{PAGE} is out of date; to write it: {how}"
        );
    }
}

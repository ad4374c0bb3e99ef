//! docs/reference/experiments.md lists the keys, defaults and measures of the reader.

use super::claims::figure_names;
use super::{Experiment, ExperimentError};
use crate::metric::Metric;
use std::collections::BTreeSet;
use std::path::Path;

const PAGE: &str = include_str!("../../../../docs/reference/experiments.md");
/// The tables of a description, as the page names them.
const TABLES: [&str; 8] = [
    "[settings]",
    "[[scene]]",
    "[[method]]",
    "[[budget]]",
    "[contributions]",
    "[[claim]]",
    "[[table]]",
    "[quick]",
];
const DESCRIPTION: &str = "[[scene]]\nfile = \"a.pbrt\"\nreference-spp = 1\n\
                           [[method]]\nname = \"a\"\n[[budget]]\nsamples = 1\n";

fn read(text: &str) -> Result<Experiment, ExperimentError> {
    Experiment::read(text, Path::new("a.toml"))
}

/// Returns the cells of the table of keys that stands below `heading` on the page.
fn rows(heading: &str) -> Vec<Vec<&'static str>> {
    let (_, below) = PAGE
        .split_once(&format!("\n{heading}"))
        .expect("the page has the table");
    let lines = below
        .lines()
        .skip_while(|line| !line.starts_with("|---"))
        .skip(1);
    let rows = lines.take_while(|line| line.starts_with('|'));
    rows.map(|row| row.trim_matches('|').split(" | ").map(str::trim).collect())
        .collect()
}

/// Returns the names in backticks in the first cells of the rows below `heading`.
fn names(heading: &str) -> BTreeSet<&'static str> {
    let cells = rows(heading).into_iter().map(|row| row[0]);
    cells
        .flat_map(|cell| cell.split('`').skip(1).step_by(2))
        .collect()
}

#[test]
fn the_page_has_the_keys_of_the_reader() {
    for table in [""].into_iter().chain(TABLES) {
        // No key resembles this name, so the hint lists all of them.
        let line = "zzzzzzzzzzzzzzzz = 1\n";
        let (text, mut listed) = match table {
            "" => (
                format!("{line}{DESCRIPTION}"),
                names("At the top of the file:"),
            ),
            _ => (
                format!("{DESCRIPTION}{table}\n{line}"),
                names(&format!("`{table}`")),
            ),
        };
        match table {
            "" => listed.extend(TABLES.map(|table| table.trim_matches(['[', ']']))),
            "[[claim]]" | "[[table]]" => listed.append(&mut names("The keys of a number:")),
            _ => {}
        }
        let error = read(&text).unwrap_err();
        let known = error
            .hint()
            .unwrap()
            .strip_prefix("known keys are ")
            .unwrap();
        assert_eq!(
            known.split(", ").collect::<BTreeSet<_>>(),
            listed,
            "{table}"
        );
    }
}

#[test]
fn the_page_has_the_defaults_of_the_reader() {
    let rows = rows("At the top of the file:");
    let default = |name| {
        rows.iter()
            .find(|row| row[0] == format!("`{name}`"))
            .unwrap()[2]
    };
    let experiment = read(&format!("pyramid = \"a\"\n{DESCRIPTION}")).unwrap();
    assert_eq!(default("title"), format!("`{}`", experiment.title));
    assert_eq!(default("seeds"), experiment.seeds.count.to_string());
    assert_eq!(default("first-seed"), experiment.seeds.first.to_string());
    assert_eq!(
        default("pyramid-spp"),
        experiment.pyramid.unwrap().spp.to_string()
    );
    let metrics = experiment.metrics.into_iter().map(Metric::name);
    let metrics: Vec<_> = metrics.map(|name| format!("`{name}`")).collect();
    assert_eq!(default("metrics"), metrics.join(", "));
}

#[test]
fn the_page_has_all_measures() {
    let (_, below) = PAGE.split_once("### Measures").unwrap();
    let lines = below.lines().skip_while(|line| !line.starts_with("- "));
    let listed: Vec<_> = lines.take_while(|line| line.starts_with("- ")).collect();
    let known: Vec<_> = figure_names()
        .iter()
        .map(|name| format!("- `{name}`"))
        .collect();
    assert_eq!(listed, known);
}

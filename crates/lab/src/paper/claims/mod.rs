//! From measurements to claims: pure functions of records, walks and contributions.
//!
//! A statement about numbers is judged by the intervals of these numbers ([`judge`]): it is reproduced
//! where the interval lies within what is stated, not reproduced where it lies outside, and
//! undecided where it overlaps. A statement about several numbers holds if all its parts do, and does
//! not hold if one of them does not ([`all`]); the confidence of 95 % is shared among the parts
//! (by Bonferroni), so that it is that of the statement.
//!
//! Where records are missing nothing is decided.

mod beyond;
mod complexity;
mod figure_2;
mod records;
mod sweep;
mod table_1;
mod theory;
mod time;
mod verdict;

pub use beyond::beyond;
pub use complexity::complexity;
pub use figure_2::figure_2;
pub use sweep::albedo;
pub use table_1::table_1;
pub use theory::section_3;
pub use time::{rooms, times};
pub use verdict::{Expected, all, judge};

use super::plans;
use crate::results::{Axis, Cell, Claim, Plot, PlotKind, Scale, Series, Table, Verdict};
use crate::statistics::{Interval, RATIOS};

/// How sure a whole statement is.
const CONFIDENCE: f64 = 0.95;

/// The confidence of each of `parts` intervals that a statement needs all of.
pub(super) fn shared(parts: usize) -> f64 {
    1.0 - (1.0 - CONFIDENCE) / parts.max(1) as f64
}

/// A claim without tables and plots.
fn claim(id: &str, source: &str, claim: &str, verdict: Verdict, found: String) -> Claim {
    Claim {
        id: id.to_owned(),
        claim: claim.to_owned(),
        source: source.to_owned(),
        verdict,
        found,
        method: format!("{RATIOS} The intervals of a statement hold together with 95 %."),
        tables: Vec::new(),
        plots: Vec::new(),
    }
}

/// A cell with an interval; empty where nothing was measured.
fn cell(interval: Option<Interval>) -> Cell {
    match interval {
        Some(Interval { value, low, high }) => Cell::Interval { value, low, high },
        None => Cell::Text(String::new()),
    }
}

fn text(words: impl Into<String>) -> Cell {
    Cell::Text(words.into())
}

/// A ratio with its interval, in words.
fn words(interval: Option<Interval>) -> String {
    match interval {
        Some(Interval { value, low, high }) => format!("{value:.3} [{low:.3}, {high:.3}]"),
        None => "not measured".to_owned(),
    }
}

fn table(caption: impl Into<String>, columns: &[&str], rows: Vec<Vec<Cell>>) -> Table {
    Table {
        caption: caption.into(),
        columns: columns.iter().map(|&head| head.to_owned()).collect(),
        rows,
    }
}

fn axis(label: &str, scale: Scale) -> Axis {
    Axis {
        label: label.to_owned(),
        scale,
    }
}

/// A plot of lines.
fn lines(caption: impl Into<String>, x: Axis, y: Axis, series: Vec<Series>) -> Plot {
    Plot {
        caption: caption.into(),
        kind: PlotKind::Lines,
        x,
        y,
        series,
    }
}

/// A line through intervals.
fn series(name: impl Into<String>, points: &[(f64, Option<Interval>)]) -> Series {
    let known = points.iter().filter_map(|(x, y)| Some((*x, (*y)?)));
    let (points, intervals) = known.map(|(x, y)| ([x, y.value], [y.low, y.high])).unzip();
    Series {
        name: name.into(),
        points,
        intervals,
    }
}

/// The optimisations as the paper numbers them, with their rules.
fn optimisations() -> impl Iterator<Item = (usize, &'static str)> {
    plans::RULES.into_iter().enumerate().skip(1)
}

/// What was there before all optimisations.
const NONE: &str = plans::RULES[0];

//! Claims and tables: statements of a description about its records, and the figures beside them.
//!
//! A [`ClaimSpec`] says of some numbers where they lie; a [`TableSpec`] shows numbers. Both are made of
//! [`Quantity`]s, so that one evaluator serves them all ([`Findings`]). Records do not depend on claims:
//! a description whose claims change is judged again without a new render.
//!
//! # Verdicts
//!
//! A statement about numbers is judged by their intervals: it is reproduced where each interval lies
//! within the stated range, not reproduced where one lies outside, and undecided where they overlap the
//! border ([`Expected`]). The confidence of 95 % is shared among the parts of a statement (by
//! Bonferroni), so that it is that of the statement. A goal is met or not met in the same way.
//!
//! # Errors at equal cost
//!
//! Renders end after whole passes, so budgets are kept to half a pass. The mean square error of an
//! unbiased estimator falls as 1 / samples, which makes MSE · cost independent of where a render ended,
//! but for training, which costs T however many samples follow. With the cost c of a render, its error
//! under a budget B would be MSE · (c - T) / (B - T); compared is
//!
//!   MSE · (c - T) · B / (B - T),
//!
//! MSE · c under the budget itself. B is the full budget, also in a quick run, whose training is as long.
//! Metrics that are roots of squares are multiplied by the root of the cost.

mod judge;
mod measure;
mod plot;
mod table;
#[cfg(test)]
mod tests;

pub use judge::Findings;
#[cfg(test)]
pub(super) use measure::figure_names;
pub use measure::{Cost, Measure};

use super::Experiment;
use super::analysis::{self, Section};
use crate::results::{BudgetKind, Claim, Results, Scale};

/// Where a number is stated to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Expected {
    /// The lower end of the range; minus infinity where there is none.
    pub low: f64,
    /// The upper end.
    pub high: f64,
}

/// A statement.
#[derive(Clone, Debug, PartialEq)]
pub struct ClaimSpec {
    /// A short name, such as `table-1-b-uniform-lower`, unlike all others.
    pub id: String,
    /// The origin of the statement, such as `Table 1`.
    pub source: String,
    /// The statement, in a sentence.
    pub claim: String,
    /// Whether others stated it, or it is aimed at.
    pub kind: ClaimKind,
    /// Where each of its numbers is stated to be.
    pub expected: Expected,
    /// The numbers, each with its name; there is at least one.
    pub parts: Vec<(String, Quantity)>,
}

/// The origin of a statement, which words its verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClaimKind {
    /// Someone stated it: it is reproduced, or not.
    Statement,
    /// It is aimed at: it is met, or not.
    Goal,
}

/// A number that records determine.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    /// The number of each record.
    pub measure: Measure,
    /// The kind of budget that the records are of. None: the first budget that the method has.
    pub budget: Option<BudgetKind>,
    /// The scene.
    pub scene: String,
    /// The method.
    pub method: String,
    /// The divisor.
    pub over: Over,
    /// The scene whose ratio divides this one. None: no scene.
    pub than: Option<String>,
}

/// The divisor of a number; ratios are paired by seed.
#[derive(Clone, Debug, PartialEq)]
pub enum Over {
    /// None: the mean over seeds is shown, without an interval.
    Nothing,
    /// A number; 1 gives the geometric mean with its interval.
    Number(f64),
    /// The same measure of another method.
    Method(String),
}

/// A table.
#[derive(Clone, Debug, PartialEq)]
pub struct TableSpec {
    /// Where it is shown.
    pub place: TablePlace,
    /// What it shows.
    pub caption: String,
    /// The heads of the columns.
    pub columns: Vec<String>,
    /// Rows of as many cells.
    pub rows: Vec<Vec<CellSpec>>,
    /// Some of its columns as curves.
    pub plot: Option<PlotSpec>,
    /// The axis of a histogram of the contributions in its rows. None: no histogram.
    pub histogram: Option<String>,
}

/// Where a table is shown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TablePlace {
    /// Below the claim with this id.
    Claim(String),
    /// In the section with this title.
    Section(String),
}

/// A cell of a table.
#[derive(Clone, Debug, PartialEq)]
pub enum CellSpec {
    /// A text, or a number that is known.
    Value(String),
    /// A number of the records.
    Quantity(Quantity),
}

/// Columns as curves over another one.
#[derive(Clone, Debug, PartialEq)]
pub struct PlotSpec {
    /// The column of the x coordinates.
    pub x: usize,
    /// The columns of the curves.
    pub curves: Vec<usize>,
    /// What the y axis shows.
    pub label: String,
    /// How the x axis is divided.
    pub x_scale: Scale,
    /// How the y axis is divided.
    pub y_scale: Scale,
}

impl Experiment {
    /// The claims of the description, judged by the records.
    pub fn judge(&self, results: &Results) -> Vec<Claim> {
        let findings = Findings::new(self, results);
        let claims = self.claims.iter().map(|spec| {
            let mut claim = findings.claim(spec);
            let is_below = |table: &&TableSpec| table.place == TablePlace::Claim(spec.id.clone());
            for table in self.tables.iter().filter(is_below) {
                findings.show(table, &mut claim.tables, &mut claim.plots);
            }
            claim
        });
        claims.collect()
    }

    /// The tables of the description that belong to no claim, or the usual ones where it has no table.
    pub fn sections(&self, results: &Results) -> Vec<Section> {
        if self.tables.is_empty() {
            return analysis::sections(results);
        }
        let findings = Findings::new(self, results);
        let mut sections: Vec<Section> = Vec::new();
        for table in &self.tables {
            let TablePlace::Section(title) = &table.place else {
                continue;
            };
            if sections.last().is_none_or(|last| last.title != *title) {
                sections.push(Section {
                    title: title.clone(),
                    ..Section::default()
                });
            }
            if let Some(Section { tables, plots, .. }) = sections.last_mut() {
                findings.show(table, tables, plots);
            }
        }
        sections
    }
}

//! Claims and tables: statements of a description about its records, and figures for them.
//!
//! A [`ClaimSpec`] states a range for some numbers; a [`TableSpec`] shows numbers. Both consist of
//! [`Quantity`]s, which [`Findings`] evaluates. Records do not depend on claims: changed claims are judged
//! again without a new render.
//!
//! # Verdicts
//!
//! The intervals of its numbers decide a statement: it is reproduced if each interval lies within the stated
//! range, not reproduced if one lies outside, and undecided otherwise. Bonferroni's correction
//! makes 95 % the confidence of the whole statement, whatever the number of its parts. A goal is met or not
//! met in the same way.
//!
//! # Errors at equal cost
//!
//! Renders end after whole passes and meet their budget only within half a pass. The mean square error of
//! an unbiased estimator is proportional to 1 / samples, so that MSE · cost does not depend on the number of
//! passes, except through training, which costs T for any number of samples. A render of cost c would have
//! the error MSE · (c - T) / (B - T) under a budget B; claims compare
//!
//!   MSE · (c - T) · B / (B - T),
//!
//! which is the render's MSE · cost under the budget B. B is the full budget, also in a quick run, whose
//! training takes as long. Metrics that are roots of squares are multiplied by the root of the cost.

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
use crate::metric::Metric;
use crate::results::{BudgetInfo, BudgetKind, Claim, Results, Scale};

/// A statement.
#[derive(Clone, Debug, PartialEq)]
pub struct ClaimSpec {
    /// A unique short name, such as `table-1-b-uniform-lower`.
    pub id: String,
    /// The origin of the statement, such as `Table 1`.
    pub source: String,
    /// The statement, in a sentence.
    pub claim: String,
    /// True: a goal, which is met or not. False: a statement of others, which is reproduced or not.
    pub goal: bool,
    /// The lower end of the range of each of the claim's numbers. None: unbounded.
    pub above: Option<f64>,
    /// The upper end of the range. None: unbounded.
    pub below: Option<f64>,
    /// The numbers with their names, at least one.
    pub parts: Vec<(String, Quantity)>,
}

/// A number computed from records.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    /// The number taken from each record.
    pub measure: Measure,
    /// The budget of the records.
    pub budget: BudgetChoice,
    /// The scene.
    pub scene: String,
    /// The method.
    pub method: String,
    /// The divisor.
    pub over: Over,
    /// The scene whose ratio divides this ratio. None: no further division.
    pub than: Option<String>,
}

/// The choice of a budget among those with records of a method.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum BudgetChoice {
    /// The first one.
    First,
    /// The first one of this kind.
    Kind(BudgetKind),
    /// The one with this name.
    Named(String),
}

impl BudgetChoice {
    fn includes(&self, budget: &BudgetInfo) -> bool {
        match self {
            Self::First => true,
            Self::Kind(kind) => budget.kind == *kind,
            Self::Named(name) => budget.name == *name,
        }
    }
}

/// The divisor of a number; ratios are paired by seed.
#[derive(Clone, Debug, PartialEq)]
pub enum Over {
    /// No divisor: the mean over seeds, without an interval.
    Nothing,
    /// No divisor: the mean over seeds, with its interval.
    MeanInterval,
    /// A number; 1 gives the geometric mean with its interval.
    Number(f64),
    /// The same measure of another method.
    Method(String),
}

/// A table.
#[derive(Clone, Debug, PartialEq)]
pub struct TableSpec {
    /// The claim or section that has the table.
    pub place: TablePlace,
    /// The caption.
    pub caption: String,
    /// The heads of the columns.
    pub columns: Vec<String>,
    /// Rows, each with one cell per column.
    pub rows: Vec<Vec<CellSpec>>,
    /// A plot of some columns. None: no plot.
    pub plot: Option<PlotSpec>,
    /// The axis of a histogram of the contributions in its rows. None: no histogram.
    pub histogram: Option<String>,
}

/// The place of a table in the report.
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
    /// A text or number from the description.
    Value(String),
    /// A number computed from the records.
    Quantity(Quantity),
}

/// A plot of columns over another column.
#[derive(Clone, Debug, PartialEq)]
pub struct PlotSpec {
    /// The column of the x coordinates.
    pub x: usize,
    /// The columns of the curves.
    pub curves: Vec<usize>,
    /// The label of the y axis.
    pub label: String,
    /// The scale of the x axis.
    pub x_scale: Scale,
    /// The scale of the y axis.
    pub y_scale: Scale,
}

impl Experiment {
    /// Adds the metrics of claims and tables to those that are computed.
    pub(super) fn add_metrics(&mut self) {
        let parts = self.claims.iter().flat_map(|claim| &claim.parts);
        let of_claims = parts.map(|(_, of)| of.measure);
        let cells = self
            .tables
            .iter()
            .flat_map(|table| table.rows.iter().flatten());
        let of_tables = cells.filter_map(|cell| match cell {
            CellSpec::Quantity(of) => Some(of.measure),
            CellSpec::Value(_) => None,
        });
        for measure in of_claims.chain(of_tables) {
            let (Measure::Metric(metric) | Measure::AtCost(metric, _)) = measure else {
                continue;
            };
            if metric != Metric::Rmse && !self.metrics.contains(&metric) {
                self.metrics.push(metric);
            }
        }
    }

    /// Judges the claims of the description by the records.
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

    /// Makes the tables of the description that belong to no claim, or the default tables if it has none.
    pub fn sections(&self, results: &Results) -> Vec<Section> {
        let findings = Findings::new(self, results);
        if self.tables.is_empty() {
            return analysis::sections(&findings);
        }
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

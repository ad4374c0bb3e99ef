//! The default tables and plots of records.
//!
//! Each scene and budget has two tables. The first shows means over seeds, with
//! [`mean_interval`](crate::statistics::mean_interval). The second shows ratios to the first method, paired by
//! seed, with [`ratio_interval`](crate::statistics::ratio_interval): of errors, and of the efficiencies
//!
//!   1 / (MSE · rays)  and  1 / (MSE · seconds),
//!
//! whose costs include training, as the columns of rays and seconds do. Several budgets of one kind give a
//! plot of each metric over them. All intervals have 95 % confidence; a single seed gives a number without
//! an interval. The numbers are [`Quantity`]s, like the numbers of claims.
//!
//! [`overruns`] finds renders that take far more rays than their budget. [`reference_noise`] computes which
//! share of the errors is noise of the reference.

mod curves;
mod noise;
mod overrun;
#[cfg(test)]
mod tests;

pub use noise::{ReferenceNoise, reference_noise};
pub use overrun::overruns;

use super::claims::{BudgetChoice, Findings, Measure, Over, Quantity};
use crate::results::{BudgetInfo, Cell, Plot, Record, Results, SceneInfo, Table};
use std::collections::BTreeSet;

/// The confidence of intervals.
pub const CONFIDENCE: f64 = 0.95;

/// The costs of a render.
const COSTS: [&str; 4] = [
    "samples per pixel",
    "rays per pixel",
    "seconds",
    "processor seconds",
];
/// The efficiencies of a render.
const EFFICIENCIES: [&str; 2] = ["efficiency by rays", "efficiency by time"];

/// The tables and plots of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Section {
    /// The scene, or another title.
    pub title: String,
    /// The tables.
    pub tables: Vec<Table>,
    /// The plots.
    pub plots: Vec<Plot>,
}

/// Makes a section for each scene with records.
pub(super) fn sections(findings: &Findings<'_>) -> Vec<Section> {
    let results = findings.results;
    let has_records = |scene: &&SceneInfo| results.records.iter().any(|r| r.scene == scene.name);
    let scenes = results.scenes.iter().filter(has_records);
    let section = |scene: &SceneInfo| Section {
        title: scene.name.clone(),
        tables: results
            .budgets
            .iter()
            .flat_map(|budget| Rows::new(findings, scene, budget).tables())
            .collect(),
        plots: curves::plots(findings, scene),
    };
    scenes.map(section).collect()
}

/// Returns the records of a scene, budget and method, sorted by seed.
pub(super) fn records_of<'a>(
    results: &'a Results,
    scene: &str,
    budget: &str,
    method: &str,
) -> Vec<&'a Record> {
    let is_one = |record: &&Record| {
        record.scene == scene && record.budget == budget && record.method == method
    };
    let mut records: Vec<_> = results.records.iter().filter(is_one).collect();
    records.sort_by_key(|record| record.seed);
    records
}

/// Returns the metrics in a scene's records, in the order of their names.
fn metrics(results: &Results, scene: &SceneInfo) -> Vec<Measure> {
    let all = results.records.iter();
    let records = all.filter(|record| record.scene == scene.name);
    let names: BTreeSet<&String> = records.flat_map(|record| record.metrics.keys()).collect();
    measures(names)
}

/// Returns the measures of these names.
fn measures(names: impl IntoIterator<Item: AsRef<str>>) -> Vec<Measure> {
    let names = names.into_iter();
    names
        .filter_map(|name| name.as_ref().parse().ok())
        .collect()
}

/// The methods with records of a scene and budget.
struct Rows<'a> {
    findings: &'a Findings<'a>,
    scene: &'a SceneInfo,
    budget: &'a BudgetInfo,
    methods: Vec<&'a str>,
}

impl<'a> Rows<'a> {
    fn new(findings: &'a Findings<'a>, scene: &'a SceneInfo, budget: &'a BudgetInfo) -> Self {
        let results = findings.results;
        let names = results.methods.iter().map(|method| &*method.name);
        let has_records =
            |method: &&str| !records_of(results, &scene.name, &budget.name, method).is_empty();
        Self {
            findings,
            scene,
            budget,
            methods: names.filter(has_records).collect(),
        }
    }

    /// Makes the tables of means and of ratios to the first method.
    fn tables(&self) -> Vec<Table> {
        let results = self.findings.results;
        let [first, others @ ..] = &self.methods[..] else {
            return Vec::new();
        };
        let place = format!("{}, {}", self.scene.name, self.budget.name);
        let seeds = records_of(results, &self.scene.name, &self.budget.name, first).len();
        let has_processor = |record: &Record| record.processor_seconds.is_some();
        let costs = COSTS.len() - usize::from(!results.records.iter().any(has_processor));
        let metrics = metrics(results, self.scene);
        let columns = |measures: &[Measure], over: Over| -> Vec<(Measure, Over)> {
            measures
                .iter()
                .map(|measure| (*measure, over.clone()))
                .collect()
        };
        let costs = columns(&measures(&COSTS[..costs]), Over::Nothing);
        let means = [costs, columns(&metrics, Over::MeanInterval)].concat();
        let noun = if seeds == 1 { "seed" } else { "seeds" };
        let intervals = match seeds {
            0 | 1 => "without intervals",
            _ => "with 95 % intervals",
        };
        let caption = format!("{place}: means over {seeds} {noun}, {intervals}.");
        let mut tables = vec![self.table(caption, &means, &self.methods)];
        if !others.is_empty() {
            let caption = format!(
                "{place}: ratios to {first}, paired by seed, {intervals}. \
                 Errors are better below 1, efficiencies above."
            );
            let compared = [metrics, measures(EFFICIENCIES)].concat();
            let ratios = columns(&compared, Over::Method((*first).to_owned()));
            tables.push(self.table(caption, &ratios, others));
        }
        tables
    }

    fn table(&self, caption: String, columns: &[(Measure, Over)], methods: &[&str]) -> Table {
        let heads = columns.iter().map(|(measure, _)| measure.to_string());
        let row = |method: &&str| {
            let cells = columns.iter().map(|(measure, over)| {
                self.findings.number(&Quantity {
                    over: over.clone(),
                    ..quantity(*measure, self.scene, self.budget, method)
                })
            });
            let name = Cell::Text((*method).to_owned());
            std::iter::once(name).chain(cells).collect()
        };
        Table {
            caption,
            columns: std::iter::once("method".to_owned()).chain(heads).collect(),
            rows: methods.iter().map(row).collect(),
        }
    }
}

/// Makes the mean of a measure over the records of a scene, budget and method.
fn quantity(measure: Measure, scene: &SceneInfo, budget: &BudgetInfo, method: &str) -> Quantity {
    Quantity {
        measure,
        budget: BudgetChoice::Named(budget.name.clone()),
        scene: scene.name.clone(),
        method: method.to_owned(),
        over: Over::Nothing,
        than: None,
    }
}

//! The default tables and plots of records, as a pure function of [`Results`].
//!
//! Each scene and budget has two tables. The first shows means over seeds, with [`mean_interval`]. The
//! second shows ratios to the first method, paired by seed, with [`ratio_interval`]: of errors, and of the
//! efficiencies
//!
//!   1 / (MSE · rays)  and  1 / (MSE · seconds),
//!
//! whose costs include training, as the columns of rays and seconds do. Several budgets of one kind give a
//! plot of each metric over them. All intervals have 95 % confidence; a single seed gives a number without
//! an interval.
//!
//! [`overruns`] finds renders that take far more rays than their budget, [`reference_noise`] the share of
//! the errors that is noise of the reference.

mod curves;
mod noise;
mod overrun;
#[cfg(test)]
mod tests;

pub use noise::{ReferenceNoise, reference_noise};
pub use overrun::overruns;

use crate::results::{Cell, Plot, Record, Results, SceneInfo, Table};
use crate::statistics::{Interval, mean_interval, ratio_interval};
use std::collections::BTreeSet;

/// The confidence of intervals.
pub const CONFIDENCE: f64 = 0.95;

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
pub fn sections(results: &Results) -> Vec<Section> {
    let has_records = |scene: &&SceneInfo| results.records.iter().any(|r| r.scene == scene.name);
    let scenes = results.scenes.iter().filter(has_records);
    let section = |scene: &SceneInfo| Section {
        title: scene.name.clone(),
        tables: tables(results, scene),
        plots: curves::plots(results, scene),
    };
    scenes.map(section).collect()
}

/// Returns the records of a scene, budget and method, sorted by seed.
pub fn records_of<'a>(
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

/// Computes the geometric mean of the ratio of a value in `a` to that in `b`, over their common seeds.
///
/// None: there are fewer than two common seeds, or a value is not positive.
pub fn ratio(
    a: &[&Record],
    b: &[&Record],
    value: impl Fn(&Record) -> Option<f64>,
) -> Option<Interval> {
    let (a, b) = pairs(a, b, value);
    ratio_interval(&a, &b, CONFIDENCE)
}

/// Returns the values in `a` and `b` for their common seeds.
fn pairs(
    a: &[&Record],
    b: &[&Record],
    value: impl Fn(&Record) -> Option<f64>,
) -> (Vec<f64>, Vec<f64>) {
    let pair = |a: &&Record| {
        let b = b.iter().find(|b| b.seed == a.seed)?;
        Some((value(a)?, value(b)?))
    };
    a.iter().filter_map(pair).unzip()
}

/// Returns the names of all metrics in a scene's records.
fn metrics<'a>(results: &'a Results, scene: &SceneInfo) -> BTreeSet<&'a str> {
    let records = results.records.iter();
    let records = records.filter(|record| record.scene == scene.name);
    let names = records.flat_map(|record| record.metrics.keys());
    names.map(String::as_str).collect()
}

/// The head of a column, and a function from the records of a method to its cell.
type Column<'a> = (String, Box<dyn Fn(&[&Record]) -> Cell + 'a>);

fn tables(results: &Results, scene: &SceneInfo) -> Vec<Table> {
    let mut tables = Vec::new();
    for budget in &results.budgets {
        let rows: Vec<(&str, Vec<&Record>)> = (results.methods.iter())
            .map(|method| {
                let records = records_of(results, &scene.name, &budget.name, &method.name);
                (&*method.name, records)
            })
            .filter(|(_, records)| !records.is_empty())
            .collect();
        let Some((first, baseline)) = rows.first() else {
            continue;
        };
        let place = format!("{}, {}", scene.name, budget.name);
        let seeds = baseline.len();
        let caption = format!("{place}: means over {seeds} seeds, with 95 % intervals.");
        tables.push(table(caption, &means(results, scene), &rows));
        if rows.len() > 1 {
            let caption = format!(
                "{place}: ratios to {first}, paired by seed, with 95 % intervals. \
                 Errors are better below 1, efficiencies above."
            );
            let columns = ratios(results, scene, baseline);
            tables.push(table(caption, &columns, &rows[1..]));
        }
    }
    tables
}

fn table(caption: String, columns: &[Column<'_>], rows: &[(&str, Vec<&Record>)]) -> Table {
    let heads = columns.iter().map(|(head, _)| head.clone());
    let row = |(method, records): &(&str, Vec<&Record>)| {
        let cells = columns.iter().map(|(_, cell)| cell(records));
        std::iter::once(Cell::Text((*method).to_owned()))
            .chain(cells)
            .collect()
    };
    Table {
        caption,
        columns: std::iter::once("method".to_owned()).chain(heads).collect(),
        rows: rows.iter().map(row).collect(),
    }
}

/// Makes the columns of the table of means.
fn means<'a>(results: &'a Results, scene: &SceneInfo) -> Vec<Column<'a>> {
    let pixels = (scene.size[0] * scene.size[1]) as f64;
    let plain = |value: &dyn Fn(&Record) -> f64, records: &[&Record]| {
        let sum: f64 = records.iter().map(|record| value(record)).sum();
        Cell::Number(sum / records.len() as f64)
    };
    let mut columns: Vec<Column<'a>> = vec![
        (
            "samples per pixel".to_owned(),
            Box::new(move |records| plain(&|record| record.spp as f64, records)),
        ),
        (
            "rays per pixel".to_owned(),
            Box::new(move |records| plain(&|record| record.rays.total() as f64 / pixels, records)),
        ),
        (
            "seconds".to_owned(),
            Box::new(move |records| plain(&|record| record.seconds, records)),
        ),
    ];
    if results
        .records
        .iter()
        .any(|record| record.processor_seconds.is_some())
    {
        let of = |record: &Record| record.processor_seconds.unwrap_or(f64::NAN);
        columns.push((
            "processor seconds".to_owned(),
            Box::new(move |records| plain(&of, records)),
        ));
    }
    for metric in metrics(results, scene) {
        let cell = move |records: &[&Record]| {
            let values = records
                .iter()
                .filter_map(|r| r.metrics.get(metric).copied());
            mean_cell(&values.collect::<Vec<_>>())
        };
        columns.push((metric.to_owned(), Box::new(cell)));
    }
    columns
}

/// Makes the columns of the table of ratios.
fn ratios<'a>(
    results: &'a Results,
    scene: &SceneInfo,
    baseline: &'a [&'a Record],
) -> Vec<Column<'a>> {
    let mut columns: Vec<Column<'a>> = Vec::new();
    for metric in metrics(results, scene) {
        let value = move |record: &Record| record.metrics.get(metric).copied();
        let cell = move |records: &[&Record]| ratio_cell(records, baseline, value);
        columns.push((metric.to_owned(), Box::new(cell)));
    }
    let of_rays = |record: &Record| Some(record.efficiency_rays);
    let of_seconds = |record: &Record| Some(record.efficiency_seconds);
    columns.push((
        "efficiency by rays".to_owned(),
        Box::new(move |records| ratio_cell(records, baseline, of_rays)),
    ));
    columns.push((
        "efficiency by time".to_owned(),
        Box::new(move |records| ratio_cell(records, baseline, of_seconds)),
    ));
    columns
}

/// Returns the cell for a missing number.
fn missing() -> Cell {
    Cell::Text("–".to_owned())
}

fn mean_cell(values: &[f64]) -> Cell {
    match (mean_interval(values, CONFIDENCE), values) {
        (Some(interval), _) => interval_cell(interval),
        (None, [value]) => Cell::Number(*value),
        (None, _) => missing(),
    }
}

fn ratio_cell(
    records: &[&Record],
    baseline: &[&Record],
    value: impl Fn(&Record) -> Option<f64> + Copy,
) -> Cell {
    if let Some(interval) = ratio(records, baseline, value) {
        return interval_cell(interval);
    }
    match pairs(records, baseline, value) {
        (a, b) if a.len() == 1 && b[0] > 0.0 => Cell::Number(a[0] / b[0]),
        _ => missing(),
    }
}

fn interval_cell(interval: Interval) -> Cell {
    let Interval { value, low, high } = interval;
    Cell::Interval { value, low, high }
}

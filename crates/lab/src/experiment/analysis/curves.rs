//! Curves of errors over budgets.

use super::{CONFIDENCE, metrics, records_of};
use crate::results::{Axis, BudgetKind, Plot, PlotKind, Record, Results, Scale, SceneInfo, Series};
use crate::statistics::mean_interval;

/// Every kind of budget, with the label of its axis.
const KINDS: [(BudgetKind, &str); 3] = [
    (BudgetKind::Samples, "samples per pixel"),
    (BudgetKind::Rays, "rays per pixel"),
    (BudgetKind::Seconds, "seconds"),
];

/// Plots each metric over each kind of budget that has several amounts.
pub(super) fn plots(results: &Results, scene: &SceneInfo) -> Vec<Plot> {
    let mut plots = Vec::new();
    for (kind, label) in KINDS {
        let budgets = results.budgets.iter().filter(|budget| budget.kind == kind);
        if budgets.count() < 2 {
            continue;
        }
        for metric in metrics(results, scene) {
            plots.push(Plot {
                caption: format!("{}: {metric} over {label}.", scene.name),
                kind: PlotKind::Lines,
                x: logarithmic(label),
                y: logarithmic(metric),
                series: series(results, scene, kind, metric),
            });
        }
    }
    plots
}

fn logarithmic(label: &str) -> Axis {
    Axis {
        label: label.to_owned(),
        scale: Scale::Log,
    }
}

/// Makes the curves of all methods.
fn series(results: &Results, scene: &SceneInfo, kind: BudgetKind, metric: &str) -> Vec<Series> {
    let curve = |method: &str| {
        let mut points: Vec<([f64; 2], Option<[f64; 2]>)> = Vec::new();
        for budget in results.budgets.iter().filter(|budget| budget.kind == kind) {
            let records = records_of(results, &scene.name, &budget.name, method);
            points.extend(point(&records, cost(kind, scene), metric));
        }
        points.sort_by(|(a, _), (b, _)| a[0].total_cmp(&b[0]));
        // All or none: the list of intervals is empty or as long as that of points.
        let intervals: Option<Vec<_>> = points.iter().map(|(_, interval)| *interval).collect();
        Series {
            name: method.to_owned(),
            points: points.iter().map(|(point, _)| *point).collect(),
            intervals: intervals.unwrap_or_default(),
        }
    };
    let methods = results.methods.iter();
    let curves = methods.map(|method| curve(&method.name));
    curves.filter(|curve| !curve.points.is_empty()).collect()
}

/// Returns a function that gives the cost of a render in the unit of the budget.
fn cost(kind: BudgetKind, scene: &SceneInfo) -> impl Fn(&Record) -> f64 {
    let pixels = (scene.size[0] * scene.size[1]) as f64;
    move |record| match kind {
        BudgetKind::Samples => record.spp as f64,
        BudgetKind::Rays => record.rays.total() as f64 / pixels,
        BudgetKind::Seconds => record.seconds,
    }
}

/// Computes mean cost and mean error, with the interval of the latter. None: no record has the metric.
///
/// A lower end at or below zero, which a logarithmic axis cannot show, is replaced by the smallest error of
/// all seeds.
fn point(
    records: &[&Record],
    cost: impl Fn(&Record) -> f64,
    metric: &str,
) -> Option<([f64; 2], Option<[f64; 2]>)> {
    let values = records.iter();
    let values = values.filter_map(|record| Some((cost(record), *record.metrics.get(metric)?)));
    let (costs, errors): (Vec<_>, Vec<_>) = values.unzip();
    let n = errors.len() as f64;
    let mean = |values: &[f64]| values.iter().sum::<f64>() / n;
    let interval = mean_interval(&errors, CONFIDENCE).map(|interval| {
        let smallest = errors.iter().copied().fold(f64::INFINITY, f64::min);
        let low = if interval.low > 0.0 {
            interval.low
        } else {
            smallest
        };
        [low, interval.high]
    });
    (!errors.is_empty()).then(|| ([mean(&costs), mean(&errors)], interval))
}

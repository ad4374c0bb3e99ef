//! Curves of errors over budgets.

use super::super::claims::{Findings, Measure};
use super::{CONFIDENCE, metrics, quantity};
use crate::results::{
    Axis, BudgetInfo, BudgetKind, Plot, PlotKind, Point, Scale, SceneInfo, Series,
};
use crate::statistics::mean_interval;

/// Plots each metric over each kind of budget that has several amounts.
pub(super) fn plots(findings: &Findings<'_>, scene: &SceneInfo) -> Vec<Plot> {
    let mut plots = Vec::new();
    for (_, kind) in BudgetKind::NAMES {
        let all = findings.results.budgets.iter();
        let budgets: Vec<_> = all.filter(|budget| budget.kind == kind).collect();
        if budgets.len() < 2 {
            continue;
        }
        let Ok(cost) = kind.cost().parse() else {
            continue;
        };
        for metric in metrics(findings.results, scene) {
            let axes = Axes {
                findings,
                scene,
                cost,
                metric,
            };
            plots.push(axes.plot(&budgets));
        }
    }
    plots
}

/// The measures of a plot.
struct Axes<'a> {
    findings: &'a Findings<'a>,
    scene: &'a SceneInfo,
    cost: Measure,
    metric: Measure,
}

impl Axes<'_> {
    fn plot(&self, budgets: &[&BudgetInfo]) -> Plot {
        let methods = self.findings.results.methods.iter();
        let curves = methods.map(|method| self.curve(budgets, &method.name));
        Plot {
            caption: format!("{}: {} over {}.", self.scene.name, self.metric, self.cost),
            kind: PlotKind::Lines,
            x: Axis::new(self.cost.to_string(), Scale::Log),
            y: Axis::new(self.metric.to_string(), Scale::Log),
            series: curves.filter(|curve| !curve.points.is_empty()).collect(),
        }
    }

    fn curve(&self, budgets: &[&BudgetInfo], method: &str) -> Series {
        let all = budgets.iter();
        let mut points: Vec<Point> = all.filter_map(|b| self.point(b, method)).collect();
        points.sort_by(|(a, _), (b, _)| a[0].total_cmp(&b[0]));
        Series::new(method, &points)
    }

    /// Computes mean cost and mean error, with the interval of the latter. None: no record has the metric.
    ///
    /// A lower end at or below zero, which a logarithmic axis cannot show, is replaced by the smallest error
    /// of all seeds.
    fn point(&self, budget: &BudgetInfo, method: &str) -> Option<Point> {
        let of = |measure| quantity(measure, self.scene, budget, method);
        let (cost, error) = (of(self.cost), of(self.metric));
        let errors = self.findings.numbers(&error);
        let interval = mean_interval(&errors, CONFIDENCE).map(|interval| {
            let smallest = errors.iter().copied().fold(f64::INFINITY, f64::min);
            let low = Some(interval.low).filter(|low| *low > 0.0);
            [low.unwrap_or(smallest), interval.high]
        });
        let mean = |of| self.findings.mean(of);
        Some(([mean(&cost)?, mean(&error)?], interval))
    }
}

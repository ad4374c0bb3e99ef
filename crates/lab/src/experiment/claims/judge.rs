//! Intervals and verdicts of claims, from records.

use super::measure::{Clock, Measured};
use super::{BudgetChoice, ClaimSpec, Cost, Measure, Over, Quantity};
use crate::experiment::Experiment;
use crate::experiment::analysis::{CONFIDENCE, records_of};
use crate::results::{BudgetKind, Claim, Record, Results, Verdict};
use crate::statistics::{Interval, RATIOS, ratio_interval};
use std::collections::BTreeMap;

/// Numbers by seed, or for contributions, by pass.
type BySeed = BTreeMap<u64, f64>;

/// The records of an experiment, with the description and the clock that evaluate them.
pub struct Findings<'a> {
    pub(super) experiment: &'a Experiment,
    pub(in super::super) results: &'a Results,
    clock: Clock,
}

impl<'a> Findings<'a> {
    /// Prepares the evaluation of results: by processor time if all records have it, else by wall time.
    pub fn new(experiment: &'a Experiment, results: &'a Results) -> Self {
        let is_known = |record: &Record| {
            record.processor_seconds.is_some() && record.training_processor_seconds.is_some()
        };
        let clock = if results.records.iter().all(is_known) {
            Clock::Processors
        } else {
            Clock::Wall
        };
        Self {
            experiment,
            results,
            clock,
        }
    }

    /// Returns the numbers of a method in a scene, by seed.
    fn values(&self, of: &Quantity, scene: &str, method: &str) -> BySeed {
        if let Measure::Contributions(name) = of.measure {
            let all = self.results.contributions.iter();
            let mut own = all.filter(|found| found.scene == scene && found.method == method);
            let passes = own.next().map_or(&[][..], |found| &found.passes);
            let pass =
                |(pass, figures): (u64, &BTreeMap<String, f64>)| Some((pass, *figures.get(name)?));
            return (0..).zip(passes).filter_map(pass).collect();
        }
        let mut scenes = self.results.scenes.iter();
        let Some(info) = scenes.find(|info| info.name == scene) else {
            return BySeed::new();
        };
        let records = self.records(&of.budget, scene, method);
        let value = |record: &&Record| {
            let measured = Measured {
                record,
                scene: info,
                clock: self.clock,
                threads: self.results.machine.threads,
                full: self.full(&record.budget),
            };
            Some((record.seed, measured.value(of.measure)?))
        };
        records.iter().filter_map(value).collect()
    }

    /// Returns the records of a method in a scene, of the first chosen budget that has any there.
    fn records(&self, choice: &BudgetChoice, scene: &str, method: &str) -> Vec<&'a Record> {
        let results = self.results;
        let all_budgets = results.budgets.iter();
        let budgets = all_budgets.filter(|budget| choice.includes(budget));
        let mut all = budgets.map(|budget| records_of(results, scene, &budget.name, method));
        all.find(|records| !records.is_empty()).unwrap_or_default()
    }

    /// Returns the full amount of the budget with this name, in rays per pixel or in seconds.
    fn full(&self, name: &str) -> Option<(Cost, f64)> {
        let mut budgets = self.experiment.budgets.iter();
        let budget = budgets.find(|budget| budget.name == name)?;
        match budget.kind {
            BudgetKind::Rays => Some((Cost::Rays, budget.full)),
            BudgetKind::Seconds => Some((Cost::Time, budget.full)),
            BudgetKind::Samples => None,
        }
    }

    /// Returns the ratios of number and divisor in a scene by seed, for the seeds that have both numbers.
    pub(super) fn ratios(&self, of: &Quantity, scene: &str) -> BySeed {
        let divisors = match &of.over {
            Over::Method(method) => Some(self.values(of, scene, method)),
            _ => None,
        };
        let divisor = |seed: &u64| match (&of.over, &divisors) {
            (Over::Number(number), _) => Some(*number),
            (_, Some(divisors)) => divisors.get(seed).copied(),
            (_, None) => Some(1.0),
        };
        let own = self.values(of, scene, &of.method).into_iter();
        let ratios = own.filter_map(|(seed, value)| Some((seed, value / divisor(&seed)?)));
        ratios.collect()
    }

    /// Computes the geometric mean of the ratio over seeds, with its interval. None: fewer than two seeds have
    /// the ratio, or one is not positive.
    pub(super) fn interval(&self, of: &Quantity, confidence: f64) -> Option<Interval> {
        let own = self.ratios(of, &of.scene);
        // Renders of different scenes are independent, so pairing them by seed is harmless.
        let others = of.than.as_ref().map(|than| self.ratios(of, than));
        let ratio = |(seed, ratio): (u64, f64)| match &others {
            Some(others) => Some(ratio / others.get(&seed)?),
            None => Some(ratio),
        };
        let ratios: Vec<f64> = own.into_iter().filter_map(ratio).collect();
        ratio_interval(&ratios, confidence)
    }

    /// Returns the number for each seed, without the divisor.
    pub(in super::super) fn numbers(&self, of: &Quantity) -> Vec<f64> {
        let values = self.values(of, &of.scene, &of.method);
        values.into_values().collect()
    }

    /// Computes the mean over seeds. None: there is no record.
    pub(in super::super) fn mean(&self, of: &Quantity) -> Option<f64> {
        let values = self.numbers(of);
        (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
    }

    /// Judges a claim; its tables are left empty.
    pub(super) fn claim(&self, spec: &ClaimSpec) -> Claim {
        let confidence = shared(spec.parts.len());
        let parts = spec.parts.iter();
        let intervals: Vec<_> = parts.map(|(_, of)| self.interval(of, confidence)).collect();
        let names = spec.parts.iter().map(|(name, _)| name);
        let named = names.zip(&intervals);
        let parts: Vec<_> = named.map(|(name, found)| part(name, *found)).collect();
        let measures: Vec<_> = spec.parts.iter().map(|(_, of)| of.measure).collect();
        let is_one = measures.windows(2).all(|pair| pair[0] == pair[1]);
        let common = measures.first().filter(|_| is_one);
        let measure = common.map_or(String::new(), |measure| format!("{measure}: "));
        Claim {
            id: spec.id.clone(),
            claim: spec.claim.clone(),
            source: spec.source.clone(),
            verdict: worded(verdict(&intervals, spec), spec),
            found: format!("{measure}{}.", parts.join("; ")),
            method: self.method(spec),
            tables: Vec::new(),
            plots: Vec::new(),
        }
    }

    /// Describes the intervals and the clock of a claim.
    fn method(&self, spec: &ClaimSpec) -> String {
        let mut text = format!("{RATIOS} The intervals of a statement hold together with 95 %.");
        if spec.parts.iter().any(|(_, of)| of.measure.is_time()) {
            text.push_str(match self.clock {
                Clock::Processors => " Time is processor time of all threads.",
                Clock::Wall => " Time is that of the clock: the system reports no processor time.",
            });
        }
        text
    }
}

/// Returns the confidence of each of the `parts` intervals of a statement, by Bonferroni's correction.
fn shared(parts: usize) -> f64 {
    1.0 - (1.0 - CONFIDENCE) / parts.max(1) as f64
}

/// Formats a number with its interval.
fn part(name: &str, found: Option<Interval>) -> String {
    let Some(Interval { value, low, high }) = found else {
        return format!("{name}: not measured");
    };
    let digits = match value.abs() {
        small if small < 10.0 => 3,
        medium if medium < 100.0 => 2,
        _ => 0,
    };
    format!("{name}: {value:.digits$} [{low:.digits$}, {high:.digits$}]")
}

/// Returns the verdict on the statement that all numbers with these intervals are in the expected range.
fn verdict(intervals: &[Option<Interval>], spec: &ClaimSpec) -> Verdict {
    let known = intervals.iter().copied().collect::<Option<Vec<_>>>();
    let Some(known) = known.filter(|known| !known.is_empty()) else {
        return Verdict::NotMeasured;
    };
    let low = spec.above.unwrap_or(f64::NEG_INFINITY);
    let high = spec.below.unwrap_or(f64::INFINITY);
    let is_outside = |found: &Interval| found.high < low || found.low > high;
    let is_inside = |found: &Interval| found.low > low && found.high < high;
    if known.iter().any(is_outside) {
        Verdict::NotReproduced
    } else if known.iter().all(is_inside) {
        Verdict::Reproduced
    } else {
        Verdict::Undecided
    }
}

fn worded(verdict: Verdict, spec: &ClaimSpec) -> Verdict {
    match (verdict, spec.goal) {
        (Verdict::Reproduced, true) => Verdict::Met,
        (Verdict::NotReproduced, true) => Verdict::NotMet,
        (other, _) => other,
    }
}

//! Errors times costs, and by which factor one method has less of them.

use super::{Judged, budget_of};
use crate::experiment::analysis::records_of;
use crate::results::{BudgetKind, Record, Results, SceneInfo};
use crate::statistics::{Interval, ratio_interval};

/// Which records are compared, by which cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum View {
    /// Those of equal time, by time.
    EqualTime,
    /// Those of equal rays, by rays.
    EqualRays,
    /// Those of equal rays, by the time that they took.
    TimeOfRays,
}

/// Which error counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Error {
    /// relMSE of pixels.
    Pixels,
    /// relMSE of all pixels but the worst thousandth, which may be all that the first one tells of.
    Trimmed,
    /// relMSE of means over blocks.
    Blocks,
}

impl View {
    fn budget(self) -> BudgetKind {
        match self {
            Self::EqualTime => BudgetKind::Seconds,
            Self::EqualRays | Self::TimeOfRays => BudgetKind::Rays,
        }
    }

    /// In words, after a comma.
    pub(super) fn words(self) -> &'static str {
        match self {
            Self::EqualTime => "in equal time",
            Self::EqualRays => "at equal rays",
            Self::TimeOfRays => "in time, at equal rays",
        }
    }

    /// The unit of the cost.
    pub(super) fn unit(self, clock: Clock) -> &'static str {
        match (self, clock) {
            (Self::EqualRays, _) => "rays",
            (_, Clock::Processors) => "processor seconds",
            (_, Clock::Wall) => "seconds",
        }
    }

    /// What a record cost, and the part of it that was training. None: that is not known.
    fn cost(self, record: &Record, clock: Clock) -> Option<[f64; 2]> {
        match (self, clock) {
            (Self::EqualRays, _) => {
                let rays = record.rays;
                Some([rays.total() as f64, rays.training as f64])
            }
            (_, Clock::Processors) => {
                let training = record.training_processor_seconds?;
                Some([record.processor_seconds?, training])
            }
            (_, Clock::Wall) => Some([record.seconds, record.training_seconds?]),
        }
    }
}

impl Error {
    fn metric(self) -> &'static str {
        match self {
            Self::Pixels => "relmse",
            Self::Trimmed => "relmse_trim",
            Self::Blocks => "relmse_block",
        }
    }
}

/// What time is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Clock {
    /// That of the processors, of all threads.
    Processors,
    /// That of the wall.
    Wall,
}

impl Clock {
    /// The one that all records have.
    pub(super) fn of(results: &Results) -> Self {
        let mut records = results.records.iter();
        let is_known = |record: &Record| {
            record.processor_seconds.is_some() && record.training_processor_seconds.is_some()
        };
        if records.all(is_known) {
            Self::Processors
        } else {
            Self::Wall
        }
    }

    pub(super) fn words(self) -> &'static str {
        match self {
            Self::Processors => "processor seconds of all threads, as user and as system",
            Self::Wall => "seconds of the clock, as the system does not report processor seconds",
        }
    }
}

/// What is measured in a scene.
#[derive(Clone, Copy)]
pub(super) struct Measured<'a> {
    pub(super) results: &'a Results,
    pub(super) scene: &'a SceneInfo,
    pub(super) view: View,
    pub(super) clock: Clock,
    pub(super) judged: Judged,
}

impl<'a> Measured<'a> {
    /// The records of a method, by seed.
    pub(super) fn records(&self, method: &str) -> Vec<&'a Record> {
        match budget_of(self.results, self.view.budget()) {
            Some(budget) => records_of(self.results, [&self.scene.name, budget, method]),
            None => Vec::new(),
        }
    }

    /// Error · (c - T) · B / (B - T) of a render of cost c, whose training costs T. B is the budget that
    /// is judged, and no less than c, which is more than T. None: one of them is not known.
    fn value(&self, record: &Record, error: Error) -> Option<f64> {
        let [cost, training] = self.view.cost(record, self.clock)?;
        let budget = self.budget().max(cost);
        let weight = budget / (budget - training);
        Some(record.metrics.get(error.metric())? * (cost - training) * weight)
    }

    /// The budget that is judged, in the unit of the cost.
    fn budget(&self) -> f64 {
        let Judged { seconds, rays } = self.judged;
        match (self.view, self.clock) {
            (View::EqualRays, _) => {
                rays * self
                    .scene
                    .size
                    .map(|side| side as f64)
                    .iter()
                    .product::<f64>()
            }
            (_, Clock::Processors) => seconds * self.results.machine.threads.max(1) as f64,
            (_, Clock::Wall) => seconds,
        }
    }

    /// The gain of a method over another, over the seeds that both have. None: fewer than two have.
    pub(super) fn gain(
        &self,
        [method, over]: [&str; 2],
        error: Error,
        confidence: f64,
    ) -> Option<Interval> {
        let others = self.records(over);
        let pair = |record: &Record| {
            let other = others.iter().find(|other| other.seed == record.seed)?;
            Some((self.value(other, error)?, self.value(record, error)?))
        };
        let own = self.records(method);
        let pairs = own.into_iter().filter_map(pair);
        let (others, own): (Vec<_>, Vec<_>) = pairs.unzip();
        ratio_interval(&others, &own, confidence)
    }

    /// The geometric mean over seeds of error · cost. None: nothing is known, or something is 0.
    pub(super) fn mean(&self, method: &str, error: Error) -> Option<f64> {
        let records = self.records(method);
        let values = records.iter().map(|record| self.value(record, error));
        let logs: Option<Vec<f64>> = values.map(|value| Some(libm::log(value?))).collect();
        let logs = logs.filter(|logs| !logs.is_empty())?;
        let mean = libm::exp(logs.iter().sum::<f64>() / logs.len() as f64);
        (mean > 0.0).then_some(mean)
    }
}

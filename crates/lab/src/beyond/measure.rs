//! Errors times costs, and by which factor one method has less of them.

use super::budget_of;
use crate::experiment::analysis::records_of;
use crate::results::{BudgetKind, Record, Results};
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
            Self::TimeOfRays => "in time",
        }
    }

    /// What a record cost. None: that is not known.
    fn cost(self, record: &Record, clock: Clock) -> Option<f64> {
        match (self, clock) {
            (Self::EqualRays, _) => Some(record.rays.total() as f64),
            (_, Clock::Processors) => record.processor_seconds,
            (_, Clock::Wall) => Some(record.seconds),
        }
    }
}

impl Error {
    fn metric(self) -> &'static str {
        match self {
            Self::Pixels => "relmse",
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
        if records.all(|record| record.processor_seconds.is_some()) {
            Self::Processors
        } else {
            Self::Wall
        }
    }

    pub(super) fn words(self) -> &'static str {
        match self {
            Self::Processors => "processor seconds of all threads, as user and as system",
            Self::Wall => {
                "seconds of the clock, as the system does not tell those of the processors"
            }
        }
    }
}

/// What is measured in a scene.
#[derive(Clone, Copy)]
pub(super) struct Measured<'a> {
    pub(super) results: &'a Results,
    pub(super) scene: &'a str,
    pub(super) view: View,
    pub(super) clock: Clock,
}

impl<'a> Measured<'a> {
    /// The records of a method, by seed.
    pub(super) fn records(&self, method: &str) -> Vec<&'a Record> {
        match budget_of(self.results, self.view.budget()) {
            Some(budget) => records_of(self.results, [self.scene, budget, method]),
            None => Vec::new(),
        }
    }

    /// Error · cost. None: one of them is not known.
    pub(super) fn value(&self, record: &Record, error: Error) -> Option<f64> {
        Some(record.metrics.get(error.metric())? * self.view.cost(record, self.clock)?)
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

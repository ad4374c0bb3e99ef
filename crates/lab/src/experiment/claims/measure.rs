//! Numbers of one record.

use crate::metric::Metric;
use crate::results::{Record, SceneInfo};
use bidir::names::UnknownName;
use std::fmt;
use std::str::FromStr;

/// The cost at which errors are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cost {
    /// All rays.
    Rays,
    /// Processor time if all records have it, else wall time.
    Time,
}

/// A number of a record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measure {
    /// The error against the reference.
    Metric(Metric),
    /// The error at equal cost.
    AtCost(Metric, Cost),
    /// Another number, by its index in the list of figures.
    Figure(usize),
    /// One of the [`FIGURES`](crate::experiment::contributions::FIGURES) of contributions.
    Contributions(&'static str),
}

/// The clock that measures time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Clock {
    /// Processor time of all threads, which hardly depends on other work of the machine.
    Processors,
    /// Wall time.
    Wall,
}

/// A record with the context of its numbers.
#[derive(Clone, Copy)]
pub(super) struct Measured<'a> {
    pub(super) record: &'a Record,
    pub(super) scene: &'a SceneInfo,
    pub(super) clock: Clock,
    /// Threads of the render.
    pub(super) threads: usize,
    /// The full budget B, in rays per pixel or in seconds, over which the cost of training is distributed.
    /// None: the cost of the record.
    pub(super) full: Option<(Cost, f64)>,
}

type Figure = fn(&Measured<'_>) -> Option<f64>;

/// Numbers other than metrics, with their names and units.
const FIGURES: [(&str, Figure); 13] = [
    ("samples per pixel", |of| Some(of.record.spp as f64)),
    ("rays per pixel", |of| {
        Some(of.record.rays.total() as f64 / of.pixels())
    }),
    ("seconds", |of| Some(of.record.seconds)),
    ("processor seconds", |of| of.record.processor_seconds),
    ("processor seconds of training", |of| {
        of.record.training_processor_seconds
    }),
    ("efficiency by rays", |of| Some(of.record.efficiency_rays)),
    ("efficiency by time", |of| {
        Some(of.record.efficiency_seconds)
    }),
    ("nanoseconds per ray", |of| {
        let [time, rays] = [Cost::Time, Cost::Rays].map(|cost| of.without_training(cost));
        Some(1e9 * time? / rays?)
    }),
    ("rays per sample", |of| {
        Some(of.without_training(Cost::Rays)? / of.samples())
    }),
    ("shadow rays per sample", |of| {
        Some(of.shadow_rays() / of.samples())
    }),
    ("shadow rays, % of all", |of| {
        Some(100.0 * of.shadow_rays() / of.without_training(Cost::Rays)?)
    }),
    ("camera rays per sample", |of| Some(of.camera_rays())),
    ("connections per sample", |of| {
        // The subpaths of a sample are independent; the point on the light is a vertex, too.
        let light = 1.0 + of.record.rays.light as f64 / of.samples();
        Some(light * of.camera_rays())
    }),
];

impl Measured<'_> {
    fn pixels(&self) -> f64 {
        let [width, height] = self.scene.size;
        (width * height) as f64
    }

    fn samples(&self) -> f64 {
        self.record.spp as f64 * self.pixels()
    }

    fn camera_rays(&self) -> f64 {
        self.record.rays.camera as f64 / self.samples()
    }

    fn shadow_rays(&self) -> f64 {
        (self.record.rays.connection + self.record.rays.light_image) as f64
    }

    /// Returns the cost of the render, and the part due to training. None: not measured.
    fn cost(&self, cost: Cost) -> Option<[f64; 2]> {
        let record = self.record;
        match (cost, self.clock) {
            (Cost::Rays, _) => Some([record.rays.total(), record.rays.training].map(|n| n as f64)),
            (_, Clock::Processors) => Some([
                record.processor_seconds?,
                record.training_processor_seconds?,
            ]),
            (_, Clock::Wall) => Some([record.seconds, record.training_seconds?]),
        }
    }

    fn without_training(&self, cost: Cost) -> Option<f64> {
        let [all, training] = self.cost(cost)?;
        Some(all - training)
    }

    /// Computes (c - T) · B / (B - T): the cost c without training T, scaled to the full budget B.
    fn weighed(&self, cost: Cost) -> Option<f64> {
        let [all, training] = self.cost(cost)?;
        let full = self.full.filter(|(kind, _)| *kind == cost);
        let unit = match (cost, self.clock) {
            (Cost::Rays, _) => self.pixels(),
            (_, Clock::Processors) => self.threads.max(1) as f64,
            (_, Clock::Wall) => 1.0,
        };
        let budget = full.map_or(all, |(_, amount)| amount * unit).max(all);
        Some((all - training) * budget / (budget - training))
    }

    /// Returns the number of this record. None: not measured.
    pub(super) fn value(&self, measure: Measure) -> Option<f64> {
        match measure {
            Measure::Metric(metric) => self.record.metrics.get(metric.name()).copied(),
            Measure::AtCost(metric, cost) => {
                let error = self.value(Measure::Metric(metric))?;
                Some(error * libm::pow(self.weighed(cost)?, metric.order()?))
            }
            Measure::Figure(index) => FIGURES[index].1(self),
            Measure::Contributions(_) => None,
        }
    }
}

impl Measure {
    /// Returns true if the number depends on a clock.
    pub(super) fn is_time(self) -> bool {
        matches!(self, Self::AtCost(_, Cost::Time))
            || matches!(self, Self::Figure(index) if FIGURES[index].0.contains("seconds"))
    }
}

/// Parses `rmse`, `rmse at equal rays`, `rmse in equal time`, or the name of a figure.
impl FromStr for Measure {
    type Err = UnknownName;

    fn from_str(text: &str) -> Result<Self, UnknownName> {
        let all = all();
        let found = all.iter().find(|(name, _)| name == text);
        found.map(|(_, measure)| *measure).ok_or_else(|| {
            let names: Vec<&str> = all.iter().map(|(name, _)| name.as_str()).collect();
            UnknownName::new(text, &names)
        })
    }
}

/// Returns the names of all measures that are not metrics.
#[cfg(test)]
pub(in super::super) fn figure_names() -> Vec<String> {
    let all = all().into_iter();
    let figures = all
        .filter(|(_, measure)| matches!(measure, Measure::Figure(_) | Measure::Contributions(_)));
    figures.map(|(name, _)| name).collect()
}

/// Returns all measures with their names.
fn all() -> Vec<(String, Measure)> {
    let metrics = Metric::NAMES.into_iter().flat_map(|(name, metric)| {
        let at = |words: &str, cost| (format!("{name} {words}"), Measure::AtCost(metric, cost));
        let both = [
            at("at equal rays", Cost::Rays),
            at("in equal time", Cost::Time),
        ];
        let equal = both.into_iter().filter(move |_| metric.order().is_some());
        std::iter::once((name.to_owned(), Measure::Metric(metric))).chain(equal)
    });
    let numbered = FIGURES.iter().enumerate();
    let figures = numbered.map(|(index, (name, _))| ((*name).to_owned(), Measure::Figure(index)));
    let names = crate::experiment::contributions::FIGURES.iter();
    let contributions = names.map(|name| ((*name).to_owned(), Measure::Contributions(name)));
    metrics.chain(figures).chain(contributions).collect()
}

impl fmt::Display for Measure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let all = all();
        let found = all.iter().find(|(_, measure)| measure == self);
        f.write_str(found.map_or("", |(name, _)| name))
    }
}

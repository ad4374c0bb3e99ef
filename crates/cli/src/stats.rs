//! Counts and measurements of a render: as JSON, and as lines to read.

mod parts;
mod summary;

use crate::scene_io::Stopping;
use bidir::driver::{Budget, Session};
use bidir::film::Film;
use bidir::stats::{Dropped, StrategyCounts};
use formats::film::SettingsText;
use lab::sample::TrainingReport;
use parts::{BudgetReport, RayReport, StagesReport, StrategyReport};
use serde::Serialize;
use std::collections::BTreeSet;
use std::time::Duration;

pub(crate) use summary::{Summary, listed};

/// The version of the program.
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The course of a render.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Course {
    /// Reading and building the scene.
    pub(crate) load: Duration,
    /// Training and rendering.
    pub(crate) render: Duration,
    /// The reason for the number of passes.
    pub(crate) stopping: Stopping,
}

/// The report of a render.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Report {
    version: &'static str,
    scene: String,
    resolution: [u32; 2],
    /// Left, top, right and bottom (exclusive) of what was rendered.
    crop: [u32; 4],
    settings: SettingsText,
    budget: BudgetReport,
    threads: usize,
    isa: String,
    spp: u64,
    /// The passes of the film, those of earlier runs included.
    passes: String,
    stopping: &'static str,
    seconds: f64,
    load_seconds: f64,
    samples: u64,
    samples_per_second: f64,
    /// None: too few samples to measure one.
    stages: Option<StagesReport>,
    rays: RayReport,
    connection_rays_per_sample: f64,
    connection_blocked: u64,
    light_image_blocked: u64,
    candidates: u64,
    strategies: Vec<StrategyReport>,
    /// Of paths that are too long for counts of their own.
    longer_paths: StrategyCounts,
    training: Option<TrainingReport>,
    dropped: u64,
    dropped_list: BTreeSet<Dropped>,
    film_bytes: u64,
    bvh_bytes: usize,
}

impl Report {
    /// The report of the passes of `session` so far, of the scene file `scene`.
    pub(crate) fn new(
        scene: String,
        session: &Session<'_>,
        budget: Budget,
        course: Course,
    ) -> Self {
        let (stats, film) = (session.stats(), session.film().settings());
        let (bvh, training) = (session.scene().bvh(), session.training());
        let ([left, top], [right, bottom]) = (film.crop.min, film.crop.max);
        let seconds = course.render.as_secs_f64();
        Self {
            version: VERSION,
            scene,
            resolution: film.resolution,
            crop: [left, top, right, bottom],
            settings: SettingsText::from(session.settings()),
            budget: BudgetReport {
                spp: budget.passes,
                seconds: budget.time.map(|time| time.as_secs_f64()),
            },
            threads: session.threads(),
            isa: bvh.isa().to_string(),
            spp: session.film().passes().len(),
            passes: session.film().passes().to_string(),
            stopping: course.stopping.name(),
            seconds,
            load_seconds: course.load.as_secs_f64(),
            samples: stats.samples,
            samples_per_second: stats.samples as f64 / seconds,
            stages: StagesReport::new(session.stage_times()),
            rays: RayReport {
                of_image: stats.rays,
                training: training.map_or(0, |training| training.rays.total()),
            },
            connection_rays_per_sample: per_sample(stats.rays.connection, stats.samples),
            connection_blocked: stats.connections_blocked,
            light_image_blocked: stats.light_image_blocked,
            candidates: stats.candidates,
            strategies: StrategyReport::all(session),
            longer_paths: stats.strategies.longer(),
            training: TrainingReport::new(session),
            dropped: stats.dropped,
            dropped_list: stats.dropped_list.clone(),
            film_bytes: Film::memory(film, &session.settings().layers),
            bvh_bytes: bvh.memory_bytes(),
        }
    }

    /// The counts of each strategy, as a table to read.
    pub(crate) fn strategy_table(&self) -> String {
        parts::strategy_table(&self.strategies, self.samples)
    }

    /// The warning of raw images that lack values. None: they lack none.
    pub(crate) fn raw_warning(&self) -> Option<String> {
        let dropped = |strategy: &StrategyReport| strategy.raw_dropped.unwrap_or(0);
        let count: u64 = self.strategies.iter().map(dropped).sum();
        (count > 0).then(|| {
            format!(
                "{count} values were too large without their weight, and are missing in raw images"
            )
        })
    }

    /// The warning of dropped contributions. None: there were none.
    pub(crate) fn warning(&self) -> Option<String> {
        let first = self.dropped_list.first()?;
        let [x, y] = first.pixel;
        Some(format!(
            "{} contributions were not finite or too large, and were dropped; the first by {}, \
             repeat it with --replay {x},{y},{}",
            self.dropped, first.strategy, first.pass
        ))
    }
}

fn per_sample(count: u64, samples: u64) -> f64 {
    count as f64 / samples.max(1) as f64
}

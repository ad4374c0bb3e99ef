//! Counts and measurements of a render, as JSON and as text.

mod summary;

use bidir::driver::Budget;
use bidir::film::Film;
use bidir::stats::{Stage, StageTimes, Stats};
use formats::film::{Render, SettingsText};
use lab::pyramid::Figures;
use lab::sample::TrainingReport;
use serde::Serialize;
use serde_json::{Value, json};
use std::time::Duration;

pub(crate) use summary::{Summary, listed};

/// The report of a render. Numbers that are not finite become null in JSON.
#[derive(Debug, Serialize)]
#[serde(transparent)]
pub(crate) struct Report {
    json: Value,
    #[serde(skip)]
    strategies: Vec<Figures>,
    /// The warnings of dropped values.
    #[serde(skip)]
    pub(crate) warnings: Vec<String>,
}

impl Report {
    /// Returns the report of a render of the scene file `scene`; `load` is the time of reading the scene.
    pub(crate) fn new(scene: String, load: Duration, render: &Render, budget: Budget) -> Self {
        let session = &render.session;
        let (stats, film) = (session.stats(), session.film().settings());
        let (bvh, training) = (session.scene().bvh(), session.training());
        let ([left, top], [right, bottom]) = (film.crop.min, film.crop.max);
        let seconds = render.spent.total.as_secs_f64();
        let strategies = Figures::all(session);
        let mut rays = json!(stats.rays);
        rays["training"] = training.map_or(0, |training| training.rays.total()).into();
        let json = json!({
            "version": env!("CARGO_PKG_VERSION"),
            "scene": Value::String(scene),
            "resolution": film.resolution,
            "crop": [left, top, right, bottom],
            "settings": SettingsText::from(session.settings()),
            "budget": {
                "spp": budget.passes,
                "seconds": budget.time.map(|time| time.as_secs_f64()),
            },
            "threads": session.threads(),
            "isa": bvh.isa().to_string(),
            "spp": session.film().passes().len(),
            "passes": session.film().passes().to_string(),
            "stopping": render.stopping.name(),
            "seconds": seconds,
            "load_seconds": load.as_secs_f64(),
            "samples": stats.samples,
            "samples_per_second": stats.samples as f64 / seconds,
            "stages": stages(session.stage_times()),
            "rays": rays,
            "connection_rays_per_sample": per_sample(stats.rays.connection, stats.samples),
            "connection_blocked": stats.connections_blocked,
            "light_image_blocked": stats.light_image_blocked,
            "candidates": stats.candidates,
            "strategies": strategies.iter().map(row).collect::<Vec<_>>(),
            "longer_paths": stats.strategies.longer(),
            "training": TrainingReport::new(session),
            "dropped": stats.dropped,
            "dropped_list": stats.dropped_list,
            "film_bytes": Film::memory(film, &session.settings().layers),
            "bvh_bytes": bvh.memory_bytes(),
        });
        Self {
            json,
            warnings: warnings(stats, &strategies),
            strategies,
        }
    }

    /// Returns a table, as text, of the strategies whose images the film keeps.
    pub(crate) fn strategy_table(&self) -> String {
        let head = "strategy  rays/sample  blocked        mean    variance\n".to_owned();
        let samples = self.json["samples"].as_u64().unwrap_or_default();
        self.strategies.iter().fold(head, |table, row| {
            let Some(images) = row.images else {
                return table;
            };
            let rays = per_sample(row.counts.traced, samples);
            let or_dash = |text: Option<String>| text.unwrap_or_else(|| "-".to_owned());
            let blocked = row
                .blocked_share()
                .map(|share| format!("{:.1} %", 100.0 * share));
            let variance = images.variance.map(|variance| format!("{variance:.3e}"));
            let [blocked, variance] = [blocked, variance].map(or_dash);
            let (name, mean) = (row.strategy.to_string(), format!("{:.3e}", images.mean));
            table + &format!("{name:<8} {rays:>12.3} {blocked:>8} {mean:>11} {variance:>11}\n")
        })
    }
}

/// Returns the warnings of dropped contributions, and of values that raw images lack.
fn warnings(stats: &Stats, strategies: &[Figures]) -> Vec<String> {
    let dropped = stats.dropped_list.first().map(|first| {
        let ([x, y], pass) = (first.pixel, first.pass);
        format!(
            "{} contributions were not finite or too large, and were dropped; the first by {}, \
             repeat it with --replay {x},{y},{pass}",
            stats.dropped, first.strategy
        )
    });
    let images = strategies.iter().filter_map(|figures| figures.images);
    let lacking: u64 = images.map(|images| images.raw_dropped).sum();
    let raw = (lacking > 0).then(|| {
        format!(
            "{lacking} values were too large without their weight, and are missing in raw images"
        )
    });
    dropped.into_iter().chain(raw).collect()
}

fn per_sample(count: u64, samples: u64) -> f64 {
    count as f64 / samples.max(1) as f64
}

/// Returns the time of a sample on one thread by stage, averaged over the measured samples. None: no sample was
/// measured.
fn stages(times: &StageTimes) -> Option<Value> {
    let total = times.total().as_secs_f64();
    let per_sample = |seconds: f64| seconds * 1e9 / times.samples as f64;
    let parts = Stage::NAMES.into_iter().filter_map(|(name, stage)| {
        let seconds = times.of(stage).as_secs_f64();
        (seconds > 0.0).then(|| {
            json!({
                "stage": name,
                "share": seconds / total,
                "nanoseconds_per_sample": per_sample(seconds),
            })
        })
    });
    (times.samples > 0).then(|| {
        json!({
            "measured_samples": times.samples,
            "nanoseconds_per_sample": per_sample(total),
            "parts": parts.collect::<Vec<_>>(),
        })
    })
}

/// Returns the JSON row of a strategy: its counts, and its mean luminance and variance if the film keeps its image.
fn row(figures: &Figures) -> Value {
    let images = figures.images;
    let mut row = json!(figures.counts);
    row["s"] = figures.strategy.s.into();
    row["t"] = figures.strategy.t.into();
    row["blocked_share"] = figures.blocked_share().into();
    row["mean"] = images.map(|images| images.mean).into();
    row["variance"] = images.and_then(|images| images.variance).into();
    row["raw_dropped"] = images.map(|images| images.raw_dropped).into();
    row
}

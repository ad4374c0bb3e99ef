//! The parts of a report, as JSON has them. Numbers that are not finite become null.

use bidir::driver::Session;
use bidir::path::Strategy;
use bidir::stats::{RayCounts, Stage, StageTimes, StrategyCounts};
use lab::pyramid::Figures;
use serde::Serialize;

/// The limits of a render.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct BudgetReport {
    pub(super) spp: Option<u64>,
    pub(super) seconds: Option<f64>,
}

/// The rays of a render.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct RayReport {
    #[serde(flatten)]
    pub(super) of_image: RayCounts,
    /// Not in the sum.
    pub(super) training: u64,
}

/// The time of samples by stage, from those that were measured.
#[derive(Clone, Debug, Serialize)]
pub(super) struct StagesReport {
    measured_samples: u64,
    /// Of one thread, clock included; as all times here.
    nanoseconds_per_sample: f64,
    /// The parts that the estimator has, in the order of a sample.
    parts: Vec<StageReport>,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct StageReport {
    stage: &'static str,
    share: f64,
    nanoseconds_per_sample: f64,
}

impl StagesReport {
    /// None: no sample was measured.
    pub(super) fn new(times: &StageTimes) -> Option<Self> {
        let total = times.total().as_secs_f64();
        let per_sample = |seconds: f64| seconds * 1e9 / times.samples as f64;
        let parts = Stage::NAMES.into_iter().map(|(name, stage)| {
            let seconds = times.of(stage).as_secs_f64();
            StageReport {
                stage: name,
                share: seconds / total,
                nanoseconds_per_sample: per_sample(seconds),
            }
        });
        (times.samples > 0).then(|| Self {
            measured_samples: times.samples,
            nanoseconds_per_sample: per_sample(total),
            parts: parts.filter(|part| part.share > 0.0).collect(),
        })
    }
}

#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct StrategyReport {
    s: u16,
    t: u16,
    #[serde(flatten)]
    counts: StrategyCounts,
    /// The blocked part of the traced rays.
    blocked_share: Option<f64>,
    /// Of the luminance of its weighted image; where the film keeps one, as the fields below.
    mean: Option<f64>,
    /// Of the value that a pass adds to a pixel, in the mean pixel.
    variance: Option<f64>,
    /// Values that are in the weighted image, but too large for the raw one.
    pub(super) raw_dropped: Option<u64>,
}

impl StrategyReport {
    /// All strategies with counts, shorter paths first.
    pub(super) fn all(session: &Session<'_>) -> Vec<Self> {
        let all = Figures::all(session);
        all.iter().map(Self::from).collect()
    }
}

impl From<&Figures> for StrategyReport {
    fn from(figures: &Figures) -> Self {
        let images = figures.images;
        Self {
            s: figures.strategy.s,
            t: figures.strategy.t,
            counts: figures.counts,
            blocked_share: figures.blocked_share(),
            mean: images.map(|images| images.mean),
            variance: images.and_then(|images| images.variance),
            raw_dropped: images.map(|images| images.raw_dropped),
        }
    }
}

/// The strategies that the film keeps images of, in columns.
pub(super) fn strategy_table(strategies: &[StrategyReport], samples: u64) -> String {
    let head = "strategy  rays/sample  blocked        mean    variance\n".to_owned();
    let kept = strategies.iter().filter(|row| row.mean.is_some());
    let number = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.3e}"));
    kept.fold(head, |table, row| {
        let name = Strategy { s: row.s, t: row.t };
        let rays = row.counts.traced as f64 / samples.max(1) as f64;
        let blocked = row.blocked_share;
        let blocked = blocked.map_or("-".to_owned(), |share| format!("{:.1} %", 100.0 * share));
        let [mean, variance] = [row.mean, row.variance].map(number);
        let name = name.to_string();
        table + &format!("{name:<8} {rays:>12.3} {blocked:>8} {mean:>11} {variance:>11}\n")
    })
}

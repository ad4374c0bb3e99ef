//! The lines that are printed at the end of a render.

use crate::args::short;
use bidir::driver::{Budget, Plan};
use bidir::integrator::{CandidateCount, IntegratorKind};
use formats::film::Render;
use std::time::Duration;

/// The number of passes below which the variance of a pixel is too uncertain for an error.
const LEAST_PASSES: u64 = 16;

/// The summary of a render, for people.
#[derive(Clone, Debug)]
pub(crate) struct Summary {
    /// Number of all passes of the film.
    passes: u64,
    /// Number of passes of this run.
    rendered: u64,
    /// The number of passes to reach. None: there is no limit.
    wanted: Option<u64>,
    /// The passes as ranges. None: this is not a part of a render.
    pub(crate) part: Option<String>,
    /// Width and height of the crop. None: the whole film is rendered.
    crop: Option<[u32; 2]>,
    time: Duration,
    /// The relative error, by the measure of `--noise`. None: it is not known.
    error: Option<f64>,
    /// True if `--noise` asks for an error, but the film has too few passes for one.
    lacks_error: bool,
    /// True if the image is denoised, so that the error is that of the image before.
    pub(crate) is_denoised: bool,
    plan: Option<Plan>,
    /// Number of training samples. None: training was not limited.
    trained: Option<u64>,
}

impl Summary {
    /// Returns the summary of a render. The caller sets `part` and `is_denoised`.
    pub(crate) fn new(render: &Render, budget: Budget) -> Self {
        let session = &render.session;
        let film = session.film();
        let (passes, settings) = (film.passes(), film.settings());
        let crop = settings.crop;
        let size = [0, 1].map(|axis| crop.max[axis] - crop.min[axis]);
        let training = session.training();
        let error = (passes.len() >= LEAST_PASSES).then(|| session.noise());
        Self {
            passes: passes.len(),
            rendered: session.stats().samples / crop.area().max(1),
            wanted: budget.passes,
            part: None,
            crop: (size != settings.resolution).then_some(size),
            time: render.spent.total,
            error: error.filter(|error| error.is_finite() && *error > 0.0),
            lacks_error: budget.noise.is_some() && passes.len() < LEAST_PASSES,
            is_denoised: false,
            plan: training.and_then(|training| training.plan),
            trained: training.and_then(|training| training.is_short.then_some(training.samples)),
        }
    }

    /// Returns a line with samples, time and error, and one with the plan of `auto` and limited training, if any.
    pub(crate) fn lines(&self) -> Vec<String> {
        let chosen = self.plan.as_ref();
        let plan = chosen.map(|plan| format!("auto chose {}", describe(plan)));
        let trained = self.trained.map(|samples| {
            format!("training was limited to {samples} samples, a tenth of the time")
        });
        let parts: Vec<_> = plan.into_iter().chain(trained).collect();
        let training = Some(parts.join("; ")).filter(|line| !line.is_empty());
        std::iter::once(self.samples()).chain(training).collect()
    }

    fn samples(&self) -> String {
        let time = short(self.time);
        let count = match self.wanted.filter(|wanted| self.passes < *wanted) {
            Some(wanted) => format!("{} of {wanted} samples per pixel", self.passes),
            None if self.passes == 1 => "1 sample per pixel".to_owned(),
            None => format!("{} samples per pixel", self.passes),
        };
        let part = self.part.as_ref().map(|part| format!(" (passes {part})"));
        let size = self.crop;
        let crop = size.map(|[width, height]| format!(" of a crop of {width}x{height} pixels"));
        let run = match self.rendered {
            0 => ", all of them from the checkpoint".to_owned(),
            rendered if rendered < self.passes => format!(", {rendered} of them in {time}"),
            _ => format!(" in {time}"),
        };
        let noisy = if self.is_denoised {
            " before denoising"
        } else {
            ""
        };
        let digits = self.error.map(two_digits);
        let known = digits.map(|error| format!(", relative error {error}{noisy}"));
        let lacks = format!(", no relative error below {LEAST_PASSES} samples");
        let error = known.or_else(|| self.lacks_error.then_some(lacks));
        let parts = [Some(count), part, crop, Some(run), error];
        parts.into_iter().flatten().collect()
    }
}

/// Returns the flags of `bidir render` for the plan of `auto`.
fn describe(plan: &Plan) -> String {
    let name = plan.integrator;
    let is_lvc = plan.integrator == IntegratorKind::Lvc;
    let (candidates, rays) = (plan.candidates, plan.shadow_rays);
    let samples = plan.samples_per_subpath.get();
    let has_own_lights = is_lvc && plan.next_events != CandidateCount::NEXT_EVENTS;
    let has_own = plan.roulette != plan.integrator.roulette();
    let given = [
        Some(format!("--integrator {name}")),
        is_lvc.then(|| format!("--candidates {candidates}")),
        has_own_lights.then(|| format!("--next-events {}", plan.next_events)),
        is_lvc.then(|| format!("--shadow-rays {rays}")),
        is_lvc.then(|| format!("--samples-per-subpath {samples}")),
        has_own.then(|| format!("--path-roulette {}", plan.roulette)),
    ];
    let flags: Vec<_> = given.into_iter().flatten().collect();
    flags.join(" ")
}

/// Joins names, such as `a, b and c`.
pub(crate) fn listed(names: &[String]) -> String {
    match names {
        [] => "no file".to_owned(),
        [name] => name.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// Formats a positive number with two significant digits.
fn two_digits(number: f64) -> String {
    // 0.0996 has the digits of 0.10.
    let rounded = format!("{number:.1e}").parse().unwrap_or(number);
    let exponent = libm::floor(libm::log10(rounded) + 1e-9);
    let digits = (1.0 - exponent).clamp(0.0, 12.0) as usize;
    format!("{number:.digits$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn summary() -> Summary {
        Summary {
            passes: 64,
            rendered: 64,
            wanted: Some(64),
            part: None,
            crop: None,
            time: Duration::from_millis(700),
            error: Some(0.2123),
            lacks_error: false,
            is_denoised: false,
            plan: None,
            trained: None,
        }
    }

    #[track_caller]
    fn check(summary: &Summary, expected: &str) {
        assert_eq!(summary.lines(), [expected]);
    }

    #[test]
    fn a_line_has_samples_time_and_error() {
        let all = summary();
        check(&all, "64 samples per pixel in 0.70s, relative error 0.21");
        let one = Summary {
            passes: 1,
            rendered: 1,
            wanted: None,
            error: None,
            ..summary()
        };
        check(&one, "1 sample per pixel in 0.70s");
        let asked = Summary {
            passes: 8,
            rendered: 8,
            wanted: Some(8),
            error: None,
            lacks_error: true,
            ..summary()
        };
        check(
            &asked,
            "8 samples per pixel in 0.70s, no relative error below 16 samples",
        );
        let denoised = Summary {
            is_denoised: true,
            ..summary()
        };
        check(
            &denoised,
            "64 samples per pixel in 0.70s, relative error 0.21 before denoising",
        );
    }

    #[test]
    fn a_part_says_which_one() {
        let stopped = Summary {
            wanted: Some(100),
            error: None,
            ..summary()
        };
        check(&stopped, "64 of 100 samples per pixel in 0.70s");
        let resumed = Summary {
            rendered: 24,
            ..stopped.clone()
        };
        check(&resumed, "64 of 100 samples per pixel, 24 of them in 0.70s");
        let there = Summary {
            rendered: 0,
            wanted: Some(64),
            ..stopped
        };
        check(
            &there,
            "64 samples per pixel, all of them from the checkpoint",
        );
        let part = Summary {
            part: Some("64..128".to_owned()),
            crop: Some([8, 4]),
            error: None,
            ..summary()
        };
        check(
            &part,
            "64 samples per pixel (passes 64..128) of a crop of 8x4 pixels in 0.70s",
        );
    }

    #[test]
    fn limited_training_is_named() {
        let limited = Summary {
            trained: Some(512),
            ..summary()
        };
        let [_, line] = limited.lines().try_into().expect("two lines");
        assert_eq!(
            line,
            "training was limited to 512 samples, a tenth of the time"
        );
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!(two_digits(0.2123), "0.21");
        assert_eq!(two_digits(0.00316), "0.0032");
        assert_eq!(two_digits(0.0996), "0.10");
        assert_eq!(two_digits(0.001), "0.0010");
        assert_eq!(two_digits(1.26), "1.3");
        assert_eq!(two_digits(126.0), "126");
        let names = ["a", "b", "c"].map(str::to_owned);
        assert_eq!(listed(&names), "a, b and c");
        assert_eq!(listed(&names[..2]), "a and b");
        assert_eq!(listed(&[]), "no file");
    }
}

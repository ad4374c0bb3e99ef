//! Whether what was aimed at is reached: pure functions of records.
//!
//! A target is *met* where the interval of the gain lies above it, *not met* where it lies below, and
//! *undecided* where the target is within it. Judged is `auto` with its default settings, as nobody
//! chooses anything for it; what `lvc` reaches is told beside it.

use super::measure::{Clock, Error, Measured, View};
use super::plan::{Amounts, Judged, SCENES};
use super::targets::{BEHIND, TARGETS, Target};
use super::variants::{AUTO, BASELINE, PATH, SHARED};
use crate::paper::claims::{Expected, all, judge};
use crate::results::{Claim, Results, Verdict};
use crate::statistics::Interval;

#[cfg(test)]
mod tests;

/// How sure a finding is.
pub(super) const CONFIDENCE: f64 = 0.95;

/// One for each target, and one for `auto` in each scene.
pub(super) fn claims(results: &Results, amounts: &Amounts) -> Vec<Claim> {
    let targets = TARGETS
        .iter()
        .map(|target| of_target(results, amounts, target));
    let auto = SCENES
        .iter()
        .map(|scene| of_auto(results, amounts, scene.name));
    let claims = targets.chain(auto);
    claims
        .map(|claim| Claim {
            method: method(results, amounts),
            ..claim
        })
        .collect()
}

/// How sure everything is.
fn method(results: &Results, amounts: &Amounts) -> String {
    let Amounts { seeds, judged, .. } = amounts;
    let time = Clock::of(results).words();
    format!(
        "95 % intervals of ratios, paired by {seeds} seeds; time is {time}; training is weighed as in {} \
         seconds or {} rays per pixel.",
        judged.seconds, judged.rays
    )
}

/// Gains in a scene, which may not be there.
#[derive(Clone, Copy)]
pub(super) struct Gains<'a>(Option<Measured<'a>>);

impl<'a> Gains<'a> {
    pub(super) fn new(results: &'a Results, judged: Judged, scene: &str, view: View) -> Self {
        let mut scenes = results.scenes.iter();
        let scene = scenes.find(|known| known.name == scene);
        Self(scene.map(|scene| Measured {
            results,
            scene,
            view,
            clock: Clock::of(results),
            judged,
        }))
    }

    /// The gain of a method over another, with the confidence of a finding. None: it was not measured.
    pub(super) fn of(self, pair: [&str; 2], error: Error) -> Option<Interval> {
        self.0?.gain(pair, error, CONFIDENCE)
    }
}

/// Whether a target is met: what the gain of `auto` decides.
pub(super) fn judged(results: &Results, amounts: &Amounts, target: &Target) -> Verdict {
    let gains = Gains::new(results, amounts.judged, target.scene, target.view);
    let gain = gains.of([AUTO, target.over], Error::Pixels);
    aimed(judge(gain, Expected::Above(target.gain)), gain.is_some())
}

fn of_target(results: &Results, amounts: &Amounts, target: &Target) -> Claim {
    let Target {
        scene,
        over,
        view,
        gain,
    } = *target;
    let gains = Gains::new(results, amounts.judged, scene, view);
    let reached = |method, error| words(gains.of([method, over], error));
    let verdict = judged(results, amounts, target);
    let found = format!(
        "{AUTO}: {} by pixels, {} by blocks; {SHARED}: {} by pixels, {} by blocks.",
        reached(AUTO, Error::Pixels),
        reached(AUTO, Error::Blocks),
        reached(SHARED, Error::Pixels),
        reached(SHARED, Error::Blocks),
    );
    let id = format!("{} {scene} over {over}", view.words());
    let statement = format!(
        "{scene}: {} {AUTO} gains at least {gain} × over {over}.",
        view.words()
    );
    claim(&id, statement, verdict, found)
}

/// What decides on `auto` in a scene: its gains over both that it is compared with.
pub(super) fn judged_auto(
    results: &Results,
    amounts: &Amounts,
    scene: &str,
) -> ([Option<Interval>; 2], Verdict) {
    let Gains(measured) = Gains::new(results, amounts.judged, scene, View::EqualTime);
    // One of both intervals may fail in half as many cases.
    let confidence = 0.5 + 0.5 * CONFIDENCE;
    let gains =
        [PATH, BASELINE].map(|over| measured?.gain([AUTO, over], Error::Pixels, confidence));
    let verdicts = gains.map(|gain| judge(gain, Expected::Above(1.0 / BEHIND)));
    let is_measured = gains.iter().all(Option::is_some);
    (gains, aimed(all(verdicts), is_measured))
}

fn of_auto(results: &Results, amounts: &Amounts, scene: &str) -> Claim {
    let (gains, verdict) = judged_auto(results, amounts, scene);
    let [path, bdpt] = gains.map(words);
    let gains = Gains::new(results, amounts.judged, scene, View::EqualTime);
    let blocks = [PATH, BASELINE].map(|over| words(gains.of([AUTO, over], Error::Blocks)));
    let found = format!(
        "{AUTO} gains {path} over {PATH} and {bdpt} over {BASELINE} by pixels, {} and {} by blocks.",
        blocks[0], blocks[1]
    );
    let statement = format!(
        "{scene}: in equal time {AUTO} is at most 10 % behind the better of {PATH} and {BASELINE}."
    );
    claim(&format!("auto {scene}"), statement, verdict, found)
}

/// A verdict on what is aimed at.
fn aimed(verdict: Verdict, is_measured: bool) -> Verdict {
    match verdict {
        _ if !is_measured => Verdict::NotMeasured,
        Verdict::Reproduced => Verdict::Met,
        Verdict::NotReproduced => Verdict::NotMet,
        other => other,
    }
}

fn claim(id: &str, claim: String, verdict: Verdict, found: String) -> Claim {
    let found = match verdict {
        Verdict::NotMeasured => {
            "Not measured: it takes renders of both under two seeds.".to_owned()
        }
        _ => found,
    };
    let words = id.split(|c: char| !c.is_ascii_alphanumeric());
    let words: Vec<_> = words.filter(|word| !word.is_empty()).collect();
    Claim {
        id: words.join("-"),
        claim,
        source: "A target of this project".to_owned(),
        verdict,
        found,
        method: String::new(),
        tables: Vec::new(),
        plots: Vec::new(),
    }
}

/// A gain with its interval, in words.
fn words(gain: Option<Interval>) -> String {
    match gain {
        Some(Interval { value, low, high }) => format!("{value:.2} [{low:.2}, {high:.2}]"),
        None => "not measured".to_owned(),
    }
}

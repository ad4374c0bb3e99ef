//! Whether what was aimed at is reached: pure functions of records.
//!
//! A target is *met* where the interval of the gain lies above it, *not met* where it lies below, and
//! *undecided* where the target is within it. Judged is `auto` with its default settings, as nobody
//! chooses anything for it; what `lvc` reaches is told beside it.

use super::measure::{Clock, Error, Measured, View};
use super::plan::{Amounts, SCENES};
use super::targets::{BEHIND, TARGETS, Target};
use super::variants::{AUTO, BASELINE, PATH, SHARED};
use crate::paper::claims::{Expected, all, judge};
use crate::results::{Claim, Results, Verdict};
use crate::statistics::{Interval, RATIOS};

#[cfg(test)]
mod tests;

/// How sure a finding is.
pub(super) const CONFIDENCE: f64 = 0.95;

/// One for each target, and one for `auto` in each scene.
pub(super) fn claims(results: &Results, amounts: &Amounts) -> Vec<Claim> {
    let targets = TARGETS.iter().map(|target| of_target(results, target));
    let auto = SCENES.iter().map(|scene| of_auto(results, scene.name));
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
    let time = Clock::of(results).words();
    format!(
        "{} seeds; {RATIOS} The confidence is 95 %, of all parts of a statement together. Time is {time}.",
        amounts.seeds
    )
}

/// What decides on a target: the gains of `auto`.
pub(super) fn judged(results: &Results, target: &Target) -> (Option<Interval>, Verdict) {
    let measured = measured(results, target.scene, target.view);
    let gain = measured.gain([AUTO, target.over], Error::Pixels, CONFIDENCE);
    (
        gain,
        aimed(judge(gain, Expected::Above(target.gain)), gain.is_some()),
    )
}

pub(super) fn measured<'a>(results: &'a Results, scene: &'a str, view: View) -> Measured<'a> {
    Measured {
        results,
        scene,
        view,
        clock: Clock::of(results),
    }
}

fn of_target(results: &Results, target: &Target) -> Claim {
    let Target {
        scene,
        over,
        view,
        gain,
    } = *target;
    let (_, verdict) = judged(results, target);
    let measured = measured(results, scene, view);
    let reached = |method, error| words(measured.gain([method, over], error, CONFIDENCE));
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
pub(super) fn judged_auto(results: &Results, scene: &str) -> ([Option<Interval>; 2], Verdict) {
    let measured = measured(results, scene, View::EqualTime);
    // One of both intervals may fail in half as many cases.
    let confidence = 0.5 + 0.5 * CONFIDENCE;
    let gains = [PATH, BASELINE].map(|over| measured.gain([AUTO, over], Error::Pixels, confidence));
    let verdicts = gains.map(|gain| judge(gain, Expected::Above(1.0 / BEHIND)));
    let is_measured = gains.iter().all(Option::is_some);
    (gains, aimed(all(verdicts), is_measured))
}

fn of_auto(results: &Results, scene: &str) -> Claim {
    let (gains, verdict) = judged_auto(results, scene);
    let [path, bdpt] = gains.map(words);
    let measured = measured(results, scene, View::EqualTime);
    let blocks = [PATH, BASELINE].map(|over| {
        let gain = measured.gain([AUTO, over], Error::Blocks, CONFIDENCE);
        words(gain)
    });
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

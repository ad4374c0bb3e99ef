//! All estimators in all scenes, each idea on its own, and what was aimed at.
//!
//! [`run`] renders each scene as an experiment of its own in the folder of its name, and gives one
//! [`Results`] with a [`Claim`](crate::results::Claim) for each target and for `auto` in each scene.
//! [`sections`] has the tables.
//!
//! | module | has |
//! |---|---|
//! | `plan` | scenes, sizes, budgets: what is rendered |
//! | `variants` | the estimators, and what stands for each idea |
//! | `targets` | what is aimed at |
//! | `measure` | errors times costs, and their ratios |
//! | `findings`, `tables` | what records say |
//!
//! # The measure
//!
//! The variance of an unbiased estimator falls as 1 / samples, so relMSE · cost tells how good it is
//! whatever the budget, but for training, which costs T however many samples follow. With the cost c of a
//! render, its error under a budget B would be relMSE · (c - T) / (B - T), so that what is compared is
//!
//!   relMSE · (c - T) · B / (B - T),
//!
//! which is relMSE · c under the budget itself: a quick run weighs training as a whole one does
//! ([`Judged`]). This is `relMSE · cost` in what follows. The *gain* of a method over another is the geometric mean over seeds of
//!
//!   (relMSE · cost of the other) / (relMSE · cost of the method),
//!
//! paired by seed, with its interval ([`crate::statistics::ratio_interval`]). The cost is all rays, those
//! of training included, at *equal rays*; and in *equal time* processor seconds of all threads, training
//! included, as the clock of a busy machine tells more of its other work; seconds of the clock stand in
//! for them where the host cannot tell. `relmse_block` in the place of relMSE is what is left where
//! noise of single pixels averages out, and `relmse_trim` what a few pixels do not hide. Noise of the
//! reference is in all errors, and brings gains nearer to 1.
//!
//! Ideas are rendered at equal rays alone, where processor seconds tell of equal time, too.

mod findings;
mod measure;
mod plan;
mod tables;
mod targets;
#[cfg(test)]
mod tests;
mod variants;

pub use plan::{Amounts, Judged, scene_names};
pub use tables::sections;

use crate::experiment::{
    BudgetSpec, End, Event, ExperimentError, Observer, Outcome, Setup, write_results,
};
use crate::results::{BudgetKind, Record, Results};
use crate::{parts, reference, scenes};
use plan::Place;
use std::path::PathBuf;

type Result<T> = std::result::Result<T, ExperimentError>;

/// How the experiment is run.
#[derive(Clone, Debug)]
pub struct Options {
    /// How much is rendered.
    pub amounts: Amounts,
    /// Threads of each render; 0 is one per processor.
    pub threads: usize,
    /// The folder that has `pbrt-v4/` with the scenes made by others. None: nobody named one.
    pub others: Option<PathBuf>,
    /// The names of the scenes that are rendered, of [`scene_names`]; empty: all.
    pub scenes: Vec<String>,
}

/// A scene that takes no part.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Absent {
    name: &'static str,
    reason: String,
}

/// Renders what has no record yet, judges, and writes `results.json`.
///
/// Scenes that are not there, or whose reference is contradicted by its witness, are left out with a
/// warning; no target is met by them.
///
/// Errors: no scene is there, or as of [`crate::experiment::run`].
pub fn run(options: &Options, setup: &Setup, observer: &mut dyn Observer) -> Result<Outcome> {
    parts::begin("beyond", setup)?;
    let folder = setup.folder.join("scenes");
    scenes::unpack(&folder).map_err(|error| ExperimentError::Folder {
        path: folder.clone(),
        error,
    })?;
    let (places, mut absent) = plan::places(options, &folder);
    for Absent { name, reason } in &absent {
        observer.tell(Event::Warning(&format!(
            "scene `{name}` is left out: {reason}"
        )));
    }
    if places.is_empty() {
        let reason = absent.pop().map(|absent| absent.reason);
        let reason = reason.unwrap_or_else(|| "no scene was chosen".to_owned());
        return Err(ExperimentError::NoScenes(reason));
    }
    let (end, all) = render(options, &places, &mut absent, setup, observer)?;
    let results = concluded(options, all, &absent);
    write_results(&setup.folder, &results)?;
    Ok(Outcome {
        end,
        results: Some(results),
    })
}

/// Renders all scenes; one whose reference is contradicted becomes absent.
fn render(
    options: &Options,
    places: &[Place],
    absent: &mut Vec<Absent>,
    setup: &Setup,
    observer: &mut dyn Observer,
) -> Result<(End, Results)> {
    let mut all = parts::empty("Beyond the paper", "", setup);
    for place in places {
        let name = place.scene.name;
        let experiment = plan::experiment(options, place);
        let outcome = match parts::run(&experiment, name, setup, observer) {
            Err(error) if is_contradicted(&error) => {
                let reason = error.to_string();
                observer.tell(Event::Warning(&format!(
                    "scene `{name}` is left out: {reason}"
                )));
                absent.push(Absent { name, reason });
                continue;
            }
            outcome => outcome?,
        };
        if let Some(part) = outcome.results {
            let shown = BudgetSpec::new(BudgetKind::Seconds, options.amounts.seconds);
            let shows = |record: &Record| record.budget == shown.name;
            all = parts::with(all, name, part, shows);
        }
        if outcome.end == End::Stopped {
            return Ok((End::Stopped, all));
        }
    }
    Ok((End::Complete, all))
}

/// True where the two estimators of a reference disagree: nothing is compared with it, and other scenes
/// do not depend on it.
fn is_contradicted(error: &ExperimentError) -> bool {
    let ExperimentError::Reference { error, .. } = error else {
        return false;
    };
    matches!(error, reference::Error::Disagree { .. })
}

/// With claims, and with words about what there is and what there is not.
fn concluded(options: &Options, all: Results, absent: &[Absent]) -> Results {
    let claims = findings::claims(&all, &options.amounts);
    Results {
        description: description(absent),
        claims,
        ..all
    }
}

/// What is compared, in paragraphs.
fn description(absent: &[Absent]) -> String {
    let about = "Gains of all estimators over bidirectional path tracing that traces every \
         shadow ray, in equal time and at equal rays, and the gain of each idea behind them. The \
         gain is the \
                 geometric mean over seeds of the ratio of relMSE · cost, training included; \
                 time is processor time where the system reports it.";
    let light = "Light tracing takes part where it makes all light paths: it misses everything \
         seen in mirrors or through clear glass.";
    let same = variants::aliases();
    let same = (!same.is_empty()).then(|| {
        let same = same.join("; ");
        format!("Variants with the same settings are rendered once: {same}.")
    });
    let missing = absent
        .iter()
        .map(|Absent { name, reason }| format!("The scene {name} is left out: {reason}."));
    let paragraphs = [about, light].map(str::to_owned).into_iter();
    let paragraphs: Vec<_> = paragraphs.chain(same).chain(missing).collect();
    paragraphs.join("\n\n")
}

/// The name of the budget of a kind. None: nothing was rendered under one.
fn budget_of(results: &Results, kind: BudgetKind) -> Option<&str> {
    let mut budgets = results.budgets.iter();
    let budget = budgets.find(|budget| budget.kind == kind)?;
    Some(&budget.name)
}

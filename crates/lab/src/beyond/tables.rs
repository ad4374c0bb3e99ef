//! The tables: all estimators, each idea, and what was found.

use super::findings::{CONFIDENCE, Gains, judged, judged_auto};
use super::measure::{Clock, Error, Measured, View};
use super::plan::{Amounts, Judged};
use super::targets::{TARGETS, Target};
use super::variants::{self, AUTO, BASELINE, PATH, SHARED, Variant};
use crate::experiment::analysis::Section;
use crate::results::{Cell, Record, Results, Table, Verdict};
use crate::statistics::Interval;

/// Estimators, ideas, findings.
pub fn sections(results: &Results, amounts: &Amounts) -> Vec<Section> {
    let judged = amounts.judged;
    let views = [View::EqualTime, View::EqualRays];
    let mut all = vec![section(
        "Estimators",
        views.map(|view| estimators(results, judged, view)).into(),
    )];
    for idea in variants::ideas() {
        let views = [
            (View::EqualRays, Error::Pixels),
            (View::TimeOfRays, Error::Pixels),
            (View::EqualRays, Error::Blocks),
        ];
        let tables = views.map(|(view, error)| of_idea(results, judged, idea, view, error));
        all.push(section(idea, tables.into()));
    }
    all.push(section(
        "Findings",
        vec![targets(results, amounts), auto(results, amounts)],
    ));
    all
}

fn section(title: &str, tables: Vec<Table>) -> Section {
    Section {
        title: title.to_owned(),
        tables,
        plots: Vec::new(),
    }
}

/// Every estimator in every scene.
fn estimators(results: &Results, judged: Judged, view: View) -> Table {
    let columns = [
        "scene",
        "method",
        "samples per pixel",
        "seconds",
        "processor seconds",
        "of training",
        "relMSE · cost ↓",
        "over bdpt all ↑",
        "over path ↑",
        "over bdpt all, trimmed ↑",
        "over path, trimmed ↑",
        "over bdpt all, blocks ↑",
        "over path, blocks ↑",
    ];
    let scenes = results.scenes.iter();
    let rows = scenes.flat_map(|scene| {
        let measured = Measured {
            results,
            scene,
            view,
            clock: Clock::of(results),
            judged,
        };
        let rendered = variants::estimators().filter(move |variant| {
            let is_itself = variant.rendered().name == variant.name;
            is_itself && !measured.records(variant.name).is_empty()
        });
        rendered.map(move |variant| estimator(&measured, variant.name))
    });
    Table {
        caption: format!(
            "Estimators {}: means over seeds; geometric means of relMSE · cost, in {}, and gains, with \
             95 % intervals. Trimmed is without the worst 0.1 % of pixels; training is weighed as in a \
             whole run.",
            view.words(),
            view.unit(Clock::of(results))
        ),
        columns: columns.map(str::to_owned).into(),
        rows: rows.collect(),
    }
}

fn estimator(measured: &Measured<'_>, method: &str) -> Vec<Cell> {
    let records = measured.records(method);
    let mean = |value: fn(&Record) -> f64| {
        let sum: f64 = records.iter().map(|record| value(record)).sum();
        number(Some(sum / records.len() as f64))
    };
    let gain = |over, error| {
        // Of itself it is 1, whatever was measured.
        if method == over {
            return Cell::Number(1.0);
        }
        interval(measured.gain([method, over], error, CONFIDENCE))
    };
    vec![
        text(&measured.scene.name),
        text(method),
        mean(|record| record.spp as f64),
        mean(|record| record.seconds),
        mean(|record| record.processor_seconds.unwrap_or(f64::NAN)),
        mean(|record| record.training_processor_seconds.unwrap_or(f64::NAN)),
        number(measured.mean(method, Error::Pixels)),
        gain(BASELINE, Error::Pixels),
        gain(PATH, Error::Pixels),
        gain(BASELINE, Error::Trimmed),
        gain(PATH, Error::Trimmed),
        gain(BASELINE, Error::Blocks),
        gain(PATH, Error::Blocks),
    ]
}

/// What the variants of an idea gain over what they are variants of.
fn of_idea(results: &Results, judged: Judged, idea: &str, view: View, error: Error) -> Table {
    let scenes = || results.scenes.iter().map(|scene| &*scene.name);
    let row = |(variant, of): (&Variant, &str)| {
        let rendered = variant.rendered().name;
        let gain = |scene| {
            if rendered == of {
                return Cell::Number(1.0);
            }
            interval(Gains::new(results, judged, scene, view).of([rendered, of], error))
        };
        let words = [variant.name, of].map(text);
        words.into_iter().chain(scenes().map(gain)).collect()
    };
    let by = match error {
        Error::Pixels => "",
        Error::Trimmed => ", without the worst 0.1 % of pixels",
        Error::Blocks => ", of means over blocks",
    };
    let heads = ["variant", "over"].into_iter().chain(scenes());
    Table {
        caption: format!("{idea}: gains {}{by}, with 95 % intervals.", view.words()),
        columns: heads.map(str::to_owned).collect(),
        rows: variants::of_idea(idea).map(row).collect(),
    }
}

/// All targets, and whether they are met.
fn targets(results: &Results, amounts: &Amounts) -> Table {
    let row = |target: &Target| {
        let gains = Gains::new(results, amounts.judged, target.scene, target.view);
        let gain = |method, error| interval(gains.of([method, target.over], error));
        vec![
            text(verdict(judged(results, amounts, target))),
            text(target.scene),
            text(target.view.words()),
            text(target.over),
            Cell::Number(target.gain),
            gain(AUTO, Error::Pixels),
            gain(AUTO, Error::Blocks),
            gain(SHARED, Error::Pixels),
            gain(SHARED, Error::Blocks),
        ]
    };
    let columns = [
        "verdict",
        "scene",
        "cost",
        "over",
        "target",
        "auto",
        "auto, blocks",
        "lvc",
        "lvc, blocks",
    ];
    Table {
        caption: "Targets: gains, the goals and the results, with 95 % intervals. auto is \
                  judged, by pixels."
            .to_owned(),
        columns: columns.map(str::to_owned).into(),
        rows: TARGETS.iter().map(row).collect(),
    }
}

/// `auto` against the better of two, in every scene.
fn auto(results: &Results, amounts: &Amounts) -> Table {
    let row = |scene: &str| {
        let (gains, found) = judged_auto(results, amounts, scene);
        let measured = Gains::new(results, amounts.judged, scene, View::EqualTime);
        let blocks = [PATH, BASELINE].map(|over| measured.of([AUTO, over], Error::Blocks));
        let words = [verdict(found), scene].map(text);
        let gains = gains.into_iter().chain(blocks).map(interval);
        words.into_iter().chain(gains).collect()
    };
    let columns = [
        "verdict",
        "scene",
        "over path",
        "over bdpt all",
        "over path, blocks",
        "over bdpt all, blocks",
    ];
    Table {
        caption: "auto in equal time: met where it is at most 10 % behind both, which are 97.5 % \
                  intervals by pixels, so that both hold together with 95 %."
            .to_owned(),
        columns: columns.map(str::to_owned).into(),
        rows: super::scene_names().map(row).into(),
    }
}

fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Met | Verdict::Reproduced => "met",
        Verdict::NotMet | Verdict::NotReproduced => "not met",
        Verdict::Undecided => "undecided",
        Verdict::NotMeasured => "not measured",
    }
}

fn text(words: &str) -> Cell {
    Cell::Text(words.to_owned())
}

/// A number that is known, and JSON has.
fn number(value: Option<f64>) -> Cell {
    match value.filter(|value| value.is_finite()) {
        Some(value) => Cell::Number(value),
        None => text("–"),
    }
}

fn interval(interval: Option<Interval>) -> Cell {
    match interval {
        Some(Interval { value, low, high }) => Cell::Interval { value, low, high },
        None => text("–"),
    }
}

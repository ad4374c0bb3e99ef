//! Findings on made-up records.

use super::*;
use crate::beyond::tests::{check_shape, setup};
use crate::beyond::{sections, variants};
use crate::parts;
use crate::results::{BudgetInfo, BudgetKind, MethodInfo, Rays, Record, SceneInfo};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Ten seeds of a scene: each method with relMSE · cost, times 1 ± `spread`, by pixels; by blocks it is
/// the inverse. The clock of the wall tells nonsense.
fn records(scene: &str, methods: &[(&str, f64)], spread: f64) -> Vec<Record> {
    let kinds = ["time", "rays"];
    let cells = kinds.into_iter().flat_map(|budget| {
        let seeds = move |&(method, product): &(&'static str, f64)| {
            (0..10).map(move |seed| (budget, method, product, seed))
        };
        known(methods)
            .into_iter()
            .flat_map(move |method| seeds(&method).collect::<Vec<_>>())
    });
    cells
        .map(|(budget, method, product, seed)| {
            let phase = (seed * 7 + method.len() as u64) % 11;
            let product = product * (1.0 + spread * (phase as f64 / 5.0 - 1.0));
            let cost = 1000 * (1 + seed);
            let errors = [("relmse", product), ("relmse_block", 1.0 / product)];
            let errors = errors.map(|(name, value)| (name.to_owned(), value / cost as f64));
            Record {
                scene: scene.to_owned(),
                method: method.to_owned(),
                budget: budget.to_owned(),
                seed,
                spp: 4,
                seconds: (1.0 + seed as f64).powi(method.len() as i32),
                processor_seconds: Some(cost as f64),
                rays: Rays {
                    camera: cost / 2,
                    training: cost / 2,
                    ..Rays::default()
                },
                connections_blocked: 0,
                metrics: BTreeMap::from(errors),
                efficiency_rays: 0.0,
                efficiency_seconds: 0.0,
                image: None,
            }
        })
        .collect()
}

/// The same methods under names that live as long as the program.
fn known(methods: &[(&str, f64)]) -> Vec<(&'static str, f64)> {
    let all = [BASELINE, PATH, SHARED, AUTO];
    let find = |name: &str| all.into_iter().find(|known| *known == name).unwrap();
    methods
        .iter()
        .map(|(name, product)| (find(name), *product))
        .collect()
}

fn results(scene: &str, records: Vec<Record>) -> Results {
    let setup = setup(Path::new(""));
    let budget = |name: &str, kind| BudgetInfo {
        name: name.to_owned(),
        kind,
        amount: 1.0,
    };
    Results {
        scenes: vec![SceneInfo {
            name: scene.to_owned(),
            file: String::new(),
            digest: String::new(),
            size: [8, 6],
            reference: String::new(),
            reference_image: None,
            reference_mse: None,
        }],
        methods: [BASELINE, PATH, SHARED, AUTO]
            .map(|name| MethodInfo {
                name: name.to_owned(),
                settings: BTreeMap::new(),
            })
            .into(),
        budgets: vec![
            budget("time", BudgetKind::Seconds),
            budget("rays", BudgetKind::Rays),
        ],
        records,
        ..parts::empty("", "", &setup)
    }
}

/// The verdicts on the targets of the apartment, where bidirectional path tracing costs 100 and path
/// tracing 50: 8 in equal time, 1.8 over path, 20 at equal rays.
#[track_caller]
fn check_targets(auto: f64, spread: f64, expected: [Verdict; 3]) {
    let methods = [
        (BASELINE, 100.0),
        (PATH, 50.0),
        (SHARED, 10.0),
        (AUTO, auto),
    ];
    let results = results("apartment", records("apartment", &methods, spread));
    let targets = TARGETS.iter().filter(|target| target.scene == "apartment");
    let verdicts: Vec<_> = targets.map(|target| judged(&results, target).1).collect();
    assert_eq!(verdicts, expected);
}

#[test]
fn targets_are_met_or_not_by_their_intervals() {
    use Verdict::{Met, NotMet, Undecided};
    check_targets(4.0, 0.01, [Met, Met, Met]);
    check_targets(10.0, 0.01, [Met, Met, NotMet]);
    check_targets(20.0, 0.01, [NotMet, Met, NotMet]);
    check_targets(40.0, 0.01, [NotMet, NotMet, NotMet]);
    // 8.3 with an interval that holds 8.
    check_targets(12.0, 0.5, [Undecided, Met, NotMet]);
}

#[test]
fn gains_are_those_of_processors_and_of_all_rays() {
    let methods = [(BASELINE, 100.0), (PATH, 50.0), (AUTO, 10.0)];
    let mut results = results("apartment", records("apartment", &methods, 0.0));
    let gain = |results: &Results, view, error| {
        let measured = measured(results, "apartment", view);
        measured.gain([AUTO, BASELINE], error, 0.95).unwrap().value
    };
    for view in [View::EqualTime, View::EqualRays, View::TimeOfRays] {
        assert!((gain(&results, view, Error::Pixels) - 10.0).abs() < 1e-9);
        assert!((gain(&results, view, Error::Blocks) - 0.1).abs() < 1e-9);
    }
    // Without the clock of the processors that of the wall has to do.
    results.records[3].processor_seconds = None;
    assert!((gain(&results, View::EqualTime, Error::Pixels) - 10.0).abs() > 0.1);
    assert!((gain(&results, View::EqualRays, Error::Pixels) - 10.0).abs() < 1e-9);
    let claims = claims(&results, &Amounts::quick());
    assert!(
        claims[0].method.contains("seconds of the clock"),
        "{:?}",
        claims[0]
    );
}

#[track_caller]
fn check_auto(auto: f64, expected: Verdict) {
    let methods = [(BASELINE, 100.0), (PATH, 50.0), (AUTO, auto)];
    let results = results("coffee", records("coffee", &methods, 0.01));
    assert_eq!(judged_auto(&results, "coffee").1, expected);
}

#[test]
fn auto_may_be_a_tenth_behind_the_better_of_both() {
    check_auto(20.0, Verdict::Met);
    check_auto(53.0, Verdict::Met);
    check_auto(55.0, Verdict::Undecided);
    check_auto(58.0, Verdict::NotMet);
    check_auto(200.0, Verdict::NotMet);
}

#[test]
fn what_was_not_rendered_is_not_measured() {
    let mut results = results(
        "coffee",
        records("coffee", &[(AUTO, 1.0), (PATH, 1.0)], 0.0),
    );
    let claims = claims(&results, &Amounts::quick());
    assert_eq!(claims.len(), TARGETS.len() + SCENES.len());
    let verdicts = claims.iter().map(|claim| claim.verdict);
    assert!(verdicts.eq([Verdict::NotMeasured; TARGETS.len() + SCENES.len()]));
    assert!(
        claims[0].found.contains("not measured"),
        "{}",
        claims[0].found
    );
    let ids: BTreeSet<_> = claims.iter().map(|claim| &claim.id).collect();
    assert_eq!(ids.len(), claims.len());
    results.records.clear();
    results.budgets.clear();
    for table in sections(&results)
        .iter()
        .flat_map(|section| &section.tables)
    {
        check_shape(table);
    }
}

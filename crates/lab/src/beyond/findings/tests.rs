//! Findings on made-up records.

use super::*;
use crate::beyond::sections;
use crate::beyond::tests::{check_shape, setup};
use crate::parts;
use crate::results::{BudgetInfo, BudgetKind, MethodInfo, Rays, Record, SceneInfo};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Ten seeds of a scene: each method with relMSE · cost, times 1 ± `spread`, by pixels; by blocks it is
/// the inverse. The clock of the wall tells nonsense.
fn records(scene: &str, methods: &[(&str, f64)], spread: f64) -> Vec<Record> {
    let mut records = Vec::new();
    for budget in ["time", "rays"] {
        for (method, product) in methods {
            for seed in 0..10 {
                let phase = (seed * 7 + method.len() as u64) % 11;
                let product = product * (1.0 + spread * (phase as f64 / 5.0 - 1.0));
                records.push(record([scene, method, budget], product, seed));
            }
        }
    }
    records
}

fn record([scene, method, budget]: [&str; 3], product: f64, seed: u64) -> Record {
    let cost = 1000 * (1 + seed);
    let errors = [
        ("relmse", product),
        ("relmse_trim", libm::sqrt(product)),
        ("relmse_block", 1.0 / product),
    ];
    let errors = errors.map(|(name, value)| (name.to_owned(), value / cost as f64));
    Record {
        scene: scene.to_owned(),
        method: method.to_owned(),
        budget: budget.to_owned(),
        seed,
        spp: 4,
        seconds: (1 + seed * method.len() as u64) as f64,
        processor_seconds: Some(cost as f64),
        training_seconds: Some(0.0),
        training_processor_seconds: Some(0.0),
        rays: Rays {
            camera: cost / 2,
            light: cost / 2,
            ..Rays::default()
        },
        connections_blocked: 0,
        metrics: BTreeMap::from(errors),
        efficiency_rays: 0.0,
        efficiency_seconds: 0.0,
        image: None,
    }
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
    let verdicts: Vec<_> = targets
        .map(|target| judged(&results, &Amounts::full(), target))
        .collect();
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
        let gains = Gains::new(results, Amounts::full().judged, "apartment", view);
        gains.of([AUTO, BASELINE], error).unwrap().value
    };
    for view in [View::EqualTime, View::EqualRays, View::TimeOfRays] {
        assert!((gain(&results, view, Error::Pixels) - 10.0).abs() < 1e-9);
        assert!((gain(&results, view, Error::Trimmed) - libm::sqrt(10.0)).abs() < 1e-9);
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

/// Half of a render of cost 2000 was training. Under 10 000 that would be a tenth, and the error what
/// 9000 give.
#[test]
fn training_is_weighed_as_in_the_budget_that_is_judged() {
    let methods = [(BASELINE, 100.0), (AUTO, 100.0)];
    let mut records = records("apartment", &methods, 0.0);
    records.retain(|record| record.seed < 3);
    for record in &mut records {
        if record.method == AUTO {
            let cost = 1000.0 * (1 + record.seed) as f64;
            record.processor_seconds = Some(2.0 * cost);
            record.training_processor_seconds = Some(cost);
            record.rays.training = 1000 * (1 + record.seed);
        }
    }
    let results = results("apartment", records);
    let gain = |judged, view| {
        let gains = Gains::new(&results, judged, "apartment", view);
        gains.of([AUTO, BASELINE], Error::Pixels).unwrap().value
    };
    let expected = [1000.0, 2000.0, 3000.0].map(|training| (10_000.0 - training) / 10_000.0);
    let expected = libm::cbrt(expected.iter().product::<f64>());
    let judged = Judged {
        seconds: 10_000.0,
        rays: 10_000.0 / 48.0,
    };
    for view in [View::EqualTime, View::EqualRays] {
        let gain = gain(judged, view);
        assert!(
            (gain - expected).abs() < 1e-9,
            "{view:?}: {gain} {expected}"
        );
    }
    // A budget that was overrun is what was rendered.
    let overrun = Judged {
        seconds: 1.0,
        rays: 1.0,
    };
    assert!((gain(overrun, View::EqualTime) - 0.5).abs() < 1e-9);
}

#[track_caller]
fn check_auto(auto: f64, expected: Verdict) {
    let methods = [(BASELINE, 100.0), (PATH, 50.0), (AUTO, auto)];
    let results = results("coffee", records("coffee", &methods, 0.01));
    assert_eq!(
        judged_auto(&results, &Amounts::full(), "coffee").1,
        expected
    );
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
        claims[0].found.starts_with("Not measured"),
        "{}",
        claims[0].found
    );
    let ids: BTreeSet<_> = claims.iter().map(|claim| &claim.id).collect();
    assert_eq!(ids.len(), claims.len());
    results.records.clear();
    results.budgets.clear();
    for table in sections(&results, &Amounts::quick())
        .iter()
        .flat_map(|section| &section.tables)
    {
        check_shape(table);
    }
}

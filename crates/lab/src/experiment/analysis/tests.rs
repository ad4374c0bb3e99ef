use super::*;
use crate::experiment::Experiment;
use crate::results::{BudgetKind, MethodInfo, Rays};
use crate::statistics::Interval;
use std::collections::BTreeMap;
use std::path::Path;

/// Makes the sections of results under a description without tables.
fn sections(results: &Results) -> Vec<Section> {
    let text = "[[scene]]\nfile = \"room.pbrt\"\nreference-spp = 1\n\
                [[method]]\nname = \"first\"\n[[budget]]\nsamples = 64\n";
    let experiment = Experiment::read(text, Path::new("a.toml")).unwrap();
    experiment.sections(results)
}

/// Makes a record of a method whose error is scaled by `factor`; all but `first` take twice the rays.
fn record(method: &str, factor: f64, budget: f64, seed: u64) -> Record {
    // Large differences between seeds, which all methods share.
    let error = factor * [1.0, 4.0, 0.5][seed as usize] / budget;
    Record {
        scene: "room".into(),
        method: method.into(),
        budget: format!("{budget} spp"),
        seed,
        spp: budget as u64,
        seconds: 2.0,
        rays: Rays {
            camera: if method == "first" { 500 } else { 1000 },
            ..Rays::default()
        },
        metrics: BTreeMap::from([("rmse".to_owned(), error)]),
        efficiency_rays: 1.0 / (error * error * if method == "first" { 500.0 } else { 1000.0 }),
        efficiency_seconds: 1.0 / (error * error * 2.0),
        ..Record::default()
    }
}

fn results(seeds: u64) -> Results {
    let method = |name: &str| MethodInfo {
        name: name.into(),
        settings: BTreeMap::new(),
    };
    let budget = |amount: f64| BudgetInfo {
        name: format!("{amount} spp"),
        kind: BudgetKind::Samples,
        amount,
    };
    let cells = (0..seeds).flat_map(|seed| {
        [64.0, 16.0].into_iter().flat_map(move |budget| {
            let methods = [("first", 1.0), ("second", 0.5)];
            methods.map(|(method, factor)| record(method, factor, budget, seed))
        })
    });
    Results {
        scenes: vec![SceneInfo {
            name: "room".into(),
            size: [5, 10],
            ..SceneInfo::default()
        }],
        methods: vec![method("first"), method("second"), method("not run")],
        budgets: vec![budget(64.0), budget(16.0)],
        records: cells.collect(),
        ..Results::default()
    }
}

#[track_caller]
fn check_interval(cell: &Cell, expected: f64) {
    let Cell::Interval(Interval { value, low, high }) = cell else {
        panic!("{cell:?}");
    };
    for number in [value, low, high] {
        assert!((number - expected).abs() < 1e-9, "{cell:?}");
    }
}

#[test]
fn ratios_are_paired_by_seed() {
    let sections = sections(&results(3));
    let [means, ratios, ..] = &sections[0].tables[..] else {
        panic!("{sections:?}");
    };
    assert_eq!((sections.len(), sections[0].tables.len()), (1, 4));
    let heads = [
        "method",
        "samples per pixel",
        "rays per pixel",
        "seconds",
        "rmse",
    ];
    assert_eq!(means.columns, heads);
    assert_eq!(means.rows.len(), 2);
    assert_eq!(means.rows[1][2], Cell::Number(20.0));
    let Cell::Interval(Interval { value, low, high }) = means.rows[0][4] else {
        panic!("{means:?}");
    };
    assert!((value - 5.5 / 3.0 / 64.0).abs() < 1e-12 && low < 0.0 && high > 0.05);
    // However different the seeds, the ratio is the same under each.
    let [row] = &ratios.rows[..] else {
        panic!("{ratios:?}");
    };
    assert_eq!(row[0], Cell::Text("second".into()));
    check_interval(&row[1], 0.5);
    check_interval(&row[2], 2.0);
    check_interval(&row[3], 4.0);
}

#[test]
fn seeds_that_one_method_lacks_are_left_out() {
    let mut results = results(3);
    results
        .records
        .retain(|record| record.seed != 1 || record.method == "first");
    let sections = sections(&results);
    check_interval(&sections[0].tables[1].rows[0][1], 0.5);
}

#[test]
fn one_seed_gives_numbers_without_intervals() {
    let sections = sections(&results(1));
    let tables = &sections[0].tables;
    assert!(matches!(tables[0].rows[0][4], Cell::Number(_)));
    assert_eq!(tables[1].rows[0][1], Cell::Number(0.5));
    assert!(sections[0].plots[0].series[0].intervals.is_empty());
}

#[test]
fn curves_go_over_all_budgets_of_a_kind() {
    let sections = sections(&results(3));
    let [plot] = &sections[0].plots[..] else {
        panic!("{sections:?}");
    };
    assert_eq!(plot.series.len(), 2);
    let curve = &plot.series[1];
    assert!((curve.points[0][0] - 16.0).abs() < 1e-12);
    assert!((curve.points[1][0] - 64.0).abs() < 1e-12);
    assert!((curve.points[0][1] / curve.points[1][1] - 4.0).abs() < 1e-9);
    assert_eq!(curve.intervals.len(), 2);
    assert!(
        curve
            .intervals
            .iter()
            .all(|[low, high]| *low > 0.0 && high > low)
    );
}

#[test]
fn noise_of_the_reference_is_a_part_of_the_smallest_error() {
    let mut results = results(3);
    assert_eq!(reference_noise(&results).count(), 0);
    // Of the second method with 64 samples: 0.5 · [1, 4, 0.5] / 64.
    let least = 0.25 * (1.0 + 16.0 + 0.25) / 3.0 / (64.0 * 64.0);
    for (part, share, is_large) in [(0.05, 0.05, false), (0.2, 0.2, true), (3.0, 1.0, true)] {
        results.scenes[0].reference_mse = Some(part * least);
        let noise = reference_noise(&results).next().unwrap();
        assert_eq!((noise.method, noise.budget), ("second", "64 spp"));
        assert!((noise.share - share).abs() < 1e-12, "{noise:?}");
        assert_eq!(noise.is_large(), is_large);
    }
    assert!(
        reference_noise(&results)
            .next()
            .unwrap()
            .warning()
            .contains("100 % noise")
    );
    results.records.clear();
    assert_eq!(reference_noise(&results).count(), 0);
}

#[test]
fn results_without_records_have_no_sections() {
    assert_eq!(sections(&results(0)), []);
}

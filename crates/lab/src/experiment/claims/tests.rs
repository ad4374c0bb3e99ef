//! Claims and tables of artificial records.

use super::*;
use crate::experiment::{BUILTIN, ExperimentError, SceneSource, SceneSpec};
use crate::results::{
    BudgetInfo, Cell, Contributions, Rays, Record, Results, SceneInfo, Table, Verdict,
};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

const HEAD: &str = r#"
[[scene]]
for.name = ["A", "B"]
name = "{name}"
file = "{name}.pbrt"
reference-spp = 1
[[method]]
for.rule = ["all", "one", "two"]
name = "{rule}"
[[budget]]
seconds = 1
[[budget]]
rays = 100
"#;

fn read(claims: &str) -> Result<Experiment, ExperimentError> {
    Experiment::read(&[HEAD, claims].concat(), Path::new("a.toml"))
}

/// Makes records of ten seeds of a method under both budgets, with relMSE · cost = `product` (1 ± `spread`).
/// RMS errors are roots of the relMSE; block errors use 1 / `product`. Wall times are arbitrary.
fn records(scene: &str, method: &str, product: f64, spread: f64) -> Vec<Record> {
    let record = |budget: &str, seed: u64| {
        let phase = (seed * 7 + method.bytes().map(u64::from).sum::<u64>()) % 11;
        let product = product * (1.0 + spread * (phase as f64 / 5.0 - 1.0));
        let cost = 1000 * (1 + seed);
        let error = product / cost as f64;
        let metrics = [
            ("rmse", error.sqrt()),
            ("relmse", error),
            ("relmse_block", 1.0 / product / cost as f64),
        ];
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
            metrics: metrics.map(|(name, value)| (name.to_owned(), value)).into(),
            ..Record::default()
        }
    };
    let budgets = ["1 s", "100 rays per pixel"];
    let records = budgets.iter();
    records
        .flat_map(|budget| (0..10).map(|seed| record(budget, seed)))
        .collect()
}

fn results(records: Vec<Record>) -> Results {
    let scene = |name: &str| SceneInfo {
        name: name.to_owned(),
        size: [8, 6],
        ..SceneInfo::default()
    };
    let budget = |name: &str, kind| BudgetInfo {
        name: name.to_owned(),
        kind,
        amount: 1.0,
    };
    Results {
        scenes: ["A", "B"].map(scene).into(),
        budgets: vec![
            budget("1 s", BudgetKind::Seconds),
            budget("100 rays per pixel", BudgetKind::Rays),
        ],
        records,
        ..Results::default()
    }
}

/// Writes the claim that `one` has less error than `all` in scene A, with `more` keys.
fn claim(more: &str) -> String {
    format!(
        "[[claim]]\nid = \"it\"\nclaim = \"It is so.\"\nscene = \"A\"\nmethod = \"one\"\n{more}\n"
    )
}

#[track_caller]
fn check(one: f64, spread: f64, more: &str, expected: Verdict) {
    let all = [
        records("A", "all", 100.0, spread),
        records("A", "one", one, spread),
    ];
    let found = read(&claim(more)).unwrap().judge(&results(all.concat()));
    assert_eq!(found[0].verdict, expected, "{}", found[0].found);
}

#[test]
fn intervals_inside_outside_and_across_a_border_decide() {
    use Verdict::{Met, NotMet, NotReproduced, Reproduced, Undecided};
    let less = "measure = \"relmse at equal rays\"\nover = \"all\"\nbelow = 1";
    check(90.0, 0.01, less, Reproduced);
    check(110.0, 0.01, less, NotReproduced);
    check(98.0, 0.5, less, Undecided);
    let within = "measure = \"relmse in equal time\"\nover = \"all\"\nabove = 0.8\nbelow = 0.95";
    check(90.0, 0.01, within, Reproduced);
    check(70.0, 0.01, within, NotReproduced);
    let goal = "measure = \"relmse at equal rays\"\ngain-over = \"all\"\nabove = 8\ngoal = true";
    check(10.0, 0.01, goal, Met);
    check(20.0, 0.01, goal, NotMet);
    check(12.0, 0.5, goal, Undecided);
}

#[test]
fn a_failed_part_decides_a_claim_and_a_missing_part_leaves_it_open() {
    let parts = "each.rule = [\"one\", \"two\"]\nmeasure = \"rmse\"\nover = \"all\"\nbelow = 1";
    let text = claim(parts).replace("method = \"one\"", "method = \"{rule}\"");
    let experiment = read(&text).unwrap();
    let judged = |two: Option<f64>| {
        let mut all = [
            records("A", "all", 100.0, 0.01),
            records("A", "one", 80.0, 0.01),
        ]
        .concat();
        all.extend(
            two.into_iter()
                .flat_map(|two| records("A", "two", two, 0.01)),
        );
        experiment.judge(&results(all))[0].verdict
    };
    assert_eq!(judged(Some(70.0)), Verdict::Reproduced);
    assert_eq!(judged(Some(120.0)), Verdict::NotReproduced);
    assert_eq!(judged(None), Verdict::NotMeasured);
}

fn value(findings: &Findings<'_>, measure: &str, budget: BudgetKind) -> f64 {
    let quantity = Quantity {
        measure: measure.parse().unwrap(),
        budget: BudgetChoice::Kind(budget),
        scene: "A".to_owned(),
        method: "all".to_owned(),
        over: Over::Method("one".to_owned()),
        than: None,
    };
    findings.interval(&quantity, 0.95).unwrap().value
}

#[test]
fn metrics_of_claims_are_computed() {
    let mape = read(&claim("measure = \"mape in equal time\"\nbelow = 1")).unwrap();
    assert!(mape.metrics.contains(&Metric::Mape));
    assert!(!read("").unwrap().metrics.contains(&Metric::Mape));
}

#[test]
fn errors_are_compared_at_equal_cost() {
    let experiment = read("").unwrap();
    let all = [
        records("A", "all", 100.0, 0.0),
        records("A", "one", 10.0, 0.0),
    ]
    .concat();
    let mut results = results(all);
    let kinds = [BudgetKind::Seconds, BudgetKind::Rays];
    for kind in kinds {
        let findings = Findings::new(&experiment, &results);
        let value = |measure| value(&findings, measure, kind);
        assert!((value("relmse at equal rays") - 10.0).abs() < 1e-9);
        assert!((value("relmse in equal time") - 10.0).abs() < 1e-9);
        assert!((value("rmse at equal rays") - libm::sqrt(10.0)).abs() < 1e-9);
        assert!((value("relmse_block in equal time") - 0.1).abs() < 1e-9);
    }
    // Seeds have different costs, so that only pairs of one seed give this ratio.
    results
        .records
        .retain(|record| record.method == "all" || record.seed != 3);
    results.records.reverse();
    let findings = Findings::new(&experiment, &results);
    assert!((value(&findings, "relmse", BudgetKind::Rays) - 10.0).abs() < 1e-9);
    // Without processor times, wall times are used.
    results.records[3].processor_seconds = None;
    let findings = Findings::new(&experiment, &results);
    assert!((value(&findings, "relmse at equal rays", BudgetKind::Rays) - 10.0).abs() < 1e-9);
    assert!((value(&findings, "relmse in equal time", BudgetKind::Rays) - 10.0).abs() < 1e-9);
    let wall = |record: &Record| record.seconds > 0.0;
    assert!(results.records.iter().all(wall));
}

/// Training is half of a render of cost c, but only c / 2B of the full budget B.
#[test]
fn training_costs_its_share_of_the_full_budget() {
    let mut experiment = read("").unwrap();
    let mut all = [
        records("A", "all", 100.0, 0.0),
        records("A", "one", 100.0, 0.0),
    ]
    .concat();
    all.retain(|record| record.seed < 3);
    for record in all.iter_mut().filter(|record| record.method == "all") {
        let cost = 1000 * (1 + record.seed);
        record.processor_seconds = Some(2.0 * cost as f64);
        record.training_processor_seconds = Some(cost as f64);
        record.rays.training = cost;
    }
    let mut results = results(all);
    results.machine.threads = 1;
    let shares = [1000.0, 2000.0, 3000.0].map(|training| 10_000.0 / (10_000.0 - training));
    let expected = libm::cbrt(shares.iter().product::<f64>());
    let [time, rays] = &mut experiment.budgets[..] else {
        panic!("two budgets");
    };
    (time.full, rays.full) = (10_000.0, 10_000.0 / 48.0);
    let findings = Findings::new(&experiment, &results);
    let found = value(&findings, "relmse in equal time", BudgetKind::Seconds);
    assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    let found = value(&findings, "relmse at equal rays", BudgetKind::Rays);
    assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    // The cost of the render replaces a budget that it exceeds.
    experiment.budgets[0].full = 1.0;
    let findings = Findings::new(&experiment, &results);
    let found = value(&findings, "relmse in equal time", BudgetKind::Seconds);
    assert!((found - 2.0).abs() < 1e-9, "{found}");
}

#[test]
fn ratios_of_two_scenes_are_compared() {
    let text = claim("measure = \"relmse\"\nover = \"all\"\nthan = \"B\"\nbelow = 1");
    let experiment = read(&text).unwrap();
    let judged = |in_b: f64| {
        let all = [
            records("A", "all", 100.0, 0.01),
            records("A", "one", 70.0, 0.01),
            records("B", "all", 300.0, 0.01),
            records("B", "one", in_b, 0.01),
        ];
        experiment.judge(&results(all.concat()))[0].verdict
    };
    assert_eq!(judged(270.0), Verdict::Reproduced);
    assert_eq!(judged(180.0), Verdict::NotReproduced);
}

/// Makes the only table of a description from these records.
fn table(text: &str, records: Vec<Record>) -> (Table, Vec<crate::results::Plot>) {
    let mut sections = read(text).unwrap().sections(&results(records));
    assert_eq!(sections[0].title, "Mine");
    (
        sections[0].tables.remove(0),
        std::mem::take(&mut sections[0].plots),
    )
}

#[test]
fn a_table_has_its_columns_and_the_rows_that_were_measured() {
    let text = r#"
[[table]]
section = "Mine"
caption = "Errors."
each.rule = [{ rule = "one", n = 1 }, { rule = "two", n = 2 }]
method = "{rule}"
measure = "relmse"
columns = [
    { head = "n", value = "{n}" },
    { head = "samples", measure = "samples per pixel", scene = "A" },
    { for.scene = ["A", "B"], head = "in {scene}", scene = "{scene}", over = "all" },
]
plot = { x = "n", curves = ["in A"], label = "error", log = "y" }
"#;
    let all = [
        records("A", "all", 100.0, 0.01),
        records("A", "one", 50.0, 0.01),
    ]
    .concat();
    let (table, plots) = table(text, all);
    assert_eq!(table.columns, ["n", "samples", "in A", "in B"]);
    let [row] = &table.rows[..] else {
        panic!("`two` was not rendered: {table:?}");
    };
    assert_eq!(row[..2], [Cell::Number(1.0), Cell::Number(4.0)]);
    assert!(matches!(row[2], Cell::Interval(found) if (found.value - 0.5).abs() < 0.01));
    assert_eq!(row[3], Cell::Text("–".to_owned()));
    let series = &plots[0].series[0];
    assert_eq!((series.points.len(), series.intervals.len()), (1, 1));
    assert_eq!(
        (plots[0].x.scale, plots[0].y.scale),
        (Scale::Linear, Scale::Log)
    );
}

#[test]
fn contributions_are_judged_by_passes() {
    let text = r#"
[[claim]]
id = "figure"
claim = "They range far."
measure = "contributions: orders of magnitude"
scene = "A"
method = "one"
over = 3
above = 1
[[table]]
claim = "figure"
caption = "Contributions."
measure = "contributions: orders of magnitude"
scene = "A"
method = "one"
columns = [{ head = "weights", value = "some" }, { head = "orders" }]
histogram = "log10"
"#;
    let experiment = read(text).unwrap();
    let judged = |orders: [f64; 3]| {
        let name = "contributions: orders of magnitude".to_owned();
        let pass = |orders| BTreeMap::from([(name.clone(), orders)]);
        let mut results = results(Vec::new());
        results.contributions.push(Contributions {
            scene: "A".to_owned(),
            method: "one".to_owned(),
            passes: orders.map(pass).into(),
            weighted: vec![[-1.0, 1.0]],
            unweighted: Vec::new(),
        });
        experiment.judge(&results).remove(0)
    };
    let found = judged([8.0, 8.1, 7.9]);
    assert_eq!(found.verdict, Verdict::Reproduced);
    let series = &found.plots[0].series[0];
    assert_eq!((&*series.name, series.points.len()), ("some", 1));
    assert_eq!(judged([1.0, 1.1, 0.9]).verdict, Verdict::NotReproduced);
    assert_eq!(judged([2.0, 3.1, 4.2]).verdict, Verdict::Undecided);
}

#[test]
fn built_in_descriptions_have_all_claims_and_no_method_twice() {
    let [paper, beyond] = BUILTIN.map(|builtin| builtin.experiment().unwrap());
    assert_eq!((paper.methods.len(), paper.scenes.len()), (27, 17));
    let is_inside = |scene: &SceneSpec| scene.source != SceneSource::Disk;
    assert!(paper.scenes.iter().all(is_inside));
    assert!(!paper.claims.is_empty() && !beyond.claims.is_empty());
    assert_eq!(beyond.scenes.len() + beyond.absent.len(), 9);
    // No two methods are the same.
    let mut settings = BTreeSet::new();
    for method in &beyond.methods {
        let own = method.request.apply(&bidir::driver::Settings::default());
        let own = format!("{:?}", crate::experiment::texts(&own));
        assert!(settings.insert(own), "{} is rendered twice", method.name);
    }
}

use crate::common::{Ran, Workplace};
use serde_json::Value;

/// All estimators and ideas in one scene, of few pixels and passes.
const TINY: &str = "experiment beyond --quick --scenes room-direct,veach-ajar --size 8x6 --seconds 0.02 \
                    --rays 20 --seeds 1 --reference-spp 16 --threads 2";

#[test]
fn beyond_judges_the_existing_scenes_and_continues() {
    let place = Workplace::new();
    place
        .run(&format!("{TINY} -o out"))
        .expect(0)
        .says("scene `veach-ajar` is left out: BIDIR_SCENES is not set")
        .says("wrote out/report.html")
        .prints("Integrators in equal time")
        .prints("Gains of each idea at equal rays")
        .prints("Goals: gains of auto")
        .prints("not measured  in-equal-time-veach-ajar-over-bdpt-all");
    let results: Value = serde_json::from_str(&place.read("out/results.json")).unwrap();
    let records = results["records"].as_array().unwrap();
    for record in records {
        assert!(record["metrics"]["relmse_block"].as_f64().unwrap() > 0.0);
        if cfg!(unix) {
            assert!(
                record["processor_seconds"].as_f64().unwrap() > 0.0,
                "{record}"
            );
        }
    }
    let page = place.read("out/report.html");
    for part in [
        "veach-ajar is left out",
        "not measured",
        "processor seconds",
    ] {
        assert!(page.contains(part), "{part}");
    }
    assert!(page.contains("--scenes room-direct,veach-ajar --size 8x6 --seconds 0.02"));
    // Nothing is rendered twice: records are the same, including times.
    let before = place.read("out/records.ndjson");
    place.run(&format!("{TINY} -o out")).expect(0);
    assert_eq!(place.read("out/records.ndjson"), before);
    place
        .run(&format!(
            "{} -o out",
            TINY.replace("--rays 20", "--rays 21")
        ))
        .expect(5)
        .says("--restart");
    // Nor does any other experiment replace its results.
    let before = place.read("out/results.json");
    place.write("test.toml", OTHER);
    for other in ["paper --quick", "test.toml"] {
        place
            .run(&format!("experiment {other} -o out"))
            .expect(5)
            .says("out: the records are of another experiment")
            .says("--restart");
        assert_eq!(place.read("out/results.json"), before);
    }
}

/// A description that renders next to nothing.
const OTHER: &str = r#"
size = "8x6"
[[scene]]
file = "room.pbrt"
reference-spp = 16
[[method]]
name = "all"
[[budget]]
samples = 1
"#;

#[test]
fn results_of_a_description_are_not_replaced_by_those_of_a_built_in_experiment() {
    let place = Workplace::new();
    place.write("test.toml", OTHER);
    place.run("experiment test.toml -o out").expect(0);
    let names = ["results.json", "report.html", "records.ndjson"];
    let files = || names.map(|name| place.read(&format!("out/{name}")));
    let before = files();
    for other in [TINY, "experiment paper --quick"] {
        place
            .run(&format!("{other} -o out"))
            .expect(5)
            .says("the records are of another experiment");
    }
    assert_eq!(files(), before);
    assert!(!place.path("out/scenes").exists());
}

#[test]
fn flags_replace_the_extent_of_a_description() {
    let place = Workplace::new();
    place.write("test.toml", OTHER);
    place
        .run("experiment test.toml -o out --size 5x4 --seeds 2 --reference-spp 32")
        .expect(0);
    let results: Value = serde_json::from_str(&place.read("out/results.json")).unwrap();
    assert_eq!(results["records"].as_array().unwrap().len(), 2);
    assert_eq!(results["scenes"][0]["size"], serde_json::json!([5, 4]));
    assert!(
        results["scenes"][0]["reference"]
            .as_str()
            .unwrap()
            .contains("32 samples")
    );
}

/// Small: nothing can be concluded, but every claim whose scenes are rendered is judged.
#[test]
fn the_paper_is_judged_claim_by_claim() {
    let place = Workplace::new();
    let mut command = place.command(
        "experiment paper -o out --quick --size 8x6 --seeds 2 --rays 20 --reference-spp 16 --threads 2",
    );
    let scenes = "A,B,apartment,albedo 0.3,albedo 0.5,albedo 0.7,albedo 0.8";
    command.args(["--scenes", scenes]);
    Ran::of(&mut command).expect(0).prints("Verdicts.");
    let results: Value = serde_json::from_str(&place.read("out/results.json")).unwrap();
    let claims = results["claims"].as_array().unwrap();
    let open = claims
        .iter()
        .filter(|claim| claim["verdict"] == "not-measured");
    let open: Vec<_> = open.map(|claim| claim["id"].as_str().unwrap()).collect();
    let expected = [
        "section-4-complexity-direct",
        "section-4-complexity-indirect",
    ];
    assert_eq!(open, expected);
    assert!(claims.len() > open.len());
    let shown = results["pyramids"].as_array().unwrap().iter();
    let shown: Vec<_> = shown
        .map(|found| found["scene"].as_str().unwrap())
        .collect();
    assert_eq!(shown, ["A", "B", "apartment"]);
    assert_eq!(results["contributions"].as_array().unwrap().len(), 6);
}

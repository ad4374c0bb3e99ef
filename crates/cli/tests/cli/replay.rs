use crate::common::Workplace;

#[test]
fn a_sample_is_told_step_by_step() {
    let place = Workplace::new();
    let ran = place.run("render room.pbrt --replay 12,12,1").expect(0);
    let ran = ran
        .prints("pixel 12,12 pass 1")
        .prints("camera subpath")
        .prints("light subpath");
    ran.prints("candidates")
        .prints("chosen with probability")
        .prints("added to the pixel");
    assert!(!place.path("room.exr").exists(), "nothing is rendered");
}

#[test]
fn a_replayed_sample_adds_up() {
    let place = Workplace::new();
    let replay = |pass: u32| {
        let arguments = "--json --shadow-rays per-pair";
        place
            .run(&format!(
                "render room.pbrt --replay 12,12,{pass} {arguments}"
            ))
            .expect(0)
            .json()
    };
    let count = |sample: &serde_json::Value| sample["candidates"].as_array().unwrap().len();
    let sample = (0..20)
        .map(replay)
        .find(|sample| count(sample) > 1)
        .unwrap();
    let candidates = sample["candidates"].as_array().unwrap();
    let chosen = candidates
        .iter()
        .filter(|candidate| candidate["is_chosen"] == true);
    assert_eq!(chosen.count(), 1);
    let red = |value: &serde_json::Value| value[0].as_f64().unwrap();
    let sum: f64 = candidates
        .iter()
        .map(|candidate| red(&candidate["contribution"]))
        .sum();
    assert!((sum - red(&sample["value_of_candidates"])).abs() < 1e-6 * (1.0 + sum));
    let camera = sample["camera"]["vertices"].as_array().unwrap();
    assert_eq!(
        (&camera[0]["kind"], &camera[1]["kind"]),
        (&"camera".into(), &"surface".into())
    );
}

#[test]
fn json_alone_means_nothing() {
    Workplace::new()
        .run("render room.pbrt --json")
        .expect(2)
        .says("--replay");
}

use crate::common::Workplace;
use serde_json::Value;

#[test]
fn a_replay_prints_every_step() {
    let place = Workplace::new();
    let ran = place.run("render room.pbrt --replay 12,12,1").expect(0);
    let ran = ran
        .prints("pixel 12,12 pass 1")
        .prints("integrator bdpt, shadow rays all")
        .prints("camera subpath")
        .prints("light subpath")
        .prints("hits of lights, s = 0");
    ran.prints("candidates for shadow rays, s >= 1 and t >= 2")
        .prints("probability")
        .prints("splats to the light image, t = 1, of one of 384 light subpaths")
        .prints("added to the pixel");
    assert!(!place.path("room.exr").exists(), "nothing is rendered");
}

/// Returns replays of the first passes of a pixel with several connections.
fn replays(arguments: &str) -> Vec<Value> {
    let place = Workplace::new();
    let replay = |pass: u32| {
        let command = format!("render room.pbrt --replay 12,12,{pass} --json {arguments}");
        place.run(&command).expect(0).json()
    };
    (0..12).map(replay).collect()
}

fn list<'a>(value: &'a Value, key: &str) -> &'a [Value] {
    value[key].as_array().unwrap()
}

fn red(value: &Value) -> f64 {
    value[0].as_f64().unwrap()
}

#[track_caller]
fn assert_close(a: f64, b: f64) {
    assert!((a - b).abs() <= 1e-5 * (1.0 + b.abs()), "{a} {b}");
}

#[test]
fn a_replayed_sample_adds_up() {
    for arguments in [
        "--shadow-rays per-pair",
        "--shadow-rays ray-roulette:5",
        "--integrator path",
        "--integrator light",
    ] {
        for sample in replays(arguments) {
            let candidates = list(&sample, "candidates");
            for term in candidates.iter().chain(list(&sample, "hits")) {
                let weighted = red(&term["contribution"]) * term["weight"].as_f64().unwrap();
                assert_close(weighted, red(&term["value"]));
            }
            for candidate in candidates {
                let counts = candidate["is_chosen"] == true && candidate["is_visible"] == true;
                let value = if counts {
                    red(&candidate["value"])
                } else {
                    0.0
                };
                let prob = candidate["prob"].as_f64().unwrap();
                assert_close(red(&candidate["added"]) * prob, value);
            }
            let sum = |terms: &[Value]| terms.iter().map(|term| red(&term["added"])).sum::<f64>();
            let (hits, candidates) = (sum(list(&sample, "hits")), sum(candidates));
            assert_close(hits, red(&sample["value_of_hits"]));
            assert_close(candidates, red(&sample["value_of_candidates"]));
            assert_close(hits + candidates, red(&sample["value"]));
        }
    }
}

#[test]
fn one_per_pair_shows_all_probabilities() {
    let samples = replays("--shadow-rays per-pair");
    let mut several = 0;
    for sample in &samples {
        let candidates = list(sample, "candidates");
        if candidates.is_empty() {
            continue;
        }
        let chosen = candidates.iter().filter(|c| c["is_chosen"] == true);
        assert_eq!(chosen.count(), 1);
        assert_close(
            candidates.iter().map(|c| c["prob"].as_f64().unwrap()).sum(),
            1.0,
        );
        several += usize::from(candidates.len() > 1);
    }
    assert!(several > 0);
    let camera = list(&samples[0]["camera"], "vertices");
    assert_eq!(
        (&camera[0]["kind"], &camera[1]["kind"]),
        (&"camera".into(), &"surface".into())
    );
}

#[test]
fn roulette_shows_the_results_of_training() {
    let samples = replays("--shadow-rays ray-roulette:5");
    for sample in &samples {
        let training = |key: &str| sample["training"][key].as_f64().unwrap();
        assert_close(training("threshold"), 5.0 * training("mean_luminance"));
        for candidate in list(sample, "candidates") {
            let score = candidate["score"].as_f64().unwrap();
            let expected = (score / training("threshold")).min(1.0);
            assert_close(candidate["prob"].as_f64().unwrap(), expected);
        }
    }
    Workplace::new()
        .run("render room.pbrt --replay 12,12,1 --shadow-rays ray-roulette --spp 1000")
        .expect(0)
        .prints("training: 4096 samples");
}

#[test]
fn splats_have_their_pixels() {
    let samples = replays("--integrator light");
    let splats: Vec<_> = samples
        .iter()
        .flat_map(|sample| list(sample, "light_image"))
        .collect();
    assert!(!splats.is_empty());
    for splat in splats {
        let (raster, landed) = (&splat["raster"], &splat["landed"]);
        // The filter is the box of one pixel.
        for axis in 0..2 {
            let pixel = raster[axis].as_f64().unwrap().floor();
            assert!(landed.is_null() || landed[axis].as_f64() == Some(pixel));
        }
        let is_seen = splat["is_visible"] == true && !landed.is_null();
        let expected = if is_seen {
            red(&splat["value"]) / 384.0
        } else {
            0.0
        };
        assert_close(red(&splat["added"]), expected);
    }
}

#[test]
fn a_sample_is_drawn() {
    let place = Workplace::new();
    let command = "render room.pbrt --replay 12,12,1 --svg sample.svg";
    place
        .run(command)
        .expect(0)
        .prints("pixel 12,12 pass 1")
        .says("wrote sample.svg");
    let drawing = place.read("sample.svg");
    for part in [
        "<svg xmlns=",
        "Sample of pixel 12,12 in pass 1",
        "room.pbrt",
        "</svg>\n",
    ] {
        assert!(drawing.contains(part), "{part}");
    }
    let json = place
        .run(&format!("{command} --json --quiet --threads 1"))
        .expect(0);
    assert_eq!(json.json()["pixel"][0], 12);
    assert_eq!(json.stderr, "");
    assert_eq!(
        place.read("sample.svg"),
        drawing,
        "the same sample has the same bytes"
    );
    assert_eq!(place.names(), ["room.pbrt", "sample.svg"]);
}

use crate::common::{Client, Place, SIZE, number};
use serde_json::Value;

fn lane(status: &Value, number: usize) -> &Value {
    &status["lanes"][number]
}

#[test]
fn the_status_describes_the_render() {
    let place = Place::new();
    let status = place.wait_for_passes(2);
    assert_eq!(status["scene"], "room.pbrt");
    assert_eq!(status["state"], "rendering");
    assert_eq!(status["controls"], true);
    assert_eq!(status["film"]["resolution"], serde_json::json!(SIZE));
    assert_eq!(status["film"]["crop"], serde_json::json!([0, 0, 48, 32]));
    assert_eq!(status["camera"]["kind"], "perspective");
    let choices = status["choices"]["integrators"].as_array().unwrap();
    assert!(choices.contains(&"lvc".into()));
    let lane = lane(&status, 0);
    assert_eq!(lane["integrator"], "bdpt");
    assert_eq!(lane["settings"]["shadow-rays"], "all");
    assert_eq!(
        (&lane["target"], &lane["eta"]),
        (&Value::Null, &Value::Null)
    );
    assert!(lane["samplesPerSecond"].as_f64().unwrap() > 0.0);
    assert!(lane["raysPerSample"]["lightImage"].as_f64().unwrap() > 0.0);
    assert!(place.get("/log").text().contains("rendering: bdpt all"));
    place.close();
}

#[test]
fn frames_grow_in_passes_and_all_clients_see_the_same() {
    let place = Place::new();
    let (mut one, mut other) = (place.client(), place.client());
    let first = one.frame(|_| true);
    assert_eq!((first.full, first.crop), (SIZE, [0, 0, 48, 32]));
    assert!(first.values.iter().all(|value| value.is_finite()));
    assert!(first.values.iter().any(|value| *value > 0.0));
    let second = one.frame(|_| true);
    assert!(second.passes > first.passes && second.generation == first.generation);
    // Frames stay what they are when both have the same passes.
    let mut seen = vec![first, second];
    for _ in 0..200 {
        let theirs = other.frame(|_| true);
        if let Some(ours) = seen.iter().find(|frame| frame.passes == theirs.passes) {
            assert_eq!(ours.values, theirs.values);
            place.close();
            return;
        }
        seen.push(one.frame(|_| true));
    }
    panic!("no frame was sent to both");
}

#[test]
fn pause_stops_the_counter_and_resume_goes_on() {
    let place = Place::new();
    let mut client = place.client();
    place.wait_for_passes(1);
    client.send(r#"{"command":"pause"}"#);
    let paused = place.wait("pause", |status| status["state"] == "paused");
    // The last frame is that of the last pass.
    let passes = number(&lane(&paused, 0)["passes"]);
    client.frame(|frame| u64::from(frame.passes) == passes);
    std::thread::sleep(std::time::Duration::from_millis(100));
    assert_eq!(number(&lane(&place.json("/status"), 0)["passes"]), passes);
    client.send(r#"{"command":"resume"}"#);
    let status = place.wait_for_passes(passes + 1);
    assert_eq!(
        lane(&status, 0)["generation"],
        lane(&paused, 0)["generation"]
    );
    place.close();
}

#[test]
fn stop_ends_and_restart_begins_anew() {
    let place = Place::new();
    let mut client = place.client();
    let before = place.wait_for_passes(2);
    client.send(r#"{"command":"stop"}"#);
    place.wait("end", |status| status["state"] == "done");
    client.send(r#"{"command":"resume"}"#);
    let status = place.wait("refusal", |status| !status["message"].is_null());
    assert!(status["message"].as_str().unwrap().contains("restart"));
    assert_eq!(place.get("/render.png").code, 200);
    client.send(r#"{"command":"restart"}"#);
    let status = place.wait("render", |status| status["state"] == "rendering");
    assert!(number(&lane(&status, 0)["generation"]) > number(&lane(&before, 0)["generation"]));
    assert_eq!(status["message"], Value::Null);
    place.close();
}

#[test]
fn another_method_begins_anew() {
    let place = Place::new();
    let mut client = place.client();
    let old = client.frame(|_| true);
    client.send(r#"{"command":"method","lane":"a","integrator":"path","shadowRays":"budget:3"}"#);
    let new = client.frame(|frame| frame.generation > old.generation);
    assert!(new.passes >= 1);
    let status = place.json("/status");
    assert_eq!(lane(&status, 0)["integrator"], "path");
    assert_eq!(lane(&status, 0)["shadowRays"], "budget:3");
    // The roulette is that of the new estimator.
    assert_eq!(lane(&status, 0)["settings"]["path-roulette"], "albedo:1");
    client.send(r#"{"command":"method","lane":"a","integrator":"photons","shadowRays":"all"}"#);
    let status = place.wait("refusal", |status| !status["message"].is_null());
    assert!(status["message"].as_str().unwrap().contains("photons"));
    assert_eq!(lane(&status, 0)["integrator"], "path");
    place.close();
}

#[test]
fn two_lanes_have_equal_time() {
    let place = Place::new();
    let mut client = place.client();
    client.send(r#"{"command":"split","on":true,"integrator":"path","shadowRays":"all"}"#);
    client.frame(|frame| frame.lane == 1);
    let seconds = |status: &Value, number| lane(status, number)["seconds"].as_f64().unwrap_or(0.0);
    let status = place.wait("equal time", |status| {
        let [a, b] = [seconds(status, 0), seconds(status, 1)];
        number(&lane(status, 1)["passes"]) > 20 && (a - b).abs() < 0.1 * (a + b)
    });
    assert_eq!(status["split"], true);
    let names = [0, 1].map(|number| lane(&status, number)["integrator"].clone());
    assert_eq!(names, ["bdpt", "path"]);
    client.send(r#"{"command":"split","on":false}"#);
    let status = place.wait("one lane", |status| status["split"] == false);
    assert_eq!(status["lanes"].as_array().unwrap().len(), 1);
    assert_eq!(place.get("/render.png?lane=b").code, 409);
    place.close();
}

#[test]
fn the_error_falls_along_a_curve() {
    let place = Place::new();
    let mut client = place.client();
    let curve = |status: &Value| lane(status, 0)["curve"].as_array().unwrap().clone();
    let status = loop {
        client.frame(|_| true);
        let status = place.json("/status");
        if curve(&status).len() >= 5 {
            break status;
        }
    };
    let at = |point: &Value, i: usize| point[i].as_f64().unwrap();
    let curve = curve(&status);
    assert!(
        curve
            .windows(2)
            .all(|pair| at(&pair[0], 0) < at(&pair[1], 0))
    );
    assert!(at(&curve[0], 1) > at(&curve[curve.len() - 1], 1));
    place.close();
}

/// Waits until the lanes of this generation are paused.
fn wait_for_pause(client: &mut Client, generation: u64) {
    loop {
        let status = client.status();
        if status["state"] == "paused" && lane(&status, 0)["generation"] == generation {
            return;
        }
    }
}

#[test]
fn a_client_hears_of_changes() {
    let place = Place::new();
    let mut client = place.client();
    client.status();
    client.send(r#"{"command":"pause"}"#);
    wait_for_pause(&mut client, 1);
    // A command that comes before new lanes have begun is for these.
    for generation in 2..20 {
        client.send(r#"{"command":"restart"}"#);
        client.send(r#"{"command":"pause"}"#);
        wait_for_pause(&mut client, generation);
    }
    place.close();
}

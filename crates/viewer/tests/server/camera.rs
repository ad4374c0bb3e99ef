use crate::common::{Place, SIZE, number};
use serde_json::Value;

fn vector(value: &Value) -> [f64; 3] {
    [0, 1, 2].map(|i| value[i].as_f64().unwrap())
}

fn distance(status: &Value) -> f64 {
    let camera = &status["camera"];
    let (origin, target) = (vector(&camera["origin"]), vector(&camera["target"]));
    let square = |i: usize| (origin[i] - target[i]) * (origin[i] - target[i]);
    (square(0) + square(1) + square(2)).sqrt()
}

#[test]
fn a_moved_camera_is_seen_at_low_resolution_and_then_in_full() {
    let place = Place::new();
    let mut client = place.client();
    let still = client.frame(|_| true);
    let before = place.json("/status");
    assert_eq!(before["camera"]["moved"], false);
    client.send(r#"{"command":"orbit","yaw":0.4,"pitch":0.2}"#);
    let small = client.frame(|frame| frame.generation > still.generation);
    assert_eq!((small.full, small.crop), ([12, 8], [0, 0, 12, 8]));
    let full = client.frame(|frame| frame.full == SIZE && frame.generation > small.generation);
    assert_eq!(full.crop, [0, 0, 48, 32]);
    let after = place.json("/status");
    assert_eq!(after["camera"]["moved"], true);
    assert_eq!(
        vector(&after["camera"]["target"]).map(f32_of),
        vector(&before["camera"]["target"]).map(f32_of)
    );
    assert!((distance(&after) - distance(&before)).abs() < 1e-4);
    assert!(vector(&after["camera"]["origin"])[1] > vector(&before["camera"]["origin"])[1]);
    place.close();
}

/// Rounded, as turning rounds.
fn f32_of(number: f64) -> i64 {
    (number * 1e4).round() as i64
}

#[test]
fn home_is_the_same_picture_bit_for_bit() {
    let place = Place::ending(2);
    let mut client = place.client();
    let first = client.frame(|frame| frame.passes == 2);
    for command in [
        r#"{"command":"orbit","yaw":-1,"pitch":5}"#,
        r#"{"command":"dolly","factor":0.5}"#,
        r#"{"command":"pan","right":0.1,"up":-0.1}"#,
        r#"{"command":"walk","forward":0.2,"yaw":0.3}"#,
    ] {
        client.send(command);
    }
    let moved = client.frame(|frame| {
        frame.full == SIZE && frame.passes == 2 && frame.generation > first.generation
    });
    assert_ne!(moved.values, first.values);
    client.send(r#"{"command":"home"}"#);
    let home = client.frame(|frame| frame.generation > moved.generation && frame.passes == 2);
    assert_eq!(home.values, first.values);
    assert_eq!(place.json("/status")["camera"]["moved"], false);
    place.close();
}

#[test]
fn a_camera_that_moves_all_the_time_is_seen_moving() {
    let place = Place::new();
    let mut client = place.client();
    client.frame(|_| true);
    let mut generations = Vec::new();
    for _ in 0..10 {
        for _ in 0..3 {
            client.send(r#"{"command":"orbit","yaw":0.01,"pitch":0}"#);
        }
        let last = generations.last().copied().unwrap_or(0);
        generations.push(client.frame(|frame| frame.generation > last).generation);
    }
    assert!(generations.is_sorted());
    place.close();
}

#[test]
fn moves_that_lead_nowhere_are_refused() {
    let place = Place::new();
    let mut client = place.client();
    place.wait_for_passes(1);
    for command in [
        r#"{"command":"dolly","factor":-1}"#,
        r#"{"command":"dolly","factor":0}"#,
        r#"{"command":"pan","right":1e39,"up":0}"#,
    ] {
        client.send(command);
        let status = place.wait("refusal", |status| !status["message"].is_null());
        assert_eq!(status["camera"]["moved"], false, "{command}");
        client.send(r#"{"command":"resume"}"#);
        place.wait("new message", |status| status["message"].is_null());
    }
    assert!(number(&place.json("/status")["lanes"][0]["generation"]) == 1);
    place.close();
}

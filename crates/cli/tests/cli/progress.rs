use crate::common::Workplace;
use serde_json::Value;

/// Returns the lines that are JSON objects.
fn objects(text: &str) -> Vec<Value> {
    let lines = text.lines().filter(|line| line.starts_with('{'));
    lines
        .map(|line| serde_json::from_str(line).unwrap())
        .collect()
}

#[test]
fn the_last_line_of_progress_is_complete() {
    let place = Workplace::new();
    let progress = |format: &str| place.run(&format!("render room.pbrt {format}")).expect(0);
    for format in ["", "--progress plain", "--progress bar"] {
        progress(format)
            .says("Progress: 100% pass 2 of 2, ")
            .says("wrote room.exr");
    }
    let ran = progress("--spp 4096");
    assert_eq!(ran.stderr.matches("100%").count(), 1, "{}", ran.stderr);
    let ran = progress("--progress ndjson");
    let last = objects(&ran.stderr).pop().unwrap();
    assert_eq!(last["progress"].as_f64(), Some(1.0));
    assert_eq!((&last["pass"], &last["passes"]), (&2.into(), &2.into()));
    assert_eq!(last["left"].as_f64(), Some(0.0));
    assert!(last["seconds"].as_f64().unwrap() > 0.0);
    assert_eq!(last.as_object().unwrap().len(), 5);
}

#[test]
fn quiet_keeps_requested_progress() {
    let place = Workplace::new();
    assert_eq!(place.run("render room.pbrt -q").expect(0).stderr, "");
    let ran = place.run("render room.pbrt -q --progress ndjson").expect(0);
    assert_eq!(ran.stderr.lines().count(), objects(&ran.stderr).len());
    let ran = place.run("render room.pbrt -q --progress openjd").expect(0);
    assert_eq!(ran.stderr, "");
}

#[test]
fn lines_of_progress_come_at_intervals() {
    let place = Workplace::new();
    let arguments = "--spp 1000000000 --time 1.5 --threads 1 --progress ndjson -q";
    let ran = place
        .run(&format!("render room.pbrt {arguments}"))
        .expect(0);
    let lines = objects(&ran.stderr);
    let numbers = |key: &str| -> Vec<f64> {
        lines
            .iter()
            .map(|line| line[key].as_f64().unwrap())
            .collect()
    };
    assert!((2..=4).contains(&lines.len()), "{}", ran.stderr);
    for key in ["progress", "pass", "seconds"] {
        assert!(numbers(key).is_sorted(), "{key}: {}", ran.stderr);
    }
    for (seconds, left) in numbers("seconds").iter().zip(numbers("left")) {
        assert!((seconds + left - 1.5).abs() < 0.3, "{}", ran.stderr);
    }
}

#[cfg(unix)]
#[test]
fn a_stopped_render_is_not_reported_as_complete() {
    use std::io::{BufRead, BufReader, Read};
    use std::process::{Command, Stdio};

    let place = Workplace::new();
    // A tenth of the work is reported after a second.
    let arguments = "--size 500x300 --threads 1 --spp 1000000 --time 10 --progress openjd";
    let mut command = place.command(&format!("render room.pbrt {arguments}"));
    let mut child = command
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut stdout = BufReader::new(child.stdout.take().unwrap());
    let mut output = String::new();
    while !output.contains("openjd_status") {
        assert!(stdout.read_line(&mut output).unwrap() > 0, "{output}");
    }
    let id = child.id().to_string();
    assert!(
        Command::new("kill")
            .args(["-s", "TERM", &id])
            .status()
            .unwrap()
            .success()
    );
    stdout.read_to_string(&mut output).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(143));
    assert!(
        output.contains("openjd_status: stopping; a second signal"),
        "{output}"
    );
    assert!(!output.contains("100.0"), "{output}");
}

use crate::common::Workplace;
use serde_json::Value;

/// The lines that are objects of JSON.
fn objects(text: &str) -> Vec<Value> {
    let lines = text.lines().filter(|line| line.starts_with('{'));
    lines
        .map(|line| serde_json::from_str(line).unwrap())
        .collect()
}

#[test]
fn a_render_ends_with_all_of_it() {
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
    let ran = progress("--progress openjd");
    assert_eq!(
        ran.stdout,
        "openjd_progress: 100.0\nopenjd_status: pass 2 of 2\n"
    );
    assert!(!ran.stderr.contains("Progress"), "{}", ran.stderr);
}

#[test]
fn quiet_leaves_the_progress_that_is_asked_for() {
    let place = Workplace::new();
    assert_eq!(place.run("render room.pbrt -q").expect(0).stderr, "");
    let ran = place.run("render room.pbrt -q --progress ndjson").expect(0);
    assert_eq!(ran.stderr.lines().count(), objects(&ran.stderr).len());
    let ran = place.run("render room.pbrt -q --progress openjd").expect(0);
    assert_eq!(ran.stderr, "");
}

#[test]
fn lines_come_now_and_then() {
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

#[test]
fn a_scheduler_is_told_why_a_render_fails() {
    let place = Workplace::new();
    place.write(
        "bad.pbrt",
        "Camera \"perspective\"\nWorldBegin\nMaterial \"difuse\"\n",
    );
    for (scene, code, fails) in [
        (
            "missing.pbrt",
            4,
            "openjd_fail: cannot open `missing.pbrt`: ",
        ),
        ("bad.pbrt", 3, "openjd_fail: bad.pbrt:3:"),
        (
            "room.pbrt -o room.jpg",
            2,
            "openjd_fail: cannot write `room.jpg`: output images are .exr or .png\n",
        ),
    ] {
        let ran = place
            .run(&format!("render {scene} --progress openjd"))
            .expect(code);
        let ran = ran.says("error: ").prints(fails);
        assert_eq!(ran.stdout.lines().count(), 1, "{}", ran.stdout);
        let ran = place.run(&format!("render {scene}")).expect(code);
        assert_eq!(ran.stdout, "");
    }
    place
        .run("render room.pbrt --progress tractor")
        .expect(2)
        .says("openjd");
}

#[cfg(unix)]
#[test]
fn a_render_that_is_stopped_does_not_say_that_it_is_done() {
    use std::io::{BufRead, BufReader, Read};
    use std::process::{Command, Stdio};

    let place = Workplace::new();
    // A tenth of the time is reported after a second.
    let arguments = "--size 500x300 --threads 1 --spp 1000000 --time 10 --progress openjd";
    let mut command = place.command(&format!("render room.pbrt {arguments}"));
    let mut child = command
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut stdout = BufReader::new(child.stdout.take().unwrap());
    let mut told = String::new();
    while !told.contains("openjd_status") {
        assert!(stdout.read_line(&mut told).unwrap() > 0, "{told}");
    }
    let id = child.id().to_string();
    assert!(
        Command::new("kill")
            .args(["-s", "TERM", &id])
            .status()
            .unwrap()
            .success()
    );
    stdout.read_to_string(&mut told).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(143));
    assert!(
        told.contains("openjd_status: stopping after the running pass"),
        "{told}"
    );
    assert!(!told.contains("100.0"), "{told}");
}

use crate::common::{Ran, SCENE, Workplace};
use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

pub(crate) fn send(signal: &str, child: &Child) {
    let id = child.id().to_string();
    assert!(
        Command::new("kill")
            .args(["-s", signal, &id])
            .status()
            .unwrap()
            .success()
    );
}

/// Renders, and sends each signal after a line with its words.
fn interrupted(place: &Workplace, arguments: &str, signals: &[(&str, &str)]) -> Ran {
    let mut command = place.command(&format!("render room.pbrt {arguments}"));
    let mut child = command.stderr(Stdio::piped()).spawn().unwrap();
    let mut output = String::new();
    let mut signals = signals.iter();
    let mut next = signals.next();
    for line in BufReader::new(child.stderr.take().unwrap()).lines() {
        let line = line.unwrap() + "\n";
        output += &line;
        if let Some((_, signal)) = next.filter(|(words, _)| line.contains(words)) {
            send(signal, &child);
            next = signals.next();
        }
    }
    let code = child.wait().unwrap().code();
    Ran {
        code,
        stdout: String::new(),
        stderr: output,
    }
}

#[test]
fn the_first_signal_ends_with_the_image_of_the_complete_passes() {
    for (signal, code) in [("INT", 130), ("TERM", 143)] {
        let place = Workplace::new();
        // A tenth of the time is reported after a second.
        let arguments = "--spp 1000000000 --time 10 --threads 1";
        let ran = interrupted(&place, arguments, &[("Progress:", signal)]).expect(code);
        ran.says("wrote room.exr and room.png")
            .says(" of 1000000000 samples per pixel");
        place.run("compare room.exr room.exr --exact").expect(0);
    }
}

/// A film of 50 MB takes long to write.
#[test]
fn the_second_signal_ends_at_once() {
    let place = Workplace::new();
    // A tenth of the time is reported after a second.
    let arguments = "--size 600x600 --integrator path --time 10 --checkpoint a.film";
    let signals = [
        ("Progress:", "INT"),
        ("a second signal stops at once", "INT"),
    ];
    interrupted(&place, arguments, &signals).expect(130);
    assert!(!place.path("room.exr").exists() && !place.path("a.film").exists());
}

#[test]
fn a_signal_in_the_only_pass_leaves_no_file() {
    let place = Workplace::new();
    let arguments = "--size 1000x1000 --spp 1 --time 1m --threads 1";
    interrupted(&place, arguments, &[("Progress:", "INT")])
        .expect(130)
        .says("stopped before the first pass: nothing was written");
    assert_eq!(place.names(), ["room.pbrt"]);
}

/// A scene whose rays pass twenty thousand surfaces that are nearly invisible.
fn slow(place: &Workplace) {
    let curtain = |i: i32| {
        let height = -3.0 - f64::from(i) / 40_000.0;
        format!(
            "Shape \"disk\" \"float radius\" 3 \"float height\" {height} \"float alpha\" 1e-5\n"
        )
    };
    let curtains: String = (0..20_000).map(curtain).collect();
    place.write("room.pbrt", &(SCENE.to_owned() + &curtains));
}

/// A pass of a million samples takes minutes, and a batch of them half a second.
#[test]
fn without_a_complete_pass_in_time_nothing_is_written() {
    let place = Workplace::new();
    slow(&place);
    let render = "render room.pbrt --size 1000x1000 --checkpoint a.film";
    for integrator in ["path", "bdpt", "lvc"] {
        let start = Instant::now();
        place
            .run(&format!("{render} --integrator {integrator} --time 1"))
            .expect(7)
            .says("no pass was complete after 1.00s: nothing was written")
            .says("give it more --time, or make the image smaller with --size or --crop");
        assert!(start.elapsed() < Duration::from_secs(120));
        assert_eq!(place.names(), ["room.pbrt"]);
    }
}

#[test]
fn with_a_film_file_the_render_can_continue() {
    let place = Workplace::new();
    let arguments = "--spp 1000000 --checkpoint a.film --time 10 --threads 1";
    let signals = [("Progress:", "TERM")];
    interrupted(&place, arguments, &signals)
        .expect(75)
        .says("wrote room.exr, room.png and a.film")
        .says("stopped early; the same command with --resume continues");
    let info = place.run("film info a.film --json").expect(0).json();
    assert_eq!(info["stopping"], "time");
}

/// Runs a render with long training, and sends a signal after its message.
fn stopped_in_training(place: &Workplace, what: &str, signal: &str) -> Ran {
    slow(place);
    let long = "--integrator lvc --spp 100000";
    let mut command = place.command(&format!("render room.pbrt {long} {what}"));
    let mut child = command.stderr(Stdio::piped()).spawn().unwrap();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    let mut output = String::new();
    while !output.contains("training before the first sample") {
        assert!(stderr.read_line(&mut output).unwrap() > 0, "{output}");
    }
    send(signal, &child);
    stderr.read_to_string(&mut output).unwrap();
    Ran {
        code: child.wait().unwrap().code(),
        stdout: String::new(),
        stderr: output,
    }
}

#[test]
fn with_a_film_file_training_can_be_stopped_too() {
    // There is nothing to continue from.
    for (signal, code) in [("INT", 130), ("TERM", 143)] {
        let place = Workplace::new();
        let ran = stopped_in_training(&place, "--checkpoint a.film", signal).expect(code);
        ran.says("stopped before the first pass: nothing was written");
        assert_eq!(place.names(), ["room.pbrt"]);
    }
}

#[test]
fn a_replay_can_be_stopped_while_it_trains() {
    let place = Workplace::new();
    stopped_in_training(&place, "--replay 1,1,0", "INT").expect(130);
}

#[test]
fn a_reference_can_be_stopped_and_continued() {
    let place = Workplace::new();
    let arguments = "reference room.pbrt --size 48x32 --spp 4096 --progress plain";
    let mut child = place
        .command(arguments)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // Wait until the first replicate is done.
    while !place.path("room.reference/films/picture-00.film").exists() {
        std::thread::sleep(Duration::from_millis(5));
    }
    send("INT", &child);
    let mut output = String::new();
    let stderr = child.stderr.as_mut().unwrap();
    stderr.read_to_string(&mut output).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(75), "{output}");
    assert!(
        output.contains("run the same command to continue"),
        "{output}"
    );
    assert!(!place.path("room.reference/provenance.json").exists());
    // With fewer samples, the finished replicate has too many.
    let least = "reference room.pbrt --size 48x32 --spp 16";
    place.run(least).expect(5).says("use --spp 4096");
}

#[test]
fn a_signal_writes_the_files_at_once() {
    let place = Workplace::new();
    let arguments = "--time 10m --threads 1 -o a.exr --checkpoint a.film";
    let mut command = place.command(&format!("render room.pbrt {arguments}"));
    let mut child = command.stderr(Stdio::null()).spawn().unwrap();
    // Once the film file is locked, signals are watched.
    while !place.path("a.film.lock").exists() {
        std::thread::sleep(Duration::from_millis(5));
    }
    send("USR1", &child);
    while !place.path("a.exr").exists() {
        assert!(
            child.try_wait().unwrap().is_none(),
            "written at the end only"
        );
        std::thread::sleep(Duration::from_millis(5));
    }
    place.run("film verify a.film").expect(0);
    let now = place.attributes("a.exr");
    assert_eq!(now["bidir/stopping"], "time");
    assert!(now["bidir/samples"].parse::<u64>().unwrap() > 0);
    // On a busy machine, the next pass may come later than the signal that ends the render.
    while place.attributes("a.exr")["bidir/samples"] == now["bidir/samples"] {
        assert!(child.try_wait().unwrap().is_none(), "written only once");
        send("USR1", &child);
        std::thread::sleep(Duration::from_millis(5));
    }
    send("TERM", &child);
    assert_eq!(child.wait().unwrap().code(), Some(75));
    let end = place.attributes("a.exr");
    assert!(now.keys().eq(end.keys()) && now["bidir/samples"] != end["bidir/samples"]);
}

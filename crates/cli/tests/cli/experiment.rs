use crate::common::{Ran, Workplace};
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};

/// Two methods under two budgets, in 16 x 12 pixels.
const DESCRIPTION: &str = r#"
title = "A test"
seeds = 3
size = "16x12"
[[scene]]
file = "room.pbrt"
reference-spp = 16
[[method]]
name = "all"
[[method]]
name = "one"
shadow-rays = "per-pair"
[[budget]]
samples = 2
[[budget]]
rays = 40
"#;

fn place() -> Workplace {
    let place = Workplace::new();
    place.write("test.toml", DESCRIPTION);
    place
}

/// Returns the records of an experiment without their times.
fn records(place: &Workplace, folder: &str) -> Vec<Value> {
    let text = place.read(&format!("{folder}/results.json"));
    let mut results: Value = serde_json::from_str(&text).unwrap();
    let records = results["records"].as_array_mut().unwrap();
    for record in records.iter_mut() {
        let record = record.as_object_mut().unwrap();
        record.remove("seconds").unwrap();
        record.remove("processor_seconds").unwrap();
        record.remove("training_seconds").unwrap();
        record.remove("training_processor_seconds").unwrap();
        record.remove("efficiency_seconds").unwrap();
    }
    records.clone()
}

#[test]
fn an_experiment_has_tables_records_and_a_report() {
    let place = place();
    place
        .run("experiment test.toml -o out/deep")
        .expect(0)
        .prints("room, 2 spp: means over 3 seeds, with 95 % intervals.")
        .prints("room, 40 rays per pixel: ratios to all, paired by seed")
        .says("Progress: 100% 12 of 12 renders")
        .says("wrote out/deep/report.html");
    assert_eq!(records(&place, "out/deep").len(), 12);
    assert!(place.read("out/deep/report.html").contains("A test"));
    let images = std::fs::read_dir(place.path("out/deep/images")).unwrap();
    assert_eq!(images.count(), 4);
    // Nothing is rendered twice, and nothing else but a lock is in the folder.
    place
        .run("experiment test.toml -o out/deep --quiet")
        .expect(0)
        .prints("room, 2 spp");
    let names = std::fs::read_dir(place.path("out/deep")).unwrap();
    assert_eq!(names.count(), 6);
}

#[test]
fn tables_of_one_seed_promise_no_intervals() {
    let place = place();
    place
        .run("experiment test.toml --seeds 1")
        .expect(0)
        .prints("room, 2 spp: means over 1 seed, without intervals.")
        .prints("ratios to all, paired by seed, without intervals.")
        .says("wrote test.results/report.html");
}

#[test]
fn a_report_shows_strategies_and_flip_maps() {
    let place = place();
    place.write(
        "test.toml",
        &format!("pyramid = \"all\"\npyramid-spp = 2\n{DESCRIPTION}"),
    );
    place.run("experiment test.toml -o out").expect(0);
    let page = place.read("out/report.html");
    for layer in ["\"longer\":\"", "\"s1t2\":\"", "\"raw.s1t2\":\""] {
        assert_eq!(page.matches(layer).count(), 1, "{layer}");
    }
    // All four renders have their maps, and their reference needs none.
    assert_eq!(page.matches("\"flip\":\"").count(), 4);
    assert_eq!(page.matches("\"flip\":null").count(), 1);
    let results: Value = serde_json::from_str(&place.read("out/results.json")).unwrap();
    assert_eq!(
        results["pyramids"][0]["images"],
        "images/room--strategies.exr"
    );
    // A reference from a file is in the report, too.
    let reference = "reference = \"out/images/room--2-spp--all.exr\"";
    place.write(
        "test.toml",
        &DESCRIPTION.replace("reference-spp = 16", reference),
    );
    place.run("experiment test.toml -o given").expect(0);
    let page = place.read("given/report.html");
    assert_eq!(page.matches("\"flip\":\"").count(), 4);
    place.write("test.toml", &format!("pyramid = \"oen\"\n{DESCRIPTION}"));
    place
        .run("experiment test.toml -o out")
        .expect(3)
        .says("test.toml:1:11: unknown name `oen`")
        .says("did you mean `one`?");
}

#[test]
fn a_method_is_added_by_the_description_alone() {
    let place = place();
    let more = "[[method]]\nname = \"light\"\nintegrator = \"light\"\n";
    place.write("more.toml", &(DESCRIPTION.to_owned() + more));
    place
        .run("experiment more.toml -o out --quick --threads 1")
        .expect(0)
        .prints("light");
    let records = records(&place, "out");
    assert_eq!(records.len(), 18);
}

/// Runs an experiment, and stops it after a line with these words.
fn interrupted(place: &Workplace, arguments: &str, words: &str) -> Ran {
    let mut command = place.command(arguments);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut output = String::new();
    for line in BufReader::new(child.stderr.take().unwrap()).lines() {
        let line = line.unwrap() + "\n";
        if line.contains(words) && !output.contains(words) {
            let id = child.id().to_string();
            let kill = Command::new("kill").args(["-s", "INT", &id]).status();
            assert!(kill.unwrap().success());
        }
        output += &line;
    }
    let code = child.wait().unwrap().code();
    Ran {
        code,
        stdout: String::new(),
        stderr: output,
    }
}

#[test]
fn an_interrupted_experiment_continues_to_the_same_records() {
    let place = place();
    // The first render is long enough to be stopped.
    place.write(
        "test.toml",
        &DESCRIPTION.replace("samples = 2", "samples = 800"),
    );
    place.run("experiment test.toml -o whole").expect(0);
    interrupted(&place, "experiment test.toml -o stopped", "0 of 12 renders")
        .expect(75)
        .says("stopped: run the same command to continue");
    place.run("experiment test.toml -o stopped").expect(0);
    assert_eq!(records(&place, "stopped"), records(&place, "whole"));
}

#[test]
fn errors_of_a_description_have_their_place() {
    let place = place();
    place.write("key.toml", &DESCRIPTION.replace("seeds", "sedes"));
    place
        .run("experiment key.toml -o out")
        .expect(3)
        .says("key.toml:3:1: there is no key `sedes` here")
        .says("did you mean `seeds`?");
    place.write("scene.toml", &DESCRIPTION.replace("room.pbrt", "rom.pbrt"));
    place
        .run("experiment scene.toml -o out")
        .expect(4)
        .says("rom.pbrt");
    place
        .run("experiment none.toml -o out")
        .expect(4)
        .says("none.toml");
    // A built-in experiment has this name; the path makes it a file.
    place.write("paper", DESCRIPTION);
    place.run("experiment ./paper -o out").expect(0);
}

#[test]
fn another_experiment_needs_restart() {
    let place = place();
    place.run("experiment test.toml -o out").expect(0);
    place.write("test.toml", &DESCRIPTION.replace("rays = 40", "rays = 30"));
    place
        .run("experiment test.toml -o out")
        .expect(5)
        .says("--restart");
    place
        .run("experiment test.toml -o out --restart --threads 1")
        .expect(0);
    assert_eq!(records(&place, "out").len(), 12);
    // Times depend on the number of threads.
    place
        .run("experiment test.toml -o out --threads 2")
        .expect(5)
        .says("1 threads, here 2 threads")
        .says("--threads");
}

#[test]
fn a_cluster_needs_the_python_package() {
    let place = Workplace::new();
    place
        .run("experiment paper -o out --ray local")
        .expect(2)
        .says("--ray takes a description");
    place
        .run("experiment a.toml -o out --ray local --threads 2")
        .expect(2)
        .says("cannot be used with --threads");
}

#[cfg(unix)]
#[test]
fn the_program_of_a_cluster_gets_the_arguments() {
    let place = Workplace::new();
    let python = |name: &str, script: &str| {
        let path = place.path(name);
        // Another process writes it, because a program that is open for writing here cannot be started.
        let write = "printf '%s' \"$1\" > \"$2\" && chmod +x \"$2\"";
        let mut shell = Command::new("sh");
        shell.args(["-c", write, "sh", script]).arg(&path);
        assert!(shell.status().unwrap().success());
        path
    };
    let without = python(
        "without",
        "#!/bin/sh\necho 'No module named bidir' >&2\nexit 1\n",
    );
    let run = |python: &Path| {
        let command = "experiment a.toml -o out --ray host:1 --quick";
        let mut command = place.command(command);
        // The variable applies to all commands, and does not conflict with --ray.
        command.env("BIDIR_THREADS", "2");
        Ran::of(command.env("BIDIR_PYTHON", python))
    };
    run(&without)
        .expect(4)
        .says("No module named bidir")
        .says("pip install '.[ray]'");
    run(Path::new("no-such-python")).expect(4);
    // The command has the exit code of the package.
    let with = python(
        "with",
        "#!/bin/sh\n[ \"$1\" = -c ] && exit 0\necho \"$@\" >&2\nexit 75\n",
    );
    run(&with)
        .expect(75)
        .says("-m bidir.ray experiment a.toml --output out --address host:1 --quick");
}

/// Runs the description of the guide, made smaller, with the command that is printed there.
#[test]
fn the_description_of_the_guide_runs() {
    let place = Workplace::new();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let guide = std::fs::read_to_string(root.join("docs/guide/comparing.md")).unwrap();
    let (_, text) = guide.split_once("```toml\n").unwrap();
    let (text, _) = text.split_once("```").unwrap();
    let scenes = format!("file = \"{}/scenes/", root.display());
    place.write("claims.toml", &text.replace("file = \"scenes/", &scenes));
    place
        .run("experiment claims.toml -o out --size 12x9 --seeds 3 --rays 40 --reference-spp 32")
        .expect(0)
        .prints("two-beat-all: ")
        .prints("nanoseconds per ray: per-pair, direct: ");
    let results: Value = serde_json::from_str(&place.read("out/results.json")).unwrap();
    for claim in results["claims"].as_array().unwrap() {
        assert_ne!(claim["verdict"], "not-measured", "{claim}");
    }
    // Changed claims do not render anything again.
    let before = place.read("out/records.ndjson");
    let other = text.replace("below = 0.95", "below = 0.0001");
    place.write("claims.toml", &other.replace("file = \"scenes/", &scenes));
    place
        .run("experiment claims.toml -o out --size 12x9 --seeds 3 --rays 40 --reference-spp 32")
        .expect(0)
        .prints("two-beat-all: not reproduced");
    assert_eq!(place.read("out/records.ndjson"), before);
}

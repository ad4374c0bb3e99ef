use crate::common::{Ran, SCENE, Workplace};
use formats::is_obeyed;
use std::fs;

/// Sets a title, clears the screen, reverses the direction of writing, and forges a line.
const HOSTILE: &str = "\x1b]0;t\x07\u{9b}2J\u{202e}\r\x7f\nerror: forged";
/// The same on one line, for strings of a scene.
const HOSTILE_STRING: &str = "\x1b]0;t\x07\u{9b}2J\u{202e}\x7f";

/// Runs a command in the scene's folder, and fails if its output has control characters; `@` in a word is
/// the hostile name.
#[track_caller]
fn run(place: &Workplace, words: &str) -> Ran {
    let words = words.split_whitespace();
    let words = words.map(|word| word.replace('@', HOSTILE));
    let ran = Ran::of(place.command("").args(words));
    for text in [&ran.stdout, &ran.stderr] {
        let is_raw = |c: char| is_obeyed(c) && c != '\n';
        assert!(!text.contains(is_raw), "{text:?}");
        assert!(!text.lines().any(|line| line == "error: forged"), "{text}");
    }
    ran
}

fn place() -> Workplace {
    let place = Workplace::new();
    fs::rename(
        place.path("room.pbrt"),
        place.path(&format!("{HOSTILE}.pbrt")),
    )
    .unwrap();
    place
}

#[test]
fn control_characters_in_names_of_files_are_escaped() {
    let place = place();
    let shown = r"\u{1b}]0;t\u{7}\u{9b}2J\u{202e}\r\u{7f}\nerror: forged";
    run(
        &place,
        "render @.pbrt -o @.exr --size 8x6 --checkpoint @.film",
    )
    .expect(0)
    .says(&format!("wrote {shown}.exr, {shown}.png and {shown}.film"));
    run(&place, "film info @.film")
        .expect(0)
        .prints(&format!("scene     {shown}.pbrt"));
    let json = run(&place, "film info @.film --json").expect(0).json();
    assert_eq!(json["scene"], format!("{HOSTILE}.pbrt"));
    run(&place, "film verify @.film").expect(0).says(shown);
    run(&place, "merge @.film @.film -o all.film")
        .expect(5)
        .says(shown);
    run(&place, "render @.pbrt --checkpoint @.film")
        .expect(2)
        .says(shown);
    run(&place, "render @x.pbrt")
        .expect(4)
        .says("hint: did you mean");
    run(&place, "render @.pbrt -o @.jpg --progress openjd")
        .expect(2)
        .prints("openjd_fail: cannot write");
    let info = run(&place, "info @.pbrt").expect(0);
    assert!(
        info.stdout
            .contains(&format!("scene        {shown}.pbrt\nfilm "))
    );
    let json = run(&place, "info @.pbrt --json").expect(0).json();
    assert_eq!(json["scene"], format!("{HOSTILE}.pbrt"));
    run(&place, "render @.pbrt -o b.exr --size 4x3").expect(0);
    run(&place, "compare @.exr b.exr").expect(4).says(shown);
    run(&place, "farm shell @.pbrt --parts 2")
        .expect(2)
        .says("control characters, which a job file cannot show");
}

#[test]
fn control_characters_in_texts_of_scenes_are_escaped() {
    let place = Workplace::new();
    let shown = r"\u{1b}]0;t\u{7}\u{9b}2J\u{202e}\u{7f}";
    let broken = SCENE.replace("\"sphere\"", &format!("\"sphere{HOSTILE_STRING}\""));
    place.write("broken.pbrt", &broken);
    let ran = run(&place, "render broken.pbrt").expect(3);
    // Once in the message, and once in the lines of the file.
    assert_eq!(ran.stderr.matches(shown).count(), 2, "{}", ran.stderr);
    let named = SCENE.replace("room.exr", &format!("{HOSTILE_STRING}.exr"));
    place.write("named.pbrt", &named.replace('\n', "\r\n"));
    run(&place, "info named.pbrt").expect(0).prints(shown);
    let odd = format!("Option \"string {HOSTILE_STRING}\" \"{HOSTILE_STRING}\"\n{SCENE}");
    place.write("odd.pbrt", &odd);
    run(&place, "info odd.pbrt");
    let gltf = format!(r#"{{"asset": {{"version": "2.0"}}, "{HOSTILE_STRING}": 1}}"#);
    place.write("a.gltf", &gltf);
    run(&place, "info a.gltf").expect(3);
}

#[test]
fn control_characters_in_names_of_an_experiment_are_escaped() {
    let place = Workplace::new();
    let name = r#"name = "a\u001b[2J\u009b\u202e\nerror: forged""#;
    let description = format!(
        "title = \"t\"\nseeds = 1\nsize = \"8x6\"\n[[scene]]\nfile = \"room.pbrt\"\n{name}\n\
         reference-spp = 16\n[[method]]\n{name}\n[[budget]]\nsamples = 2\n"
    );
    place.write("test.toml", &description);
    let ran = run(&place, "experiment test.toml -o out").expect(0);
    let shown = r"a\u{1b}[2J\u{9b}\u{202e}\nerror: forged";
    assert!(ran.stdout.contains(shown) && ran.stderr.contains(shown));
    place.write(
        "wrong.toml",
        &description.replace("file = \"room", "file = \"\\u001b"),
    );
    run(&place, "experiment wrong.toml -o out")
        .expect(4)
        .says(r"\u{1b}.pbrt");
}

#[test]
fn control_characters_in_arguments_and_variables_are_escaped() {
    let place = Workplace::new();
    for words in [
        "render room.pbrt --@",
        "render room.pbrt @",
        "render room.pbrt --integrator @",
        "render room.pbrt --spp @",
        "reference room.pbrt --estimator @",
        "completions @",
        "man @",
        "@",
        "@.pbrt",
    ] {
        let ran = run(&place, words).expect(2);
        assert!(ran.stderr.contains(r"\u{1b}]0;t"), "{}", ran.stderr);
        // With our own colours.
        let words = words
            .split_whitespace()
            .map(|word| word.replace('@', HOSTILE));
        let mut command = place.command("");
        let ran = Ran::of(command.args(words).env("CLICOLOR_FORCE", "1"));
        assert!(!ran.stderr.contains("\x1b]") && !ran.stderr.contains('\u{9b}'));
    }
    let mut command = place.command("render room.pbrt");
    let ran = Ran::of(command.env("BIDIR_SPP", HOSTILE)).expect(2);
    ran.says(r"BIDIR_SPP: `\u{1b}]0;t");
}

/// Makes the files that the commands below read.
#[cfg(target_os = "linux")]
fn place_of_files() -> Workplace {
    let place = Workplace::new();
    let render = "render room.pbrt --size 8x6 -q -o a.exr --checkpoint a.film";
    place.run(render).expect(0);
    place.write(
        "test.toml",
        "title = \"t\"\nseeds = 1\nsize = \"8x6\"\n[[scene]]\nfile = \"room.pbrt\"\nreference-spp = 16\n\
         [[method]]\nname = \"a\"\n[[budget]]\nsamples = 2\n",
    );
    place
}

#[cfg(target_os = "linux")]
#[test]
fn an_error_of_stdout_is_an_error() {
    let place = place_of_files();
    for words in [
        "--help",
        "render -h",
        "help film",
        "--version",
        "render --version",
        "man",
        "man render",
        "man --markdown",
        "completions bash",
        "info room.pbrt",
        "info room.pbrt --json",
        "compare a.exr a.exr",
        "compare a.exr a.exr --json",
        "film info a.film",
        "film info a.film --json",
        "missing a.film --spp 4",
        "farm shell room.pbrt --parts 2",
        "farm k8s room.pbrt --parts 2",
        "render room.pbrt --replay 1,1,0",
        "render room.pbrt --replay 1,1,0 --json",
        "render room.pbrt --size 8x6 -q --progress openjd",
        "reference room.pbrt --size 8x6 --spp 16 -q --progress openjd",
        "experiment test.toml -o out",
    ] {
        let full = fs::File::options().write(true).open("/dev/full").unwrap();
        let ran = Ran::of(place.command(words).stdout(full));
        assert_eq!(ran.code, Some(4), "{words}: {}", ran.stderr);
        ran.once("error: cannot write to stdout: ");
    }
    // The image was written all the same.
    assert!(place.path("room.exr").exists());
}

#[cfg(target_os = "linux")]
#[test]
fn an_error_of_stderr_is_an_error_of_commands_that_succeed() {
    let place = place_of_files();
    for (words, code) in [
        ("render room.pbrt --size 8x6 -q --progress ndjson", 4),
        ("render room.pbrt --size 8x6 -q --progress plain", 4),
        ("render room.pbrt --size 8x6", 4),
        ("reference room.pbrt --size 8x6 --spp 16", 4),
        ("tonemap a.exr -o b.png", 4),
        ("merge a.film -o b.film", 4),
        ("film verify a.film", 4),
        ("experiment test.toml -o again", 4),
        ("render room.pbrt -q", 0),
        ("render room.pbrt --spp x", 2),
        ("missing a.film --spp 4", 6),
        ("", 2),
    ] {
        let full = fs::File::options().write(true).open("/dev/full").unwrap();
        let ran = Ran::of(place.command(words).stderr(full));
        assert_eq!(ran.code, Some(code), "{words}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn readers_that_leave_are_no_error() {
    use std::process::Stdio;

    let place = place_of_files();
    for words in [
        "--help",
        "man --markdown",
        "info room.pbrt",
        "render room.pbrt --size 8x6 -q --progress openjd",
        "render room.pbrt --size 8x6 --progress ndjson",
    ] {
        let mut command = place.command(words);
        let mut child = command
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop((child.stdout.take(), child.stderr.take()));
        assert_eq!(child.wait().unwrap().code(), Some(0), "{words}");
    }
}

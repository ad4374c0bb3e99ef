//! Mistakes on the command line: one form, in colour, with a hint.

use crate::common::{Ran, Workplace};

#[track_caller]
fn check(arguments: &str, code: i32, says: &str) {
    Workplace::new().run(arguments).expect(code).says(says);
}

/// Returns the error and the hint of a command line.
#[track_caller]
fn check_mistake(arguments: &str, error: &str, hint: Option<&str>) {
    let ran = Workplace::new().run(arguments).expect(2);
    let hint = hint.map(|hint| format!("hint: {hint}\n"));
    let expected = format!("error: {error}\n{}", hint.unwrap_or_default());
    assert_eq!(ran.stderr, expected, "{arguments}");
    assert_eq!(ran.stdout, "", "{arguments}");
}

#[test]
fn mistakes_of_the_command_line_have_one_form() {
    for (arguments, error, hint) in [
        (
            "rendr room.pbrt",
            "there is no command `rendr`",
            Some("did you mean `render`?"),
        ),
        (
            "paint",
            "there is no command `paint`",
            Some("see `bidir --help`"),
        ),
        (
            "film inf a.film",
            "there is no command `inf`",
            Some("did you mean `info`?"),
        ),
        (
            "render",
            "`bidir render` needs SCENE",
            Some("see `bidir render --help`"),
        ),
        (
            "film develop a.film",
            "`bidir film develop` needs --output IMAGE",
            Some("see `bidir film develop --help`"),
        ),
        (
            "missing",
            "`bidir missing` needs --spp N",
            Some("see `bidir missing --help`"),
        ),
        (
            "render room.pbrt --sp 4",
            "there is no flag `--sp`",
            Some("did you mean `--spp`?"),
        ),
        (
            "render room.pbrt other.pbrt",
            "unexpected argument `other.pbrt`",
            Some("see `bidir render --help`"),
        ),
        (
            "render room.pbrt --spp 4 --spp 5",
            "--spp is given more than once",
            None,
        ),
        (
            "render room.pbrt --crop 0,0,4,4 --cropwindow 0,1,0,1",
            "--crop cannot be used with --cropwindow",
            None,
        ),
        ("render room.pbrt --spp", "--spp needs a value: N", None),
        (
            "render room.pbrt --integrator",
            "--integrator needs one of path, light, bdpt, lvc, auto",
            None,
        ),
        (
            "completions fisch",
            "SHELL: `fisch` is not one of bash, elvish, fish, powershell, zsh",
            Some("did you mean `fish`?"),
        ),
        (
            "experiment a.toml --ray auto --threads 2",
            "--ray cannot be used with --threads: each node uses all of its threads",
            Some("see `bidir experiment --help`"),
        ),
    ] {
        check_mistake(arguments, error, hint);
    }
}

#[test]
fn mistakes_of_the_command_line_have_the_colours_of_other_errors() {
    let place = Workplace::new();
    for arguments in [
        "render missing.pbrt",
        "render room.pbrt --sp 4",
        "render",
        "rendr",
        "render room.pbrt --spp x",
        "render room.pbrt --crop 0,0,4,4 --cropwindow 0,1,0,1",
    ] {
        let mut command = place.command(arguments);
        command
            .env("FORCE_COLOR", "1")
            .env_remove("NO_COLOR")
            .env("TERM", "xterm");
        Ran::of(&mut command).says("\x1b[1;31merror\x1b[0m: ");
        let ran = Ran::of(command.arg("--no-color"));
        assert!(!ran.stderr.contains('\x1b'), "{arguments}");
    }
}

#[test]
fn samples_have_units_and_exponents() {
    let place = Workplace::new();
    place
        .run("render room.pbrt --size 4x3 --spp 0.02k -o a.exr")
        .expect(0)
        .says("20 samples per pixel");
    for (arguments, part) in [
        ("--spp 4k", "--spp 4000"),
        ("--spp 1e6", "--spp 1000000"),
        ("--spp 1e9", "--spp 1000000000"),
        ("--spp 2.5M", "--spp 2500000"),
    ] {
        let farm = format!("farm shell room.pbrt --parts 2 {arguments}");
        place.run(&farm).expect(0).prints(part);
    }
    let mut command = place.command("render room.pbrt --size 4x3 -o a.exr");
    Ran::of(command.env("BIDIR_SPP", "1.7e1"))
        .expect(0)
        .says("17 samples per pixel");
    for wrong in ["-1", "0k", "4.5", "4kk", "1e99"] {
        let says = format!("error: --spp: `{wrong}` is not a whole number above 0\n");
        check(&format!("render room.pbrt --spp {wrong}"), 2, &says);
    }
}

#[test]
fn film_files_have_their_ending() {
    for (arguments, says) in [
        (
            "render room.pbrt --checkpoint x.txt",
            "error: cannot write `x.txt`: film files are .film\nhint: name it x.film\n",
        ),
        (
            "render room.pbrt --checkpoint out/x",
            "hint: name it out/x.film\n",
        ),
        (
            "render room.pbrt --passes 0..1 --checkpoint x.exr",
            "cannot write `x.exr`",
        ),
        (
            "render room.pbrt --checkpoint x.pbrt",
            "cannot write `x.pbrt`",
        ),
        ("merge a.film -o b.png", "cannot write `b.png`"),
    ] {
        check(arguments, 2, says);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn folders_that_take_no_files_get_the_reason_of_the_system() {
    for (arguments, file) in [
        ("render room.pbrt -o /proc/x.exr", "/proc/x.exr"),
        ("render room.pbrt --stats /proc/x.json", "/proc/x.json"),
        ("render room.pbrt --checkpoint /proc/x.film", "/proc/x.film"),
        ("tonemap room.exr -o /proc/x.png", "/proc/x.png"),
        ("render room.pbrt -o /sys/x.exr", "/sys/x.exr"),
    ] {
        let ran = Workplace::new().run(arguments).expect(4);
        assert!(!ran.stderr.contains("no such folder"), "{}", ran.stderr);
        ran.says(&format!("error: cannot write `{file}`: "))
            .says(" in `/");
    }
}

use crate::common::{Ran, Workplace, scenes};

#[test]
fn errors_are_coloured_on_request() {
    let place = Workplace::new();
    for arguments in ["render missing.pbrt", "render room.pbrt --sp 4", "rendr"] {
        let mut command = place.command(arguments);
        let plain = Ran::of(command.env_remove("FORCE_COLOR"));
        assert!(!plain.stderr.contains('\x1b'), "{arguments}");
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
fn samples_have_units_and_flags_take_precedence_over_the_environment() {
    let place = Workplace::new();
    for (spp, flags, says) in [
        ("", "--size 4x3 --spp 0.02k", "20 samples per pixel"),
        ("1.7e1", "--size 4x3", "17 samples per pixel"),
        ("3", "--spp 1", "1 sample per pixel"),
    ] {
        let mut command = place.command(&format!("render room.pbrt {flags}"));
        if !spp.is_empty() {
            command.env("BIDIR_SPP", spp);
        }
        Ran::of(&mut command).expect(0).says(says);
    }
}

#[test]
fn a_part_that_is_watched_is_rendered() {
    for watched in ["--serve 0", "--replay 1,1,0"] {
        let render = format!("render room.pbrt --part 0/2 {watched}");
        Workplace::new().run(&render).expect(0);
    }
}

#[test]
fn broken_scenes_exit_with_3_and_show_the_place() {
    for (name, says) in [
        ("huge-film.pbrt", "1000000"),
        ("missing-mesh.pbrt", "no-such-mesh.ply"),
        ("misspelt-material.pbrt", "did you mean `diffuse`?"),
        ("nan-vertex.pbrt", "nan-vertex.ply"),
        (
            "unclosed-string.pbrt",
            "12:10: the string has no closing quote; write `\"diffuse\"`",
        ),
    ] {
        let scene = scenes().join("broken").join(name);
        let ran = Ran::of(Workplace::new().command("render").arg(&scene)).expect(3);
        ran.says(says).says(&format!("{name}:")).says("╭─[");
    }
}

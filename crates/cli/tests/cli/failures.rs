use crate::common::{Ran, Workplace, scenes};
use std::fs;

#[track_caller]
fn check(arguments: &str, code: i32, says: &str) {
    Workplace::new().run(arguments).expect(code).says(says);
}

#[test]
fn errors_of_the_command_line_exit_with_2() {
    check("", 2, "Usage");
    check("render", 2, "SCENE");
    check("render room.pbrt --integrator photon", 2, "bdpt");
    check("render room.pbrt --shadow-rays some", 2, "per-light-vertex");
    check("render room.pbrt --strategies s", 2, "strategy");
    check("render room.pbrt --time soon", 2, "1h30m");
    check("render room.pbrt --spp 0", 2, "--spp");
    check("render room.pbrt --size 0x4", 2, "1920x1080");
    check(
        "render room.pbrt --crop 0,0,4,4 --cropwindow 0,1,0,1",
        2,
        "cannot be used with",
    );
    check("render room.pbrt -o room.jpg", 2, ".exr or .png");
    check("render room.pbrt --replay 24,0,0", 2, "is not rendered");
    check(
        "compare room.exr room.exr --exact --resample",
        2,
        "cannot be used with",
    );
}

#[test]
fn strategies_that_make_no_path_are_refused_and_lost_light_is_a_warning() {
    let of = |list: &str| format!("render room.pbrt --spp 1 --strategies {list}");
    check(
        &of("s0t0"),
        2,
        "error: --strategies s0t0 makes no path\nhint: ",
    );
    let long = "error: --strategies s4t3 makes no path of at most 6 vertices\nhint: raise --max-depth: \
                paths of 4 bounces have 6 vertices, and no path has more than 1024\n";
    check(
        &of("s9999t2"),
        2,
        "error: --strategies s9999t2 makes no path of at most 6 vertices\nhint: raise --max-depth",
    );
    check(
        &of("s9999t2 --max-depth 0"),
        2,
        "makes no path of at most 1024 vertices\nhint: no path has more vertices\n",
    );
    check(&of("s4t3"), 2, long);
    let lost = "--strategies s2 loses light: no strategy makes paths of 2 vertices";
    check(&of("s2"), 0, &format!("warning: {lost}\n"));
    check(
        &(of("s2") + " --strict"),
        6,
        "1 warning, an error under --strict",
    );
    let ran = Workplace::new().run(&of("all,-s0")).expect(0);
    assert!(!ran.stderr.contains("warning"), "{}", ran.stderr);
}

#[test]
fn errors_of_numbers_out_of_range_name_the_range() {
    for (flags, says) in [
        ("--spp 0", "error: --spp: `0` is not a whole number above 0"),
        (
            "--spp -1",
            "error: --spp: `-1` is not a whole number above 0",
        ),
        (
            "--spp many",
            "error: --spp: `many` is not a whole number above 0",
        ),
        (
            "--max-depth -1",
            "error: --max-depth: `-1` is not a whole number, 0 or more",
        ),
        (
            "--seed -1",
            "error: --seed: `-1` is not a whole number, 0 or more",
        ),
        (
            "--noise -1",
            "error: --noise: `-1`: expected a number above 0",
        ),
        (
            "--noise 5%",
            "error: --noise: `5%`: write a fraction without a percent sign: 0.05\n",
        ),
        (
            "--size 320",
            "error: --size: `320`: expected WIDTHxHEIGHT, such as 320x240\n",
        ),
        ("--time -1", "error: --time: `-1`: expected a time such as"),
        (
            "--time 0",
            "error: --time: `0`: must be above 0, such as 90s\n",
        ),
        (
            "--size 256x0",
            "error: --size: `256x0`: each side has 1 to 65536 pixels, such as 1920x1080\n",
        ),
        (
            "--size 1000000x1000000",
            "error: --size: `1000000x1000000`: each side has 1 to 65536 pixels",
        ),
        (
            "--part 16/16",
            "error: --part: `16/16`: there is no part 16 of 16: parts are 0 to 15\n",
        ),
        (
            "--integrator BDPT",
            "error: --integrator: `BDPT` is not one of path, light, bdpt, lvc, auto\n\
             hint: did you mean `bdpt`?\n",
        ),
        ("--time -1s", "error: --time: `-1s` is negative"),
        ("--crop -1,0,4,4", "error: --crop: `-1,0,4,4` is negative"),
        (
            "--threads 5000",
            "error: --threads: `5000` is not a whole number from 0 to 1024",
        ),
        (
            "--strategy-layers 17",
            "error: --strategy-layers: `17` is not a whole number from 2 to 16",
        ),
        (
            "--shadow-rays budget",
            "`budget` needs a number of rays, such as budget:4",
        ),
    ] {
        check(&format!("render room.pbrt {flags}"), 2, says);
    }
    let place = Workplace::new();
    let mut command = place.command("render room.pbrt");
    Ran::of(command.env("BIDIR_SPP", "x"))
        .expect(2)
        .says("error: BIDIR_SPP: `x` is not a whole number above 0");
    let mut command = place.command("render room.pbrt");
    Ran::of(command.env("BIDIR_INTEGRATOR", "photon"))
        .expect(2)
        .says("error: BIDIR_INTEGRATOR: `photon` is not one of path, light, bdpt");
}

#[test]
fn flags_that_need_another_flag_name_it() {
    for (arguments, says) in [
        ("render room.pbrt --json", "--json needs --replay X,Y,PASS"),
        (
            "render room.pbrt --svg a.svg",
            "--svg needs --replay X,Y,PASS",
        ),
        (
            "render room.pbrt --resume",
            "--resume needs --checkpoint FILE.film",
        ),
        (
            "render room.pbrt --restart",
            "--restart needs --checkpoint FILE.film",
        ),
        (
            "render room.pbrt --checkpoint-every=1m",
            "--checkpoint-every needs --checkpoint FILE.film",
        ),
        (
            "compare a.exr b.exr --error-max 2",
            "--error-max needs --error-map FILE",
        ),
    ] {
        check(arguments, 2, &format!("error: {says}\n"));
    }
}

#[test]
fn a_file_in_the_place_of_a_command_gets_a_hint() {
    for (file, hint) in [
        ("scenes/room.pbrt", "bidir render scenes/room.pbrt"),
        ("room.GLB", "bidir render room.GLB"),
        ("a.toml", "bidir experiment a.toml"),
        ("a.film", "bidir film info a.film"),
    ] {
        let says = format!("error: there is no command `{file}`\nhint: {hint}\n");
        check(file, 2, &says);
    }
}

#[test]
fn missing_files_get_a_hint_at_similar_names() {
    let near = "no such file\nhint: did you mean `room.pbrt`?\n";
    check("render rom.pbrt", 4, near);
    check(
        "info ./roomm.pbrt",
        4,
        "hint: did you mean `./room.pbrt`?\n",
    );
    let place = Workplace::new();
    fs::create_dir_all(place.path("scenes/rooms")).unwrap();
    place.write("scenes/cornell.pbrt", "");
    place.write("scenes/rooms/a.gltf", "");
    for (missing, near) in [
        ("scene/cornell.pbrt", "scenes/cornell.pbrt"),
        ("./scnes/cornell.pbrt", "./scenes/cornell.pbrt"),
        ("scenes/cornel.pbrt", "scenes/cornell.pbrt"),
        ("scene/cornel.pbrt", "scenes/cornell.pbrt"),
        ("scene/room/a.gltf", "scenes/rooms/a.gltf"),
    ] {
        for command in ["render", "info"] {
            let ran = place.run(&format!("{command} {missing}")).expect(4);
            ran.says(&format!(": no such file\nhint: did you mean `{near}`?\n"));
        }
    }
    for far in ["elsewhere/cornell.pbrt", "scene/other.pbrt"] {
        let ran = place.run(&format!("render {far}")).expect(4);
        assert!(!ran.stderr.contains("hint"), "{}", ran.stderr);
    }
    place
        .run("experiment shadow-rays -o out")
        .expect(4)
        .says("hint: name `paper`, `beyond` or a .toml file\n");
    fs::create_dir(place.path("experiments")).unwrap();
    place.write("experiments/shadow-rays.toml", "");
    place
        .run("experiment shadow-rays -o out")
        .expect(4)
        .says("hint: did you mean `experiments/shadow-rays.toml`?\n");
}

#[test]
fn flags_of_other_programs_are_recognised() {
    for (flag, hint) in [
        (
            "--width 100",
            "hint: the size of the image is --size WIDTHxHEIGHT",
        ),
        (
            "--height 100",
            "hint: the size of the image is --size WIDTHxHEIGHT",
        ),
        (
            "--resolution 100",
            "hint: the size of the image is --size WIDTHxHEIGHT",
        ),
        (
            "--samples 100",
            "hint: the number of samples per pixel is --spp N",
        ),
        (
            "--camera Cam",
            "hint: the view is that of the first camera of the scene",
        ),
        ("--gpu", "hint: bidir renders on processors only"),
        (
            "--bounces 3",
            "hint: the maximum number of bounces is --max-depth N",
        ),
    ] {
        let name = flag.split(' ').next().unwrap();
        let ran = Workplace::new().run(&format!("render room.pbrt {flag}"));
        ran.expect(2)
            .says(&format!("error: there is no flag `{name}`\n"))
            .says(hint);
    }
    check(
        "render room.pbrt --exposure 1",
        2,
        "error: there is no flag `--exposure`\nhint: `bidir tonemap IMAGE.exr --exposure STOPS`",
    );
    check(
        "render room.pbrt -spp 4",
        2,
        "error: there is no flag `-spp`\nhint: did you mean `--spp`?\n",
    );
    check(
        "info room.pbrt --integrator path",
        2,
        "error: `info` has no flag `--integrator`\nhint: it is a flag of `bidir render`\n",
    );
    // A command without such a setting has no hint.
    check(
        "tonemap room.exr --width 100",
        2,
        "error: there is no flag `--width`\nhint: see `bidir tonemap --help`\n",
    );
}

#[test]
fn foreign_files_are_named_with_a_hint() {
    let place = Workplace::new();
    place.write("room.blend", "BLENDER-v402");
    place.write("room.xml", "<scene version=\"3.0.0\"></scene>");
    for command in ["render", "info"] {
        place
            .run(&format!("{command} room.blend"))
            .expect(3)
            .says("error: `room.blend` is a Blender file; export it as glTF 2.0 (docs/guide");
        place
            .run(&format!("{command} room.xml"))
            .expect(3)
            .says("error: `room.xml` is a Mitsuba scene; bidir reads pbrt-v4 (.pbrt) and glTF 2.0");
        place
            .run(&format!("{command} ."))
            .expect(4)
            .says("error: `.` is a folder; name a scene in it, such as ./room.pbrt");
    }
}

#[test]
fn missing_experiments_are_errors_like_other_missing_files() {
    check(
        "experiment nope.toml -o out",
        4,
        "error: cannot open `nope.toml`: no such file",
    );
    let near = "hint: did you mean the built-in experiment `paper`?";
    check("experiment papper -o out", 4, near);
}

#[test]
fn messages_have_whole_names() {
    check(
        "render x.pbrt",
        4,
        "error: cannot open `x.pbrt`: no such file",
    );
    let place = Workplace::new();
    place.write("xx.pbrt", "WorldBegin\nMaterial \"xylophone\"\n");
    place
        .run("render xx.pbrt")
        .expect(3)
        .says("error: xx.pbrt:2:");
}

#[test]
fn a_part_that_would_write_nothing_is_refused() {
    let place = Workplace::new();
    for share in ["--part 0/2", "--passes 0..1", "--part 0/2 -q"] {
        let ran = place.run(&format!("render room.pbrt {share}")).expect(2);
        ran.says("--checkpoint FILE.film").says("--output");
    }
    for kept in [
        "-o a.exr",
        "--stats a.json",
        "--pyramid a",
        "--checkpoint a.film",
        "--serve 0",
        "--replay 1,1,0",
    ] {
        place
            .run(&format!("render room.pbrt --part 0/2 {kept}"))
            .expect(0);
    }
}

#[test]
fn flags_take_precedence_over_the_environment() {
    let place = Workplace::new();
    let spp = |arguments: &str, value: &str| {
        let mut command = place.command(arguments);
        Ran::of(command.env("BIDIR_SPP", value))
    };
    spp("render room.pbrt", "3")
        .expect(0)
        .says("3 samples per pixel");
    spp("render room.pbrt --spp 1", "3")
        .expect(0)
        .says("1 sample per pixel");
    spp("render room.pbrt", "many").expect(2).says("BIDIR_SPP");
    let mut command = place.command("render room.pbrt");
    Ran::of(command.env("BIDIR_ISA", "neon"))
        .expect(2)
        .says("scalar");
}

#[test]
fn unreadable_and_unwritable_files_exit_with_4_before_rendering() {
    check("render missing.pbrt", 4, "missing.pbrt");
    check("info missing.pbrt", 4, "missing.pbrt");
    check("compare missing.exr missing.exr", 4, "missing.exr");
    check("compare room.pbrt room.pbrt", 4, "room.pbrt");
    let far = "--spp 1000000000";
    for (flag, file) in [
        ("--output", "missing/room.exr"),
        ("--stats", "missing/a.json"),
        ("--checkpoint", "missing/a.film"),
        ("--replay 1,1,0 --svg", "missing/a.svg"),
    ] {
        let render = format!("render room.pbrt {far} {flag} {file}");
        let ran = Workplace::new().run(&render).expect(4).says(file);
        let flag = flag.split(' ').next_back().unwrap();
        let elsewhere =
            format!("hint: make the folder `missing`, or write elsewhere with {flag}\n");
        ran.says("no such folder\n").says(&elsewhere);
    }
    let place = Workplace::new();
    fs::create_dir(place.path("out")).unwrap();
    place
        .run(&format!("render room.pbrt {far} -o out"))
        .expect(4)
        .says(
            "error: cannot write `out`: it is a folder\nhint: name a file, such as out/NAME.exr\n",
        );
    fs::create_dir(place.path("folder.exr")).unwrap();
    place
        .run(&format!("render room.pbrt {far} -o folder.exr"))
        .expect(4)
        .says("is a folder");
}

#[test]
fn strict_makes_warnings_errors() {
    let place = Workplace::new();
    let light = "render room.pbrt --integrator light --shadow-rays per-pair";
    place
        .run(light)
        .expect(0)
        .says("warning: --shadow-rays has no effect");
    place
        .run(&format!("{light} --strict"))
        .expect(6)
        .says("--strict");
    place.run("render room.pbrt --strict").expect(0);
    place
        .run("render room.pbrt --crop 8,8,99,9")
        .expect(0)
        .says("warning: the crop reaches beyond");
}

#[test]
fn a_scene_without_light_is_a_warning() {
    let place = Workplace::new();
    place.write_dark();
    let message = "warning: the scene has no light: the image will be black";
    place.run("render dark.pbrt").expect(0).says(message);
    let strict = place.run("render dark.pbrt --strict").expect(6);
    strict
        .says(message)
        .says("1 warning, an error under --strict");
}

/// Checks that the error of a scene of `scenes/broken` has its place.
#[track_caller]
fn check_broken(name: &str, says: &str) {
    let scene = scenes().join("broken").join(name);
    let mut command = Workplace::new().command("render");
    let ran = Ran::of(command.current_dir(std::env::temp_dir()).arg(&scene))
        .expect(3)
        .says(says);
    ran.says(&format!("{name}:")).says("╭─[");
}

#[test]
fn broken_scenes_exit_with_3_and_show_the_place() {
    check_broken("huge-film.pbrt", "1000000");
    check_broken("missing-mesh.pbrt", "no-such-mesh.ply");
    check_broken("misspelt-material.pbrt", "did you mean `diffuse`?");
    check_broken("nan-vertex.pbrt", "nan-vertex.ply");
    check_broken(
        "unclosed-string.pbrt",
        "12:10: the string has no closing quote; write `\"diffuse\"`",
    );
}

#[test]
fn a_film_beyond_memory_is_an_error_of_the_scene() {
    let message = "a film of 65536 x 65536 pixels is too large";
    let of_flag = format!("error: --size: {message}");
    check("render room.pbrt --size 65536x65536", 3, &of_flag);
    let place = Workplace::new();
    for (name, [width, height], place_of_size) in [
        ("square", [65536, 65536], "4:34"),
        ("wide", [65536, 60000], "4:34"),
        ("high", [60000, 65536], "4:62"),
    ] {
        let scene = crate::common::SCENE
            .replace("xresolution\" 24", &format!("xresolution\" {width}"))
            .replace("yresolution\" 16", &format!("yresolution\" {height}"));
        place.write(&format!("{name}.pbrt"), &scene);
        let says = format!(
            "error: {name}.pbrt:{place_of_size}: a film of {width} x {height} pixels is too large"
        );
        for command in ["render", "reference"] {
            let ran = place.run(&format!("{command} {name}.pbrt")).expect(3);
            ran.says(&says)
                .says("make it smaller with --size")
                .says("╭─[");
        }
        place
            .run(&format!("render {name}.pbrt --size 8x8 -o a.exr"))
            .expect(0);
    }
    let gltf = r#"{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"camera": 0}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 1, "aspectRatio": 900, "znear": 1}}]}"#;
    place.write("wide.gltf", gltf);
    place
        .run("render wide.gltf --pyramid out --strategy-layers 16 --integrator bdpt")
        .expect(3)
        .says("error: wide.gltf: cameras[0]: a film of 8192 x 720 pixels is too large");
}

#[test]
fn colour_depends_on_flags_and_environment() {
    let place = Workplace::new();
    let mut command = place.command("render missing.pbrt");
    let plain = Ran::of(command.env_remove("FORCE_COLOR"));
    assert!(!plain.stderr.contains('\x1b'));
    let mut command = place.command("render missing.pbrt");
    command
        .env("FORCE_COLOR", "1")
        .env_remove("NO_COLOR")
        .env("TERM", "xterm");
    Ran::of(&mut command).says("\x1b[");
    let ran = Ran::of(command.arg("--no-color"));
    assert!(!ran.stderr.contains('\x1b'));
}

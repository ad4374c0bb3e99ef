use crate::common::{Ran, Workplace};

#[test]
fn the_image_has_the_name_of_the_scenes_film_and_a_png_beside_it() {
    let place = Workplace::new();
    let ran = place
        .run("render room.pbrt")
        .expect(0)
        .says("\nwrote room.exr and room.png\n2 samples per pixel in ");
    assert_eq!(ran.stdout, "");
    assert!(!ran.stderr.contains("error"), "{}", ran.stderr);
    assert!(place.path("room.exr").exists() && place.path("room.png").exists());
}

#[test]
fn quiet_is_silent_and_a_png_may_be_the_only_output() {
    let place = Workplace::new();
    let ran = place.run("render room.pbrt -q -o alone.png").expect(0);
    assert_eq!(ran.stdout + &ran.stderr, "");
    assert!(place.path("alone.png").exists() && !place.path("alone.exr").exists());
}

#[test]
fn progress_without_a_terminal_has_whole_lines() {
    let ran = Workplace::new()
        .run("render room.pbrt --time 1500ms")
        .expect(2);
    assert!(!ran.stderr.contains('\r'));
    let ran = Workplace::new()
        .run("render room.pbrt --time 1.3 --threads 1")
        .expect(0)
        .says("Progress: ");
    assert!(!ran.stderr.contains('\r') && !ran.stderr.contains('\x1b'));
}

#[test]
fn the_summary_has_files_samples_and_error() {
    let place = Workplace::new();
    let last = |flags: &str, lines: usize| {
        let ran = place.run(&format!("render room.pbrt {flags}")).expect(0);
        let all: Vec<_> = ran.stderr.lines().map(str::to_owned).collect();
        all[all.len() - lines..].join("\n")
    };
    let text = last("--spp 16 --stats s.json --crop 0,0,12,8", 2);
    let expected =
        "wrote room.exr, room.png and s.json\n16 samples per pixel of a crop of 12x8 pixels in ";
    assert!(text.starts_with(expected), "{text}");
    assert!(text.contains(", relative error "), "{text}");
    let text = last("--integrator auto -o auto.png", 3);
    assert!(
        text.starts_with("wrote auto.png\n2 samples per pixel in "),
        "{text}"
    );
    assert!(text.contains("\nauto chose --integrator "), "{text}");
    let text = last("--passes 4..6 --checkpoint part.film", 2);
    let expected = "wrote part.film\n2 samples per pixel (passes 4..6) in ";
    assert!(text.starts_with(expected), "{text}");
    let text = last("--passes 4..6 --checkpoint part.film --resume", 1);
    assert!(text.contains(", all of them from the checkpoint"), "{text}");
    let text = last("--spp 5 --checkpoint all.film", 1);
    assert!(text.starts_with("5 samples per pixel in "), "{text}");
    let text = last("--spp 7 --checkpoint all.film --resume", 1);
    assert!(
        text.starts_with("7 samples per pixel, 2 of them in "),
        "{text}"
    );
}

/// A scene of one triangle.
const GLTF: &str = r#"{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
"nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
"min": [-1, -1, 0], "max": [1, 1, 0]}],
"bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"byteLength": 36,
"uri": "data:application/octet-stream;base64,AACAvwAAgL8AAAAAAACAPwAAgL8AAAAAAAAAAAAAgD8AAAAA"}]}"#;

#[test]
fn a_gltf_file_is_rendered_with_auto_unless_another_integrator_is_named() {
    let place = Workplace::new();
    place.write("room.gltf", GLTF);
    let render = "render room.gltf --size 16x12 --spp 1";
    place.run(render).expect(0).says("auto chose ");
    let check = |integrator: &str| {
        assert_eq!(place.attributes("room.exr")["bidir/integrator"], integrator);
    };
    place.run(&format!("{render} --integrator light")).expect(0);
    check("light");
    Ran::of(place.command(render).env("BIDIR_INTEGRATOR", "bdpt")).expect(0);
    check("bdpt");
}

#[test]
fn the_integrator_of_a_scene_has_the_defaults_of_the_flag() {
    let place = Workplace::new();
    place.write("room.gltf", GLTF);
    let scene = place.read("room.pbrt");
    place.write("path.pbrt", &scene.replace("\"bdpt\"", "\"path\""));
    for (file, integrator) in [
        ("room.gltf", "auto"),
        ("room.pbrt", "bdpt"),
        ("path.pbrt", "path"),
    ] {
        let identity = |flag: &str| {
            let render = format!("render {file} --size 16x12 --spp 1 -o a.exr {flag}");
            place.run(&render).expect(0);
            place.attributes("a.exr")["bidir/identity"].clone()
        };
        let named = identity(&format!("--integrator {integrator}"));
        assert_eq!(identity(""), named, "{file}");
    }
}

#[test]
fn a_scene_with_path_gets_a_hint_at_auto_if_light_is_missing() {
    const NOTE: &str = "note: rendered with `path`, as the scene asks; try --integrator auto";
    let place = Workplace::new();
    let path = crate::common::SCENE.replace("Integrator \"bdpt\"", "Integrator \"volpath\"");
    place.write("path.pbrt", &path);
    let glass = "WorldBegin\nMaterial \"dielectric\"\nShape \"sphere\" \"float radius\" .1\n";
    place.write("glass.pbrt", &path.replace("WorldBegin", glass));
    place.run("render glass.pbrt").expect(0).says(NOTE);
    for silent in [
        "glass.pbrt -q",
        "glass.pbrt --integrator path",
        "glass.pbrt --integrator auto",
        "path.pbrt",
        "room.pbrt",
    ] {
        let ran = place.run(&format!("render {silent}")).expect(0);
        assert!(!ran.stderr.contains("note:"), "{silent}: {}", ran.stderr);
    }
}

#[test]
fn older_names_are_accepted_with_a_warning() {
    let place = Workplace::new();
    let lvc = "render room.pbrt --integrator lvc -q";
    let today = format!("{lvc} --light-start power --shadow-rays auto -o a.exr");
    assert_eq!(place.run(&today).expect(0).stderr, "");
    let older = format!("{lvc} --emission power --shadow-rays suited -o b.exr");
    let ran = place.run(&older).expect(0);
    assert_eq!(
        ran.stderr,
        "warning: --emission is now --light-start\nwarning: the value `suited` is now `auto`\n"
    );
    place.run("compare a.exr b.exr --exact").expect(0);
}

/// Checks that two commands give the same bits.
#[track_caller]
fn check_same(place: &Workplace, a: &str, b: &str) {
    place
        .run(&format!("render room.pbrt -o a.exr {a}"))
        .expect(0);
    place
        .run(&format!("render room.pbrt -o b.exr {b}"))
        .expect(0);
    place.run("compare a.exr b.exr --exact").expect(0);
}

#[test]
fn threads_instructions_and_spellings_do_not_change_bits() {
    let place = Workplace::new();
    check_same(&place, "--threads 1", "--nthreads 2");
    for isa in accel::Isa::supported() {
        check_same(&place, &format!("--isa {isa}"), "");
    }
    check_same(&place, "--crop 4,2,20,10", "--pixelbounds 4,20,2,10");
    check_same(
        &place,
        "--crop 6,4,18,12",
        "--cropwindow 0.25,0.75,0.25,0.75",
    );
    check_same(&place, "--seed 0", "");
    let mut command = place.command("render room.pbrt --outfile b.exr --seed 0");
    Ran::of(command.env("BIDIR_ISA", "scalar").env("BIDIR_SEED", "7")).expect(0);
    place.run("compare a.exr b.exr --exact").expect(0);
}

#[test]
fn settings_change_the_image() {
    let place = Workplace::new();
    place.run("render room.pbrt -q -o a.exr").expect(0);
    for setting in [
        "--seed 1",
        "--sampler independent",
        "--integrator path",
        "--integrator lvc",
        "--integrator auto",
        "--integrator lvc --proposal uniform",
        "--integrator lvc --samples-per-subpath 4",
        "--integrator lvc --next-events 1",
        "--integrator lvc --light-start power",
        "--integrator lvc --candidates 8",
        "--integrator lvc --shadow-rays budget:2",
        "--mis uniform",
        "--max-depth 1",
        "--strategies all,-s0",
        "--light-point shared",
        "--light-choice power",
        "--path-roulette off",
        "--shadow-rays budget:2",
        "--spp 3",
    ] {
        place
            .run(&format!("render room.pbrt -q -o b.exr {setting}"))
            .expect(0);
        place.run("compare a.exr b.exr --exact").expect(6);
    }
}

#[test]
fn the_first_limit_of_time_and_samples_ends_a_render() {
    let place = Workplace::new();
    place
        .run("render room.pbrt --time 1h --spp 3")
        .expect(0)
        .says("3 samples per pixel");
    place
        .run("render room.pbrt --time 0.000001 --spp 3")
        .expect(7)
        .says("no pass was complete after ");
    let start = std::time::Instant::now();
    place
        .run("render room.pbrt --time 0.3 --threads 1")
        .expect(0);
    assert!((0.2..5.0).contains(&start.elapsed().as_secs_f64()));
}

#[test]
fn statistics_have_settings_times_and_rays() {
    let place = Workplace::new();
    let arguments = "--stats s.json --shadow-rays ray-roulette:0.2 --crop 1,2,9,10";
    place
        .run(&format!("render room.pbrt --spp 7 --threads 1 {arguments}"))
        .expect(0);
    let stats: serde_json::Value = serde_json::from_str(&place.read("s.json")).unwrap();
    let number = |path: &str| stats.pointer(path).unwrap().as_f64().unwrap();
    assert_eq!(stats["settings"]["shadow_rays"], "ray-roulette:0.2");
    assert_eq!(stats["settings"]["integrator"], "bdpt");
    assert_eq!(stats["crop"], serde_json::json!([1, 2, 9, 10]));
    assert_eq!(stats["resolution"], serde_json::json!([24, 16]));
    assert_eq!((number("/spp") as u64, number("/threads") as u64), (7, 1));
    assert_eq!(number("/samples") as u64, 7 * 64);
    let kinds = ["camera", "light", "connection", "light_image"];
    let sum: f64 = kinds
        .iter()
        .map(|kind| number(&format!("/rays/{kind}")))
        .sum();
    assert_eq!(sum as u64, number("/rays/total") as u64);
    assert!(number("/rays/training") > 0.0 && number("/candidates") > 0.0);
    // One of seven batches.
    assert_eq!(number("/stages/measured_samples") as u64, 64);
    let stages = stats["stages"]["parts"].as_array().unwrap();
    let shares = stages.iter().map(|part| part["share"].as_f64().unwrap());
    assert!((shares.sum::<f64>() - 1.0).abs() < 1e-9);
    assert_eq!(stages[0]["stage"], "walk");
    assert!(number("/seconds") > 0.0 && number("/load_seconds") > 0.0);
    let per_sample = number("/rays/connection") / number("/samples");
    assert!((number("/connection_rays_per_sample") - per_sample).abs() < 1e-9);
    assert!(stats["dropped_list"].is_array() && stats["connection_blocked"].is_u64());
    let training = |kind| number(&format!("/training/rays/{kind}")) as u64;
    assert_eq!(kinds.map(training).iter().sum::<u64>(), training("total"));
    assert_eq!(training("total"), number("/rays/training") as u64);
    let threshold = 0.2 * number("/training/mean_luminance");
    assert!((number("/training/threshold") - threshold).abs() < 1e-5 * threshold);
}

#[test]
fn statistics_have_the_counts_of_each_strategy() {
    let place = Workplace::new();
    let arguments = "--stats s.json --shadow-rays per-camera-vertex --spp 4";
    place
        .run(&format!("render room.pbrt {arguments}"))
        .expect(0);
    let stats: serde_json::Value = serde_json::from_str(&place.read("s.json")).unwrap();
    let rows = stats["strategies"].as_array().unwrap();
    let sum = |count: &str, is_counted: &dyn Fn(u64, u64) -> bool| {
        let number = |row: &serde_json::Value, key: &str| row[key].as_u64().unwrap();
        let rows = rows
            .iter()
            .filter(|row| is_counted(number(row, "s"), number(row, "t")));
        rows.map(|row| number(row, count)).sum::<u64>()
    };
    let number = |path: &str| stats.pointer(path).unwrap().as_u64().unwrap();
    let is_connection = |s: u64, t: u64| s >= 1 && t >= 2;
    for (count, total) in [
        ("candidates", "/candidates"),
        ("traced", "/rays/connection"),
        ("blocked", "/connection_blocked"),
    ] {
        assert_eq!(sum(count, &is_connection), number(total), "{count}");
    }
    let is_light_image = |_, t: u64| t == 1;
    assert_eq!(sum("traced", &is_light_image), number("/rays/light_image"));
    assert_eq!(
        sum("blocked", &is_light_image),
        number("/light_image_blocked")
    );
    let is_hit = |s: u64, _| s == 0;
    assert!(sum("candidates", &is_hit) > 0 && sum("traced", &is_hit) == 0);
    assert_eq!(number("/longer_paths/candidates"), 0);
}

#[test]
fn the_image_has_attributes_of_its_render() {
    let place = Workplace::new();
    std::fs::create_dir(place.path("scenes")).unwrap();
    place.write("scenes/room.pbrt", crate::common::SCENE);
    let render = "render scenes/room.pbrt --seed 1234567 --shadow-rays per-pair";
    place.run(render).expect(0);
    let attributes = place.attributes("room.exr");
    for (name, value) in [
        ("samplesPerPixel", "2"),
        ("bidir/version", env!("CARGO_PKG_VERSION")),
        ("bidir/scene", "room.pbrt"),
        ("bidir/integrator", "bdpt"),
        ("bidir/shadow-rays", "per-pair"),
        ("bidir/max-depth", "4"),
        ("bidir/seed", "1234567"),
        ("bidir/size", "24 x 16"),
        ("bidir/crop", "0,0,24,16"),
        ("bidir/passes", "0..2"),
        ("bidir/stopping", "fixed"),
        ("bidir/samples", "768"),
        ("bidir/dropped", "0"),
    ] {
        assert_eq!(attributes[name], value, "{name}");
    }
    let number = |name: &str| attributes[name].parse::<f64>().unwrap();
    assert!(number("renderTimeSeconds") > 0.0 && number("bidir/rays.connection") > 0.0);
    let own = attributes.keys().filter(|name| name.starts_with("bidir/"));
    for name in own {
        assert!(!name.contains(['_', ' ']), "{name}");
    }
}

#[test]
fn dropped_samples_cause_a_warning() {
    let place = Workplace::new();
    let mut command = place.command("render room.pbrt --passes 1..2 --checkpoint a.film");
    Ran::of(command.env("BIDIR_SPP", "9"))
        .expect(0)
        .says("BIDIR_SPP has no effect where --passes is given");
    place
        .run("render room.pbrt --passes 1..2 --spp 9 --strict -o a.exr")
        .expect(6)
        .says("--spp has no effect");
    place
        .run("render room.pbrt --part 0/2 --spp 9 --strict -o a.exr")
        .expect(0);
}

#[test]
fn a_scene_may_come_from_standard_input() {
    let place = Workplace::new();
    let mut command = place.command("render - -o stdin.exr");
    command.stdin(std::fs::File::open(place.path("room.pbrt")).unwrap());
    Ran::of(&mut command).expect(0);
    assert!(place.path("stdin.exr").exists());
}

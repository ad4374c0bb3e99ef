use crate::common::{Ran, Workplace};

#[test]
fn the_image_has_the_name_that_the_scene_says_and_a_picture_beside_it() {
    let place = Workplace::new();
    let ran = place
        .run("render room.pbrt")
        .expect(0)
        .says("2 spp")
        .says("wrote room.exr, room.png");
    assert_eq!(ran.stdout, "");
    assert!(place.path("room.exr").exists() && place.path("room.png").exists());
}

#[test]
fn quiet_is_silent_and_a_picture_may_stand_alone() {
    let place = Workplace::new();
    let ran = place.run("render room.pbrt -q -o alone.png").expect(0);
    assert_eq!(ran.stdout + &ran.stderr, "");
    assert!(place.path("alone.png").exists() && !place.path("alone.exr").exists());
}

#[test]
fn lines_of_progress_end_where_no_terminal_listens() {
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

/// Checks that two ways to render give the same bits.
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
fn threads_instructions_and_spellings_do_not_change_a_bit() {
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
        "--integrator lvc --emission power",
        "--integrator lvc --candidates 8 --mis-count correlated",
        "--integrator lvc --shadow-rays budget:2 --mis-count resampled",
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
fn time_or_samples_end_a_render_whichever_is_first() {
    let place = Workplace::new();
    place
        .run("render room.pbrt --time 1h --spp 3")
        .expect(0)
        .says("3 spp");
    place
        .run("render room.pbrt --time 0.000001 --spp 3")
        .expect(0)
        .says("1 spp");
    let start = std::time::Instant::now();
    place
        .run("render room.pbrt --time 0.3 --threads 1")
        .expect(0);
    assert!((0.2..5.0).contains(&start.elapsed().as_secs_f64()));
}

#[test]
fn statistics_tell_settings_times_and_rays() {
    let place = Workplace::new();
    let arguments = "--stats s.json --shadow-rays ray-roulette:0.2 --crop 1,2,9,10 --threads 1";
    place
        .run(&format!("render room.pbrt {arguments}"))
        .expect(0);
    let stats: serde_json::Value = serde_json::from_str(&place.read("s.json")).unwrap();
    let number = |path: &str| stats.pointer(path).unwrap().as_f64().unwrap();
    assert_eq!(stats["settings"]["shadow_rays"], "ray-roulette:0.2");
    assert_eq!(stats["settings"]["integrator"], "bdpt");
    assert_eq!(stats["crop"], serde_json::json!([1, 2, 9, 10]));
    assert_eq!(stats["resolution"], serde_json::json!([24, 16]));
    assert_eq!((number("/spp") as u64, number("/threads") as u64), (2, 1));
    assert_eq!(number("/samples") as u64, 2 * 64);
    let kinds = ["camera", "light", "connection", "light_image"];
    let sum: f64 = kinds
        .iter()
        .map(|kind| number(&format!("/rays/{kind}")))
        .sum();
    assert_eq!(sum as u64, number("/rays/total") as u64);
    assert!(number("/rays/training") > 0.0 && number("/candidates") > 0.0);
    assert_eq!(number("/stages/measured_samples") as u64, 2 * 64 / 61);
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
fn statistics_tell_what_became_of_each_strategy() {
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
fn the_image_says_how_it_was_made() {
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
fn samples_that_do_not_count_are_told() {
    let place = Workplace::new();
    let mut command = place.command("render room.pbrt --passes 1..2 --checkpoint a.film");
    Ran::of(command.env("BIDIR_SPP", "9"))
        .expect(0)
        .says("BIDIR_SPP has no influence where --passes is given");
    place
        .run("render room.pbrt --passes 1..2 --spp 9 --strict -o a.exr")
        .expect(6)
        .says("--spp has no influence");
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

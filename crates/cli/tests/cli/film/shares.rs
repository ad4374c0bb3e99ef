//! Parts of a render: merged, missing, refused and continued.

use crate::common::Workplace;
use std::fs;

#[test]
fn parts_merged_in_any_order_equal_the_whole() {
    let place = Workplace::new();
    for estimator in ["path", "light", "bdpt", "bdpt --shadow-rays ray-roulette"] {
        let render = format!("render room.pbrt --integrator {estimator} --spp 7 -q");
        place.run(&format!("{render} -o whole.exr")).expect(0);
        for (parts, order) in [
            (1, vec![0]),
            (3, vec![2, 0, 1]),
            (7, vec![3, 6, 0, 5, 1, 4, 2]),
        ] {
            let mut films = String::new();
            for part in order {
                let film = format!("{parts}-{part}.film");
                let share = format!("{render} --part {part}/{parts} --checkpoint {film} --restart");
                place.run(&share).expect(0);
                films = films + " " + &film;
            }
            place
                .run(&format!("merge{films} -o all.film --image all.exr"))
                .expect(0);
            place.expect_same("all.exr", "whole.exr");
        }
        // The film of the next estimator does not replace it.
        fs::remove_file(place.path("all.film")).unwrap();
    }
    // A part writes no image that others would overwrite.
    assert!(!place.path("room.exr").exists());
}

#[test]
fn a_merge_into_one_of_its_films_can_be_repeated() {
    let place = Workplace::new();
    for (passes, film) in [("0..1", "a"), ("1..2", "b"), ("2..3", "c")] {
        place.render_share(passes, &format!("{film}.film"));
    }
    place.run("merge -o whole.film a.film b.film").expect(0);
    // In any order, and by any name.
    for films in [
        "c.film whole.film",
        "./whole.film c.film",
        "a.film c.film whole.film",
    ] {
        let merge = format!("merge -o whole.film {films} --image whole.exr");
        place.run(&merge).expect(0).says("passes 0..3 of ");
        let film = fs::read(place.path("whole.film")).unwrap();
        let again = place.run(&merge).expect(0);
        again.says("passes 0..3 of ").says("of them merged before");
        assert!(
            fs::read(place.path("whole.film")).unwrap() == film,
            "{films}"
        );
    }
    place
        .run("render room.pbrt -q --spp 3 -o undivided.exr")
        .expect(0);
    place.expect_same("whole.exr", "undivided.exr");
}

/// Training takes at most a tenth of the time, and no part of the passes: those of a render can be split.
#[test]
fn films_keep_the_training_that_they_began_with() {
    let place = Workplace::new();
    let render = "render room.pbrt -q --integrator lvc";
    let run = |flags: &str| place.run(&format!("{render} {flags}")).expect(0);
    let training = |film: &str| {
        let info = place.run(&format!("film info {film} --json")).expect(0);
        info.json()["settings"]["training"].clone()
    };
    run("--spp 4 -o whole.exr --checkpoint whole.film");
    assert!(training("whole.film").is_null());
    run("--passes 0..3 --checkpoint a.film");
    run("--passes 3..4 --checkpoint b.film");
    let merge = "merge a.film b.film -o parts.film --image parts.exr";
    place.run(merge).expect(0);
    place.expect_same("whole.exr", "parts.exr");
    // In hardly more time than a pass takes, training is short.
    let in_time = |exponent: i32| {
        let time = 0.01 * f64::from(1 << exponent);
        let flags = format!("--time {time} --spp 4 --checkpoint c.film");
        let ran = place.run(&format!("{render} {flags}"));
        ran.code == Some(0)
    };
    assert!((0..14).any(in_time));
    let short = training("c.film");
    assert!(short.is_string(), "{short}");
    // Whatever the time of later runs, they repeat the training of the first.
    for later in ["--spp 4", "--spp 6 --time 99"] {
        run(&format!("{later} --checkpoint c.film --resume"));
        assert_eq!(training("c.film"), short, "{later}");
    }
}

#[test]
fn an_image_has_the_attributes_of_all_runs_by_any_command() {
    let place = Workplace::new();
    let render = "render room.pbrt -q --shadow-rays ray-roulette --checkpoint a.film --resume";
    let seconds = || {
        let info = place.run("film info a.film --json").expect(0).json();
        info["seconds"].as_f64().unwrap()
    };
    place.run(&format!("{render} --spp 2 -o a.exr")).expect(0);
    let first = (place.attributes("a.exr"), seconds());
    place.run(&format!("{render} --spp 5 -o a.exr")).expect(0);
    let attributes = place.attributes("a.exr");
    assert!(seconds() > first.1);
    assert_eq!(
        attributes["renderTimeSeconds"],
        (seconds() as f32).to_string()
    );
    let number = |name: &str| attributes[name].parse::<u64>().unwrap();
    assert_eq!(number("bidir/samples"), 5 * 24 * 16);
    // Both runs were trained.
    let training: u64 = first.0["bidir/rays.training"].parse().unwrap();
    assert_eq!(number("bidir/rays.training"), 2 * training);
    assert!(attributes.contains_key("bidir/trained-mean"));

    let image = fs::read(place.path("a.exr")).unwrap();
    place.run("film develop a.film -o b.exr").expect(0);
    assert!(fs::read(place.path("b.exr")).unwrap() == image);
    place.run("merge a.film -o c.film --image c.exr").expect(0);
    assert!(fs::read(place.path("c.exr")).unwrap() == image);
    // If nothing is left to do, the image is also that of the film file.
    place.run(&format!("{render} --spp 5 -o d.exr")).expect(0);
    assert!(fs::read(place.path("d.exr")).unwrap() == image);
}

#[test]
fn an_image_has_the_settings_of_its_render() {
    let place = Workplace::new();
    let attributes = |flags: &str| {
        let command = format!("render room.pbrt -q --spp 1 -o a.exr {flags}");
        place.run(&command).expect(0);
        place.attributes("a.exr")
    };
    let lvc = attributes("--integrator lvc --candidates 5,2");
    assert_eq!(lvc["bidir/candidates"], "5,2");
    assert!(!lvc.contains_key("bidir/plan"));
    let auto = attributes("--integrator auto");
    assert_eq!(auto["bidir/candidates"], "auto");
    assert!(auto["bidir/plan"].contains("albedo"), "{auto:?}");
}

#[test]
fn noise_ends_a_render() {
    let place = Workplace::new();
    let render = "render room.pbrt -q --noise 0.1 --checkpoint a.film";
    place.run(render).expect(0);
    let info = place.run("film info a.film --json").expect(0).json();
    assert_eq!(info["stopping"], "noise");
    // An interrupted and continued render ends after the same passes.
    place
        .run("render room.pbrt -q --spp 5 --checkpoint b.film")
        .expect(0);
    place
        .run("render room.pbrt -q --noise 0.1 --checkpoint b.film --resume")
        .expect(0);
    let again = place.run("film info b.film --json").expect(0).json();
    assert_eq!(info["passes"], again["passes"]);
}

#[test]
fn a_black_picture_has_no_noise() {
    let place = Workplace::new();
    place.write_dark();
    for integrator in ["path", "bdpt", "lvc"] {
        let render = format!("render dark.pbrt --integrator {integrator} --noise 0.5 --spp 99");
        place
            .run(&render)
            .expect(0)
            .says("16 of 99 samples per pixel");
    }
}

#[test]
fn a_run_without_a_complete_pass_leaves_the_film() {
    let place = Workplace::new();
    let render = "render room.pbrt -q --checkpoint a.film --resume";
    place.run(&format!("{render} --spp 2")).expect(0);
    let files = place.names();
    let before = fs::read(place.path("a.film")).unwrap();
    place
        .run(&format!("{render} --spp 3 --time 0.000001"))
        .expect(7)
        .says("no further pass was complete after ");
    assert_eq!(place.names(), files);
    assert!(fs::read(place.path("a.film")).unwrap() == before);
    // A film that is complete needs no time.
    place
        .run(&format!("{render} --spp 2 --time 0.000001"))
        .expect(0);
}

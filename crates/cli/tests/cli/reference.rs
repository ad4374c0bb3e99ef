use crate::common::{Ran, Workplace};
use serde_json::Value;
use std::fs;

fn provenance(place: &Workplace, folder: &str) -> Value {
    serde_json::from_str(&place.read(&format!("{folder}/provenance.json"))).unwrap()
}

#[test]
fn two_estimators_make_a_reference_that_images_are_compared_with() {
    let place = Workplace::new();
    place
        .run("reference room.pbrt --spp 100")
        .expect(0)
        .says("bdpt, 112 samples per pixel; agrees with path, 112 samples per pixel (p = ")
        .says("level 0.001); wrote room.reference")
        .says("of the film's mean would be detected with even odds");
    assert_eq!(place.names(), ["room.pbrt", "room.reference"]);
    let json = provenance(&place, "room.reference");
    assert_eq!(json["agreement"]["agree"], true);
    assert_eq!(json["agreement"]["replicates"], 16);
    assert_eq!(json["resolution"], serde_json::json!([24, 16]));
    assert_eq!(json["estimators"][1]["settings"]["integrator"], "path");
    assert_eq!(json["estimators"][0]["settings"]["sampler"], "independent");
    assert_eq!(json["estimators"][0]["settings"]["max-depth"], "4");
    assert!(json["estimators"][0]["seconds"].as_f64().unwrap() > 0.0);
    assert!(json["estimators"][0]["rays"]["light"].as_u64().unwrap() > 0);
    let picture = "room.reference/picture.exr";
    assert_eq!(place.attributes(picture)["samplesPerPixel"], "112");
    place
        .run(
            "film verify room.reference/films/picture-00.film room.reference/films/against-15.film",
        )
        .expect(0);
    // The folder stands for its picture.
    place
        .run(&format!(
            "compare {picture} --reference room.reference --exact"
        ))
        .expect(0);
    let other = place
        .run("compare room.reference/against.exr room.reference --json")
        .expect(0)
        .json();
    assert!(other["rmse"].as_f64().unwrap() > 0.0);
    assert!(other["z_test"]["blocks"]["p"].as_f64().unwrap() > 1e-3);
}

/// Naming the default estimators makes the same reference.
#[test]
fn the_default_estimators_may_be_named() {
    let place = Workplace::new();
    let make = |flags: &str| place.run(&format!("reference room.pbrt --spp 16 {flags}"));
    make("").expect(0);
    make("--estimator bdpt --against path").expect(0);
    make("--estimator lvc -o lvc.reference")
        .expect(0)
        .says("lvc, 16 samples per pixel");
}

#[test]
fn a_difference_is_tested_if_both_images_have_variances() {
    let place = Workplace::new();
    let image = |name: &str, flags: &str| {
        let flags = format!("render room.pbrt -q -o {name} --sampler independent {flags}");
        place.run(&flags).expect(0);
    };
    let layers = "--aov variance,samples --spp 256";
    image("a.exr", layers);
    image("b.exr", &format!("{layers} --seed 1 --integrator path"));
    image("c.exr", &format!("{layers} --seed 2 --max-depth 1"));
    image("d.exr", "--spp 4");
    let p = |images: &str, test: &str| {
        let json = place.run(&format!("compare {images} --json")).expect(0);
        json.json()["z_test"][test]["p"].as_f64()
    };
    assert!(p("a.exr b.exr", "blocks").unwrap() > 1e-3);
    for test in ["pixels", "blocks"] {
        assert!(p("a.exr c.exr", test).unwrap() < 1e-3, "{test}");
    }
    assert_eq!(p("a.exr d.exr", "pixels"), None);
    place
        .run("compare a.exr c.exr")
        .expect(0)
        .prints("z_blocks     p ")
        .prints(" standard errors");
    // There is a warning about the test of blocks only if pixels share light subpaths.
    for (name, integrator) in [("e.exr", "lvc"), ("f.exr", "auto")] {
        image(
            name,
            &format!("{layers} --seed 3 --integrator {integrator}"),
        );
        let shared = format!("`{name}` share light subpaths by `{integrator}`");
        let is_warned = |images: &str| {
            let run = place.run(&format!("compare {images}")).expect(0);
            run.stderr.contains(&shared)
        };
        assert!(is_warned(&format!("{name} a.exr")) && is_warned(&format!("a.exr {name}")));
        assert!(!is_warned("a.exr b.exr") && !is_warned(&format!("{name} d.exr")));
    }
}

#[test]
fn more_samples_are_added_to_the_same_bits() {
    let place = Workplace::new();
    let film = "--size 12x8 --crop 2,1,10,7";
    let estimators = ["--estimator", "bdpt --strategies all,-s0 --seed 3"];
    let reference = |arguments: &str| {
        let mut command = place.command(&format!("reference room.pbrt -q {arguments}"));
        let output = command.args(estimators).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{output:?}");
    };
    reference(&format!("-o a.reference {film} --spp 48"));
    reference(&format!("-o b.reference {film} --spp 16"));
    place
        .run("reference room.pbrt -o b.reference --extend 32")
        .expect(0);
    let [a, b] = ["a.reference", "b.reference"].map(|name| provenance(&place, name));
    for key in ["picture", "agreement", "crop", "resolution", "scene_digest"] {
        assert_eq!(a[key], b[key], "{key}");
    }
    for index in [0, 1] {
        let [a, b] = [&a, &b].map(|json| &json["estimators"][index]);
        for key in ["settings", "spp", "first_seed", "rays"] {
            assert_eq!(a[key], b[key], "{key}");
        }
    }
    assert_eq!(a["estimators"][0]["seed"], 3);
    assert_eq!(a["estimators"][0]["settings"]["strategies"], "all,-s0");
    // The same number of samples needs no work, fewer are refused.
    reference(&format!("-o b.reference {film} --spp 48"));
    assert_eq!(provenance(&place, "b.reference")["picture"], a["picture"]);
    place
        .run("reference room.pbrt -o b.reference --spp 16 --size 12x8 --crop 2,1,10,7 --estimator bdpt")
        .expect(5)
        .says("picture-00.film is the film of another render: seed is");
}

#[test]
fn disagreeing_estimators_are_written_and_refused() {
    let place = Workplace::new();
    let mut command = place.command("reference room.pbrt --spp 64 --against");
    let output = command.arg("path --max-depth 1").output().unwrap();
    let messages = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(6), "{messages}");
    assert!(
        messages.contains("the estimators disagree, most in"),
        "{messages}"
    );
    assert_eq!(
        provenance(&place, "room.reference")["agreement"]["agree"],
        false
    );
    let picture = "room.reference/picture.exr";
    place
        .run(&format!("compare {picture} --reference room.reference"))
        .expect(6)
        .says("room.reference: refused: its estimators disagree");
    // Other estimators need --restart.
    place
        .run("reference room.pbrt --spp 16")
        .expect(5)
        .says("--restart");
    place
        .run("reference room.pbrt --spp 64 --restart")
        .expect(0);
    place
        .run(&format!("compare {picture} --reference room.reference"))
        .expect(0);
    place
        .run("reference room.pbrt --spp 32")
        .expect(5)
        .says("has 64 samples per pixel already, more than the 32");
}

#[test]
fn stale_and_damaged_references_are_refused() {
    let place = Workplace::new();
    place
        .run("reference room.pbrt -q --spp 16 -o a.reference")
        .expect(0);
    let scene = place.read("room.pbrt");
    place.write("room.pbrt", &scene.replace("[9 8 7]", "[9 8 6]"));
    place
        .run("reference room.pbrt -o a.reference --extend 16")
        .expect(6)
        .says("another scene, or one that has changed since");
    place
        .run("reference room.pbrt -o a.reference --spp 16")
        .expect(5)
        .says("scene-digest is");
    let json = place.read("a.reference/provenance.json");
    place.write("a.reference/provenance.json", &json[..json.len() / 2]);
    let image = "compare a.reference/picture.exr --reference a.reference";
    place.run(image).expect(4).says("provenance.json: damaged");
    let mut older: Value = serde_json::from_str(&json).unwrap();
    // Older files have no checksum.
    older.as_object_mut().unwrap().remove("checksum");
    older["format"] = 1.into();
    place.write("a.reference/provenance.json", &older.to_string());
    place
        .run(image)
        .expect(6)
        .says("the reference has format 1; this program reads format 2");
    place.write("a.reference/provenance.json", &json);
    fs::remove_file(place.path("a.reference/against.exr")).unwrap();
    place
        .run(image)
        .expect(4)
        .says("against.exr: damaged: it is missing");
    fs::remove_file(place.path("a.reference/provenance.json")).unwrap();
    let hint = "hint: make one with `bidir reference`";
    place
        .run(image)
        .expect(4)
        .says("a.reference is not a reference: it has no provenance.json")
        .says(hint);
    for folder in ["a.reference", "none.reference"] {
        place
            .run(&format!("reference room.pbrt -o {folder} --extend 16"))
            .expect(4)
            .says("is not a reference")
            .says(hint);
    }
    place
        .run("compare a.reference/picture.exr --reference none.reference")
        .expect(4)
        .says("cannot open `none.reference`: no such file");
}

#[test]
fn an_estimator_cannot_cross_check_itself() {
    let place = Workplace::new();
    let reference = |estimators: &[&str]| {
        let mut command = place.command("reference room.pbrt -q --spp 16 --restart -o a.reference");
        Ran::of(command.args(estimators))
    };
    let same: [&[&str]; 8] = [
        &["--estimator=bdpt", "--against=bdpt"],
        &["--estimator=bdpt --seed 1", "--against=bdpt --seed 2"],
        &["--estimator=lvc", "--against=lvc --shadow-rays auto"],
        &["--estimator=path", "--against=path --candidates 4"],
        &["--estimator=light", "--against=light --mis power"],
        // `auto` may choose the other estimator.
        &["--estimator=auto", "--against=path"],
        &["--estimator=bdpt", "--against=auto"],
        // The first estimator is the default.
        &["--against=bdpt --path-roulette auto"],
    ];
    for estimators in same {
        reference(estimators)
            .expect(2)
            .says("the same estimator")
            .says("hint: give --against another integrator");
    }
    assert_eq!(place.names(), ["room.pbrt"]);
    // An existing reference stays.
    reference(&["--against=bdpt --mis power"]).expect(0);
    reference(&["--against=bdpt"]).expect(2);
    let picture = "a.reference/picture.exr";
    place
        .run(&format!("compare {picture} --reference a.reference"))
        .expect(0);
}

#[test]
fn a_wrong_command_line_is_an_error() {
    let place = Workplace::new();
    for (arguments, says) in [
        ("--spp 4 --extend 4", "cannot be used with"),
        ("--extend 4 --size 4x4", "cannot be used with"),
        ("--extend 4 --crop 0,0,4,4", "cannot be used with"),
        ("--spp 0", "`0`: expected a whole number"),
        (
            "--against photons",
            "--against: --integrator: `photons` is not one of path",
        ),
        ("-o .", ". exists already and is not a reference"),
    ] {
        place
            .run(&format!("reference room.pbrt {arguments}"))
            .expect(2)
            .says(says);
    }
    place.run("reference nothing.pbrt").expect(4);
    assert_eq!(place.names(), ["room.pbrt"]);
}

//! No output replaces a file that the command reads, nor another output.

use crate::common::{Ran, Workplace};
use std::collections::BTreeMap;
use std::fs;

/// A scene that reads or names a file of every kind.
const WOOD: &str = r#"
Camera "perspective"
Film "rgb" "integer xresolution" 4 "integer yresolution" 4 "string filename" "wood.exr"
WorldBegin
LightSource "infinite" "string filename" "sky.exr"
Include "part.svg"
Texture "wood" "spectrum" "imagemap" "string filename" "wood.png"
Texture "unused" "spectrum" "imagemap" "string filename" "unused.png"
Material "diffuse" "texture reflectance" "wood"
Shape "plymesh" "string filename" "mesh.ply"
"#;
const MESH: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n\
    property float y\nproperty float z\nelement face 1\n\
    property list uchar int vertex_indices\nend_header\n0 0 3\n1 0 3\n0 1 3\n3 0 1 2\n";

/// Returns a workplace with the scene and its files.
fn place() -> Workplace {
    let place = Workplace::new();
    place.write("wood.pbrt", WOOD);
    place.write("mesh.ply", MESH);
    place.write(
        "part.svg",
        "LightSource \"point\" \"spectrum I\" \"lamp.spd\"\n",
    );
    place.write("lamp.spd", "400 1\n700 1\n");
    let render = "render room.pbrt -q --spp 1 --size 8x8 -o";
    place.run(&format!("{render} sky.exr")).expect(0);
    fs::rename(place.path("sky.png"), place.path("wood.png")).unwrap();
    fs::copy(place.path("wood.png"), place.path("unused.png")).unwrap();
    place
}

/// Returns all files with their bytes.
fn contents(place: &Workplace) -> BTreeMap<String, Vec<u8>> {
    let names = place.names().into_iter();
    let files = names.filter(|name| place.path(name).is_file());
    files
        .map(|name| (name.clone(), fs::read(place.path(&name)).unwrap()))
        .collect()
}

/// Checks that a command fails with both names, and changes no file.
#[track_caller]
fn refused(place: &Workplace, arguments: &str, [output, does, other]: [&str; 3]) -> Ran {
    let before = contents(place);
    let says = format!("cannot write `{output}`: it would replace the {does} `{other}`");
    let ran = place.run(arguments).expect(4).says(&says);
    assert!(contents(place) == before, "{arguments}");
    ran
}

#[test]
fn a_render_replaces_no_file_of_its_scene() {
    let place = place();
    let hint = "hint: name another file with --output";
    let default = ["wood.png", "input", "wood.png"];
    refused(&place, "render wood.pbrt -q --spp 1", default).says(hint);
    for (flags, output, input) in [
        ("-o ./sky.exr", "./sky.exr", "sky.exr"),
        ("-o unused.png", "unused.png", "unused.png"),
        ("-o a.exr --stats part.svg", "part.svg", "part.svg"),
        ("-o a.exr --stats mesh.ply", "mesh.ply", "mesh.ply"),
        ("-o a.exr --stats lamp.spd", "lamp.spd", "lamp.spd"),
        ("-o a.exr --stats wood.pbrt", "wood.pbrt", "wood.pbrt"),
        ("--replay 0,0,0 --svg part.svg", "part.svg", "part.svg"),
        ("-o wood.png --checkpoint a.film", "wood.png", "wood.png"),
    ] {
        let render = format!("render wood.pbrt -q --spp 1 {flags}");
        refused(&place, &render, [output, "input", input]);
    }
    place.run("render wood.pbrt -q --spp 1 -o a.exr").expect(0);
}

#[test]
fn the_outputs_of_a_render_are_different_files() {
    let place = Workplace::new();
    for (flags, output, other) in [
        ("-o a.exr --stats ./a.png", "./a.png", "a.png"),
        (
            "-o a.exr --stats a.film --checkpoint a.film",
            "a.film",
            "a.film",
        ),
        (
            "--stats a.film.lock --checkpoint a.film",
            "a.film.lock",
            "a.film.lock",
        ),
        (
            "--stats a.film.previous --checkpoint a.film",
            "a.film.previous",
            "a.film.previous",
        ),
    ] {
        let render = format!("render room.pbrt -q --spp 1 {flags}");
        refused(&place, &render, [output, "other output", other]);
    }
}

#[cfg(unix)]
#[test]
fn links_to_a_file_of_the_scene_are_that_file() {
    let place = place();
    fs::create_dir(place.path("strategies")).unwrap();
    std::os::unix::fs::symlink("../sky.exr", place.path("strategies/pyramid.exr")).unwrap();
    fs::hard_link(place.path("sky.exr"), place.path("second.exr")).unwrap();
    let render = "render wood.pbrt -q --spp 1 --integrator bdpt -o";
    let pyramid = ["strategies/pyramid.exr", "input", "sky.exr"];
    refused(
        &place,
        &format!("{render} a.exr --pyramid strategies"),
        pyramid,
    )
    .says("hint: name another file with --pyramid");
    let second = ["second.exr", "input", "sky.exr"];
    refused(&place, &format!("{render} second.exr"), second);
}

#[test]
fn commands_for_images_and_films_replace_none_that_they_read() {
    let place = Workplace::new();
    place
        .run("render room.pbrt -q --spp 1 --checkpoint a.film")
        .expect(0);
    fs::copy(place.path("room.exr"), place.path("b.exr")).unwrap();
    fs::copy(place.path("a.film"), place.path("film.exr")).unwrap();
    let map = "compare room.exr b.exr --error-map";
    let maps = "compare room.exr --reference b.exr --error-map";
    for (command, output, input) in [
        (map, "room.exr", "room.exr"),
        (map, "./b.exr", "b.exr"),
        (maps, "b.exr", "b.exr"),
        ("tonemap room.png -o", "./room.png", "room.png"),
        ("denoise room.exr -o", "room.exr", "room.exr"),
        ("film develop film.exr -o", "film.exr", "film.exr"),
        ("merge film.exr -o b.film --image", "./film.exr", "film.exr"),
    ] {
        refused(
            &place,
            &format!("{command} {output}"),
            [output, "input", input],
        );
    }
}

#[test]
fn references_and_experiments_replace_no_file_that_they_read() {
    let place = place();
    fs::create_dir_all(place.path("old.reference/films")).unwrap();
    let picture = "old.reference/picture.exr";
    fs::copy(place.path("sky.exr"), place.path(picture)).unwrap();
    place.write("wood.pbrt", &WOOD.replace("sky.exr", picture));
    let make = "reference wood.pbrt --spp 16 --restart -o old.reference";
    refused(&place, make, [picture, "input", picture]);

    fs::create_dir_all(place.path("out/references")).unwrap();
    let copy = "out/references/room.exr";
    fs::copy(place.path("sky.exr"), place.path(copy)).unwrap();
    let tables =
        "[[method]]\nname = \"a\"\n[[budget]]\nsamples = 1\n[[scene]]\nfile = \"room.pbrt\"\n";
    let description = format!("size = \"8x8\"\n{tables}reference = \"{copy}\"\n");
    place.write("a.toml", &description);
    let copy = [
        "out/references/room.exr",
        "input",
        "./out/references/room.exr",
    ];
    refused(&place, "experiment a.toml -o out", copy);
    place.write("out/results.json", &description);
    let results = ["out/results.json", "input", "out/results.json"];
    refused(&place, "experiment out/results.json -o out", results);
    assert_eq!(place.read("out/results.json"), description);
}

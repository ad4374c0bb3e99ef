//! No output replaces a file that the command reads, by whatever name.

use crate::common::{Ran, Workplace};
use std::fs;

/// A scene that reads an image.
const SKY: &str = r#"
Camera "perspective"
Film "rgb" "integer xresolution" 4 "integer yresolution" 4
WorldBegin
LightSource "infinite" "string filename" "sky.exr"
"#;

/// Returns a workplace with the scene and its image.
fn place() -> Workplace {
    let place = Workplace::new();
    place.write("sky.pbrt", SKY);
    let render = "render room.pbrt -q --spp 1 --size 8x8 -o sky.exr";
    place.run(render).expect(0);
    place
}

/// Checks that a command fails with both names, and changes no file.
#[track_caller]
fn refused(place: &Workplace, arguments: &str, [output, input]: [&str; 2]) -> Ran {
    let before = place.contents();
    let says = format!("cannot write `{output}`: it would replace the input `{input}`");
    let ran = place.run(arguments).expect(4).says(&says);
    assert!(place.contents() == before, "{arguments}");
    ran
}

#[cfg(unix)]
#[test]
fn links_to_a_file_of_the_scene_are_that_file() {
    let place = place();
    fs::create_dir(place.path("strategies")).unwrap();
    std::os::unix::fs::symlink("../sky.exr", place.path("strategies/pyramid.exr")).unwrap();
    fs::hard_link(place.path("sky.exr"), place.path("second.exr")).unwrap();
    let render = "render sky.pbrt -q --spp 1 --integrator bdpt -o";
    let pyramid = ["strategies/pyramid.exr", "sky.exr"];
    refused(
        &place,
        &format!("{render} a.exr --pyramid strategies"),
        pyramid,
    )
    .says("hint: name another file with --pyramid");
    let second = ["second.exr", "sky.exr"];
    refused(&place, &format!("{render} second.exr"), second);
}

#[test]
fn films_with_other_names_are_not_replaced() {
    let place = Workplace::new();
    let render = "render room.pbrt -q --spp 1 --checkpoint a.film";
    place.run(render).expect(0);
    fs::copy(place.path("a.film"), place.path("film.exr")).unwrap();
    let develop = "film develop film.exr -o film.exr";
    refused(&place, develop, ["film.exr", "film.exr"]);
    let merge = "merge film.exr -o b.film --image ./film.exr";
    refused(&place, merge, ["./film.exr", "film.exr"]);
}

#[test]
fn references_and_experiments_replace_no_file_that_they_read() {
    let place = place();
    fs::create_dir_all(place.path("old.reference/films")).unwrap();
    let picture = "old.reference/picture.exr";
    fs::copy(place.path("sky.exr"), place.path(picture)).unwrap();
    place.write("sky.pbrt", &SKY.replace("sky.exr", picture));
    let make = "reference sky.pbrt --spp 16 --restart -o old.reference";
    refused(&place, make, [picture, picture]);

    fs::create_dir_all(place.path("out/references")).unwrap();
    let copy = "out/references/room.exr";
    fs::copy(place.path("sky.exr"), place.path(copy)).unwrap();
    let tables =
        "[[method]]\nname = \"a\"\n[[budget]]\nsamples = 1\n[[scene]]\nfile = \"room.pbrt\"\n";
    let description = format!("size = \"8x8\"\n{tables}reference = \"{copy}\"\n");
    place.write("a.toml", &description);
    let copy = ["out/references/room.exr", "./out/references/room.exr"];
    refused(&place, "experiment a.toml -o out", copy);
    place.write("out/results.json", &description);
    let results = ["out/results.json", "out/results.json"];
    refused(&place, "experiment out/results.json -o out", results);
    assert_eq!(place.read("out/results.json"), description);
}

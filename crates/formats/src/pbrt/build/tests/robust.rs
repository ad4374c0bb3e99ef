use super::{LENIENT, STRICT, build};
use crate::pbrt::{parse_file, parse_text};
use proptest::prelude::*;
use std::path::Path;

/// Pieces of scenes; `#` stands for a number.
const PIECES: &[&str] = &[
    "Material \"diffuse\" \"rgb reflectance\" [# # #]",
    "Material \"conductor\" \"float roughness\" # \"rgb eta\" [# # #]",
    "Material \"dielectric\" \"float eta\" # \"float uroughness\" #",
    "Shape \"sphere\" \"float radius\" #",
    "Shape \"sphere\" \"float zmin\" # \"float zmax\" # \"float phimax\" #",
    "Shape \"disk\" \"float radius\" # \"float innerradius\" # \"float height\" #",
    "Shape \"trianglemesh\" \"point3 P\" [# # # # # # # # #]",
    "Shape \"trianglemesh\" \"point3 P\" [# # # # # # # # #] \"normal N\" [# # # # # # # # #]",
    "AreaLightSource \"diffuse\" \"rgb L\" [# # #] \"float scale\" #",
    "AreaLightSource \"diffuse\" \"float power\" # \"bool twosided\" true",
    "LightSource \"point\" \"rgb I\" [# # #] \"float power\" # \"point3 from\" [# # #]",
    "LightSource \"spot\" \"float coneangle\" # \"float conedeltaangle\" # \"float power\" #",
    "LightSource \"distant\" \"point3 from\" [# # #] \"float scale\" #",
    "LightSource \"infinite\" \"rgb L\" [# # #] \"float illuminance\" #",
    "Translate # # #",
    "Scale # # #",
    "Rotate # # # #",
    "ObjectBegin \"o\" Shape \"sphere\" ObjectEnd ObjectInstance \"o\"",
];

const NUMBERS: &[&str] = &[
    "0", "1", "-1", "0.5", "3", "1e-38", "1e-44", "1e20", "3e38", "-3e38", "90",
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn scenes_of_any_numbers_never_panic(
        pieces in proptest::collection::vec(proptest::sample::select(PIECES), 0..8),
        numbers in proptest::collection::vec(proptest::sample::select(NUMBERS), 64),
        ordinary in 0usize..64,
    ) {
        let mut text = String::from("WorldBegin\n");
        let mut numbers = numbers.into_iter().enumerate().cycle();
        for piece in pieces.join("\n").split('#') {
            let (i, number) = numbers.next().unwrap();
            text.push_str(piece);
            text.push_str(if i < ordinary { "1" } else { number });
        }
        if let Ok(description) = parse_text("s", &text) {
            let _ = build(&description, &LENIENT).map_err(|error| error.to_string());
        }
    }
}

/// Scenes made by others, in `pbrt-v4/` of the folder that `BIDIR_SCENES` names.
#[test]
fn real_scenes_are_built() {
    let Some(scenes) = std::env::var_os("BIDIR_SCENES") else {
        println!("skipped: BIDIR_SCENES is not set");
        return;
    };
    let scenes = Path::new(&scenes).join("pbrt-v4");
    for (name, options, shapes) in [
        ("veach-bidir/veach-bidir.pbrt", STRICT, Some(14)),
        ("veach-ajar/veach-ajar.pbrt", STRICT, Some(22)),
        ("veach-mis/veach-mis.pbrt", STRICT, Some(9)),
        ("cornell-box-w3ntao/cornell-box.pbrt", STRICT, Some(8)),
        ("cornell-box-w3ntao/smallpt.pbrt", STRICT, None),
        ("coffee/coffee.pbrt", LENIENT, Some(23)),
        ("living-room/living-room.pbrt", LENIENT, None),
    ] {
        let description = parse_file(&scenes.join(name)).unwrap_or_else(|error| panic!("{error}"));
        let count = description.shapes.len();
        assert_eq!(count, shapes.unwrap_or(count), "{name}");
        let loaded = build(&description, &options).unwrap_or_else(|error| panic!("{error}"));
        println!(
            "{name}: {:?}\n{}",
            loaded.summary,
            loaded.warnings.join("\n")
        );
        let is_lit = !loaded.scene.lights().is_empty();
        assert!(loaded.summary.primitives > 10 && is_lit, "{name}");
    }
}

use super::{LENIENT, STRICT, check_world, load_text, world};
use crate::pbrt::load;
use bidir::material::{ConductorIndex, Material};
use bidir::math::{Vec2, Vec3};
use bidir::scene::Scene;
use bidir::texture::TexturePoint;

/// A folder with a scene and an image of two rows: red above, green below.
fn textured(parameters: &str) -> Scene {
    let folder = tempfile::tempdir().unwrap();
    let image = folder.path().join("t.png");
    crate::image::write_png(&image, [1, 2], &[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]).unwrap();
    let text = format!(
        "WorldBegin Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"t.png\"\n\
         \"string filter\" \"point\" {parameters}\n\
         Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\""
    );
    let path = folder.path().join("s.pbrt");
    std::fs::write(&path, text).unwrap();
    load(&path, &STRICT)
        .unwrap_or_else(|error| panic!("{error}"))
        .scene
}

#[track_caller]
fn check_texture(parameters: &str, uv: Vec2, expected: [f32; 3]) {
    let scene = textured(parameters);
    let Material::Diffuse { reflectance } = &scene.materials()[1] else {
        panic!("the material is diffuse");
    };
    assert_eq!(
        Vec3::from(reflectance.eval(&TexturePoint::of_parameters(uv))),
        Vec3::from(expected)
    );
}

#[test]
fn images_stand_upright_and_are_scaled_before_they_are_inverted() {
    let (low, high) = (Vec2::new(0.5, 0.25), Vec2::new(0.5, 0.75));
    check_texture("", high, [1.0, 0.0, 0.0]);
    check_texture("", low, [0.0, 1.0, 0.0]);
    check_texture(
        "\"float scale\" 0.25 \"bool invert\" true",
        high,
        [0.75, 1.0, 1.0],
    );
    check_texture("\"float vdelta\" 0.5", low, [1.0, 0.0, 0.0]);
    check_texture("\"string wrap\" \"black\"", high + Vec2::Y, [0.0; 3]);
    check_texture("\"string wrap\" \"clamp\"", high + Vec2::Y, [1.0, 0.0, 0.0]);
}

const TWO: &str = "Texture \"two\" \"spectrum\" \"constant\" \"rgb value\" [2 2 2]";

/// The material of the only shape.
#[track_caller]
fn material(text: &str) -> Material {
    world(&format!("{text} Shape \"sphere\"")).materials()[1].clone()
}

#[test]
fn a_constant_is_checked_for_what_it_is_used_for() {
    let text =
        format!("{TWO}\nMaterial \"conductor\" \"texture eta\" \"two\" \"texture k\" \"two\"");
    let Material::Conductor {
        index: ConductorIndex::Complex { eta, k },
        ..
    } = material(&text)
    else {
        panic!("the material is a conductor with an index");
    };
    let at = TexturePoint::of_parameters(Vec2::ZERO);
    assert_eq!(
        [eta, k].map(|part| Vec3::from(part.eval(&at))),
        [Vec3::splat(2.0); 2]
    );
    // Also after it was used for something that may be so large.
    check_world(
        &format!("{text}\nMaterial \"diffuse\" \"texture reflectance\" \"two\" Shape \"sphere\""),
        "s.pbrt:2:49: the reflectance `value` is above 1",
    );
    check_world(
        "Material \"diffuse\" \"spectrum reflectance\" \"metal-Al-k\" Shape \"sphere\"",
        "s.pbrt:2:43: the reflectance `reflectance` is above 1",
    );
}

#[test]
fn a_stand_in_is_counted_once_however_often_it_is_used() {
    let loaded = load_text(
        "WorldBegin\nTexture \"dots\" \"spectrum\" \"ptex\"\n\
         Material \"diffuse\" \"texture reflectance\" \"dots\" Shape \"sphere\"\n\
         Material \"conductor\" \"texture reflectance\" \"dots\" Shape \"sphere\"",
        &LENIENT,
    );
    assert_eq!(
        loaded.warnings,
        ["s.pbrt:2:27: the texture class `ptex` is not supported yet: 0.5 stands in"]
    );
}

//! Heights and normals of materials.

use super::textures::material;
use super::{STRICT, world};
use crate::pbrt::load;
use bidir::material::Relief;
use bidir::math::{Vec2, Vec3};
use bidir::texture::TexturePoint;

/// Builds a scene beside an image of one pixel, which is stored as (0.5, 0.5, 1).
fn with_normals(text: &str) -> Result<crate::pbrt::Loaded, crate::error::Error> {
    let folder = tempfile::tempdir().unwrap();
    let linear = 0.21404114;
    let image = folder.path().join("n.png");
    crate::image::write_png(&image, [1, 1], &[[linear, linear, 1.0]]).unwrap();
    let path = folder.path().join("s.pbrt");
    std::fs::write(&path, format!("WorldBegin {text} Shape \"sphere\"")).unwrap();
    load(&path, &STRICT)
}

#[test]
fn materials_have_heights_or_normals() {
    let text =
        "Texture \"h\" \"float\" \"fbm\" Material \"diffuse\" \"texture displacement\" \"h\"";
    assert!(matches!(
        material(text).relief(),
        Some(Relief::Displacement(_))
    ));
    let both = "Texture \"h\" \"float\" \"fbm\" Material \"diffuse\" \
                \"texture displacement\" \"h\" \"string normalmap\" \"n.png\"";
    let scene = with_normals(both)
        .unwrap_or_else(|error| panic!("{error}"))
        .scene;
    let Some(Relief::NormalMap(map)) = scene.materials()[1].relief() else {
        panic!("the image of normals counts");
    };
    // Stored values are not decoded from sRGB.
    let stored = Vec3::from(map.texture.eval(&TexturePoint::of_parameters(Vec2::ZERO)));
    assert!(
        stored.distance(Vec3::new(0.5, 0.5, 1.0)) < 0.003,
        "{stored}"
    );
    let missing = with_normals("Material \"diffuse\" \"string normalmap\" \"m.png\"");
    let error = missing.expect_err("there is no such file").to_string();
    assert!(error.contains("m.png`: no such file"), "{error}");
}

/// Parts of a mixture have their own bump and normal maps.
#[test]
fn mixtures_choose_a_relief_with_the_material() {
    let text = "Texture \"h\" \"float\" \"fbm\"\n\
                MakeNamedMaterial \"a\" \"string type\" \"diffuse\"\n\
                MakeNamedMaterial \"b\" \"string type\" \"diffuse\" \"texture displacement\" \"h\"\n\
                Material \"mix\" \"string materials\" [ \"a\" \"b\" ] Shape \"sphere\"";
    let scene = world(text);
    let at = TexturePoint::of_parameters(Vec2::ZERO);
    let mixture = scene.materials().last().expect("there is a mixture");
    for (u, has_relief) in [(0.9, false), (0.1, true)] {
        assert_eq!(mixture.choose(&at, || u).relief().is_some(), has_relief);
    }
}

use super::refusals::outcome;
use super::{STRICT, world};
use crate::pbrt::load;
use bidir::material::{ConductorIndex, Material};
use bidir::math::{Vec2, Vec3};
use bidir::scene::Scene;
use bidir::texture::{ColorTexture, TexturePoint};
use std::sync::Arc;

/// Returns a scene with an image of two rows: red above, green below.
fn textured(parameters: &str) -> Arc<Scene> {
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
fn images_are_upright_and_are_scaled_before_they_are_inverted() {
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

/// Returns the material of the only shape.
#[track_caller]
pub(super) fn material(text: &str) -> Material {
    world(&format!("{text} Shape \"sphere\"")).materials()[1].clone()
}

#[test]
fn a_constant_is_checked_for_each_purpose() {
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
}

/// Returns the reflectance of the only shape, which is the texture `t`.
#[track_caller]
fn reflectance(text: &str) -> ColorTexture {
    let material = material(&format!(
        "{text}\nMaterial \"diffuse\" \"texture reflectance\" \"t\""
    ));
    let Material::Diffuse { reflectance } = material else {
        panic!("the material is diffuse");
    };
    reflectance
}

#[track_caller]
fn check_value(text: &str, at: &TexturePoint, expected: [f32; 3]) {
    let value = Vec3::from(reflectance(text).eval(at));
    let distance = value.distance(Vec3::from(expected));
    assert!(distance < 1e-5, "{value} instead of {expected:?}");
}

#[test]
fn classes_have_the_parameters_and_defaults_of_the_format() {
    let at = |u, v| TexturePoint::of_parameters(Vec2::new(u, v));
    let is = |class: &str, at: &TexturePoint, expected: f32| {
        check_value(
            &format!("Texture \"t\" \"spectrum\" {class}"),
            at,
            [expected; 3],
        );
    };
    is("\"constant\"", &at(0.0, 0.0), 1.0);
    is("\"scale\" \"float scale\" .25", &at(0.0, 0.0), 0.25);
    is("\"mix\" \"float amount\" .25", &at(0.0, 0.0), 0.25);
    is("\"bilerp\"", &at(0.7, 0.25), 0.25);
    is(
        "\"bilerp\" \"rgb v10\" [1 1 1] \"rgb v01\" [0 0 0]",
        &at(0.7, 0.25),
        0.7,
    );
    is("\"checkerboard\"", &at(0.5, 0.5), 1.0);
    is("\"checkerboard\" \"float uscale\" 2", &at(0.75, 0.5), 0.0);
    is("\"checkerboard\" \"float udelta\" 1", &at(0.75, 0.5), 0.0);
    is("\"dots\" \"rgb outside\" [1 1 1]", &at(0.49, 0.49), 1.0);
    let beside = TexturePoint {
        point: Vec3::new(-0.5, 0.5, 0.5),
        ..at(0.5, 0.5)
    };
    is("\"checkerboard\" \"integer dimension\" 3", &beside, 0.0);
    is(
        "\"checkerboard\" \"string mapping\" \"planar\" \"vector3 v1\" [0 0 4]",
        &beside,
        1.0,
    );
    let sideways = TexturePoint {
        normal: Vec3::new(0.6, 0.8, 0.0),
        ..at(0.0, 0.0)
    };
    is("\"directionmix\"", &sideways, 0.2);
    is("\"directionmix\" \"vector3 dir\" [-2 0 0]", &sideways, 0.4);
    for class in ["fbm", "wrinkled", "windy"] {
        let text = format!(
            "Texture \"t\" \"float\" \"{class}\" Material \"conductor\" \"texture roughness\" \"t\""
        );
        assert_eq!(material(&text).kind(), "conductor");
    }
    reflectance(
        "Texture \"t\" \"spectrum\" \"marble\" \"integer octaves\" 3 \"float variation\" .5",
    );
}

/// Points are mapped to texture space by the inverse of the transformation at the directive.
#[test]
fn textures_have_the_transformation_of_their_directive() {
    let at = |x: f32, y: f32, z: f32| TexturePoint {
        point: Vec3::new(x, y, z),
        ..TexturePoint::of_parameters(Vec2::ZERO)
    };
    let text = "Translate 10 0 0 Scale 2 2 2 Texture \"t\" \"spectrum\" \"checkerboard\" \
                \"integer dimension\" 3 Identity";
    check_value(text, &at(11.0, 1.0, 1.0), [1.0; 3]);
    check_value(text, &at(9.0, 1.0, 1.0), [0.0; 3]);
    check_value(text, &at(12.5, 2.5, 1.0), [1.0; 3]);
    let text = "Rotate 90 0 0 1 Texture \"t\" \"spectrum\" \"directionmix\" Identity";
    let normal = Vec3::X;
    check_value(
        text,
        &TexturePoint {
            normal,
            ..at(0.0, 0.0, 0.0)
        },
        [0.0; 3],
    );
}

#[test]
fn textures_are_made_of_textures_above_them() {
    let half = "Texture \"half\" \"spectrum\" \"constant\" \"rgb value\" [.5 .5 .5]";
    let board = "Texture \"b\" \"spectrum\" \"checkerboard\" \"texture tex1\" \"half\"";
    let amount = "Texture \"a\" \"float\" \"scale\" \"float tex\" .5 \"float scale\" .5";
    let mix = "Texture \"t\" \"spectrum\" \"mix\" \"texture tex1\" \"b\" \"texture amount\" \"a\"";
    let at = |u| TexturePoint::of_parameters(Vec2::new(u, 0.5));
    // Numbers may be defined after the colours that use them.
    let text = format!("{half} {board} {mix} {amount}");
    check_value(&text, &at(0.5), [0.625; 3]);
    check_value(&text, &at(1.5), [0.25; 3]);
}

/// Refuses a chain that is too long, and one that doubles at each step.
#[test]
fn nesting_has_limits() {
    let used = |class: &str, count: usize| {
        let first = "WorldBegin\nTexture \"t0\" \"float\" \"fbm\"".to_owned();
        let chain = (1..count).fold(first, |text, i| {
            let part = class.replace('?', &format!("t{}", i - 1));
            format!("{text}\nTexture \"t{i}\" \"float\" {part}")
        });
        let last = count - 1;
        let user = format!("Material \"conductor\" \"texture roughness\" \"t{last}\"");
        outcome(&format!("{chain}\n{user} Shape \"sphere\""), &STRICT)
    };
    let scale = "\"scale\" \"texture tex\" \"?\"";
    let double = "\"mix\" \"texture tex1\" \"?\" \"texture tex2\" \"?\"";
    assert_eq!(used(scale, 30), "accepted");
    let too_deep = "Limit: s.pbrt:9:22: textures are nested deeper than 32";
    assert_eq!(used(scale, 40), too_deep);
    let too_large = "Limit: s.pbrt:11:22: the texture is made of more than 1024";
    assert_eq!(used(double, 20), too_large);
}

/// A file that several textures use with different settings is stored once.
#[test]
fn images_are_read_once() {
    let folder = tempfile::tempdir().unwrap();
    let image = folder.path().join("t.png");
    crate::image::write_png(&image, [2, 1], &[[1.0; 3], [0.25; 3]]).unwrap();
    let look = |name: &str, filter: &str, scale: f32| {
        format!(
            "Texture \"{name}\" \"spectrum\" \"imagemap\" \"string filename\" \"t.png\" \
             \"string filter\" \"{filter}\" \"float scale\" {scale}\n\
             Material \"diffuse\" \"texture reflectance\" \"{name}\" Shape \"sphere\"\n"
        )
    };
    let text = look("a", "trilinear", 1.0) + &look("b", "point", 0.5);
    let path = folder.path().join("s.pbrt");
    std::fs::write(&path, format!("WorldBegin {text}")).unwrap();
    let scene = load(&path, &STRICT)
        .unwrap_or_else(|error| panic!("{error}"))
        .scene;
    let maps = scene.materials()[1..]
        .iter()
        .map(|material| match material {
            Material::Diffuse {
                reflectance: ColorTexture::Image(map),
            } => map,
            _ => panic!("the material shows an image"),
        });
    let maps: Vec<_> = maps.collect();
    assert!(Arc::ptr_eq(&maps[0].image, &maps[1].image));
    assert_eq!(maps[0].image.copies(), 1);
    let at = TexturePoint::of_parameters(Vec2::new(0.75, 0.5));
    assert!((maps[1].eval(&at)[0] - 0.125).abs() < 1e-2);
}

/// The bytes of an image decide its format, not its name.
#[test]
fn images_of_scenes_are_read_by_their_bytes() {
    let seeds = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fuzz/seeds/image/");
    let folder = tempfile::tempdir().unwrap();
    for (seed, name) in [
        ("rgb8.png", "really-a-png.jpg"),
        ("rgb.jpg", "a.png"),
        ("rgb.bmp", "a.bmp"),
        ("palette.gif", "a.tga"),
        ("rgb.qoi", "image"),
        ("rgb.tiff", "a.hdr"),
    ] {
        let bytes = std::fs::read(format!("{seeds}{seed}")).unwrap();
        std::fs::write(folder.path().join(name), &bytes[1..]).unwrap();
        let text = format!(
            "WorldBegin Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"{name}\"\n\
             Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\""
        );
        let path = folder.path().join("s.pbrt");
        std::fs::write(&path, text).unwrap();
        load(&path, &STRICT).unwrap_or_else(|error| panic!("{error}"));
    }
}

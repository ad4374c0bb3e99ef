//! Cameras, lights, materials and textures.

#![expect(
    clippy::float_cmp,
    reason = "numbers of a file come through as they are"
)]

use super::{Draft, F32, floats, load_bytes, mesh, warnings};
use crate::error::ErrorKind;
use crate::image::encode_png;
use crate::pbrt::{Crop, LoadOptions, Loaded};
use bidir::bsdf::{Thickness, TransportMode};
use bidir::light::{Light, LightPoint};
use bidir::locus::Locus;
use bidir::material::{Bitangent, Material, PrincipledMaterial, Relief};
use bidir::math::{Vec2, Vec3};
use bidir::spectrum::Lanes;
use bidir::texture::TexturePoint;
use serde_json::{Value, json};

/// A triangle with a texture of 2 × 2 texels: red and green above, blue and white below.
fn textured() -> Draft {
    let mut draft = Draft::triangle();
    let uvs = draft.accessor(&floats(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]), (F32, "VEC2", 3));
    draft.primitive()["attributes"]["TEXCOORD_0"] = json!(uvs);
    draft.primitive()["material"] = json!(0);
    let texels = [
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 1.0, 1.0],
    ];
    let view = draft.view(&encode_png([2, 2], &texels).unwrap());
    draft.json["images"] = json!([{ "bufferView": view, "mimeType": "image/png" }]);
    draft.json["samplers"] = json!([{ "magFilter": 9728 }]);
    draft.json["textures"] = json!([{ "source": 0, "sampler": 0 }]);
    let texture = json!({ "index": 0 });
    draft.json["materials"] = json!([{ "pbrMetallicRoughness": { "baseColorTexture": texture } }]);
    draft
}

fn principled(loaded: &Loaded) -> &PrincipledMaterial {
    match &loaded.scene.materials()[0] {
        Material::Principled(material) => material,
        other => panic!("{other:?}"),
    }
}

/// The part of white light along the normal that white metal of this roughness scatters: ∫ f cosθ dω.
fn white_metal(roughness: f32) -> f32 {
    let mut draft = Draft::triangle();
    draft.primitive()["material"] = json!(0);
    let metal = json!({ "metallicFactor": 1.0, "roughnessFactor": roughness });
    draft.json["materials"] = json!([{ "pbrMetallicRoughness": metal }]);
    let loaded = draft.load().unwrap();
    let at = TexturePoint::of_parameters(Vec2::ZERO);
    let material = &loaded.scene.materials()[0];
    let bsdf = material.bsdf(&at, Lanes::Rgb);
    let n = 40_000u16;
    let value = |i: u16| {
        let cos = (f32::from(i) + 0.5) / f32::from(n);
        let wi = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
        let f = bsdf.eval(Vec3::Z, wi, TransportMode::Radiance).f[0];
        f64::from(f * cos)
    };
    (std::f64::consts::TAU * (0..n).map(value).sum::<f64>() / f64::from(n)) as f32
}

#[test]
fn rough_metal_keeps_the_light_between_its_facets() {
    for roughness in [0.2, 0.4, 0.6, 0.8, 1.0] {
        let part = white_metal(roughness);
        assert!((part - 1.0).abs() < 0.012, "{roughness}: {part}");
    }
}

/// The base colour at a point of the triangle, by the file's own coordinates.
#[track_caller]
fn color(loaded: &Loaded, uv: [f32; 2]) -> [f32; 3] {
    let [a, b, c] = [0, 1, 2].map(|i| mesh(loaded, 0).uvs[i]);
    let at = a + (b - a) * uv[0] + (c - a) * uv[1];
    principled(loaded)
        .color
        .eval(&TexturePoint::of_parameters(at))
}

const RED: [f32; 3] = [1.0, 0.0, 0.0];
const GREEN: [f32; 3] = [0.0, 1.0, 0.0];
const BLUE: [f32; 3] = [0.0, 0.0, 1.0];

#[track_caller]
fn check_color(loaded: &Loaded, uv: [f32; 2], expected: [f32; 3]) {
    let found = color(loaded, uv);
    let is_near = found
        .iter()
        .zip(expected)
        .all(|(a, b)| (a - b).abs() < 1e-5);
    assert!(is_near, "{found:?} at {uv:?} instead of {expected:?}");
}

#[test]
fn textures_are_the_right_way_up() {
    let loaded = textured().load().unwrap();
    check_color(&loaded, [0.1, 0.1], RED);
    check_color(&loaded, [0.9, 0.1], GREEN);
    check_color(&loaded, [0.1, 0.9], BLUE);
    check_color(&loaded, [1.1, -0.9], RED);
}

fn with_transform(transform: &Value) -> Draft {
    let mut draft = textured();
    let info = &mut draft.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
    info["extensions"] = json!({ "KHR_texture_transform": transform });
    draft
}

/// The worked example of the extension: the lower left quadrant, turned clockwise.
#[test]
fn textures_are_moved_as_the_extension_says() {
    let quarter = std::f64::consts::FRAC_PI_2;
    let turned = json!({ "offset": [0, 1], "rotation": quarter, "scale": [0.5, 0.5] });
    let loaded = with_transform(&turned).load().unwrap();
    for uv in [[0.1, 0.1], [0.9, 0.1], [0.9, 0.9]] {
        check_color(&loaded, uv, BLUE);
    }
    let shifted = json!({ "offset": [0.5, 0.0] });
    check_color(&with_transform(&shifted).load().unwrap(), [0.1, 0.1], GREEN);
    let scaled = json!({ "scale": [2.0, 1.0] });
    check_color(&with_transform(&scaled).load().unwrap(), [0.3, 0.1], GREEN);
}

/// Textures of one material that are moved differently.
#[test]
fn textures_of_a_material_may_have_different_places() {
    let mut draft = with_transform(&json!({ "offset": [0.5, 0.0], "scale": [1.0, 1.0] }));
    draft.json["materials"][0]["pbrMetallicRoughness"]["metallicRoughnessTexture"] =
        json!({ "index": 0 });
    let loaded = draft.load().unwrap();
    check_color(&loaded, [0.1, 0.1], GREEN);
    let at = mesh(&loaded, 0).uvs[0] + Vec2::new(0.1, -0.1);
    let at = TexturePoint::of_parameters(at);
    // Green is roughness, blue metal; the texel is red.
    let material = principled(&loaded);
    assert!(material.roughness.eval(&at) <= 0.0 && material.metallic.eval(&at) <= 0.0);
    // The worked example of the extension, beside a texture that is not turned.
    let quarter = std::f64::consts::FRAC_PI_2;
    let info = &mut draft.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
    info["extensions"]["KHR_texture_transform"] =
        json!({ "offset": [0, 1], "rotation": quarter, "scale": [0.5, 0.5] });
    let turned = draft.load().unwrap();
    for uv in [[0.1, 0.1], [0.9, 0.1], [0.9, 0.9]] {
        check_color(&turned, uv, BLUE);
    }
}

/// Tangents follow the map of the anisotropy's texture; the colour stays where it is.
#[test]
fn textures_have_the_places_of_their_own_maps() {
    let quarter = std::f64::consts::FRAC_PI_2;
    let turned = json!({ "offset": [0, 1], "rotation": quarter, "scale": [0.5, 0.5] });
    for other in [
        json!({ "rotation": 0.7 }),
        json!({ "scale": [2, -3], "offset": [0.25, 0.5] }),
        json!({ "rotation": -2.0, "scale": [0.5, 4] }),
        json!({ "scale": [-1, 1] }),
        json!({ "scale": [0, 1], "rotation": 0.3 }),
        turned.clone(),
    ] {
        let mut draft = with_transform(&turned);
        let texture = json!({ "index": 0, "extensions": { "KHR_texture_transform": other } });
        draft.json["materials"][0]["extensions"]["KHR_materials_anisotropy"] =
            json!({ "anisotropyStrength": 1, "anisotropyTexture": texture });
        let loaded = draft.load().unwrap();
        for uv in [[0.1, 0.1], [0.9, 0.1], [0.8, 0.9]] {
            check_color(&loaded, uv, BLUE);
        }
    }
}

#[test]
fn normal_textures_turn_the_shading_frame() {
    let mut draft = textured();
    let texels = [[0.5, 0.5, 1.0]; 1];
    let view = draft.view(&encode_png([1, 1], &texels).unwrap());
    draft.json["images"] = json!([{ "bufferView": view, "mimeType": "image/png" }]);
    draft.json["materials"][0]["normalTexture"] = json!({ "index": 0, "scale": 0.25 });
    let loaded = draft.load().unwrap();
    let Some(Relief::NormalMap(map)) = loaded.scene.materials()[0].relief() else {
        panic!("{:?}", loaded.scene.materials());
    };
    assert_eq!((map.scale, map.bitangent), (0.25, Bitangent::AlongV));
    // Stored as it is meant, not as sRGB.
    let stored = map.texture.eval(&TexturePoint::of_parameters(Vec2::ZERO));
    let encoded = 188.0 / 255.0;
    let distance = (Vec3::from(stored) - Vec3::new(encoded, encoded, 1.0)).length();
    assert!(distance < 0.01, "{stored:?}");
    assert_eq!(warnings(&loaded, "normal"), 0);
}

#[test]
fn images_repeat_as_their_sampler_says() {
    for (wrap, beyond) in [(10497, RED), (33648, GREEN), (33071, GREEN)] {
        let mut draft = textured();
        draft.json["samplers"][0]["wrapS"] = json!(wrap);
        draft.json["samplers"][0]["wrapT"] = json!(wrap);
        check_color(&draft.load().unwrap(), [1.1, 0.1], beyond);
    }
    let mut draft = textured();
    draft.json["samplers"][0]["wrapS"] = json!(33071);
    let loaded = draft.load().unwrap();
    check_color(&loaded, [1.1, 0.1], GREEN);
    check_color(&loaded, [0.1, 1.1], RED);
}

#[test]
fn extensions_of_materials_are_read() {
    let mut draft = textured();
    draft.json["materials"][0]["extensions"] = json!({
        "KHR_materials_ior": { "ior": 1.33 },
        "KHR_materials_transmission": { "transmissionFactor": 0.75 },
        "KHR_materials_volume": { "thicknessFactor": 0.1 },
        "KHR_materials_clearcoat": { "clearcoatFactor": 0.5, "clearcoatRoughnessFactor": 0.25 },
        "KHR_materials_sheen": { "sheenColorFactor": [0.1, 0.2, 0.3], "sheenRoughnessFactor": 0.4 },
        "KHR_materials_specular": { "specularColorFactor": [2, 1, 0.5], "specularFactor": 0.5 },
        "KHR_materials_anisotropy": { "anisotropyStrength": 0.6, "anisotropyRotation": 1.5 },
    });
    let loaded = draft.load().unwrap();
    let material = principled(&loaded);
    assert_eq!((material.ior, material.thickness), (1.33, Thickness::Solid));
    let numbers = [
        (&material.transmission, 0.75),
        (&material.coat, 0.5),
        (&material.coat_roughness, 0.25),
        (&material.sheen_roughness, 0.4),
        (&material.specular, 0.5),
    ];
    for (number, expected) in numbers {
        assert!(
            (number.eval(&TexturePoint::of_parameters(Vec2::ZERO)) - expected).abs() < 1e-6,
            "{expected}"
        );
    }
    assert_eq!(material.sheen.factor, [0.1, 0.2, 0.3]);
    assert_eq!(material.specular_color.factor, [2.0, 1.0, 0.5]);
    assert_eq!(material.anisotropy.strength, 0.6);
    let direction = Vec2::new(libm::cosf(1.5), libm::sinf(1.5));
    assert!(material.anisotropy.direction.distance(direction) < 1e-6);
    let volume = &mut draft.json["materials"][0]["extensions"]["KHR_materials_volume"];
    *volume = json!({ "thicknessFactor": 0.0 });
    assert_eq!(
        principled(&draft.load().unwrap()).thickness,
        Thickness::ThinWalled
    );
}

/// The visible part of the triangle.
fn met(loaded: &Loaded) -> f32 {
    let end = |z: f32| Locus::in_space(Vec3::new(0.1, 0.1, z));
    1.0 - loaded.scene.transmittance(&end(1.0), &end(-1.0))
}

#[test]
fn alpha_is_coverage_or_cut() {
    let mut draft = Draft::triangle();
    draft.primitive()["material"] = json!(0);
    let mut check = |material: Value, expected: f32| {
        draft.json["materials"] = json!([material]);
        let found = met(&draft.load().unwrap());
        assert!((found - expected).abs() < 1e-6, "{material}: {found}");
    };
    let pbr = json!({ "baseColorFactor": [1, 1, 1, 0.25] });
    check(json!({ "pbrMetallicRoughness": pbr }), 1.0);
    check(
        json!({ "pbrMetallicRoughness": pbr, "alphaMode": "BLEND" }),
        0.25,
    );
    check(
        json!({ "pbrMetallicRoughness": pbr, "alphaMode": "MASK" }),
        0.0,
    );
    check(
        json!({ "pbrMetallicRoughness": pbr, "alphaMode": "MASK", "alphaCutoff": 0.2 }),
        1.0,
    );
}

#[test]
fn emission_is_of_the_front_unless_both_sides_are_asked_for() {
    let mut draft = Draft::triangle();
    draft.primitive()["material"] = json!(0);
    for (both, behind) in [(false, 0.0), (true, 8.0)] {
        draft.json["materials"] = json!([{
            "emissiveFactor": [0.5, 1, 0], "doubleSided": both,
            "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 8 } },
        }]);
        let loaded = draft.load().unwrap();
        let light = loaded.scene.light(0);
        let at = LightPoint {
            locus: Locus::on_surface(Vec3::ZERO, Vec3::Z, 0.0),
            primitive: 0,
        };
        let context = loaded.scene.light_context();
        assert_eq!(
            light.emitted(&context, &at, Vec3::Z, Lanes::Rgb),
            Lanes::Rgb.illuminant([4.0, 8.0, 0.0])
        );
        assert_eq!(
            light.emitted(&context, &at, -Vec3::Z, Lanes::Rgb)[1],
            behind
        );
    }
}

#[test]
fn emissive_textures_are_pictures_that_shine() {
    let mut draft = textured();
    let texture = json!({ "index": 0 });
    draft.json["materials"] = json!([{ "emissiveFactor": [2, 3, 4], "emissiveTexture": texture }]);
    let loaded = draft.load().unwrap();
    for ([x, y], expected) in [
        ([0.1, 0.1], [2.0, 0.0, 0.0]),
        ([0.8, 0.1], [0.0, 3.0, 0.0]),
        ([0.1, 0.8], [0.0, 0.0, 4.0]),
    ] {
        let at = LightPoint {
            locus: Locus::on_surface(Vec3::new(x, y, 0.0), Vec3::Z, 0.0),
            primitive: 0,
        };
        let context = loaded.scene.light_context();
        let found = loaded
            .scene
            .light(0)
            .emitted(&context, &at, Vec3::Z, Lanes::Rgb);
        assert_eq!(Lanes::Rgb.to_rgb(found), expected);
    }
    // A picture that is black all over is no lamp.
    let view = draft.view(&encode_png([1, 1], &[[0.0; 3]]).unwrap());
    draft.json["images"] = json!([{ "bufferView": view, "mimeType": "image/png" }]);
    assert_eq!(draft.load().unwrap().summary.area_lights, 0);
}

#[test]
fn punctual_lights_shine_along_minus_z_of_their_node() {
    let mut draft = Draft::triangle();
    draft.json["nodes"][0]["extensions"] = json!({ "KHR_lights_punctual": { "light": 0 } });
    draft.json["nodes"][0]["rotation"] = json!([1, 0, 0, 0]);
    let lights = |light: Value, draft: &mut Draft| {
        draft.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [light] } });
        draft.load().unwrap().scene.lights()[0].clone()
    };
    let sun = json!({ "type": "directional", "intensity": 3, "color": [1, 0.5, 0] });
    match lights(sun, &mut draft) {
        Light::Distant(light) => {
            assert!(light.to_light.distance(-Vec3::Z) < 1e-6, "{light:?}");
            assert_eq!(light.irradiance, [3.0, 1.5, 0.0].into());
        }
        other => panic!("{other:?}"),
    }
    let spot = json!({ "type": "spot", "spot": { "innerConeAngle": 0.2, "outerConeAngle": 0.8 } });
    let light = lights(spot, &mut draft);
    let at = LightPoint::in_space(Vec3::ZERO);
    let loaded = draft.load().unwrap();
    let context = loaded.scene.light_context();
    for angle in [0.1f32, 0.4, 0.6, 0.9] {
        let w = Vec3::new(libm::sinf(angle), 0.0, libm::cosf(angle));
        let [inner, outer] = [0.2f32, 0.8].map(libm::cosf);
        let linear = ((libm::cosf(angle) - outer) / (inner - outer)).clamp(0.0, 1.0);
        assert!(
            (light.emitted(&context, &at, w, Lanes::Rgb)[0] - linear * linear).abs() < 1e-5,
            "{angle}"
        );
    }
}

fn with_camera(camera: &Value) -> Draft {
    let mut draft = Draft::triangle();
    draft.json["cameras"] = json!([camera]);
    draft.json["nodes"] =
        json!([{ "mesh": 0 }, { "camera": 0, "translation": [0, 0, 4], "scale": [3, 1, 2] }]);
    draft.json["scenes"][0]["nodes"] = json!([0, 1]);
    draft
}

/// The raster position of the direction towards `point`, as part of the film.
pub(super) fn seen(loaded: &Loaded, point: Vec3) -> Vec2 {
    let camera = loaded.view.camera();
    let eye = camera.sample_lens(|| Vec2::ZERO).locus.point;
    let [width, height] = loaded.view.film().resolution.map(|side| side as f32);
    camera.raster(eye, (point - eye).normalize()).unwrap() / Vec2::new(width, height)
}

#[test]
fn cameras_look_along_minus_z_with_their_vertical_angle() {
    let angle = 2.0 * libm::atan(0.5);
    let draft = with_camera(&json!({ "type": "perspective", "perspective":
        { "yfov": angle, "aspectRatio": 1.5, "znear": 0.1 } }));
    let loaded = draft.load().unwrap();
    assert_eq!(loaded.view.film().resolution, [1080, 720]);
    assert!(seen(&loaded, Vec3::ZERO).distance(Vec2::splat(0.5)) < 1e-5);
    assert!(seen(&loaded, Vec3::Y * 2.0).distance(Vec2::new(0.5, 0.0)) < 1e-5);
    assert!(seen(&loaded, Vec3::X * 3.0).distance(Vec2::new(1.0, 0.5)) < 1e-5);
    // A film of another shape keeps everything in view, and stretches nothing.
    for (size, corner) in [
        ([300, 100], Vec3::new(6.0, 2.0, 0.0)),
        ([100, 100], Vec3::new(3.0, 3.0, 0.0)),
    ] {
        let loaded = draft.load_sized(size);
        assert!(seen(&loaded, corner).distance(Vec2::X) < 1e-5, "{size:?}");
    }
}

#[test]
fn without_a_camera_all_is_in_view_and_without_light_it_is_lit() {
    let mut draft = Draft::triangle();
    draft.json["nodes"][0]["translation"] = json!([100, 50, -20]);
    let loaded = draft.load().unwrap();
    for point in &mesh(&loaded, 0).positions {
        let at = seen(&loaded, *point);
        assert!(at.min_element() >= 0.0 && at.max_element() <= 1.0, "{at}");
    }
    assert_eq!(loaded.scene.environment().len(), 1);
    assert_eq!(loaded.warnings.len(), 2, "{:?}", loaded.warnings);
}

#[test]
fn webp_textures_are_read() {
    let mut draft = textured();
    let texels = [255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255];
    let mut webp = Vec::new();
    let encoder = ::image::codecs::webp::WebPEncoder::new_lossless(&mut webp);
    let color = ::image::ExtendedColorType::Rgb8;
    encoder.encode(&texels, 2, 2, color).unwrap();
    let view = draft.view(&webp);
    draft.json["images"] = json!([{ "bufferView": view, "mimeType": "image/webp" }]);
    let source = json!({ "EXT_texture_webp": { "source": 0 } });
    draft.json["textures"] = json!([{ "sampler": 0, "extensions": source }]);
    draft.json["extensionsRequired"] = json!(["EXT_texture_webp"]);
    let loaded = draft.load().unwrap();
    check_color(&loaded, [0.1, 0.1], RED);
    check_color(&loaded, [0.9, 0.1], GREEN);
    check_color(&loaded, [0.1, 0.9], BLUE);
}

#[test]
fn orthographic_cameras_see_parallel_rays() {
    let draft = with_camera(&json!({ "type": "orthographic", "orthographic":
        { "xmag": 3, "ymag": 2, "znear": 0.1, "zfar": 9 } }));
    let loaded = draft.load().unwrap();
    assert_eq!(loaded.view.film().resolution, [1080, 720]);
    let at = |loaded: &Loaded, point: Vec3| {
        let [width, height] = loaded.view.film().resolution.map(|side| side as f32);
        let raster = loaded.view.camera().raster(point, -Vec3::Z).unwrap();
        raster / Vec2::new(width, height)
    };
    for depth in [0.0, -70.0] {
        let corner = Vec3::new(3.0, 2.0, depth);
        assert!(at(&loaded, corner).distance(Vec2::X) < 1e-5);
        assert!(at(&loaded, -corner.with_z(-depth)).distance(Vec2::Y) < 1e-5);
    }
    let square = draft.load_sized([100, 100]);
    assert!(at(&square, Vec3::new(3.0, 3.0, 0.0)).distance(Vec2::X) < 1e-5);
}

#[test]
fn crops_are_parts_of_the_film() {
    let draft = Draft::triangle();
    let options = LoadOptions {
        crop: Some(Crop::Fractions([0.0, 0.5, 0.5, 1.0])),
        ..LoadOptions::default()
    };
    let loaded = load_bytes("a.gltf", &draft.gltf(), &options).unwrap();
    assert_eq!(loaded.view.film().crop.max, [640, 720]);
    let options = LoadOptions {
        crop: Some(Crop::Pixels([5000, 6000, 0, 10])),
        ..options
    };
    let error = load_bytes("a.gltf", &draft.gltf(), &options).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Options);
}

#[test]
fn colours_of_vertices_multiply_the_base_colour() {
    let mut draft = textured();
    let colors = draft.accessor(&floats(&[0.5, 0.5, 0.5].repeat(3)), (F32, "VEC3", 3));
    draft.primitive()["attributes"]["COLOR_0"] = json!(colors);
    check_color(&draft.load().unwrap(), [0.1, 0.1], [0.5, 0.0, 0.0]);
    let colors = draft.accessor(
        &floats(&[1.0, 0.5, 0.0, 0.0, 0.5, 0.0, 0.5, 0.5, 0.0]),
        (F32, "VEC3", 3),
    );
    draft.primitive()["attributes"]["COLOR_0"] = json!(colors);
    check_color(&draft.load().unwrap(), [0.1, 0.1], [0.5, 0.0, 0.0]);
}

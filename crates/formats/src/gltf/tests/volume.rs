//! Coloured glass: light that travels the attenuation distance in it keeps the attenuation colour.

use super::*;
use bidir::driver::{Resources, Session, Settings};
use bidir::integrator::IntegratorKind;

/// The faces of a box, seen from outside: those towards +z and -z first. Corners are counted around +z, below first.
pub(super) const BOX: [u16; 36] = [
    4, 5, 6, 4, 6, 7, 0, 2, 1, 0, 3, 2, // across z
    0, 1, 5, 0, 5, 4, 1, 2, 6, 1, 6, 5, // around it
    2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7,
];

/// Glass that does not bend light, of half the attenuation distance, between a lamp and a small camera of parallel rays
/// along -z.
fn pane(volume: &Value) -> Draft {
    pane_of(1.0, volume)
}

/// The same with another index of refraction.
fn pane_of(ior: f32, volume: &Value) -> Draft {
    let mut draft = Draft::empty();
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let at = |z: f32| corners.map(|[x, y]| [x, y, z]);
    let positions: Vec<f32> = [at(0.0), at(0.5)].concat().concat();
    draft.accessor(&floats(&positions), (F32, "VEC3", 8));
    draft.accessor(&shorts(&BOX), (U16, "SCALAR", 36));
    draft.accessor(&shorts(&BOX[..6]), (U16, "SCALAR", 6));
    draft.json["materials"] = json!([
        { "extensions": {
            "KHR_materials_ior": { "ior": ior },
            "KHR_materials_transmission": { "transmissionFactor": 1 },
            "KHR_materials_volume": volume,
        }, "pbrMetallicRoughness": { "roughnessFactor": 0, "metallicFactor": 0 } },
        { "emissiveFactor": [1, 1, 1] },
    ]);
    let primitive = |indices: usize, material: usize| {
        json!({ "primitives": [{
            "attributes": { "POSITION": 0 }, "indices": indices, "material": material,
        }] })
    };
    draft.json["meshes"] = json!([primitive(1, 0), primitive(2, 1)]);
    draft.json["cameras"] = json!([{ "type": "orthographic",
        "orthographic": { "xmag": 0.1, "ymag": 0.1, "znear": 0, "zfar": 10 } }]);
    draft.json["nodes"] = json!([
        { "mesh": 0 },
        { "mesh": 1, "translation": [0, 0, -2] },
        { "camera": 0, "translation": [0, 0, 3] },
    ]);
    draft.json["scenes"] = json!([{ "nodes": [0, 1, 2] }]);
    draft
}

/// The light of the lamp that the camera gets.
pub(super) fn seen(draft: &Draft) -> [f32; 3] {
    seen_by(draft, IntegratorKind::Path, 1)
}

pub(super) fn seen_by(draft: &Draft, integrator: IntegratorKind, passes: u32) -> [f32; 3] {
    seen_within(draft, integrator, 32, passes)
}

/// Returns the light that the camera gets by paths of at most `max_depth` bounces.
pub(super) fn seen_within(
    draft: &Draft,
    integrator: IntegratorKind,
    max_depth: u32,
    passes: u32,
) -> [f32; 3] {
    let loaded = draft.load_sized([1, 1]);
    let (mut settings, resources) = (Settings::new(integrator), Resources::default());
    settings.path.max_depth = Some(max_depth);
    let session = Session::new(&loaded.scene, &loaded.view, settings, &resources);
    let mut session = session.expect("a small film");
    for _ in 0..passes {
        session.step(&());
    }
    session.film().develop().pixels[0]
}

/// Green of half the distance.
fn green() -> Value {
    json!({ "thicknessFactor": 1, "attenuationDistance": 1, "attenuationColor": [0.04, 0.25, 1] })
}

#[track_caller]
fn check(draft: &Draft, expected: [f32; 3]) {
    let light = seen(draft);
    for (found, expected) in light.into_iter().zip(expected) {
        assert!((found - expected).abs() < 1e-3 * expected, "{light:?}");
    }
}

#[test]
fn half_the_distance_leaves_the_root_of_the_colour() {
    let expected = [0.2, 0.5, 1.0];
    check(&pane(&green()), expected);
    let mut twice = pane(&green());
    let nodes = twice.json["nodes"].as_array_mut().unwrap();
    nodes.push(json!({ "mesh": 0, "translation": [5, 0, 0] }));
    twice.json["scenes"][0]["nodes"] = json!([0, 1, 2, 3]);
    check(&twice, expected);
    // The distance is one of the world, whatever the size of the glass in its own coordinates.
    let mut scaled = pane(&green());
    scaled.json["nodes"][0]["scale"] = json!([1, 1, 2]);
    check(&scaled, expected.map(|part| part * part));
}

/// R = 4 % on each face, and light that goes to and fro between them.
#[test]
fn refracting_glass_absorbs_what_gets_in() {
    let expected = [0.2f32, 0.5, 1.0].map(|part| {
        let inside = 0.04 * part;
        0.96 * 0.96 * part / (1.0 - inside * inside)
    });
    for integrator in [IntegratorKind::Path, IntegratorKind::Bdpt] {
        let light = seen_by(&pane_of(1.5, &green()), integrator, 1 << 14);
        for (found, expected) in light.into_iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 0.02, "{light:?}");
        }
    }
}

#[test]
fn the_distance_follows_the_unit_of_a_huge_scene() {
    const SCALE: f32 = 1e8;
    let mut volume = green();
    volume["attenuationDistance"] = json!(SCALE);
    let mut draft = pane(&volume);
    let nodes = draft.json["nodes"].as_array_mut().unwrap();
    nodes.push(json!({ "scale": [SCALE, SCALE, SCALE], "children": [0, 1, 2] }));
    draft.json["scenes"][0]["nodes"] = json!([3]);
    check(&draft, [0.2, 0.5, 1.0]);
}

#[test]
fn a_sheet_encloses_nothing() {
    let mut draft = pane(&green());
    // One face, in place of both.
    draft.json["meshes"][0]["primitives"][0]["indices"] = json!(2);
    check(&draft, [1.0; 3]);
    let loaded = draft.load().expect("it is valid");
    let expected = "the mesh encloses nothing: it is a thin wall, without a volume";
    assert_eq!(warnings(&loaded, expected), 1);
}

#[test]
fn volumes_are_clear_without_an_end_or_a_colour_and_thin_walls_have_none() {
    for key in ["attenuationDistance", "attenuationColor", "thicknessFactor"] {
        let mut volume = green();
        volume.as_object_mut().unwrap().remove(key);
        check(&pane(&volume), [1.0; 3]);
    }
}

#[test]
fn a_channel_of_nothing_is_dark() {
    let mut volume = green();
    volume["attenuationColor"] = json!([0, 0, 0.25]);
    let [red, _, blue] = seen(&pane(&volume));
    assert!(red < 1e-6 && (blue - 0.5).abs() < 1e-3, "{red} {blue}");
}

#[test]
fn opaque_materials_have_no_inside() {
    let mut draft = pane(&green());
    draft.json["materials"][0]["extensions"]["KHR_materials_transmission"] = json!({});
    assert!(!draft.load().expect("it is valid").scene.has_media());
}

//! Scenes without a camera, or without light of consequence.

use super::look::seen;
use super::{Draft, F32, floats, warnings};
use crate::import::Loaded;
use bidir::light::LightPoint;
use bidir::math::{Vec3, sin_cos};
use bidir::spectrum::Lanes;
use serde_json::{Value, json};

/// The part of the film that the triangle covers, seen from where there is no camera.
fn covered(corners: [[f32; 3]; 3]) -> f32 {
    let mut draft = Draft::triangle();
    let positions = draft.accessor(&floats(&corners.concat()), (F32, "VEC3", 3));
    draft.primitive()["attributes"]["POSITION"] = json!(positions);
    let loaded = draft.load().unwrap();
    let [a, b, c] = corners.map(|corner| seen(&loaded, Vec3::from(corner)));
    for at in [a, b, c] {
        assert!(at.min_element() >= 0.0 && at.max_element() <= 1.0, "{at}");
    }
    (b - a).perp_dot(c - a).abs() / 2.0
}

#[test]
fn flat_scenes_are_not_seen_edge_on() {
    let floor = [[0.0, 1.0, 0.0], [4.0, 1.0, 0.0], [0.0, 1.0, 4.0]];
    let side = [[2.0, 0.0, 0.0], [2.0, 3.0, 0.0], [2.0, 0.0, 3.0]];
    let slope = [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    // Edge-on from the front and from above it.
    let across = [[0.0, 0.0, 0.0], [0.5, 0.7, 0.0], [0.0, 0.0, 1.0]];
    for corners in [floor, side, slope, across] {
        assert!(covered(corners) > 0.03, "{corners:?} {}", covered(corners));
    }
    // The front stays the front.
    let front = covered([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    let half_of_a_square = 0.5 * 9.0 / 16.0 / (1.05 * 1.05);
    assert!((front - half_of_a_square).abs() < 1e-3, "{front}");
}

/// The radiance of what surrounds a scene without light, in directions from the viewer.
#[test]
fn surfaces_differ_from_the_background_whatever_their_colour() {
    let loaded = Draft::triangle().load().unwrap();
    let scene = &loaded.scene;
    let light = &scene.lights()[scene.environment()[0] as usize];
    let radiance = |direction: Vec3| {
        let at = LightPoint::at_infinity(direction);
        light.emitted(&scene.light_context(), &at, -direction, Lanes::Rgb)[0]
    };
    let background = radiance(Vec3::NEG_Z);
    assert!((background - 0.25).abs() < 1e-6, "{background}");
    // A white surface towards the viewer: the mean over directions around the normal, by the cosine.
    let rings = [0.1, 0.3, 0.5, 0.7, 0.9_f32].map(|squared: f32| {
        let (cos, sin) = (squared.sqrt(), (1.0 - squared).sqrt());
        let around = (0..12).map(|i| std::f32::consts::TAU * i as f32 / 12.0);
        let values = around.map(|phi| {
            let (y, x) = sin_cos(phi);
            radiance(Vec3::new(sin * x, sin * y, cos))
        });
        values.sum::<f32>() / 12.0
    });
    let white = rings.iter().sum::<f32>() / 5.0;
    assert!((0.6..1.0).contains(&white), "{white}");
}

/// A quadrilateral with its front where it goes around in the positive direction.
type Quad = [[f32; 3]; 4];

/// The faces of a box around the origin, with their fronts outside.
fn faces_of_box(half: [f32; 3]) -> Vec<Quad> {
    let corner = |signs: [f32; 3]| [0, 1, 2].map(|axis| signs[axis] * half[axis]);
    let face = |axis: usize, sign: f32| {
        let at = |u: f32, v: f32| {
            let mut signs = [sign; 3];
            (signs[(axis + 1) % 3], signs[(axis + 2) % 3]) = (u * sign, v);
            corner(signs)
        };
        [at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)]
    };
    (0..3)
        .flat_map(|axis| [face(axis, -1.0), face(axis, 1.0)])
        .collect()
}

fn turned(quads: Vec<Quad>) -> Vec<Quad> {
    quads.into_iter().map(|[a, b, c, d]| [d, c, b, a]).collect()
}

/// Loads a scene of two meshes, of which the second emits, and a point light if there is a place for it.
fn with_lamps(walls: &[Quad], lamps: &[Quad], light: Option<[f32; 3]>) -> Loaded {
    let mut draft = Draft::empty();
    let mut primitive = |quads: &[Quad], material: usize| -> Value {
        let corners = quads.iter().flat_map(|[a, b, c, d]| [a, b, c, a, c, d]);
        let numbers: Vec<f32> = corners.flatten().copied().collect();
        let positions = draft.accessor(&floats(&numbers), (F32, "VEC3", 6 * quads.len()));
        json!({ "attributes": { "POSITION": positions }, "material": material })
    };
    let mut primitives = vec![primitive(walls, 0)];
    if !lamps.is_empty() {
        primitives.push(primitive(lamps, 1));
    }
    draft.json["meshes"] = json!([{ "primitives": primitives }]);
    draft.json["materials"] = json!([{}, { "emissiveFactor": [1, 1, 1] }]);
    draft.json["nodes"] = json!([{ "mesh": 0 }]);
    draft.json["scenes"] = json!([{ "nodes": [0] }]);
    if let Some(place) = light {
        let lights = json!({ "lights": [{ "type": "point", "intensity": 10 }] });
        draft.json["extensions"] = json!({ "KHR_lights_punctual": lights });
        draft.json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
        let node = json!({ "translation": place,
            "extensions": { "KHR_lights_punctual": { "light": 0 } } });
        draft.json["nodes"] = json!([{ "mesh": 0 }, node]);
        draft.json["scenes"] = json!([{ "nodes": [0, 1] }]);
    }
    draft.load().unwrap()
}

fn has_sky(loaded: &Loaded) -> bool {
    !loaded.scene.environment().is_empty()
}

/// Returns true if the camera stands in a box around the origin.
fn is_inside(loaded: &Loaded, half: [f32; 3]) -> bool {
    let eye = loaded
        .scene
        .space()
        .world_point(loaded.view.camera().pose().origin);
    eye.abs().cmplt(Vec3::from(half).as_dvec3()).all()
}

const ROOM: [f32; 3] = [3.0, 1.5, 2.0];

/// A square of half size `half` under the ceiling of the room, with its front below.
fn ceiling_lamp(half: f32) -> Quad {
    let y = 1.49;
    [
        [-half, y, -half],
        [half, y, -half],
        [half, y, half],
        [-half, y, half],
    ]
}

#[test]
fn closed_rooms_are_seen_from_inside() {
    let walls = faces_of_box(ROOM);
    let lamp = [ceiling_lamp(0.5)];
    // Walls with their fronts on either side, and a lamp of either kind.
    for walls in [turned(walls.clone()), walls] {
        for loaded in [
            with_lamps(&walls, &[], Some([0.5, 0.5, 0.2])),
            with_lamps(&walls, &lamp, None),
        ] {
            assert!(is_inside(&loaded, ROOM), "{:?}", loaded.warnings);
            assert!(!has_sky(&loaded));
            assert_eq!(warnings(&loaded, "one inside it"), 1);
        }
    }
}

#[test]
fn open_rooms_and_solids_are_seen_from_outside() {
    let mut walls = turned(faces_of_box(ROOM));
    // Without the wall in front.
    walls.pop();
    let open = with_lamps(&walls, &[ceiling_lamp(0.5)], None);
    assert!(
        !is_inside(&open, ROOM) && !has_sky(&open),
        "{:?}",
        open.warnings
    );
    let solid = faces_of_box([1.0; 3]);
    let lit = with_lamps(&solid, &[], Some([2.0, 2.0, 4.0]));
    assert!(
        !is_inside(&lit, [1.0; 3]) && !has_sky(&lit),
        "{:?}",
        lit.warnings
    );
}

/// A helmet whose eyes glow is dark but for them.
#[test]
fn a_little_emission_is_no_light() {
    let helmet = faces_of_box([1.0; 3]);
    let eye = |x: f32| {
        [
            [x, 0.1, 1.01],
            [x + 0.2, 0.1, 1.01],
            [x + 0.2, 0.2, 1.01],
            [x, 0.2, 1.01],
        ]
    };
    let loaded = with_lamps(&helmet, &[eye(-0.5), eye(0.3)], None);
    assert!(
        has_sky(&loaded) && !is_inside(&loaded, [1.0; 3]),
        "{:?}",
        loaded.warnings
    );
    assert_eq!(warnings(&loaded, "leave the scene dark"), 1);
    // A sign that shines over all of the front is seen, and a lamp before it lights it.
    let mut sign = faces_of_box([1.0; 3]);
    let front = sign.pop().unwrap();
    assert!(!has_sky(&with_lamps(&sign, &[front], None)));
    let y = -1.2;
    let lamp = [[-1.0, y, 3.2], [1.0, y, 3.2], [1.0, y, 1.2], [-1.0, y, 1.2]];
    let lit = with_lamps(&helmet, &[lamp], None);
    assert!(!has_sky(&lit), "{:?}", lit.warnings);
}

//! Scenes without a camera, or without light.

use super::look::seen;
use super::{Draft, F32, floats};
use bidir::light::LightPoint;
use bidir::math::Vec3;
use serde_json::json;

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
        let [red, ..] = light.emitted(&scene.light_context(), &at, -direction);
        red
    };
    let background = radiance(Vec3::NEG_Z);
    assert!((background - 0.25).abs() < 1e-6, "{background}");
    // A white surface towards the viewer: the mean over directions around the normal, by the cosine.
    let rings = [0.1, 0.3, 0.5, 0.7, 0.9_f32].map(|squared: f32| {
        let (cos, sin) = (squared.sqrt(), (1.0 - squared).sqrt());
        let around = (0..12).map(|i| std::f32::consts::TAU * i as f32 / 12.0);
        let values = around.map(|phi| radiance(Vec3::new(sin * phi.cos(), sin * phi.sin(), cos)));
        values.sum::<f32>() / 12.0
    });
    let white = rings.iter().sum::<f32>() / 5.0;
    assert!((0.6..1.0).contains(&white), "{white}");
}

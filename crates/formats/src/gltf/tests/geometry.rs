use super::{Draft, front, mesh};
use crate::pbrt::Loaded;
use bidir::light::Light;
use bidir::math::{DVec3, Vec3};
use bidir::sampler::{Domain, Sampler, SamplerKind};
use bidir::scene::RayDraws;
use serde_json::json;

/// A mirrored mesh keeps its front: what pointed along +z does so still, or along -z where z itself is
/// turned.
#[test]
fn mirrored_nodes_turn_the_winding() {
    for (scale, normal) in [
        ([-1, 1, 1], Vec3::Z),
        ([1, 1, -1], -Vec3::Z),
        ([-1, -1, -1], -Vec3::Z),
    ] {
        let mut draft = Draft::triangle();
        draft.json["nodes"][0]["scale"] = json!(scale);
        let loaded = draft.load().unwrap();
        assert!(
            front(mesh(&loaded, 0), 0).distance(normal) < 1e-6,
            "{scale:?}"
        );
        // Shared objects likewise.
        draft.json["nodes"] = json!([{ "mesh": 0, "scale": scale }, { "mesh": 0 }]);
        draft.json["scenes"][0]["nodes"] = json!([0, 1]);
        let loaded = draft.load().unwrap();
        let origin = Vec3::new(0.2 * scale[0] as f32, 0.2 * scale[1] as f32, 5.0);
        let stream = Sampler::new(SamplerKind::Independent, 0).stream(Domain::Camera, 0, 0);
        let chances = RayDraws::new(&stream, 1);
        let hit = loaded.scene.intersect(origin, -Vec3::Z, chances).unwrap();
        assert!(hit.surface.n_g.distance(normal) < 1e-6, "{scale:?}");
    }
}

/// A triangle whose node and whose parallel camera are moved, or scaled.
fn placed(translation: [f64; 3], scale: f64) -> Loaded {
    let mut draft = Draft::triangle();
    let [x, y, z] = translation;
    draft.json["cameras"] = json!([{ "type": "orthographic",
        "orthographic": { "xmag": scale, "ymag": scale, "znear": 0, "zfar": 1 } }]);
    let sizes = [scale; 3];
    draft.json["nodes"] = json!([
        { "mesh": 0, "translation": translation, "scale": sizes },
        { "camera": 0, "translation": [x, y, z + 3.0 * scale] },
        { "translation": [x, y + scale, z],
          "extensions": { "KHR_lights_punctual": { "light": 0 } } }
    ]);
    draft.json["extensions"] =
        json!({ "KHR_lights_punctual": { "lights": [{ "type": "point" }] } });
    draft.json["scenes"] = json!([{ "nodes": [0, 1, 2] }]);
    draft.load().unwrap()
}

#[test]
fn nodes_that_are_far_away_keep_their_shape() {
    let Loaded { scene, view, .. } = placed([0.1, -3e6, 1e7], 1.0);
    let (space, bounds) = (scene.space(), scene.bvh().bounds());
    assert!(bounds.max.length() < 3.0, "{bounds:?}");
    let world = |p| space.world_point(p) - DVec3::new(0.1, -3e6, 1e7);
    assert!(world(bounds.min).length() < 1e-6, "{bounds:?}");
    assert!((world(view.camera().pose().origin) - DVec3::Z * 3.0).length() < 1e-6);
}

#[test]
fn what_is_seen_of_a_tiny_or_huge_file_is_the_same() {
    let [unit, tiny, huge] = [1.0, 1e-9, 1e9].map(|scale| placed([0.0; 3], scale));
    assert_eq!(unit.scene.space().unit.to_bits(), 1.0f64.to_bits());
    for (loaded, scale) in [(&tiny, 1e-9), (&huge, 1e9)] {
        let scene = &loaded.scene;
        assert_ne!(scene.space().unit.to_bits(), 1.0f64.to_bits());
        let raster = |Loaded { scene, view, .. }: &Loaded| {
            let corner = scene.bvh().bounds().max;
            view.camera().raster(corner, Vec3::NEG_Z)
        };
        let [found, expected] = [loaded, &unit].map(|loaded| raster(loaded).unwrap());
        assert!(found.distance(expected) < 1e-2, "{found} {expected}");
        let Light::Point(light) = scene.light(0) else {
            panic!("the light is a point");
        };
        let irradiance =
            f64::from(light.intensity.color()[0] / (light.position.y * light.position.y));
        assert!(
            (irradiance * scale * scale - 1.0).abs() < 1e-5,
            "{irradiance}"
        );
    }
}

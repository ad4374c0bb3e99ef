use super::{Draft, F32, U8, U16, check_points, floats, front, mesh, shorts};
use crate::pbrt::Loaded;
use bidir::light::Light;
use bidir::math::{DVec3, Vec2, Vec3};
use bidir::sampler::{Domain, Sampler, SamplerKind};
use bidir::scene::RayDraws;
use serde_json::json;

/// Five corners of a fan or a zigzag.
fn five() -> Draft {
    let mut draft = Draft::empty();
    let corners = [
        0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 0.0, 2.0, 0.0,
    ];
    draft.accessor(&floats(&corners), (F32, "VEC3", 5));
    draft.json["meshes"] = json!([{ "primitives": [{ "attributes": { "POSITION": 0 } }] }]);
    draft.json["nodes"] = json!([{ "mesh": 0 }]);
    draft.json["scenes"] = json!([{ "nodes": [0] }]);
    draft
}

#[test]
fn strips_and_fans_keep_their_winding() {
    let mut strip = five();
    strip.primitive()["mode"] = json!(5);
    let loaded = strip.load().unwrap();
    let triangles = &mesh(&loaded, 0).triangles;
    assert_eq!(triangles[..], [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
    for i in 0..3 {
        assert!(front(mesh(&loaded, 0), i).z > 0.9, "{i}");
    }
    let mut fan = five();
    fan.primitive()["mode"] = json!(6);
    let loaded = fan.load().unwrap();
    assert_eq!(
        mesh(&loaded, 0).triangles[..],
        [[1, 2, 0], [2, 3, 0], [3, 4, 0]]
    );
    let mut lines = five();
    lines.primitive()["mode"] = json!(1);
    let loaded = lines.load().unwrap();
    assert!(loaded.scene.shapes().is_empty());
    assert!(
        loaded
            .warnings
            .iter()
            .any(|warning| warning.contains("points and lines"))
    );
}

#[test]
fn indices_of_every_size_are_read() {
    for (bytes, component) in [(vec![0, 1, 2], U8), (shorts(&[0, 1, 2]), U16)] {
        let mut draft = Draft::triangle();
        let indices = draft.accessor(&bytes, (component, "SCALAR", 3));
        draft.primitive()["indices"] = json!(indices);
        assert_eq!(mesh(&draft.load().unwrap(), 0).triangles, [[0, 1, 2]]);
    }
}

#[test]
fn sparse_accessors_replace_values_of_others_or_zeros() {
    let mut draft = Draft::triangle();
    let indices = draft.view(&[2]);
    let values = draft.view(&floats(&[5.0, 6.0, 7.0]));
    let sparse = json!({
        "count": 1,
        "indices": { "bufferView": indices, "componentType": U8 },
        "values": { "bufferView": values },
    });
    draft.json["accessors"][0]["sparse"] = sparse;
    let expected = [[0.0; 3], [1.0, 0.0, 0.0], [5.0, 6.0, 7.0]];
    check_points(&mesh(&draft.load().unwrap(), 0).positions, &expected);
    let accessor = draft.json["accessors"][0].as_object_mut().unwrap();
    accessor.remove("bufferView");
    let expected = [[0.0; 3], [0.0; 3], [5.0, 6.0, 7.0]];
    check_points(&mesh(&draft.load().unwrap(), 0).positions, &expected);
}

#[test]
fn interleaved_and_quantised_attributes_are_read() {
    let mut draft = Draft::triangle();
    // Positions in i16 normalised, then normals in i8 normalised, 12 bytes apart.
    let mut bytes = Vec::new();
    for (x, y) in [(0, 0), (32767, 0), (0, -32767)] {
        bytes.extend(shorts(&[x as u16, (y as i16) as u16, 0, 0]));
        bytes.extend([0, 0, 127, 0]);
    }
    let view = draft.view(&bytes);
    draft.json["bufferViews"][view]["byteStride"] = json!(12);
    draft.json["accessors"] = json!([
        { "bufferView": view, "componentType": 5122, "normalized": true, "type": "VEC3", "count": 3 },
        { "bufferView": view, "byteOffset": 8, "componentType": 5120, "normalized": true, "type": "VEC3",
          "count": 3 },
    ]);
    draft.primitive()["attributes"] = json!({ "POSITION": 0, "NORMAL": 1 });
    draft.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    draft.json["nodes"][0]["scale"] = json!([4, 4, 4]);
    let loaded = draft.load().unwrap();
    check_points(
        &mesh(&loaded, 0).positions,
        &[[0.0; 3], [4.0, 0.0, 0.0], [0.0, -4.0, 0.0]],
    );
    check_points(&mesh(&loaded, 0).normals, &[[0.0, 0.0, 1.0]; 3]);
}

#[test]
fn transformations_of_ancestors_come_first() {
    let mut draft = Draft::triangle();
    let half = std::f32::consts::FRAC_1_SQRT_2;
    draft.json["nodes"] = json!([
        { "translation": [0, 0, 10], "rotation": [0, 0, half, half], "scale": [2, 1, 1], "children": [1] },
        { "mesh": 0, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 3,0,0,1] },
    ]);
    let loaded = draft.load().unwrap();
    let expected = [[0.0, 6.0, 10.0], [0.0, 8.0, 10.0], [-1.0, 6.0, 10.0]];
    check_points(&mesh(&loaded, 0).positions, &expected);
}

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

#[test]
fn meshes_of_several_nodes_are_shared_and_lights_are_not() {
    let mut draft = Draft::triangle();
    draft.json["nodes"] = json!([
        { "mesh": 0 }, { "mesh": 0, "translation": [5, 0, 0] }, { "mesh": 0, "scale": [0, 0, 0] },
    ]);
    draft.json["scenes"][0]["nodes"] = json!([0, 1, 2]);
    let loaded = draft.load().unwrap();
    assert_eq!(
        (loaded.scene.instance_count(), loaded.summary.instances),
        (2, 2)
    );
    assert_eq!(
        (
            loaded.scene.unique_primitives(),
            loaded.scene.placed_primitives()
        ),
        (1, 2)
    );
    draft.json["materials"] = json!([{ "emissiveFactor": [1, 1, 1] }]);
    draft.primitive()["material"] = json!(0);
    let loaded = draft.load().unwrap();
    assert_eq!(
        (loaded.scene.instance_count(), loaded.summary.area_lights),
        (0, 2)
    );
}

#[test]
fn instances_of_a_node_are_placed_each_by_its_own_map() {
    let mut draft = Draft::triangle();
    let translations = draft.accessor(&floats(&[0.0, 0.0, 1.0, 0.0, 0.0, 2.0]), (F32, "VEC3", 2));
    let scales = draft.accessor(&floats(&[1.0, 1.0, 1.0, 3.0, 3.0, 3.0]), (F32, "VEC3", 2));
    draft.json["nodes"][0]["extensions"] = json!({ "EXT_mesh_gpu_instancing":
        { "attributes": { "TRANSLATION": translations, "SCALE": scales } } });
    let loaded = draft.load().unwrap();
    let bounds = loaded.scene.bvh().bounds();
    assert!(
        bounds.max.distance(Vec3::new(3.0, 3.0, 2.0)) < 1e-4,
        "{bounds:?}"
    );
    assert_eq!(loaded.scene.instance_count(), 2);
}

#[test]
fn morph_targets_are_added_by_default_weights() {
    let mut draft = Draft::triangle();
    let target = draft.accessor(
        &floats(&[0.0, 0.0, 2.0, 0.0, 0.0, 2.0, 0.0, 0.0, 2.0]),
        (F32, "VEC3", 3),
    );
    draft.primitive()["targets"] = json!([{ "POSITION": target }]);
    draft.json["meshes"][0]["weights"] = json!([0.5]);
    let at = |draft: &Draft| mesh(&draft.load().unwrap(), 0).positions[1];
    assert_eq!(at(&draft), Vec3::new(1.0, 0.0, 1.0));
    draft.json["nodes"][0]["weights"] = json!([2.0]);
    assert_eq!(at(&draft), Vec3::new(1.0, 0.0, 4.0));
}

/// Tangents move as the surface does, and need normals beside them.
#[test]
fn tangents_are_those_of_the_file() {
    let mut draft = Draft::triangle();
    let normals = draft.accessor(&floats(&[0.0, 0.0, 1.0].repeat(3)), (F32, "VEC3", 3));
    let tangents = draft.accessor(&floats(&[0.6, 0.8, 0.0, -1.0].repeat(3)), (F32, "VEC4", 3));
    draft.primitive()["attributes"]["TANGENT"] = json!(tangents);
    assert!(mesh(&draft.load().unwrap(), 0).tangents.is_empty());
    draft.primitive()["attributes"]["NORMAL"] = json!(normals);
    draft.json["nodes"][0]["scale"] = json!([-4, 3, 1]);
    let expected = [-1.0, 1.0, 0.0].map(|x: f32| x * 0.5f32.sqrt());
    check_points(&mesh(&draft.load().unwrap(), 0).tangents, &[expected; 3]);
    let target = draft.accessor(&floats(&[0.0, -1.6, 0.0].repeat(3)), (F32, "VEC3", 3));
    draft.primitive()["targets"] = json!([{ "TANGENT": target }]);
    draft.json["meshes"][0]["weights"] = json!([1]);
    let expected = [-1.0, -1.0, 0.0].map(|x: f32| x * 0.5f32.sqrt());
    check_points(&mesh(&draft.load().unwrap(), 0).tangents, &[expected; 3]);
}

#[test]
fn skinned_vertices_follow_their_joints_and_not_their_node() {
    let mut draft = Draft::triangle();
    let joints = draft.accessor(&[0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0], (U8, "VEC4", 3));
    let weights = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0];
    let weights = draft.accessor(&floats(&weights), (F32, "VEC4", 3));
    draft.primitive()["attributes"] =
        json!({ "POSITION": 0, "JOINTS_0": joints, "WEIGHTS_0": weights });
    draft.json["skins"] = json!([{ "joints": [1, 2] }]);
    draft.json["nodes"] = json!([
        { "mesh": 0, "skin": 0, "translation": [100, 0, 0] },
        { "translation": [0, 0, 1] }, { "translation": [0, 0, 3] },
    ]);
    draft.json["scenes"][0]["nodes"] = json!([0, 1, 2]);
    let loaded = draft.load().unwrap();
    let expected = [[0.0, 0.0, 1.0], [1.0, 0.0, 3.0], [0.0, 1.0, 2.0]];
    check_points(&mesh(&loaded, 0).positions, &expected);
}

/// Coordinates of textures go down in the file and up in the renderer.
#[test]
fn the_upper_left_corner_is_the_origin_of_textures() {
    let mut draft = Draft::triangle();
    let uvs = draft.accessor(&[0, 0, 255, 0, 0, 255], (U8, "VEC2", 3));
    draft.json["accessors"][uvs]["normalized"] = json!(true);
    draft.primitive()["attributes"]["TEXCOORD_0"] = json!(uvs);
    let loaded = draft.load().unwrap();
    assert_eq!(mesh(&loaded, 0).uvs, [Vec2::Y, Vec2::ONE, Vec2::ZERO]);
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
        let irradiance = f64::from(light.intensity[0] / (light.position.y * light.position.y));
        assert!(
            (irradiance * scale * scale - 1.0).abs() < 1e-5,
            "{irradiance}"
        );
    }
}

#[test]
fn vertices_far_from_their_node_are_warned_of() {
    let mut draft = Draft::empty();
    let corners = [1e6, 0.0, 0.0, 1e6 + 2.0, 0.0, 0.0, 1e6, 2.0, 0.0];
    draft.accessor(&floats(&corners), (F32, "VEC3", 3));
    draft.json["meshes"] = json!([{ "primitives": [{ "attributes": { "POSITION": 0 } }] }]);
    draft.json["nodes"] = json!([{ "mesh": 0 }]);
    draft.json["scenes"] = json!([{ "nodes": [0] }]);
    let loaded = draft.load().unwrap();
    let warnings = loaded.warnings.iter();
    let found: Vec<_> = warnings.filter(|text| text.contains("32-bit")).collect();
    assert_eq!(found.len(), 1, "{:?}", loaded.warnings);
    assert!(found[0].contains("meshes[0].primitives[0]: coordinates of 1.00e6"));
}

/// Attributes that cannot be used have substitutes; positions are refused elsewhere.
#[test]
fn attributes_are_repaired_with_a_warning() {
    let mut draft = Draft::triangle();
    let nan = f32::NAN;
    let normals = draft.accessor(
        &floats(&[nan, 0., 1., 0., 0., -1., 0., 0., 0.]),
        (F32, "VEC3", 3),
    );
    let tangents = [1., 0., 0., 1., 0., nan, 0., 1., 1., 0., 0., 1.];
    let tangents = draft.accessor(&floats(&tangents), (F32, "VEC4", 3));
    let uvs = draft.accessor(
        &floats(&[f32::INFINITY, 0., 1., 0., 0., 1.]),
        (F32, "VEC2", 3),
    );
    let indices = draft.accessor(&[0, 1, 2, 0, 0, 1], (U8, "SCALAR", 6));
    draft.primitive()["indices"] = json!(indices);
    draft.primitive()["attributes"] =
        json!({ "POSITION": 0, "NORMAL": normals, "TANGENT": tangents, "TEXCOORD_0": uvs });
    let loaded = draft.load().unwrap();
    let mesh = mesh(&loaded, 0);
    check_points(&mesh.normals, &[[0.0, 0.0, -1.0]; 3]);
    assert_eq!(mesh.uvs, [Vec2::Y, Vec2::ONE, Vec2::ZERO]);
    assert!(mesh.tangents.is_empty() && mesh.triangles.len() == 2);
    for expected in [
        "meshes[0].primitives[0]: 1 faces have no area",
        "2 normals are not finite or zero",
        "1 tangents are not finite or zero",
        "1 texture coordinates are not finite",
    ] {
        assert!(
            loaded.warnings.iter().any(|it| it.contains(expected)),
            "{:?}",
            loaded.warnings
        );
    }
}

/// Joints that are not there do not move vertices.
#[test]
fn weights_of_joints_are_repaired_with_a_warning() {
    let mut draft = Draft::triangle();
    let joints = draft.accessor(&[0, 9, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0], (U8, "VEC4", 3));
    let weights = [
        0.5,
        0.5,
        0.0,
        0.0,
        1.0,
        f32::NAN,
        0.0,
        0.0,
        0.5,
        0.5,
        -1.0,
        0.0,
    ];
    let weights = draft.accessor(&floats(&weights), (F32, "VEC4", 3));
    draft.primitive()["attributes"] =
        json!({ "POSITION": 0, "JOINTS_0": joints, "WEIGHTS_0": weights });
    draft.json["skins"] = json!([{ "joints": [1, 2] }]);
    draft.json["nodes"] = json!([
        { "mesh": 0, "skin": 0 }, { "translation": [0, 0, 1] }, { "translation": [0, 0, 3] },
    ]);
    draft.json["scenes"][0]["nodes"] = json!([0, 1, 2]);
    let loaded = draft.load().unwrap();
    let expected = [[0.0, 0.0, 1.0], [1.0, 0.0, 3.0], [0.0, 1.0, 2.0]];
    check_points(&mesh(&loaded, 0).positions, &expected);
    let is_told = |it: &String| it.contains("3 weights of joints");
    assert!(loaded.warnings.iter().any(is_told), "{:?}", loaded.warnings);
}

/// Vertices whose weights are all 0, or none of a joint that is there.
#[test]
fn vertices_without_weights_follow_the_first_joint() {
    let (zero, nan, one) = ([0.0; 4], [f32::NAN; 4], [1.0, 0.0, 0.0, 0.0]);
    for (rows, loose) in [
        ([zero, one, one], 1),
        ([zero; 3], 3),
        ([nan, one, zero], 2),
        ([[-1.0; 4]; 3], 3),
        ([[0.0, 1.0, 0.0, 0.0], one, one], 1),
        ([one; 3], 0),
    ] {
        let mut draft = Draft::triangle();
        let joints = draft.accessor(&[0, 9, 0, 0].repeat(3), (U8, "VEC4", 3));
        let weights = draft.accessor(&floats(&rows.concat()), (F32, "VEC4", 3));
        draft.primitive()["attributes"] =
            json!({ "POSITION": 0, "JOINTS_0": joints, "WEIGHTS_0": weights });
        draft.json["skins"] = json!([{ "joints": [1] }]);
        draft.json["nodes"] = json!([{ "mesh": 0, "skin": 0 }, { "translation": [0, 0, 1] }]);
        draft.json["scenes"][0]["nodes"] = json!([0, 1]);
        let loaded = draft.load().unwrap();
        let expected = [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]];
        check_points(&mesh(&loaded, 0).positions, &expected);
        let told = format!("{loose} vertices have no weight");
        let is_told = loaded.warnings.iter().any(|it| it.contains(&told));
        assert_eq!(is_told, loose > 0, "{:?}", loaded.warnings);
    }
}

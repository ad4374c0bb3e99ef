//! Volumes within volumes, that touch or overlap; meshes that enclose nothing, or are inside out.
//!
//! A small camera of parallel rays looks along -z through boxes at a lamp of radiance 1.

use super::volume::{BOX, seen, seen_by, seen_within};
use super::*;
use bidir::integrator::IntegratorKind;

/// A box of a material, between two heights, as wide as it says.
#[derive(Clone)]
struct Solid {
    material: usize,
    z: [f32; 2],
    half: f32,
    faces: Vec<u16>,
    normals: Option<f32>,
}

fn solid(material: usize, z: [f32; 2], half: f32) -> Solid {
    Solid {
        material,
        z,
        half,
        faces: BOX.to_vec(),
        normals: None,
    }
}

impl Solid {
    fn inside_out(mut self) -> Self {
        self.faces
            .as_chunks_mut::<3>()
            .0
            .iter_mut()
            .for_each(|face| face.swap(1, 2));
        self
    }

    /// The same faces without those along z.
    fn tube(mut self) -> Self {
        self.faces.drain(..12);
        self
    }

    /// With smooth normals that point out of it, or into it if `sign` is negative.
    fn with_normals(mut self, sign: f32) -> Self {
        self.normals = Some(sign);
        self
    }

    fn corners(&self) -> Vec<f32> {
        let h = self.half;
        let ring = [[-h, -h], [h, -h], [h, h], [-h, h]];
        let at = |z: f32| ring.map(|[x, y]| [x, y, z]);
        self.z.map(at).concat().concat()
    }
}

/// A material that keeps `color` of light over a length of 1, with this index of refraction.
fn glass(color: f32, ior: f32) -> Value {
    json!({ "extensions": {
        "KHR_materials_ior": { "ior": ior },
        "KHR_materials_transmission": { "transmissionFactor": 1 },
        "KHR_materials_volume": {
            "thicknessFactor": 1, "attenuationDistance": 1, "attenuationColor": [color, color, color],
        },
    }, "pbrMetallicRoughness": { "roughnessFactor": 0, "metallicFactor": 0 } })
}

/// Each of `meshes` is one of the file, with a node of its own. The last material is the lamp's.
fn bench(materials: &[Value], meshes: &[&[Solid]]) -> Draft {
    let mut draft = Draft::empty();
    let lamp = solid(materials.len(), [-20.0, -19.0], 9.0);
    let lamp = [lamp];
    let all = meshes.iter().copied().chain([&lamp[..]]);
    let described: Vec<Value> = all.map(|parts| mesh_of(&mut draft, parts)).collect();
    let nodes = (0..described.len()).map(|mesh| json!({ "mesh": mesh }));
    let camera = json!({ "camera": 0, "translation": [0.013, 0.027, 9] });
    let nodes: Vec<Value> = nodes.chain([camera]).collect();
    let mut materials = materials.to_vec();
    materials.push(json!({ "emissiveFactor": [1, 1, 1] }));
    draft.json["materials"] = json!(materials);
    draft.json["meshes"] = json!(described);
    draft.json["scenes"] = json!([{ "nodes": (0..nodes.len()).collect::<Vec<_>>() }]);
    draft.json["nodes"] = json!(nodes);
    draft.json["cameras"] = json!([{ "type": "orthographic",
        "orthographic": { "xmag": 0.01, "ymag": 0.01, "znear": 0, "zfar": 100 } }]);
    draft
}

fn mesh_of(draft: &mut Draft, parts: &[Solid]) -> Value {
    let primitives = parts.iter().map(|part| {
        let corners = part.corners();
        let position = draft.accessor(&floats(&corners), (F32, "VEC3", 8));
        let count = part.faces.len();
        let indices = draft.accessor(&shorts(&part.faces), (U16, "SCALAR", count));
        let mut attributes = json!({ "POSITION": position });
        if let Some(sign) = part.normals {
            let middle = [0.0, 0.0, 0.5 * (part.z[0] + part.z[1])];
            let around = corners.chunks_exact(3).flat_map(|corner| {
                [0, 1, 2].map(|i| sign * (corner[i] - middle[i]).signum() / 3f32.sqrt())
            });
            let normals: Vec<f32> = around.collect();
            attributes["NORMAL"] = json!(draft.accessor(&floats(&normals), (F32, "VEC3", 8)));
        }
        json!({ "attributes": attributes, "indices": indices, "material": part.material })
    });
    json!({ "primitives": primitives.collect::<Vec<_>>() })
}

#[track_caller]
fn check(draft: &Draft, expected: f32) {
    for light in seen(draft) {
        assert!(
            (light - expected).abs() < 1e-3 * expected,
            "{light}, not {expected}"
        );
    }
}

/// Returns the number of warnings that contain `words`.
fn warnings(draft: &Draft, words: &str) -> usize {
    super::warnings(&draft.load().expect("it is valid"), words)
}

const INSIDE_OUT: &str = "inside out";
const THIN: &str = "it is a thin wall, without a volume";

/// What is left of light over lengths of two glasses that keep a half and a quarter.
fn left(half: f32, quarter: f32) -> f32 {
    libm::powf(0.5, half) * libm::powf(0.25, quarter)
}

fn two() -> [Value; 2] {
    [glass(0.5, 1.0), glass(0.25, 1.0)]
}

fn outer() -> Solid {
    solid(0, [-1.0, 1.0], 1.0)
}

fn inner() -> Solid {
    solid(1, [-0.5, 0.5], 0.5)
}

#[test]
fn behind_an_inner_volume_the_outer_goes_on() {
    check(&bench(&two(), &[&[outer()], &[inner()]]), left(1.0, 1.0));
    // Whatever their order, and in one mesh.
    check(&bench(&two(), &[&[inner()], &[outer()]]), left(1.0, 1.0));
    check(&bench(&two(), &[&[outer(), inner()]]), left(1.0, 1.0));
}

#[test]
fn three_volumes_nest() {
    let ice = solid(2, [-0.25, 0.125], 0.25);
    let materials = [glass(0.5, 1.0), glass(0.25, 1.0), glass(0.1, 1.0)];
    let draft = bench(&materials, &[&[outer()], &[inner()], &[ice]]);
    check(&draft, left(1.0, 0.625) * libm::powf(0.1, 0.375));
}

/// The scales of the nodes of both, and where the camera is.
#[test]
fn volumes_nest_under_any_map_and_from_any_place() {
    for (outer_scale, inner_scale, camera, expected) in [
        ([-1.0, 1.0, 1.0], [1.0, -1.0, 1.0], 9.0, left(1.0, 1.0)),
        ([-1.0, -1.0, -1.0], [1.0, 1.0, -1.0], 9.0, left(1.0, 1.0)),
        ([1.0, 1.0, 3.0], [1.0, 1.0, 1.0], 9.0, left(5.0, 1.0)),
        ([2.0, 1.0, 1.0], [0.5, 0.7, -1.5], 9.0, left(0.5, 1.5)),
        ([1.0, 1.0, 1.0], [1.0, 1.0, 1.0], 0.75, left(0.75, 1.0)),
        ([1.0, 1.0, -1.0], [1.0, 1.0, 1.0], 0.25, left(0.5, 0.75)),
        ([1.0, 1.0, 1.0], [-1.0, 1.0, 1.0], -0.75, left(0.25, 0.0)),
    ] {
        for turned in [false, true] {
            let within = if turned {
                inner().inside_out()
            } else {
                inner()
            };
            let mut draft = bench(&two(), &[&[outer()], &[within]]);
            draft.json["nodes"][0]["scale"] = json!(outer_scale);
            draft.json["nodes"][1]["scale"] = json!(inner_scale);
            draft.json["nodes"][3]["translation"][2] = json!(camera);
            check(&draft, expected);
        }
    }
}

#[test]
fn volumes_may_lie_beside_each_other_and_alternate() {
    let shells = (0..6u8).map(|k| {
        let half = 1.0 - 0.15 * f32::from(k);
        solid(usize::from(k % 2), [-half, half], half)
    });
    for (parts, expected) in [
        (
            vec![solid(0, [-1.0, -0.1], 1.0), solid(1, [0.1, 1.0], 1.0)],
            left(0.9, 0.9),
        ),
        (
            vec![
                outer(),
                solid(1, [-0.8, -0.2], 0.5),
                solid(1, [0.2, 0.8], 0.5),
            ],
            left(0.8, 1.2),
        ),
        (vec![outer(), solid(1, [0.5, 1.5], 0.5)], left(1.5, 1.0)),
        (
            vec![solid(0, [-1.0, 0.0], 1.0), solid(1, [0.0, 1.0], 1.0)],
            left(1.0, 1.0),
        ),
        (shells.collect(), left(0.9, 1.1)),
    ] {
        let meshes: Vec<&[Solid]> = parts.iter().map(std::slice::from_ref).collect();
        check(&bench(&two(), &meshes), expected);
    }
}

#[test]
fn of_volumes_that_overlap_the_smaller_fills_both() {
    let across = solid(1, [0.5, 1.5], 0.5);
    check(&bench(&two(), &[&[outer()], &[across]]), left(1.5, 1.0));
}

#[test]
fn volumes_that_touch_have_no_gap() {
    let below = solid(1, [-2.0, -1.0], 1.0);
    check(&bench(&two(), &[&[outer()], &[below]]), left(2.0, 1.0));
}

#[test]
fn nested_volumes_of_instances_nest_in_each_place() {
    let mut draft = bench(&two(), &[&[outer()], &[inner()]]);
    let nodes = draft.json["nodes"].as_array_mut().unwrap();
    for (mesh, z) in [(0, 4.0), (1, 4.0)] {
        nodes.push(json!({ "mesh": mesh, "translation": [0, 0, z], "scale": [1, 1, 0.5] }));
    }
    draft.json["scenes"][0]["nodes"] = json!([0, 1, 2, 3, 4, 5]);
    check(&draft, left(1.5, 1.5));
}

#[test]
fn a_substance_within_itself_has_no_surface() {
    let same = Solid {
        material: 0,
        ..inner()
    };
    let draft = bench(&[glass(0.5, 1.5)], &[&[outer()], &[same]]);
    let alone = bench(&[glass(0.5, 1.5)], &[&[outer()]]);
    // Light passes two surfaces, and would not pass four.
    let [both, alone] = [draft, alone].map(|it| seen_within(&it, IntegratorKind::Path, 3, 4096)[0]);
    assert!((both / alone - 1.0).abs() < 0.02, "{both}, not {alone}");
}

#[test]
fn a_volume_that_looks_inwards_within_its_substance_is_a_cavity() {
    let same = || {
        Solid {
            material: 0,
            ..inner()
        }
        .inside_out()
    };
    let materials = [glass(0.5, 1.0)];
    for meshes in [
        vec![vec![outer(), same()]],
        vec![vec![outer()], vec![same()]],
        vec![vec![same()], vec![outer()]],
    ] {
        let meshes: Vec<&[Solid]> = meshes.iter().map(Vec::as_slice).collect();
        let draft = bench(&materials, &meshes);
        check(&draft, 0.5);
        assert_eq!(warnings(&draft, INSIDE_OUT), 0);
    }
}

#[test]
fn a_mesh_that_is_inside_out_is_turned() {
    let draft = bench(&two(), &[&[outer().inside_out()], &[inner()]]);
    check(&draft, left(1.0, 1.0));
    assert_eq!(warnings(&draft, INSIDE_OUT), 1);
    let draft = bench(&two(), &[&[outer()], &[inner().inside_out()]]);
    check(&draft, left(1.0, 1.0));
    let both = outer().inside_out().with_normals(-1.0);
    let draft = bench(&two(), &[&[both]]);
    check(&draft, 0.25);
    assert_eq!(warnings(&draft, INSIDE_OUT), 1);
    // Normals that point outwards are right already, and bend light as before.
    let draft = bench(&two(), &[&[outer().inside_out().with_normals(1.0)]]);
    check(&draft, 0.25);
    assert_eq!(warnings(&draft, INSIDE_OUT), 0);
}

#[test]
fn a_face_that_looks_the_other_way_is_turned() {
    let mut box_ = outer();
    box_.faces.swap(0, 1);
    let draft = bench(&two(), &[&[box_], &[inner()]]);
    check(&draft, left(1.0, 1.0));
    assert_eq!(warnings(&draft, INSIDE_OUT), 1);
}

#[test]
fn meshes_that_enclose_nothing_are_thin() {
    let mut pane = outer();
    pane.faces.truncate(6);
    let mut two_sided = pane.clone();
    two_sided.faces.extend(pane.clone().inside_out().faces);
    let mut lidless = outer();
    lidless.faces.drain(..6);
    // No light is bent or absorbed; each face reflects 4 % of it, and 2 r / (1 + r) of it with what goes to and fro.
    for (open, faces) in [(pane, 1), (two_sided, 1), (lidless, 1), (outer().tube(), 0)] {
        let draft = bench(&[glass(0.5, 1.0)], &[std::slice::from_ref(&open)]);
        check(&draft, 1.0);
        assert_eq!(warnings(&draft, THIN), 1);
        let draft = bench(&[glass(0.5, 1.5)], &[&[open]]);
        let light = seen_by(&draft, IntegratorKind::Path, 4096)[0];
        let expected = if faces == 0 { 1.0 } else { 0.9 };
        assert!(light >= expected - 0.03, "{light}");
    }
}

#[test]
fn faces_of_several_materials_close_each_other() {
    let mut lid = outer();
    lid.faces.truncate(6);
    let mut rest = outer();
    rest.faces.drain(..6);
    rest.material = 1;
    let materials = [glass(0.5, 1.0), glass(0.5, 1.0), glass(0.25, 1.0)];
    let core = Solid {
        material: 2,
        ..inner()
    };
    let draft = bench(&materials, &[&[lid, rest], &[core]]);
    check(&draft, left(1.0, 1.0));
    assert_eq!(warnings(&draft, THIN), 0);
}

#[test]
fn a_camera_may_be_within_nested_volumes() {
    let mut draft = bench(&two(), &[&[outer()], &[inner()]]);
    draft.json["nodes"][3]["translation"] = json!([0.013, 0.027, 0.25]);
    check(&draft, left(0.5, 0.75));
    draft.json["nodes"][3]["translation"] = json!([0.013, 0.027, 0.75]);
    check(&draft, left(0.75, 1.0));
}

/// The part of light that gets through flat layers of these indices and transmittances, to and fro as well.
fn through_layers(indices: &[f32], kept: &[f32]) -> f32 {
    let sqr = |x: f32| x * x;
    let reflectance = |a: f32, b: f32| sqr((a - b) / (a + b));
    let mut all = indices.windows(2).map(|n| reflectance(n[0], n[1]));
    let first = all.next().expect("two indices");
    // (transmitted, reflected from before, reflected from behind) of all layers so far.
    let mut stack = (1.0 - first, first, first);
    for (r, kept) in all.zip(kept) {
        let (t, front, back) = stack;
        let back = back * kept * kept;
        let t = t * kept;
        let again = 1.0 / (1.0 - back * r);
        let behind = r + sqr(1.0 - r) * back * again;
        stack = (t * (1.0 - r) * again, front + t * t * r * again, behind);
    }
    stack.0
}

/// Ice in water in glass: the index of each surface is relative to what is around it.
#[test]
fn surfaces_reflect_by_the_index_around_them() {
    let (n_outer, n_inner) = (1.33, 2.5);
    let materials = [glass(0.5, n_outer), glass(0.25, n_inner)];
    let draft = bench(&materials, &[&[outer()], &[inner()]]);
    let [half, quarter] = [libm::powf(0.5, 0.5), 0.25];
    let indices = [1.0, n_outer, n_inner, n_outer, 1.0];
    let expected = through_layers(&indices, &[half, quarter, half]);
    for integrator in [
        IntegratorKind::Path,
        IntegratorKind::Bdpt,
        IntegratorKind::Lvc,
    ] {
        let light = seen_by(&draft, integrator, 1 << 14)[0];
        assert!(
            (light / expected - 1.0).abs() < 0.02,
            "{integrator}: {light}, not {expected}"
        );
    }
}

/// A liquid that touches the glass below it but for rounding, or overlaps it, meets it without air between.
#[test]
fn a_liquid_meets_glass_without_air_between() {
    let materials = [glass(0.5, 1.0 + 0.8), glass(0.25, 1.33)];
    let expected = through_layers(&[1.0, 1.33, 1.8, 1.0], &[0.25, 0.5]);
    let floor = solid(0, [-1.0, 0.0], 0.5);
    for bottom in [5e-6, 1e-6, 0.0, -0.5] {
        let liquid = solid(1, [bottom, 1.0], 2.0);
        let draft = bench(&materials, &[std::slice::from_ref(&floor), &[liquid]]);
        let light = seen_by(&draft, IntegratorKind::Path, 1 << 14)[0];
        assert!(
            (light / expected - 1.0).abs() < 0.02,
            "{light}, not {expected}"
        );
    }
}

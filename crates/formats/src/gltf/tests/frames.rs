//! Layers in frames of their own, and frames of mirrored surfaces, by what a plate scatters.

use super::{Draft, F32, U8, floats};
use crate::image::encode_png;
use crate::import::Loaded;
use bidir::bsdf::TransportMode;
use bidir::math::{Vec2, Vec3};
use bidir::path::{Job, PathSettings, Vertex};
use bidir::sampler::{Domain, Sampler, SamplerKind};
use bidir::scene::RayDraws;
use bidir::spectrum::Spectrum;
use serde_json::{Value, json};

/// Texture coordinates of the corners from the lower left, counter-clockwise.
const UVS: [f32; 8] = [0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0];

/// A plate in the plane z = 0 that faces +z, with a material and a 1 × 1 image of each colour.
fn plate(material: &Value, uvs: [f32; 8], texels: &[[f32; 3]]) -> Draft {
    let mut draft = Draft::empty();
    let corners = [
        -1., -1., 0., 1., -1., 0., 1., 1., 0., -1., -1., 0., 1., 1., 0., -1., 1., 0.,
    ];
    let at = |i: usize| Vec2::new(uvs[2 * i], uvs[2 * i + 1]).to_array();
    let uvs = [0, 1, 2, 0, 2, 3].map(at).concat();
    let position = draft.accessor(&floats(&corners), (F32, "VEC3", 6));
    let uv = draft.accessor(&floats(&uvs), (F32, "VEC2", 6));
    let normal = draft.accessor(&floats(&[0.0, 0.0, 1.0].repeat(6)), (F32, "VEC3", 6));
    let attributes = json!({ "POSITION": position, "NORMAL": normal, "TEXCOORD_0": uv });
    draft.json["meshes"] = json!([{ "primitives": [{ "attributes": attributes, "material": 0 }] }]);
    draft.json["nodes"] = json!([{ "mesh": 0 }]);
    draft.json["scenes"] = json!([{ "nodes": [0] }]);
    draft.json["materials"] = json!([material]);
    let views: Vec<usize> = texels
        .iter()
        .map(|&texel| draft.view(&encode_png([1, 1], &[linear(texel)]).unwrap()))
        .collect();
    let image = |view: &usize| json!({ "bufferView": view, "mimeType": "image/png" });
    draft.json["images"] = views.iter().map(image).collect();
    draft.json["textures"] = (0..views.len())
        .map(|source| json!({ "source": source }))
        .collect();
    draft
}

/// The value that the encoder stores as `texel`: it takes numbers of light.
fn linear(texel: [f32; 3]) -> [f32; 3] {
    texel.map(|x| {
        if x <= 0.04045 {
            x / 12.92
        } else {
            libm::powf((x + 0.055) / 1.055, 2.4)
        }
    })
}

/// The texel of a normal.
fn normal(x: f32, y: f32, z: f32) -> [f32; 3] {
    Vec3::new(x, y, z)
        .normalize()
        .to_array()
        .map(|n| (n + 1.0) / 2.0)
}

/// f cosθ between `wo`, towards the camera, and `wi` near the centre of the plate.
fn scattered(loaded: &Loaded, wo: Vec3, wi: Vec3) -> f32 {
    let settings = PathSettings::default();
    let job = Job::of_own_subpaths(&loaded.scene, &loaded.view, &settings);
    let stream = Sampler::new(SamplerKind::Independent, 1).stream(Domain::Camera, 0, 0);
    let space = job.scene.space().from_world();
    let centre = space.transform_point3(glam::DVec3::new(0.1, 0.05, 0.0));
    let origin = centre.as_vec3() + wo * 0.01;
    let hit = job.scene.intersect(origin, -wo, RayDraws::new(&stream, 1));
    let hit = hit.expect("the plate is there");
    let vertex = Vertex::surface(&job, &hit, wo, Spectrum::ONE, || 0.5);
    let event = vertex.event(wo, wi, TransportMode::Radiance);
    event.scatter(&job)[0] * vertex.locus.n_g.dot(wi).abs()
}

/// Pairs of directions above the plate.
fn pairs() -> impl Iterator<Item = [Vec3; 2]> {
    let direction = |k: u8| {
        let part = |step: f32| (0.31 + step * f32::from(k)).fract();
        let (sin, cos) = libm::sincosf(std::f32::consts::TAU * part(0.618));
        let z = 0.15 + 0.8 * part(0.414);
        Vec3::new(cos, sin, 0.0) * (1.0 - z * z).sqrt() + Vec3::Z * z
    };
    (0..40).map(move |k| [direction(2 * k), direction(2 * k + 1)])
}

/// Checks that the two plates scatter alike, the second between directions that are mirrored along an axis.
#[track_caller]
fn check_alike(name: &str, [first, second]: [&Loaded; 2], mirror: Vec3) {
    let mut lit = 0;
    for [wo, wi] in pairs() {
        let a = scattered(first, wo, wi);
        let b = scattered(second, wo * mirror, wi * mirror);
        lit += usize::from(a > 1e-3);
        assert!(
            (a - b).abs() <= 1e-3 * a.max(b) + 1e-5,
            "{name}: {a}, {b} for {wo} and {wi}"
        );
    }
    assert!(lit >= 5, "{name}: {lit} pairs are lit");
}

/// Metal brushed along a slant, with normals that are tilted another way.
fn brushed() -> Value {
    json!({
        "pbrMetallicRoughness": { "roughnessFactor": 0.5 },
        "normalTexture": { "index": 0 },
        "extensions": { "KHR_materials_anisotropy": {
            "anisotropyStrength": 0.9, "anisotropyRotation": 0.6, "anisotropyTexture": { "index": 1 },
        } },
    })
}

/// A mirrored surface is the mirror image, be it mirrored by its texture coordinates, its node, or a parent.
#[test]
fn what_turns_in_a_frame_is_mirrored_with_the_surface() {
    let texels = [normal(0.2, 0.3, 1.0), [0.9, 0.7, 1.0]];
    let draft = |uvs| plate(&brushed(), uvs, &texels);
    let plain = draft(UVS).load().unwrap();
    let mirrored_u = std::array::from_fn(|i| if i % 2 == 0 { 1.0 - UVS[i] } else { UVS[i] });
    let mirrored_v = std::array::from_fn(|i| if i % 2 == 1 { 1.0 - UVS[i] } else { UVS[i] });
    let [along_x, along_y] = [ALONG_X, ALONG_Y];
    check_alike("u", [&plain, &draft(mirrored_u).load().unwrap()], along_x);
    check_alike("v", [&plain, &draft(mirrored_v).load().unwrap()], along_y);
    for (scale, mirror) in [([-2.0, 2.0, 2.0], along_x), ([1.0, -1.0, 1.0], along_y)] {
        let mut node = draft(UVS);
        node.json["nodes"][0]["scale"] = json!(scale);
        check_alike("node", [&plain, &node.load().unwrap()], mirror);
        let mut parent = draft(UVS);
        parent.json["nodes"] = json!([{ "children": [1], "scale": scale }, { "mesh": 0 }]);
        check_alike("parent", [&plain, &parent.load().unwrap()], mirror);
        // Beside an equal one: both are instances of one object.
        let mut shared = draft(UVS);
        let beside = json!({ "mesh": 0, "translation": [9.0, 0.0, 0.0] });
        shared.json["nodes"] = json!([{ "mesh": 0, "scale": scale }, beside]);
        shared.json["scenes"] = json!([{ "nodes": [0, 1] }]);
        check_alike("instance", [&plain, &shared.load().unwrap()], mirror);
    }
    // Two mirrors are a turn by 180°.
    let mut turned = draft(UVS);
    turned.json["nodes"][0]["scale"] = json!([-1.0, -1.0, 1.0]);
    check_alike("turn", [&plain, &turned.load().unwrap()], along_x * along_y);
}

/// Everything that has a frame: a brushed base under its own normals, sheen, and a coat under others.
fn layered() -> Value {
    json!({
        "pbrMetallicRoughness": { "roughnessFactor": 0.5, "metallicFactor": 0.6 },
        "normalTexture": { "index": 0, "scale": 0.7 },
        "extensions": {
            "KHR_materials_anisotropy": { "anisotropyStrength": 0.9, "anisotropyRotation": 0.6 },
            "KHR_materials_sheen": { "sheenColorFactor": [0.5, 0.4, 0.3], "sheenRoughnessFactor": 0.5 },
            "KHR_materials_clearcoat": {
                "clearcoatFactor": 0.8, "clearcoatRoughnessFactor": 0.5,
                "clearcoatNormalTexture": { "index": 1, "scale": 0.5 },
            },
        },
    })
}

const ALONG_X: Vec3 = Vec3::new(-1.0, 1.0, 1.0);
const ALONG_Y: Vec3 = Vec3::new(1.0, -1.0, 1.0);

/// Where a plate is put.
type Change<'a> = &'a dyn Fn(&mut Draft);

/// The plate under a joint, whose node and its parent have these scales.
fn skinned(draft: &mut Draft, [joint, parent]: [[f32; 3]; 2]) {
    let joints = draft.accessor(&[0; 24], (U8, "VEC4", 6));
    let weights = floats(&[1.0, 0.0, 0.0, 0.0].repeat(6));
    let weights = draft.accessor(&weights, (F32, "VEC4", 6));
    let attributes = &mut draft.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = json!(joints);
    attributes["WEIGHTS_0"] = json!(weights);
    draft.json["skins"] = json!([{ "joints": [1] }]);
    draft.json["nodes"] = json!([
        { "mesh": 0, "skin": 0 }, { "scale": joint }, { "scale": parent, "children": [1] },
    ]);
    draft.json["scenes"] = json!([{ "nodes": [0, 2] }]);
}

/// Two instances of the plate, the one that is seen with this scale.
fn instanced(draft: &mut Draft, scale: [f32; 3]) {
    let places = floats(&[0.0, 0.0, 0.0, 9.0, 0.0, 0.0]);
    let places = draft.accessor(&places, (F32, "VEC3", 2));
    let scales = floats(&[scale, [1.0; 3]].concat());
    let scales = draft.accessor(&scales, (F32, "VEC3", 2));
    let attributes = json!({ "TRANSLATION": places, "SCALE": scales });
    let extension = json!({ "EXT_mesh_gpu_instancing": { "attributes": attributes } });
    draft.json["nodes"][0]["extensions"] = extension;
}

/// Tangents along x in the file, under a node of this scale.
fn with_tangents(draft: &mut Draft, scale: [f32; 3]) {
    let tangents = floats(&[1.0, 0.0, 0.0, 1.0].repeat(6));
    let tangents = draft.accessor(&tangents, (F32, "VEC4", 6));
    draft.json["meshes"][0]["primitives"][0]["attributes"]["TANGENT"] = json!(tangents);
    draft.json["nodes"][0]["scale"] = json!(scale);
}

/// Joints, instances and nodes mirror all layers, and no other scale does.
#[test]
fn all_layers_are_mirrored_by_whatever_mirrors() {
    let texels = [normal(0.2, 0.3, 1.0), [0.9, 0.7, 1.0]];
    let one = [1.0; 3];
    let (x, y) = ([-1.0, 1.0, 1.0], [1.0, -1.0, 1.0]);
    let placed: [(&str, Vec3, Change<'_>); 12] = [
        ("joint, x", ALONG_X, &|draft| skinned(draft, [x, one])),
        ("joint, y", ALONG_Y, &|draft| skinned(draft, [y, one])),
        ("parent of a joint", ALONG_X, &|draft| {
            skinned(draft, [one, [-3.0; 3]]);
            draft.json["nodes"][1]["scale"] = json!([1, -1, -1]);
        }),
        ("joints that undo each other", Vec3::ONE, &|draft| {
            skinned(draft, [x, x]);
        }),
        (
            "the node of a skin, which is ignored",
            Vec3::ONE,
            &|draft| {
                skinned(draft, [one; 2]);
                draft.json["nodes"][0]["scale"] = json!(x);
            },
        ),
        ("instance, x", ALONG_X, &|draft| instanced(draft, x)),
        ("instance, y", ALONG_Y, &|draft| {
            instanced(draft, [2.0, -2.0, 2.0]);
        }),
        ("instance under a mirror", ALONG_X * ALONG_Y, &|draft| {
            instanced(draft, x);
            draft.json["nodes"][0]["scale"] = json!(y);
        }),
        ("tangents", Vec3::ONE, &|draft| with_tangents(draft, one)),
        ("tangents, x", ALONG_X, &|draft| with_tangents(draft, x)),
        ("tangents, y", ALONG_Y, &|draft| with_tangents(draft, y)),
        ("matrix", ALONG_X, &|draft| {
            draft.json["nodes"][0]["matrix"] =
                json!([-2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 5, 0, 0, 0, 0, 1]);
        }),
    ];
    for material in [brushed(), layered()] {
        let plain = plate(&material, UVS, &texels).load().unwrap();
        for (name, mirror, change) in placed {
            let mut draft = plate(&material, UVS, &texels);
            change(&mut draft);
            check_alike(name, [&plain, &draft.load().unwrap()], mirror);
        }
    }
}

/// Textures of colours and numbers turn as their transforms say; the grain and the relief stay.
#[test]
fn transforms_of_other_textures_leave_frames_alone() {
    let texels = [normal(0.2, 0.3, 1.0), [1.0; 3]];
    let grain = json!({ "anisotropyStrength": 0.9, "anisotropyRotation": 0.6 });
    let turned = |with_relief: bool, place: &[&str], transform: Option<&Value>| {
        let mut material = json!({
            "pbrMetallicRoughness": { "roughnessFactor": 0.5 },
            "extensions": { "KHR_materials_anisotropy": grain },
        });
        if with_relief {
            material["normalTexture"] = json!({ "index": 0 });
        }
        if let Some(transform) = transform {
            let extension = json!({ "KHR_texture_transform": transform });
            let slot = place.iter().fold(&mut material, |at, &key| &mut at[key]);
            *slot = json!({ "index": 1, "extensions": extension });
        }
        plate(&material, UVS, &texels).load().unwrap()
    };
    let color = ["pbrMetallicRoughness", "baseColorTexture"];
    let metal = ["pbrMetallicRoughness", "metallicRoughnessTexture"];
    let sheen = ["extensions", "KHR_materials_sheen", "sheenColorTexture"];
    for with_relief in [false, true] {
        let plain = turned(with_relief, &color, None);
        for (place, transform) in [
            (&color[..], json!({ "rotation": 1.5707964 })),
            (&color, json!({ "rotation": 0.7, "scale": [2, 3] })),
            (&color, json!({ "scale": [-1, 1] })),
            (&metal, json!({ "scale": [1, -1], "offset": [0.5, 0.5] })),
            (&metal, json!({ "rotation": 3.0, "scale": [0, 0] })),
            (&sheen, json!({ "scale": [-4, 4], "rotation": -0.4 })),
        ] {
            let other = turned(with_relief, place, Some(&transform));
            check_alike(&transform.to_string(), [&plain, &other], Vec3::ONE);
        }
    }
}

/// Smith's Λ: (√(1 + α² tan²θ) - 1) / 2 in the axes of the slopes [Walter07].
fn lambda(w: Vec3, [x, y]: [f32; 2]) -> f32 {
    let tan2 = (w.x * w.x * x * x + w.y * w.y * y * y) / (w.z * w.z);
    ((1.0 + tan2).sqrt() - 1.0) / 2.0
}

/// F D G₂ / (4 cosθ_o), f cosθ_i of facets that mirror, in their axes [Walter07].
fn mirrored(o: Vec3, i: Vec3, slopes: [f32; 2], f0: f32) -> f32 {
    let h = (o + i).normalize();
    let [x, y] = slopes;
    let lean = (h.x / x) * (h.x / x) + (h.y / y) * (h.y / y) + h.z * h.z;
    let d = 1.0 / (std::f32::consts::PI * x * y * lean * lean);
    let g2 = 1.0 / (1.0 + lambda(o, slopes) + lambda(i, slopes));
    let f = f0 + (1.0 - f0) * libm::powf(1.0 - o.dot(h), 5.0);
    f * d * g2 / (4.0 * o.z)
}

/// Coats have one facet's closed form: 0.04 / (4 π α²) = 1.989 along the normal at roughness 0.2. A lamp of intensity 10
/// at a distance of 4 shows 1.243 there, and 1.204 on average over a film of ± 0.05, whose corners see facets aslant.
#[test]
fn coats_scatter_by_their_closed_form() {
    for roughness in [0.2f32, 0.35, 0.5, 0.8, 1.0] {
        let mut material = coated(&json!({ "base": true }));
        let coat = &mut material["extensions"]["KHR_materials_clearcoat"];
        coat["clearcoatRoughnessFactor"] = json!(roughness);
        let texels = [normal(0.0, 0.0, 1.0), normal(0.6, -0.3, 1.0)];
        let loaded = plate(&material, UVS, &texels).load().unwrap();
        let slopes = [roughness * roughness; 2];
        for tan in [0.0, 0.01, 0.03, 0.1, 0.4] {
            let i = Vec3::new(tan, -0.5 * tan, 1.0).normalize();
            let expected = mirrored(Vec3::Z, i, slopes, 0.04);
            let found = scattered(&loaded, Vec3::Z, i);
            assert!(
                (found / expected - 1.0).abs() < 2e-3,
                "{found}, not {expected}"
            );
        }
    }
}

/// White metal brushed at 45°, of slopes 1 and 0.16: one facet's closed form, and what leaves after more of them,
/// (1 - E_o) (1 - E_i) cosθ_i / (π (1 - Ē)), with E by quadrature over 160,000 facets: 0.5241 along the normal, 0.5865 for
/// directions at 45° along the grain, Ē = 0.5742. A lamp of intensity 10 on the line of the streak shows 0.913 + 0.231.
#[test]
fn brushed_metal_scatters_by_its_closed_form() {
    let metal = json!({
        "pbrMetallicRoughness": { "roughnessFactor": 0.4 },
        "extensions": { "KHR_materials_anisotropy": {
            "anisotropyStrength": 1, "anisotropyRotation": std::f32::consts::FRAC_PI_4,
        } },
    });
    let loaded = plate(&metal, UVS, &[]).load().unwrap();
    let i = Vec3::new(0.5, 0.5, std::f32::consts::FRAC_1_SQRT_2);
    let along = Vec3::new(std::f32::consts::FRAC_1_SQRT_2, 0.0, i.z);
    let once = mirrored(Vec3::Z, along, [1.0, 0.16], 1.0);
    let often = (1.0 - 0.5241) * (1.0 - 0.5865) * i.z / (std::f32::consts::PI * (1.0 - 0.5742));
    let found = scattered(&loaded, Vec3::Z, i);
    assert!(
        (found / (once + often) - 1.0).abs() < 3e-3,
        "{found}, not {once} + {often}"
    );
    let power = 10.0 / (2.0 * 1.06 * 1.06 + 1.5 * 1.5);
    assert!((found * power - 1.144).abs() < 5e-3, "{}", found * power);
    let off = scattered(&loaded, Vec3::Z, i * ALONG_Y);
    assert!(off < 0.3 * found, "{off}, {found}");
}

/// The image is mirrored, not only turned: without the mirror of directions it is another one.
#[test]
fn a_brushed_surface_is_not_its_mirror_image() {
    let texels = [normal(0.2, 0.3, 1.0), [0.9, 0.7, 1.0]];
    let loaded = plate(&brushed(), UVS, &texels).load().unwrap();
    let mirror = Vec3::new(-1.0, 1.0, 1.0);
    let differs = |[wo, wi]: [Vec3; 2]| {
        let [a, b] = [(wo, wi), (wo * mirror, wi * mirror)].map(|(o, i)| scattered(&loaded, o, i));
        (a - b).abs() > 0.1 * a.max(b)
    };
    assert!(pairs().filter(|&pair| differs(pair)).count() > 20);
}

/// Black under a clear coat: what is seen is the coat.
fn coated(extra: &Value) -> Value {
    let mut coat = json!({ "clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.5 });
    let mut material = json!({ "pbrMetallicRoughness": {
        "baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0,
    } });
    if extra["coat"] == json!(true) {
        coat["clearcoatNormalTexture"] = json!({ "index": 0 });
    }
    if extra["base"] == json!(true) {
        material["normalTexture"] = json!({ "index": 1 });
    }
    let black = json!({ "specularFactor": 0 });
    material["extensions"] =
        json!({ "KHR_materials_clearcoat": coat, "KHR_materials_specular": black });
    material
}

/// A coat has the normals of the mesh, or those of its own map, whatever those of its base are.
#[test]
fn a_coat_has_normals_of_its_own() {
    let load = |coat: bool, base: bool, of_coat: [f32; 3], of_base: [f32; 3]| {
        let material = coated(&json!({ "coat": coat, "base": base }));
        plate(&material, UVS, &[of_coat, of_base]).load().unwrap()
    };
    let (flat, slant) = (normal(0.0, 0.0, 1.0), normal(0.5, -0.2, 1.0));
    let steep = normal(-0.9, 0.4, 1.0);
    let plain = load(false, false, flat, flat);
    check_alike(
        "base mapped",
        [&plain, &load(false, true, flat, slant)],
        Vec3::ONE,
    );
    check_alike(
        "base steep",
        [&plain, &load(false, true, flat, steep)],
        Vec3::ONE,
    );
    let own = load(true, false, slant, flat);
    check_alike(
        "both mapped",
        [&own, &load(true, true, slant, steep)],
        Vec3::ONE,
    );
    check_alike(
        "mapped apart",
        [&own, &load(true, true, slant, normal(0.2, 0.2, 1.0))],
        Vec3::ONE,
    );
    let apart = |[wo, wi]: [Vec3; 2]| {
        let [a, b] = [&plain, &own].map(|loaded| scattered(loaded, wo, wi));
        (a - b).abs() > 0.2 * a.max(b)
    };
    assert!(pairs().filter(|&pair| apart(pair)).count() > 10);
}

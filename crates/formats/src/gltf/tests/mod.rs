//! Small files made here, read as any other.

mod frames;
mod geometry;
mod look;
mod nested;
mod outside;
mod refusals;
mod volume;

use super::load;
use crate::error::Result;
use crate::import::{LoadOptions, Loaded};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use bidir::math::Vec3;
use bidir::shape::{Mesh, Shape};
use serde_json::{Value, json};
use std::path::Path;

/// Bytes of numbers, little-endian.
fn bytes_of<const N: usize, T: Copy>(values: &[T], bytes: impl Fn(T) -> [u8; N]) -> Vec<u8> {
    values.iter().flat_map(|&value| bytes(value)).collect()
}

fn floats(values: &[f32]) -> Vec<u8> {
    bytes_of(values, f32::to_le_bytes)
}

fn shorts(values: &[u16]) -> Vec<u8> {
    bytes_of(values, u16::to_le_bytes)
}

/// A file in the making: its buffer grows with every accessor.
#[derive(Clone)]
struct Draft {
    json: Value,
    buffer: Vec<u8>,
}

/// The types of components.
const U8: u32 = 5121;
const U16: u32 = 5123;
const F32: u32 = 5126;

impl Draft {
    /// One node with one mesh of one triangle in the plane z = 0, that faces +z.
    fn triangle() -> Self {
        let mut draft = Self::empty();
        let corners = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        draft.accessor(&floats(&corners), (F32, "VEC3", 3));
        draft.json["meshes"] = json!([{ "primitives": [{ "attributes": { "POSITION": 0 } }] }]);
        draft.json["nodes"] = json!([{ "mesh": 0 }]);
        draft.json["scenes"] = json!([{ "nodes": [0] }]);
        draft
    }

    fn empty() -> Self {
        let json = json!({
            "asset": { "version": "2.0" }, "scene": 0,
            "accessors": [], "bufferViews": [], "buffers": [{ "byteLength": 0 }],
        });
        Self {
            json,
            buffer: Vec::new(),
        }
    }

    /// Adds bytes as a buffer view. Returns its number.
    fn view(&mut self, bytes: &[u8]) -> usize {
        let offset = self.buffer.len();
        self.buffer.extend(bytes);
        while !self.buffer.len().is_multiple_of(4) {
            self.buffer.push(0);
        }
        self.json["buffers"][0]["byteLength"] = json!(self.buffer.len());
        let views = self.json["bufferViews"].as_array_mut().unwrap();
        views.push(json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() }));
        views.len() - 1
    }

    /// Adds an accessor over bytes of its own. Returns its number.
    fn accessor(&mut self, bytes: &[u8], (component, kind, count): (u32, &str, usize)) -> usize {
        let view = self.view(bytes);
        let accessors = self.json["accessors"].as_array_mut().unwrap();
        accessors.push(json!({
            "bufferView": view, "componentType": component, "type": kind, "count": count,
        }));
        accessors.len() - 1
    }

    fn primitive(&mut self) -> &mut Value {
        &mut self.json["meshes"][0]["primitives"][0]
    }

    /// The file with its buffer as a data URI.
    fn gltf(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        let uri = STANDARD.encode(&self.buffer);
        json["buffers"][0]["uri"] = json!(format!("data:application/octet-stream;base64,{uri}"));
        serde_json::to_vec_pretty(&json).unwrap()
    }

    /// The same as a `.glb`.
    fn glb(&self) -> Vec<u8> {
        let mut json = serde_json::to_vec(&self.json).unwrap();
        json.resize(json.len().next_multiple_of(4), b' ');
        let length = 12 + 8 + json.len() + 8 + self.buffer.len();
        let mut glb = b"glTF\x02\0\0\0".to_vec();
        glb.extend((length as u32).to_le_bytes());
        for (name, data) in [(b"JSON", &json), (b"BIN\0", &self.buffer)] {
            glb.extend((data.len() as u32).to_le_bytes());
            glb.extend(name);
            glb.extend(data);
        }
        glb
    }

    fn load(&self) -> Result<Loaded> {
        load_bytes("a.gltf", &self.gltf(), &LoadOptions::default())
    }

    /// Loads the file with a film of this size.
    #[track_caller]
    fn load_sized(&self, size: [u32; 2]) -> Loaded {
        let options = LoadOptions {
            resolution: Some(size),
            ..LoadOptions::default()
        };
        load_bytes("a.gltf", &self.gltf(), &options).expect("it is valid")
    }
}

fn load_bytes(name: &str, bytes: &[u8], options: &LoadOptions) -> Result<Loaded> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    load(&path, options)
}

/// Mesh number `i` of a scene.
fn mesh(loaded: &Loaded, i: usize) -> &Mesh {
    match &loaded.scene.shapes()[i] {
        Shape::Mesh(mesh) => mesh,
        other => panic!("{other:?}"),
    }
}

/// Returns the number of warnings that contain `words`.
fn warnings(loaded: &Loaded, words: &str) -> usize {
    let warnings = loaded.warnings.iter();
    warnings.filter(|it| it.contains(words)).count()
}

/// The normal of the front of triangle `i`.
fn front(mesh: &Mesh, i: usize) -> Vec3 {
    let [a, b, c] = mesh.triangle(i);
    (b - a).cross(c - a).normalize() * mesh.orientation.sign()
}

#[test]
fn a_file_and_its_container_are_the_same_scene() {
    let draft = Draft::triangle();
    let options = LoadOptions::default();
    let text = load_bytes("a.gltf", &draft.gltf(), &options).unwrap();
    let binary = load_bytes("a.glb", &draft.glb(), &options).unwrap();
    for loaded in [&text, &binary] {
        assert_eq!(mesh(loaded, 0).positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
        assert_eq!(loaded.summary.primitives, 1);
        assert!(front(mesh(loaded, 0), 0).distance(Vec3::Z) < 1e-6);
    }
    assert_ne!(text.digest, binary.digest);
    let again = load_bytes("b.glb", &draft.glb(), &options).unwrap();
    assert_eq!(binary.digest, again.digest);
}

#[test]
fn the_digest_is_of_all_files() {
    let mut draft = Draft::triangle();
    draft.json["buffers"][0]["uri"] = json!("my%20mesh.bin");
    let text = serde_json::to_vec(&draft.json).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gltf");
    std::fs::write(&path, text).unwrap();
    let digest = |bytes: &[u8]| {
        std::fs::write(folder.path().join("my mesh.bin"), bytes).unwrap();
        crate::scene::load(&path, &LoadOptions::default())
            .unwrap()
            .digest
    };
    let first = digest(&draft.buffer);
    assert_eq!(first, digest(&draft.buffer));
    let mut moved = draft.buffer.clone();
    moved[2] = 1;
    assert_ne!(first, digest(&moved));
}

#[test]
fn inputs_are_all_files_that_are_named() {
    let mut draft = Draft::triangle();
    draft.json["buffers"][0]["uri"] = json!("my%20mesh.bin");
    let images = [
        "unused.png",
        "data:image/png;base64,",
        "https://a.org/b.png",
    ];
    draft.json["images"] = json!(images.map(|uri| json!({ "uri": uri })));
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("a.gltf"), serde_json::to_vec(&draft.json).unwrap()).unwrap();
    std::fs::write(at("my mesh.bin"), &draft.buffer).unwrap();
    let loaded = crate::scene::load(&at("a.gltf"), &LoadOptions::default()).unwrap();
    let inputs = ["a.gltf", "my mesh.bin", "unused.png"].map(at);
    assert_eq!(loaded.inputs, inputs);
    assert_eq!(loaded.files, inputs[..2]);
}

/// No bytes make it panic: files cut anywhere, and with a byte changed.
#[test]
fn broken_files_are_errors() {
    let glb = Draft::triangle().glb();
    let try_to = |bytes: &[u8]| drop(load_bytes("a.glb", bytes, &LoadOptions::default()));
    for length in (0..glb.len()).step_by(3) {
        try_to(&glb[..length]);
    }
    let gltf = Draft::triangle().gltf();
    for i in (0..gltf.len()).step_by(5) {
        for byte in [b'9', b'-', b'}', b'"'] {
            let mut changed = gltf.clone();
            changed[i] = byte;
            drop(load_bytes("a.gltf", &changed, &LoadOptions::default()));
        }
    }
}

#[test]
fn a_path_says_which_format_it_is() {
    for (name, expected) in [
        ("a.gltf", true),
        ("b/c.GLB", true),
        ("a.pbrt", false),
        ("glb", false),
    ] {
        assert_eq!(super::is_gltf(Path::new(name)), expected, "{name}");
    }
}

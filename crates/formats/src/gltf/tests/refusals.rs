//! Small files, written as changes of one triangle, and what is read of them.
//!
//! `PATH = JSON` sets a value. `accessor TYPE KIND NUMBERS` and `view TYPE NUMBERS` add an accessor or a buffer view,
//! `text JSON` a buffer view of the characters of a string. `cut N` ends the buffer after N bytes, `file NAME TEXT` puts
//! a file beside it, and `show` asks for the meshes.

use super::{Draft, bytes_of, floats, load_bytes};
use crate::cases;
use crate::error::ErrorKind;
use crate::import::{LoadOptions, Loaded};
use bidir::shape::{Orientation, Shape};
use expect_test::expect_file;
use serde_json::json;
use std::fmt::Write;
use std::fs;

#[test]
fn files_and_what_is_read_of_them() {
    for file in [expect_file!["refusals.txt"], expect_file!["geometry.txt"]] {
        cases::check(&file, outcome);
    }
}

fn outcome(text: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let mut draft = Draft::triangle();
    let mut shows = false;
    for line in text.lines() {
        match line.split_once(' ').unwrap_or((line, "")) {
            ("show", _) => shows = true,
            ("cut", count) => draft.buffer.truncate(count.parse().unwrap()),
            ("file", file) => {
                let (name, contents) = file.split_once(' ').unwrap();
                fs::write(folder.path().join(name), contents).unwrap();
            }
            ("text", text) => {
                let text: String = serde_json::from_str(text).unwrap();
                draft.view(&text.chars().map(|byte| byte as u8).collect::<Vec<_>>());
            }
            ("view", numbers) => {
                draft.view(&bytes(numbers).1);
            }
            ("accessor", numbers) => accessor(&mut draft, numbers),
            _ => {
                let (path, value) = line.split_once(" = ").expect("PATH = JSON");
                let is_end = |end: char| end == '.' || end == '[';
                let steps = path.split(is_end).map(|step| step.trim_end_matches(']'));
                let place = steps.fold(&mut draft.json, |at, step| match step.parse::<usize>() {
                    Ok(index) => &mut at[index],
                    Err(_) => &mut at[step],
                });
                *place = serde_json::from_str(value).unwrap();
            }
        }
    }
    let path = folder.path().join("a.gltf");
    let json = if draft.json["buffers"][0]["uri"].is_null() {
        draft.gltf()
    } else {
        serde_json::to_vec(&draft.json).unwrap()
    };
    fs::write(&path, json).unwrap();
    let loaded = super::load(&path, &LoadOptions::default());
    let meshes = loaded.as_ref().map(shown).unwrap_or_default();
    // All lack a camera, and most a light.
    let is_own = |text: &String| {
        !["camera", "light"]
            .iter()
            .any(|it| text.contains(&format!("the scene has no {it}")))
    };
    let read = loaded.map(|loaded| loaded.warnings.into_iter().filter(is_own).collect());
    let outcome = cases::of_reading(read) + if shows { &meshes } else { "" };
    outcome.replace(&format!("{}/", folder.path().display()), "")
}

/// Returns the type of numbers, their bytes, and how many they are.
fn bytes(text: &str) -> (u32, Vec<u8>, usize) {
    let mut words = text.split_whitespace();
    let kind = words.next().expect("a type");
    let numbers: Vec<f32> = words.map(|word| word.parse().unwrap()).collect();
    let count = numbers.len();
    match kind {
        "U8" => (super::U8, bytes_of(&numbers, |n| [n as u8]), count),
        "U16" => (
            super::U16,
            bytes_of(&numbers, |n| (n as u16).to_le_bytes()),
            count,
        ),
        _ => (super::F32, floats(&numbers), count),
    }
}

fn accessor(draft: &mut Draft, text: &str) {
    let (kind, rest) = text.split_once(' ').unwrap();
    let (shape, numbers) = rest.split_once(' ').unwrap();
    let (component, bytes, count) = bytes(&format!("{kind} {numbers}"));
    let size = match shape {
        "SCALAR" => 1,
        shape => usize::from(shape.as_bytes()[3] - b'0'),
    };
    draft.accessor(&bytes, (component, shape, count / size));
}

/// Returns the meshes of a scene, as lines.
fn shown(loaded: &Loaded) -> String {
    let mut text = String::new();
    for shape in loaded.scene.shapes() {
        let Shape::Mesh(mesh) = shape else { continue };
        let reversed = match mesh.orientation {
            Orientation::Natural => "",
            Orientation::Reversed => ", reversed",
        };
        write!(text, "\nmesh {:?}{reversed}", mesh.triangles).unwrap();
        let uvs: Vec<_> = mesh.uvs.iter().map(|uv| uv.extend(0.0)).collect();
        for (name, points) in [
            ("positions", &mesh.positions),
            ("normals", &mesh.normals),
            ("tangents", &mesh.tangents),
            ("uvs", &uvs),
        ] {
            let rounded = |x: f32| (x * 1e4).round() / 1e4 + 0.0;
            let points: Vec<_> = points.iter().map(|p| p.to_array().map(rounded)).collect();
            if !points.is_empty() {
                write!(text, "\n  {name} {points:?}").unwrap();
            }
        }
    }
    for lamp in &loaded.lamps {
        write!(text, "\nlamp that no ray hits: {}", lamp.place).unwrap();
    }
    let (scene, lamps) = (&loaded.scene, loaded.summary.area_lights);
    let bounds = scene.bvh().bounds();
    let (kept, placed) = (scene.unique_primitives(), scene.placed_primitives());
    let instances = scene.instance_count();
    let (low, high) = (bounds.min, bounds.max);
    text + &format!(
        "\n{kept} triangles in {placed} places, {instances} instances, {lamps} lamps, from {low:.2} to {high:.2}"
    )
}

#[test]
fn bad_json_has_a_line_and_a_column() {
    let text = b"{\n  \"asset\": {\"version\": \"2.0\"},\n  \"nodes\": [{\"mesh\": \"zero\"}]\n}";
    for (text, line) in [(&text[..], 3), (b"{ \"asset\": ", 1)] {
        let error = load_bytes("a.gltf", text, &LoadOptions::default()).unwrap_err();
        let found = (error.kind(), error.line());
        assert_eq!(found, (ErrorKind::Syntax, Some(line)), "{error}");
    }
}

/// Deep trees are no trees too deep.
#[test]
fn trees_may_be_deep() {
    let mut draft = Draft::triangle();
    let child = |i| json!({ "children": [i] });
    let nodes = (1..20_000).map(child).chain([json!({ "mesh": 0 })]);
    draft.json["nodes"] = nodes.collect();
    assert_eq!(draft.load().unwrap().summary.shapes, 1);
}

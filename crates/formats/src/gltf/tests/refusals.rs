//! Errors name their place and give a hint.

use super::{Draft, F32, U8, floats, load_bytes};
use crate::error::ErrorKind;
use crate::import::LoadOptions;
use serde_json::json;

#[track_caller]
fn check(draft: &Draft, kind: ErrorKind, words: &[&str]) {
    let error = draft.error();
    let text = error.to_string();
    assert_eq!(error.kind(), kind, "{text}");
    assert!(error.has_place() && text.contains("a.gltf: "), "{text}");
    for word in words {
        assert!(text.contains(word), "`{word}` is not in: {text}");
    }
}

#[test]
fn bad_json_has_a_line_and_a_column() {
    let text = b"{\n  \"asset\": {\"version\": \"2.0\"},\n  \"nodes\": [{\"mesh\": \"zero\"}]\n}";
    let error = load_bytes("a.gltf", text, &LoadOptions::default()).unwrap_err();
    assert_eq!(
        (error.kind(), error.line()),
        (ErrorKind::Syntax, Some(3)),
        "{error}"
    );
    assert!(
        error.to_string().contains("invalid type: string"),
        "{error}"
    );
    let error = load_bytes("a.gltf", b"{ \"asset\": ", &LoadOptions::default()).unwrap_err();
    assert_eq!(
        (error.kind(), error.line()),
        (ErrorKind::Syntax, Some(1)),
        "{error}"
    );
}

#[test]
fn references_to_what_is_not_there_are_refused() {
    let mut draft = Draft::triangle();
    draft.primitive()["attributes"]["POSITION"] = json!(7);
    let place = "meshes[0].primitives[0].attributes.POSITION: there is no accessor 7";
    check(&draft, ErrorKind::Scene, &[place]);
    let mut draft = Draft::triangle();
    draft.json["nodes"][0]["mesh"] = json!(3);
    check(
        &draft,
        ErrorKind::Scene,
        &["nodes[0].mesh: there is no mesh 3"],
    );
    let mut draft = Draft::triangle();
    draft.primitive()["material"] = json!(1);
    check(
        &draft,
        ErrorKind::Scene,
        &["material: there is no material 1"],
    );
    let mut draft = Draft::triangle();
    draft.json["accessors"][0]["bufferView"] = json!(9);
    check(
        &draft,
        ErrorKind::Scene,
        &["accessors[0].bufferView: there is no buffer view 9"],
    );
    let mut draft = Draft::triangle();
    draft.json["scene"] = json!(2);
    check(&draft, ErrorKind::Scene, &["there is no scene 2"]);
}

#[test]
fn cut_buffers_and_wrong_counts_are_refused_before_memory_is_taken() {
    let mut draft = Draft::triangle();
    draft.buffer.truncate(20);
    check(
        &draft,
        ErrorKind::Data,
        &["buffers[0]", "20 bytes instead of 36"],
    );
    for count in [4, usize::MAX, usize::MAX / 12] {
        let mut draft = Draft::triangle();
        draft.json["accessors"][0]["count"] = json!(count);
        check(&draft, ErrorKind::Data, &["accessors[0]", "end beyond"]);
    }
    let mut draft = Draft::triangle();
    let accessor = draft.json["accessors"][0].as_object_mut().unwrap();
    accessor.remove("bufferView");
    accessor.insert("count".into(), json!(1u64 << 50));
    check(&draft, ErrorKind::Limit, &["accessors[0]"]);
    let mut draft = Draft::triangle();
    draft.json["bufferViews"][0]["byteOffset"] = json!(usize::MAX);
    check(&draft, ErrorKind::Data, &["bufferViews[0]"]);
    let mut draft = Draft::triangle();
    draft.json["bufferViews"][0]["byteStride"] = json!(4);
    check(&draft, ErrorKind::Scene, &["4 bytes apart"]);
}

#[test]
fn indices_beyond_the_vertices_are_refused() {
    let mut draft = Draft::triangle();
    let indices = draft.accessor(&[0, 1, 3], (U8, "SCALAR", 3));
    draft.primitive()["indices"] = json!(indices);
    check(
        &draft,
        ErrorKind::Scene,
        &["indices: there is no vertex 3: the mesh has 3"],
    );
    draft.primitive()["indices"] = json!(0);
    check(&draft, ErrorKind::Scene, &["has no indices"]);
}

#[test]
fn cycles_and_second_parents_are_refused() {
    let mut draft = Draft::triangle();
    draft.json["nodes"] = json!([{ "children": [1] }, { "children": [0] }]);
    check(
        &draft,
        ErrorKind::Scene,
        &["nodes[1].children[0]: node 0 is reached twice"],
    );
    draft.json["nodes"] = json!([{ "children": [0] }]);
    check(&draft, ErrorKind::Scene, &["node 0 is reached twice"]);
    draft.json["nodes"] = json!([{ "children": [5] }]);
    check(
        &draft,
        ErrorKind::Scene,
        &["nodes[0].children[0]: there is no node 5"],
    );
    // Deep trees are no trees too deep.
    let depth = 20_000;
    let node = |i| {
        if i + 1 < depth {
            json!({ "children": [i + 1] })
        } else {
            json!({ "mesh": 0 })
        }
    };
    draft.json["nodes"] = (0..depth).map(node).collect();
    assert_eq!(draft.load().unwrap().summary.shapes, 1);
}

#[test]
fn unknown_extensions_are_refused_where_they_are_required() {
    let mut draft = Draft::triangle();
    draft.json["extensionsUsed"] = json!(["ADOBE_magic"]);
    let loaded = draft.load().unwrap();
    assert!(
        loaded.warnings[0].contains("`ADOBE_magic`"),
        "{:?}",
        loaded.warnings
    );
    draft.json["extensionsRequired"] = json!(["ADOBE_magic"]);
    check(
        &draft,
        ErrorKind::Unsupported,
        &["extensionsRequired[0]", "`ADOBE_magic`"],
    );
    draft.json["extensionsRequired"] = json!(["KHR_mesh_quantisation"]);
    check(
        &draft,
        ErrorKind::Unsupported,
        &["did you mean `KHR_mesh_quantization`?"],
    );
    draft.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    check(&draft, ErrorKind::Unsupported, &["without compressing"]);
}

#[test]
fn an_extension_without_effect_has_one_warning_at_its_material() {
    let mut draft = Draft::triangle();
    draft.primitive()["material"] = json!(0);
    draft.json["extensionsUsed"] = json!(["KHR_materials_iridescence"]);
    draft.json["materials"] = json!([{ "extensions": { "KHR_materials_iridescence": {} } }]);
    let warnings = draft.load().unwrap().warnings;
    let about: Vec<_> = warnings
        .iter()
        .filter(|warning| warning.contains("iridescence"))
        .collect();
    assert!(
        matches!(&about[..], [one] if one.contains("materials[0]")),
        "{warnings:?}"
    );
}

#[test]
fn a_file_that_is_no_image_is_named() {
    let mut draft = Draft::triangle();
    draft.primitive()["material"] = json!(0);
    draft.json["images"] = json!([{ "uri": "base.png" }]);
    draft.json["textures"] = json!([{ "source": 0 }]);
    draft.json["materials"] =
        json!([{ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }]);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gltf");
    std::fs::write(&path, draft.gltf()).unwrap();
    std::fs::write(folder.path().join("base.png"), "text").unwrap();
    let error = crate::scene::load(&path, &LoadOptions::default()).unwrap_err();
    let expected = "images[0]: `base.png` is neither png, jpg nor webp";
    assert!(error.to_string().contains(expected), "{error}");
}

#[test]
fn misspelt_names_get_the_nearest_known_one() {
    let mut draft = Draft::triangle();
    draft.primitive()["material"] = json!(0);
    draft.json["materials"] = json!([{ "alphaMode": "BLND" }]);
    check(
        &draft,
        ErrorKind::Scene,
        &["materials[0].alphaMode", "did you mean `BLEND`?"],
    );
    let mut draft = Draft::triangle();
    draft.json["accessors"][0]["type"] = json!("VEC33");
    check(
        &draft,
        ErrorKind::Scene,
        &["accessors[0].type", "did you mean `VEC3`?"],
    );
    let mut draft = Draft::triangle();
    draft.json["cameras"] = json!([{ "type": "perspektive" }]);
    draft.json["nodes"][0]["camera"] = json!(0);
    check(
        &draft,
        ErrorKind::Scene,
        &["cameras[0].type", "did you mean `perspective`?"],
    );
}

#[test]
fn versions_and_missing_files() {
    let mut draft = Draft::triangle();
    draft.json["asset"] = json!({ "version": "1.0" });
    check(
        &draft,
        ErrorKind::Unsupported,
        &["needs glTF 1.0", "convert it"],
    );
    draft.json["asset"] = json!({ "version": "2.1" });
    assert!(draft.load().is_ok());
    let mut draft = Draft::triangle();
    draft.json["buffers"][0]["uri"] = json!("not there.bin");
    let text = serde_json::to_vec(&draft.json).unwrap();
    let error = load_bytes("a.gltf", &text, &LoadOptions::default()).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::MissingFile);
    assert!(error.has_place(), "{error}");
    assert!(
        error
            .to_string()
            .contains("a.gltf: buffers[0].uri: cannot open `"),
        "{error}"
    );
}

#[test]
fn broken_images_and_numbers_are_refused() {
    let mut draft = Draft::triangle();
    draft.primitive()["material"] = json!(0);
    let view = draft.view(b"\x89PNG and no more");
    draft.json["images"] = json!([{ "bufferView": view }]);
    draft.json["textures"] = json!([{ "source": 0 }]);
    draft.json["materials"] =
        json!([{ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }]);
    check(&draft, ErrorKind::Data, &["images[0]"]);
    let view = draft.view(b"RIFF1234WEBP");
    draft.json["images"] = json!([{ "bufferView": view }]);
    check(&draft, ErrorKind::Data, &["images[0]", "broken image"]);
    for (bytes, words) in [
        (&b"WM1234"[..], "neither png, jpg nor webp"),
        (b"\xabKTX 20\xbb\r\n\x1a\n", "it is a KTX2 file"),
        (b"\0\0\0\x20ftypavif", "it is an AVIF file"),
        (b"DDS |\0\0\0", "it is a DDS file"),
    ] {
        let view = draft.view(bytes);
        draft.json["images"] = json!([{ "bufferView": view }]);
        check(
            &draft,
            ErrorKind::Unsupported,
            &[words, "as png, jpg or webp"],
        );
    }
    draft.json["textures"] = json!([{ "extensions": { "KHR_texture_basisu": { "source": 0 } } }]);
    let only = "its only image is a KTX2 file";
    check(&draft, ErrorKind::Unsupported, &["textures[0]", only]);
    draft.json["extensionsRequired"] = json!(["KHR_texture_basisu"]);
    check(
        &draft,
        ErrorKind::Unsupported,
        &["KHR_texture_basisu", "ktx extract"],
    );
    let mut draft = Draft::triangle();
    let bad = [0.0, 0.0, 0.0, 1.0, f32::NAN, 0.0, 0.0, 1.0, 0.0];
    let bad = draft.accessor(&floats(&bad), (F32, "VEC3", 3));
    draft.primitive()["attributes"]["POSITION"] = json!(bad);
    check(
        &draft,
        ErrorKind::Scene,
        &["value 1 of accessor 1 is not finite"],
    );
    let mut draft = Draft::triangle();
    draft.json["nodes"][0]["translation"] = json!([1e30, 0, 0]);
    check(&draft, ErrorKind::Limit, &["beyond"]);
}

/// Accessors, buffers and meshes that are named again take few bytes.
#[test]
fn what_is_named_again_and_again_has_limits() {
    let mut draft = Draft::triangle();
    let zeros = json!({ "componentType": 5126, "type": "VEC3", "count": 1_398_000 });
    draft.json["accessors"] = json!([zeros]);
    let primitive = json!({ "attributes": { "POSITION": 0 } });
    draft.json["meshes"] = json!([{ "primitives": vec![primitive.clone(); 4] }]);
    check(&draft, ErrorKind::Limit, &["primitives or vertices"]);
    // Positions that are not used are read all the same.
    let indexed = json!({ "attributes": { "POSITION": 0 }, "indices": 1 });
    let corners = draft.accessor(&[0, 0, 0], (U8, "SCALAR", 3));
    assert_eq!(corners, 1);
    draft.json["meshes"] = json!([{ "primitives": vec![indexed; 20] }]);
    check(&draft, ErrorKind::Limit, &["again and again"]);
    draft = Draft::triangle();
    let attributes = json!({ "TRANSLATION": 1 });
    draft.json["accessors"].as_array_mut().unwrap().push(zeros);
    draft.json["nodes"][0]["extensions"] =
        json!({ "EXT_mesh_gpu_instancing": { "attributes": attributes } });
    check(&draft, ErrorKind::Limit, &["mesh instances"]);
}

use crate::scene::{LoadOptions, load};
use std::path::PathBuf;

/// Returns the message about a file of this name, without the folder.
fn message(name: &str, bytes: &[u8]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    let error = load(&path, &LoadOptions::default()).unwrap_err();
    let folder = format!("{}{}", folder.path().display(), std::path::MAIN_SEPARATOR);
    error.to_string().replace(&folder, "")
}

#[track_caller]
fn check(name: &str, bytes: &[u8], expected: &str) {
    assert_eq!(message(name, bytes), expected);
}

const FORMATS: &str = "bidir reads pbrt-v4 (.pbrt) and glTF 2.0 (.gltf, .glb)";
const BY_BLENDER: &str = "import it into Blender and export it as glTF 2.0 (docs/guide/blender.md)";

#[test]
fn files_of_blender_are_named_packed_or_not() {
    let expected = "`room.blend` is a Blender file; export it as glTF 2.0 (docs/guide/blender.md)";
    check("room.blend", b"BLENDER-v402REND", expected);
    check("room.blend", b"\x28\xb5\x2f\xfd\0\0\0", expected);
    check("room.blend", b"\x1f\x8b\x08\0\0", expected);
}

#[test]
fn scenes_of_other_renderers_are_named() {
    let mitsuba = b"<?xml version=\"1.0\"?>\n<scene version=\"3.0.0\">\n</scene>";
    let expected = format!("`room.xml` is a Mitsuba scene; {FORMATS}");
    check("room.xml", mitsuba, &expected);
    check("room.pbrt", mitsuba, &expected.replace(".xml`", ".pbrt`"));
    let tungsten = b"{\"media\": [], \"bsdfs\": [{\"name\": \"a\"}], \"primitives\": []}";
    let expected = format!("`room.json` is a Tungsten scene; {FORMATS}");
    check("room.json", tungsten, &expected);
}

#[test]
fn meshes_and_scenes_of_modellers_are_named() {
    let of = |name: &str, kind: &str| format!("`{name}` is {kind}; {BY_BLENDER}");
    for (name, bytes, kind) in [
        (
            "a.obj",
            &b"# by hand\nmtllib a.mtl\nv 0 0 0\n"[..],
            "a Wavefront OBJ file",
        ),
        ("a.usda", b"#usda 1.0\n(\n)", "a USD file"),
        ("a.usdc", b"PXR-USDC\0\0", "a USD file"),
        ("a.usd", b"PXR-USDC\0\0", "a USD file"),
        ("a.usdz", b"PK\x03\x04\0\0", "a USD file"),
        ("a.fbx", b"Kaydara FBX Binary  \0", "an FBX file"),
        ("a.fbx", b"; FBX 7.4.0 project file", "an FBX file"),
        (
            "a.dae",
            b"<?xml version=\"1.0\"?><COLLADA>",
            "a COLLADA file",
        ),
        ("a.abc", b"Ogawa\xff", "an Alembic file"),
    ] {
        check(name, bytes, &of(name, kind));
    }
    assert!(
        message("a.ply", b"ply\nformat ascii 1.0\n").contains("a PLY mesh; name it in a scene")
    );
}

#[test]
fn a_gltf_file_with_another_ending_gets_a_hint() {
    let expected = "`a.pbrt` is a glTF file; name it ";
    let said = message("a.pbrt", b"{\"asset\": {\"version\": \"2.0\"}}");
    assert!(
        said.starts_with(expected) && said.ends_with("a.gltf"),
        "{said}"
    );
    let said = message("a.pbrt", b"glTF\x02\0\0\0");
    assert!(
        said.starts_with("`a.pbrt` is a binary glTF file; name it "),
        "{said}"
    );
    let said = message("a.glb", b"# a room\nLookAt 0 0 0  0 0 1  0 1 0\n");
    assert!(
        said.starts_with("`a.glb` is a pbrt scene; name it "),
        "{said}"
    );
}

#[test]
fn files_that_are_not_gltf_are_named() {
    check(
        "a.glb",
        b"some words",
        &format!("`a.glb` is not a glTF file: it begins with neither `glTF` nor `{{`; {FORMATS}"),
    );
    check(
        "a.gltf",
        b"",
        &format!("`a.gltf` is an empty file; {FORMATS}"),
    );
    check(
        "a.gltf",
        b"\x01\0\0\xfe",
        &format!("`a.gltf` is a binary file, not a scene; {FORMATS}"),
    );
}

#[test]
fn binary_files_are_never_printed() {
    for bytes in [
        &b"\x7fELF\x02\x01\x01\0\0\0"[..],
        b"\xb1\x95\0\0\x01",
        b"ab\0\x1b[31m",
    ] {
        let expected = format!("`a.pbrt` is a binary file, not a scene; {FORMATS}");
        check("a.pbrt", bytes, &expected);
    }
    // Neither zero bytes nor UTF-8.
    let text = message("a.pbrt", b"\x9c\x1b[31m\xff\xfe");
    assert!(text.is_ascii() && !text.contains('\x1b'), "{text:?}");
}

#[test]
fn images_films_and_prose_are_named() {
    for (name, bytes) in [
        ("a.png", &b"\x89PNG\r\n\x1a\n"[..]),
        ("a.pbrt", b"\xff\xd8\xff\xe0"),
        ("a.exr", b"\x76\x2f\x31\x01\x02\0\0\0"),
        ("a.hdr", b"#?RADIANCE\n"),
    ] {
        assert!(message(name, bytes).starts_with(&format!("`{name}` is an image; ")));
    }
    assert!(message("a.film", b"BIDIRFLM\x01").contains("is a film file; `bidir film develop`"));
    let toml = message("a.toml", b"title = \"a\"\n");
    assert!(
        toml.contains("is a TOML file; `bidir experiment`"),
        "{toml}"
    );
    let prose = format!("`README.md` is not a scene; {FORMATS}");
    check("README.md", b"# bidir\n\nbidir is a renderer.\n", &prose);
}

#[test]
fn a_folder_is_named_with_a_scene_in_it() {
    let folder = tempfile::tempdir().unwrap();
    let at = |path: PathBuf| {
        load(&path, &LoadOptions::default())
            .unwrap_err()
            .to_string()
    };
    let said = at(folder.path().to_owned());
    assert!(
        said.ends_with("is a folder; name a scene: .pbrt, .gltf or .glb"),
        "{said}"
    );
    std::fs::write(folder.path().join("b.pbrt"), "").unwrap();
    std::fs::write(folder.path().join("a.glb"), "").unwrap();
    let said = at(folder.path().to_owned());
    let scene = folder.path().join("a.glb");
    let expected = format!(
        "is a folder; name a scene in it, such as {}",
        scene.display()
    );
    assert!(said.ends_with(&expected), "{said}");
}

#[test]
fn scenes_with_unusual_endings_are_read_and_the_parser_reports_misspellings() {
    let folder = tempfile::tempdir().unwrap();
    let text = "# a sky\nWorldBegin LightSource \"infinite\"\n";
    for name in ["sky", "sky.txt", "sky.xml", "sky.PBRT"] {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        assert!(load(&path, &LoadOptions::default()).is_ok(), "{name}");
    }
    let said = message("sky.pbrt", b"LokAt 0 0 0\nWorldBegin\n");
    assert_eq!(
        said,
        "sky.pbrt:1:1: unknown directive `LokAt`; did you mean `LookAt`?"
    );
    let said = message("sky.txt", b"LokAt 0 0 0\nWorldBegin\n");
    assert_eq!(
        said,
        "sky.txt:1:1: unknown directive `LokAt`; did you mean `LookAt`?"
    );
}

use super::STRICT;
use crate::pbrt::{LoadOptions, SceneDigest, load};
use flate2::{Compression, write::GzEncoder};
use std::collections::BTreeMap;
use std::io::Write;

/// Files by name. The lowest bit of each last byte may be flipped.
type Files = BTreeMap<&'static str, Vec<u8>>;

const SCENE: &str = r#"
WorldBegin
Texture "t" "spectrum" "imagemap" "string filename" "t.pfm"
Texture "unused" "spectrum" "imagemap" "string filename" "unused.pfm"
Material "diffuse" "texture reflectance" "t"
Include "part.pbrt"
Import "import.pbrt"
LightSource "infinite" "string filename" "sky.pfm"
# 0"#;
const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 4\n\
    property float x\nproperty float y\nproperty float z\n\
    element face 1\nproperty list uchar int vertex_indices\nend_header\n\
    0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2";
const PFM: &str = "Pf\n1 1\n1.0\n>abc";

fn files() -> Files {
    let files = [
        ("s.pbrt", SCENE),
        (
            "part.pbrt",
            "Shape \"plymesh\" \"string filename\" \"m.ply\" # 0",
        ),
        ("import.pbrt", "Shape \"sphere\" # 0"),
        ("m.ply", PLY),
        ("t.pfm", PFM),
        ("sky.pfm", PFM),
        ("unused.pfm", PFM),
    ];
    files.map(|(name, text)| (name, text.into())).into()
}

/// Returns the digest of the scene `name` in a new folder with `files`.
#[track_caller]
fn digest(name: &str, files: &Files, options: &LoadOptions) -> SceneDigest {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    let loaded = load(&folder.path().join(name), options);
    loaded.unwrap_or_else(|error| panic!("{error}")).digest
}

/// Flips a bit of the file `name`, and checks whether that makes another scene.
#[track_caller]
fn check_flip(name: &str, is_another: bool) {
    let mut flipped = files();
    *flipped.get_mut(name).unwrap().last_mut().unwrap() ^= 1;
    let before = digest("s.pbrt", &files(), &STRICT);
    assert_eq!(digest("s.pbrt", &flipped, &STRICT) != before, is_another);
}

#[test]
fn the_digest_depends_on_every_file_that_is_read() {
    check_flip("s.pbrt", true);
    check_flip("part.pbrt", true);
    check_flip("import.pbrt", true);
    check_flip("m.ply", true);
    check_flip("t.pfm", true);
    check_flip("sky.pfm", true);
    check_flip("unused.pfm", false);
}

#[test]
fn the_digest_does_not_depend_on_folders_packing_and_options() {
    let mut files = files();
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(&files["s.pbrt"]).unwrap();
    files.insert("packed.pbrt.gz", encoder.finish().unwrap());
    let plain = digest("s.pbrt", &files, &STRICT);
    assert_eq!(digest("s.pbrt", &files, &STRICT), plain);
    assert_eq!(digest("packed.pbrt.gz", &files, &STRICT), plain);
    let options = LoadOptions {
        lenient: true,
        resolution: Some([3, 2]),
        ..STRICT
    };
    assert_eq!(digest("s.pbrt", &files, &options), plain);
}

#[test]
fn the_digest_depends_on_the_boundaries_between_files() {
    let split = |a: &str, b: &str| {
        let main = "WorldBegin Include \"a\" Include \"b\"";
        let files = [("s.pbrt", main), ("a", a), ("b", b)];
        let files = files.map(|(name, text)| (name, text.into())).into();
        digest("s.pbrt", &files, &STRICT)
    };
    assert_ne!(split("# a\n", "# b\n"), split("# a\n# b\n", ""));
    assert_ne!(split("# a\n", "# b\n"), split("# b\n", "# a\n"));
}

#[test]
fn a_scene_in_memory_has_the_digest_of_its_file() {
    let text = "WorldBegin Shape \"sphere\"";
    let of_file = digest("s.pbrt", &[("s.pbrt", text.into())].into(), &STRICT);
    assert_eq!(super::load_text(text, &STRICT).digest, of_file);
}

//! The scenes of published measurements are frozen: any change of a file that is read for them fails here.
//! Make a new scene instead.

use bidir_formats::pbrt::{LoadOptions, load};
use std::path::Path;

/// Checks the hash of all files that are read for a scene.
#[track_caller]
fn check(name: &str, digest: &str) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let options = LoadOptions {
        resolution: Some([4, 3]),
        ..LoadOptions::default()
    };
    let loaded = load(&folder.join(name), &options).expect("the project's scenes are valid");
    assert_eq!(loaded.digest.to_string(), digest, "{name}");
}

#[test]
fn scenes_of_the_paper_are_frozen() {
    check(
        "room-direct.pbrt",
        "6e0e550b8d3ffb506d85d1508527a60046679de03e5ab5c3f46488e5b5dc30c6",
    );
    check(
        "room-indirect.pbrt",
        "b1f179372a3a727ffc6b39d14076820badb7843a77b0dc76969b7a7032e89d0b",
    );
    check(
        "apartment.pbrt",
        "9b30b83936a1a72ad20b2c5bb4f84ce4fa4a01bf385003a916efda91a620b418",
    );
    check(
        "apartment-dark.pbrt",
        "a3701f80eca2ebb1654469851f69be472102fe5d973376fc5a61f0e92103b68d",
    );
}

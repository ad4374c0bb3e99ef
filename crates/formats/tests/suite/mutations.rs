//! Nearly valid files never make a parser panic: the seeds of the fuzz targets, and a few thousand
//! mutations of them, the same in every run.
#![expect(
    unreachable_pub,
    reason = "the modules belong to a crate where they are reached"
)]

#[path = "../../../../fuzz/src/check.rs"]
mod check;
#[path = "../../../../fuzz/src/inputs.rs"]
mod inputs;
#[path = "../../../../fuzz/src/mutation.rs"]
mod mutation;

use std::path::Path;

fn check(target: &str, rounds: u64, read: fn(&[u8])) {
    let seeds = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/seeds");
    check::check(&seeds.join(target), rounds, read);
}

#[test]
fn scenes() {
    check("pbrt", 600, inputs::pbrt);
}

#[test]
fn gltf_scenes() {
    check("gltf", 1500, inputs::gltf);
}

#[test]
fn meshes() {
    check("ply", 4000, inputs::ply);
}

#[test]
fn images() {
    check("image", 400, inputs::image);
}

#[test]
fn films() {
    check("film", 1000, inputs::film);
}

#[test]
fn spectra() {
    check("spectrum", 200, inputs::spectrum);
}

#[test]
fn grids() {
    check("nanovdb", 150, inputs::nanovdb);
}

#[test]
#[should_panic(expected = "panics: mutation")]
fn a_panic_fails_the_test() {
    check("spectrum", 50, |bytes| assert!(!bytes.contains(&0xff)));
}

//! Path tracing and bidirectional path tracing agree on scenes made by others. The variable BIDIR_SCENES
//! names the folder with `pbrt-v4/` and `gltf/`; without it the tests are skipped, and with it every scene
//! must exist.

#![allow(clippy::print_stderr, reason = "a skipped test says so")]

use crate::statistics::{Replicates, Shown, WHOLE, check_agree, check_means, replicates, suspects};
use bidir::driver::Settings;
use bidir::integrator::IntegratorKind;
use bidir::path::PathSettings;
use bidir_formats::scene::{Crop, LoadOptions, Loaded, load};
use std::path::PathBuf;

/// Loads a scene with a film of `size` × `size` pixels and a crop. None: the tests are skipped, which is
/// printed.
fn open_part(name: &str, size: u32, crop: Option<Crop>) -> Option<Loaded> {
    let Some(folder) = std::env::var_os("BIDIR_SCENES") else {
        eprintln!("skipped: BIDIR_SCENES is not set");
        return None;
    };
    let file = PathBuf::from(folder).join(name);
    let options = LoadOptions {
        resolution: Some([size; 2]),
        crop,
        ..LoadOptions::default()
    };
    Some(load(&file, &options).expect("the scene is supported"))
}

fn open(name: &str, size: u32) -> Option<Loaded> {
    open_part(name, size, None)
}

fn estimate(loaded: &Loaded, integrator: IntegratorKind, passes: u64) -> Replicates {
    estimate_anew(loaded, integrator, passes, 0)
}

/// Does the same with another seed.
fn estimate_anew(
    loaded: &Loaded,
    integrator: IntegratorKind,
    passes: u64,
    seed: u64,
) -> Replicates {
    let path = PathSettings {
        max_depth: Some(loaded.settings.max_depth),
        ..PathSettings::default()
    };
    let settings = Settings {
        path,
        seed,
        ..Settings::new(integrator)
    };
    let shown = Shown {
        scene: &loaded.scene,
        view: &loaded.view,
    };
    replicates(shown, &settings, passes)
}

/// Compares the two estimators on a small film: the bidirectional one with `passes`, path tracing, which is
/// noisier and cheaper, with `factor` times as many.
#[track_caller]
fn check(name: &str, passes: u64, factor: u64) {
    let Some(loaded) = open(name, 32) else { return };
    let bdpt = estimate(&loaded, IntegratorKind::Bdpt, passes);
    let path = estimate(&loaded, IntegratorKind::Path, factor * passes);
    check_agree(name, &bdpt, &path, &[WHOLE, 16]);
}

#[test]
fn cornell_box() {
    check("pbrt-v4/cornell-box-w3ntao/cornell-box.pbrt", 256, 8);
}

#[test]
fn gltf_cornell_box() {
    check("gltf/CornellBox/CornellBox.glb", 640, 4);
}

#[test]
fn gltf_flight_helmet() {
    check("gltf/FlightHelmet/FlightHelmet.gltf", 64, 2);
}

mod long_statistics {
    use super::check;

    #[test]
    #[ignore = "long statistics: .ci/run statistics"]
    fn coffee() {
        check("pbrt-v4/coffee/coffee.pbrt", 320, 8);
    }

    #[test]
    #[ignore = "long statistics: .ci/run statistics"]
    fn veach_bidir() {
        check("pbrt-v4/veach-bidir/veach-bidir.pbrt", 1024, 24);
    }

    #[test]
    #[ignore = "long statistics: .ci/run statistics"]
    fn veach_mis() {
        check("pbrt-v4/veach-mis/veach-mis.pbrt", 1024, 4);
    }

    #[test]
    #[ignore = "long statistics: .ci/run statistics"]
    fn veach_ajar() {
        check("pbrt-v4/veach-ajar/veach-ajar.pbrt", 5120, 3);
    }

    #[test]
    #[ignore = "long statistics: .ci/run statistics"]
    fn living_room() {
        check("pbrt-v4/living-room/living-room.pbrt", 1024, 4);
    }
}

/// The film of a large comparison.
const LARGE: u32 = 192;
/// The size of compared blocks.
const BLOCK: usize = 16;
/// Samples per pixel of bidirectional path tracing in a large comparison.
const PASSES: u64 = 64;
/// The cross-check by path tracing, with more samples.
const BY_PATH: (IntegratorKind, u64) = (IntegratorKind::Path, 16 * PASSES);
/// The cross-check for scenes in which path tracing finds most light by rare hits of small lamps.
const BY_LVC: (IntegratorKind, u64) = (IntegratorKind::Lvc, PASSES);
/// Factor on the samples of blocks that differ.
const AGAIN: u64 = 256;

/// Compares 64 samples per pixel of bidirectional path tracing with a second estimator: blocks of 16 × 16
/// pixels agree, and means are within 1 %.
///
/// Both estimators find caustics seen in mirrors by rare hits of a lamp: in such a block the means of 32
/// replicates are skewed, most of them too dark and alike, which looks like a bias. Blocks that differ are
/// rendered again with 256 times as many samples: a bias stays, a skewed mean does not.
#[track_caller]
fn check_large(name: &str, cross_check: (IntegratorKind, u64)) {
    let Some(loaded) = open(name, LARGE) else {
        return;
    };
    let bdpt = estimate(&loaded, IntegratorKind::Bdpt, PASSES);
    let other = estimate(&loaded, cross_check.0, cross_check.1);
    let ratio = bdpt.mean() / other.mean();
    eprintln!("{name}: mean ratio {ratio:.5}");
    assert!((ratio - 1.0).abs() < 0.01, "the means differ: {ratio}");
    check_means(name, &bdpt, &other, BLOCK);
    for block in suspects(&bdpt, &other, BLOCK) {
        check_again(name, cross_check, block);
    }
}

/// Compares the two in these pixels only.
#[track_caller]
fn check_again(
    name: &str,
    cross_check: (IntegratorKind, u64),
    [left, top, right, bottom]: [u32; 4],
) {
    let crop = Crop::Pixels([left, right, top, bottom]);
    let loaded = open_part(name, LARGE, Some(crop)).expect("it was there before");
    let again = |(integrator, passes)| estimate_anew(&loaded, integrator, AGAIN * passes, 1);
    let [bdpt, other] = [(IntegratorKind::Bdpt, PASSES), cross_check].map(again);
    let name = format!("{name}, again from {left}, {top}");
    eprintln!("{name}: {:.5}, {:.5}", bdpt.mean(), other.mean());
    check_agree(&name, &bdpt, &other, &[WHOLE]);
}

#[test]
#[ignore = "takes long: just nightly"]
fn large_veach_bidir() {
    check_large("pbrt-v4/veach-bidir/veach-bidir.pbrt", BY_LVC);
}

#[test]
#[ignore = "takes long: just nightly"]
fn large_veach_mis() {
    check_large("pbrt-v4/veach-mis/veach-mis.pbrt", BY_LVC);
}

#[test]
#[ignore = "takes long: just nightly"]
fn large_veach_ajar() {
    check_large("pbrt-v4/veach-ajar/veach-ajar.pbrt", BY_PATH);
}

#[test]
#[ignore = "takes long: just nightly"]
fn large_coffee() {
    check_large("pbrt-v4/coffee/coffee.pbrt", BY_PATH);
}

#[test]
#[ignore = "takes long: just nightly"]
fn large_living_room() {
    check_large("pbrt-v4/living-room/living-room.pbrt", BY_PATH);
}

#[test]
#[ignore = "takes long: just nightly"]
fn large_boxes() {
    for name in [
        "cornell-box",
        "cornell-box-silver",
        "cornell-box-specular",
        "smallpt",
    ] {
        check_large(&format!("pbrt-v4/cornell-box-w3ntao/{name}.pbrt"), BY_PATH);
    }
}

#[test]
#[ignore = "takes long: just nightly"]
fn large_gltf() {
    for name in [
        "CornellBox/CornellBox.glb",
        "FlightHelmet/FlightHelmet.gltf",
        "ajar_caustic.glb",
    ] {
        check_large(&format!("gltf/{name}"), BY_PATH);
    }
}

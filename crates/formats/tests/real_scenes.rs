//! Scenes that others made: path tracing and bidirectional path tracing agree on them too. The
//! variable BIDIR_SCENES names the folder that holds `pbrt-v4/`; without it the tests are skipped, and with
//! it every scene must be there.

#![allow(clippy::print_stderr, reason = "a skipped test says so")]

#[path = "../../bidir/tests/common/statistics.rs"]
mod statistics;

use bidir::driver::Settings;
use bidir::integrator::IntegratorKind;
use bidir::path::PathSettings;
use bidir_formats::pbrt::{LoadOptions, Loaded, load};
use statistics::{COARSE, FINE, check_agree, replicates};
use std::path::PathBuf;

/// Loads a scene at a small size. None: the tests are skipped, which is said.
fn open(name: &str) -> Option<Loaded> {
    let Some(folder) = std::env::var_os("BIDIR_SCENES") else {
        eprintln!("skipped: BIDIR_SCENES is not set");
        return None;
    };
    let file = PathBuf::from(folder).join("pbrt-v4").join(name);
    let options = LoadOptions {
        resolution: Some([32, 32]),
        ..LoadOptions::default()
    };
    Some(load(&file, &options).expect("the scene is supported"))
}

/// Compares the two estimators with `passes` of the bidirectional one, so that `bias` would show.
#[track_caller]
fn check(name: &str, passes: u64, bias: f64) {
    let Some(loaded) = open(name) else { return };
    let render = |integrator, passes| {
        let path = PathSettings {
            max_depth: Some(loaded.settings.max_depth),
            ..PathSettings::default()
        };
        let settings = Settings {
            integrator,
            path,
            ..Settings::default()
        };
        replicates(&loaded.scene, &settings, passes, 16)
    };
    let bdpt = render(IntegratorKind::Bdpt, passes);
    let path = render(IntegratorKind::Path, 8 * passes);
    check_agree(name, &bdpt, &path, bias);
}

#[test]
fn veach_bidir() {
    check("veach-bidir/veach-bidir.pbrt", 64, COARSE);
}

#[test]
fn veach_mis() {
    check("veach-mis/veach-mis.pbrt", 64, COARSE);
}

#[test]
fn veach_ajar() {
    check("veach-ajar/veach-ajar.pbrt", 32, COARSE);
}

#[test]
fn cornell_box() {
    check("cornell-box-w3ntao/cornell-box.pbrt", 32, FINE);
}

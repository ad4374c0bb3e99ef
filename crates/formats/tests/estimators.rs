//! All estimators agree with the path tracer on the torture scenes, each of which is after one way
//! to be wrong. The scenes are the project's own, in `scenes/torture`.

#[path = "../../bidir/tests/common/statistics.rs"]
mod statistics;

use bidir::driver::Settings;
use bidir::integrator::IntegratorKind;
use bidir::path::{LightPointChoice, MisHeuristic, PathRoulette, PathSettings};
use bidir::scene::Scene;
use bidir_formats::pbrt::{LoadOptions, Loaded, load};
use statistics::{COARSE, FINE, Replicates, check_agree, replicates};
use std::path::Path;

/// A scene, the limit of depth that its file asks for, and the passes of one replicate.
#[derive(Clone, Copy)]
struct Case<'a> {
    scene: &'a Scene,
    max_depth: u32,
    passes: u64,
}

fn open(name: &str) -> Loaded {
    let file = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../scenes/torture")
        .join(name);
    load(&file, &LoadOptions::default()).expect("the project's scenes are valid")
}

impl<'a> Case<'a> {
    fn new(loaded: &'a Loaded, passes: u64) -> Self {
        Self {
            scene: &loaded.scene,
            max_depth: loaded.settings.max_depth,
            passes,
        }
    }

    /// The case with `factor` times as many passes, for an estimator of more variance.
    fn with_effort(self, factor: u64) -> Self {
        Self {
            passes: self.passes * factor,
            ..self
        }
    }

    /// Renders with settings changed by `change`. The path tracer is cheap and gets more passes.
    fn render(&self, integrator: IntegratorKind, change: impl Fn(&mut Settings)) -> Replicates {
        let path = PathSettings {
            max_depth: Some(self.max_depth),
            ..PathSettings::default()
        };
        let mut settings = Settings {
            integrator,
            path,
            ..Settings::default()
        };
        change(&mut settings);
        let passes = match integrator {
            IntegratorKind::Path | IntegratorKind::Light => 2 * self.passes,
            IntegratorKind::Bdpt => self.passes,
        };
        replicates(self.scene, &settings, passes, 8)
    }

    fn bdpt(&self, change: impl Fn(&mut Settings)) -> Replicates {
        self.render(IntegratorKind::Bdpt, change)
    }

    /// Compares the bidirectional path tracer with the path tracer, and returns the latter.
    #[track_caller]
    fn check_bdpt(&self) -> Replicates {
        let reference = self.render(IntegratorKind::Path, |_| ());
        check_agree("bdpt", &self.bdpt(|_| ()), &reference, FINE);
        reference
    }

    /// Compares all three estimators.
    #[track_caller]
    fn check_all(&self) -> Replicates {
        let reference = self.check_bdpt();
        let light = self.render(IntegratorKind::Light, |_| ());
        check_agree("light", &light, &reference, COARSE);
        reference
    }
}

#[test]
fn glass_smooth_and_rough() {
    // The light tracer cannot see through smooth glass, and so is not asked.
    Case::new(&open("glass.pbrt"), 64).check_bdpt();
}

#[test]
fn metal_smooth_rough_and_anisotropic() {
    Case::new(&open("conductor.pbrt"), 32).check_bdpt();
}

#[test]
fn half_covered_lens() {
    Case::new(&open("lens.pbrt"), 72).check_all();
}

#[test]
fn shading_normals_that_disagree_with_the_geometry() {
    Case::new(&open("shading-normal.pbrt"), 32).check_all();
}

#[test]
fn mirrored_transforms_and_two_sided_lights() {
    Case::new(&open("mirror.pbrt"), 32).check_all();
}

#[test]
fn point_spot_distant_and_infinite_lights() {
    Case::new(&open("lights.pbrt"), 48).check_all();
}

#[test]
fn a_crop_is_the_same_part_of_the_whole() {
    Case::new(&open("crop.pbrt"), 64).check_all();
}

#[test]
fn filters_with_and_without_negative_lobes() {
    for name in ["gaussian", "mitchell", "sinc"] {
        let loaded = open(&format!("filter-{name}.pbrt"));
        let case = Case::new(&loaded, 64);
        let reference = case.check_all();
        // Walks whose film position has a negative weight survive as others do.
        let throughput = case.render(IntegratorKind::Path, |settings| {
            settings.path.roulette = PathRoulette::Throughput { start: 0 };
        });
        check_agree("throughput", &throughput, &reference, COARSE);
    }
}

#[test]
fn any_scale_of_the_world() {
    let unit = Case::new(&open("scale-unit.pbrt"), 20).check_all();
    for name in ["scale-tiny.pbrt", "scale-huge.pbrt"] {
        let scaled = Case::new(&open(name), 20).check_all();
        check_agree(name, &scaled, &unit, FINE);
    }
}

#[test]
fn surfaces_that_almost_touch() {
    Case::new(&open("touching.pbrt"), 32).check_all();
}

#[test]
fn every_choice_of_shadow_rays_under_every_heuristic() {
    // Red light on bluish surfaces: a biased colour would show.
    let loaded = open("red-light-blue-surfaces.pbrt");
    let case = Case::new(&loaded, 12);
    let reference = case.with_effort(3).check_all();
    for (mis_name, mis) in MisHeuristic::NAMES {
        for rule in [
            "per-light-vertex",
            "per-camera-vertex",
            "per-pair",
            "ray-roulette",
            "budget:2",
        ] {
            let case = case.with_effort(if mis == MisHeuristic::Balance { 2 } else { 1 });
            let result = case.bdpt(|settings| {
                settings.path.mis = mis;
                settings.shadow_rays = rule.parse().expect("a rule");
            });
            let bias = if mis == MisHeuristic::Balance {
                FINE
            } else {
                COARSE
            };
            check_agree(&format!("{rule}, {mis_name}"), &result, &reference, bias);
        }
    }
}

#[test]
fn shared_light_points_and_missing_strategies() {
    let loaded = open("red-light-blue-surfaces.pbrt");
    let case = Case::new(&loaded, 24);
    let reference = case.render(IntegratorKind::Path, |_| ());
    let shared = case.bdpt(|settings| settings.path.light_point = LightPointChoice::Shared);
    check_agree("shared", &shared, &reference, FINE);
    // Each of these lists can still make every path of the scene.
    let lists = [
        ("all,-s0", FINE),
        ("all,-t1", FINE),
        ("all,-s1", FINE),
        ("all,-s1,-t1", COARSE),
        ("s0,s1", FINE),
    ];
    for (list, bias) in lists {
        let result = case.with_effort(2).bdpt(|settings| {
            settings.path.strategies = list.parse().expect("a list of strategies");
        });
        check_agree(list, &result, &reference, bias);
    }
}

#[test]
fn single_strategies_at_fixed_length() {
    let loaded = open("separated.pbrt");
    let case = Case::new(&loaded, 128);
    for length in [3, 4] {
        let single = |s: usize| {
            let only = format!("s{s}t{}", length - s);
            // Few light subpaths reach the lens's view, or the camera's few surfaces.
            let case = case.with_effort(if s == 1 { 1 } else { 8 });
            case.bdpt(|settings| settings.path.strategies = only.parse().expect("a strategy"))
        };
        let next_event = single(1);
        for s in 2..length {
            let name = format!("s{s}t{} against s1", length - s);
            check_agree(&name, &single(s), &next_event, COARSE);
        }
    }
}

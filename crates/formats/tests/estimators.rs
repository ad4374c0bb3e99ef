//! All estimators agree with the path tracer on the torture scenes, each of which is after one way
//! to be wrong. The scenes are the project's own, in `scenes/torture`.

#[path = "../../bidir/tests/common/statistics/mod.rs"]
mod statistics;

use bidir::driver::Settings;
use bidir::integrator::IntegratorKind;
use bidir::path::{LightPointChoice, MisHeuristic, PathRoulette, PathSettings};
use bidir::scene::Scene;
use bidir_formats::pbrt::{LoadOptions, Loaded, load};
use statistics::{Replicates, WHOLE, check_agree, replicates};
use std::path::Path;

/// Few pixels with many samples each: then the mean of a pixel is close to normal.
const RESOLUTION: [u32; 2] = [16, 16];
/// The film's mean and every pixel are compared.
const PIXELS: &[usize] = &[WHOLE, 1];
/// For estimators whose pixels have heavy tails: the film's mean and its quarters.
const QUARTERS: &[usize] = &[WHOLE, 8];

/// A scene, the limit of depth that its file asks for, and the passes of all replicates.
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
    let options = LoadOptions {
        resolution: Some(RESOLUTION),
        ..LoadOptions::default()
    };
    load(&file, &options).expect("the project's scenes are valid")
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
        replicates(self.scene, &settings, passes)
    }

    fn bdpt(&self, change: impl Fn(&mut Settings)) -> Replicates {
        self.render(IntegratorKind::Bdpt, change)
    }

    /// Compares the bidirectional path tracer with the path tracer, and returns the latter.
    #[track_caller]
    fn check_bdpt(&self) -> Replicates {
        let reference = self.render(IntegratorKind::Path, |_| ());
        check_agree("bdpt", &self.bdpt(|_| ()), &reference, PIXELS);
        reference
    }

    /// Compares the light tracer with the path tracer's result.
    #[track_caller]
    fn check_light(&self, reference: &Replicates) {
        let light = self.render(IntegratorKind::Light, |_| ());
        check_agree("light", &light, reference, QUARTERS);
    }

    /// Compares all three estimators.
    #[track_caller]
    fn check_all(&self) -> Replicates {
        let reference = self.check_bdpt();
        self.check_light(&reference);
        reference
    }
}

#[test]
fn glass_smooth_and_rough() {
    // The light tracer cannot see through smooth glass, and so is not asked.
    Case::new(&open("glass.pbrt"), 9216).check_bdpt();
}

#[test]
fn metal_smooth_rough_and_anisotropic() {
    Case::new(&open("conductor.pbrt"), 4608).check_bdpt();
}

#[test]
fn half_covered_lens() {
    let loaded = open("lens.pbrt");
    let case = Case::new(&loaded, 10368);
    let reference = case.check_bdpt();
    // Splats from what is close to the lens are few and bright.
    case.with_effort(3).check_light(&reference);
}

#[test]
fn shading_normals_that_disagree_with_the_geometry() {
    Case::new(&open("shading-normal.pbrt"), 4608).check_all();
}

#[test]
fn mirrored_transforms_and_two_sided_lights() {
    Case::new(&open("mirror.pbrt"), 4608).check_all();
}

#[test]
fn point_spot_distant_and_infinite_lights() {
    Case::new(&open("lights.pbrt"), 6912).check_all();
}

#[test]
fn a_crop_is_the_same_part_of_the_whole() {
    Case::new(&open("crop.pbrt"), 9216).check_all();
}

#[test]
fn filters_with_and_without_negative_lobes() {
    for name in ["triangle", "gaussian", "mitchell", "sinc"] {
        let loaded = open(&format!("filter-{name}.pbrt"));
        let case = Case::new(&loaded, 6144);
        let reference = case.check_all();
        // Walks whose film position has a negative weight survive as others do.
        let throughput = case
            .with_effort(3)
            .render(IntegratorKind::Path, |settings| {
                settings.path.roulette = PathRoulette::Throughput { start: 0 };
            });
        check_agree("throughput", &throughput, &reference, PIXELS);
    }
}

#[test]
fn any_scale_of_the_world() {
    let unit = Case::new(&open("scale-unit.pbrt"), 1280).check_all();
    for name in ["scale-tiny.pbrt", "scale-huge.pbrt"] {
        let scaled = Case::new(&open(name), 1280).check_all();
        check_agree(name, &scaled, &unit, PIXELS);
    }
}

#[test]
fn surfaces_that_almost_touch() {
    Case::new(&open("touching.pbrt"), 2048).check_all();
}

#[test]
fn every_choice_of_shadow_rays_under_every_heuristic() {
    // Red light on bluish surfaces: a biased colour would show.
    let loaded = open("red-light-blue-surfaces.pbrt");
    let case = Case::new(&loaded, 768);
    let reference = case.with_effort(6).check_all();
    for (mis_name, mis) in MisHeuristic::NAMES {
        for rule in [
            "per-light-vertex",
            "per-camera-vertex",
            "per-pair",
            "ray-roulette",
            "budget:2",
        ] {
            let case = case.with_effort(2);
            let result = case.bdpt(|settings| {
                settings.path.mis = mis;
                settings.shadow_rays = rule.parse().expect("a rule");
            });
            let blocks = match mis {
                MisHeuristic::Balance => PIXELS,
                MisHeuristic::Power | MisHeuristic::Uniform => QUARTERS,
            };
            check_agree(&format!("{rule}, {mis_name}"), &result, &reference, blocks);
        }
    }
}

#[test]
fn shared_light_points_and_missing_strategies() {
    let loaded = open("red-light-blue-surfaces.pbrt");
    let case = Case::new(&loaded, 1536);
    let reference = case.with_effort(4).render(IntegratorKind::Path, |_| ());
    let shared = case.bdpt(|settings| settings.path.light_point = LightPointChoice::Shared);
    check_agree("shared", &shared, &reference, PIXELS);
    // Each of these lists can still make every path of the scene.
    let lists = [
        ("all,-s0", PIXELS),
        ("all,-s1", PIXELS),
        ("all,-s2", PIXELS),
        ("all,-t1", PIXELS),
        ("all,-s1,-t1", QUARTERS),
        ("s0,s1", PIXELS),
    ];
    for (list, blocks) in lists {
        let result = case.with_effort(2).bdpt(|settings| {
            settings.path.strategies = list.parse().expect("a list of strategies");
        });
        check_agree(list, &result, &reference, blocks);
    }
}

#[test]
fn single_strategies_at_fixed_length() {
    let loaded = open("separated.pbrt");
    let case = Case::new(&loaded, 8192);
    // Walks of the camera that meet the lamp after two bounces are too few to compare.
    for (length, others) in [(3, [0, 2]), (4, [2, 3])] {
        let single = |s: usize, effort: u64| {
            let only = format!("s{s}t{}", length - s);
            case.with_effort(effort)
                .bdpt(|settings| settings.path.strategies = only.parse().expect("a strategy"))
        };
        let next_event = single(1, 1);
        for s in others {
            let name = format!("s{s}t{} against s1", length - s);
            // Few light subpaths reach the lens's view, and few walks of the camera the lamp.
            let result = single(s, if s == 0 { 3 } else { 8 });
            check_agree(&name, &result, &next_event, QUARTERS);
        }
    }
}

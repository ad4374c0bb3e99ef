//! All estimators agree with the path tracer on the torture scenes in `scenes/torture`, each of which
//! exposes one kind of error.
//!
//! This file has the scenes that need comparisons of their own; `matrix` has every integrator with every
//! choice of shadow rays on all scenes; `plans` has the plans that `auto` chooses; `places` moves and
//! scales a scene.

mod case;
mod matrix;
mod nested;
mod places;
mod plans;
mod subsurface;

#[path = "../../../bidir/tests/common/statistics/mod.rs"]
mod statistics;

use bidir::integrator::{CandidateCount, IntegratorKind, LightStart};
use bidir::path::{LightChoiceKind, LightPointChoice, MisHeuristic, PathRoulette};
use bidir::select::ShadowRays;
use bidir_formats::pbrt::Crop;
use bidir_formats::pbrt::Loaded;
use case::{Case, PIXELS, QUARTERS, open, open_part};
use statistics::{Replicates, check_agree, check_paired};
use std::sync::LazyLock;

/// A scene for several tests, with its image by path tracing, which is rendered once.
struct World {
    loaded: Loaded,
    passes: u64,
    reference: Replicates,
}

impl World {
    /// Renders the reference with twice `effort` times the passes of a test.
    fn new(name: &str, passes: u64, effort: u64) -> Self {
        let loaded = open(&format!("{name}.pbrt"));
        let reference = Case::new(&loaded, passes).with_effort(effort).path();
        Self {
            loaded,
            passes,
            reference,
        }
    }

    fn case(&self) -> Case<'_> {
        Case::new(&self.loaded, self.passes)
    }
}

/// Red light on bluish surfaces: a biased colour would show.
static RED_LIGHT: LazyLock<World> = LazyLock::new(|| World::new("red-light-blue-surfaces", 256, 4));

#[test]
fn glass_smooth_and_rough() {
    // The light tracer cannot connect through smooth glass, so it is not compared.
    let loaded = open("glass.pbrt");
    let case = Case::new(&loaded, 2304);
    case.check_bdpt(&case.path());
}

#[test]
fn metal_smooth_rough_and_anisotropic() {
    let loaded = open("conductor.pbrt");
    let case = Case::new(&loaded, 2880);
    case.check_bdpt(&case.path());
}

#[test]
fn half_covered_lens() {
    let loaded = open("lens.pbrt");
    // Splats from close to the lens are few and bright: the light tracer needs so many samples that it
    // belongs to the long statistics.
    let case = Case::new(&loaded, 2560);
    case.check_bdpt(&case.path());
}

#[test]
fn parallel_rays() {
    let loaded = open("parallel.pbrt");
    let case = Case::new(&loaded, 1152);
    case.check_bdpt(&case.path());
    // Only camera rays can see the sky, so the light tracer is compared on the ground below it.
    let ground = open_part("parallel.pbrt", Some(Crop::Fractions([0.0, 1.0, 0.5, 1.0])));
    let case = Case::new(&ground, 9216);
    case.check_light(&case.path());
}

#[test]
fn pictures_of_all_directions() {
    for name in ["around-longitude.pbrt", "around-octahedron.pbrt"] {
        Case::new(&open(name), 768).check_all();
    }
}

#[test]
fn shading_normals_that_disagree_with_the_geometry() {
    let loaded = open("shading-normal.pbrt");
    let case = Case::new(&loaded, 576);
    let reference = case.path();
    case.check_bdpt(&reference);
    case.with_effort(8).check_light(&reference);
}

#[test]
fn mirrored_transforms_and_two_sided_lights() {
    Case::new(&open("mirror.pbrt"), 384).check_all();
}

#[test]
fn point_spot_distant_and_infinite_lights() {
    let loaded = open("lights.pbrt");
    let case = Case::new(&loaded, 768);
    let reference = case.path();
    case.check_bdpt(&reference);
    case.with_effort(4).check_light(&reference);
}

#[test]
fn lamps_chosen_by_a_tree_and_by_power() {
    let loaded = open("lamps.pbrt");
    let case = Case::new(&loaded, 960);
    let reference = case
        .with_effort(4)
        .render(IntegratorKind::Path, |settings| {
            settings.path.light_choice = LightChoiceKind::Power;
        });
    check_agree("path, tree", &case.path(), &reference, PIXELS);
    case.check_bdpt(&reference);
    case.with_effort(2).check_light(&reference);
    // Weights contain the tree's densities, but shared points do not come from it.
    let shared = case.bdpt(|settings| settings.path.light_point = LightPointChoice::Shared);
    check_agree("bdpt, shared", &shared, &reference, PIXELS);
}

#[test]
fn a_crop_is_the_same_part_of_the_whole() {
    let loaded = open("crop.pbrt");
    let case = Case::new(&loaded, 1536);
    let reference = case.path();
    case.check_bdpt(&reference);
    // Few light paths end in the crop.
    case.with_effort(10).check_light(&reference);
}

#[test]
fn filters_with_and_without_negative_lobes() {
    check_filter("triangle", 512, 2);
    check_filter("mitchell", 512, 2);
}

/// Compares estimators with a filter, by pixels, as lobes blur edges but keep means of blocks.
///
/// The path tracer takes `effort` times the passes: it rarely hits the lamp, and wide lobes raise the
/// variance.
#[track_caller]
fn check_filter(name: &str, passes: u64, effort: u64) {
    let loaded = open(&format!("filter-{name}.pbrt"));
    let case = Case::new(&loaded, passes);
    let reference = case.bdpt(|_| ());
    case.check_light(&reference);
    let case = case.with_effort(2 * effort);
    // Roulette treats walks whose film position has a negative weight like others.
    for roulette in [
        PathRoulette::default(),
        PathRoulette::Throughput { start: 0 },
    ] {
        let path = case.render(IntegratorKind::Path, |settings| {
            settings.path.roulette = roulette;
        });
        check_agree(&format!("{name}, {roulette}"), &path, &reference, PIXELS);
    }
}

/// The same paths, drawn with the same random numbers, carry the same light at any scale.
#[test]
fn any_scale_of_the_world() {
    let integrators = [
        IntegratorKind::Path,
        IntegratorKind::Bdpt,
        IntegratorKind::Light,
    ];
    let render = |name: &str| {
        let loaded = open(name);
        let case = Case::new(&loaded, 96);
        integrators.map(|integrator| case.render(integrator, |_| ()))
    };
    Case::new(&open("scale-unit.pbrt"), 384).check_all();
    let unit = render("scale-unit.pbrt");
    for name in ["scale-tiny.pbrt", "scale-huge.pbrt"] {
        for (i, scaled) in render(name).iter().enumerate() {
            let name = format!("{name}, {:?}", integrators[i]);
            check_paired(&name, scaled, &unit[i], PIXELS);
        }
    }
}

#[test]
fn surfaces_that_almost_touch() {
    Case::new(&open("touching.pbrt"), 640).check_all();
}

/// All shadow rays under each heuristic agree with path tracing, and every choice among them, which has the
/// same subpaths, agrees with all of them.
#[test]
fn every_choice_of_shadow_rays_under_every_heuristic() {
    let case = RED_LIGHT.case();
    case.with_effort(4).check_light(&RED_LIGHT.reference);
    for (mis_name, mis) in MisHeuristic::NAMES {
        let render = |case: Case<'_>, rule: &str| {
            case.bdpt(|settings| {
                settings.path.mis = mis;
                settings.shadow_rays = rule.parse().expect("a rule");
            })
        };
        let part = case.with_part(2);
        let all = render(part, "all");
        let (effort, blocks) = match mis {
            MisHeuristic::Balance | MisHeuristic::Power => (1, PIXELS),
            MisHeuristic::Uniform => (4, QUARTERS),
        };
        let more = render(case.with_effort(effort), "all");
        check_agree(mis_name, &more, &RED_LIGHT.reference, blocks);
        for rule in [
            "per-light-vertex",
            "per-camera-vertex",
            "per-pair",
            "ray-roulette",
            "budget:2",
        ] {
            let name = format!("{rule}, {mis_name}");
            check_paired(&name, &render(part, rule), &all, QUARTERS);
        }
    }
}

/// Takes several light points for each camera vertex: for the first vertex as many as for later ones, or
/// more.
#[test]
fn several_light_points_for_each_camera_vertex() {
    let separated = World::new("separated", 128, 4);
    for (name, world, effort) in [
        ("red-light-blue-surfaces", &*RED_LIGHT, 1),
        ("separated", &separated, 2),
    ] {
        for (first, deeper) in [(4, 1), (2, 4)] {
            let result = world
                .case()
                .with_effort(effort)
                .render(IntegratorKind::Lvc, |settings| {
                    settings.lvc.next_events = CandidateCount::new(first, deeper);
                });
            let name = format!("{name}, {first} and {deeper} light points");
            check_agree(&name, &result, &world.reference, QUARTERS);
        }
    }
}

/// In scenes with many lamps and with all kinds of lights, the trained distribution differs much from power.
#[test]
fn light_subpaths_with_a_trained_light_start() {
    for (name, passes, effort) in [("lamps", 960, 2), ("lights", 768, 1)] {
        let loaded = open(&format!("{name}.pbrt"));
        let case = Case::new(&loaded, passes);
        let reference = case.with_effort(effort).path();
        for (kind, emission) in LightStart::NAMES {
            let result = case.render(IntegratorKind::Lvc, |settings| {
                settings.lvc.light_start = emission;
            });
            // A pixel that sees only the sky gets so few splats that its mean is skewed.
            let name = format!("{name}, emission {kind}");
            check_agree(&name, &result, &reference, QUARTERS);
        }
    }
}

/// Traces two of many candidates.
#[track_caller]
fn check_few_rays(name: &str, world: &World, effort: u64) {
    let case = world.case().with_effort(effort);
    let result = case.render(IntegratorKind::Lvc, |settings| {
        settings.shadow_rays = ShadowRays::Budget(2);
        settings.lvc.candidates = CandidateCount::of(8);
    });
    check_agree(name, &result, &world.reference, QUARTERS);
}

#[test]
fn two_rays_for_many_candidates() {
    check_few_rays("red-light-blue-surfaces", &RED_LIGHT, 2);
}

#[test]
fn shared_light_points_and_missing_strategies() {
    let (case, reference) = (RED_LIGHT.case(), &RED_LIGHT.reference);
    let shared = case.bdpt(|settings| settings.path.light_point = LightPointChoice::Shared);
    check_agree("shared", &shared, reference, PIXELS);
    // Each of these lists can still make every path of the scene.
    let lists = [
        ("all,-s0", 1, PIXELS),
        ("all,-s1", 4, QUARTERS),
        ("all,-s2", 1, PIXELS),
        ("all,-t1", 1, PIXELS),
        ("s0,s1", 1, PIXELS),
    ];
    for (list, effort, blocks) in lists {
        check_strategies(list, effort, blocks);
    }
}

/// Compares a list of strategies with path tracing, with `effort` times the passes.
#[track_caller]
fn check_strategies(list: &str, effort: u64, blocks: &[usize]) {
    let result = RED_LIGHT.case().with_effort(effort).bdpt(|settings| {
        settings.path.strategies = list.parse().expect("a list of strategies");
    });
    check_agree(list, &result, &RED_LIGHT.reference, blocks);
}

/// Comparisons that need many samples.
mod long_statistics {
    use super::case::{Case, open};
    use super::{QUARTERS, World, check_agree, check_few_rays, check_filter, check_strategies};

    #[test]
    #[ignore = "long statistics: .ci/run statistics"]
    fn light_tracing_to_a_half_covered_lens() {
        let loaded = open("lens.pbrt");
        let case = Case::new(&loaded, 3072);
        let reference = case.with_effort(2).path();
        case.with_effort(12).check_light(&reference);
    }

    #[test]
    #[ignore = "long statistics: .ci/run statistics"]
    fn single_strategies_at_fixed_length() {
        let loaded = open("separated.pbrt");
        let case = Case::new(&loaded, 1024);
        let single = |s: usize, length: usize, effort: u64| {
            let only = format!("s{s}t{}", length - s);
            case.with_effort(effort).bdpt(|settings| {
                settings.path.strategies = only.parse().expect("a strategy");
                settings.path.max_depth = Some(length as u32 - 2);
            })
        };
        // Few light subpaths reach the view of the lens, and few camera subpaths the lamp: hits after two
        // bounces are too rare to compare.
        for (length, effort, others) in [(3, 1, [(0, 8), (2, 6)]), (4, 24, [(2, 12), (3, 24)])] {
            let next_event = single(1, length, effort);
            for (s, effort) in others {
                let name = format!("s{s}t{} against s1", length - s);
                check_agree(&name, &single(s, length, effort), &next_event, QUARTERS);
            }
        }
    }

    #[test]
    #[ignore = "long statistics: .ci/run statistics"]
    fn two_rays_for_many_candidates() {
        check_few_rays("bulb", &World::new("bulb", 256, 6), 3);
    }

    #[test]
    #[ignore = "long statistics: .ci/run statistics"]
    fn strategies_without_next_event_estimation_and_light_images() {
        check_strategies("all,-s1,-t1", 20, QUARTERS);
    }

    #[test]
    #[ignore = "long statistics: .ci/run statistics"]
    fn filters_of_wide_lobes() {
        check_filter("gaussian", 512, 2);
        check_filter("sinc", 4096, 4);
    }
}

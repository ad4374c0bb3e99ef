//! All estimators agree with the path tracer on the torture scenes, each of which is after one way
//! to be wrong. The scenes are the project's own, in `scenes/torture`.
//!
//! Here are those that need comparisons of their own; `matrix` has every integrator with every choice
//! of shadow rays on all scenes; `plans` has what `auto` takes.

mod case;
mod matrix;
mod plans;

#[path = "../../../bidir/tests/common/statistics/mod.rs"]
mod statistics;

use bidir::integrator::{CandidateCount, Candidates, EmissionKind, IntegratorKind};
use bidir::path::{LightChoiceKind, LightPointChoice, MisCount, MisHeuristic, PathRoulette};
use bidir::select::ShadowRays;
use bidir_formats::pbrt::Crop;
use case::{Case, PIXELS, QUARTERS, open, open_part};
use statistics::check_agree;

#[test]
fn glass_smooth_and_rough() {
    // The light tracer cannot see through smooth glass, and so is not asked.
    let loaded = open("glass.pbrt");
    let case = Case::new(&loaded, 4608);
    case.check_bdpt(&case.path());
}

#[test]
fn metal_smooth_rough_and_anisotropic() {
    let loaded = open("conductor.pbrt");
    let case = Case::new(&loaded, 4608);
    case.check_bdpt(&case.path());
}

#[test]
fn half_covered_lens() {
    let loaded = open("lens.pbrt");
    let case = Case::new(&loaded, 3072);
    let reference = case.with_effort(2).path();
    case.check_bdpt(&reference);
    // Splats from what is close to the lens are few and bright.
    case.with_effort(12).check_light(&reference);
}

#[test]
fn parallel_rays() {
    let loaded = open("parallel.pbrt");
    let case = Case::new(&loaded, 2304);
    case.check_bdpt(&case.path());
    // Nothing but the camera's own rays can see the sky: below it is the ground.
    let ground = open_part("parallel.pbrt", Some(Crop::Fractions([0.0, 1.0, 0.5, 1.0])));
    let case = Case::new(&ground, 9216);
    case.check_light(&case.path());
}

#[test]
fn pictures_of_all_directions() {
    for name in ["around-longitude.pbrt", "around-octahedron.pbrt"] {
        Case::new(&open(name), 2304).check_all();
    }
}

#[test]
fn shading_normals_that_disagree_with_the_geometry() {
    Case::new(&open("shading-normal.pbrt"), 2304).check_all();
}

#[test]
fn mirrored_transforms_and_two_sided_lights() {
    Case::new(&open("mirror.pbrt"), 1536).check_all();
}

#[test]
fn point_spot_distant_and_infinite_lights() {
    Case::new(&open("lights.pbrt"), 9216).check_all();
}

#[test]
fn lamps_chosen_by_a_tree_and_by_power() {
    let loaded = open("lamps.pbrt");
    let case = Case::new(&loaded, 2304);
    let reference = case
        .with_effort(4)
        .render(IntegratorKind::Path, |settings| {
            settings.path.light_choice = LightChoiceKind::Power;
        });
    check_agree("path, tree", &case.path(), &reference, PIXELS);
    case.check_bdpt(&reference);
    case.with_effort(2).check_light(&reference);
    // Weights that know the tree's densities, and points that do not come from it.
    let shared = case.bdpt(|settings| settings.path.light_point = LightPointChoice::Shared);
    check_agree("bdpt, shared", &shared, &reference, PIXELS);
}

#[test]
fn a_crop_is_the_same_part_of_the_whole() {
    let loaded = open("crop.pbrt");
    let case = Case::new(&loaded, 9216);
    let reference = case.path();
    case.check_bdpt(&reference);
    // Few light paths end in the crop.
    case.with_effort(2).check_light(&reference);
}

#[test]
fn filters_with_and_without_negative_lobes() {
    // The path tracer meets the lamp rarely, and the wider the lobes the more that varies.
    for (name, effort) in [
        ("triangle", 3),
        ("gaussian", 3),
        ("mitchell", 4),
        ("sinc", 24),
    ] {
        let loaded = open(&format!("filter-{name}.pbrt"));
        let case = Case::new(&loaded, 1024);
        let reference = case.with_effort(effort).path();
        case.with_effort(2).check_bdpt(&reference);
        case.with_effort(2).check_light(&reference);
        // Walks whose film position has a negative weight survive as others do.
        let throughput = case
            .with_effort(effort)
            .render(IntegratorKind::Path, |settings| {
                settings.path.roulette = PathRoulette::Throughput { start: 0 };
            });
        check_agree("throughput", &throughput, &reference, PIXELS);
    }
}

#[test]
fn any_scale_of_the_world() {
    let unit = Case::new(&open("scale-unit.pbrt"), 768).check_all();
    for name in ["scale-tiny.pbrt", "scale-huge.pbrt"] {
        let scaled = Case::new(&open(name), 768).check_all();
        check_agree(name, &scaled, &unit, PIXELS);
    }
}

#[test]
fn surfaces_that_almost_touch() {
    Case::new(&open("touching.pbrt"), 1024).check_all();
}

#[test]
fn every_choice_of_shadow_rays_under_every_heuristic() {
    // Red light on bluish surfaces: a biased colour would show.
    let loaded = open("red-light-blue-surfaces.pbrt");
    let case = Case::new(&loaded, 768);
    let reference = case.with_effort(4).path();
    case.with_effort(2).check_bdpt(&reference);
    case.with_effort(2).check_light(&reference);
    for (mis_name, mis) in MisHeuristic::NAMES {
        for rule in [
            "per-light-vertex",
            "per-camera-vertex",
            "per-pair",
            "ray-roulette",
            "budget:2",
        ] {
            let (effort, blocks) = match mis {
                MisHeuristic::Balance => (1, PIXELS),
                MisHeuristic::Power => (1, QUARTERS),
                MisHeuristic::Uniform => (2, QUARTERS),
            };
            let result = case.with_effort(effort).bdpt(|settings| {
                settings.path.mis = mis;
                settings.shadow_rays = rule.parse().expect("a rule");
            });
            check_agree(&format!("{rule}, {mis_name}"), &result, &reference, blocks);
        }
    }
}

/// Several light points for each camera vertex, as many for the first as for those behind it or more.
#[test]
fn several_light_points_for_each_camera_vertex() {
    for (name, passes, efforts) in [
        ("red-light-blue-surfaces", 768, [4, 1]),
        ("separated", 512, [4, 2]),
    ] {
        let loaded = open(&format!("{name}.pbrt"));
        let case = Case::new(&loaded, passes);
        let [path, lvc] = efforts.map(|effort| case.with_effort(effort));
        let reference = path.path();
        for (first, deeper) in [(3, 1), (2, 4)] {
            let result = lvc.render(IntegratorKind::Lvc, |settings| {
                settings.lvc.next_events = CandidateCount::new(first, deeper);
            });
            let name = format!("{name}, {first} and {deeper} light points");
            check_agree(&name, &result, &reference, QUARTERS);
        }
    }
}

/// Lamps of many places, and lights of every kind: what is learnt of them is far from their power.
#[test]
fn light_subpaths_that_begin_where_they_reach_what_is_seen() {
    for (name, passes, effort) in [("lamps", 1536, 4), ("lights", 4608, 1)] {
        let loaded = open(&format!("{name}.pbrt"));
        let case = Case::new(&loaded, passes);
        let reference = case.with_effort(effort).path();
        for (kind, emission) in EmissionKind::NAMES {
            let result = case.render(IntegratorKind::Lvc, |settings| {
                settings.lvc.emission = emission;
            });
            let name = format!("{name}, emission {kind}");
            check_agree(&name, &result, &reference, PIXELS);
        }
    }
}

/// Two of many candidates are traced: what counts as a sample depends on how weights count.
#[test]
fn weights_that_count_samples_in_other_ways() {
    for (name, passes, efforts) in [
        ("red-light-blue-surfaces", 768, [4, 1]),
        ("bulb", 1024, [4, 2]),
    ] {
        let loaded = open(&format!("{name}.pbrt"));
        let case = Case::new(&loaded, passes);
        let [path, lvc] = efforts.map(|effort| case.with_effort(effort));
        let reference = path.path();
        for (count_name, mis_count) in MisCount::NAMES {
            let result = lvc.render(IntegratorKind::Lvc, |settings| {
                settings.shadow_rays = ShadowRays::Budget(2);
                settings.lvc.candidates = Candidates::Of(CandidateCount::of(8));
                settings.lvc.mis_count = mis_count;
            });
            check_agree(
                &format!("{name}, {count_name}"),
                &result,
                &reference,
                QUARTERS,
            );
        }
    }
}

#[test]
fn shared_light_points_and_missing_strategies() {
    let loaded = open("red-light-blue-surfaces.pbrt");
    let case = Case::new(&loaded, 1024);
    let reference = case.with_effort(4).path();
    let shared = case.bdpt(|settings| settings.path.light_point = LightPointChoice::Shared);
    check_agree("shared", &shared, &reference, PIXELS);
    // Each of these lists can still make every path of the scene.
    let lists = [
        ("all,-s0", 1, PIXELS),
        ("all,-s1", 1, PIXELS),
        ("all,-s2", 1, PIXELS),
        ("all,-t1", 1, PIXELS),
        ("all,-s1,-t1", 3, QUARTERS),
        ("s0,s1", 1, PIXELS),
    ];
    for (list, effort, blocks) in lists {
        let result = case.with_effort(effort).bdpt(|settings| {
            settings.path.strategies = list.parse().expect("a list of strategies");
        });
        check_agree(list, &result, &reference, blocks);
    }
}

#[test]
fn single_strategies_at_fixed_length() {
    let loaded = open("separated.pbrt");
    let case = Case::new(&loaded, 16384);
    let single = |s: usize, length: usize, effort: u64| {
        let only = format!("s{s}t{}", length - s);
        case.with_effort(effort)
            .bdpt(|settings| settings.path.strategies = only.parse().expect("a strategy"))
    };
    // Few light subpaths reach the lens's view, and few walks of the camera the lamp: those that
    // meet it after two bounces are too few to compare.
    for (length, effort, others) in [(3, 1, [(0, 3), (2, 1)]), (4, 3, [(2, 2), (3, 4)])] {
        let next_event = single(1, length, effort);
        for (s, effort) in others {
            let name = format!("s{s}t{} against s1", length - s);
            check_agree(&name, &single(s, length, effort), &next_event, QUARTERS);
        }
    }
}

use super::*;
use crate::driver::training::plan::{BDPT, LVC, MANY, PLANS, path};
use crate::driver::training::trial::Trial;
use crate::driver::training::trial::tests::square;
use crate::path::PathRoulette;

/// The best of the plans, on a film of these blocks.
fn best(blocks: &Blocks, settings: &Settings, tried: &[Tried]) -> Plan {
    let best = Judge::new(blocks, settings, tried).best(None);
    best.expect("they found light")
}

/// Two samples that differ, of so much variance.
fn difference(variance: f64) -> Trial {
    Trial::of(&[[1.0, 1.0 + variance.sqrt()]], &[])
}

/// Path tracing that found next to nothing, and bidirectional path tracing with these light images.
fn chosen(splats: &[[f64; 2]]) -> Plan {
    let tried = [
        (path(0), Trial::of(&[[1.0, 1.1]], &[])),
        (path(1), Trial::of(&[[1.0, 1.1]], &[])),
        (BDPT, Trial::of(&[[0.0, 2.0]], splats)),
    ];
    best(&square(), &Settings::default(), &tried)
}

#[test]
fn walks_that_end_at_once_have_to_be_better() {
    let best_beside = |variance: f64| {
        let tried = [(path(0), difference(variance)), (path(1), difference(1.0))];
        best(&square(), &Settings::default(), &tried)
    };
    assert_eq!([0.9, 0.75].map(best_beside), [path(1), path(0)]);
}

#[test]
fn what_light_images_tell_counts_against_path_tracing() {
    assert_eq!(chosen(&[]), path(1));
    // Light images of what path tracing makes as often do not.
    assert_eq!(chosen(&[[0.1, 0.5]; 8]), path(1));
    assert_eq!(chosen(&[[1.0, 0.999]; 8]), BDPT);
}

#[test]
fn light_images_tell_where_their_weights_count_all_that_path_tracing_takes() {
    let tried = |plan| {
        let silent = Trial::of(&[[1.0, 1.1]], &[]);
        [
            (path(0), silent),
            (plan, Trial::of(&[[0.0, 2.0]], &[[1.0, 0.999]; 8])),
        ]
    };
    let missed = |settings: Settings, plan| {
        let (tried, blocks) = (tried(plan), square());
        let missed = Missed::new(&Scale::new(&blocks, &tried), &settings, &tried);
        missed.missed > 0.0
    };
    let with = |mis| {
        let mut settings = Settings::default();
        settings.path.mis = mis;
        [BDPT, LVC].map(|plan| missed(settings.clone(), plan))
    };
    assert_eq!(with(MisHeuristic::Balance), [true; 2]);
    assert_eq!(with(MisHeuristic::Uniform), [false; 2]);
}

#[test]
fn light_images_tell_nothing_of_roulette_that_no_density_has() {
    let with = |roulette| {
        let mut settings = Settings::default();
        settings.path.roulette = roulette;
        is_told(&settings, &BDPT.keeping(&settings))
    };
    assert!(with(PathRoulette::Albedo { start: 1 }));
    assert!(!with(PathRoulette::Throughput { start: 1 }));
}

/// Path tracing hit the lamp in none of its samples, so that they do not vary.
#[test]
fn a_plan_that_finds_nothing_of_what_is_there_is_not_taken() {
    let everywhere = |value: f64| Trial::of(&[[value, 1.5 * value]; BLOCKS], &[]);
    for (found, expected) in [(0.0, BDPT), (0.01, BDPT), (0.5, path(1))] {
        let tried = [(path(1), everywhere(found)), (BDPT, everywhere(1.0))];
        let plan = best(&square(), &Settings::default(), &tried);
        assert_eq!(plan, expected, "{found}");
    }
}

#[test]
fn one_light_image_alone_tells_nothing() {
    assert_eq!(chosen(&[[3.0, 0.999]; 1]), path(1));
    assert_eq!(chosen(&[[3.0, 0.999]; 2]), BDPT);
}

#[test]
fn what_light_images_tell_is_beside_path_tracing_of_their_roulette() {
    let keeping = |plan: Plan| Plan {
        roulette: PathRoulette::Off,
        ..plan
    };
    let tried = [
        (keeping(path(0)), Trial::of(&[[1.0, 1.1]], &[])),
        (path(1), Trial::of(&[[1.0, 1.1]], &[])),
        (keeping(BDPT), Trial::of(&[[0.0, 2.0]], &[[1.0, 0.999]; 8])),
    ];
    let plan = best(&square(), &Settings::default(), &tried);
    assert_eq!(plan.integrator, IntegratorKind::Bdpt);
}

#[test]
fn of_plans_that_are_as_good_one_without_common_noise_is_taken() {
    let cost = |integrator| Trial::of(&[[0.0; 2]], &[]).cost(integrator);
    let ratio = cost(IntegratorKind::Path) / cost(IntegratorKind::Lvc);
    // With so much of the product of path tracing.
    let best_beside = |product: f64| {
        let difference = (product * ratio).sqrt();
        let tried = [
            (path(1), Trial::of(&[[1.0, 2.0]], &[])),
            (LVC, Trial::of(&[[1.0, 1.0 + difference]], &[])),
        ];
        best(&square(), &Settings::default(), &tried)
    };
    assert_eq!([0.95, 0.85].map(best_beside), [path(1), LVC]);
}

/// Candidates pay where most of the variance is behind the camera rays, and those are points of a sequence.
#[test]
fn what_a_pixel_varies_by_is_the_same_for_all_that_share_light_subpaths() {
    let with_pixel = |behind: f64| {
        let mut trial = Trial::of(&[[0.0, 4.0]], &[]);
        trial.set_behind(0, behind);
        trial
    };
    let mut many = with_pixel(0.5);
    many.stats.rays.camera *= 2;
    for (sampler, expected) in [(SamplerKind::Sobol, MANY), (SamplerKind::Independent, LVC)] {
        let settings = Settings {
            sampler,
            ..Settings::default()
        };
        let tried = [(LVC, with_pixel(2.0)), (MANY, many.clone())];
        let best = Judge::new(&square(), &settings, &tried).best_shared();
        assert_eq!(best, Some(expected));
    }
}

/// One was tried again, and those that share with it stand where they stood.
#[test]
fn the_first_samples_tell_which_of_those_that_share_light_subpaths() {
    for (other, expected) in [(9.0, MANY), (0.1, BDPT)] {
        let tried = [
            (LVC, difference(1.0)),
            (MANY, difference(2.0)),
            (BDPT, difference(other)),
        ];
        let (blocks, settings) = (square(), Settings::default());
        let judge = Judge::new(&blocks, &settings, &tried);
        assert_eq!(judge.best(Some(MANY)), Some(expected));
    }
}

#[test]
fn of_plans_that_found_nothing_none_is_the_best() {
    let judged = |value| {
        let tried = PLANS.map(|plan| (plan, Trial::of(&[[value; 2]], &[])));
        let (blocks, settings) = (square(), Settings::default());
        let judge = Judge::new(&blocks, &settings, &tried);
        (judge.best(None), judge.close().len())
    };
    assert_eq!(judged(0.0), (None, 0));
    // No more samples are asked where one varies by nothing.
    assert_eq!(judged(1.0), (Some(path(0)), 0));
}

/// Of so much variance in the one block.
fn varying(plan: Plan, variance: f64) -> Tried {
    let is_path = plan.integrator == IntegratorKind::Path;
    let cost = if is_path {
        1.0
    } else {
        Trial::of(&[[0.0; 2]], &[]).cost(plan.integrator)
    };
    let difference = (2.0 * variance / cost).sqrt();
    (plan, Trial::of(&[[1.0, 1.0 + difference]], &[]))
}

/// Of plans with light images whichever made a bright one would seem worse.
#[test]
fn one_bright_light_image_decides_nothing() {
    let with = |plan, splats: &[[f64; 2]]| (plan, Trial::of(&[[1.0, 2.0]], splats));
    let best = |splats: &[[f64; 2]]| {
        let tried = [with(BDPT, splats), with(LVC, &[])];
        best(&square(), &Settings::default(), &tried)
    };
    let bright = [30.0, 0.5];
    assert_eq!(best(&[bright]), BDPT);
    assert_eq!(best(&[bright, bright]), LVC);
}

#[test]
fn plans_that_are_near_the_best_are_tried_more() {
    let close = |tried: &[Tried]| Judge::new(&square(), &Settings::default(), tried).close();
    let path_beside_bdpt = |variance| close(&[varying(path(1), variance), varying(BDPT, 1.0)]);
    assert_eq!(path_beside_bdpt(1.4), [BDPT, path(1)]);
    assert_eq!(path_beside_bdpt(1.6), []);
    // Of those that share light subpaths the best alone.
    let shared = [varying(LVC, 1.0), varying(MANY, 1.2)];
    assert_eq!(close(&shared), []);
    let mut all = [shared.as_slice(), &[varying(BDPT, 1.5)]].concat();
    assert_eq!(close(&all), [BDPT, LVC]);
    // Path tracing with all roulettes, where one is near.
    all.extend([varying(path(0), 1.7), varying(path(1), 1.3)]);
    assert_eq!(close(&all), [BDPT, LVC, path(0), path(1)]);
    let paths = [varying(path(0), 0.9), varying(path(1), 0.5)];
    let beside = [paths.as_slice(), &[varying(BDPT, 1.5)]].concat();
    assert_eq!(close(&beside), [path(0), path(1)]);
}

#[test]
fn the_best_is_one_of_those_that_were_tried_more() {
    let mut tried = [1.1, 1.0, 1.3].map(|variance| varying(BDPT, variance));
    (tried[0].0, tried[2].0) = (path(1), path(2));
    for i in [0, 2] {
        let more = tried[i].1.clone();
        tried[i].1.add(more);
    }
    assert_eq!(best(&square(), &Settings::default(), &tried), path(1));
}

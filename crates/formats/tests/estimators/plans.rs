//! What `auto` renders with, in scenes where that is plain: at 80 x 60 the best plan of another
//! estimator takes twice as long.

use crate::case::open;
use bidir::driver::{Resources, Session, Settings};
use bidir::integrator::{CandidateCount, Candidates, IntegratorKind};
use bidir::select::ShadowRays;

#[test]
fn under_a_sky_paths_begin_at_the_camera() {
    check("sky-alone.pbrt", IntegratorKind::Path);
}

#[test]
fn what_few_vertices_make_needs_few_connections() {
    check("filter-triangle.pbrt", IntegratorKind::Bdpt);
}

#[test]
fn where_light_comes_by_bounces_its_subpaths_are_shared() {
    check("narrow-spot.pbrt", IntegratorKind::Lvc);
}

/// Candidates that nobody named are those of the plan, or the estimator's own, and named ones stay.
#[test]
fn candidates_are_those_that_suit_the_estimator() {
    let scene = open("narrow-spot.pbrt").scene;
    for (name, integrator) in IntegratorKind::NAMES {
        let choose = |candidates| {
            let mut settings = Settings::default();
            settings.set_integrator(integrator);
            settings.lvc.candidates = candidates;
            Session::new(&scene, settings, &Resources::default()).expect("the film is small")
        };
        let named = Candidates::Of(CandidateCount::new(5, 2));
        assert_eq!(choose(named).settings().lvc.candidates, named, "{name}");
        let session = choose(Candidates::Suited);
        let plan = session.training().and_then(|training| training.plan);
        let suited = plan.map_or(integrator.candidates(), |plan| {
            Candidates::Of(plan.candidates)
        });
        assert_ne!(suited, Candidates::Suited, "{name}");
        assert_eq!(session.settings().lvc.candidates, suited, "{name}");
    }
}

/// A choice of shadow rays that nobody named is the estimator's, and one that was named stays.
#[test]
fn shadow_rays_are_those_that_suit_the_estimator() {
    let scene = open("narrow-spot.pbrt").scene;
    for (name, integrator) in IntegratorKind::NAMES {
        let choose = |shadow_rays| {
            let settings = Settings {
                integrator,
                shadow_rays,
                ..Settings::default()
            };
            let resources = Resources::default();
            Session::new(&scene, settings, &resources).expect("the film is small")
        };
        assert_eq!(
            choose(ShadowRays::PerPair).settings().shadow_rays,
            ShadowRays::PerPair,
            "{name}"
        );
        let mut session = choose(ShadowRays::Suited);
        let plan = session.training().and_then(|training| training.plan);
        let suited = plan.map_or(integrator.shadow_rays(), |plan| plan.shadow_rays);
        assert_ne!(suited, ShadowRays::Suited, "{name}");
        assert_eq!(session.settings().shadow_rays, suited, "{name}");
        if let ShadowRays::Budget(rays) = suited {
            assert!(session.step(&()), "nobody stops it");
            let stats = session.stats();
            assert!(stats.rays.connection <= u64::from(rays) * stats.samples);
            assert!(
                stats.candidates > stats.rays.connection,
                "{name}: no choice"
            );
        }
    }
}

#[track_caller]
fn check(name: &str, expected: IntegratorKind) {
    let scene = open(name).scene;
    for seed in 0..2 {
        let settings = Settings {
            integrator: IntegratorKind::Auto,
            seed,
            ..Settings::default()
        };
        let session = Session::new(&scene, settings, &Resources::default()).expect("a small film");
        let plan = session.training().and_then(|training| training.plan);
        let plan = plan.expect("auto finds one");
        assert_eq!(plan.integrator, expected, "{name}, seed {seed}: {plan}");
    }
}

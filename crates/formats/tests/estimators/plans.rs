//! What `auto` renders with, in scenes where that is plain: at 80 x 60 the best plan of another
//! estimator takes twice as long.

use crate::case::open;
use bidir::driver::{Resources, Session, Settings};
use bidir::integrator::IntegratorKind;
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
        let suited = session.settings().integrator.shadow_rays();
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

//! The plans that `auto` chooses in clear cases: at 80 x 60, the best plan of another estimator takes twice
//! as long.

use crate::case::open;
use bidir::driver::{Plan, Resources, Session, Settings};
use bidir::integrator::{CandidateCount, IntegratorKind};
use bidir::select::ShadowRays;
use bidir::settings::{Choice, Request};
use bidir_formats::scene::Loaded;

#[test]
fn under_a_sky_paths_begin_at_the_camera() {
    check("sky-alone.pbrt", IntegratorKind::Path);
}

#[test]
fn short_paths_need_few_connections() {
    check("filter-triangle.pbrt", IntegratorKind::Bdpt);
}

#[test]
fn indirect_light_has_shared_subpaths() {
    check("narrow-spot.pbrt", IntegratorKind::Lvc);
}

/// Where light comes through glass, candidates gain little. Between diffuse vertices they gain most, and cost
/// least. The other number has a predicted cost that is 9 % higher or more.
#[test]
fn indirect_light_of_diffuse_walls_has_more_candidates() {
    for (name, candidates) in [
        ("narrow-spot.pbrt", CandidateCount::new(24, 1)),
        ("glass.pbrt", CandidateCount::DEFAULT),
    ] {
        let plan = plan_of(name);
        assert_eq!(plan.candidates, candidates, "{name}: {plan}");
    }
}

/// Light from an image around the scene gains by light points, light through glass does not. The other number has a
/// predicted cost that is 17 % higher or more.
#[test]
fn direct_light_has_more_light_points() {
    for (name, next_events) in [
        ("around-octahedron.pbrt", CandidateCount::new(4, 1)),
        ("glass.pbrt", CandidateCount::NEXT_EVENTS),
    ] {
        let plan = plan_of(name);
        assert_eq!(plan.next_events, next_events, "{name}: {plan}");
    }
}

fn plan_of(name: &str) -> Plan {
    let loaded = open(name);
    let session = session(&loaded, IntegratorKind::Auto, &Request::default());
    let plan = session.training().and_then(|training| training.plan);
    plan.expect("auto finds one")
}

/// Default numbers of candidates and light points are those of the plan or of the estimator, and explicit ones stay.
#[test]
fn default_candidates_depend_on_the_estimator() {
    let loaded = open("narrow-spot.pbrt");
    for (name, integrator) in IntegratorKind::NAMES {
        let choose = |count| {
            let request = Request {
                candidates: count,
                next_events: count,
                ..Request::default()
            };
            session(&loaded, integrator, &request)
        };
        let named = CandidateCount::new(5, 2);
        let session = choose(Some(Choice::Fixed(named)));
        let lvc = session.settings().lvc;
        assert_eq!([lvc.candidates, lvc.next_events], [named; 2], "{name}");
        let session = choose(None);
        let plan = session.training().and_then(|training| training.plan);
        let of_estimator = [CandidateCount::DEFAULT, CandidateCount::NEXT_EVENTS];
        let own = plan.map_or(of_estimator, |plan| [plan.candidates, plan.next_events]);
        let lvc = session.settings().lvc;
        assert_eq!([lvc.candidates, lvc.next_events], own, "{name}");
    }
}

fn session<'a>(loaded: &'a Loaded, integrator: IntegratorKind, request: &Request) -> Session<'a> {
    let settings = request.apply(&Settings::new(integrator));
    Session::new(&loaded.scene, &loaded.view, settings, &Resources::default())
        .expect("the film is small")
}

/// The default choice of shadow rays is that of the estimator, and an explicit one stays.
#[test]
fn the_default_choice_of_shadow_rays_depends_on_the_estimator() {
    let loaded = open("narrow-spot.pbrt");
    for (name, integrator) in IntegratorKind::NAMES {
        let choose = |shadow_rays| {
            let request = Request {
                shadow_rays,
                ..Request::default()
            };
            session(&loaded, integrator, &request)
        };
        assert_eq!(
            choose(Some(Choice::Fixed(ShadowRays::PerPair)))
                .settings()
                .shadow_rays,
            ShadowRays::PerPair,
            "{name}"
        );
        let mut session = choose(Some(Choice::Automatic));
        let plan = session.training().and_then(|training| training.plan);
        let own = plan.map_or(integrator.shadow_rays(), |plan| plan.shadow_rays);
        assert_eq!(session.settings().shadow_rays, own, "{name}");
        if let ShadowRays::Budget(rays) = own {
            assert!(session.step(&()), "no observer stops it");
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
    let loaded = open(name);
    for seed in 0..2 {
        let settings = Settings {
            seed,
            ..Settings::new(IntegratorKind::Auto)
        };
        let session = Session::new(&loaded.scene, &loaded.view, settings, &Resources::default())
            .expect("a small film");
        let plan = session.training().and_then(|training| training.plan);
        let plan = plan.expect("auto finds one");
        assert_eq!(plan.integrator, expected, "{name}, seed {seed}: {plan}");
    }
}

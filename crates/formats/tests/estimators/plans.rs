//! The plans that `auto` chooses in clear cases: at 80 x 60, the best plan of another estimator takes half as long
//! again or more.

use crate::case::open_at;
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

/// Candidates gain most between diffuse vertices, where they cost least, and little through glass. Plans with more than
/// these cost a fifth more or worse.
#[test]
fn candidates_depend_on_the_surfaces() {
    for (name, most) in [("narrow-spot.pbrt", 24), ("glass.pbrt", 12)] {
        let plan = plan_of(name);
        assert!(plan.candidates.get()[0] <= most, "{name}: {plan}");
    }
}

/// Light points gain where an image around the scene lights it, most where several lights do, and little through glass.
/// Plans with numbers beyond these cost a fifth more or worse.
#[test]
fn light_points_depend_on_the_light() {
    for (name, light_points) in [
        ("around-octahedron.pbrt", 4..=8),
        ("lights.pbrt", 8..=8),
        ("glass.pbrt", 2..=2),
    ] {
        let plan = plan_of(name);
        assert!(
            light_points.contains(&plan.next_events.get()[0]),
            "{name}: {plan}"
        );
    }
}

/// A scene with a film whose groups share light subpaths as those of larger ones do.
fn open(name: &str) -> Loaded {
    open_at(name, [80, 60], None)
}

/// The plan of `auto` in this scene.
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

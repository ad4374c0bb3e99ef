use super::*;
use crate::settings::{Choice, Request};

/// Settings of `auto` that name nothing.
fn open() -> Settings {
    Settings::new(IntegratorKind::Auto)
}

#[test]
fn every_plan_is_open_where_nothing_is_named() {
    assert_eq!(open_plans(&open()), PLANS);
    for plan in PLANS {
        let applied = plan.apply(&open());
        assert_eq!(applied.integrator, plan.integrator);
        assert_eq!(plan.keeping(&applied), plan);
    }
}

#[test]
fn what_is_named_stays_and_plans_that_differ_by_it_alone_are_one() {
    let request = Request {
        path_roulette: Some(Choice::Fixed(PathRoulette::Off)),
        shadow_rays: Some(Choice::Fixed(ShadowRays::PerPair)),
        candidates: Some(Choice::Fixed(CandidateCount::of(5))),
        ..Request::default()
    };
    let settings = request.apply(&open());
    let plans = open_plans(&settings);
    // Path tracing, bidirectional path tracing, and three numbers of samples for a light subpath.
    assert_eq!(plans.len(), 5, "{plans:?}");
    for plan in plans {
        let applied = plan.apply(&settings);
        assert_eq!(applied.path.roulette, PathRoulette::Off);
        assert_eq!(applied.shadow_rays, ShadowRays::PerPair);
        assert_eq!(applied.lvc.candidates, settings.lvc.candidates);
    }
}

#[test]
fn a_plan_is_what_the_estimator_does_by_default() {
    let mut settings = Settings::default();
    settings.set_integrator(LVC.integrator);
    assert_eq!(LVC.keeping(&settings), LVC);
    assert_eq!(LVC.roulette, settings.path.roulette);
    assert_eq!(LVC.samples_per_subpath, settings.lvc.samples_per_subpath);
}

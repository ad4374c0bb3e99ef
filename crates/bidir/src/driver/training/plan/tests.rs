use super::*;
use crate::settings::{Choice, Request};

/// Returns the settings of `auto` that name nothing.
fn open() -> Settings {
    Settings::new(IntegratorKind::Auto)
}

#[test]
fn plans_are_applied_where_nothing_is_named() {
    for plan in PLANS {
        assert_eq!(plan.keeping(&open()), plan);
        let applied = plan.apply(&open());
        assert_eq!(applied.integrator, plan.integrator);
        assert_eq!(applied.lvc.candidates, plan.candidates);
        assert_eq!(applied.lvc.next_events, plan.next_events);
        assert_eq!(plan.keeping(&applied), plan);
    }
}

#[test]
fn settings_that_are_named_stay() {
    let request = Request {
        path_roulette: Some(Choice::Fixed(PathRoulette::Off)),
        shadow_rays: Some(Choice::Fixed(ShadowRays::PerPair)),
        candidates: Some(Choice::Fixed(CandidateCount::of(5))),
        next_events: Some(Choice::Fixed(CandidateCount::of(3))),
        ..Request::default()
    };
    let settings = request.apply(&open());
    for plan in PLANS {
        let applied = plan.keeping(&settings).apply(&settings);
        assert_eq!(applied.path.roulette, PathRoulette::Off);
        assert_eq!(applied.shadow_rays, ShadowRays::PerPair);
        assert_eq!(applied.lvc.candidates, settings.lvc.candidates);
        assert_eq!(applied.lvc.next_events, settings.lvc.next_events);
    }
}

#[test]
fn plans_are_what_estimators_do_by_default() {
    for plan in [BDPT, LVC] {
        let settings = Settings::new(plan.integrator);
        assert_eq!(plan.keeping(&settings), plan);
    }
    let settings = Settings::new(LVC.integrator);
    assert_eq!(LVC.samples_per_subpath, settings.lvc.samples_per_subpath);
}

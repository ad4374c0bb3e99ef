//! What `auto` renders with, in scenes where that is plain: at 80 x 60 the best plan of another
//! estimator takes twice as long.

use crate::case::open;
use bidir::driver::{Resources, Session, Settings};
use bidir::integrator::IntegratorKind;

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

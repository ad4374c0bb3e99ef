use super::*;
use crate::film::PixelRect;
use trial::tests::sphere;

/// What `auto` renders a black sphere with.
fn planned(z: f32, radiance: Option<[f32; 3]>) -> IntegratorKind {
    let max = [16; 2];
    let scene = sphere(PixelRect { min: [0; 2], max }, z, radiance);
    let mut settings = Settings::default();
    settings.set_integrator(IntegratorKind::Auto);
    let (plan, training) = Training::plan(&scene, &settings);
    assert_eq!(training.plan, Some(plan));
    plan.integrator
}

#[test]
fn without_lights_and_where_none_is_found_there_is_a_plan() {
    assert_eq!(planned(3.0, Some([2.0; 3])), IntegratorKind::Path);
    assert_eq!(planned(3.0, None), IntegratorKind::Path);
    // Behind the camera: what nothing found yet is found by what makes most paths.
    assert_eq!(planned(-9.0, Some([2.0; 3])), IntegratorKind::Lvc);
}

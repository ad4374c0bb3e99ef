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

/// A thread keeps the subpaths of 2048 samples: of the longest ones there are fewer.
#[test]
fn long_light_subpaths_are_few() {
    let max = [512; 2];
    let scene = sphere(PixelRect { min: [0; 2], max }, 3.0, Some([2.0; 3]));
    let settings = Settings::default();
    let mut training = Training::run(&scene, &settings);
    for (rays, expected) in [(5.0, 2), (128.0, 2), (200.0, 4), (1023.0, 16)] {
        training.subpath_rays = rays;
        let samples = training.samples_per_subpath(&scene, SamplesPerSubpath::default());
        assert_eq!(samples.get(), expected, "{rays}");
        assert!(2048.0 / f64::from(expected) * rays <= MOST_CACHED);
    }
}

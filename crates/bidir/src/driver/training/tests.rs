use super::*;
use crate::driver::{Resources, Session};
use crate::film::PixelRect;
use trial::tests::{sphere, view};

/// What `auto` renders a black sphere with.
fn planned(z: f32, radiance: Option<[f32; 3]>) -> IntegratorKind {
    let view = view(PixelRect {
        min: [0; 2],
        max: [16; 2],
    });
    let scene = sphere(z, radiance);
    let mut settings = Settings::default();
    settings.set_integrator(IntegratorKind::Auto);
    let task = Task {
        scene: &scene,
        view: &view,
        settings: &settings,
        is_late: &|| false,
    };
    let (plan, training) = Training::plan(task).expect("nothing is late");
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
    let view = view(PixelRect {
        min: [0; 2],
        max: [16; 2],
    });
    let scene = sphere(3.0, None);
    let mut training = Training::of(&Survey::short(&scene, &view, &Settings::default()));
    for (rays, expected) in [(5.0, 2), (128.0, 2), (200.0, 4), (1023.0, 16)] {
        training.subpath_rays = rays;
        let samples = training.samples_per_subpath(1 << 20, SamplesPerSubpath::default());
        assert_eq!(samples.get(), expected, "{rays}");
        assert!(2048.0 / f64::from(expected) * rays <= MOST_CACHED);
    }
}

/// A pass of a sphere with some effort, and whether training was cut short.
fn rendered(integrator: IntegratorKind, effort: Effort<'_>) -> (Vec<[u32; 3]>, bool) {
    let view = view(PixelRect {
        min: [0; 2],
        max: [16; 2],
    });
    let scene = sphere(3.0, Some([2.0; 3]));
    let mut settings = Settings::default();
    settings.set_integrator(integrator);
    let session = Session::with_effort(&scene, &view, settings, &Resources::default(), effort);
    let mut session = session.expect("the film is small");
    session.step(&());
    let pixels = session.film().develop().pixels;
    let bits = pixels.iter().map(|pixel| pixel.map(f32::to_bits));
    let training = session.training().expect("there is some");
    (bits.collect(), training.is_short)
}

/// It depends on no clock how far training came.
#[test]
fn late_training_is_as_if_it_had_been_short_from_the_first() {
    for integrator in [IntegratorKind::Lvc, IntegratorKind::Auto] {
        let [short, late, last, whole] = [
            Effort::Short,
            Effort::Until(&|| true),
            Effort::Until(&|| false),
            Effort::Whole,
        ]
        .map(|effort| rendered(integrator, effort));
        assert_eq!(late, short, "{integrator:?}");
        assert_eq!(last, whole, "{integrator:?}");
        assert!(short.1 && !whole.1, "{integrator:?}");
    }
}

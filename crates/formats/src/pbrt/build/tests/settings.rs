use super::{STRICT, load_text};
use crate::pbrt::SceneSettings;
use bidir::integrator::IntegratorKind;
use bidir::math::{Vec2, Vec3};
use bidir::sampler::SamplerKind;

#[test]
fn settings_come_from_the_file_or_the_format() {
    let defaults = load_text("WorldBegin", &STRICT);
    assert_eq!(defaults.view.film().resolution, [1280, 720]);
    assert_eq!(defaults.view.film().filter.radius(), Vec2::splat(1.5));
    let expected = SceneSettings {
        integrator: IntegratorKind::Path,
        max_depth: 5,
        sampler: SamplerKind::Sobol,
        samples_per_pixel: 16,
        seed: None,
        output: None,
        aovs: Vec::new(),
    };
    assert_eq!(defaults.settings, expected);
    let loaded = load_text(
        "Integrator \"bdpt\" \"integer maxdepth\" 7 Sampler \"independent\" \"integer seed\" 3\n\
         Film \"rgb\" \"string filename\" \"a.exr\" \"integer xresolution\" 40 \"integer yresolution\" 30\n\
         \"float iso\" 200 \"float cropwindow\" [0.5 1 0 0.25]\n\
         Camera \"perspective\" \"float shutterclose\" 3 WorldBegin",
        &STRICT,
    );
    let expected = SceneSettings {
        integrator: IntegratorKind::Bdpt,
        max_depth: 7,
        sampler: SamplerKind::Independent,
        samples_per_pixel: 4,
        seed: Some(3),
        output: Some("a.exr".into()),
        aovs: Vec::new(),
    };
    assert_eq!(loaded.settings, expected);
    let film = loaded.view.film();
    assert_eq!((film.crop.min, film.crop.max), ([20, 0], [40, 8]));
    assert!((film.exposure - 6.0).abs() < 1e-6);
}

#[test]
fn the_camera_looks_along_z_and_fov_spans_the_shorter_side() {
    let text = "LookAt 1 2 3 1 2 9 0 1 0 Camera \"perspective\" \"float fov\" 90\n\
        Film \"rgb\" \"integer xresolution\" 200 \"integer yresolution\" 100 WorldBegin";
    let view = load_text(text, &STRICT).view;
    let toward = |x: f32, y: f32| {
        view.camera()
            .sample_ray(Vec2::new(x, y), || Vec2::splat(0.5))
            .direction
    };
    let near = |direction: Vec3, expected: Vec3| direction.distance(expected.normalize()) < 1e-5;
    assert!(near(toward(100.0, 50.0), Vec3::Z));
    // The top of the picture is up, its right is +x of the left-handed camera.
    assert!(near(toward(100.0, 0.0), Vec3::new(0.0, 1.0, 1.0)));
    assert!(near(toward(200.0, 50.0), Vec3::new(2.0, 0.0, 1.0)));
}

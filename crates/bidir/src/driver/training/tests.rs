use super::*;
use crate::camera::{Camera, Perspective, PerspectiveSettings};
use crate::driver::{Resources, Session, SessionError, Stop};
use crate::film::{FilmSettings, Filter, FilterKind, PixelRect};
use crate::integrator::{CandidateCount, SamplesPerSubpath};
use crate::light::EmissionSides;
use crate::material::Material;
use crate::math::{Affine3A, Vec2, Vec3};
use crate::scene::{Emission, SceneBuilder};
use crate::select::ShadowRays;
use crate::shape::{Orientation, Shape, Sphere};
use crate::spectrum::luminance;
use crate::texture::ColorTexture;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

pub(super) const WHOLE: PixelRect = PixelRect {
    min: [0; 2],
    max: [16; 2],
};

/// A camera that looks along z, for a film of 16 x 16 of which a crop is rendered.
pub(super) fn view(crop: PixelRect) -> View {
    view_of(16, crop)
}

/// The same for a square film of `size` x `size`.
pub(super) fn view_of(size: u32, crop: PixelRect) -> View {
    let filter = Filter::new(FilterKind::Triangle, Vec2::splat(1.0));
    let film = FilmSettings {
        crop,
        ..FilmSettings::new([size; 2], filter)
    };
    let camera = Perspective::new(&PerspectiveSettings {
        world_from_camera: Affine3A::IDENTITY,
        resolution: Vec2::splat(size as f32),
        screen: [Vec2::new(-1.0, 1.0), Vec2::new(1.0, -1.0)],
        lens_radius: 0.1,
        focal_distance: 2.0,
    });
    let camera = Camera::Perspective(camera.expect("a rigid camera"));
    View::new(camera, film).expect("the film is not empty")
}

/// The samples of training that nobody stops.
#[track_caller]
pub(super) fn survey_of(task: Task<'_>, effort: Effort<'_>) -> Survey {
    Survey::run(task, effort).expect("nobody stops it")
}

/// A diffuse surface.
pub(super) fn grey(reflectance: f32) -> Material {
    Material::Diffuse {
        reflectance: ColorTexture::Constant([reflectance; 3]),
    }
}

fn add_sphere(
    builder: &mut SceneBuilder,
    [z, radius]: [f32; 2],
    material: Material,
    radiance: Option<[f32; 3]>,
) {
    let material = builder.material(material);
    let place = Affine3A::from_translation(Vec3::new(0.0, 0.0, z));
    let sphere = Shape::Sphere(Sphere::new(place, radius, Orientation::Natural));
    let light = radiance.map(|radiance| Emission {
        radiance,
        pattern: None,
        sides: EmissionSides::Front,
    });
    builder.shape(sphere, material, light);
}

/// A black sphere of this radiance, at this place before the camera.
fn sphere(z: f32, radiance: Option<[f32; 3]>) -> Scene {
    let mut builder = SceneBuilder::new();
    add_sphere(&mut builder, [z, 1.5], grey(0.0), radiance);
    builder.build().expect("the scene is valid")
}

/// A black lamp before nothing.
pub(super) fn lamp() -> Scene {
    sphere(3.0, Some([2.0; 3]))
}

/// A lamp and a grey ball in a grey sphere.
pub(super) fn room() -> Scene {
    room_with(grey(0.4))
}

/// A lamp and a ball of this material in a grey sphere.
pub(super) fn room_with(ball: Material) -> Scene {
    let mut builder = SceneBuilder::new();
    add_sphere(&mut builder, [0.0, 6.0], grey(0.6), None);
    add_sphere(&mut builder, [3.5, 1.0], ball, None);
    add_sphere(&mut builder, [-3.0, 1.0], grey(0.0), Some([5.0; 3]));
    builder.build().expect("the scene is valid")
}

/// The estimator that `auto` takes for a black sphere.
fn planned(z: f32, radiance: Option<[f32; 3]>) -> IntegratorKind {
    let scene = sphere(z, radiance);
    let settings = Settings::new(IntegratorKind::Auto);
    let prepared = prepare(&scene, &view(WHOLE), settings, Effort::WHOLE);
    let (decided, training) = prepared.expect("nobody stops it");
    let plan = training.and_then(|training| training.plan);
    assert_eq!(plan.map(|plan| plan.integrator), Some(decided.integrator));
    decided.integrator
}

#[test]
fn without_lights_and_where_none_is_found_there_is_a_plan() {
    assert_eq!(planned(3.0, Some([2.0; 3])), IntegratorKind::Path);
    assert_eq!(planned(3.0, None), IntegratorKind::Path);
    // Behind the camera: where nothing was found, the plan is the one that makes most paths.
    assert_eq!(planned(-9.0, Some([2.0; 3])), IntegratorKind::Lvc);
}

/// A thread keeps the subpaths of 2048 samples: of the longest ones there are fewer.
#[test]
fn long_light_subpaths_are_few() {
    let scene = sphere(3.0, None);
    let settings = Settings::new(IntegratorKind::Lvc);
    let task = Task {
        scene: &scene,
        view: &view(WHOLE),
        settings: &settings,
    };
    let mut training = Training::new(&survey_of(task, Effort::at_most(16)));
    let film = FilmSettings::new([1024; 2], Filter::default());
    for (rays, expected) in [(5.0, 2), (128.0, 2), (200.0, 4), (1023.0, 16)] {
        training.subpath_rays = rays;
        let mut settings = settings.clone();
        training.bound_cache(&film, &mut settings);
        let samples = settings.lvc.samples_per_subpath.get();
        assert_eq!(samples, expected, "{rays}");
        assert!(2048.0 / f64::from(expected) * rays <= MOST_CACHED);
    }
}

/// A light image is as bright however many samples there are for a light subpath, also more than a group has.
#[test]
fn every_group_has_a_light_subpath() {
    let scene = room();
    let brightness = |exponent| {
        let mut settings = Settings::new(IntegratorKind::Lvc);
        settings.path.strategies = "t1".parse().expect("a strategy");
        settings.lvc.samples_per_subpath = SamplesPerSubpath::power_of_two(exponent);
        let session = Session::new(&scene, &view(WHOLE), settings, &Resources::default());
        let mut session = session.expect("the film is small");
        (0..256).for_each(|_| assert!(session.step(&())));
        let pixels = session.film().develop().pixels;
        pixels.iter().map(|pixel| f64::from(pixel[1])).sum::<f64>()
    };
    let (many, few) = (brightness(0), brightness(8));
    assert!((few / many - 1.0).abs() < 0.2, "{few} instead of {many}");
}

/// A pass of a sphere with some effort, and the samples of training.
fn rendered(integrator: IntegratorKind, effort: Effort<'_>) -> (Vec<[u32; 3]>, u64) {
    let settings = Settings::new(integrator);
    let scene = room();
    let session = Session::with_effort(
        &scene,
        &view(WHOLE),
        settings,
        &Resources::default(),
        effort,
    );
    let mut session = session.expect("the film is small");
    session.step(&());
    let pixels = session.film().develop().pixels;
    let bits = pixels.iter().map(|pixel| pixel.map(f32::to_bits));
    let training = session.training().expect("there is some");
    assert_eq!(training.is_short, training.samples < 1 << 12);
    (bits.collect(), training.samples)
}

/// It depends on no clock what training found, once its number of samples is known.
#[test]
fn training_that_ends_late_is_training_with_as_many_samples() {
    let asked = AtomicU64::new(0);
    for integrator in [IntegratorKind::Lvc, IntegratorKind::Auto] {
        for (questions, expected) in [(0, 16), (20, 64), (1 << 20, 1 << 12)] {
            asked.store(0, Ordering::Relaxed);
            let effort = Effort {
                samples: u64::MAX,
                is_late: &|| asked.fetch_add(1, Ordering::Relaxed) >= questions,
                stop: Stop::NEVER,
            };
            let late = rendered(integrator, effort);
            assert_eq!(late.1, expected, "{integrator:?}");
            assert_eq!(late, rendered(integrator, Effort::at_most(expected)));
        }
        let limited = [31, 16, 0].map(|samples| rendered(integrator, Effort::at_most(samples)).1);
        assert_eq!(limited, [16; 3]);
    }
}

/// The variance of the luminance of a pass between passes, of each pixel relative to the square of its mean as plans are
/// judged.
fn rendered_variance(scene: &Scene, settings: &Settings) -> f64 {
    let passes = 400;
    let view = view(WHOLE);
    let mut session = Session::new(scene, &view, settings.clone(), &Resources::default())
        .expect("the film is small");
    let (mut sums, mut squares, mut before) = ([0.0; 256], [0.0; 256], [0.0; 256]);
    for pass in 1..=passes {
        session.step(&());
        let pixels = session.film().develop().pixels;
        for (i, pixel) in pixels.iter().enumerate() {
            let sum = f64::from(luminance(*pixel)) * f64::from(pass);
            let value = sum - before[i];
            before[i] = sum;
            sums[i] += value;
            squares[i] += value * value;
        }
    }
    let count = f64::from(passes);
    let mean = sums.iter().sum::<f64>() / count / 256.0;
    let relative = |i: usize| {
        let of_pixel = sums[i] / count;
        let variance = (squares[i] - count * of_pixel * of_pixel) / (count - 1.0);
        variance / (of_pixel * of_pixel + 0.01 * mean * mean)
    };
    (0..256).map(relative).sum()
}

/// What the survey predicts is what renders have, with no constant that is fitted.
#[test]
fn predicted_variances_are_those_of_renders() {
    let (scene, view) = (room(), view(WHOLE));
    let auto = Settings::new(IntegratorKind::Auto);
    let task = Task {
        scene: &scene,
        view: &view,
        settings: &auto,
    };
    let survey = survey_of(task, Effort::WHOLE);
    let terms = survey.relative_terms(view.film()).expect("a lamp");
    let judge = known::Judge::new(task, &survey, &survey.found.cells());
    for (integrator, candidates, light_points, rays) in [
        (IntegratorKind::Path, 1, 1, ShadowRays::All),
        (IntegratorKind::Bdpt, 1, 1, ShadowRays::All),
        (IntegratorKind::Lvc, 12, 2, ShadowRays::Budget(6)),
        (IntegratorKind::Lvc, 24, 2, ShadowRays::Budget(3)),
        (IntegratorKind::Lvc, 24, 8, ShadowRays::All),
    ] {
        let mut settings = Settings::new(integrator);
        settings.path.roulette = auto.path.roulette;
        settings.lvc.candidates = CandidateCount::new(candidates, 1);
        settings.lvc.next_events = CandidateCount::new(light_points, 1);
        settings.shadow_rays = rays;
        let predicted = judge.judge(&settings, &terms).variance(rays).pixels;
        let ratio = predicted / rendered_variance(&scene, &settings);
        let name = format!("{integrator:?}, {candidates}, {light_points}, {rays}");
        // Groups of 64 samples have 32 light subpaths: what those have in common is the least certain.
        let expected = match integrator {
            IntegratorKind::Lvc => 0.75..1.33,
            _ => 0.85..1.18,
        };
        assert!(expected.contains(&ratio), "{name}: {ratio}");
    }
}

/// Whether a host asks before training or while it runs, there is no session.
#[test]
fn training_that_is_stopped_makes_no_session() {
    let scene = room();
    for questions in [0, 70] {
        let (asked, flag) = (AtomicU64::new(0), AtomicBool::new(questions == 0));
        let effort = Effort {
            samples: u64::MAX,
            is_late: &|| {
                let is_due = asked.fetch_add(1, Ordering::Relaxed) >= questions;
                flag.fetch_or(is_due, Ordering::Relaxed);
                false
            },
            stop: Stop::when(&flag),
        };
        let settings = Settings::new(IntegratorKind::Lvc);
        let resources = Resources::default();
        let session = Session::with_effort(&scene, &view(WHOLE), settings, &resources, effort);
        assert!(matches!(session, Err(SessionError::Stopped)));
    }
}

use super::plan::{BDPT, LVC, PATH, PLANS, SHORT_PATH, lvc_of};
use super::*;
use crate::driver::{Resources, Session, SessionError, Stop};
use crate::film::{FilmSettings, Filter, FilterKind, PixelRect};
use crate::integrator::SamplesPerSubpath;
use crate::material::Material;
use crate::sampler::SamplerKind;
use crate::scene::SceneBuilder;
use crate::select::ShadowRays;
use crate::spectrum::{Rgb, luminance};
use crate::testing::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

pub(super) const WHOLE: PixelRect = PixelRect {
    min: [0; 2],
    max: [16; 2],
};

/// Returns a camera that looks along z, for a film of 16 x 16 of which a crop is rendered.
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
    let camera = camera_with(Vec3::ZERO, size, 1.0, [0.1, 2.0]);
    View::new(camera, film).expect("the film is not empty")
}

/// Returns a film whose blocks have 64 samples of a survey each.
pub(super) fn large_view() -> View {
    let whole = PixelRect {
        min: [0; 2],
        max: [64; 2],
    };
    view_of(64, whole)
}

pub(super) fn input<'a>(
    scene: &'a Scene,
    view: &'a View,
    settings: &'a Settings,
) -> TrainingInput<'a> {
    TrainingInput {
        scene,
        view,
        settings,
    }
}

/// Returns the samples of training that nobody stops.
#[track_caller]
pub(super) fn survey_of(input: TrainingInput<'_>, effort: Effort<'_>) -> Survey {
    Survey::run(input, effort).expect("nobody stops it")
}

/// Returns a diffuse surface.
pub(super) fn grey(reflectance: f32) -> Material {
    diffuse([reflectance; 3])
}

fn add_sphere(
    builder: &mut SceneBuilder,
    [z, radius]: [f32; 2],
    material: Material,
    radiance: Option<Rgb>,
) {
    let material = builder.material(material);
    builder.shape(
        sphere(Vec3::Z * z, radius),
        material,
        radiance.and_then(emission),
    );
}

/// Returns a black sphere of this radiance, at this place before the camera.
fn black_sphere(z: f32, radiance: Option<Rgb>) -> Scene {
    let mut builder = SceneBuilder::new();
    add_sphere(&mut builder, [z, 1.5], grey(0.0), radiance);
    builder.build().expect("the scene is valid")
}

/// Returns a black lamp before nothing.
pub(super) fn lamp() -> Scene {
    black_sphere(3.0, Some([2.0; 3]))
}

/// Returns a lamp and a grey ball in a grey sphere.
pub(super) fn room() -> Scene {
    room_with(grey(0.4))
}

/// Returns a lamp and a ball of this material in a grey sphere.
pub(super) fn room_with(ball: Material) -> Scene {
    let mut builder = SceneBuilder::new();
    add_sphere(&mut builder, [0.0, 6.0], grey(0.6), None);
    add_sphere(&mut builder, [3.5, 1.0], ball, None);
    add_sphere(&mut builder, [-3.0, 1.0], grey(0.0), Some([5.0; 3]));
    builder.build().expect("the scene is valid")
}

/// Returns the estimator that `auto` takes for a black sphere.
fn planned(z: f32, radiance: Option<[f32; 3]>) -> IntegratorKind {
    let scene = black_sphere(z, radiance);
    let settings = Settings::new(IntegratorKind::Auto);
    let prepared = prepare(&scene, &view(WHOLE), settings, Effort::WHOLE);
    let (decided, training) = prepared.expect("nobody stops it");
    let plan = training.and_then(|training| training.plan);
    assert_eq!(plan.map(|plan| plan.integrator), Some(decided.integrator));
    decided.integrator
}

#[test]
fn without_lights_and_where_none_is_found_there_is_a_plan() {
    assert_eq!(planned(3.0, None), IntegratorKind::Path);
    // Behind the camera: where nothing was found, the plan is the one that makes most paths.
    assert_eq!(planned(-9.0, Some([2.0; 3])), IntegratorKind::Lvc);
}

/// By another survey than that which chose it, a plan costs about as little as the best one.
#[test]
fn no_plan_is_much_better_than_the_one_that_is_chosen() {
    let view = large_view();
    for (name, ball) in [("grey", grey(0.4)), ("metal", metal(0.3))] {
        let scene = room_with(ball);
        let [chosen, other] = [0, 1].map(|seed| {
            let mut settings = independent();
            settings.seed = seed;
            settings
        });
        let prepared = prepare(&scene, &view, chosen, Effort::WHOLE).expect("nobody stops it");
        let plan = prepared
            .1
            .and_then(|training| training.plan)
            .expect("it is open");
        let input = input(&scene, &view, &other);
        let survey = survey_of(input, Effort::WHOLE);
        let terms = survey.relative_terms(view.film()).expect("a lamp");
        let cells = survey.log.cells();
        let judge = known::Judge::new(input, &plan::typical(&other), &survey, &cells);
        let product = |plan: Plan| {
            let settings = plan.apply(&other);
            let variance = judge.judge(&settings, &terms).variance(plan.shadow_rays);
            variance.mean() * survey.cost(&settings, &judge.counts(&settings))
        };
        let least = PLANS.map(product).into_iter().fold(f64::INFINITY, f64::min);
        let ratio = product(plan) / least;
        assert!(ratio < 1.2, "{name}: {plan} costs {ratio} times the best");
    }
}

/// A thread keeps the subpaths of 2048 samples: of the longest ones there are fewer.
#[test]
fn long_light_subpaths_are_few() {
    let scene = black_sphere(3.0, None);
    let settings = Settings::new(IntegratorKind::Lvc);
    let view = view(WHOLE);
    let survey = survey_of(input(&scene, &view, &settings), Effort::at_most(16));
    let mut training = Training::new(&survey);
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
        steps(&mut session, 256);
        let pixels = session.film().develop().pixels;
        pixels.iter().map(|pixel| f64::from(pixel[1])).sum::<f64>()
    };
    let (many, few) = (brightness(0), brightness(8));
    assert!((few / many - 1.0).abs() < 0.2, "{few} instead of {many}");
}

/// Returns a pass of a sphere with some effort, and the samples of training.
fn rendered(integrator: IntegratorKind, effort: Effort<'_>) -> (Vec<[u32; 3]>, u64) {
    let settings = Settings::new(integrator);
    let scene = room();
    let (view, resources) = (view(WHOLE), Resources::default());
    let session = Session::with_effort(&scene, &view, settings, &resources, effort);
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

/// Returns the relative variance of luminance between passes as plans are judged: the sum over 16 x 16 blocks of the
/// means of their pixels.
fn rendered_variance(scene: &Scene, view: &View, settings: &Settings) -> f64 {
    let passes = 32;
    let [width, height] = view.film().resolution.map(|n| n as usize);
    let area = width * height;
    let session = Session::new(scene, view, settings.clone(), &Resources::default());
    let mut session = session.expect("the film is small");
    let [mut sums, mut squares, mut before] = [(); 3].map(|()| vec![0.0; area]);
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
    let (count, area) = (f64::from(passes), area as f64);
    let mean = sums.iter().sum::<f64>() / count / area;
    let relative = |(sum, square): (&f64, &f64)| {
        let of_pixel = sum / count;
        let variance = (square - count * of_pixel * of_pixel) / (count - 1.0);
        variance / (of_pixel * of_pixel + 0.01 * mean * mean)
    };
    sums.iter().zip(&squares).map(relative).sum::<f64>() * 256.0 / area
}

/// Returns settings of `auto` with the independent sampler; with the default one the light images of a pass have less noise.
fn independent() -> Settings {
    let mut settings = Settings::new(IntegratorKind::Auto);
    settings.sampler = SamplerKind::Independent;
    settings
}

/// Returns the mean over surveys of what they predict for `plans`.
fn predicted_variances<const N: usize>(scene: &Scene, view: &View, plans: [Plan; N]) -> [f64; N] {
    let surveys = 4;
    let mut auto = independent();
    let mut sums = [0.0; N];
    for seed in 0..surveys {
        auto.seed = seed;
        let input = input(scene, view, &auto);
        let survey = survey_of(input, Effort::WHOLE);
        let terms = survey.relative_terms(view.film()).expect("a lamp");
        let cells = survey.log.cells();
        let judge = known::Judge::new(input, &plan::typical(&auto), &survey, &cells);
        for (sum, plan) in sums.iter_mut().zip(plans) {
            let judgement = judge.judge(&plan.apply(&auto), &terms);
            *sum += judgement.variance(plan.shadow_rays).pixels / surveys as f64;
        }
    }
    sums
}

/// Surveys predict the variance of renders, without a fitted constant.
#[test]
fn predicted_variances_are_those_of_renders() {
    let (scene, view) = (room(), large_view());
    let all_rays = Plan {
        shadow_rays: ShadowRays::All,
        ..lvc_of(24, 8, 1)
    };
    let plans = [PATH, SHORT_PATH, BDPT, LVC, lvc_of(24, 2, 3), all_rays];
    let predicted = predicted_variances(&scene, &view, plans);
    for (plan, predicted) in plans.into_iter().zip(predicted) {
        let settings = plan.apply(&independent());
        let ratio = predicted / rendered_variance(&scene, &view, &settings);
        assert!((0.87..1.15).contains(&ratio), "{plan}: {ratio}");
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

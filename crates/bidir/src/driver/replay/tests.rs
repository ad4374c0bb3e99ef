use super::*;
use crate::camera::{Camera, Perspective, PerspectiveSettings};
use crate::driver::{Resources, Session, Settings};
use crate::film::{FilmSettings, Filter, FilterKind};
use crate::integrator::IntegratorKind;
use crate::light::{EmissionSides, InfiniteLight, Light};
use crate::material::Material;
use crate::math::{Affine3A, Vec2, Vec3};
use crate::scene::{Emission, Scene, SceneBuilder};
use crate::select::ShadowRays;
use crate::shape::{Orientation, Shape, Sphere};
use crate::texture::ColorTexture;
use crate::view::View;

const SIZE: u32 = 6;

/// Two spheres, a third that emits, and a sky, through a filter that reaches over two pixels.
fn view() -> View {
    let filter = Filter::new(FilterKind::Triangle, Vec2::splat(1.0));
    let camera = Perspective::new(&PerspectiveSettings {
        world_from_camera: Affine3A::IDENTITY,
        resolution: Vec2::splat(SIZE as f32),
        screen: [Vec2::new(-0.6, 0.6), Vec2::new(0.6, -0.6)],
        lens_radius: 0.05,
        focal_distance: 3.0,
    });
    let camera = Camera::Perspective(camera.expect("a rigid camera"));
    View::new(camera, FilmSettings::new([SIZE; 2], filter)).expect("the film is not empty")
}

fn scene() -> Scene {
    let mut builder = SceneBuilder::new();
    let red = builder.material(Material::Diffuse {
        reflectance: ColorTexture::Constant([0.8, 0.5, 0.2]),
    });
    let mut sphere = |x: f32, y: f32, radius: f32, emission: Option<Emission>| {
        let place = Affine3A::from_translation(Vec3::new(x, y, 3.0));
        let sphere = Sphere::new(place, radius, Orientation::Natural);
        builder.shape(Shape::Sphere(sphere), red, emission);
    };
    sphere(-0.7, 0.0, 0.8, None);
    sphere(0.7, -0.3, 0.6, None);
    let light = Emission {
        radiance: [5.0, 6.0, 7.0],
        pattern: None,
        sides: EmissionSides::Front,
    };
    sphere(0.6, 0.7, 0.2, Some(light));
    builder.light(Light::Infinite(InfiniteLight::constant([0.3; 3])));
    builder.build().expect("the scene is valid")
}

fn session<'a>(scene: &'a Scene, integrator: IntegratorKind, rule: &str) -> Session<'a> {
    let settings = Settings {
        shadow_rays: rule.parse::<ShadowRays>().expect("a rule"),
        ..Settings::new(integrator)
    };
    let resources = Resources {
        threads: 1,
        ..Resources::default()
    };
    Session::new(scene, &view(), settings, &resources).expect("the film is small")
}

/// Every sample of a pass, with its pixel.
fn pass(session: &Session<'_>, pass: u64) -> Vec<([u32; 2], Replay)> {
    let pixels = (0..SIZE).flat_map(|y| (0..SIZE).map(move |x| [x, y]));
    let replay = |pixel| session.replay(pixel, pass).expect("the pixel is inside");
    pixels.map(|pixel| (pixel, replay(pixel))).collect()
}

#[test]
fn the_terms_of_a_pass_are_its_image() {
    let scene = scene();
    for (name, integrator) in IntegratorKind::NAMES {
        for rule in ["all", "per-pair", "ray-roulette:2", "budget:2"] {
            let mut session = session(&scene, integrator, rule);
            let mut image = [[0.0; 3]; (SIZE * SIZE) as usize];
            for (pixel, replay) in pass(&session, 0) {
                for term in &replay.terms {
                    let landed = term.landing.map_or(Some(pixel), |landing| landing.pixel);
                    let Some([x, y]) = landed else { continue };
                    let sum = &mut image[(y * SIZE + x) as usize];
                    (0..3).for_each(|channel| sum[channel] += term.added[channel]);
                }
            }
            session.step(&());
            let rendered = session.film().develop().pixels;
            for (a, b) in image.iter().flatten().zip(rendered.iter().flatten()) {
                assert!(
                    (a - b).abs() <= 1e-4 * b.max(1.0),
                    "{name}, {rule}: {a} {b}"
                );
            }
        }
    }
}

/// Checks that the parts of a term fit together.
#[track_caller]
fn check_term(replayed: &ReplayedTerm) {
    let value = replayed.term.value();
    assert!(!value.is_black());
    let prob = replayed.selection.map_or(1.0, |selection| selection.prob);
    match replayed.fate {
        Fate::NotTraced => assert!(prob < 1.0 && !replayed.is_chosen()),
        Fate::Blocked => assert!(!replayed.is_visible() && replayed.is_chosen()),
        Fate::Added => assert!(replayed.is_visible() && replayed.is_chosen()),
        Fate::Dropped => panic!("the scene has no value to drop"),
    }
    if replayed.fate != Fate::Added {
        assert!(replayed.added.is_black());
    } else if replayed.landing.is_none() {
        let error = replayed.added * prob as f32 - value;
        assert!(error.map(f32::abs).max_lane() <= 1e-5 * value.max_lane());
    }
}

#[test]
fn every_term_says_what_became_of_it() {
    let scene = scene();
    let mut fates = Vec::new();
    for (_, integrator) in IntegratorKind::NAMES {
        let session = session(&scene, integrator, "ray-roulette:20");
        for (_, replay) in (0..16).flat_map(|index| pass(&session, index)) {
            replay.terms.iter().for_each(check_term);
            fates.extend(replay.terms.iter().map(|term| term.fate));
        }
    }
    for fate in [Fate::NotTraced, Fate::Blocked, Fate::Added] {
        let count = fates.iter().filter(|other| **other == fate).count();
        assert!(count > 10, "{count} are {fate:?}");
    }
}

/// Each sample brings its part of the shared light subpaths, in counters and in its replay.
#[test]
fn the_rays_of_a_pass_are_those_of_its_samples() {
    let scene = scene();
    for (name, integrator) in IntegratorKind::NAMES {
        let mut session = session(&scene, integrator, "all");
        let pass = pass(&session, 0);
        let rays = pass.iter().map(|(_, r)| r.batch.worker.stats.rays.total());
        let rays: u64 = rays.sum();
        session.step(&());
        assert_eq!(rays, session.stats().rays.total(), "{name}");
        let subpaths = pass.iter().filter(|(_, r)| !r.light().vertices.is_empty());
        let expected = match session.settings().integrator {
            IntegratorKind::Path => 0,
            _ => session.light_subpaths(),
        };
        assert_eq!(subpaths.count() as u64, expected, "{name}");
    }
}

#[test]
fn probabilities_of_one_per_pair_sum_to_one() {
    let scene = scene();
    let session = session(&scene, IntegratorKind::Bdpt, "per-pair");
    for (_, replay) in (0..4).flat_map(|index| pass(&session, index)) {
        let selections = replay.terms.iter().filter_map(|term| term.selection);
        let sum: f64 = selections.map(|selection| selection.prob).sum();
        assert!(sum == 0.0 || (sum - 1.0).abs() < 1e-9, "{sum}");
    }
}

#[test]
fn connections_are_candidates_or_zero() {
    let scene = scene();
    let session = session(&scene, IntegratorKind::Bdpt, "all");
    for (_, replay) in pass(&session, 0) {
        let [light, camera] =
            [replay.light(), replay.camera()].map(|subpath| subpath.vertices.len());
        let longest = session.settings().path.max_vertices();
        let pairs = (1..=light).flat_map(|s| (2..=camera).map(move |t| s + t));
        let all = pairs.filter(|n| *n <= longest).count();
        let candidates = replay.batch.candidates.offered.iter();
        let own = candidates.filter(|c| usize::from(c.term.strategy.s) <= light);
        assert_eq!(own.count() + replay.zeros.len(), all);
    }
}

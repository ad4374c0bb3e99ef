use super::*;
use crate::driver::{Session, Settings};
use crate::film::{Filter, FilterKind};
use crate::integrator::IntegratorKind;
use crate::select::ShadowRays;
use crate::testing::prelude::*;

const SIZE: u32 = 6;

/// Two spheres, a third that emits, and a sky, through a filter that reaches over two pixels.
fn shot() -> Shot {
    let filter = Filter::new(FilterKind::Triangle, Vec2::splat(1.0));
    let mut builder = ShotBuilder::with_filter(camera(Vec3::ZERO, SIZE, 0.05), SIZE, filter);
    let red = builder.material(diffuse([0.8, 0.5, 0.2]));
    for (x, y, radius, emission) in [
        (-0.7, 0.0, 0.8, None),
        (0.7, -0.3, 0.6, None),
        (0.6, 0.7, 0.2, emission([5.0, 6.0, 7.0])),
    ] {
        builder.shape(sphere(Vec3::new(x, y, 3.0), radius), red, emission);
    }
    builder.sky([0.3; 3]);
    builder.build()
}

fn session<'a>(shot: &'a Shot, integrator: IntegratorKind, rule: &str) -> Session<'a> {
    let settings = Settings {
        shadow_rays: rule.parse::<ShadowRays>().expect("a rule"),
        ..Settings::new(integrator)
    };
    shot.session(settings, 1)
}

/// Every sample of a pass, with its pixel.
fn pass(session: &Session<'_>, pass: u64) -> Vec<([u32; 2], Replay)> {
    let pixels = (0..SIZE).flat_map(|y| (0..SIZE).map(move |x| [x, y]));
    let replay = |pixel| session.replay(pixel, pass).expect("the pixel is inside");
    pixels.map(|pixel| (pixel, replay(pixel))).collect()
}

#[test]
fn the_terms_of_a_pass_are_its_image() {
    let shot = shot();
    for (name, integrator) in IntegratorKind::NAMES {
        for rule in ["all", "per-pair", "ray-roulette:2", "budget:2"] {
            let mut session = session(&shot, integrator, rule);
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
            for (a, b) in image.as_flattened().iter().zip(rendered.as_flattened()) {
                let bound = 1e-4 * f64::from(b.max(1.0));
                check_near(*a, *b, bound, format!("{name}, {rule}"));
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
    let shot = shot();
    let mut fates = Vec::new();
    for (_, integrator) in IntegratorKind::NAMES {
        let session = session(&shot, integrator, "ray-roulette:20");
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
    let shot = shot();
    for (name, integrator) in IntegratorKind::NAMES {
        let mut session = session(&shot, integrator, "all");
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
    let shot = shot();
    let session = session(&shot, IntegratorKind::Bdpt, "per-pair");
    for (_, replay) in (0..4).flat_map(|index| pass(&session, index)) {
        let selections = replay.terms.iter().filter_map(|term| term.selection);
        let sum: f64 = selections.map(|selection| selection.prob).sum();
        assert!(sum == 0.0 || (sum - 1.0).abs() < 1e-9, "{sum}");
    }
}

#[test]
fn connections_are_candidates_or_zero() {
    let shot = shot();
    let session = session(&shot, IntegratorKind::Bdpt, "all");
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

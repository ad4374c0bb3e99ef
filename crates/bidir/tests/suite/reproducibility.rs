//! The same passes have the same bits, however they are computed.

use crate::common;
use bidir::driver::{Progress, Resources, Session, Settings, Stop, render};
use bidir::film::{Film, MergeError, PassBuffer, PassSet};
use bidir::integrator::IntegratorKind;
use bidir::light::{InfiniteLight, Light};
use bidir::select::ShadowRays;
use bidir::stats::{Stage, StageTimes};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

fn settings(integrator: IntegratorKind, shadow_rays: &str) -> Settings {
    let shadow_rays = shadow_rays.parse::<ShadowRays>().expect("a rule");
    Settings {
        shadow_rays,
        ..Settings::new(integrator)
    }
}

fn with_threads(threads: usize) -> Resources {
    Resources {
        threads,
        ..Resources::default()
    }
}

/// Each integrator by each kind of rule that it can follow.
const RULES: [(IntegratorKind, &[&str]); 5] = [
    (IntegratorKind::Path, &["all"]),
    (IntegratorKind::Light, &["all"]),
    (
        IntegratorKind::Bdpt,
        &["all", "per-pair", "ray-roulette", "budget:2"],
    ),
    (
        IntegratorKind::Lvc,
        &["all", "per-pair", "ray-roulette", "budget:2"],
    ),
    (IntegratorKind::Auto, &["all", "budget:2"]),
];

/// On a film that is large enough for every thread to have a part of it.
#[test]
fn threads_do_not_change_a_bit() {
    let scene = common::room_of(28, 0.1);
    for (integrator, rules) in RULES {
        for rule in rules {
            let settings = settings(integrator, rule);
            let film = |threads| {
                render(
                    &scene.scene,
                    &scene.view,
                    &settings,
                    2,
                    &with_threads(threads),
                )
                .expect("the film is small")
            };
            assert!(film(1) == film(3), "{integrator:?}, {rule}");
        }
    }
}

#[test]
fn measuring_stages_changes_no_bit_and_no_counter() {
    let scene = common::room(0.1);
    for (name, integrator) in IntegratorKind::NAMES {
        let session = |clock| {
            let resources = Resources {
                clock,
                ..with_threads(1)
            };
            let mut session = Session::new(
                &scene.scene,
                &scene.view,
                settings(integrator, "per-pair"),
                &resources,
            )
            .expect("the film is small");
            (0..16).for_each(|_| assert!(session.step(&())));
            session
        };
        let (plain, timed) = (session(None), session(Some(Instant::now)));
        assert!(plain.film() == timed.film(), "{name}");
        assert_eq!(plain.stats(), timed.stats(), "{name}");
        assert_eq!(*plain.stage_times(), StageTimes::default(), "{name}");
        let times = timed.stage_times();
        assert!((32..=256).contains(&times.samples), "{name}: {times:?}");
        let of_bdpt = timed.settings().integrator.has_candidates();
        for stage in [Stage::Walk, Stage::Film] {
            assert!(!times.of(stage).is_zero(), "{name}: {times:?}");
        }
        for stage in [Stage::Candidates, Stage::Shadow] {
            assert_eq!(!times.of(stage).is_zero(), of_bdpt, "{name}: {times:?}");
        }
    }
}

#[test]
fn a_session_counts_the_same_with_any_number_of_threads() {
    let scene = common::room(0.0);
    let stats = |threads| {
        let settings = settings(IntegratorKind::Bdpt, "per-pair");
        let mut session = Session::new(&scene.scene, &scene.view, settings, &with_threads(threads))
            .expect("the film is small");
        (0..4).for_each(|_| assert!(session.step(&())));
        session.stats().clone()
    };
    let one = stats(1);
    assert_eq!(one, stats(3));
    assert_eq!(one.samples, 4 * 64);
    // One per pair is at most one ray per sample, and not every sample has one.
    assert!(one.rays.connection > 0 && one.rays.connection <= one.samples);
    assert!(one.candidates > one.rays.connection);
}

/// Asks to stop after the first run of pixels.
struct StopAfterRun(AtomicBool);

impl Progress for StopAfterRun {
    fn advance(&self, _samples: u64) {
        self.0.store(true, Ordering::Relaxed);
    }

    fn stop(&self) -> Stop<'_> {
        Stop::when(&self.0)
    }
}

/// Whether a host asks before the pass or in it, in rays of a thread that ends its run later.
#[test]
fn a_pass_that_is_given_up_leaves_no_trace() {
    let scene = common::room_of(32, 0.0);
    for integrator in [IntegratorKind::Bdpt, IntegratorKind::Lvc] {
        let settings = settings(integrator, "all");
        let resources = with_threads(2);
        let mut session = Session::new(&scene.scene, &scene.view, settings.clone(), &resources)
            .expect("the film is small");
        assert!(session.step(&()));
        let before = session.stats().clone();
        for asks_first in [false, true] {
            assert!(!session.step(&StopAfterRun(AtomicBool::new(asks_first))));
            assert_eq!((session.next_pass(), session.stats()), (1, &before));
        }
        assert!(session.step(&()));
        let whole =
            render(&scene.scene, &scene.view, &settings, 2, &resources).expect("the film is small");
        assert!(*session.film() == whole);
    }
}

/// A host whose code panics.
struct Panics;

impl Progress for Panics {
    fn advance(&self, _samples: u64) {
        panic!("the host panics, as this test wants");
    }
}

#[test]
fn a_pass_that_the_host_ends_by_a_panic_leaves_no_trace() {
    let scene = common::room(0.0);
    let settings = settings(IntegratorKind::Bdpt, "all");
    let resources = with_threads(2);
    let session = || Session::new(&scene.scene, &scene.view, settings.clone(), &resources);
    let [mut session, mut other] = [session(), session()].map(|it| it.expect("the film is small"));
    let step = std::panic::AssertUnwindSafe(|| session.step(&Panics));
    assert!(std::panic::catch_unwind(step).is_err());
    assert!(session.step(&()) && other.step(&()));
    assert!(session.film() == other.film());
    assert_eq!(session.stats(), other.stats());
}

/// The film of some passes, by a session that goes on with others.
fn part(session: &mut Session<'_>, passes: std::ops::Range<u64>) -> Film {
    session.start_at(passes.start);
    while session.next_pass() < passes.end {
        session.step(&());
    }
    session.take_film().expect("the film is small").0
}

#[test]
fn parts_in_any_order_are_the_whole() {
    let scene = common::room(0.1);
    for (integrator, rule) in [
        (IntegratorKind::Path, "all"),
        (IntegratorKind::Light, "all"),
        (IntegratorKind::Bdpt, "all"),
        (IntegratorKind::Bdpt, "per-light-vertex"),
        (IntegratorKind::Bdpt, "per-camera-vertex"),
        (IntegratorKind::Bdpt, "per-pair"),
        (IntegratorKind::Bdpt, "ray-roulette"),
        (IntegratorKind::Bdpt, "budget:2"),
        (IntegratorKind::Lvc, "all"),
        (IntegratorKind::Lvc, "budget:2"),
        (IntegratorKind::Auto, "all"),
    ] {
        let settings = settings(integrator, rule);
        let resources = with_threads(2);
        let mut session = Session::new(&scene.scene, &scene.view, settings.clone(), &resources)
            .expect("the film is small");
        let [whole, a, b, c] = [0..7, 4..7, 0..1, 1..4].map(|range| part(&mut session, range));
        let parts = [a, b, c];
        let mut merged = parts[0].clone();
        merged.merge(&parts[2]).expect("other passes");
        // Another session renders the missing pass.
        let mut session = Session::new(
            &scene.scene,
            &scene.view,
            settings.clone(),
            &with_threads(1),
        )
        .expect("the film is small");
        session
            .add_film(merged.clone())
            .expect("nothing was rendered");
        assert_eq!(session.next_pass(), 0);
        session.step(&());
        assert_eq!(session.next_pass(), 7);
        assert!(*session.film() == whole, "{integrator:?} {rule}");
        merged.merge(&parts[1]).expect("other passes");
        assert!(merged == whole, "{integrator:?} {rule}");
        let overlap = merged.merge(&parts[0]).expect_err("the same passes");
        assert_eq!(overlap, MergeError::Overlap(PassSet::from(4..7)));
    }
}

#[test]
fn a_replayed_sample_is_the_sample() {
    for integrator in [
        IntegratorKind::Bdpt,
        IntegratorKind::Lvc,
        IntegratorKind::Auto,
    ] {
        check_replays(integrator);
    }
}

#[track_caller]
fn check_replays(integrator: IntegratorKind) {
    let scene = common::room(0.1);
    let settings = settings(integrator, "budget:2");
    let resources = with_threads(1);
    let session = Session::new(&scene.scene, &scene.view, settings.clone(), &resources)
        .expect("the film is small");
    let film = scene.view.film();
    let mut again = Film::new(film.clone(), u64::MAX).expect("the film is small");
    for pass in 0..2 {
        let buffer = PassBuffer::new(film, again.layers()).expect("the film is small");
        for i in 0..film.crop.area() as usize {
            let replay = session
                .replay(film.crop.pixel(i), pass)
                .expect("the pixel is inside");
            let rgb = |light: bidir::spectrum::Spectrum| [light[0], light[1], light[2]];
            buffer.set_camera_sample(i, rgb(replay.value()));
            for (contribution, place) in replay.splats() {
                let value = rgb(contribution.value());
                buffer.splat(film, place, value, std::iter::empty());
            }
        }
        again.add_pass(pass, &buffer);
    }
    assert!(
        again
            == render(&scene.scene, &scene.view, &settings, 2, &resources)
                .expect("the film is small")
    );
    assert!(session.replay([8, 0], 0).is_none());
}

#[test]
fn other_seeds_and_samplers_are_other_images() {
    let scene = common::room(0.0);
    let first = settings(IntegratorKind::Path, "all");
    let other = Settings {
        seed: 1,
        ..first.clone()
    };
    let film = |settings: &Settings| {
        render(&scene.scene, &scene.view, settings, 1, &with_threads(1)).expect("the film is small")
    };
    assert!(film(&first) != film(&other));
}

/// Memory of this process. Unit: pages. None: the system does not report it.
fn resident_pages() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/self/statm").ok()?;
    text.split_whitespace().nth(1)?.parse().ok()
}

#[test]
#[ignore = "takes long: just nightly"]
fn a_million_passes_take_no_memory_and_lose_nothing() {
    let radiance = [0.1, 0.7, 1.3e4];
    let mut builder = common::builder(16, 0.0);
    builder.light(Light::Infinite(InfiniteLight::constant(radiance)));
    let scene = builder.build().expect("the scene is valid");
    let settings = settings(IntegratorKind::Path, "all");
    let mut session = Session::new(&scene.scene, &scene.view, settings, &with_threads(1))
        .expect("the film is small");
    let mut before = None;
    while session.next_pass() < 1_000_000 {
        session.step(&());
        if session.next_pass() == 1000 {
            before = resident_pages();
        }
    }
    if let (Some(before), Some(after)) = (before, resident_pages()) {
        assert!(after <= before + 64, "{before} pages, then {after}");
    }
    for pixel in session.film().develop().pixels {
        assert_eq!(pixel.map(f32::to_bits), radiance.map(f32::to_bits));
    }
}

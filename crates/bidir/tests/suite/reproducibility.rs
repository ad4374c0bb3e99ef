//! The same passes have the same bits, however they are computed.

use crate::common::prelude::*;
use crate::common::rooms::{room, room_of};
use bidir::driver::{Progress, Resources, Stop};
use bidir::film::{MergeError, PassBuffer, PassSet};
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

/// Each integrator by each kind of rule that it can follow.
fn all_settings() -> impl Iterator<Item = Settings> {
    let of_connections = "all per-light-vertex per-camera-vertex per-pair ray-roulette budget:2";
    let all = [
        (IntegratorKind::Path, "all"),
        (IntegratorKind::Light, "all"),
        (IntegratorKind::Bdpt, of_connections),
        (IntegratorKind::Lvc, "all per-pair ray-roulette budget:2"),
        (IntegratorKind::Auto, "all budget:2"),
    ];
    let of =
        |(kind, rules): (_, &'static str)| rules.split(' ').map(move |rule| settings(kind, rule));
    all.into_iter().flat_map(of)
}

fn describe(settings: &Settings) -> String {
    format!("{}, {}", settings.integrator, settings.shadow_rays)
}

/// On a film that is large enough for every thread to have a part of it.
#[test]
fn threads_do_not_change_a_bit() {
    let scene = room_of(28, 0.1);
    for settings in all_settings() {
        let [one, three] = [1, 3].map(|threads| scene.film(&settings, 2, threads));
        assert!(one == three, "{}", describe(&settings));
    }
}

#[test]
fn measuring_stages_changes_no_bit_and_no_counter() {
    let scene = room(0.1);
    for (name, integrator) in IntegratorKind::NAMES {
        let session = |clock| {
            let resources = Resources {
                clock,
                ..with_threads(1)
            };
            let mut session = scene.session_with(settings(integrator, "per-pair"), &resources);
            steps(&mut session, 16);
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
    let scene = room(0.0);
    let stats = |threads| {
        let mut settings = settings(IntegratorKind::Bdpt, "per-pair");
        settings.layers = Layers::new(&[], &[], 4).with_raw();
        let mut session = scene.session(settings, threads);
        steps(&mut session, 4);
        session.stats().clone()
    };
    let one = stats(1);
    assert_eq!(one, stats(3));
    assert_eq!(one.samples, 4 * 64);
    // One per pair is at most one ray per sample, and not every sample has one.
    assert!(one.rays.connection > 0 && one.rays.connection <= one.samples);
    assert!(one.candidates > one.rays.connection);
    assert!(one.strategy_images.rows().count() > 6);
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
    let scene = room_of(32, 0.0);
    for integrator in [IntegratorKind::Bdpt, IntegratorKind::Lvc] {
        let settings = settings(integrator, "all");
        let mut session = scene.session(settings.clone(), 2);
        steps(&mut session, 1);
        let before = session.stats().clone();
        for asks_first in [false, true] {
            assert!(!session.step(&StopAfterRun(AtomicBool::new(asks_first))));
            assert_eq!((session.next_pass(), session.stats()), (1, &before));
        }
        assert!(session.step(&()));
        assert!(*session.film() == scene.film(&settings, 2, 2));
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
    let scene = room(0.0);
    let settings = settings(IntegratorKind::Bdpt, "all");
    let [mut session, mut other] = [(); 2].map(|()| scene.session(settings.clone(), 2));
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
    let scene = room(0.1);
    for settings in all_settings() {
        let case = describe(&settings);
        let mut session = scene.session(settings.clone(), 2);
        let [whole, a, b, c] = [0..7, 4..7, 0..1, 1..4].map(|range| part(&mut session, range));
        let parts = [a, b, c];
        let mut merged = parts[0].clone();
        merged.merge(&parts[2]).expect("other passes");
        // Another session renders the missing pass.
        let mut session = scene.session(settings, 1);
        let added = session.add_film(merged.clone());
        added.expect("nothing was rendered");
        assert_eq!(session.next_pass(), 0);
        session.step(&());
        assert_eq!(session.next_pass(), 7);
        assert!(*session.film() == whole, "{case}");
        merged.merge(&parts[1]).expect("other passes");
        assert!(merged == whole, "{case}");
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
    let scene = room(0.1);
    let settings = settings(integrator, "budget:2");
    let session = scene.session(settings.clone(), 1);
    let film = scene.view.film();
    let mut again = Film::new(film.clone(), u64::MAX).expect("the film is small");
    for pass in 0..2 {
        let buffer = PassBuffer::new(film, again.layers()).expect("the film is small");
        for i in 0..film.crop.area() as usize {
            let replay = session.replay(film.crop.pixel(i), pass);
            let replay = replay.expect("the pixel is inside");
            let rgb = |light: Spectrum| [light[0], light[1], light[2]];
            buffer.set_camera_sample(i, rgb(replay.value()));
            for (contribution, place) in replay.splats() {
                let value = rgb(contribution.value());
                buffer.splat(film, place, value, std::iter::empty());
            }
        }
        again.add_pass(pass, &buffer);
    }
    assert!(again == scene.film(&settings, 2, 1));
    assert!(session.replay([8, 0], 0).is_none());
}

#[test]
fn other_seeds_and_samplers_are_other_images() {
    let scene = room(0.0);
    let first = settings(IntegratorKind::Path, "all");
    let other = Settings {
        seed: 1,
        ..first.clone()
    };
    assert!(scene.film(&first, 1, 1) != scene.film(&other, 1, 1));
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
    let mut builder = builder(16, 0.0);
    builder.sky(radiance);
    let scene = builder.build();
    let mut session = scene.session(settings(IntegratorKind::Path, "all"), 1);
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

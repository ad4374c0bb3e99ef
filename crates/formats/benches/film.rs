//! Measures the cost of the exact film relative to the time of rendering: adds the same contributions to
//! a [`PassBuffer`] and [`Film`], and to plain `f32` pixels (camera samples added, splats by
//! compare-and-swap, no variance).
//!
//! `cargo bench -p bidir-formats --bench film`, or `just bench-film`. Every round measures everything in
//! turn; the table shows medians over rounds.

use bidir::driver::{Progress, Resources, Session, Settings};
use bidir::film::{Film, FilmSettings, PassBuffer, SplatPlace};
use bidir::integrator::IntegratorKind;
use bidir::spectrum::Rgb;
use bidir_formats::pbrt::{LoadOptions, Loaded, load};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::iter;
use std::path::Path;
use std::sync::atomic::{AtomicU32, AtomicUsize, Ordering};
use std::time::Instant;

const ROUNDS: usize = 9;
/// Number of recorded passes, which are played in turn.
const RECORDED: u64 = 4;
/// Number of times that the recorded passes are played in one measurement.
const PLAYED: usize = 16;
const RUN: usize = 256;

/// The contributions of a sample: the value of its own pixel, and splats with their places.
struct Contributions {
    camera: Rgb,
    splats: Vec<(SplatPlace, Rgb)>,
}

/// Records the contributions of a pass, pixel by pixel.
fn record(session: &Session<'_>, pass: u64) -> Vec<Contributions> {
    let crop = session.view().film().crop;
    let pixels = 0..crop.area() as usize;
    let of = |pixel| {
        let replay = session.replay(crop.pixel(pixel), pass)?;
        let rgb = |value| replay.lanes.to_rgb(value);
        let splats = replay.splats();
        let splats = splats.map(|(contribution, place)| (place, rgb(contribution.value())));
        Some(Contributions {
            camera: rgb(replay.value()),
            splats: splats.collect(),
        })
    };
    pixels.filter_map(of).collect()
}

/// Calls `deposit` for every pixel, runs of pixels in turn on all threads of `pool`.
fn on_all_threads(pool: &ThreadPool, pixels: usize, deposit: impl Fn(usize) + Sync) {
    let next = AtomicUsize::new(0);
    pool.broadcast(|_| {
        loop {
            let begin = next.fetch_add(RUN, Ordering::Relaxed);
            if begin >= pixels {
                return;
            }
            (begin..(begin + RUN).min(pixels)).for_each(&deposit);
        }
    });
}

/// A film of plain floating-point sums.
struct PlainFilm {
    pixels: Vec<[AtomicU32; 3]>,
}

impl PlainFilm {
    fn new(pixels: usize) -> Self {
        let pixels = iter::repeat_with(Default::default).take(pixels).collect();
        Self { pixels }
    }

    fn add(&self, i: usize, value: Rgb) {
        for (cell, channel) in self.pixels[i].iter().zip(value) {
            let add = |bits| Some((f32::from_bits(bits) + channel).to_bits());
            // The closure always gives a value, so this cannot fail.
            let _ = cell.fetch_update(Ordering::Relaxed, Ordering::Relaxed, add);
        }
    }
}

/// Measures adding the recorded passes to plain pixels. Unit: seconds.
fn plain(pool: &ThreadPool, settings: &FilmSettings, passes: &[Vec<Contributions>]) -> f64 {
    let film = PlainFilm::new(passes[0].len());
    let start = Instant::now();
    for pass in iter::repeat_n(passes, PLAYED).flatten() {
        on_all_threads(pool, pass.len(), |i| {
            film.add(i, pass[i].camera);
            for &(place, value) in &pass[i].splats {
                if let Some((pixel, weight)) = settings.pick_pixel(place) {
                    film.add(pixel, value.map(|channel| channel * weight));
                }
            }
        });
    }
    start.elapsed().as_secs_f64() / (PLAYED * passes.len()) as f64
}

/// Measures adding the recorded passes to an exact film. Unit: seconds.
fn exact(pool: &ThreadPool, settings: &FilmSettings, passes: &[Vec<Contributions>]) -> f64 {
    let mut film = Film::new(settings.clone(), u64::MAX).expect("the scene's film");
    let mut buffer = PassBuffer::new(settings, film.layers()).expect("the memory of a pass");
    let start = Instant::now();
    for (index, pass) in (0..).zip(iter::repeat_n(passes, PLAYED).flatten()) {
        on_all_threads(pool, pass.len(), |i| {
            buffer.set_camera_sample(i, pass[i].camera);
            for &(place, value) in &pass[i].splats {
                buffer.splat(settings, place, value, iter::empty());
            }
        });
        pool.install(|| film.add_pass(index, &buffer));
        buffer.clear();
    }
    start.elapsed().as_secs_f64() / (PLAYED * passes.len()) as f64
}

/// Measures rendering a pass. Unit: seconds.
fn render(session: &mut Session<'_>, progress: &dyn Progress) -> f64 {
    let start = Instant::now();
    for _ in 0..RECORDED {
        session.step(progress);
    }
    start.elapsed().as_secs_f64() / RECORDED as f64
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Measures one estimator with a number of threads. Returns a row of the table.
fn measure(loaded: &Loaded, name: &str, settings: &Settings, threads: usize) -> String {
    let resources = Resources {
        threads,
        ..Resources::default()
    };
    let mut session = Session::new(&loaded.scene, &loaded.view, settings.clone(), &resources)
        .expect("the scene's film");
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.expect("threads can be started");
    let passes: Vec<_> = (0..RECORDED).map(|pass| record(&session, pass)).collect();
    let rounds = (0..ROUNDS).map(|_| {
        let rendered = render(&mut session, &());
        [
            rendered,
            plain(&pool, loaded.view.film(), &passes),
            exact(&pool, loaded.view.film(), &passes),
        ]
    });
    let rounds: Vec<_> = rounds.collect();
    let of = |i: usize| median(rounds.iter().map(|round| round[i]).collect());
    let share = median(
        rounds
            .iter()
            .map(|[all, plain, exact]| (exact - plain) / all)
            .collect(),
    );
    let milliseconds = [of(0), of(1), of(2)].map(|seconds| seconds * 1e3);
    let [all, plain, exact] = milliseconds;
    let share = share * 100.0;
    format!("{name:10} {threads:7} {all:14.2} {plain:10.3} {exact:10.3} {share:9.2} %")
}

#[expect(clippy::print_stdout, reason = "this is what the bench is for")]
fn main() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/room-indirect.pbrt");
    let options = LoadOptions {
        resolution: Some([320, 240]),
        ..LoadOptions::default()
    };
    let loaded = load(&file, &options).expect("the project's scene");
    println!("room-indirect, 320x240, milliseconds for each pass, medians of {ROUNDS} rounds");
    println!("estimator  threads  render (exact)      plain      exact      cost");
    // `lvc` adds contributions as `bdpt` does, and cannot render a single sample; `auto` chooses one of the
    // others.
    let estimators = IntegratorKind::NAMES.into_iter();
    for (name, integrator) in
        estimators.filter(|(_, kind)| !matches!(kind, IntegratorKind::Lvc | IntegratorKind::Auto))
    {
        for threads in [1, 2] {
            let settings = Settings::new(integrator);
            println!("{}", measure(&loaded, name, &settings, threads));
        }
    }
}

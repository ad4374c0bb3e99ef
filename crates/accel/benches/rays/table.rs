//! Measures, and prints as Markdown.

use std::hint::black_box;
use std::time::Duration;

use bidir_accel::{Isa, Ray};
use rayon::ThreadPool;

use crate::ours::Engine;
use crate::rays::{Batch, Question};

/// How the names of the engines begin that others are compared with.
pub(crate) const EMBREE: &str = "Embree";

/// An engine and its name.
pub(crate) struct Column<'a> {
    name: String,
    isa: Isa,
    engine: Box<dyn Engine + 'a>,
}

impl<'a> Column<'a> {
    /// `name` lacks the instructions, which are `isa`.
    pub(crate) fn new(name: &str, isa: Isa, engine: impl Engine + 'a) -> Self {
        Self {
            name: format!("{name} {isa}"),
            isa,
            engine: Box::new(engine),
        }
    }

    /// The column that this one is compared with: the first Embree for the same instructions.
    fn reference(&self, columns: &[Self]) -> Option<usize> {
        let same = |column: &Self| column.name.starts_with(EMBREE) && column.isa == self.isa;
        let first = columns.iter().position(same)?;
        (columns[first].name != self.name).then_some(first)
    }
}

/// Seconds that a thread of the pool works on all rays; each begins elsewhere.
fn seconds(engine: &dyn Engine, batch: &Batch, pool: &ThreadPool) -> f64 {
    let threads = pool.current_num_threads();
    let work = |thread: usize| {
        let (last, first) = batch.rays.split_at(thread * batch.rays.len() / threads);
        let begin = working_time();
        for part in [first, last] {
            black_box(engine.count_hits(batch.question, part));
        }
        working_time().saturating_sub(begin).as_secs_f64()
    };
    let total: f64 = pool.broadcast(|context| work(context.index())).iter().sum();
    total / threads as f64
}

/// Time that this thread has had a processor: the time of others does not count.
#[cfg(target_os = "linux")]
fn working_time() -> Duration {
    let mut time = libc::timespec {
        tv_sec: 0,
        tv_nsec: 0,
    };
    // SAFETY: the clock exists on every Linux, and the call writes to `time` only.
    unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &raw mut time) };
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
}

/// The time that passes.
#[cfg(not(target_os = "linux"))]
fn working_time() -> Duration {
    static BEGIN: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    BEGIN.get_or_init(std::time::Instant::now).elapsed()
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// `[batch][column][round]`, in seconds.
type Times = Vec<Vec<Vec<f64>>>;

/// All columns of a batch next to each other in time, and not always in the same order.
fn measure(columns: &[Column], batches: &[Batch], rounds: usize, pool: &ThreadPool) -> Times {
    let mut times = vec![vec![Vec::new(); columns.len()]; batches.len()];
    for round in 0..rounds {
        for (batch, times) in batches.iter().zip(&mut times) {
            for k in 0..columns.len() {
                let k = (k + round) % columns.len();
                times[k].push(seconds(columns[k].engine.as_ref(), batch, pool));
            }
        }
    }
    times
}

/// Millions of rays that a thread traces in a second, and the ratio to Embree for the same instructions; the mean is
/// that of rays which are asked one by one.
pub(crate) fn scene_table(columns: &[Column], batches: &[Batch], rounds: usize, pool: &ThreadPool) {
    let times = measure(columns, batches, rounds, pool);
    let names: Vec<_> = batches.iter().map(|batch| batch.name).collect();
    let threads = pool.current_num_threads();
    let names = names.join(" | ");
    println!("\n| Million rays/s per thread, {threads} running | {names} | Mean ratio |");
    println!("|---{}|---:|", "|---:".repeat(batches.len()));
    for (k, column) in columns.iter().enumerate() {
        let reference = column.reference(columns);
        let ratio = |times: &[Vec<f64>]| {
            reference.map(|reference| {
                let pairs = times[reference].iter().zip(&times[k]);
                median(pairs.map(|(theirs, ours)| theirs / ours))
            })
        };
        let cell = |(batch, times): (&Batch, &Vec<Vec<f64>>)| {
            let speed = batch.rays.len() as f64 / median(times[k].iter().copied()) / 1e6;
            let ratio = ratio(times).map_or(String::new(), |ratio| format!(" ({ratio:.2})"));
            format!("{speed:.2}{ratio}")
        };
        let cells: Vec<_> = batches.iter().zip(&times).map(cell).collect();
        let single = times.iter().zip(batches);
        let single = single.filter(|(_, batch)| batch.question != Question::Together);
        let logarithms: Option<Vec<f64>> = single
            .map(|(times, _)| Some(ratio(times)?.log2()))
            .collect();
        let mean = logarithms.map_or(String::new(), |all| {
            format!("{:.2}", (all.iter().sum::<f64>() / all.len() as f64).exp2())
        });
        println!("| {} | {} | {mean} |", column.name, cells.join(" | "));
    }
    let first = hits(&columns[0], batches);
    println!("| Rays that hit | {} | |", first.join(" | "));
    for column in columns {
        let hits = hits(column, batches);
        if hits != first {
            println!("| Those of {} | {} | |", column.name, hits.join(" | "));
        }
    }
}

fn hits(column: &Column, batches: &[Batch]) -> Vec<String> {
    let share = |batch: &Batch| {
        let hits = column.engine.count_hits(batch.question, &batch.rays);
        format!("{:.1} %", 100.0 * hits as f64 / batch.rays.len() as f64)
    };
    batches.iter().map(share).collect()
}

/// Memory and time to build.
pub(crate) fn build_table(columns: &[Column], triangles: usize) {
    println!("\n| | bytes per triangle | seconds to build |\n|---|---:|---:|");
    for column in columns {
        let bytes = column.engine.bytes() as f64 / triangles as f64;
        println!(
            "| {} | {bytes:.1} | {:.3} |",
            column.name,
            column.engine.build_seconds()
        );
    }
}

/// Rays that hit nothing though the mesh is closed.
pub(crate) fn leak_table(name: &str, columns: &[Column], rays: &[Ray]) {
    println!(
        "\n| {name}: {} rays at edges and vertices | closest | occluded | many at once |\n|---|---:|---:|---:|",
        rays.len()
    );
    for column in columns {
        let leaks = |question| rays.len() - column.engine.count_hits(question, rays);
        let questions = [Question::Closest, Question::Occluded, Question::Together];
        let [closest, occluded, together] = questions.map(leaks);
        let name = &column.name;
        println!("| {name} | {closest} | {occluded} | {together} |");
    }
}

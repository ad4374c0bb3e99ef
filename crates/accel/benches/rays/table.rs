//! Measures, and prints as Markdown.

use std::hint::black_box;
use std::time::Instant;

use bidir_accel::Ray;
use rayon::ThreadPool;
use rayon::prelude::{IntoParallelIterator, ParallelIterator};

use crate::ours::Engine;
use crate::rays::{Batch, Question};

/// An engine and its name.
pub(crate) struct Column<'a> {
    name: String,
    engine: Box<dyn Engine + 'a>,
}

impl<'a> Column<'a> {
    pub(crate) fn new(name: String, engine: Box<dyn Engine + 'a>) -> Self {
        Self { name, engine }
    }

    /// The column that this one is compared with: Embree for the same instructions.
    fn reference(&self, columns: &[Self]) -> Option<usize> {
        let wanted = self.name.replace("ours", "Embree");
        let same = |column: &Self| column.name == wanted && wanted != self.name;
        columns.iter().position(same)
    }
}

/// Seconds for all rays on every thread of the pool: each traces all of them, from its own beginning.
fn seconds(engine: &dyn Engine, batch: &Batch, pool: &ThreadPool) -> f64 {
    let threads = pool.current_num_threads();
    let part = |thread: usize| {
        let (last, first) = batch.rays.split_at(thread * batch.rays.len() / threads);
        engine.count_hits(batch.question, first) + engine.count_hits(batch.question, last)
    };
    let begin = Instant::now();
    let hits: usize = pool.install(|| (0..threads).into_par_iter().map(part).sum());
    black_box(hits);
    begin.elapsed().as_secs_f64()
}

pub(crate) fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Millions of rays a second and thread, and the ratio to Embree for the same instructions.
pub(crate) fn scene_table(columns: &[Column], batches: &[Batch], rounds: usize, pool: &ThreadPool) {
    // `times[batch][column][round]`, all columns of a batch next to each other in time.
    let mut times = vec![vec![Vec::new(); columns.len()]; batches.len()];
    for round in 0..rounds {
        for (batch, times) in batches.iter().zip(&mut times) {
            for k in 0..columns.len() {
                // Not always in the same order.
                let k = (k + round) % columns.len();
                times[k].push(seconds(columns[k].engine.as_ref(), batch, pool));
            }
        }
    }
    let threads = pool.current_num_threads();
    let names: Vec<_> = batches.iter().map(|batch| batch.name).collect();
    println!(
        "\n| {threads} thread(s), million rays/s (ratio to Embree) | {} | mean ratio |",
        names.join(" | ")
    );
    println!("|---{}|---:|", "|---:".repeat(batches.len()));
    for (k, column) in columns.iter().enumerate() {
        let reference = column.reference(columns);
        let (mut cells, mut logarithms) = (String::new(), 0.0);
        for (batch, times) in batches.iter().zip(&times) {
            let rays = (threads * batch.rays.len()) as f64;
            let speed = rays / median(times[k].iter().copied()) / 1e6;
            cells += &format!(" {speed:.2}");
            if let Some(reference) = reference {
                let pairs = times[reference].iter().zip(&times[k]);
                let ratio = median(pairs.map(|(theirs, ours)| theirs / ours));
                logarithms += ratio.log2();
                cells += &format!(" ({ratio:.2})");
            }
            cells += " |";
        }
        let mean = (logarithms / batches.len() as f64).exp2();
        let mean = reference.map_or(String::new(), |_| format!("{mean:.2}"));
        println!("| {} |{cells} {mean} |", column.name);
    }
    let hits = |column: &Column| -> Vec<String> {
        let share = |batch: &Batch| {
            let hits = column.engine.count_hits(batch.question, &batch.rays);
            format!("{:.2} %", 100.0 * hits as f64 / batch.rays.len() as f64)
        };
        batches.iter().map(share).collect()
    };
    println!("| rays that hit | {} | |", hits(&columns[0]).join(" | "));
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
        "\n| {name}: {} rays at edges and vertices | closest | occluded |\n|---|---:|---:|",
        rays.len()
    );
    for column in columns {
        let leaks = |question| rays.len() - column.engine.count_hits(question, rays);
        let (closest, occluded) = (leaks(Question::Closest), leaks(Question::Occluded));
        println!("| {} | {closest} | {occluded} |", column.name);
    }
}

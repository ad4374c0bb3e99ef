//! The light subpaths of a pass, kept for all of its samples, in the order of their numbers.

use crate::path::{LightShares, PathContext, RunningSums, Subpath, Vertex};
use std::sync::{Mutex, PoisonError};

/// Light subpaths are kept in runs of this length, each written by one thread.
const RUN: u64 = 256;

/// The light subpaths of a pass.
///
/// They are written by many threads, run by run, between [`begin`](Self::begin) and
/// [`end`](Self::end); then they are read.
#[derive(Debug, Default)]
pub(crate) struct LightCache {
    writing: Vec<Mutex<Run>>,
    runs: Vec<Run>,
    /// The vertices that can be connected, in the order of their subpaths.
    entries: Vec<Entry>,
    /// The number of subpaths, those without a vertex included.
    subpaths: u64,
}

/// Subpaths that follow each other.
#[derive(Debug, Default)]
struct Run {
    vertices: Vec<Vertex>,
    /// For each vertex the sum with its number, as long as there is one.
    sums: Vec<f64>,
    starts: Vec<Start>,
}

/// Where a subpath begins in its run.
#[derive(Clone, Copy, Debug)]
struct Start {
    vertex: u32,
    end: crate::path::LightEnd,
}

/// A vertex that can be connected.
#[derive(Clone, Copy, Debug)]
struct Entry {
    run: u32,
    start: u32,
    vertex: u32,
}

/// A vertex of the cache, with the subpath up to it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cached<'a> {
    /// From x_0 to the vertex.
    pub(super) light: &'a [Vertex],
    /// The sums of its subpath.
    pub(super) shares: LightShares<'a>,
}

impl LightCache {
    /// Forgets all, and makes room for so many subpaths.
    pub(super) fn begin(&mut self, subpaths: u64) {
        let mut runs = std::mem::take(&mut self.runs);
        for run in &mut runs {
            run.vertices.clear();
            run.sums.clear();
            run.starts.clear();
        }
        runs.resize_with(subpaths.div_ceil(RUN) as usize, Run::default);
        self.writing = runs.into_iter().map(Mutex::new).collect();
        self.entries.clear();
        self.subpaths = subpaths;
    }

    /// Keeps subpath number `index`. Those of a run come in order.
    pub(super) fn keep(&self, index: u64, subpath: &Subpath, weights: &RunningSums) {
        let mut run = self.writing[(index / RUN) as usize]
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        let shares = weights.light_shares();
        let vertex = run.vertices.len() as u32;
        run.starts.push(Start {
            vertex,
            end: shares.start,
        });
        run.vertices.extend_from_slice(&subpath.vertices);
        run.sums.extend_from_slice(shares.sums);
        let length = run.vertices.len();
        run.sums.resize(length, 0.0);
    }

    /// Lists what can be connected.
    pub(super) fn end(&mut self, context: &PathContext<'_>) {
        let first_walked = context.settings.light_point.first_walked() as u32;
        let written = std::mem::take(&mut self.writing).into_iter();
        self.runs
            .extend(written.map(|run| run.into_inner().unwrap_or_else(PoisonError::into_inner)));
        for (number, run) in self.runs.iter().enumerate() {
            for (start, Start { vertex: first, .. }) in run.starts.iter().enumerate() {
                let next = run.starts.get(start + 1);
                let after = next.map_or(run.vertices.len() as u32, |next| next.vertex);
                for vertex in (first + first_walked - 1..after)
                    .filter(|&vertex| !run.vertices[vertex as usize].is_delta())
                {
                    self.entries.push(Entry {
                        run: number as u32,
                        start: start as u32,
                        vertex,
                    });
                }
            }
        }
    }

    /// How many vertices can be connected.
    pub(super) fn len(&self) -> usize {
        self.entries.len()
    }

    /// How many that is for each subpath.
    pub(super) fn per_subpath(&self) -> f64 {
        self.entries.len() as f64 / self.subpaths as f64
    }

    /// Vertex number `i` of those.
    #[inline]
    pub(super) fn get(&self, i: usize) -> Cached<'_> {
        let entry = self.entries[i];
        let run = &self.runs[entry.run as usize];
        let start = &run.starts[entry.start as usize];
        let range = start.vertex as usize..entry.vertex as usize + 1;
        Cached {
            shares: LightShares {
                sums: &run.sums[range.clone()],
                start: start.end,
            },
            light: &run.vertices[range],
        }
    }
}

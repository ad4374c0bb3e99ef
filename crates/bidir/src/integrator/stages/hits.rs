//! s = 0: the camera subpath hits lights, or escapes to those at infinity. No shadow rays.

use super::super::journal::enter;
use super::super::{Entry, Link, Walked, Worker};
use crate::contribution::Term;
use crate::path::{Arrival, EndSums, HitPath, Job, Vertex, Weights};
use crate::spectrum::Spectrum;
use crate::stats::Stage;
use crate::strategy::Strategy;

/// Adds the light that camera subpaths find by themselves.
#[inline(never)]
pub(in super::super) fn hits(
    job: &Job<'_>,
    walked: &Walked,
    entries: &mut Vec<Entry>,
    worker: &mut Worker,
) {
    let Worker { weights, stats, .. } = worker;
    for (number, sample) in walked.samples.iter().enumerate() {
        let walk = walked.camera.get(number);
        let mut add = |camera: &[Vertex], arrival: &Arrival| {
            let sums = walked.camera.sums.at(walk.first + camera.len() - 1);
            if let Some(term) = hit(job, camera, arrival, weights, sums) {
                enter(entries, stats, number, sample, term, Link::Walk);
            }
        };
        for (i, vertex) in walk.vertices.iter().enumerate().skip(1) {
            if let Some(arrival) = Arrival::at(vertex) {
                add(&walk.vertices[..i], &arrival);
            }
        }
        let escape = walk.escape.into_iter();
        for arrival in escape.flat_map(|escape| Arrival::of_escape(job.scene, escape)) {
            add(walk.vertices, &arrival);
        }
    }
    worker.stopwatch.end(Stage::Hits);
}

/// Returns the term of the path from `camera` to the light that was hit. None: it is zero.
fn hit(
    job: &Job<'_>,
    camera: &[Vertex],
    arrival: &Arrival,
    weights: &mut Weights,
    sums: &EndSums,
) -> Option<Term> {
    let t = camera.len() + 1;
    if !job.takes(0, t) {
        return None;
    }
    let contribution = arrival.contribution(job);
    (contribution != Spectrum::ZERO).then(|| Term {
        strategy: Strategy::new(0, t),
        light: arrival.light,
        contribution,
        weight: weights.hit(job, &HitPath::new(job, arrival, camera), sums),
    })
}

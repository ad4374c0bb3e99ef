//! s = 0: the camera subpath hits lights, or escapes to those at infinity. No shadow rays.

use super::super::batch::enter;
use super::super::{Batch, Link};
use crate::contribution::Term;
use crate::path::{Arrival, EndSums, Job, JoinedPath, PathSums, Vertex, Weights};
use crate::spectrum::Spectrum;
use crate::stats::Stage;
use crate::strategy::Strategy;

/// Adds the light that camera subpaths find by themselves.
#[inline(never)] // So that profiles show the stages, each of which is called once.
pub(in super::super) fn hits(job: &Job<'_>, batch: &mut Batch) {
    let Batch {
        samples,
        camera,
        camera_sums,
        weights,
        entries,
        stats,
        ..
    } = batch;
    for (number, sample) in samples.iter().enumerate() {
        let walk = camera.get(number);
        let mut add = |camera: &[Vertex], arrival: &Arrival| {
            let sums = PathSums {
                light: &EndSums::NONE,
                camera: camera_sums.at(walk.first + camera.len() - 1),
                next_event: None,
            };
            if let Some(term) = hit(job, camera, arrival, weights, &sums) {
                enter(entries, stats, (number, sample), term, Link::Walk);
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
    batch.stopwatch.end(Stage::Hits);
}

/// Returns the term of the path from `camera` to the light that was hit. None: it is zero.
fn hit(
    job: &Job<'_>,
    camera: &[Vertex],
    arrival: &Arrival,
    weights: &mut Weights,
    sums: &PathSums<'_>,
) -> Option<Term> {
    let strategy = Strategy::new(0, camera.len() + 1);
    if !job.takes(0, camera.len() + 1) {
        return None;
    }
    let contribution = arrival.contribution(job);
    (contribution != Spectrum::ZERO).then(|| {
        let x0 = arrival.vertex(job);
        let path = JoinedPath::hit(&x0, camera);
        Term {
            strategy,
            light: arrival.light,
            contribution,
            weight: weights.weight(job, &path, sums),
        }
    })
}

//! Draws from the light vertex cache, for all camera vertices before any of them is connected, so that the vertices
//! drawn are loaded meanwhile: they lie anywhere in the memory of a group.

use super::super::cache::CachedEnd;
use super::super::{Batch, CandidateCount};
use crate::path::Job;
use crate::sampler::{Dimension, Purpose};
use crate::stats::Stage;

/// Draws for each camera vertex as many vertices of the cache as `counts` says, one of each of as many parts of it.
#[inline(never)]
pub(in super::super) fn draw_cached(job: &Job<'_>, batch: &mut Batch, counts: CandidateCount) {
    let Batch {
        samples,
        camera,
        light,
        light_sums,
        cache,
        cached,
        ..
    } = batch;
    let max_vertices = job.settings.max_vertices();
    for (number, sample) in samples.iter().enumerate() {
        let vertices = camera.get(number).vertices;
        for (t, y) in (2..).zip(vertices.iter().skip(1)) {
            if y.is_delta() {
                continue;
            }
            let count = f64::from(counts.at(t));
            let at = Dimension::at(t - 1, Purpose::CachedVertex);
            let u = f64::from(sample.camera.get_1d(at));
            for m in 0..counts.at(t) {
                let u = (f64::from(m) + u) / count;
                let Some(draw) = cache.draw(job.guide.proposals, y.cell, u) else {
                    continue;
                };
                let place = cache.place(draw.entry);
                if usize::from(place.s) + t > max_vertices {
                    continue;
                }
                if place.is_diffuse {
                    light_sums.load_ahead(place.z as usize);
                } else {
                    light.load_ahead(place.z as usize);
                }
                cached.push(CachedEnd {
                    sample: number as u32,
                    t: t as u32,
                    entry: draw.entry as u32,
                    share: (draw.share / count) as f32,
                    place,
                });
            }
        }
    }
    batch.stopwatch.end(Stage::Candidates);
}

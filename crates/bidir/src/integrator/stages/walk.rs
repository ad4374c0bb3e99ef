//! The subpaths of the samples, sums along them, and the lights that camera subpaths hit by themselves, s = 0.

use super::super::journal::enter;
use super::super::{Entry, Link, Sample, Walks, Worker};
use crate::camera::CameraRay;
use crate::contribution::Term;
use crate::math::Vec2;
use crate::path::{Arrival, HitPath, Job, camera_subpath, light_subpath};
use crate::sampler::{Dimension, Purpose};
use crate::spectrum::Spectrum;
use crate::stats::Stage;
use crate::strategy::Strategy;

/// Walks the camera subpath of each sample.
#[inline(never)] // So that profiles show the stages, each of which is called once.
pub(in super::super) fn walk_camera(job: &Job<'_>, walks: &mut Walks, worker: &mut Worker) {
    let Walks {
        samples, camera, ..
    } = walks;
    for sample in &*samples {
        let (ray, weight) = camera_ray(job, sample);
        camera_subpath(job, &sample.camera, &ray, weight, camera, &mut worker.stats);
    }
    worker.stopwatch.end(Stage::Walk);
}

/// Walks the light subpath of each sample, and adds it to those that are there.
#[inline(never)]
pub(in super::super) fn walk_light(job: &Job<'_>, walks: &mut Walks, worker: &mut Worker) {
    let Walks { samples, light, .. } = walks;
    for sample in &*samples {
        light_subpath(job, &sample.light, light, &mut worker.stats);
    }
    worker.stopwatch.end(Stage::Walk);
}

/// Prepares the weights of paths with the camera subpaths.
#[inline(never)]
pub(in super::super) fn sum_camera(job: &Job<'_>, walks: &mut Walks, worker: &mut Worker) {
    if worker.weights.uses_sums() {
        walks.camera.add_sums(job, 0);
    }
    worker.stopwatch.end(Stage::Walk);
}

/// Prepares the weights of paths with the samples' light subpaths.
#[inline(never)]
pub(in super::super) fn sum_light(job: &Job<'_>, walks: &mut Walks, worker: &mut Worker) {
    if worker.weights.uses_sums() {
        walks.light.add_sums(job, walks.first_light());
    }
    worker.stopwatch.end(Stage::Walk);
}

/// Adds the light that camera subpaths hit, on their way or where they escape. No shadow rays.
#[inline(never)]
pub(in super::super) fn hits(
    job: &Job<'_>,
    walks: &Walks,
    entries: &mut Vec<Entry>,
    worker: &mut Worker,
) {
    let Worker { weights, stats, .. } = worker;
    for (index, sample) in walks.samples.iter().enumerate() {
        let walk = walks.camera.get(index);
        for (before, arrival) in Arrival::all(job.scene, &walk) {
            let t = before.len() + 1;
            if !job.takes(0, t) {
                continue;
            }
            let contribution = arrival.contribution(job);
            if contribution == Spectrum::ZERO {
                continue;
            }
            let sums = walks.camera.sums.at(walk.first + t - 2);
            let term = Term {
                strategy: Strategy::new(0, t),
                light: arrival.light,
                contribution,
                weight: weights.hit(job, &HitPath::new(job, &arrival, before), sums),
            };
            enter(entries, stats, index, sample, term, Link::Walk);
        }
    }
    worker.stopwatch.end(Stage::Hits);
}

/// Returns the ray of a camera sample, and the weight of its film position.
pub(crate) fn camera_ray(job: &Job<'_>, sample: &Sample) -> (CameraRay, f32) {
    let get = |purpose| sample.camera.get_2d(Dimension::at(0, purpose));
    let (offset, weight) = job.view.film().filter.sample(get(Purpose::Film));
    let raster = Vec2::new(sample.pixel[0] as f32, sample.pixel[1] as f32) + 0.5 + offset;
    let camera = job.view.camera();
    let ray = camera.sample_ray(raster, || get(Purpose::Lens));
    (ray, weight)
}

//! The subpaths of the samples, and sums along them.

use super::super::{Sample, Walked, Worker};
use crate::camera::CameraRay;
use crate::math::Vec2;
use crate::path::{Job, camera_subpath, light_subpath};
use crate::sampler::{Dimension, Purpose};
use crate::stats::Stage;

/// Walks the camera subpath of each sample.
#[inline(never)] // So that profiles show the stages, each of which is called once.
pub(in super::super) fn walk_camera(job: &Job<'_>, walked: &mut Walked, worker: &mut Worker) {
    let Walked {
        samples, camera, ..
    } = walked;
    for sample in &*samples {
        let (ray, weight) = camera_ray(job, sample);
        camera_subpath(job, &sample.camera, &ray, weight, camera, &mut worker.stats);
    }
    worker.stopwatch.end(Stage::Walk);
}

/// Walks the light subpath of each sample, and adds it to those that are there.
#[inline(never)]
pub(in super::super) fn walk_light(job: &Job<'_>, walked: &mut Walked, worker: &mut Worker) {
    let Walked { samples, light, .. } = walked;
    for sample in &*samples {
        light_subpath(job, &sample.light, light, &mut worker.stats);
    }
    worker.stopwatch.end(Stage::Walk);
}

/// Prepares the weights of paths with the camera subpaths.
#[inline(never)]
pub(in super::super) fn sum_camera(job: &Job<'_>, walked: &mut Walked, worker: &mut Worker) {
    if worker.weights.uses_sums() {
        walked.camera.add_sums(job, 0);
    }
    worker.stopwatch.end(Stage::Walk);
}

/// Prepares the weights of paths with the samples' light subpaths.
#[inline(never)]
pub(in super::super) fn sum_light(job: &Job<'_>, walked: &mut Walked, worker: &mut Worker) {
    if worker.weights.uses_sums() {
        let first = walked.first_light();
        walked.light.add_sums(job, first);
    }
    worker.stopwatch.end(Stage::Walk);
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

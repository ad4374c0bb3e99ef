//! The subpaths of the samples, and sums along them.

use super::super::{Batch, Sample};
use crate::camera::CameraRay;
use crate::math::Vec2;
use crate::path::{Job, camera_subpath, light_subpath};
use crate::sampler::{Dimension, Purpose};
use crate::stats::Stage;

/// Walks the camera subpath of each sample.
#[inline(never)]
pub(in super::super) fn walk_camera(job: &Job<'_>, batch: &mut Batch) {
    let Batch {
        samples,
        camera,
        stats,
        ..
    } = batch;
    for sample in &*samples {
        let (ray, weight) = camera_ray(job, sample);
        camera_subpath(job, &sample.camera, &ray, weight, camera, stats);
    }
    batch.stopwatch.end(Stage::Walk);
}

/// Walks the light subpath of each sample, and adds it to those that are there.
#[inline(never)]
pub(in super::super) fn walk_light(job: &Job<'_>, batch: &mut Batch) {
    let Batch {
        samples,
        light,
        stats,
        ..
    } = batch;
    for sample in &*samples {
        light_subpath(job, &sample.light, light, stats);
    }
    batch.stopwatch.end(Stage::Walk);
}

/// Prepares the weights of paths with the camera subpaths.
#[inline(never)]
pub(in super::super) fn sum_camera(job: &Job<'_>, batch: &mut Batch) {
    if batch.weights.uses_sums() {
        for i in 0..batch.samples.len() {
            let walk = batch.camera.get(i);
            batch.camera_sums.add_camera(job, &walk);
        }
    }
    batch.stopwatch.end(Stage::Walk);
}

/// Prepares the weights of paths with the samples' light subpaths.
#[inline(never)]
pub(in super::super) fn sum_light(job: &Job<'_>, batch: &mut Batch) {
    if batch.weights.uses_sums() {
        let first = batch.first_light();
        for i in 0..batch.samples.len() {
            let walk = batch.light.get(first + i);
            batch.light_sums.add_light(job, &walk);
        }
    }
    batch.stopwatch.end(Stage::Walk);
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

//! One run of an experiment: a render, and its record.

use super::error::ExperimentError;
use super::loaded_scene::{LoadedScene, Reference};
use super::names::file_name;
use super::observer::{Observer, Pass};
use super::{BudgetSpec, MethodSpec};
use crate::image::{Pair, Pixels};
use crate::metric::Metric;
use crate::results::{BudgetKind, Rays, Record};
use bidir::driver::{Session, Stop};
use bidir::film::Picture;
use formats::image::{ExrImage, ExrLayer};
use std::collections::BTreeMap;
use std::path::Path;

/// A render of one method in one scene under one budget and seed.
#[derive(Clone, Copy)]
pub(super) struct Run<'a> {
    pub(super) scene: &'a LoadedScene<'a>,
    pub(super) method: &'a MethodSpec,
    pub(super) budget: &'a BudgetSpec,
    pub(super) seed: u64,
}

/// A finished render.
pub(super) struct Rendered {
    picture: Picture,
    spp: u64,
    time: Moment,
    /// The part of `time` before the first pass.
    training: Moment,
    rays: Rays,
    connections_blocked: u64,
}

impl Run<'_> {
    /// Renders until the budget is used up. None: the observer stopped it.
    pub(super) fn render(
        &self,
        threads: usize,
        observer: &mut dyn Observer,
    ) -> Result<Option<Rendered>, ExperimentError> {
        let mut settings = self.method.request.apply(&self.scene.settings);
        settings.seed = self.seed;
        let mut time = Moment::default();
        let begin = Moment::now(observer);
        let flag = observer.stop_flag();
        let started = self.scene.session(settings, threads, Stop::when(&flag))?;
        let Some(mut session) = started else {
            return Ok(None);
        };
        time.add_since(begin, observer);
        let training = time;
        while self.allows_another_pass(&session, time.seconds, training.seconds) {
            if observer.should_stop() {
                return Ok(None);
            }
            let begin = Moment::now(observer);
            if !session.step(&Pass(&flag)) {
                return Ok(None);
            }
            time.add_since(begin, observer);
        }
        Ok(Some(Rendered {
            picture: session.film().develop(),
            spp: session.next_pass(),
            time,
            training,
            rays: rays(&session),
            connections_blocked: session.stats().connections_blocked,
        }))
    }

    /// Returns true if the budget allows another pass.
    fn allows_another_pass(&self, session: &Session<'_>, seconds: f64, training: f64) -> bool {
        let passes = session.next_pass();
        match self.budget.kind {
            BudgetKind::Samples => (passes as f64) < self.budget.amount,
            BudgetKind::Seconds => {
                another(passes, seconds, training, |next| next <= self.budget.amount)
            }
            BudgetKind::Rays => {
                let rays = rays(session);
                let target = self.budget.amount * self.scene.subject.view.film().crop.area() as f64;
                let now = rays.total() as f64;
                let is_nearer = |next: f64| (next - target).abs() < (now - target).abs();
                another(passes, now, rays.training as f64, is_nearer)
            }
        }
    }

    /// Makes the record of a finished render.
    pub(super) fn record(
        &self,
        rendered: &Rendered,
        reference: &Reference,
        metrics: &[Metric],
    ) -> Record {
        let metrics = distances(&rendered.picture, reference, metrics);
        let mse = metrics.get("rmse").map_or(f64::NAN, |rmse| rmse * rmse);
        Record {
            scene: self.scene.spec.name.clone(),
            method: self.method.name.clone(),
            budget: self.budget.name.clone(),
            seed: self.seed,
            spp: rendered.spp,
            seconds: rendered.time.seconds,
            processor_seconds: rendered.time.processor_seconds,
            training_seconds: Some(rendered.training.seconds),
            training_processor_seconds: rendered.training.processor_seconds,
            rays: rendered.rays,
            connections_blocked: rendered.connections_blocked,
            metrics,
            efficiency_rays: efficiency(mse, rendered.rays.total() as f64),
            efficiency_seconds: efficiency(mse, rendered.time.seconds),
            image: None,
        }
    }

    /// Returns true if `record` is of this run.
    pub(super) fn is_of(&self, record: &Record) -> bool {
        record.seed == self.seed
            && record.scene == self.scene.spec.name
            && record.method == self.method.name
            && record.budget == self.budget.name
    }

    /// Returns the name of its image, relative to the folder of the results.
    pub(super) fn image(&self) -> String {
        let names = [&self.scene.spec.name, &self.budget.name, &self.method.name];
        let [scene, budget, method] = names.map(|name| file_name(name));
        // No part contains two hyphens in a row, so different names give different files.
        format!("images/{scene}--{budget}--{method}.exr")
    }
}

impl Rendered {
    pub(super) fn pixels(&self) -> Pixels {
        pixels(&self.picture)
    }

    pub(super) fn write(&self, path: &Path) -> Result<(), ExperimentError> {
        write_image(path, &pixels(&self.picture))
    }
}

/// Time on both clocks of the host, since an arbitrary moment. Unit: seconds.
#[derive(Clone, Copy)]
struct Moment {
    seconds: f64,
    /// Of all threads. None: the host does not measure it.
    processor_seconds: Option<f64>,
}

impl Default for Moment {
    fn default() -> Self {
        Self {
            seconds: 0.0,
            processor_seconds: Some(0.0),
        }
    }
}

impl Moment {
    fn now(observer: &dyn Observer) -> Self {
        Self {
            seconds: observer.seconds(),
            processor_seconds: observer.processor_seconds(),
        }
    }

    /// Adds the time since `begin`.
    fn add_since(&mut self, begin: Self, observer: &dyn Observer) {
        let now = Self::now(observer);
        self.seconds += now.seconds - begin.seconds;
        let processors = now.processor_seconds.zip(begin.processor_seconds);
        let sum = self.processor_seconds.zip(processors);
        self.processor_seconds = sum.map(|(sum, (now, begin))| sum + now - begin);
    }
}

/// Returns true if another pass follows `passes`: always the first one, and later ones if `accepts`
/// accepts the expected cost after them. `now` is the cost so far, `training` the part before the first
/// pass.
fn another(passes: u64, now: f64, training: f64, accepts: impl Fn(f64) -> bool) -> bool {
    passes == 0 || accepts(now + (now - training) / passes as f64)
}

/// Computes 1 / (MSE · cost): zero if the error is unknown, the largest number if it is zero.
fn efficiency(mse: f64, cost: f64) -> f64 {
    let efficiency = 1.0 / (mse * cost);
    if efficiency.is_nan() {
        return 0.0;
    }
    efficiency.min(f64::MAX)
}

fn rays(session: &Session<'_>) -> Rays {
    let rays = session.stats().rays;
    let training = session.training();
    Rays {
        camera: rays.camera,
        light: rays.light,
        connection: rays.connection,
        light_image: rays.light_image,
        training: training.map_or(0, |training| training.rays.total()),
    }
}

/// Computes the metrics; values that are not finite are left out, as JSON cannot hold them.
fn distances(
    picture: &Picture,
    reference: &Reference,
    metrics: &[Metric],
) -> BTreeMap<String, f64> {
    let image = pixels(picture);
    let Some(pair) = Pair::new(&image, &reference.pixels) else {
        return BTreeMap::new();
    };
    let is_included = |metric| metric == Metric::Rmse || metrics.contains(&metric);
    let names = Metric::NAMES.into_iter();
    let names = names.filter(|(_, metric)| is_included(*metric));
    let values = names.map(|(name, metric)| (name.to_owned(), metric.value(&pair)));
    values.filter(|(_, value)| value.is_finite()).collect()
}

fn pixels(picture: &Picture) -> Pixels {
    Pixels {
        size: [picture.width, picture.height],
        data: picture.pixels.clone(),
    }
}

/// Writes an image as EXR.
pub(super) fn write_image(path: &Path, image: &Pixels) -> Result<(), ExperimentError> {
    let layers = [ExrLayer::rgb("", &image.data)];
    let image = ExrImage::whole(image.size, &layers);
    Ok(formats::image::write_exr(path, &image)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_pass_is_expected_to_cost_the_mean_of_passes() {
        assert!(another(0, 9.0, 9.0, |_| false));
        // Two passes of 3 after training of 4.
        assert!(another(2, 10.0, 4.0, |next| (next - 13.0).abs() < 1e-9));
    }

    #[test]
    fn efficiency_is_always_a_number() {
        assert!((efficiency(0.5, 4.0) - 0.5).abs() < 1e-12);
        assert!(efficiency(0.0, 4.0).is_finite() && efficiency(f64::NAN, 1.0).is_finite());
    }
}

//! One run of an experiment: a render, and its record.

use super::error::ExperimentError;
use super::loaded_scene::{LoadedScene, Reference};
use super::names::file_name;
use super::observer::{Host, Observer};
use super::{BudgetSpec, MethodSpec};
use crate::image::{Pair, Pixels};
use crate::metric::Metric;
use crate::results::{BudgetKind, Rays, Record};
use bidir::driver::{Budget, Progress, Session, Spent};
use bidir::film::Picture;
use formats::film::Render;
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
    /// The part of the time before the first pass.
    training: Moment,
    rays: Rays,
    connections_blocked: u64,
}

/// A time on both clocks of the host. Unit: seconds.
#[derive(Clone, Copy)]
struct Moment {
    seconds: f64,
    /// The processor time of all threads. None: the host does not measure it.
    processor_seconds: Option<f64>,
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
        let host = Host::new(observer);
        let processors = || host.with(|observer| observer.processor_seconds());
        let begin = processors();
        let moment = |render: &Render| Moment {
            seconds: render.spent.total.as_secs_f64(),
            processor_seconds: processors().zip(begin).map(|(now, begin)| now - begin),
        };
        let Some(mut render) = self.scene.begin(&settings, threads, &host)? else {
            return Ok(None);
        };
        let training = moment(&render);
        let is_of_samples = self.budget.kind == BudgetKind::Samples;
        let budget = Budget {
            passes: is_of_samples.then_some(self.budget.amount.ceil() as u64),
            ..Budget::default()
        };
        let goes_on = &mut |render: &Render| self.allows_another_pass(render);
        if render.run(&budget, &host, goes_on).is_none() && host.stop().is_asked() {
            return Ok(None);
        }
        let time = moment(&render);
        Ok(Some(Rendered {
            picture: render.session.film().develop(),
            spp: render.spent.passes,
            time,
            training,
            rays: rays(&render.session),
            connections_blocked: render.session.stats().connections_blocked,
        }))
    }

    /// Returns true if the budget allows another pass.
    fn allows_another_pass(&self, render: &Render) -> bool {
        let Spent {
            passes,
            total,
            rendering,
        } = render.spent;
        let amount = self.budget.amount;
        match self.budget.kind {
            BudgetKind::Samples => true,
            BudgetKind::Seconds => {
                let [total, rendering] = [total, rendering].map(|time| time.as_secs_f64());
                total + rendering / passes as f64 <= amount
            }
            BudgetKind::Rays => {
                let rays = rays(&render.session);
                let target = amount * self.scene.subject.view.film().crop.area() as f64;
                let now = rays.total() as f64;
                let next = now + (now - rays.training as f64) / passes as f64;
                (next - target).abs() < (now - target).abs()
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

    /// Returns the name of the run's image, relative to the folder of the results.
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

/// Computes the metrics by name. Leaves out values that are not finite, as JSON cannot hold them.
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
    fn efficiency_is_always_a_number() {
        assert!((efficiency(0.5, 4.0) - 0.5).abs() < 1e-12);
        assert!(efficiency(0.0, 4.0).is_finite() && efficiency(f64::NAN, 1.0).is_finite());
    }
}

//! One run of an experiment: a render, and its record.

use super::error::ExperimentError;
use super::loaded_scene::LoadedScene;
use super::names::file_name;
use super::observer::{Host, Observer};
use super::{BudgetSpec, Experiment, MethodSpec, SceneSpec};
use crate::image::{Pair, Pixels};
use crate::metric::Metric;
use crate::results::{BudgetKind, Rays, Record, RunId};
use bidir::driver::{Budget, Progress, Session, Spent};
use formats::film::Render;
use formats::image::{ExrImage, ExrLayer};
use std::collections::BTreeMap;
use std::path::Path;

/// A render of one method in one scene under one budget and seed.
#[derive(Clone, Copy)]
pub(super) struct Run<'a> {
    pub(super) experiment: &'a Experiment,
    pub(super) scene: &'a LoadedScene<'a>,
    pub(super) method: &'a MethodSpec,
    pub(super) budget: &'a BudgetSpec,
    pub(super) seed: u64,
}

/// A finished run.
#[derive(Clone, Debug)]
pub struct Done {
    /// The record.
    pub record: Record,
    /// The image. None: the run has not the first seed.
    pub image: Option<Pixels>,
}

/// A time on both clocks of the host. Unit: seconds.
#[derive(Clone, Copy)]
struct Moment {
    seconds: f64,
    /// The processor time of all threads. None: the host does not measure it.
    processor_seconds: Option<f64>,
}

impl Run<'_> {
    /// Renders until the budget is used up, and compares the image with `reference`. None: the observer stopped it.
    pub(super) fn render(
        &self,
        reference: &Pixels,
        observer: &mut dyn Observer,
    ) -> Result<Option<Done>, ExperimentError> {
        let mut settings = self.method.request.apply(&self.scene.settings);
        settings.seed = self.seed;
        let host = Host::new(observer);
        let processors = || host.with(|observer| observer.processor_seconds());
        let begin = processors();
        let moment = |render: &Render| Moment {
            seconds: render.spent.total.as_secs_f64(),
            processor_seconds: processors().zip(begin).map(|(now, begin)| now - begin),
        };
        let threads = self.experiment.threads;
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
        let times = [training, moment(&render)];
        Ok(Some(self.done(&render, times, reference)))
    }

    /// Makes the record of a finished render; `times` are those after training and at the end.
    fn done(&self, render: &Render, times: [Moment; 2], reference: &Pixels) -> Done {
        let picture = render.session.film().develop();
        let image = Pixels {
            size: [picture.width, picture.height],
            data: picture.pixels,
        };
        let metrics = distances(&image, reference, &self.experiment.metrics);
        let mse = metrics.get("rmse").map_or(f64::NAN, |rmse| rmse * rmse);
        let [training, all] = times;
        let rays = rays(&render.session);
        let has_image = self.seed == self.experiment.seeds.first;
        let (scene, method, budget) = (self.scene.spec, self.method, self.budget);
        let record = Record {
            scene: scene.name.clone(),
            method: method.name.clone(),
            budget: budget.name.clone(),
            seed: self.seed,
            spp: render.spent.passes,
            seconds: all.seconds,
            processor_seconds: all.processor_seconds,
            training_seconds: Some(training.seconds),
            training_processor_seconds: training.processor_seconds,
            rays,
            connections_blocked: render.session.stats().connections_blocked,
            metrics,
            efficiency_rays: efficiency(mse, rays.total() as f64),
            efficiency_seconds: efficiency(mse, all.seconds),
            image: has_image.then(|| image_name(scene, budget, method)),
        };
        Done {
            record,
            image: has_image.then_some(image),
        }
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

    /// Returns the names and the seed that identify the run.
    pub(super) fn id(&self) -> RunId<'_> {
        RunId {
            scene: &self.scene.spec.name,
            method: &self.method.name,
            budget: &self.budget.name,
            seed: self.seed,
        }
    }
}

/// Returns the name of the image of runs, relative to the folder of the results.
pub(super) fn image_name(scene: &SceneSpec, budget: &BudgetSpec, method: &MethodSpec) -> String {
    let names = [&scene.name, &budget.name, &method.name];
    // No part contains two hyphens in a row, so different names give different files.
    let [scene, budget, method] = names.map(|name| file_name(name));
    format!("images/{scene}--{budget}--{method}.exr")
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
fn distances(image: &Pixels, reference: &Pixels, metrics: &[Metric]) -> BTreeMap<String, f64> {
    let Some(pair) = Pair::new(image, reference) else {
        return BTreeMap::new();
    };
    let is_included = |metric| metric == Metric::Rmse || metrics.contains(&metric);
    let names = Metric::NAMES.into_iter();
    let included = names.filter(|(_, metric)| is_included(*metric));
    let values = included.map(|(name, metric)| (name.to_owned(), metric.value(&pair)));
    values.filter(|(_, value)| value.is_finite()).collect()
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

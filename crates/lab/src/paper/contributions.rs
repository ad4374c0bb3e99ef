//! Figure 2: how large the contributions C_ij are that a shadow ray may bring.
//!
//! C_ij is what connection (i, j) adds if nothing is in the way, as the sum of the estimate has it:
//! with its weight. Beside them stand the contributions without weights, f / p. Both are luminances
//! of the terms that are not zero; the others need no ray.

use crate::statistics::{Interval, mean_interval};
use bidir::driver::Settings;
use bidir::integrator::{IntegratorKind, Journal, Link, LvcSettings, Sample, Workspace};
use bidir::path::{Connections, PathContext};
use bidir::sampler::{Domain, Sampler};
use bidir::scene::Scene;
use bidir::select::ShadowRays;
use rayon::prelude::*;

/// Numbers of passes that are independent of each other.
#[derive(Clone, Debug, Default)]
pub struct Values {
    /// All of them, in ascending order.
    pub all: Vec<f64>,
    /// Those of each pass, in ascending order.
    pub passes: Vec<Vec<f64>>,
}

impl Values {
    /// The numbers of these passes.
    pub fn new(mut passes: Vec<Vec<f64>>) -> Self {
        for pass in &mut passes {
            pass.sort_unstable_by(f64::total_cmp);
        }
        let mut all = passes.concat();
        all.sort_unstable_by(f64::total_cmp);
        Self { all, passes }
    }

    /// The mean of a statistic over passes. None: of a single pass.
    pub fn interval(&self, statistic: impl Fn(&[f64]) -> f64, confidence: f64) -> Option<Interval> {
        let values: Vec<f64> = self.passes.iter().map(|pass| statistic(pass)).collect();
        mean_interval(&values, confidence)
    }
}

/// The contributions of all connections of some samples.
#[derive(Clone, Debug)]
pub struct Contributions {
    /// With weights.
    pub weighted: Values,
    /// Without weights.
    pub unweighted: Values,
    /// Samples taken.
    pub samples: u64,
}

impl Contributions {
    /// The contributions of `passes` samples of every pixel.
    pub fn measure(scene: &Scene, settings: &Settings, passes: u64) -> Self {
        let crop = scene.film().crop;
        let parts: Vec<_> = (0..passes)
            .into_par_iter()
            .map(|pass| pass_of(scene, settings, pass))
            .collect();
        let values = |i: usize| {
            let pass = |terms: &Vec<[f64; 2]>| terms.iter().map(|term| term[i]).collect();
            Values::new(parts.iter().map(pass).collect())
        };
        Self {
            weighted: values(1),
            unweighted: values(0),
            samples: passes * crop.area(),
        }
    }
}

/// The terms of a sample of every pixel, without and with weight.
fn pass_of(scene: &Scene, settings: &Settings, pass: u64) -> Vec<[f64; 2]> {
    let film = scene.film();
    let sampler = Sampler::new(settings.sampler, settings.seed);
    let context = PathContext {
        scene,
        settings: &settings.path,
        wavelengths: scene.color().sample_wavelengths(0.5),
        connections: Connections::ONE_SUBPATH,
    };
    let integrator =
        IntegratorKind::Bdpt.integrator(ShadowRays::All.selector(0.0), &LvcSettings::default());
    let mut workspace = Workspace::default();
    workspace.journal = Some(Journal::default());
    let mut terms = Vec::new();
    for i in 0..film.crop.area() {
        let camera = sampler.stream(Domain::Camera, i, pass);
        let sample = Sample {
            pass,
            pixel: film.crop.pixel(i as usize),
            ray: camera,
            camera,
            light: sampler.stream(Domain::Light, 0, pass * film.light_paths() + i),
        };
        integrator.sample(&context, &sample, &mut workspace);
        let entries = workspace.journal.iter().flat_map(|j| &j.entries);
        let connections = entries.filter(|entry| matches!(entry.link, Link::Connection(_)));
        terms.extend(connections.map(|entry| {
            let luminance = |value| f64::from(scene.color().luminance(value, &context.wavelengths));
            [entry.term.contribution, entry.term.value()].map(luminance)
        }));
    }
    terms.retain(|term| term.iter().all(|c| *c > 0.0 && c.is_finite()));
    terms
}

/// The value below which the part `part` of ascending `values` lies. None: there is none.
pub fn quantile(values: &[f64], part: f64) -> Option<f64> {
    let index = (part * values.len() as f64) as usize;
    values.get(index.min(values.len().checked_sub(1)?)).copied()
}

/// Orders of magnitude between the quantiles `tail` and 1 - `tail`. None: there are no values.
pub fn decades(values: &[f64], tail: f64) -> Option<f64> {
    let (low, high) = (quantile(values, tail)?, quantile(values, 1.0 - tail)?);
    Some(libm::log10(high / low))
}

/// The share of the sum that the largest part `part` of ascending `values` has.
pub fn share_of_largest(values: &[f64], part: f64) -> f64 {
    let small = ((1.0 - part) * values.len() as f64) as usize;
    let total: f64 = values.iter().sum();
    values[small.min(values.len())..].iter().sum::<f64>() / total
}

/// The largest contributions, of which no more are needed, as a part of all, to have `share` of the
/// sum of ascending `values`.
pub fn part_with(values: &[f64], share: f64) -> f64 {
    let enough = share * values.iter().sum::<f64>();
    let mut sum = 0.0;
    let count = values.iter().rev().take_while(|value| {
        let more = sum < enough;
        sum += **value;
        more
    });
    count.count() as f64 / values.len() as f64
}

/// Parts of ascending `values` by log10: for each bin its left edge and the part of all values in it,
/// with `bins` bins per order of magnitude.
pub fn histogram(values: &[f64], bins: u32) -> Vec<[f64; 2]> {
    let bin = |value: &f64| (libm::log10(*value) * f64::from(bins)).floor() as i64;
    let (Some(first), Some(last)) = (values.first().map(bin), values.last().map(bin)) else {
        return Vec::new();
    };
    let mut counts = vec![0u64; (last - first + 1) as usize];
    for value in values {
        counts[(bin(value) - first) as usize] += 1;
    }
    let point = |(i, count): (usize, &u64)| {
        let edge = (first + i as i64) as f64 / f64::from(bins);
        [edge, *count as f64 / values.len() as f64]
    };
    counts.iter().enumerate().map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-9, "{found}, not {expected}");
    }

    #[test]
    fn values_are_summed_up_as_by_hand() {
        let values = [0.001, 0.01, 0.1, 1.0, 8.889];
        check(decades(&values, 0.0).unwrap(), libm::log10(8889.0));
        check(decades(&values, 0.2).unwrap(), libm::log10(888.9));
        check(share_of_largest(&values, 0.2), 0.8889);
        check(part_with(&values, 0.88), 0.2);
        check(part_with(&values, 0.9), 0.4);
        assert_eq!(quantile(&[], 0.5), None);
    }

    #[test]
    fn every_value_is_in_a_bin() {
        let bins = histogram(&[0.002, 0.003, 0.5, 20.0], 1);
        let edges: Vec<f64> = bins.iter().map(|bin| bin[0]).collect();
        assert_eq!(edges.len(), 5);
        check(edges[0], -3.0);
        check(bins[0][1], 0.5);
        check(bins[1][1], 0.0);
        check(bins.iter().map(|bin| bin[1]).sum(), 1.0);
        assert!(histogram(&[], 4).is_empty());
    }
}

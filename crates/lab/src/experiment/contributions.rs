//! The distribution of the contributions C_ij of connections before visibility.
//!
//! C_ij is the weighted term of connection (i, j) in the estimate if its shadow ray is unoccluded;
//! unweighted contributions are f / p. Both are luminances. Terms that are zero need no shadow ray and do
//! not count. Every pass of a bidirectional method gives one value of each of the [`FIGURES`], so that
//! claims treat passes like seeds.

use super::error::ExperimentError;
use super::loaded_scene::LoadedScene;
use super::{Experiment, MethodSpec, is_in};
use crate::results::Contributions;
use bidir::driver::Settings;
use bidir::integrator::{Batch, Method, Sample};
use bidir::path::Job;
use bidir::sampler::{Domain, Sampler};
use bidir::select::ShadowRays;
use formats::film::Subject;
use rayon::prelude::*;

/// The methods and scenes whose contributions are measured.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ContributionsSpec {
    /// The names of the methods; their integrator is `bdpt`.
    pub methods: Vec<String>,
    /// The names of the scenes; empty: all.
    pub scenes: Vec<String>,
    /// Samples per pixel, each an independent pass.
    pub spp: u64,
}

macro_rules! figures {
    ($($name:literal)*) => {
        [$(concat!("contributions", $name)),*, $(concat!("unweighted contributions", $name)),*]
    };
}

/// The names of the numbers of a pass. The numbers of the second half are computed without weights.
pub const FIGURES: [&str; 18] = figures![
    " per sample"
    ": orders of magnitude"
    ": share of the largest tenth"
    ": log10 of the least"
    ": log10 of the quantile 1 %"
    ": log10 of the median"
    ": log10 of the quantile 99 %"
    ": log10 of the largest"
    ": part that makes 90 % of the sum"
];

/// Bins of histograms per order of magnitude.
const BINS: u32 = 2;

impl Contributions {
    /// Returns the histogram for a figure: of weighted or unweighted contributions. Each bin is the left edge
    /// in log10, and the fraction of all contributions in the bin.
    pub fn histogram(&self, figure: &str) -> &[[f64; 2]] {
        if figure.starts_with("unweighted") {
            &self.unweighted
        } else {
            &self.weighted
        }
    }
}

/// Measures the contributions of the description's methods and scenes.
pub(super) fn measure(
    experiment: &Experiment,
    scenes: &[LoadedScene<'_>],
) -> Result<Vec<Contributions>, ExperimentError> {
    let Some(spec) = &experiment.contributions else {
        return Ok(Vec::new());
    };
    let mut all = Vec::new();
    for loaded in scenes
        .iter()
        .filter(|loaded| is_in(&spec.scenes, &loaded.spec.name))
    {
        let methods = experiment.methods.iter();
        for method in methods.filter(|method| spec.methods.contains(&method.name)) {
            all.push(of_method(loaded, method, spec.spp)?);
        }
    }
    Ok(all)
}

fn of_method(
    loaded: &LoadedScene<'_>,
    method: &MethodSpec,
    spp: u64,
) -> Result<Contributions, ExperimentError> {
    let settings = loaded.bidirectional(method, "contributions")?;
    let numbers = (0..spp).into_par_iter();
    let passes: Vec<_> = numbers.map(|pass| terms(loaded, &settings, pass)).collect();
    let samples = loaded.subject.view.film().crop.area() as f64;
    let figures = |terms: &[Vec<f64>; 2]| {
        let numbers = terms.each_ref().map(|values| figures(values, samples));
        let names = FIGURES.iter().map(|name| (*name).to_owned());
        let pairs = names.zip(numbers.concat());
        pairs.filter(|(_, number)| number.is_finite()).collect()
    };
    let [weighted, unweighted] = [0, 1].map(|which| {
        let all: Vec<_> = passes.iter().map(|terms| &terms[which][..]).collect();
        histogram(&sorted(all.concat()))
    });
    Ok(Contributions {
        scene: loaded.spec.name.clone(),
        method: method.name.clone(),
        passes: passes.iter().map(figures).collect(),
        weighted,
        unweighted,
    })
}

fn sorted(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_unstable_by(f64::total_cmp);
    values
}

/// Computes the [`FIGURES`] of the ascending values of `samples` samples.
fn figures(values: &[f64], samples: f64) -> [f64; FIGURES.len() / 2] {
    let log = |part| quantile(values, part).map_or(f64::NAN, libm::log10);
    [
        values.len() as f64 / samples,
        log(0.99) - log(0.01),
        share_of_largest(values, 0.1),
        log(0.0),
        log(0.01),
        log(0.5),
        log(0.99),
        log(1.0),
        part_with(values, 0.9),
    ]
}

/// Takes one sample of every pixel. Returns the terms of all connections, with and without their weights, ascending.
fn terms(loaded: &LoadedScene<'_>, settings: &Settings, pass: u64) -> [Vec<f64>; 2] {
    let Subject { scene, view, .. } = &loaded.subject;
    let film = view.film();
    let sampler = Sampler::new(settings.sampler, settings.seed);
    let job = Job::of_own_subpaths(scene, view, &settings.path);
    let method = Method::Bdpt(ShadowRays::All.selector(0.0));
    let mut batch = Batch::default();
    let mut terms: Vec<[f64; 2]> = Vec::new();
    for i in 0..film.crop.area() {
        let pixel = film.crop.pixel(i as usize);
        let camera = sampler.stream(Domain::Camera, i, pass);
        let light = sampler.stream(Domain::Light, 0, pass * film.pixel_count() + i);
        batch.fill([Sample::new(pass, pixel, camera, light)]);
        method.run(&job, &mut batch);
        terms.extend(batch.candidates.offered.iter().map(|candidate| {
            let term = &candidate.term;
            let luminance = |value| f64::from(job.lanes.luminance(value));
            [term.value(), term.contribution].map(luminance)
        }));
    }
    terms.retain(|term| term.iter().all(|c| *c > 0.0 && c.is_finite()));
    [0, 1].map(|which| sorted(terms.iter().map(|term| term[which]).collect()))
}

/// Returns the quantile `part` of ascending `values`. None: there are no values.
fn quantile(values: &[f64], part: f64) -> Option<f64> {
    let index = (part * values.len() as f64) as usize;
    values.get(index.min(values.len().checked_sub(1)?)).copied()
}

/// Computes the share of the sum of ascending `values` that is due to the largest ones, a fraction `part` of all.
fn share_of_largest(values: &[f64], part: f64) -> f64 {
    let small = ((1.0 - part) * values.len() as f64) as usize;
    let total: f64 = values.iter().sum();
    values[small.min(values.len())..].iter().sum::<f64>() / total
}

/// Computes the smallest fraction of ascending `values` that makes up `share` of their sum.
fn part_with(values: &[f64], share: f64) -> f64 {
    let enough = share * values.iter().sum::<f64>();
    let mut sum = 0.0;
    let count = values.iter().rev().take_while(|value| {
        let more = sum < enough;
        sum += **value;
        more
    });
    count.count() as f64 / values.len() as f64
}

/// Makes the histogram of log10 of ascending `values`: the left edge of each bin, and the fraction of all
/// values in the bin.
fn histogram(values: &[f64]) -> Vec<[f64; 2]> {
    let bin = |value: &f64| (libm::log10(*value) * f64::from(BINS)).floor() as i64;
    let (Some(first), Some(last)) = (values.first().map(bin), values.last().map(bin)) else {
        return Vec::new();
    };
    let mut counts = vec![0u64; (last - first + 1) as usize];
    for value in values {
        counts[(bin(value) - first) as usize] += 1;
    }
    let point = |(i, count): (usize, &u64)| {
        let edge = (first + i as i64) as f64 / f64::from(BINS);
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
    fn figures_are_as_computed_by_hand() {
        let values = [0.001, 0.01, 0.1, 1.0, 8.889];
        let figures = figures(&values, 10.0);
        check(figures[0], 0.5);
        check(figures[1], libm::log10(8889.0));
        check(figures[5], -1.0);
        check(figures[8], 0.4);
        check(share_of_largest(&values, 0.2), 0.8889);
        check(part_with(&values, 0.88), 0.2);
        assert_eq!(quantile(&[], 0.5), None);
    }

    #[test]
    fn every_value_is_in_a_bin() {
        let bins = histogram(&[0.002, 0.003, 0.5, 20.0]);
        check(bins[0][0], -3.0);
        check(bins[0][1], 0.5);
        check(bins[1][1], 0.0);
        check(bins.last().unwrap()[0], 1.0);
        check(bins.iter().map(|bin| bin[1]).sum(), 1.0);
        assert!(histogram(&[]).is_empty());
    }
}

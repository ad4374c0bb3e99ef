#![allow(dead_code, reason = "every test file uses a part of this module")]
#![allow(
    clippy::print_stderr,
    reason = "the comparisons are shown when asked for"
)]
//! Do two estimators have the same expectation? Welch's t-test on means of pixels, blocks, films.
//!
//! Each estimator renders independent replicates (other seeds, independent sampler), and the
//! comparison asks at several resolutions: a bias of the whole image shows in the film's mean, a
//! local one in blocks, a bias of one pixel in that pixel. The level is shared among resolutions,
//! and within each the smallest p-value is corrected for the number of means [Sidak67]. The
//! variance is that of both film layers together. Means over whole renders are close to normal
//! even where single samples have heavy tails; where pixels are not, blocks are asked alone.
//!
//! The variable BIDIR_TEST_SHOW prints what every comparison found; see CONTRIBUTING.md for the
//! others.

mod maps;

use bidir::driver::{Resources, Settings, render};
use bidir::film::Film;
use bidir::sampler::SamplerKind;
use bidir::scene::Scene;
use bidir::spectrum::Rgb;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Replicates of each estimator.
const REPLICATES: usize = 32;
/// The level of a whole comparison, the probability that equal estimators are called different, where
/// BIDIR_TEST_LEVEL does not set it.
const LEVEL: f64 = 1e-3;
/// The relative bias that every comparison must be able to see.
pub(crate) const BIAS: f64 = 0.02;
/// A block as large as any film.
pub(crate) const WHOLE: usize = usize::MAX;

/// A picture of every replicate.
#[derive(Clone)]
pub(crate) struct Replicates {
    width: usize,
    height: usize,
    pictures: Vec<Vec<[f64; 3]>>,
}

/// Renders the replicates of an estimator, which share `passes`. Other seeds in `settings` give other
/// replicates.
pub(crate) fn replicates(scene: &Scene, settings: &Settings, passes: u64) -> Replicates {
    replicates_of(scene, settings, passes, |film| film.develop().pixels)
}

/// The same, of an image that `develop` makes of a film, pixel by pixel.
pub(crate) fn replicates_of(
    scene: &Scene,
    settings: &Settings,
    passes: u64,
    develop: impl Fn(&Film) -> Vec<Rgb>,
) -> Replicates {
    let [replicates] = replicates_of_each(scene, settings, passes, |film| [develop(film)]);
    replicates
}

/// The same, of several images of each film.
pub(crate) fn replicates_of_each<const N: usize>(
    scene: &Scene,
    settings: &Settings,
    passes: u64,
    develop: impl Fn(&Film) -> [Vec<Rgb>; N],
) -> [Replicates; N] {
    let passes = (passes * effort()).div_ceil(REPLICATES as u64);
    // A pass of so small a film is over before a second thread is awake.
    let resources = Resources {
        threads: 1,
        ..Resources::default()
    };
    let crop = scene.film().crop;
    let mut of_each = [(); N].map(|()| Replicates {
        width: crop.width() as usize,
        height: crop.height() as usize,
        pictures: Vec::with_capacity(REPLICATES),
    });
    for replicate in 0..REPLICATES as u64 {
        let settings = Settings {
            seed: (settings.seed.wrapping_mul(1000).wrapping_add(first_seed())).wrapping_mul(1000)
                + replicate,
            sampler: SamplerKind::Independent,
            ..settings.clone()
        };
        let film = render(scene, &settings, passes, &resources).expect("the film is small");
        for (replicates, pixels) in of_each.iter_mut().zip(develop(&film)) {
            let picture = pixels.iter().map(|pixel| pixel.map(f64::from));
            replicates.pictures.push(picture.collect());
        }
    }
    of_each
}

impl Replicates {
    /// An estimator without variance: `value` everywhere, of the size of `self`.
    pub(crate) fn exactly(&self, value: [f64; 3]) -> Self {
        let picture = vec![value; self.width * self.height];
        Self {
            pictures: vec![picture; self.pictures.len()],
            ..*self
        }
    }

    /// Mean of all pixels and channels.
    pub(crate) fn mean(&self) -> f64 {
        let values = self.pictures.iter().flatten().flatten();
        values.sum::<f64>() / (self.pictures.len() * self.width * self.height * 3) as f64
    }

    fn scaled(&self, factor: f64) -> Self {
        let scale = |pixel: &[f64; 3]| pixel.map(|value| value * factor);
        let pixels = |picture: &Vec<_>| picture.iter().map(scale).collect();
        Self {
            pictures: self.pictures.iter().map(pixels).collect(),
            ..*self
        }
    }

    /// Means over blocks of `block` × `block` pixels and each channel, for one replicate.
    fn block_means(&self, replicate: usize, block: usize) -> Vec<f64> {
        let block = block.min(self.width.max(self.height));
        let columns = self.width.div_ceil(block);
        let rows = self.height.div_ceil(block);
        let mut sums = vec![(0.0, 0.0); columns * rows * 3];
        for (i, pixel) in self.pictures[replicate].iter().enumerate() {
            let (x, y) = (i % self.width / block, i / self.width / block);
            for (channel, value) in pixel.iter().enumerate() {
                let sum = &mut sums[(y * columns + x) * 3 + channel];
                *sum = (sum.0 + value, sum.1 + 1.0);
            }
        }
        sums.into_iter().map(|(sum, n)| sum / n).collect()
    }

    /// The mean over replicates and the variance of that mean, of every block and channel.
    fn moments(&self, block: usize) -> Vec<Moments> {
        let replicates = 0..self.pictures.len();
        let means: Vec<Vec<f64>> = replicates.map(|r| self.block_means(r, block)).collect();
        let of = |i: usize| Moments::of(means.iter().map(|replicate| replicate[i]));
        (0..means[0].len()).map(of).collect()
    }
}

/// An estimate of a mean.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moments {
    mean: f64,
    /// Of the mean, not of the values.
    variance: f64,
}

impl Moments {
    fn of(values: impl Iterator<Item = f64> + Clone) -> Self {
        let n = values.clone().count() as f64;
        let mean = values.clone().sum::<f64>() / n;
        let square = values.map(|value| (value - mean) * (value - mean));
        Self {
            mean,
            variance: square.sum::<f64>() / (n - 1.0) / n,
        }
    }
}

/// The two-sided p-value of Welch's t-test.
fn welch(a: Moments, b: Moments) -> f64 {
    let variance = a.variance + b.variance;
    let scale = a.mean.abs() + b.mean.abs();
    // Estimators without variance must agree to rounding.
    if variance.sqrt() <= 1e-6 * scale {
        return f64::from((a.mean - b.mean).abs() <= 1e-5 * scale);
    }
    let squares = a.variance * a.variance + b.variance * b.variance;
    let freedom = variance * variance / squares * (REPLICATES as f64 - 1.0);
    let t = (a.mean - b.mean) / variance.sqrt();
    let distribution = StudentsT::new(0.0, 1.0, freedom).expect("freedom is positive");
    2.0 * distribution.cdf(-t.abs())
}

/// What a comparison found where two estimators differ most.
#[derive(Clone, Copy, Debug)]
#[expect(dead_code, reason = "shown when a test fails")]
struct Verdict {
    /// Corrected for the number of means and of resolutions.
    p: f64,
    block: usize,
    index: usize,
    means: [f64; 2],
}

/// 1 - (1 - p)ⁿ, exact for small p too [Sidak67].
fn corrected(p: f64, n: usize) -> f64 {
    -libm::expm1(n as f64 * libm::log1p(-p))
}

/// Of each block and channel the p-value, corrected for their number, and the means.
fn tests(a: &Replicates, b: &Replicates, block: usize) -> Vec<(f64, [f64; 2])> {
    let (a, b) = (a.moments(block), b.moments(block));
    let n = a.len();
    let test = |(x, y): (Moments, Moments)| (corrected(welch(x, y), n), [x.mean, y.mean]);
    a.into_iter().zip(b).map(test).collect()
}

/// Where two estimators differ most, at any of the resolutions.
fn compare(a: &Replicates, b: &Replicates, blocks: &[usize]) -> Verdict {
    let at = |block: usize| {
        let tests = tests(a, b, block).into_iter().enumerate();
        let least = tests.min_by(|(_, x), (_, y)| x.0.total_cmp(&y.0));
        let (index, (p, means)) = least.expect("a block");
        Verdict {
            p: corrected(p, blocks.len()),
            block,
            index,
            means,
        }
    };
    let verdicts = blocks.iter().map(|block| at(*block));
    let smallest = verdicts.min_by(|x, y| x.p.total_cmp(&y.p));
    smallest.expect("a comparison has a resolution")
}

/// Checks that two estimators agree in blocks of all the given sizes, and that the same test
/// would see [`BIAS`].
#[track_caller]
pub(crate) fn check_agree(name: &str, a: &Replicates, b: &Replicates, blocks: &[usize]) {
    check_agree_to(name, a, b, blocks, BIAS);
}

/// True where two estimators agree at the level of one comparison, which would see [`BIAS`].
pub(crate) fn agree(a: &Replicates, b: &Replicates, blocks: &[usize]) -> bool {
    compare(a, b, blocks).p > level() && compare_biased(a, b, blocks, BIAS).p < level()
}

/// [`compare`], had the first a relative `bias`.
fn compare_biased(a: &Replicates, b: &Replicates, blocks: &[usize], bias: f64) -> Verdict {
    compare(&a.scaled(1.0 + bias), b, blocks)
}

/// As [`check_agree`], for another `bias` that must be seen.
#[track_caller]
pub(crate) fn check_agree_to(
    name: &str,
    a: &Replicates,
    b: &Replicates,
    blocks: &[usize],
    bias: f64,
) {
    let verdict = compare(a, b, blocks);
    if verdict.p <= level() {
        let maps = maps::write(name, a, b);
        panic!("{name}: {verdict:?}; {maps}");
    }
    if std::env::var_os("BIDIR_TEST_SHOW").is_some() {
        let seen = smallest_seen(a, b, blocks);
        eprintln!("{name}: {verdict:?}, sees a relative bias of {seen:.4}");
    }
    let biased = compare_biased(a, b, blocks, bias);
    assert!(
        biased.p < level(),
        "{name}: blind to a relative bias of {bias}: {biased:?}"
    );
}

/// The blocks of `block` × `block` pixels in which two estimators look different at the level of one
/// comparison: left, top, right, bottom.
pub(crate) fn suspects(a: &Replicates, b: &Replicates, block: usize) -> Vec<[u32; 4]> {
    let columns = a.width.div_ceil(block);
    let tests = tests(a, b, block).into_iter().enumerate();
    let differing = tests.filter(|(_, (p, _))| *p <= level());
    // Of a mean of each channel.
    let mut blocks: Vec<_> = differing.map(|(i, _)| i / 3).collect();
    blocks.dedup();
    let rect = |i: usize| {
        let [left, top] = [i % columns * block, i / columns * block];
        let [right, bottom] = [(left + block).min(a.width), (top + block).min(a.height)];
        [left, top, right, bottom].map(|at| at as u32)
    };
    blocks.into_iter().map(rect).collect()
}

/// Checks that the means of whole films agree, and that these or [`suspects`] would show [`BIAS`].
#[track_caller]
pub(crate) fn check_means(name: &str, a: &Replicates, b: &Replicates, block: usize) {
    let verdict = compare(a, b, &[WHOLE]);
    assert!(verdict.p > level(), "{name}: {verdict:?}");
    let biased = a.scaled(1.0 + BIAS);
    let is_seen = compare(&biased, b, &[WHOLE]).p <= level();
    assert!(
        is_seen || !suspects(&biased, b, block).is_empty(),
        "{name}: blind to {BIAS}"
    );
}

/// The smallest relative bias, to a tenth of itself, that a comparison would see.
fn smallest_seen(a: &Replicates, b: &Replicates, blocks: &[usize]) -> f64 {
    let mut bias = 1e-4;
    while bias < 1.0 && compare_biased(a, b, blocks, bias).p >= level() {
        bias *= 1.1;
    }
    bias
}

/// How many times the usual passes tests render: the variable BIDIR_TEST_EFFORT, else 1.
fn effort() -> u64 {
    variable("BIDIR_TEST_EFFORT").unwrap_or(1).max(1)
}

/// Where comparisons fail: the variable BIDIR_TEST_LEVEL, else [`LEVEL`].
fn level() -> f64 {
    let variable = std::env::var("BIDIR_TEST_LEVEL").ok();
    variable.map_or(LEVEL, |text| text.parse().expect("a level is a number"))
}

/// Where the seeds of replicates begin: the variable BIDIR_TEST_SEED, else 0.
fn first_seed() -> u64 {
    variable("BIDIR_TEST_SEED").unwrap_or(0)
}

/// A whole number from the environment.
fn variable(name: &str) -> Option<u64> {
    let text = std::env::var(name).ok()?;
    Some(
        text.parse()
            .unwrap_or_else(|_| panic!("{name}={text} is not a whole number")),
    )
}

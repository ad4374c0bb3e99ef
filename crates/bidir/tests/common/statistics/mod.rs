#![allow(dead_code, reason = "every test file uses a part of this module")]
#![allow(
    clippy::print_stderr,
    reason = "the comparisons are shown when asked for"
)]
//! Do two estimators have the same expectation? T-tests on means of pixels, blocks, films.
//!
//! Each estimator renders independent replicates, and the comparison looks at several resolutions: a
//! bias of the whole image shows in the film's mean, a local one in blocks, a bias of one pixel in that
//! pixel. The level is shared among resolutions, and within each the smallest p-value is corrected for
//! the number of means [Sidak67]. The variance is that of both film layers together. Means over whole
//! renders are close to normal even where single samples have heavy tails; where pixels are not, blocks
//! are compared alone.
//!
//! Replicates are runs of passes, far apart, of a few sessions, and the sampler is independent. Given the
//! training of its session an estimator has to be unbiased, so replicates need no training of their own.
//! Random numbers are addressed, so two estimators that make the same subpaths have nearly the same noise
//! in replicates of the same number: [`check_paired`] compares these one by one (common random numbers),
//! and needs a fraction of the samples of [`check_agree`], which is for estimators that share little.
//!
//! The variable BIDIR_TEST_SHOW prints the result of every comparison; see CONTRIBUTING.md for the
//! others.

mod maps;
mod t_test;

use bidir::driver::{Resources, Session, Settings};
use bidir::film::Film;
use bidir::sampler::SamplerKind;
use bidir::scene::Scene;
use bidir::spectrum::Rgb;
use bidir::view::View;
use t_test::{Moments, RandomNumbers, corrected, p_value};

/// A scene, and the view of it that is rendered.
#[derive(Clone, Copy)]
pub(crate) struct Shown<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) view: &'a View,
}

/// Replicates of each estimator.
const REPLICATES: usize = 32;
/// Sessions that these are rendered by, each with a seed and a training of its own.
const SESSIONS: usize = 2;
/// The passes from the beginning of a session's replicate to that of the next.
const STRIDE: u64 = 1 << 24;
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
pub(crate) fn replicates<'a>(
    shown: impl Into<Shown<'a>>,
    settings: &Settings,
    passes: u64,
) -> Replicates {
    replicates_of(shown, settings, passes, |film| film.develop().pixels)
}

/// The same, of an image that `develop` makes of a film, pixel by pixel.
pub(crate) fn replicates_of<'a>(
    shown: impl Into<Shown<'a>>,
    settings: &Settings,
    passes: u64,
    develop: impl Fn(&Film) -> Vec<Rgb>,
) -> Replicates {
    let [replicates] = replicates_of_each(shown, settings, passes, |film| [develop(film)]);
    replicates
}

/// The same, of several images of each film.
pub(crate) fn replicates_of_each<'a, const N: usize>(
    shown: impl Into<Shown<'a>>,
    settings: &Settings,
    passes: u64,
    develop: impl Fn(&Film) -> [Vec<Rgb>; N],
) -> [Replicates; N] {
    let passes = (passes * effort()).div_ceil(REPLICATES as u64);
    let shown = shown.into();
    let crop = shown.view.film().crop;
    let mut of_each = [(); N].map(|()| Replicates {
        width: crop.width() as usize,
        height: crop.height() as usize,
        pictures: Vec::with_capacity(REPLICATES),
    });
    for number in 0..SESSIONS as u64 {
        let mut session = session(shown, settings, number);
        for replicate in 0..(REPLICATES / SESSIONS) as u64 {
            session.start_at(replicate * STRIDE);
            for _ in 0..passes {
                session.step(&());
            }
            let (film, _) = session.take_film().expect("the film is small");
            for (replicates, pixels) in of_each.iter_mut().zip(develop(&film)) {
                let picture = pixels.iter().map(|pixel| pixel.map(f64::from));
                replicates.pictures.push(picture.collect());
            }
        }
    }
    of_each
}

/// The session with this number, of independent samples.
fn session<'a>(shown: Shown<'a>, settings: &Settings, number: u64) -> Session<'a> {
    let seed = settings.seed.wrapping_mul(1000).wrapping_add(first_seed());
    let settings = Settings {
        seed: seed.wrapping_mul(1000) + number,
        sampler: SamplerKind::Independent,
        ..settings.clone()
    };
    // A pass of so small a film is over before a second thread is awake.
    let resources = Resources {
        threads: 1,
        ..Resources::default()
    };
    Session::new(shown.scene, shown.view, settings, &resources).expect("the film is small")
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

    /// The means of every block and channel, each of all replicates.
    fn series(&self, block: usize) -> Vec<Vec<f64>> {
        let replicates = 0..self.pictures.len();
        let means: Vec<Vec<f64>> = replicates.map(|r| self.block_means(r, block)).collect();
        let of = |i: usize| means.iter().map(|replicate| replicate[i]).collect();
        (0..means[0].len()).map(of).collect()
    }

    /// The mean over replicates and the variance of that mean, of every block and channel.
    fn moments(&self, block: usize) -> Vec<Moments> {
        let of = |values: &Vec<f64>| Moments::of(values.iter().copied());
        self.series(block).iter().map(of).collect()
    }
}

/// The place where two estimators differ most.
#[derive(Clone, Copy, Debug)]
#[expect(dead_code, reason = "shown when a test fails")]
struct Verdict {
    /// Corrected for the number of means and of resolutions.
    p: f64,
    block: usize,
    index: usize,
    means: [f64; 2],
}

/// Two estimators, and the sizes of the blocks in which they are compared.
#[derive(Clone, Copy)]
pub(crate) struct Comparison<'a> {
    a: &'a Replicates,
    b: &'a Replicates,
    blocks: &'a [usize],
    numbers: RandomNumbers,
}

impl<'a> Comparison<'a> {
    pub(crate) fn new(a: &'a Replicates, b: &'a Replicates, blocks: &'a [usize]) -> Self {
        Self {
            a,
            b,
            blocks,
            numbers: RandomNumbers::Own,
        }
    }

    /// The same by the differences of replicates of the same number: for estimators that share random
    /// numbers, which need the same settings but for those that are compared.
    pub(crate) fn paired(self) -> Self {
        Self {
            numbers: RandomNumbers::Common,
            ..self
        }
    }

    /// Of each block and channel the p-value, corrected for their number, and the means.
    fn tests(&self, block: usize) -> Vec<(f64, [f64; 2])> {
        let (a, b) = (self.a.series(block), self.b.series(block));
        let n = a.len();
        let test = |(a, b): (Vec<f64>, Vec<f64>)| {
            let (p, means) = p_value(&a, &b, self.numbers);
            (corrected(p, n), means)
        };
        a.into_iter().zip(b).map(test).collect()
    }

    /// The largest difference, at any of the resolutions.
    fn verdict(&self) -> Verdict {
        let at = |block: usize| {
            let tests = self.tests(block).into_iter().enumerate();
            let least = tests.min_by(|(_, x), (_, y)| x.0.total_cmp(&y.0));
            let (index, (p, means)) = least.expect("a block");
            Verdict {
                p: corrected(p, self.blocks.len()),
                block,
                index,
                means,
            }
        };
        let verdicts = self.blocks.iter().map(|block| at(*block));
        let smallest = verdicts.min_by(|x, y| x.p.total_cmp(&y.p));
        smallest.expect("a comparison has a resolution")
    }

    /// The verdict, had the first estimator a relative `bias`.
    fn biased(&self, bias: f64) -> Verdict {
        let a = &self.a.scaled(1.0 + bias);
        Comparison { a, ..*self }.verdict()
    }

    /// The smallest relative bias, to a tenth of itself, that is seen.
    fn smallest_seen(&self) -> f64 {
        let mut bias = 1e-4;
        while bias < 1.0 && self.biased(bias).p >= level() {
            bias *= 1.1;
        }
        bias
    }

    /// True where the estimators agree at the level of one comparison, which would see [`BIAS`].
    pub(crate) fn agrees(&self) -> bool {
        self.verdict().p > level() && self.biased(BIAS).p < level()
    }

    /// Fails where the estimators differ, and where a relative `bias` of the first would not be seen.
    #[track_caller]
    pub(crate) fn check(&self, name: &str, bias: f64) {
        let verdict = self.verdict();
        if verdict.p <= level() {
            let maps = maps::write(name, self.a, self.b);
            panic!("{name}: {verdict:?}; {maps}");
        }
        if std::env::var_os("BIDIR_TEST_SHOW").is_some() {
            let seen = self.smallest_seen();
            eprintln!("{name}: {verdict:?}, sees a relative bias of {seen:.4}");
        }
        let biased = self.biased(bias);
        let is_seen = biased.p < level();
        assert!(
            is_seen,
            "{name}: blind to a relative bias of {bias}: {biased:?}"
        );
    }
}

/// Checks that two estimators agree in blocks of all the given sizes, and that the same test
/// would see [`BIAS`].
#[track_caller]
pub(crate) fn check_agree(name: &str, a: &Replicates, b: &Replicates, blocks: &[usize]) {
    check_agree_to(name, a, b, blocks, BIAS);
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
    Comparison::new(a, b, blocks).check(name, bias);
}

/// As [`check_agree`], for estimators that share random numbers: for each replicate of one, the other has
/// the one of the same seed and the same passes.
#[track_caller]
pub(crate) fn check_paired(name: &str, a: &Replicates, b: &Replicates, blocks: &[usize]) {
    Comparison::new(a, b, blocks).paired().check(name, BIAS);
}

/// The blocks of `block` × `block` pixels in which two estimators look different at the level of one
/// comparison: left, top, right, bottom.
pub(crate) fn suspects(a: &Replicates, b: &Replicates, block: usize) -> Vec<[u32; 4]> {
    let columns = a.width.div_ceil(block);
    let tests = Comparison::new(a, b, &[block]).tests(block);
    let tests = tests.into_iter().enumerate();
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
    let comparison = Comparison::new(a, b, &[WHOLE]);
    let verdict = comparison.verdict();
    assert!(verdict.p > level(), "{name}: {verdict:?}");
    let is_seen = comparison.biased(BIAS).p <= level();
    let is_seen = is_seen || !suspects(&a.scaled(1.0 + BIAS), b, block).is_empty();
    assert!(is_seen, "{name}: blind to {BIAS}");
}

/// How many times the usual passes tests render: the variable BIDIR_TEST_EFFORT, else 1.
fn effort() -> u64 {
    variable("BIDIR_TEST_EFFORT").unwrap_or(1).max(1)
}

/// The level at which comparisons fail: the variable BIDIR_TEST_LEVEL, else [`LEVEL`].
fn level() -> f64 {
    let variable = std::env::var("BIDIR_TEST_LEVEL").ok();
    variable.map_or(LEVEL, |text| text.parse().expect("a level is a number"))
}

/// The first seed of replicates: the variable BIDIR_TEST_SEED, else 0.
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

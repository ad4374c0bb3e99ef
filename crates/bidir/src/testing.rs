//! Shared parts of the statistical tests: random numbers, verdicts over many cases, and the χ² test of
//! samples against the density that is claimed for them.
//!
//! Every battery keeps the chance of a false alarm at [`LEVEL`] over all of its cases, and shows
//! that it would have noticed: each case must fail where two per cent of the probability are moved.
//! Seeds are fixed; `BIDIR_TEST_SEED=n` runs all batteries with others.

mod chi2;
#[path = "../tests/common/materials.rs"]
pub(crate) mod materials;
mod math;
#[path = "../tests/common/scenes.rs"]
pub(crate) mod scenes;

pub(crate) use chi2::{Domain, Grid};

use crate::math::Vec3;
use crate::sampler::{Domain as StreamDomain, SampleStream, Sampler, SamplerKind};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use std::fmt::{Debug, Display};
use std::str::FromStr;

/// Names that most tests use.
pub(crate) mod prelude {
    pub(crate) use super::materials::*;
    pub(crate) use super::scenes::*;
    pub(crate) use super::{Battery, check_close, check_near, samples};
    pub(crate) use crate::math::{Affine3A, Vec2, Vec3};
    pub(crate) use crate::sampler::{Dimension, Purpose};
    pub(crate) use crate::texture::{ColorTexture, FloatTexture};
}

/// The chance that a battery fails though nothing is wrong, for a seed chosen at random.
const LEVEL: f64 = 1e-3;

/// The seed where the environment names none.
const SEED: u64 = 1;

/// The bias that every case must notice.
const BIAS: f64 = 0.02;

fn seed() -> u64 {
    let chosen = std::env::var("BIDIR_TEST_SEED").ok();
    chosen.map_or(SEED, |text| {
        text.parse().expect("BIDIR_TEST_SEED is a whole number")
    })
}

/// Returns `n` independent samples; those of different cases have nothing in common.
pub(crate) fn samples(case: &str, n: u64) -> impl Iterator<Item = SampleStream> {
    let stream = stream_of(case);
    let sampler = Sampler::new(SamplerKind::Independent, seed());
    (0..n).map(move |index| sampler.stream(StreamDomain::Camera, stream, index))
}

/// Returns `n` independent means of `value`, each over `points` samples that a sequence spreads evenly.
pub(crate) fn means(
    case: &str,
    [n, points]: [u64; 2],
    value: impl Fn(&SampleStream) -> f64,
) -> impl Iterator<Item = f64> {
    let stream = stream_of(case);
    let sampler = Sampler::new(SamplerKind::Sobol, seed());
    (0..n).map(move |set| {
        let sample = |index| sampler.stream(StreamDomain::Camera, stream.wrapping_add(set), index);
        let values = (0..points).map(|index| value(&sample(index)));
        values.sum::<f64>() / points as f64
    })
}

/// Returns independent numbers in `[0, 1)`, of this state other than 0.
pub(crate) fn numbers(mut state: u64) -> impl FnMut() -> f64 {
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Returns a number of `case`, by FNV-1a, so that a case keeps its numbers when others come and go.
fn stream_of(case: &str) -> u64 {
    let hash = |hash: u64, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    case.bytes().fold(0xcbf2_9ce4_8422_2325, hash)
}

/// Checks `property` for many values of `strategy`, the same ones for the same seed.
#[track_caller]
pub(crate) fn check_property<S: Strategy>(
    strategy: &S,
    property: impl Fn(S::Value) -> Result<(), TestCaseError>,
) {
    let config = Config {
        cases: 4096,
        failure_persistence: None,
        ..Config::default()
    };
    let mut bytes = [0; 32];
    bytes[..8].copy_from_slice(&seed().to_le_bytes());
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &bytes);
    if let Err(error) = TestRunner::new_with_rng(config, rng).run(strategy, property) {
        panic!("seed {}: {error}", seed());
    }
}

/// Checks that two numbers agree up to the relative error `tolerance`.
#[track_caller]
pub(crate) fn check_close(
    actual: impl Into<f64>,
    expected: impl Into<f64>,
    tolerance: f64,
    case: impl Display,
) {
    let [actual, expected] = [actual.into(), expected.into()];
    let bound = tolerance * actual.abs().max(expected.abs());
    check_near(actual, expected, bound, case);
}

/// Checks that two numbers differ by at most `bound`.
#[track_caller]
pub(crate) fn check_near(
    actual: impl Into<f64>,
    expected: impl Into<f64>,
    bound: f64,
    case: impl Display,
) {
    let [actual, expected] = [actual.into(), expected.into()];
    let is_near = (actual - expected).abs() <= bound;
    assert!(is_near, "{case}: {actual} instead of {expected}");
}

/// Checks that each variant of an enum is among examples. A new variant does not compile before it is listed.
macro_rules! check_variants {
    ($examples:expr, $kind:ident: $($variant:ident)+) => {
        let mut missing = vec![$(stringify!($variant)),+];
        for example in $examples {
            let found = match example {
                $($kind::$variant { .. } => stringify!($variant),)+
            };
            missing.retain(|name| *name != found);
        }
        assert!(missing.is_empty(), "{missing:?}");
    };
}
pub(crate) use check_variants;

/// Many tests of one kind, judged together.
pub(crate) struct Battery {
    name: &'static str,
    cases: Vec<Case>,
}

struct Case {
    name: String,
    /// The chance of data at least as far off as these.
    p: f64,
    /// The same under the hypothesis that is off by [`BIAS`].
    p_biased: f64,
}

impl Case {
    /// Returns the fault of the case, as a line. None: it has none.
    fn failure(&self, level: f64) -> Option<String> {
        let Self { name, p, p_biased } = self;
        if p.is_nan() || *p < level {
            return Some(format!("\n  {name}: p = {p:.2e}"));
        }
        let blind = p_biased.is_nan() || *p_biased >= level;
        blind.then(|| format!("\n  {name}: blind to a bias, p = {p_biased:.2e}"))
    }
}

impl Battery {
    pub(crate) fn new(name: &'static str) -> Self {
        Self {
            name,
            cases: Vec::new(),
        }
    }

    /// Adds a χ² test: `draws` against `pdf`, a density over the grid's domain in its measure. The
    /// deficit of the density to 1 is the chance of a draw that is None.
    #[track_caller]
    pub(crate) fn chi2(
        &mut self,
        case: &str,
        grid: &Grid,
        pdf: impl Fn(Vec3) -> f32,
        draws: impl Iterator<Item = Option<Vec3>>,
    ) {
        let observed = grid.histogram(draws);
        let expected = grid.expected(pdf, observed.iter().sum());
        let total: f64 = expected[..grid.cells()].iter().sum();
        let is_density = total < 1.0 + 1e-3;
        assert!(is_density, "{case}: the density integrates to {total}");
        self.counts(case, &observed, &expected);
    }

    /// Adds a χ² test of counts against probabilities.
    pub(crate) fn counts(&mut self, case: &str, observed: &[u64], expected: &[f64]) {
        let p = chi2::p_value(observed, expected);
        let p_biased = chi2::p_value(observed, &chi2::biased(expected, BIAS));
        self.cases.push(Case {
            name: case.to_owned(),
            p,
            p_biased,
        });
    }

    /// Adds a test of the mean of `values` against `expected`.
    pub(crate) fn mean(&mut self, case: &str, values: impl Iterator<Item = f64>, expected: f64) {
        self.mean_within(case, values, expected, 0.0);
    }

    /// Adds a test that the mean of `values` is within the relative error `tolerance` of `expected`.
    pub(crate) fn mean_within(
        &mut self,
        case: &str,
        values: impl Iterator<Item = f64>,
        expected: f64,
        tolerance: f64,
    ) {
        let (mut n, mut sum, mut sum_of_squares) = (0.0, 0.0, 0.0);
        for value in values {
            n += 1.0;
            sum += value - expected;
            sum_of_squares += (value - expected) * (value - expected);
        }
        let offset: f64 = sum / n;
        let variance: f64 = (sum_of_squares / n - offset * offset) / n;
        // Single precision is no statistical error: allow for it.
        let deviation = (variance.max(0.0) + (1e-5 * expected) * (1e-5 * expected)).sqrt();
        let p = |offset: f64| {
            let beyond = (offset.abs() - tolerance * expected.abs()).max(0.0);
            libm::erfc(beyond / deviation / std::f64::consts::SQRT_2)
        };
        let p_biased = p(offset - BIAS * expected).max(p(offset + BIAS * expected));
        self.cases.push(Case {
            name: case.to_owned(),
            p: p(offset),
            p_biased,
        });
    }

    /// The verdict over all cases, at a level that Šidák's correction divides between them.
    #[track_caller]
    pub(crate) fn check(self) {
        assert!(!self.cases.is_empty());
        let level = -libm::expm1(libm::log1p(-LEVEL) / self.cases.len() as f64);
        let failures = self.cases.iter().filter_map(|case| case.failure(level));
        let report: String = failures.collect();
        let (name, count, seed) = (self.name, self.cases.len(), seed());
        println!("{name}: {count} cases, seed {seed}");
        let is_fine = report.is_empty();
        assert!(is_fine, "{name}, seed {seed}, level {level:.1e}:{report}");
    }
}

/// Checks that the first texts are written as they are read, and the others refused.
#[track_caller]
pub(crate) fn check_texts<T>(good: &[&str], bad: &[&str])
where
    T: FromStr<Err: Debug> + Display,
{
    for text in good {
        let value: T = text.parse().expect(text);
        assert_eq!(value.to_string(), *text);
    }
    for text in bad {
        assert!(text.parse::<T>().is_err(), "{text}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[should_panic(expected = "p = ")]
    fn a_battery_with_one_wrong_case_fails() {
        let mut battery = Battery::new("power");
        battery.counts("right", &[500_000, 500_000], &[0.5, 0.5]);
        battery.counts("two per cent off", &[510_000, 490_000], &[0.5, 0.5]);
        battery.check();
    }

    #[test]
    #[should_panic(expected = "blind")]
    fn a_battery_with_too_few_samples_fails() {
        let mut battery = Battery::new("power");
        battery.counts("few", &[50, 50], &[0.5, 0.5]);
        battery.check();
    }
}

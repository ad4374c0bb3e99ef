//! Do two estimators have the same expectation? Welch's t-test on block means.
//!
//! Each estimator renders independent replicates (other seeds, independent sampler). The film is
//! cut into blocks, and each block's mean in each channel is compared, and so is the mean of the
//! whole film. Block means over whole renders are close to normal even where single samples have
//! heavy tails, and their variance is that of both film layers together.

use bidir::driver::{Resources, Settings, render};
use bidir::sampler::SamplerKind;
use bidir::scene::Scene;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Replicates of each estimator.
const REPLICATES: usize = 16;
/// The level of a whole comparison: the probability that equal estimators are called different.
const LEVEL: f64 = 1e-3;

/// Block means: one list per replicate, the film's own mean last.
pub(crate) type Replicates = Vec<Vec<f64>>;

/// Renders the replicates of an estimator, with blocks of `block` × `block` pixels.
pub(crate) fn replicates(
    scene: &Scene,
    settings: &Settings,
    passes: u64,
    block: usize,
) -> Replicates {
    let passes = passes * effort();
    (0..REPLICATES as u64)
        .map(|replicate| {
            let seed = first_seed().wrapping_mul(1000) + replicate;
            let settings = Settings {
                seed,
                sampler: SamplerKind::Independent,
                ..settings.clone()
            };
            let film = render(scene, &settings, passes, &Resources::default());
            let picture = film.expect("the film is small").develop();
            let columns = picture.width.div_ceil(block);
            let rows = picture.height.div_ceil(block);
            let mut sums = vec![(0.0, 0.0); columns * rows * 3];
            let (mut total, mut count) = (0.0, 0.0);
            for (i, pixel) in picture.pixels.iter().enumerate() {
                let (x, y) = (i % picture.width / block, i / picture.width / block);
                for (channel, value) in pixel.iter().enumerate() {
                    let sum = &mut sums[(y * columns + x) * 3 + channel];
                    *sum = (sum.0 + f64::from(*value), sum.1 + 1.0);
                    total += f64::from(*value);
                    count += 1.0;
                }
            }
            let means = sums.into_iter().map(|(sum, n)| sum / n);
            means.chain([total / count]).collect()
        })
        .collect()
}

/// The smallest p-value over all blocks, corrected for their number [Sidak67], with the index of
/// that block and its two means.
pub(crate) fn smallest_p(a: &Replicates, b: &Replicates) -> (f64, usize, [f64; 2]) {
    let blocks = a[0].len();
    let test = |i: usize| {
        let (x, y) = (moments(a, i), moments(b, i));
        (welch(x, y), i, [x.0, y.0])
    };
    let smallest = (0..blocks).map(test).min_by(|a, b| a.0.total_cmp(&b.0));
    let (p, i, means) = smallest.expect("a film has blocks");
    (1.0 - libm::pow(1.0 - p, blocks as f64), i, means)
}

/// Mean and variance of the mean of block `i`.
fn moments(replicates: &Replicates, i: usize) -> (f64, f64) {
    let n = replicates.len() as f64;
    let mean = replicates.iter().map(|r| r[i]).sum::<f64>() / n;
    let square = replicates
        .iter()
        .map(|r| (r[i] - mean) * (r[i] - mean))
        .sum::<f64>();
    (mean, square / (n - 1.0) / n)
}

/// The two-sided p-value of Welch's t-test.
fn welch(a: (f64, f64), b: (f64, f64)) -> f64 {
    let variance = a.1 + b.1;
    // Estimators without variance must agree to rounding.
    if variance.sqrt() <= 1e-6 * (a.0.abs() + b.0.abs()) {
        let same = (a.0 - b.0).abs() <= 1e-5 * (a.0.abs() + b.0.abs());
        return f64::from(same);
    }
    let freedom = variance * variance / ((a.1 * a.1 + b.1 * b.1) / (REPLICATES as f64 - 1.0));
    let t = (a.0 - b.0) / variance.sqrt();
    let distribution = StudentsT::new(0.0, 1.0, freedom).expect("freedom is positive");
    2.0 * distribution.cdf(-t.abs())
}

/// The bias that a comparison must be able to see.
pub(crate) const FINE: f64 = 0.02;
/// The same for estimators with so much variance that 2 % would take minutes.
pub(crate) const COARSE: f64 = 0.06;

/// Checks that two estimators agree, and that the same test would see a relative `bias`.
#[track_caller]
pub(crate) fn check_agree(name: &str, a: &Replicates, b: &Replicates, bias: f64) {
    let (p, block, means) = smallest_p(a, b);
    assert!(
        p > LEVEL,
        "{name}: block {block} differs, p = {p:.2e}, means {means:?}"
    );
    let injected = |means: &Vec<f64>| means.iter().map(|mean| mean * (1.0 + bias)).collect();
    let biased: Replicates = a.iter().map(injected).collect();
    let (p, ..) = smallest_p(&biased, b);
    assert!(
        p < LEVEL,
        "{name}: the test is blind to a bias of {bias}, p = {p:.2e}"
    );
}

/// How many times the usual passes tests render: the variable BIDIR_TEST_EFFORT, else 1.
fn effort() -> u64 {
    let text = std::env::var("BIDIR_TEST_EFFORT").ok();
    text.and_then(|text| text.parse().ok()).unwrap_or(1).max(1)
}

/// Where the seeds of replicates begin: the variable BIDIR_TEST_SEED, else 0.
fn first_seed() -> u64 {
    let text = std::env::var("BIDIR_TEST_SEED").ok();
    text.and_then(|text| text.parse().ok()).unwrap_or(0)
}

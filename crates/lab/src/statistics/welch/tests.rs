use super::super::simulation::normal;
use super::*;

const SIZE: [usize; 2] = [16, 12];
const PIXELS: usize = SIZE[0] * SIZE[1];
/// The standard deviation of a sample relative to its mean.
const SPREAD: f64 = 0.5;

fn flat(value: f64) -> Pixels {
    Pixels {
        size: SIZE,
        data: vec![[value as f32; 3]; PIXELS],
    }
}

/// Makes `count` renders with one sample per pixel of a grey image that becomes brighter towards its end.
fn renders(stream: u64, count: usize, scale: f64) -> Vec<Pixels> {
    let mut noise = normal(stream);
    let mut render = || {
        let mut value = |i: usize| {
            let mean = 1.0 + i as f64 / PIXELS as f64;
            let noise = noise.next().expect("endless");
            (scale * mean * (1.0 + SPREAD * noise)) as f32
        };
        let data = (0..PIXELS).map(|i| [value(i), value(i), value(i)]);
        Pixels {
            size: SIZE,
            data: data.collect(),
        }
    };
    (0..count).map(|_| render()).collect()
}

/// Computes the mean of renders and the variance of that mean for every pixel.
fn estimate(renders: &[Pixels]) -> [Pixels; 2] {
    let moments = moments_of_replicates(Blocks::new(SIZE, 1), renders);
    let image = |value: fn(&Moments) -> f64| Pixels {
        size: SIZE,
        data: moments
            .chunks_exact(3)
            .map(|pixel| [0, 1, 2].map(|c| value(&pixel[c]) as f32))
            .collect(),
    };
    [image(|m| m.mean), image(|m| m.variance)]
}

/// Returns the rate of false alarms at `level` in `trials` comparisons of equal estimators.
fn alarms(trials: u64, level: f64, p: impl Fn(u64, u64) -> f64) -> f64 {
    let alarmed = (0..trials).filter(|trial| p(2 * trial, 2 * trial + 1) < level);
    alarmed.count() as f64 / trials as f64
}

#[track_caller]
fn check_rate(rate: f64, level: f64, trials: f64) {
    let error = 4.0 * (level * (1.0 - level) / trials).sqrt();
    assert!(
        (rate - level).abs() < error,
        "{rate}, not {level} ± {error}"
    );
}

#[test]
fn a_test_is_as_computed_by_hand() {
    // t = 2 / √(0.25 + 0.75), ν = 1 / (0.25² / 4 + 0.75² / 9) = 12.8; p from tables of t.
    let a = Moments {
        mean: 5.0,
        variance: 0.25,
        freedom: 4.0,
    };
    let b = Moments {
        mean: 3.0,
        variance: 0.75,
        freedom: 9.0,
    };
    let (p, t) = welch(a, b);
    assert!((t - 2.0).abs() < 1e-12);
    assert!((p - 0.0672).abs() < 2e-4, "{p}");
    assert!((corrected(0.01, 3) - (1.0 - 0.99f64 * 0.99 * 0.99)).abs() < 1e-15);
    assert!((tail(1.959964, f64::INFINITY) - 0.05).abs() < 1e-7);
}

/// Computes the p-value of images of 16 samples with variances.
fn p_of_variances(a: &[Pixels; 2], b: &[Pixels; 2], block: usize) -> f64 {
    let [a, b] = [a, b].map(|[mean, variance]| Estimated {
        mean,
        variance,
        freedom: 15.0,
    });
    z_test(&a, &b, block).unwrap().p
}

#[test]
fn false_alarms_are_as_rare_as_the_level_says() {
    for block in [1, 4, WHOLE] {
        let p = |a, b| {
            let [a, b] = [a, b].map(|stream| renders(stream, 8, 1.0));
            welch_test(&a, &b, block).unwrap().p
        };
        check_rate(alarms(1000, 0.05, p), 0.05, 1000.0);
        let p = |a, b| {
            let [a, b] = [a, b].map(|stream| estimate(&renders(stream, 16, 1.0)));
            p_of_variances(&a, &b, block)
        };
        check_rate(alarms(1000, 0.05, p), 0.05, 1000.0);
    }
}

/// The standard error of a channel's mean over the image is 0.5 / √(16 · 192) = 0.9 % with 16 samples, so
/// that a difference of 2 % is 1.6 standard errors; with 256 samples it is 6.
#[test]
fn a_bias_of_two_per_cent_is_detected() {
    let [a, b, biased] =
        [(1, 1.0), (2, 1.0), (2, 1.02)].map(|(stream, scale)| renders(stream, 256, scale));
    assert!(welch_test(&a, &b, WHOLE).unwrap().p > 1e-3);
    assert!(welch_test(&a, &biased, WHOLE).unwrap().p < 1e-3);
    let [a, b, biased] = [a, b, biased].map(|renders| estimate(&renders));
    assert!(p_of_variances(&a, &b, WHOLE) > 1e-3);
    assert!(p_of_variances(&a, &biased, WHOLE) < 1e-3);
}

/// With three channels, the test detects such a bias in about three of four trials, and half of it rarely.
#[test]
fn the_smallest_bias_is_detected_in_most_trials() {
    let found = |part: f64| {
        let trials = (0..200).filter(|trial| {
            let [a, b] = [2 * trial, 2 * trial + 1].map(|stream| renders(stream, 16, 1.0));
            let bias = smallest_bias(&a, &b, 1e-3).unwrap();
            let b = renders(2 * trial + 1, 16, 1.0 + part * bias);
            welch_test(&a, &b, WHOLE).unwrap().p < 1e-3
        });
        trials.count() as f64 / 200.0
    };
    let [half, whole] = [0.5, 1.0].map(found);
    assert!((0.5..0.95).contains(&whole), "{whole}");
    assert!(half < 0.2, "{half}");
    let black = vec![flat(0.0); 3];
    assert!(smallest_bias(&black, &black, 1e-3).is_none());
}

#[test]
fn a_local_bias_is_found_where_it_is() {
    let mut a = renders(3, 16, 1.0);
    for render in &mut a {
        for y in 4..8 {
            for x in 8..12 {
                render.data[y * SIZE[0] + x][1] *= 1.5;
            }
        }
    }
    let found = welch_test(&a, &renders(4, 16, 1.0), 4).unwrap();
    assert!(found.p < 1e-3, "{found:?}");
    assert_eq!((found.block, found.channel), ([8, 4, 12, 8], 1));
    assert_eq!(found.tests, 4 * 3 * 3);
    assert!(found.deviations > 4.0 && found.means[0] > found.means[1]);
}

#[test]
fn images_without_variance_must_agree() {
    let blocks = Blocks::new(SIZE, 1);
    let known = |value: f64| {
        let exact = Estimated {
            mean: &flat(value),
            variance: &flat(0.0),
            freedom: f64::INFINITY,
        };
        exact.moments(blocks)
    };
    let [one, same, other] = [1.0, 1.0, 1.01].map(known);
    assert!(worst(blocks, &one, &same).unwrap().p > 0.99);
    assert!(worst(blocks, &one, &other).unwrap().p <= 0.0);
    let black = known(0.0);
    assert!(worst(blocks, &black, &black).unwrap().p > 0.99);
}

#[test]
fn numbers_that_are_not_finite_differ() {
    let mut a = renders(5, 4, 1.0);
    a[2].data[17][2] = f32::NAN;
    let found = welch_test(&a, &renders(6, 4, 1.0), 1).unwrap();
    assert!(found.p <= 0.0);
    assert_eq!((found.block, found.channel), ([1, 1, 2, 2], 2));
}

#[test]
fn too_few_replicates_and_other_sizes_give_no_test() {
    let mut odd = flat(1.0);
    odd.size = [SIZE[1], SIZE[0]];
    let (one, two) = (renders(1, 1, 1.0), renders(2, 2, 1.0));
    assert!(welch_test(&one, &two, 1).is_none());
    assert!(welch_test(&two, &[odd.clone(), odd], 1).is_none());
    assert!(welch_test(&[], &two, 1).is_none());
}

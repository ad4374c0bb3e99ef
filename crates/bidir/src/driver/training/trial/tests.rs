use super::*;

impl Trial {
    /// Of pairs of samples, each in a block of its own, that took a camera ray each; and of light images
    /// in the first block: value and weight.
    pub(in crate::driver::training) fn of(pairs: &[[f64; 2]], splats: &[[f64; 2]]) -> Self {
        let mut trial = Self::default();
        for half in 0..2 {
            let values = pairs.iter().enumerate();
            trial.values.extend(values.map(|(i, pair)| (i, pair[half])));
        }
        trial.sum_values();
        for &[value, weight] in splats {
            trial.blocks[0].add_splat(value, weight);
        }
        trial.stats.samples = trial.values.len() as u64;
        trial.stats.rays.camera = trial.stats.samples;
        trial
    }
}

#[test]
fn what_pixels_differ_by_is_no_variance() {
    // Two pixels of block 3, and one of block 5.
    let values = [
        [(3, 1.0), (3, 7.0), (5, 2.0)],
        [(3, 1.0), (3, 7.0), (5, 4.0)],
    ]
    .concat();
    let mut trial = Trial {
        values,
        ..Trial::default()
    };
    trial.sum_values();
    trial.stats.samples = 6;
    let pixels = BLOCKS as f64;
    let variances = [3, 5].map(|i| trial.variance(i, pixels));
    let spreads = [3, 5].map(|i| trial.spread(i, pixels));
    assert_eq!((variances, spreads), ([0.0, 2.0], [12.0, 2.0]));
    assert!((trial.mean(3, pixels) - 4.0).abs() < 1e-12);
}

/// Three paths of known contribution, and densities of both ways to make them: what light images
/// tell is Σ f² / q.
#[test]
fn light_images_tell_of_the_second_moment_of_path_tracing() {
    let pixels = BLOCKS as f64;
    let paths = [(3.0, 0.25, 1e-4), (1.0, 0.5, 0.3), (2.0, 0.125, 0.02)];
    let mut trial = Trial::default();
    let n = 800.0;
    trial.stats.samples = 800;
    for (f, p, q) in paths {
        let w = pixels * p / (pixels * p + q);
        for _ in 0..(n * p) as u32 {
            trial.blocks[7].add_splat(w * f / p, w);
        }
    }
    let exact: f64 = paths.iter().map(|(f, _, q)| f * f / q).sum();
    let told = trial.hidden_spread(7, pixels, 0.0);
    // Of the first path 1 - w is less than what weights can tell.
    let least: f64 = paths[1..].iter().map(|(f, _, q)| f * f / q).sum();
    assert!(told > least && told < exact, "{least} {told} {exact}");
    trial.blocks[7].add_splat(0.0, 0.0);
    assert!((trial.hidden_spread(7, pixels, 0.0) - told).abs() < 1e-9);
    let told_of = |(f, p, q): (f64, f64, f64)| {
        let w = pixels * p / (pixels * p + q);
        let known = w.min(MOST_WEIGHT);
        f * f * w * w / (pixels * p * known * (1.0 - known))
    };
    let all: f64 = paths.into_iter().map(told_of).sum();
    // One of the 200 light images of the first path is left out.
    let expected = all - told_of(paths[0]) / 200.0;
    assert!((told / expected - 1.0).abs() < 1e-9, "{told} {expected}");
    assert!(trial.hidden_spread(7, pixels, 1e9) <= 0.0);
}

#[test]
fn blocks_divide_the_crop() {
    let crop = PixelRect {
        min: [3, 5],
        max: [3 + 40, 5 + 20],
    };
    let mut counts = vec![0; BLOCKS];
    for index in 0..crop.area() {
        counts[block(&crop, index)] += 1;
    }
    assert_eq!(counts.iter().sum::<u64>(), crop.area());
    assert!(
        counts.iter().all(|&count| (2..=6).contains(&count)),
        "{counts:?}"
    );
}

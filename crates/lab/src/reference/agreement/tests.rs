//! Estimators of known light, of which one draws most of it rarely.

use super::*;

const SIDE: usize = 16;
const REPLICATES: u64 = 16;

/// Numbers in `[0, 1)`, by SplitMix64.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ z >> 31) as f64 * (1.0 / 18_446_744_073_709_551_616.0)
    }
}

fn pixels(values: &[f64]) -> Pixels {
    Pixels {
        size: [SIDE; 2],
        data: values.iter().map(|&value| [value as f32; 3]).collect(),
    }
}

impl Renders {
    /// Makes the renders of an estimator that draws a sample of `bright` with probability `rate`, and that has the
    /// mean `scale`, which is 1 without a bias.
    fn made(seed: u64, passes: u64, [rate, bright, scale]: [f64; 3]) -> Self {
        let mut numbers = Numbers(seed);
        let (dim, n) = (1.0 - rate * bright, passes as f64);
        let mut sums = vec![[0.0; 2]; SIDE * SIDE];
        let replicates = (0..REPLICATES).map(|_| {
            let image = sums.iter_mut().map(|[sum, squares]| {
                let hits = (0..passes).filter(|_| numbers.next() < rate).count() as f64;
                // Even samples have a little noise.
                let even = scale * dim * (1.0 + 0.01 * (numbers.next() - 0.5));
                let bright = scale * (bright + dim);
                *sum += (n - hits) * even + hits * bright;
                *squares += (n - hits) * even * even + hits * bright * bright;
                ((n - hits) * even + hits * bright) / n
            });
            pixels(&image.collect::<Vec<_>>())
        });
        let replicates: Vec<_> = replicates.collect();
        let all = n * REPLICATES as f64;
        let mean = |[sum, _]: &[f64; 2]| sum / all;
        let variance = |[sum, squares]: &[f64; 2]| (squares / all - sum / all * (sum / all)) / all;
        Self {
            whole: [
                pixels(&sums.iter().map(mean).collect::<Vec<_>>()),
                pixels(&sums.iter().map(variance).collect::<Vec<_>>()),
            ],
            replicates,
            passes: passes * REPLICATES,
        }
    }
}

/// The verdict on an even estimator, and one of rare samples.
fn verdict(seed: u64, passes: u64, rare: [f64; 3]) -> Agreement {
    let [even, rare] = [[0.0, 0.0, 1.0], rare].map(|of| Renders::made(seed, passes, of));
    Agreement::of([&even, &rare]).expect("films of one size")
}

/// Half of the light comes by two samples in a block, so that some blocks lack it, and their variance with it.
#[test]
fn rare_bright_samples_are_no_reason_to_refuse() {
    let verdicts: Vec<_> = (0..24)
        .map(|seed| verdict(seed, 64, [3e-5, 0.5 / 3e-5, 1.0]))
        .collect();
    assert!(verdicts.iter().all(|it| it.agree && !it.decided));
    let small = [0, 1, 2, 3].map(|seed| {
        let made = [[0.0, 0.0, 1.0], [3e-5, 0.5 / 3e-5, 1.0]].map(|of| Renders::made(seed, 64, of));
        welch_test(&made[0].replicates, &made[1].replicates, SMALLEST_BLOCK)
    });
    assert!(small.iter().flatten().any(|it| it.p < 1e-6), "{small:?}");
}

#[test]
fn blocks_grow_until_their_means_have_enough_samples() {
    for seed in 0..24 {
        let it = verdict(seed, 64, [1e-4, 5e3, 1.0]);
        assert!(it.agree, "seed {seed}: p = {}", it.p);
    }
    let it = verdict(0, 64, [1e-4, 5e3, 1.0]);
    assert!(it.decided && it.block == SIDE, "{it:?}");
    let it = verdict(0, 64, [0.1, 5.0, 1.0]);
    assert!(it.decided && it.block == SMALLEST_BLOCK, "{it:?}");
}

#[test]
fn a_bias_of_two_percent_is_noticed() {
    let right = verdict(0, 400, [0.1, 5.0, 1.0]);
    assert!(right.agree && right.decided);
    let wrong = verdict(0, 400, [0.1, 5.0, 1.02]);
    assert!(!wrong.agree && wrong.decided, "{wrong:?}");
}

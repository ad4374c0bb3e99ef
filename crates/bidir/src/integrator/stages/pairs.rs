//! Which pairs of a light and a camera vertex are connected, where there are more than a sample can afford:
//! two subpaths of k vertices have k² pairs.
//!
//! All pairs that make paths of n ≤ N vertices are connected, and those of longer paths each with the probability
//!
//! π(n) = (N / n)²,
//!
//! so that N² / n of them are left on average, and N² (1/2 + ln(n / N)) of all lengths up to n. π depends on
//! the length alone, and a connection counts 1/π: the estimate keeps its expectation. The choice is
//! systematic \[Madow49\]: one number places evenly spaced pointers over the sum of all π.

use crate::path::Job;
use crate::sampler::{Dimension, Purpose, SampleStream};

/// N. Usual limits of length are below.
const ALL_UP_TO: usize = 64;

/// A choice of pairs, in the order in which they are asked for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pairs {
    pointer: f64,
}

impl Pairs {
    /// Returns the choice of a sample with the numbers `camera`.
    pub(super) fn new(job: &Job<'_>, camera: &SampleStream) -> Self {
        let at = Dimension::at(0, Purpose::Pairs);
        let has_choice = job.settings.max_vertices() > ALL_UP_TO;
        Self {
            pointer: if has_choice {
                camera.get_1d(at).into()
            } else {
                0.0
            },
        }
    }

    /// Returns how much the next pair counts, which makes a path of `n` vertices. None: it is left out.
    #[inline]
    pub(super) fn take(&mut self, n: usize) -> Option<f32> {
        if n <= ALL_UP_TO {
            return Some(1.0);
        }
        let root = ALL_UP_TO as f64 / n as f64;
        let prob = root * root;
        self.pointer += prob;
        if self.pointer < 1.0 {
            return None;
        }
        self.pointer -= 1.0;
        Some((1.0 / prob) as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::MAX_VERTICES;

    /// Takes all pairs of two subpaths of `k` vertices; returns for each number of vertices how many were
    /// taken, and what they count.
    fn taken(k: usize, pointer: f64) -> Vec<(usize, f64)> {
        let mut taken = vec![(0, 0.0); 2 * k + 1];
        let mut pairs = Pairs { pointer };
        for (t, s) in (1..=k).flat_map(|t| (1..=k).map(move |s| (t, s))) {
            if let Some(share) = pairs.take(s + t) {
                taken[s + t].0 += 1;
                taken[s + t].1 += f64::from(share);
            }
        }
        taken
    }

    #[test]
    fn short_paths_keep_all_pairs() {
        for (n, (count, share)) in taken(32, 0.7).into_iter().enumerate().skip(2) {
            assert!((share - count as f64).abs() < 1e-12);
            assert_eq!(count, (n - 1).min(65 - n));
        }
    }

    #[test]
    fn the_longest_subpaths_have_few_pairs_and_their_expectation() {
        let k = MAX_VERTICES / 2;
        let choices = 64;
        let mut sums = vec![0.0; 2 * k + 1];
        for i in 0..choices {
            let taken = taken(k, (f64::from(i) + 0.5) / f64::from(choices));
            let all: usize = taken.iter().map(|(count, _)| count).sum();
            assert!(all < 12_000, "{all} of {}", k * k);
            let shares = taken.iter().map(|(_, share)| share);
            sums.iter_mut()
                .zip(shares)
                .for_each(|(sum, share)| *sum += share);
        }
        for (n, sum) in sums.iter().enumerate().skip(ALL_UP_TO) {
            let pairs = (n - 1).min(2 * k + 1 - n) as f64;
            let mean = sum / f64::from(choices);
            // Of one pair two in 4096 numbers may or may not lead to it.
            let most = 2.0 * (n * n) as f64 / 4096.0 * pairs / f64::from(choices);
            assert!((mean - pairs).abs() <= most, "{n}: {mean} for {pairs}");
        }
    }
}

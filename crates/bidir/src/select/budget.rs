//! π_c = min(1, g_c / δ) with Σ π = the budget: threshold sampling \[Cohen09\], drawn
//! systematically \[Madow49\].

use super::{Candidate, Chosen, Draws, Selector};

/// Traces at most `rays` candidates: π = min(1, g_c / δ) with Σ π = `rays`, and one systematic
/// draw for all.
///
/// With one ray this is one per pair. With more it usually has less variance than as many single choices: large
/// candidates are certain, and one uniform number places evenly spaced pointers over the rest, so that neighbours are
/// not chosen together. It has more variance if visibility changes with the period of the pointers. This is the
/// threshold sampling of \[Cohen09\].
#[derive(Clone, Copy, Debug)]
pub struct Budget {
    /// The expected number of rays.
    pub rays: u32,
}

impl Budget {
    /// Returns δ with Σ min(1, g_c / δ) = `rays`. None: there are no more candidates than rays, so that all
    /// are traced.
    fn threshold(self, candidates: &[Candidate]) -> Option<f64> {
        if candidates.len() <= self.rays as usize {
            return None;
        }
        // Candidates with scores of δ or more count one ray each; the others share the remaining rays. δ falls from
        // round to round, and the number of rounds is at most that of candidates.
        let mut threshold = f64::INFINITY;
        loop {
            let (mut certain, mut rest) = (0u32, 0.0);
            for candidate in candidates {
                let score = f64::from(candidate.score);
                if score >= threshold {
                    certain += 1;
                } else {
                    rest += score;
                }
            }
            // With as many certain candidates as rays, the remainder is lost in rounding.
            if certain >= self.rays || rest <= 0.0 {
                return Some(threshold);
            }
            let next = rest / f64::from(self.rays - certain);
            if next >= threshold {
                return Some(threshold);
            }
            threshold = next;
        }
    }
}

/// Returns min(1, g_c / δ), or 1 without a δ.
#[inline]
fn prob(candidate: &Candidate, threshold: Option<f64>) -> f64 {
    threshold.map_or(1.0, |delta| (f64::from(candidate.score) / delta).min(1.0))
}

impl Selector for Budget {
    fn select(&self, candidates: &[Candidate], draws: Draws<'_>, chosen: &mut Vec<Chosen>) {
        let threshold = self.threshold(candidates);
        let mut pointer = draws.get(0);
        for (i, candidate) in candidates.iter().enumerate() {
            let prob = prob(candidate, threshold);
            pointer += prob;
            if pointer >= 1.0 {
                pointer -= 1.0;
                chosen.push(Chosen {
                    candidate: i as u32,
                    prob,
                });
            }
        }
    }

    fn probabilities(&self, candidates: &[Candidate]) -> Vec<f64> {
        let threshold = self.threshold(candidates);
        candidates.iter().map(|c| prob(c, threshold)).collect()
    }
}

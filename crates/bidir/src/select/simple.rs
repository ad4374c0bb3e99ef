//! Rules that treat each candidate on its own: π = 1, and π = min(1, score / threshold) [Veach97, §10.4.1]. Only the
//! number of candidates bounds the number of rays.

use super::{Candidate, Chosen, Draws, Selector};

/// Traces every candidate.
#[derive(Clone, Copy, Debug)]
pub struct All;

impl Selector for All {
    fn select(&self, candidates: &[Candidate], _draws: Draws<'_>, chosen: &mut Vec<Chosen>) {
        chosen.extend((0..candidates.len() as u32).map(|candidate| Chosen {
            candidate,
            prob: 1.0,
        }));
    }

    fn probabilities(&self, candidates: &[Candidate]) -> Vec<f64> {
        vec![1.0; candidates.len()]
    }
}

/// Keeps each candidate by a random number of its own: π = min(1, score / threshold) [Veach97, §10.4.1].
#[derive(Clone, Copy, Debug)]
pub struct RayRoulette {
    /// The least score at which a candidate is always traced.
    pub threshold: f32,
}

impl RayRoulette {
    /// Makes a roulette whose threshold is this fraction of the image's mean luminance. Filters with negative lobes
    /// may make the mean negative; then everything is traced.
    pub fn new(part: f32, mean_luminance: f32) -> Self {
        Self {
            threshold: (part * mean_luminance).max(0.0),
        }
    }

    #[inline]
    fn prob(self, candidate: &Candidate) -> f64 {
        // A black training image has threshold 0: then everything is traced.
        (f64::from(candidate.score) / f64::from(self.threshold)).min(1.0)
    }
}

impl Selector for RayRoulette {
    fn select(&self, candidates: &[Candidate], draws: Draws<'_>, chosen: &mut Vec<Chosen>) {
        for (i, candidate) in candidates.iter().enumerate() {
            let prob = self.prob(candidate);
            if prob >= 1.0 || draws.get(i) < prob {
                chosen.push(Chosen {
                    candidate: i as u32,
                    prob,
                });
            }
        }
    }

    fn probabilities(&self, candidates: &[Candidate]) -> Vec<f64> {
        candidates.iter().map(|c| self.prob(c)).collect()
    }
}

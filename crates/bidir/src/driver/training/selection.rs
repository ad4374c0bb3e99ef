//! The variance that the selection of shadow rays adds. It is estimated from the connections of a few samples of the
//! survey, each of which stands for `count` candidates of the plan:
//!
//! Σ C² v (1 - π) / π - (Σ C v (1 - π))² / Σ π (1 - π),    π = min(1, C √V̂ / δ),    Σ π = K,
//!
//! which is the variance of a draw of a fixed number of rays \[Hajek64\].

/// The candidates of a plan that a connection of the survey stands for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Expected {
    /// The number of its block.
    pub(super) block: u32,
    /// The number of its sample.
    pub(super) sample: u32,
    /// The number of such candidates in a sample of the plan.
    pub(super) count: f64,
    /// C √V̂.
    pub(super) score: f64,
    /// C v.
    pub(super) value: f64,
    /// The weight of squares in the block.
    pub(super) scale: f64,
}

/// Returns the variance of selecting `rays` rays for each sample that has candidates. `candidates` is sorted by
/// block.
pub(super) fn variance(candidates: &[Expected], rays: f64) -> f64 {
    let blocks = candidates.chunk_by(|a, b| a.block == b.block);
    blocks
        .map(|block| of_block(block, rays) * block[0].scale)
        .sum()
}

/// Returns the variance of the selection from the candidates of one block, summed over its samples.
fn of_block(candidates: &[Expected], rays: f64) -> f64 {
    let samples = candidates.chunk_by(|a, b| a.sample == b.sample).count();
    let Some(threshold) = threshold(candidates, rays * samples as f64) else {
        return 0.0;
    };
    let [mut squares, mut values, mut spread] = [0.0; 3];
    for of in candidates {
        let prob = (of.score / threshold).min(1.0);
        squares += of.count * of.value * of.value * (1.0 - prob) / prob;
        values += of.count * of.value * (1.0 - prob);
        spread += of.count * prob * (1.0 - prob);
    }
    if spread > 0.0 {
        (squares - values * values / spread).max(0.0)
    } else {
        0.0
    }
}

/// Returns δ with Σ π = `rays`. None: there are no more candidates than rays.
fn threshold(candidates: &[Expected], rays: f64) -> Option<f64> {
    if candidates.iter().map(|of| of.count).sum::<f64>() <= rays {
        return None;
    }
    let mut threshold = f64::INFINITY;
    loop {
        let (mut certain, mut rest) = (0.0, 0.0);
        for of in candidates {
            if of.score >= threshold {
                certain += of.count;
            } else {
                rest += of.count * of.score;
            }
        }
        if certain >= rays || rest <= 0.0 {
            return Some(threshold);
        }
        let next = rest / (rays - certain);
        if next >= threshold {
            return Some(threshold);
        }
        threshold = next;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contribution::Term;
    use crate::sampler::{Domain, Sampler, SamplerKind};
    use crate::select::{Budget, Candidate, Chosen, Draws, Selector};
    use crate::spectrum::Spectrum;
    use crate::strategy::Strategy;
    use crate::testing::{check_close, check_near, numbers};

    /// Samples whose candidates have widely spread values, a part of which arrives.
    fn samples(visible: f64) -> Vec<Vec<Expected>> {
        let candidates = |sample: u32| {
            let mut next = numbers((u64::from(sample) + 7).wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
            let candidates = (0..26).map(|_| {
                let u = [next(), next()];
                let value = libm::exp(3.0 * u[0]);
                Expected {
                    block: 0,
                    sample,
                    count: 1.0,
                    score: value * visible.sqrt(),
                    value: if u[1] < visible { value } else { 0.0 },
                    scale: 1.0,
                }
            });
            candidates.collect()
        };
        (0..400).map(candidates).collect()
    }

    /// Returns the variance of the sum of what arrives of a budget's choice from these candidates.
    fn simulated(candidates: &[Expected], rays: u32) -> f64 {
        let offered: Vec<_> = (candidates.iter())
            .map(|of| candidate(of.score as f32))
            .collect();
        let arrived: f64 = candidates.iter().map(|of| of.value).sum();
        let mut chosen: Vec<Chosen> = Vec::new();
        let draws = 256;
        let sampler = Sampler::new(SamplerKind::Independent, 1);
        let square = |i: u32| {
            chosen.clear();
            let stream = sampler.stream(Domain::Camera, 0, i.into());
            Budget { rays }.select(&offered, Draws(&stream), &mut chosen);
            let sum = |chosen: &Chosen| candidates[chosen.candidate as usize].value / chosen.prob;
            let error = chosen.iter().map(sum).sum::<f64>() - arrived;
            error * error
        };
        (0..draws).map(square).sum::<f64>() / f64::from(draws)
    }

    fn candidate(score: f32) -> Candidate {
        Candidate {
            term: Term {
                strategy: Strategy::new(2, 2),
                light: 0,
                contribution: Spectrum::splat(score),
                weight: 1.0,
            },
            score,
            vertices: [0; 2],
            light_vertex: 0,
        }
    }

    /// The mean over many samples, as single ones depend on the order of their candidates.
    #[test]
    fn the_variance_is_that_of_simulated_selections() {
        for (visible, rays) in [(0.3, 3), (0.3, 6), (0.3, 12), (0.8, 6), (0.8, 18)] {
            let samples = samples(visible);
            let found: f64 = samples.iter().map(|of| variance(of, f64::from(rays))).sum();
            let expected: f64 = samples.iter().map(|of| simulated(of, rays)).sum();
            check_close(found, expected, 0.09, format!("{visible}, {rays}"));
        }
    }

    /// A candidate that stands for many, and samples of a block, are as if each were there.
    #[test]
    fn candidates_stand_for_many() {
        let mut samples = samples(0.5);
        samples.truncate(2);
        let all: Vec<_> = samples.concat();
        let of_one: Vec<_> = all.iter().map(|of| Expected { sample: 0, ..*of }).collect();
        let [own, one] = [variance(&all, 6.0), variance(&of_one, 12.0)];
        check_close(own, one, 1e-9, "a block");
        let twice: Vec<_> = (of_one.iter().map(|of| Expected { count: 2.0, ..*of })).collect();
        let doubled: Vec<_> = of_one.iter().flat_map(|of| [*of; 2]).collect();
        let [counted, there] = [&twice, &doubled].map(|of| variance(of, 9.0));
        check_close(counted, there, 1e-9, "twice");
        check_near(variance(&twice, 104.0), 0.0, 1e-9, "all");
    }
}

//! π_c = g_c / Σ g over the candidates of its group: one ray for each light vertex, camera vertex
//! or pair of subpaths [Lafortune95, §3].

use super::{Candidate, Chosen, Draws, Selector};

/// What candidates have in common within a group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// The light vertex. For s = 1 with fresh light points: the row of next-event estimates, each
    /// with a light point of its own.
    LightVertex,
    /// The camera vertex.
    CameraVertex,
    /// The pair of subpaths.
    Pair,
}

/// Traces one candidate of each group, chosen in proportion to its score: π = g_c / Σ g
/// [Lafortune95, §3].
#[derive(Clone, Copy, Debug)]
pub struct OnePerGroup {
    /// How candidates are grouped.
    pub group: Group,
}

impl OnePerGroup {
    /// The number of a candidate's group; groups are numbered from 0.
    #[inline]
    fn number(self, candidate: &Candidate) -> u16 {
        match self.group {
            Group::LightVertex => candidate.strategy.s - 1,
            Group::CameraVertex => candidate.strategy.t - 2,
            Group::Pair => 0,
        }
    }

    /// The members of a group, each with its number among the candidates.
    #[inline]
    fn members(
        self,
        candidates: &[Candidate],
        group: u16,
    ) -> impl Iterator<Item = (usize, &Candidate)> {
        candidates
            .iter()
            .enumerate()
            .filter(move |(_, c)| self.number(c) == group)
    }

    /// Σ g of a group. In f64: scores of one group span ten orders of magnitude.
    #[inline]
    fn sum(self, candidates: &[Candidate], group: u16) -> f64 {
        self.members(candidates, group)
            .map(|(_, c)| f64::from(c.score))
            .sum()
    }
}

/// g_c / Σ g, `sum` being that of the candidate's group.
#[inline]
fn prob(candidate: &Candidate, sum: f64) -> f64 {
    f64::from(candidate.score) / sum
}

impl Selector for OnePerGroup {
    fn select(&self, candidates: &[Candidate], draws: Draws<'_>, chosen: &mut Vec<Chosen>) {
        let numbers = candidates.iter().map(|c| self.number(c) + 1);
        for group in 0..numbers.max().unwrap_or(0) {
            let sum = self.sum(candidates, group);
            let mut rest = draws.get(usize::from(group)) * sum;
            let mut picked = None;
            for (i, candidate) in self.members(candidates, group) {
                picked = Some(Chosen {
                    candidate: i as u32,
                    prob: prob(candidate, sum),
                });
                rest -= f64::from(candidate.score);
                if rest < 0.0 {
                    break;
                }
            }
            chosen.extend(picked);
        }
    }

    fn probabilities(&self, candidates: &[Candidate]) -> Vec<f64> {
        let of = |c| prob(c, self.sum(candidates, self.number(c)));
        candidates.iter().map(of).collect()
    }
}

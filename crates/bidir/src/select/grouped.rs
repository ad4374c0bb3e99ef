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
}

impl Selector for OnePerGroup {
    fn select(&self, candidates: &[Candidate], draws: Draws<'_>, chosen: &mut Vec<Chosen>) {
        let groups = candidates
            .iter()
            .map(|c| self.number(c) + 1)
            .max()
            .unwrap_or(0);
        for group in 0..groups {
            let members = || {
                candidates
                    .iter()
                    .enumerate()
                    .filter(|(_, c)| self.number(c) == group)
            };
            // In f64: scores of one group span ten orders of magnitude.
            let sum: f64 = members().map(|(_, c)| f64::from(c.score)).sum();
            let mut rest = draws.get(usize::from(group)) * sum;
            let mut picked = None;
            for (i, candidate) in members() {
                let score = f64::from(candidate.score);
                picked = Some(Chosen {
                    candidate: i as u32,
                    prob: score / sum,
                });
                rest -= score;
                if rest < 0.0 {
                    break;
                }
            }
            chosen.extend(picked);
        }
    }
}

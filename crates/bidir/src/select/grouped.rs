//! π_c = g_c / Σ g over the candidates of its group: one ray for each light vertex, camera vertex
//! or pair of subpaths [Lafortune95, §3].

use super::{Candidate, Chosen, Draws, Selector};

/// The property that candidates have in common within a group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// The light vertex. For s = 1 with fresh light points: all next-event estimates, each with its own light point.
    /// For a light cache: the vertex, not its index along its subpath; camera vertices seldom share one, so that most
    /// groups have one candidate.
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
    /// The property by which candidates are grouped.
    pub group: Group,
}

impl OnePerGroup {
    /// Returns the number of a candidate's group, which is also the number of the group's draw.
    #[inline]
    fn number(self, candidate: &Candidate) -> u32 {
        match self.group {
            Group::LightVertex => candidate.light_vertex,
            Group::CameraVertex => u32::from(candidate.term.strategy.t) - 2,
            Group::Pair => 0,
        }
    }

    /// Appends all candidates, sorted by group, without probabilities.
    #[inline]
    fn append_sorted(self, candidates: &[Candidate], members: &mut Vec<Chosen>) {
        let begin = members.len();
        members.extend((0..candidates.len() as u32).map(|candidate| Chosen {
            candidate,
            prob: 0.0,
        }));
        members[begin..].sort_unstable_by_key(|member| {
            let number = self.number(member.of(candidates));
            (number, member.candidate)
        });
    }

    /// Returns the members of each group of sorted candidates.
    #[inline]
    fn groups<'a>(
        self,
        candidates: &'a [Candidate],
        members: &'a [Chosen],
    ) -> impl Iterator<Item = &'a [Chosen]> {
        members.chunk_by(move |a, b| {
            let [a, b] = [a, b].map(|member| self.number(member.of(candidates)));
            a == b
        })
    }
}

impl Chosen {
    #[inline]
    fn of(self, candidates: &[Candidate]) -> &Candidate {
        &candidates[self.candidate as usize]
    }
}

/// Returns Σ g of a group. It is f64, because scores of one group span ten orders of magnitude.
#[inline]
fn sum(candidates: &[Candidate], group: &[Chosen]) -> f64 {
    let scores = group.iter().map(|c| f64::from(c.of(candidates).score));
    scores.sum()
}

/// Returns g_c / Σ g; `sum` is Σ g of the candidate's group.
#[inline]
fn prob(candidate: &Candidate, sum: f64) -> f64 {
    f64::from(candidate.score) / sum
}

/// Returns the member of a group that the number `u` chooses.
#[inline]
fn pick(candidates: &[Candidate], group: &[Chosen], u: f64) -> Chosen {
    let sum = sum(candidates, group);
    let mut rest = u * sum;
    let is_it = |member: &&Chosen| {
        rest -= f64::from(member.of(candidates).score);
        rest < 0.0
    };
    // If rounding leaves a rest, the last member is chosen.
    let found = group.iter().find(is_it);
    let picked = *found.unwrap_or(&group[group.len() - 1]);
    Chosen {
        prob: prob(picked.of(candidates), sum),
        ..picked
    }
}

impl Selector for OnePerGroup {
    fn select(&self, candidates: &[Candidate], draws: Draws<'_>, chosen: &mut Vec<Chosen>) {
        let mut kept = chosen.len();
        self.append_sorted(candidates, chosen);
        // Members are sorted by group: the chosen one of each moves to the front.
        let mut next = kept;
        while next < chosen.len() {
            let first = self.groups(candidates, &chosen[next..]).next();
            let group = first.expect("members are left");
            let number = self.number(group[0].of(candidates));
            let picked = pick(candidates, group, draws.get(number as usize));
            next += group.len();
            chosen[kept] = picked;
            kept += 1;
        }
        chosen.truncate(kept);
    }

    fn probabilities(&self, candidates: &[Candidate]) -> Vec<f64> {
        let mut members = Vec::with_capacity(candidates.len());
        self.append_sorted(candidates, &mut members);
        let mut probs = vec![0.0; candidates.len()];
        for group in self.groups(candidates, &members) {
            let sum = sum(candidates, group);
            for member in group {
                probs[member.candidate as usize] = prob(member.of(candidates), sum);
            }
        }
        probs
    }
}

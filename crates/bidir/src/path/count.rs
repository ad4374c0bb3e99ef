//! n_j: how many samples strategy j takes of a path in a pass, as weights count them. The only place
//! where normalisation meets weights.
//!
//! Weights are unbiased with any numbers that are one function of the path, whichever strategy made
//! it (docs/derivations/mis-weights.md). With light subpaths that samples share there are three such
//! functions, of which [`MisCount`] names one:
//!
//! - *expected*: n, the mean number of times that the path is made;
//! - *correlated*: n / (1 + α max(n - 1, 0)). The n connections of a camera vertex have its camera
//!   subpath in common. The variance of their mean is α + (1 - α)/n of that of one, with α the part that
//!   is due to the subpath; in the spirit of \[Grittmann21\] α = A / (A + B), where A and B are the
//!   densities with which a walk from the light and the camera's walk draw its vertices: what the
//!   camera alone would rarely find varies with what it found;
//! - *resampled*: n π̄, the mean number of times that its shadow ray is traced, π̄ being the mean probability
//!   with which connections of the two cells are chosen \[Nabata20\].

use super::{Connections, JoinedPath, LightProposals, PathContext, PathDensities, Vertex};
use crate::names::named;

/// What weights take for the number of samples of a strategy whose light subpaths are shared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MisCount {
    /// How often the path is made.
    #[default]
    Expected,
    /// The number of independent samples that would vary as much.
    Correlated,
    /// How often its shadow ray is traced.
    Resampled,
}

named!(MisCount {
    "expected" => Expected,
    "correlated" => Correlated,
    "resampled" => Resampled,
});

impl MisCount {
    /// True where n_j depends on the vertices that strategy j links alone, so that sums along
    /// subpaths can hold it.
    #[inline]
    pub(super) fn is_local(self) -> bool {
        self != Self::Correlated
    }
}

impl PathContext<'_> {
    /// n_j: how many samples strategy (s, t) takes in a pass of a path that it makes by linking `z`,
    /// its last light vertex, with `y`, its last camera vertex. Camera densities
    /// count per pixel, so every strategy that begins at the camera takes one; the light image takes
    /// one per light subpath. What correlation takes from it is not in it.
    #[inline]
    pub fn count(&self, s: usize, t: usize, [z, y]: [&Vertex; 2]) -> f64 {
        let Connections {
            per_vertex,
            next_events,
            proposals,
            samples_per_subpath,
            ..
        } = self.connections;
        match t {
            _ if !self.takes(s, t) => 0.0,
            1 => self.view.film().light_paths() as f64 / samples_per_subpath,
            _ if s >= self.settings.light_point.first_walked() => {
                let relative = |all: &LightProposals| all.relative(z.cell, y.cell);
                per_vertex[usize::from(t > 2)] * proposals.map_or(1.0, relative)
            }
            _ => {
                let counted = |all: &LightProposals| all.next_events(y.cell);
                next_events[usize::from(t > 2)] * proposals.map_or(1.0, counted)
            }
        }
    }

    /// The same for s = 0, which links nothing.
    #[inline]
    pub fn count_hits(&self, t: usize) -> f64 {
        f64::from(self.takes(0, t))
    }
}

impl JoinedPath<'_> {
    /// n_j of this path with these densities, as its weight takes it.
    pub(super) fn count(
        &self,
        context: &PathContext<'_>,
        densities: &PathDensities,
        j: usize,
    ) -> f64 {
        let t = self.len() - j;
        if j == 0 || t == 0 {
            return context.count_hits(t);
        }
        let count = context.count(j, t, [self.vertex(j - 1), self.vertex(j)]);
        let is_shared = t > 1 && j >= context.settings.light_point.first_walked();
        match context.connections.mis_count {
            MisCount::Correlated if is_shared => {
                count / (1.0 + densities.common_part(j) * (count - 1.0).max(0.0))
            }
            _ => count,
        }
    }
}

impl PathDensities {
    /// α of the camera subpath that strategy `s` walks: 1 / (1 + Π b_i / a_i) over its vertices but the
    /// lens point.
    fn common_part(&self, s: usize) -> f64 {
        let walked = &self.vertices[s..self.vertices.len() - 1];
        let ratio = |x: &super::VertexDensities| f64::from(x.from_camera) / f64::from(x.from_light);
        1.0 / (1.0 + walked.iter().map(ratio).product::<f64>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::VertexDensities;

    /// What only the camera finds is no correlation, what only the light finds is all of it.
    #[test]
    fn what_the_camera_finds_by_itself_counts_in_full() {
        let vertex = |from_light, from_camera| VertexDensities {
            from_light,
            from_camera,
            is_delta: false,
        };
        let path = |a, b| PathDensities {
            vertices: vec![
                vertex(1.0, 1.0),
                vertex(a, b),
                vertex(2.0, 2.0),
                vertex(1.0, 1.0),
            ],
            next_event: 1.0,
            light_is_delta: false,
        };
        for (a, b, expected) in [
            (1.0, 3.0, 0.25),
            (3.0, 1.0, 0.75),
            (0.0, 1.0, 0.0),
            (1.0, 0.0, 1.0),
        ] {
            assert!((path(a, b).common_part(1) - expected).abs() < 1e-12);
            assert!((path(a, b).common_part(2) - 0.5).abs() < 1e-12);
        }
    }
}

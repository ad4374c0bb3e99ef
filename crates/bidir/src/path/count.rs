//! n_j: how many samples strategy j takes of a path in a pass, as weights count them. The only place
//! where normalisation meets weights.
//!
//! Weights are unbiased with any numbers that are one function of the path, whichever strategy made
//! it (docs/derivations/mis-weights.md). n_j depends on the two vertices that strategy j links alone, so that
//! sums along subpaths can hold it.

use super::{Connections, JoinedPath, LightProposals, PathContext, Vertex};

impl PathContext<'_> {
    /// n_j: how many samples strategy (s, t) takes in a pass of a path that it makes by linking `z`,
    /// its last light vertex, with `y`, its last camera vertex. Camera densities
    /// count per pixel, so every strategy that begins at the camera takes one; the light image takes
    /// one per light subpath.
    #[inline]
    pub fn count(&self, s: usize, t: usize, [z, y]: [&Vertex; 2]) -> f64 {
        let Connections {
            per_vertex,
            next_events,
            proposals,
            light_subpaths,
            ..
        } = self.connections;
        match t {
            _ if !self.takes(s, t) => 0.0,
            1 => light_subpaths,
            _ if s >= self.settings.light_point.first_walked() => {
                let relative = |all: &LightProposals| all.relative(z.cell, y.cell);
                per_vertex[usize::from(t > 2)] * proposals.map_or(1.0, relative)
            }
            _ => next_events[usize::from(t > 2)],
        }
    }

    /// The same for s = 0, which links nothing.
    #[inline]
    pub fn count_hits(&self, t: usize) -> f64 {
        f64::from(self.takes(0, t))
    }
}

impl JoinedPath<'_> {
    /// n_j of this path, as its weight takes it.
    pub(super) fn count(&self, context: &PathContext<'_>, j: usize) -> f64 {
        match (j, self.len() - j) {
            (0, t) | (_, t @ 0) => context.count_hits(t),
            (s, t) => context.count(s, t, [self.vertex(s - 1), self.vertex(s)]),
        }
    }
}

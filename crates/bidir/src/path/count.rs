//! n_j: how many samples strategy j takes of a path in a pass, as weights count them. The only place
//! where normalisation meets weights.
//!
//! Weights are unbiased with any numbers that are one function of the path, whichever strategy made
//! it (docs/derivations/mis-weights.md). n_j depends on the two vertices that strategy j links alone, so that
//! sums along subpaths can hold it.

use super::{Job, JoinedPath};
use crate::film::FilmSettings;
use crate::guide::{Cell, CellGuide};

/// How many samples of a path strategies take in a pass, before the [`Guide`](crate::guide::Guide) shares
/// them out.
#[derive(Clone, Copy, Debug)]
pub struct SampleCounts {
    /// Connections with a light vertex of the path, on average: of the first vertex of a camera subpath (t = 2),
    /// and of those behind it.
    pub connections: [f64; 2],
    /// The same for s = 1.
    pub next_events: [f64; 2],
    /// Light subpaths, each with one light image.
    pub light_subpaths: f64,
}

impl SampleCounts {
    /// Every vertex of one light subpath is connected; each sample of `film` has its own.
    pub fn of_own_subpaths(film: &FilmSettings) -> Self {
        Self {
            connections: [1.0; 2],
            next_events: [1.0; 2],
            light_subpaths: film.light_paths() as f64,
        }
    }
}

impl Job<'_> {
    /// Returns n_j: how many samples strategy (s, t) takes in a pass of a path that it makes by linking its last light
    /// vertex, in the cell `z`, with its last camera vertex, in the cell `y`. Camera densities
    /// count per pixel, so every strategy that begins at the camera takes one; the light image takes
    /// one per light subpath.
    #[inline]
    pub fn count(&self, s: usize, t: usize, [z, y]: [Cell; 2]) -> f64 {
        let SampleCounts {
            next_events,
            light_subpaths,
            ..
        } = self.counts;
        match t {
            _ if !self.takes(s, t) => 0.0,
            1 => light_subpaths,
            _ if s >= self.settings.light_point.first_walked() => self.count_walked(t, [z, y]),
            _ => next_events[usize::from(t > 2)],
        }
    }

    /// Returns n_j of a strategy that takes part and links a vertex of a light subpath with camera vertex number `t` ≥
    /// 2.
    #[inline]
    fn count_walked(&self, t: usize, [z, y]: [Cell; 2]) -> f64 {
        self.count_from(t, self.guide.of_camera(y), z)
    }

    /// The same, where it is known what the guide knows of the camera vertex.
    #[inline(always)]
    pub(crate) fn count_from(&self, t: usize, of_camera: CellGuide<'_>, z: Cell) -> f64 {
        self.counts.connections[usize::from(t > 2)] * of_camera.count_factor(z)
    }

    /// Returns n_j of s = 0, which links nothing.
    #[inline]
    pub fn count_hits(&self, t: usize) -> f64 {
        f64::from(self.takes(0, t))
    }
}

impl JoinedPath<'_> {
    /// Returns n_j of this path, as its weight takes it.
    pub(super) fn count(&self, job: &Job<'_>, j: usize) -> f64 {
        match (j, self.len() - j) {
            (0, t) | (_, t @ 0) => job.count_hits(t),
            (s, t) => job.count(s, t, [self.vertex(s - 1).cell, self.vertex(s).cell]),
        }
    }
}

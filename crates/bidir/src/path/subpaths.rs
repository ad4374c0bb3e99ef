//! Subpaths: the vertices that walks leave, one walk behind the other.

use super::{Job, RunningSums, Vertex};
use crate::math::Vec3;
use crate::spectrum::Spectrum;

/// A camera walk that left the scene.
#[derive(Clone, Copy, Debug)]
pub struct Escape {
    /// The unit direction.
    pub direction: Vec3,
    /// Throughput, the last scattering included.
    pub beta: Spectrum,
    /// The density of the direction, without roulette. Measure: solid angle, 1/sr.
    pub pdf_fwd: f32,
    /// The factor that turns a density of the direction back into one of the last vertex.
    pub to_previous: f32,
}

/// One walk, from its end of the path.
#[derive(Clone, Copy, Debug, Default)]
pub struct Subpath<'a> {
    /// The number of its first vertex among all of [`Subpaths`].
    pub first: usize,
    /// The vertices; empty where the walk could not start.
    pub vertices: &'a [Vertex],
    /// The walk's escape from the scene, if it left it.
    pub escape: Option<Escape>,
}

/// The walks of a batch, one behind the other, and behind them single points.
#[derive(Debug, Default)]
pub struct Subpaths {
    pub(super) vertices: Vec<Vertex>,
    walks: Vec<Walk>,
    /// Sums along the walks that [`add_sums`](Self::add_sums) was asked for.
    pub(crate) sums: RunningSums,
}

/// How a walk ended.
#[derive(Clone, Copy, Debug)]
struct Walk {
    /// One past the number of its last vertex.
    end: usize,
    escape: Option<Escape>,
}

impl Subpaths {
    /// Forgets all, and keeps the memory.
    pub fn clear(&mut self) {
        self.vertices.clear();
        self.walks.clear();
        self.sums.clear();
    }

    /// Returns the number of walks.
    pub fn count(&self) -> usize {
        self.walks.len()
    }

    /// Adds the sums along the walks from number `first` on, which follow those that have sums.
    pub(crate) fn add_sums(&mut self, job: &Job<'_>, first: usize) {
        let mut sums = std::mem::take(&mut self.sums);
        for i in first..self.walks.len() {
            sums.add(job, &self.get(i));
        }
        self.sums = sums;
    }

    /// Returns walk number `i`.
    #[inline]
    pub fn get(&self, i: usize) -> Subpath<'_> {
        let first = if i == 0 { 0 } else { self.walks[i - 1].end };
        let Walk { end, escape } = self.walks[i];
        Subpath {
            first,
            vertices: &self.vertices[first..end],
            escape,
        }
    }

    /// Returns all vertices, those of the single points last.
    #[inline]
    pub fn vertices(&self) -> &[Vertex] {
        &self.vertices
    }

    /// Begins to load vertex number `i` and the one before it.
    #[inline]
    pub(crate) fn load_ahead(&self, i: usize) {
        accel::load_ahead(&self.vertices[i.saturating_sub(1)..=i]);
    }

    /// Begins to load the place of vertex number `i`.
    #[inline]
    pub(crate) fn load_locus_ahead(&self, i: usize) {
        accel::load_ahead(std::slice::from_ref(&self.vertices[i].locus));
    }

    /// Returns the number of vertices of walks, behind which the single points are.
    #[inline]
    pub(crate) fn walk_vertices(&self) -> usize {
        self.walks.last().map_or(0, |walk| walk.end)
    }

    /// Adds a single point; returns its number among all vertices. Points are forgotten before the next walk.
    #[inline]
    pub(crate) fn add_point(&mut self, point: &Vertex) -> usize {
        self.vertices.push(*point);
        self.vertices.len() - 1
    }

    /// Forgets the single points.
    pub(crate) fn forget_points(&mut self) {
        self.vertices.truncate(self.walk_vertices());
    }

    /// Adds a walk of these vertices.
    #[cfg(test)]
    pub(crate) fn add(&mut self, vertices: impl Iterator<Item = Vertex>) {
        self.vertices.extend(vertices);
        self.end(None);
    }

    /// Ends a walk.
    pub(super) fn end(&mut self, escape: Option<Escape>) {
        let end = self.vertices.len();
        self.walks.push(Walk { end, escape });
    }
}

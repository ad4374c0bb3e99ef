//! The light subpaths of a group of samples, in the order of the samples.

use crate::path::{LightEnd, LightShares, PathContext, RunningSums, Subpath, Vertex};

/// Light subpaths, one for each sample of a group.
#[derive(Debug, Default)]
pub(crate) struct LightCache {
    vertices: Vec<Vertex>,
    /// For each vertex the sum of its number along its subpath, as long as there is one.
    sums: Vec<f64>,
    subpaths: Vec<Start>,
    /// The vertices that can be connected.
    entries: Vec<Entry>,
}

/// How a subpath begins.
#[derive(Clone, Copy, Debug)]
struct Start {
    vertex: u32,
    end: LightEnd,
}

/// A vertex that can be connected.
#[derive(Clone, Copy, Debug)]
struct Entry {
    vertex: u32,
    subpath: u32,
}

/// A vertex of the cache, with the subpath up to it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cached<'a> {
    /// From x_0 to the vertex.
    pub(crate) light: &'a [Vertex],
    /// The sums along its subpath.
    pub(crate) shares: LightShares<'a>,
}

impl LightCache {
    /// Forgets all, and keeps the memory.
    pub(super) fn clear(&mut self) {
        self.vertices.clear();
        self.sums.clear();
        self.subpaths.clear();
        self.entries.clear();
    }

    /// Keeps a subpath, which may be empty, with the sums along it.
    pub(super) fn push(
        &mut self,
        context: &PathContext<'_>,
        subpath: &Subpath,
        weights: &RunningSums,
    ) {
        let shares = weights.light_shares();
        let (first, number) = (self.vertices.len(), self.subpaths.len() as u32);
        self.subpaths.push(Start {
            vertex: first as u32,
            end: shares.start,
        });
        self.vertices.extend_from_slice(&subpath.vertices);
        self.sums.extend_from_slice(shares.sums);
        self.sums.resize(self.vertices.len(), 0.0);
        let connectable = connectable(context, &subpath.vertices);
        self.entries.extend(connectable.map(|i| Entry {
            vertex: (first + i) as u32,
            subpath: number,
        }));
    }

    /// How many vertices can be connected.
    #[inline]
    pub(super) fn len(&self) -> usize {
        self.entries.len()
    }

    /// How many that is for each subpath.
    #[inline]
    pub(super) fn per_subpath(&self) -> f64 {
        self.entries.len() as f64 / self.subpaths.len() as f64
    }

    /// Number `i` of the vertices that can be connected.
    #[inline]
    pub(crate) fn get(&self, i: usize) -> Cached<'_> {
        let Entry { vertex, subpath } = self.entries[i];
        let start = &self.subpaths[subpath as usize];
        let range = start.vertex as usize..vertex as usize + 1;
        Cached {
            shares: LightShares {
                sums: &self.sums[range.clone()],
                start: start.end,
            },
            light: &self.vertices[range],
        }
    }
}

/// The vertices of a light subpath that camera vertices may be connected with, by number.
pub(crate) fn connectable(
    context: &PathContext<'_>,
    subpath: &[Vertex],
) -> impl Iterator<Item = usize> {
    let first = context.settings.light_point.first_walked() - 1;
    (first..subpath.len()).filter(move |&i| !subpath[i].is_delta())
}

//! The light subpaths of a group of samples, in the order of the samples.

use crate::path::{
    Cell, CellDraw, Cells, LightEnd, LightPointChoice, LightProposals, LightShares, RunningSums,
    Subpath, Vertex,
};
use std::ops::Range;

/// Light subpaths that samples of a group brought.
#[derive(Debug, Default)]
pub(crate) struct LightCache {
    vertices: Vec<Vertex>,
    /// For each vertex the sum of its number along its subpath, as long as there is one.
    sums: Vec<f64>,
    subpaths: Vec<Start>,
    /// The vertices that can be connected, those of a cell beside each other.
    entries: Vec<Entry>,
    /// The same, in the order of the subpaths.
    unsorted: Vec<Entry>,
    /// For each cell where its entries begin, and where the last ones end. Empty: there are no cells.
    begins: Vec<u32>,
    /// For each cell, where its next entry goes while they are sorted.
    next: Vec<u32>,
}

/// How a subpath begins.
#[derive(Clone, Copy, Debug)]
struct Start {
    vertex: u32,
    end: LightEnd,
}

/// A vertex that can be connected.
#[derive(Clone, Copy, Debug, Default)]
struct Entry {
    vertex: u32,
    subpath: u32,
    cell: Cell,
}

/// A vertex that was drawn from the cache.
#[derive(Clone, Copy, Debug)]
pub(super) struct Draw {
    /// Its number.
    pub(super) entry: usize,
    /// 1 / (N P), with N subpaths and P the probability of drawing it.
    pub(super) share: f64,
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
        self.unsorted.clear();
        self.begins.clear();
    }

    /// Keeps a subpath, which may be empty, with the sums along it.
    pub(super) fn push(
        &mut self,
        light_point: LightPointChoice,
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
        let connectable = connectable(light_point, &subpath.vertices);
        self.unsorted.extend(connectable.map(|i| Entry {
            vertex: (first + i) as u32,
            subpath: number,
            cell: subpath.vertices[i].cell,
        }));
    }

    /// Makes ready for draws, when all subpaths are here.
    pub(super) fn sort(&mut self, proposals: Option<&LightProposals>) {
        if proposals.is_none() {
            std::mem::swap(&mut self.entries, &mut self.unsorted);
            return;
        }
        self.begins.resize(Cells::COUNT + 1, 0);
        for entry in &self.unsorted {
            self.begins[entry.cell.index() + 1] += 1;
        }
        for i in 0..Cells::COUNT {
            self.begins[i + 1] += self.begins[i];
        }
        self.next.clone_from(&self.begins);
        self.entries.resize(self.unsorted.len(), Entry::default());
        for entry in &self.unsorted {
            let place = &mut self.next[entry.cell.index()];
            self.entries[*place as usize] = *entry;
            *place += 1;
        }
    }

    /// Draws a vertex for the camera vertex `y` by the number `u`. None: there is none, and the draw
    /// counts as one that finds nothing.
    #[inline]
    pub(super) fn draw(
        &self,
        proposals: Option<&LightProposals>,
        y: &Vertex,
        u: f64,
    ) -> Option<Draw> {
        let all = 0..self.entries.len();
        let subpaths = self.subpaths.len() as f64;
        let Some(proposals) = proposals else {
            let share = all.len() as f64 / subpaths;
            return pick(&all, u).map(|entry| Draw { entry, share });
        };
        let entry = match proposals.draw(y.cell, u) {
            CellDraw::All(u) => pick(&all, u),
            CellDraw::One(cell, u) => pick(&self.of_cell(cell), u),
        }?;
        let cell = self.entries[entry].cell;
        let counts = [all.len(), self.of_cell(cell).len()];
        let share = 1.0 / (subpaths * proposals.prob(cell, y.cell, counts));
        Some(Draw { entry, share })
    }

    /// The entries of a cell.
    #[inline]
    fn of_cell(&self, cell: Cell) -> Range<usize> {
        let cell = cell.index();
        self.begins[cell] as usize..self.begins[cell + 1] as usize
    }

    /// Number `i` of the vertices that can be connected.
    #[inline]
    pub(crate) fn get(&self, i: usize) -> Cached<'_> {
        let Entry {
            vertex, subpath, ..
        } = self.entries[i];
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

/// The number at the part `u` of a range. None: it is empty.
#[inline]
fn pick(range: &Range<usize>, u: f64) -> Option<usize> {
    let i = range.start + (u * range.len() as f64) as usize;
    // Rounding may lead to the end.
    (!range.is_empty()).then(|| i.min(range.end - 1))
}

/// The vertices of a light subpath that camera vertices may be connected with, by number.
pub(crate) fn connectable(
    light_point: LightPointChoice,
    subpath: &[Vertex],
) -> impl Iterator<Item = usize> {
    let first = light_point.first_walked() - 1;
    (first..subpath.len()).filter(move |&i| !subpath[i].is_delta())
}

//! The light vertex cache: which vertices of a group's light subpaths can be connected, and draws of them.

use crate::guide::{Cell, CellDraw, Cells, LightProposals};
use crate::path::{LightPointChoice, RunningSums, Subpath, Subpaths, Vertex};
use std::ops::Range;

/// An index of the light vertices that can be connected.
#[derive(Debug, Default)]
pub(super) struct LightCache {
    /// The vertices that can be connected, in the order of their cells.
    entries: Vec<CachedVertex>,
    /// The same vertices, in the order of the subpaths.
    unsorted: Vec<CachedVertex>,
    /// The number of subpaths.
    subpaths: usize,
    /// For each cell where its entries begin, and where the last ones end. Empty: there are no cells.
    begins: Vec<u32>,
    /// For each cell, where its next entry goes while they are sorted.
    next: Vec<u32>,
}

/// A vertex that can be connected.
#[derive(Clone, Copy, Debug, Default)]
struct CachedVertex {
    place: Place,
    cell: Cell,
}

/// The place of a light vertex.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Place {
    /// Its number among all light vertices.
    pub(super) z: u32,
    /// The number of vertices of the subpath up to it.
    pub(super) s: u16,
    /// True where the sums have it as a diffuse vertex.
    pub(super) is_diffuse: bool,
    /// The light that its subpath begins on.
    pub(super) light: Option<u32>,
}

/// A vertex that was drawn from the cache to be connected with a camera vertex.
#[derive(Clone, Copy, Debug)]
pub(super) struct CachedEnd {
    /// The sample, by number.
    pub(super) sample: u32,
    /// The number of the camera vertex.
    pub(super) t: u32,
    /// The number of the vertex in the cache.
    pub(super) entry: u32,
    /// How much its connection counts.
    pub(super) share: f32,
    /// Its place.
    pub(super) place: Place,
}

/// A draw from the cache.
#[derive(Clone, Copy, Debug)]
pub(super) struct Draw {
    /// Its number.
    pub(super) entry: usize,
    /// 1 / (N P), with N subpaths and P the probability of drawing it.
    pub(super) share: f64,
}

impl LightCache {
    /// Forgets all, and keeps the memory.
    pub(super) fn clear(&mut self) {
        self.entries.clear();
        self.unsorted.clear();
        self.begins.clear();
        self.subpaths = 0;
    }

    /// Takes the vertices of all these walks, and makes ready for draws.
    pub(super) fn index(
        &mut self,
        walks: &Subpaths,
        sums: &RunningSums,
        light_point: LightPointChoice,
        proposals: Option<&LightProposals>,
    ) {
        self.clear();
        self.subpaths = walks.count();
        for subpath in 0..walks.count() {
            let Subpath {
                first, vertices, ..
            } = walks.get(subpath);
            let connectable = connectable(light_point, vertices);
            self.unsorted.extend(connectable.map(|i| CachedVertex {
                place: Place {
                    z: (first + i) as u32,
                    s: i as u16 + 1,
                    is_diffuse: sums.diffuse(first + i).is_some(),
                    light: vertices[0].light,
                },
                cell: vertices[i].cell,
            }));
        }
        match proposals {
            None => std::mem::swap(&mut self.entries, &mut self.unsorted),
            Some(_) => self.sort(),
        }
    }

    fn sort(&mut self) {
        self.begins.resize(Cells::COUNT + 1, 0);
        for entry in &self.unsorted {
            self.begins[entry.cell.index() + 1] += 1;
        }
        for i in 0..Cells::COUNT {
            self.begins[i + 1] += self.begins[i];
        }
        self.next.clone_from(&self.begins);
        self.entries
            .resize(self.unsorted.len(), CachedVertex::default());
        for entry in &self.unsorted {
            let place = &mut self.next[entry.cell.index()];
            self.entries[*place as usize] = *entry;
            *place += 1;
        }
    }

    /// Draws a vertex for a camera vertex in the cell `y` by the number `u`. None: there is none, and the draw
    /// counts as one that finds nothing.
    #[inline]
    pub(super) fn draw(&self, proposals: Option<&LightProposals>, y: Cell, u: f64) -> Option<Draw> {
        let all = 0..self.entries.len();
        let subpaths = self.subpaths as f64;
        let Some(proposals) = proposals else {
            let share = all.len() as f64 / subpaths;
            return pick(&all, u).map(|entry| Draw { entry, share });
        };
        let entry = match proposals.draw(y, u) {
            CellDraw::All(u) => pick(&all, u),
            CellDraw::One(cell, u) => pick(&self.of_cell(cell), u),
        }?;
        let cell = self.entries[entry].cell;
        let counts = [all.len(), self.of_cell(cell).len()];
        let share = 1.0 / (subpaths * proposals.prob(cell, y, counts));
        Some(Draw { entry, share })
    }

    /// The entries of a cell.
    #[inline]
    fn of_cell(&self, cell: Cell) -> Range<usize> {
        let cell = cell.index();
        self.begins[cell] as usize..self.begins[cell + 1] as usize
    }

    /// The place of entry number `i`.
    #[inline]
    pub(super) fn place(&self, i: usize) -> Place {
        self.entries[i].place
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

#[cfg(test)]
mod tests;

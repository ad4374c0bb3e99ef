//! The light vertex cache: which vertices of a group's light subpaths can be connected, and draws of them.

use crate::guide::{Cell, CellDraw, Cells, LightProposals, ProposalRow};
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
    pub(super) light: u32,
}

impl Place {
    /// The place of vertex number `i` of a light subpath, of which there are `sums`. None: the subpath begins on no
    /// light.
    #[inline]
    pub(super) fn new(subpath: &Subpath<'_>, i: usize, sums: &RunningSums) -> Option<Self> {
        let z = subpath.first + i;
        Some(Self {
            z: z as u32,
            s: i as u16 + 1,
            is_diffuse: sums.diffuse(z).is_some(),
            light: subpath.vertices[0].light?,
        })
    }
}

/// A draw from the cache.
#[derive(Clone, Copy, Debug)]
struct Draw {
    /// The number of the vertex.
    entry: usize,
    /// 1 / (N P), with N subpaths and P the probability of drawing it.
    share: f64,
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
            let subpath = walks.get(subpath);
            let connectable = connectable(light_point, subpath.vertices);
            self.unsorted.extend(connectable.filter_map(|i| {
                let place = Place::new(&subpath, i, sums)?;
                let cell = subpath.vertices[i].cell;
                Some(CachedVertex { place, cell })
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

    /// Draws `count` vertices for a camera vertex with the proposals `row`, one of each of as many parts of the
    /// proposals, at the part `u` of each: their numbers, and how much each counts, 1 / (`count` N P). A part in which
    /// there is no vertex counts as a draw that finds nothing.
    #[inline]
    pub(super) fn draw_all(
        &self,
        row: Option<&ProposalRow>,
        count: u16,
        u: f64,
    ) -> impl Iterator<Item = (usize, f32)> {
        let part = 1.0 / f64::from(count);
        (0..count).filter_map(move |m| {
            let draw = self.draw(row, (f64::from(m) + u) * part)?;
            Some((draw.entry, (draw.share * part) as f32))
        })
    }

    /// Draws a vertex by the number `u` for a camera vertex with the proposals `row`. None: there is none, and the
    /// draw counts as one that finds nothing.
    #[inline]
    fn draw(&self, row: Option<&ProposalRow>, u: f64) -> Option<Draw> {
        let all = 0..self.entries.len();
        let of_subpath = 1.0 / self.subpaths as f64;
        let Some(row) = row else {
            let share = all.len() as f64 * of_subpath;
            return pick(&all, u).map(|entry| Draw { entry, share });
        };
        let (entry, cell) = match row.draw(u) {
            CellDraw::All(u) => pick(&all, u).map(|entry| (entry, self.entries[entry].cell)),
            CellDraw::One(cell, u) => pick(&self.of_cell(cell), u).map(|entry| (entry, cell)),
        }?;
        let counts = [all.len(), self.of_cell(cell).len()];
        let share = row.inverse_prob(cell, counts) * of_subpath;
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
    // Numbers of 32 bits are converted much faster than those of 64.
    let i = range.start + (u * range.len() as f64) as u32 as usize;
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

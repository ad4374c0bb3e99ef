//! The light vertex cache: which vertices of a group's light subpaths can be connected, and draws of them.

use super::curve::Curve;
use crate::guide::{Cell, CellDraw, Cells, LightProposals, Part, ProposalRow, inverse_prob};
use crate::math::Vec3;
use crate::path::{LightPointChoice, RunningSums, Subpath, Subpaths, Vertex};

/// An index of the light vertices that can be connected.
#[derive(Debug, Default)]
pub(super) struct LightCache {
    /// The vertices that can be connected, in the order of their cells.
    entries: Vec<CachedVertex>,
    /// The same vertices, in the order of the subpaths.
    unsorted: Vec<CachedVertex>,
    /// Where those lie.
    points: Vec<Vec3>,
    /// Memory for sorting.
    keys: Vec<u64>,
    /// The number of subpaths.
    subpaths: usize,
    cells: CellTable,
}

/// The bits of the number of an entry, below those of its position on the curve and of its cell.
const INDEX_BITS: u32 = 26;
const _: () = assert!(u8::BITS + Curve::BITS + INDEX_BITS == u64::BITS);

/// The entries of each cell; none where there are no cells.
#[derive(Debug)]
struct CellTable(Box<[Entries; Cells::NAMES]>);

/// Entries that follow each other.
#[derive(Clone, Copy, Debug, Default)]
struct Entries {
    first: u32,
    count: u32,
}

impl Default for CellTable {
    fn default() -> Self {
        Self(Box::new([Entries::default(); Cells::NAMES]))
    }
}

impl CellTable {
    /// Returns the entries of a cell.
    #[inline]
    fn of(&self, cell: Cell) -> Entries {
        self.0[cell.index()]
    }

    fn of_mut(&mut self, cell: Cell) -> &mut Entries {
        &mut self.0[cell.index()]
    }
}

/// A vertex that can be connected.
#[derive(Clone, Copy, Debug, Default)]
struct CachedVertex {
    vertex: LightVertexRef,
    cell: Cell,
}

/// A light vertex of a batch.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LightVertexRef {
    /// Its number among all light vertices.
    pub(super) z: u32,
    /// The number of vertices of the subpath up to it.
    pub(super) s: u16,
    /// True where the sums have it as a diffuse vertex.
    pub(super) is_diffuse: bool,
    /// The light that its subpath begins on.
    pub(super) light: u32,
}

impl LightVertexRef {
    /// Returns vertex number `i` of a light subpath, of which there are `sums`.
    #[inline]
    pub(super) fn new(subpath: &Subpath<'_>, i: usize, sums: &RunningSums) -> Self {
        let z = subpath.first + i;
        Self {
            z: z as u32,
            s: i as u16 + 1,
            is_diffuse: sums.diffuse(z).is_some(),
            // It begins on a light.
            light: subpath.vertices[0].light.unwrap_or_default(),
        }
    }
}

/// A draw from the cache.
#[derive(Clone, Copy, Debug)]
struct Draw {
    /// The number of the vertex.
    entry: usize,
    /// 1 / P, with P the probability of drawing it.
    inverse_prob: f32,
}

impl LightCache {
    /// Forgets all, and keeps the memory.
    pub(super) fn clear(&mut self) {
        self.entries.clear();
        self.unsorted.clear();
        self.points.clear();
        self.subpaths = 0;
    }

    /// Takes the vertices of all these walks, and makes ready for draws.
    pub(super) fn index(
        &mut self,
        walks: &Subpaths,
        light_point: LightPointChoice,
        proposals: Option<&LightProposals>,
    ) {
        self.clear();
        self.subpaths = walks.count();
        for subpath in 0..walks.count() {
            let subpath = walks.get(subpath);
            let connectable = connectable(light_point, subpath.vertices);
            for i in connectable {
                let vertex = LightVertexRef::new(&subpath, i, &walks.sums);
                let Vertex { cell, locus, .. } = subpath.vertices[i];
                self.unsorted.push(CachedVertex { vertex, cell });
                self.points.push(locus.point);
            }
        }
        match proposals {
            None => std::mem::swap(&mut self.entries, &mut self.unsorted),
            Some(_) => self.sort(),
        }
    }

    /// Sorts the entries by their cells, and within each along a curve that fills space: draws by numbers that are
    /// evenly spaced then lie evenly in the cell.
    fn sort(&mut self) {
        let curve = Curve::around(&self.points);
        let of_entry = self.unsorted.iter().zip(&self.points).zip(0u64..);
        self.keys.clear();
        self.keys.extend(of_entry.map(|((entry, &point), i)| {
            let cell = entry.cell.index() as u64;
            (cell << Curve::BITS | curve.position(point)) << INDEX_BITS | i
        }));
        self.keys.sort_unstable();
        self.entries.clear();
        let entry = |key: &u64| self.unsorted[(key % (1 << INDEX_BITS)) as usize];
        self.entries.extend(self.keys.iter().map(entry));
        self.cells.0.fill(Entries::default());
        for (entry, i) in self.entries.iter().zip(0..) {
            let of_cell = self.cells.of_mut(entry.cell);
            if of_cell.count == 0 {
                of_cell.first = i;
            }
            of_cell.count += 1;
        }
    }

    /// Draws `count` vertices for a camera vertex with the proposals `row`, one of each of as many parts of the
    /// proposals, at the part `u` / 2^32 of each. Calls `found` with their numbers and vertices, and how much each
    /// counts, 1 / (`count` N P) with N subpaths. A part in which there is no vertex counts as a draw that finds
    /// nothing.
    #[inline]
    pub(super) fn draw_all(
        &self,
        row: Option<&ProposalRow>,
        count: u16,
        u: u32,
        mut found: impl FnMut(usize, &LightVertexRef, f32),
    ) {
        let of_draw = 1.0 / (self.subpaths as f32 * f32::from(count));
        for number in numbers(count, u) {
            let draw = match row {
                Some(row) => self.draw_learned(row, number),
                None => self.draw_any(number),
            };
            if let Some((vertex, draw)) = draw {
                found(draw.entry, vertex, draw.inverse_prob * of_draw);
            }
        }
    }

    /// Draws a vertex by `number`, one of 2^32, each as likely as others. None: there is none, and the draw counts as
    /// one that finds nothing.
    #[inline]
    fn draw_any(&self, number: u32) -> Option<(&LightVertexRef, Draw)> {
        let all = self.entries.len() as u32;
        let entry = Part::of_all(number).pick(all);
        let inverse_prob = all as f32;
        let vertex = &self.entries.get(entry)?.vertex;
        let draw = Draw {
            entry,
            inverse_prob,
        };
        Some((vertex, draw))
    }

    /// The same for a camera vertex with the proposals `row`.
    #[inline]
    fn draw_learned(&self, row: &ProposalRow, number: u32) -> Option<(&LightVertexRef, Draw)> {
        let all = self.entries.len() as u32;
        let (entry, units, count) = match row.draw(number) {
            CellDraw::All(part) => {
                let entry = part.pick(all);
                let cell = self.entries.get(entry)?.cell;
                (entry, row.units(cell), self.cells.of(cell).count)
            }
            CellDraw::One(cell, units, part) => {
                let Entries { first, count } = self.cells.of(cell);
                if count == 0 {
                    return None;
                }
                (first as usize + part.pick(count), units, count)
            }
        };
        let vertex = &self.entries.get(entry)?.vertex;
        let draw = Draw {
            entry,
            inverse_prob: inverse_prob(units, [all, count]),
        };
        Some((vertex, draw))
    }
}

/// Returns a number below 2^32 in each of `count` equal parts, at the part `u` / 2^32 of it.
#[inline]
fn numbers(count: u16, u: u32) -> impl Iterator<Item = u32> {
    // With 32 more bits than the numbers have, so that the parts are equal.
    let count = u64::from(count);
    let (first, part) = ((u64::from(u) << 32) / count, u64::MAX / count);
    (0..count).map(move |m| ((first + m * part) >> 32) as u32)
}

/// Returns the vertices of a light subpath that camera vertices may be connected with, by number.
pub(crate) fn connectable(
    light_point: LightPointChoice,
    subpath: &[Vertex],
) -> impl Iterator<Item = usize> {
    let first = light_point.min_subpath_s() - 1;
    (first..subpath.len()).filter(move |&i| !subpath[i].is_delta())
}

#[cfg(test)]
mod tests;

//! The tree of a grid: a root, two kinds of inner nodes, and leaves of 8³ cells.
//!
//! A child of the root has 32³ children of 128³ cells, and each of these has 16³ leaves. All cells of a missing child
//! have one value.

use super::{Bytes, CellBox, GRID, broken};
use crate::error::{Error, Result};
use std::collections::BTreeSet;

/// Size of the part of a root before its tiles. Unit: bytes.
const ROOT: usize = 64;
const TILE: usize = 32;
/// Number of bits of a cell's index within a child of the root, along each axis.
const ROOT_BITS: u32 = 12;

/// A kind of inner node.
struct Inner {
    /// Number of bits of a child's index, along each axis.
    bits: u32,
    /// Number of bits of a cell's index within a child, along each axis.
    child_bits: u32,
    /// Offset of the mask of children in a node, after the mask of values. Unit: bytes.
    children: usize,
    /// Offset of the table of children and values in a node. Unit: bytes.
    table: usize,
}

const UPPER: Inner = Inner {
    bits: 5,
    child_bits: 7,
    children: 32 + 4096,
    table: 8256,
};
const LOWER: Inner = Inner {
    bits: 4,
    child_bits: 3,
    children: 32 + 512,
    table: 1088,
};
/// Offset of the values in a leaf. Unit: bytes.
const LEAF: usize = 96;

/// Returns the offset of the root.
fn root(bytes: Bytes<'_>) -> Result<usize> {
    bytes.place(GRID, GRID + 24)
}

/// Returns the bounding box of the active cells.
pub(super) fn bounds(bytes: Bytes<'_>) -> Result<CellBox> {
    let root = root(bytes)?;
    let (first, last) = (bytes.cell(root)?, bytes.cell(root + 12)?);
    if first.iter().zip(&last).any(|(first, last)| first > last) {
        return Err(broken("the grid is empty"));
    }
    Ok(CellBox { first, last })
}

/// Returns the values of the cells of a box, x fastest. The caller has to count the cells before.
pub(super) fn values(bytes: Bytes<'_>, within: CellBox) -> Result<Vec<f32>> {
    let root = root(bytes)?;
    let tiles = bytes.u32(root + 24)? as usize;
    let background = bytes.f32(root + 28)?;
    let mut dense = Dense::new(within, background)?;
    let mut seen = BTreeSet::new();
    for tile in (0..tiles).map(|i| root + ROOT + TILE * i) {
        let key = bytes.u64(tile)?;
        let part = |shift: u32| ((key >> shift) as i32) << ROOT_BITS;
        let first = [part(42), part(21), part(0)].map(i64::from);
        if !seen.insert(first) {
            return Err(broken("a part of the tree occurs twice"));
        }
        let Some(range) = dense.range(first, ROOT_BITS) else {
            continue;
        };
        match bytes.u64(tile + 8)? {
            0 => dense.fill(range, bytes.f32(tile + 20)?),
            _ => dense.upper(bytes, bytes.place(root, tile + 8)?, first)?,
        }
    }
    Ok(dense.values)
}

/// A box of cells: the first index and one past the last, along each axis.
type Range = [[i64; 2]; 3];

/// A box of values under construction.
struct Dense {
    first: [i64; 3],
    size: [i64; 3],
    values: Vec<f32>,
}

impl Dense {
    fn new(within: CellBox, value: f32) -> Result<Self> {
        let (size, count) = (within.size(), within.count());
        let mut values = Vec::new();
        let reserved = values.try_reserve_exact(usize::try_from(count).unwrap_or(usize::MAX));
        reserved.map_err(|_| Error::memory("a grid", count.saturating_mul(4)))?;
        values.resize(count as usize, value);
        Ok(Self {
            first: within.first.map(i64::from),
            size: size.map(|n| n as i64),
            values,
        })
    }

    /// Returns the cells of a cube that lie in the box. The cube begins at `first` and has 2^`bits` cells along each
    /// axis. None: it does not overlap the box.
    fn range(&self, first: [i64; 3], bits: u32) -> Option<Range> {
        let range = std::array::from_fn(|i| {
            let begin = first[i].max(self.first[i]);
            [
                begin,
                (first[i] + (1 << bits)).min(self.first[i] + self.size[i]),
            ]
        });
        range
            .iter()
            .all(|[begin, end]| begin < end)
            .then_some(range)
    }

    /// Returns the index of a cell in the values.
    fn row(&self, [x, y, z]: [i64; 3]) -> usize {
        let [x, y, z] = [x - self.first[0], y - self.first[1], z - self.first[2]];
        ((z * self.size[1] + y) * self.size[0] + x) as usize
    }

    fn fill(&mut self, [xs, ys, zs]: Range, value: f32) {
        for (y, z) in rows([ys, zs]) {
            let row = self.row([xs[0], y, z]);
            self.values[row..row + (xs[1] - xs[0]) as usize].fill(value);
        }
    }

    fn upper(&mut self, bytes: Bytes<'_>, node: usize, first: [i64; 3]) -> Result<()> {
        self.inner(&UPPER, bytes, node, first, |dense, child, first| {
            dense.inner(&LOWER, bytes, child, first, |dense, leaf, first| {
                dense.leaf(bytes, leaf, first)
            })
        })
    }

    /// Copies the values of an inner node, and calls `take` for its children.
    fn inner(
        &mut self,
        kind: &Inner,
        bytes: Bytes<'_>,
        node: usize,
        first: [i64; 3],
        take: impl Fn(&mut Self, usize, [i64; 3]) -> Result<()>,
    ) -> Result<()> {
        let Some(range) = self.range(first, kind.bits + kind.child_bits) else {
            return Ok(());
        };
        // Children that overlap the box alone, so that work is bounded by its cells.
        let numbers = |i: usize| {
            let [begin, end] = range[i].map(|n| n - first[i]);
            (begin >> kind.child_bits)..=((end - 1) >> kind.child_bits)
        };
        for x in numbers(0) {
            for y in numbers(1) {
                for z in numbers(2) {
                    let number = ((x << kind.bits | y) << kind.bits | z) as usize;
                    let inside = [x, y, z].map(|n| n << kind.child_bits);
                    let corner = std::array::from_fn(|i| first[i] + inside[i]);
                    let [mask] = bytes.at(node + kind.children + number / 8)?;
                    let entry = node + kind.table + 8 * number;
                    if mask >> (number % 8) & 1 == 1 {
                        take(self, bytes.place(node, entry)?, corner)?;
                    } else if let Some(range) = self.range(corner, kind.child_bits) {
                        self.fill(range, bytes.f32(entry)?);
                    }
                }
            }
        }
        Ok(())
    }

    fn leaf(&mut self, bytes: Bytes<'_>, leaf: usize, first: [i64; 3]) -> Result<()> {
        let Some([xs, ys, zs]) = self.range(first, 3) else {
            return Ok(());
        };
        let values = bytes.slice(leaf + LEAF, 4 * 512)?.as_chunks::<4>().0;
        for (y, z) in rows([ys, zs]) {
            let row = self.row([xs[0], y, z]);
            for (i, x) in (xs[0]..xs[1]).enumerate() {
                let [x, y, z] = [x - first[0], y - first[1], z - first[2]];
                let number = (x << 6 | y << 3 | z) as usize;
                self.values[row + i] = f32::from_le_bytes(values[number]);
            }
        }
        Ok(())
    }
}

/// Returns all pairs (y, z) of two ranges.
fn rows([ys, zs]: [[i64; 2]; 2]) -> impl Iterator<Item = (i64, i64)> {
    (zs[0]..zs[1]).flat_map(move |z| (ys[0]..ys[1]).map(move |y| (y, z)))
}

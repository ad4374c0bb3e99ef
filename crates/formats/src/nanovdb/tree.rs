//! The tree of a grid: a root, two kinds of inner nodes, and leaves of 8³ cells.
//!
//! A child of the root has 32³ children of 128³ cells, and each of those 16³ leaves. Where a child is missing, all of
//! its cells have one value.

use super::{Bytes, CellBox, GRID, broken};
use crate::error::{Error, Result};
use std::collections::BTreeSet;

/// The part of a root before its tiles, and the size of each.
const ROOT: usize = 64;
const TILE: usize = 32;
/// Bits of a cell's number within a child of the root.
const ROOT_BITS: u32 = 12;

/// A kind of inner node.
struct Inner {
    /// Bits of the number of a child, along each axis.
    bits: u32,
    /// Bits of a cell's number within a child.
    child_bits: u32,
    /// The place of the mask of children, after that of values.
    children: usize,
    /// The place of the table.
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
/// The place of a leaf's values.
const LEAF: usize = 96;

/// The place of the root.
fn root(bytes: Bytes<'_>) -> Result<usize> {
    bytes.place(GRID, GRID + 24)
}

/// The cells that are active.
pub(super) fn bounds(bytes: Bytes<'_>) -> Result<CellBox> {
    let root = root(bytes)?;
    let (first, last) = (bytes.cell(root)?, bytes.cell(root + 12)?);
    if first.iter().zip(&last).any(|(first, last)| first > last) {
        return Err(broken("the grid is empty"));
    }
    Ok(CellBox { first, last })
}

/// The values of a box, x fastest, whose cells the caller has counted.
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

/// A part of the cells of a box, from the first to behind the last.
type Range = [[i64; 2]; 3];

/// A box of values in the making.
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

    /// The cells of the cube of 2^`bits` from `first` on that lie in the box. None: none do.
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

    /// The place of the first cell of a row in the values.
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
        self.inner(&UPPER, bytes, (node, first), |dense, child, first| {
            dense.inner(&LOWER, bytes, (child, first), |dense, leaf, first| {
                dense.leaf(bytes, leaf, first)
            })
        })
    }

    /// Takes over an inner node, and its children by `take`.
    fn inner(
        &mut self,
        kind: &Inner,
        bytes: Bytes<'_>,
        (node, first): (usize, [i64; 3]),
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
                    let corner = [x, y, z].map(|n| n << kind.child_bits);
                    let corner = std::array::from_fn(|i| first[i] + corner[i]);
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

/// All pairs of numbers of two ranges.
fn rows([ys, zs]: [[i64; 2]; 2]) -> impl Iterator<Item = (i64, i64)> {
    (zs[0]..zs[1]).flat_map(move |z| (ys[0]..ys[1]).map(move |y| (y, z)))
}

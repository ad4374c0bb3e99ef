//! The surface area heuristic over bins of equal width [Wald07].
//!
//! The cost of a split is `A_l·B_l + A_r·B_r`, with `A` the surface area of a side and `B` the number
//! of blocks it fills. Divided by the area of the whole, that is the expected number of tests.
//!
//! [Wald07]: https://doi.org/10.1109/RT.2007.4342588

use glam::Vec3A;

use super::group::{Reference, area_in, summed};
use crate::aabb::Aabb;
use crate::triangle::LANES;

const MAX_BINS: usize = 32;

/// A division of a group.
pub(super) struct Split {
    /// Expected tests, times the area of the group.
    pub(super) cost: f32,
    axis: usize,
    /// The first bin of the right side, and how many there are.
    first_right: usize,
    bins: usize,
}

impl Split {
    /// Which references are on the left, of those with these centers.
    pub(super) fn is_left<'a>(&'a self, centers: &'a Aabb) -> impl Fn(&Reference) -> bool + 'a {
        let scale = bin_scale(centers, self.axis, self.bins);
        move |reference| {
            bin_of(reference, centers, self.axis, scale).min(self.bins - 1) < self.first_right
        }
    }
}

/// Blocks that this many lanes fill.
pub(super) fn blocks(lanes: u32) -> f32 {
    lanes.div_ceil(LANES as u32) as f32
}

/// Bounds of a bin, in vector registers, and the lanes of what is in it.
#[derive(Clone, Copy)]
struct Bin {
    min: Vec3A,
    max: Vec3A,
    lanes: u32,
}

impl Bin {
    const EMPTY: Self = Self {
        min: Vec3A::INFINITY,
        max: Vec3A::NEG_INFINITY,
        lanes: 0,
    };

    fn of(reference: &Reference) -> Self {
        Self {
            min: reference.bounds.min.into(),
            max: reference.bounds.max.into(),
            lanes: reference.lanes(),
        }
    }

    #[inline]
    fn add(&mut self, other: &Self) {
        self.min = self.min.min(other.min);
        self.max = self.max.max(other.max);
        self.lanes += other.lanes;
    }

    fn cost(&self, unit: f32) -> f32 {
        let bounds = Aabb {
            min: self.min.into(),
            max: self.max.into(),
        };
        area_in(unit, &bounds) * blocks(self.lanes)
    }
}

/// `[axis][bin]`.
type Table<const BINS: usize> = [[Bin; BINS]; 3];

/// The split of least cost. None: all centers are in one place, or nearly.
pub(super) fn best_split(references: &[Reference], centers: &Aabb, unit: f32) -> Option<Split> {
    // Small groups do not deserve many bins, nor a table with room for them.
    match references.len() {
        ..=8 => best_of::<12>(references, centers, unit),
        9..=16 => best_of::<16>(references, centers, unit),
        _ => best_of::<MAX_BINS>(references, centers, unit),
    }
}

fn best_of<const BINS: usize>(
    references: &[Reference],
    centers: &Aabb,
    unit: f32,
) -> Option<Split> {
    let bins = (8 + references.len() / 2).min(BINS);
    let fill = |part: &[Reference]| filled::<BINS>(part, centers, bins);
    let table = summed(references, fill, |mut sum, part| {
        for (sum, part) in sum.as_flattened_mut().iter_mut().zip(part.as_flattened()) {
            sum.add(part);
        }
        sum
    });
    let mut best: Option<Split> = None;
    for (axis, table) in table.iter().enumerate() {
        let mut right_costs = [f32::INFINITY; BINS];
        let mut right = Bin::EMPTY;
        for bin in (1..bins).rev() {
            right.add(&table[bin]);
            if right.lanes > 0 {
                right_costs[bin] = right.cost(unit);
            }
        }
        let mut left = Bin::EMPTY;
        for first_right in 1..bins {
            left.add(&table[first_right - 1]);
            let cost = left.cost(unit) + right_costs[first_right];
            let least = best.as_ref().map_or(f32::INFINITY, |best| best.cost);
            if left.lanes > 0 && cost < least {
                best = Some(Split {
                    cost,
                    axis,
                    first_right,
                    bins,
                });
            }
        }
    }
    best
}

/// Sorts references into bins along each axis.
fn filled<const BINS: usize>(references: &[Reference], centers: &Aabb, bins: usize) -> Table<BINS> {
    let mut table = [[Bin::EMPTY; BINS]; 3];
    let scales = [0, 1, 2].map(|axis| bin_scale(centers, axis, bins));
    for reference in references {
        let item = Bin::of(reference);
        for axis in 0..3 {
            let bin = bin_of(reference, centers, axis, scales[axis]).min(bins - 1);
            table[axis][bin].add(&item);
        }
    }
    table
}

/// Bins per unit of length. Infinite for tiny extents, which [`bin_of`] copes with.
fn bin_scale(centers: &Aabb, axis: usize, bins: usize) -> f32 {
    bins as f32 / (centers.max[axis] - centers.min[axis])
}

/// The bin of a reference; the far end is one beyond the last.
fn bin_of(reference: &Reference, centers: &Aabb, axis: usize, scale: f32) -> usize {
    let offset = reference.bounds.center()[axis] - centers.min[axis];
    // The cast puts a NaN (nothing times infinity) into the first bin and too much into the last.
    (offset * scale) as usize
}

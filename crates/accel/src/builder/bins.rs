//! The surface area heuristic over bins of equal width [Wald07].
//!
//! The cost of a split is `A_l·B_l + A_r·B_r`, with `A` the surface area of a side and `B` the number of blocks that
//! it fills. Divided by the area of the whole group, it is the expected number of tests.
//!
//! [Wald07]: https://doi.org/10.1109/RT.2007.4342588

use glam::Vec3A;

use super::group::{Reference, sum};
use crate::aabb::half_area;
use crate::triangle::LANES;

const MAX_BINS: usize = 32;

/// A division of a group.
pub(super) struct Split {
    /// The expected number of tests, times the area of the group.
    pub(super) cost: f32,
    axis: usize,
    /// The first bin of the right side, and below, the number of bins.
    first_right: usize,
    bins: usize,
}

impl Split {
    /// Returns a predicate that is true for references on the left; `centers` bounds the centers of the group.
    pub(super) fn is_left(&self, centers: [Vec3A; 2]) -> impl Fn(&Reference) -> bool {
        let grid = Grid::new(centers, self.bins);
        let (first, scale) = (grid.first[self.axis], grid.scale[self.axis]);
        let (axis, first_right) = (self.axis, self.first_right as f32);
        move |reference| {
            let place = (reference.center_on(axis) - first) * scale;
            // A NaN is in the first bin.
            place < first_right || place.is_nan()
        }
    }
}

/// Returns the number of blocks that this many lanes fill.
pub(super) fn blocks(lanes: u32) -> f32 {
    lanes.div_ceil(LANES as u32) as f32
}

/// Returns half of the surface area of a box whose lengths are multiplied by `scale`.
pub(super) fn scaled_area(scale: f32, [min, max]: [Vec3A; 2]) -> f32 {
    // The difference alone could overflow.
    half_area(max * scale - min * scale)
}

/// Bins of equal width along each axis, between the outermost centers.
struct Grid {
    first: Vec3A,
    /// The number of bins per unit of length. It is infinite for tiny extents; [`Self::bins_of`] handles that.
    scale: Vec3A,
    last_bin: Vec3A,
}

impl Grid {
    fn new([first, last]: [Vec3A; 2], bins: usize) -> Self {
        Self {
            first,
            scale: Vec3A::splat(bins as f32) / (last - first),
            last_bin: Vec3A::splat((bins - 1) as f32),
        }
    }

    /// Returns the bin of a center along each axis.
    #[inline]
    fn bins_of(&self, center: Vec3A) -> [usize; 3] {
        // A NaN (zero times infinity) goes to the first bin: the cast ensures it, `max` might not.
        let place = ((center - self.first) * self.scale).max(Vec3A::ZERO);
        let [x, y, z] = place.min(self.last_bin).to_array();
        // Converted by way of 32 bits, which is faster.
        [x as i32 as usize, y as i32 as usize, z as i32 as usize]
    }
}

/// The bounds and the lanes of the references in a bin.
#[derive(Clone, Copy)]
struct Bin {
    bounds: [Vec3A; 2],
    lanes: u32,
}

impl Bin {
    const EMPTY: Self = Self {
        bounds: [Vec3A::INFINITY, Vec3A::NEG_INFINITY],
        lanes: 0,
    };

    #[inline]
    fn add(&mut self, other: &Self) {
        let [min, max] = other.bounds;
        self.bounds = [self.bounds[0].min(min), self.bounds[1].max(max)];
        self.lanes += other.lanes;
    }

    fn cost(&self, scale: f32) -> f32 {
        scaled_area(scale, self.bounds) * blocks(self.lanes)
    }
}

/// The bins, by `[axis][bin]`.
type Table<const BINS: usize> = [[Bin; BINS]; 3];

/// Returns the split of least cost; `centers` bounds the centers of the references. None: all centers are at one
/// point, or nearly.
pub(super) fn best_split(
    references: &[Reference],
    centers: [Vec3A; 2],
    scale: f32,
) -> Option<Split> {
    // Small groups need fewer bins, and a smaller table.
    match references.len() {
        ..=8 => best_of::<12>(references, centers, scale),
        9..=16 => best_of::<16>(references, centers, scale),
        _ => best_of::<MAX_BINS>(references, centers, scale),
    }
}

fn best_of<const BINS: usize>(
    references: &[Reference],
    centers: [Vec3A; 2],
    scale: f32,
) -> Option<Split> {
    let bins = (8 + references.len() / 2).min(BINS);
    let grid = Grid::new(centers, bins);
    let fill = |table: &mut Table<BINS>, part: &[Reference]| fill(table, part, &grid);
    let mut table = [[Bin::EMPTY; BINS]; 3];
    sum(references, &mut table, fill, |table, part| {
        for (sum, part) in table.as_flattened_mut().iter_mut().zip(part.as_flattened()) {
            sum.add(part);
        }
    });
    let mut best: Option<Split> = None;
    for (axis, table) in table.iter().enumerate() {
        let mut right_costs = [f32::INFINITY; BINS];
        let mut right = Bin::EMPTY;
        for bin in (1..bins).rev() {
            right.add(&table[bin]);
            if right.lanes > 0 {
                right_costs[bin] = right.cost(scale);
            }
        }
        let mut left = Bin::EMPTY;
        for first_right in 1..bins {
            left.add(&table[first_right - 1]);
            let cost = left.cost(scale) + right_costs[first_right];
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
fn fill<const BINS: usize>(table: &mut Table<BINS>, references: &[Reference], grid: &Grid) {
    for reference in references {
        let item = Bin {
            bounds: reference.bounds(),
            lanes: reference.lanes(),
        };
        for (table, bin) in table.iter_mut().zip(grid.bins_of(reference.center())) {
            table[bin].add(&item);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aabb::Aabb;
    use crate::builder::group::Totals;
    use glam::Vec3;

    #[test]
    fn both_sides_are_those_of_the_bins() {
        let wave = |i: u32| libm::sinf((i * i) as f32);
        let mut splits = 0;
        for size in [1e-45, 1e-38, 1e-20, 1.0, 1e20, f32::MAX] {
            for flat in [1.0, 0.0, f32::MIN_POSITIVE] {
                let center = |i| Vec3::new(wave(i), flat * wave(i + 1), wave(i + 2)) * size;
                let bounds = |i| Aabb::around(&[center(i), center(i) * 0.5]);
                let references: Vec<_> = (0..100)
                    .map(|i| Reference::instance(i, bounds(i)))
                    .collect();
                let centers = Totals::of(&references).centers();
                let Some(split) = best_split(&references, centers, 1.0 / size) else {
                    continue;
                };
                splits += 1;
                let grid = Grid::new(centers, split.bins);
                let is_left = split.is_left(centers);
                let mut counts = [0, 0];
                for reference in &references {
                    let bin = grid.bins_of(reference.center())[split.axis];
                    assert_eq!(is_left(reference), bin < split.first_right, "{reference:?}");
                    counts[usize::from(is_left(reference))] += 1;
                }
                assert!(counts.iter().all(|&count| count > 0), "{counts:?}");
            }
        }
        assert!(splits > 12, "{splits} splits");
    }
}

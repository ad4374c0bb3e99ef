//! Cells of vertices: boxes of space, each divided by the direction of the normal. Training learns about connections
//! between cells.
//!
//! The boxes are the leaves of a k-d tree over vertices of training, so that each has about the same number of them.
//! A plane goes through the widest gap near the median. If it lay in a wall, rounding would decide in which box a
//! point of the wall is: the box would depend on the walk that found the point, and weights would not be a function
//! of the path.

use crate::math::Vec3;
use std::cmp::Ordering;

/// The number of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cell(u8);

impl Cell {
    /// The cell of every vertex if nothing is learned.
    pub(crate) const FIRST: Self = Self(0);

    /// Returns its number, which is less than [`Cells::COUNT`]. Tables of [`Cells::NAMES`] entries need no check of
    /// bounds.
    #[inline]
    pub(crate) fn index(self) -> usize {
        usize::from(self.0)
    }
}

/// The number of levels of planes in the tree.
const LEVELS: u32 = 5;
/// The number of boxes.
const BOXES: usize = 1 << LEVELS;
/// The number of classes of normals: by the axis that a normal is nearest to, and its sign.
const NORMALS: usize = 6;

/// The fraction of the vertices, on either side of the median, among which a gap is searched for.
const NEAR_MEDIAN: f64 = 0.15;

/// The largest distance of points of one wall by rounding, relative to the coordinate.
const ROUNDING: f32 = 4e-6;

/// A division of space and normals into cells.
#[derive(Clone, Debug)]
pub struct Cells {
    /// The planes in the order of a heap, the root at 1.
    planes: Vec<Plane>,
}

/// A plane: points whose coordinate number `axis` is less than `at` are before it. Unit: m.
#[derive(Clone, Copy, Debug)]
struct Plane {
    axis: u32,
    at: f32,
}

impl Cells {
    /// The number of cells.
    pub const COUNT: usize = BOXES * NORMALS;
    /// The number of values of a [`Cell`].
    pub(crate) const NAMES: usize = 1 << u8::BITS;

    /// Returns the number of a pair of cells, less than the square of [`Self::COUNT`]. Pairs with the same cell of
    /// camera vertices have consecutive numbers.
    #[inline]
    pub(crate) fn pair(light: Cell, camera: Cell) -> usize {
        camera.index() * Self::COUNT + light.index()
    }

    /// Returns the cell with number `index`.
    #[inline]
    pub(crate) fn cell(index: usize) -> Cell {
        Cell(index as u8)
    }

    /// Divides space so that each box has about the same number of `points`.
    pub fn new(points: &mut [Vec3]) -> Self {
        let nowhere = Plane { axis: 0, at: 0.0 };
        let mut planes = vec![nowhere; BOXES];
        divide(points, 1, &mut planes);
        Self { planes }
    }

    /// Returns the cell of a vertex with the unit normal `n`.
    #[inline]
    pub fn of(&self, point: Vec3, n: Vec3) -> Cell {
        let point = point.to_array();
        let mut i = 1;
        for _ in 0..LEVELS {
            let plane = self.planes[i];
            i = 2 * i + usize::from(point[plane.axis as usize] >= plane.at);
        }
        let size = n.abs();
        let axis = if size.x > size.y.max(size.z) {
            0
        } else {
            1 + usize::from(size.z > size.y)
        };
        let sign = usize::from(n[axis] < 0.0);
        Self::cell((i - BOXES) * NORMALS + 2 * axis + sign)
    }
}

/// Sets plane number `i`, and the planes below it in the tree, for `points`.
fn divide(points: &mut [Vec3], i: usize, planes: &mut [Plane]) {
    if i >= planes.len() || points.is_empty() {
        return;
    }
    let axis = longest(points);
    // Points are compared by all coordinates, so that their order does not depend on the sorting algorithm.
    points.sort_unstable_by(|a, b| {
        let axes = [axis, (axis + 1) % 3, (axis + 2) % 3].into_iter();
        let mut orders = axes.map(|axis| a[axis].total_cmp(&b[axis]));
        orders
            .find(|order| order.is_ne())
            .unwrap_or(Ordering::Equal)
    });
    let middle = widest_gap(points, axis);
    let at = 0.5 * (points[middle.saturating_sub(1)][axis] + points[middle][axis]);
    planes[i] = Plane {
        axis: axis as u32,
        at,
    };
    let (before, behind) = points.split_at_mut(middle);
    divide(before, 2 * i, planes);
    divide(behind, 2 * i + 1, planes);
}

/// Returns the axis along which `points` vary most.
fn longest(points: &[Vec3]) -> usize {
    let count = points.len() as f32;
    let mean = points.iter().sum::<Vec3>() / count;
    let squares: Vec3 = points.iter().map(|&p| (p - mean) * (p - mean)).sum();
    let [x, y, z] = squares.to_array();
    match (x >= y && x >= z, y >= z) {
        (true, _) => 0,
        (false, true) => 1,
        (false, false) => 2,
    }
}

/// Returns the index of the first point behind the widest gap of sorted `points` near their median. If a wall holds
/// all points near the median, it is the gap nearest to the median.
fn widest_gap(points: &[Vec3], axis: usize) -> usize {
    let count = points.len() as f64;
    let end = |part: f64| ((count * part) as usize).clamp(1, points.len());
    let gap = |i: usize| points[i][axis] - points[i - 1][axis];
    let largest = points[0][axis]
        .abs()
        .max(points[points.len() - 1][axis].abs());
    let is_wide = |&i: &usize| gap(i) > ROUNDING * largest;
    let near_median = end(0.5 - NEAR_MEDIAN)..end(0.5 + NEAR_MEDIAN);
    let widest = near_median.max_by(|&a, &b| gap(a).total_cmp(&gap(b)));
    let middle = points.len() / 2;
    let nearest = || {
        (1..points.len())
            .filter(is_wide)
            .min_by_key(|&i| i.abs_diff(middle))
    };
    widest.filter(is_wide).or_else(nearest).unwrap_or(middle)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::check_property;
    use proptest::prelude::*;

    fn point() -> impl Strategy<Value = Vec3> {
        // Many points have some coordinate in common, as those of walls have.
        let coordinate = || prop_oneof![-2.0f32..2.0, Just(0.0f32), Just(1.0f32)];
        (coordinate(), coordinate(), coordinate()).prop_map(|(x, y, z)| Vec3::new(x, y, z))
    }

    #[test]
    fn every_point_has_a_cell_and_boxes_have_about_as_many() {
        let points = prop::collection::vec(point(), 0..600);
        check_property(&points, |points| {
            let cells = Cells::new(&mut points.clone());
            let mut counts = [0usize; Cells::COUNT];
            for &p in &points {
                counts[cells.of(p, Vec3::Z).index()] += 1;
            }
            let most = counts.iter().max().copied().unwrap_or(0);
            // Points that share a coordinate stay together.
            prop_assert!(most <= 32 + points.len() / 8, "{most} of {}", points.len());
            Ok(())
        });
    }

    #[test]
    fn rounding_moves_no_wall_to_another_box() {
        let grid = (0..64 * 64).map(|i| (i % 64, i / 64));
        let mut points: Vec<_> = grid
            .flat_map(|(x, y)| {
                let (x, y) = (x as f32 / 64.0, y as f32 / 64.0);
                [Vec3::new(x, y, 1.0), Vec3::new(x, y, 3.0)]
            })
            .collect();
        let cells = Cells::new(&mut points);
        for p in points {
            let [below, above] = [-1e-5, 1e-5].map(|z| cells.of(p + Vec3::Z * z, Vec3::Z));
            assert_eq!(below, above, "{p}");
        }
    }

    /// Most vertices lie on a tabletop, so that the median is amid them.
    #[test]
    fn no_plane_divides_what_lies_in_one() {
        let grid = (0..100).map(|i| Vec3::new((i % 10) as f32, (i / 10) as f32, 0.0) * 0.01);
        let floor = grid.clone().take(30);
        let mut points: Vec<_> = grid.map(|p| p + Vec3::Z * 0.75).chain(floor).collect();
        let mut planes = vec![Plane { axis: 0, at: 0.0 }; BOXES];
        divide(&mut points, 1, &mut planes);
        assert_eq!((planes[1].axis, planes[1].at), (2, 0.375));
    }

    #[test]
    fn normals_have_six_classes() {
        let cells = Cells::new(&mut []);
        let axes = [Vec3::X, Vec3::Y, Vec3::Z];
        let of_axes = axes.map(|n| [n, -n].map(|n| cells.of(Vec3::ZERO, n).0));
        let mut classes = of_axes.as_flattened().to_vec();
        classes.sort_unstable();
        classes.dedup();
        assert_eq!(classes.len(), NORMALS);
    }
}

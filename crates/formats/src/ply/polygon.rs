//! Splits polygons into triangles.
//!
//! A polygon is read as a fan about its first corner. If a triangle of the fan lies outside the polygon, ears are
//! cut instead: corners whose triangle with both neighbours lies inside. A simple polygon of four corners or more
//! has two ears. All tests are in the axis plane in which the polygon's projection is largest: a projection along
//! an axis keeps convexity, and rounds nothing.

use crate::error::{Error, ErrorKind, Result};
use crate::repair;
use glam::{DVec2, DVec3};

/// Splits polygons, and counts the work.
pub(super) struct Splitter<'m> {
    positions: &'m [[f32; 3]],
    /// Number of tests of a corner against an ear that are left.
    tests: u64,
    /// Number of polygons without an ear, whose sides cross.
    pub(super) crossing: usize,
}

/// The unsplit rest of a polygon in a plane.
struct Rest {
    /// The corners, in positive direction.
    corners: Vec<DVec2>,
    /// The indices of the corners before and after each corner.
    neighbours: Vec<[usize; 2]>,
    /// The corners that are not convex; some may be cut already.
    reflex: Vec<usize>,
}

impl<'m> Splitter<'m> {
    /// Splits polygons between these vertices, with at most `tests` tests.
    pub(super) fn new(positions: &'m [[f32; 3]], tests: u64) -> Self {
        Self {
            positions,
            tests,
            crossing: 0,
        }
    }

    /// Replaces the fan of a polygon by triangles inside the polygon. Errors: that takes too many tests.
    pub(super) fn split(&mut self, fan: &mut [[u32; 3]]) -> Result<()> {
        let Some(&[first, second, _]) = fan.first() else {
            return Ok(());
        };
        let last = fan.iter().map(|triangle| triangle[2]);
        let names: Vec<u32> = [first, second].into_iter().chain(last).collect();
        let vertex = |&name: &u32| DVec3::from(self.positions[name as usize].map(f64::from));
        let in_space: Vec<DVec3> = names.iter().map(vertex).collect();
        let Some(corners) = flattened(&in_space) else {
            let cover = |triangle: &[u32; 3]| repair::area(self.positions, *triangle);
            self.crossing += usize::from(fan.iter().any(|t| cover(t) != DVec3::ZERO));
            return Ok(());
        };
        let is_inside = |i: usize| area(corners[0], corners[i], corners[i + 1]) > 0.0;
        if (1..names.len() - 1).all(is_inside) {
            return Ok(());
        }
        let mut rest = Rest::new(corners);
        let mut corner = 0;
        let most = self.crossing + 1;
        for triangle in fan {
            corner = self.ear(&mut rest, corner)?;
            let [before, after] = rest.neighbours[corner];
            *triangle = [before, corner, after].map(|i| names[i]);
            rest.cut(corner);
            // Ears next to each other would make a fan of thin triangles.
            corner = after;
        }
        self.crossing = self.crossing.min(most);
        Ok(())
    }

    /// Finds the next ear at or after corner `start`; any corner if there is none.
    fn ear(&mut self, rest: &mut Rest, start: usize) -> Result<usize> {
        let mut corner = start;
        loop {
            if self.is_ear(rest, corner)? {
                return Ok(corner);
            }
            corner = rest.neighbours[corner][1];
            if corner == start {
                break;
            }
        }
        // Sides cross if more than a triangle is left, or one that goes around the other way.
        let [before, after] = rest.neighbours[start];
        let [a, b, c] = [before, start, after].map(|i| rest.corners[i]);
        let is_last = rest.neighbours[after][1] == before;
        let is_rest = !is_last && !rest.reflex.is_empty();
        self.crossing += usize::from(is_rest || (is_last && area(a, b, c) < 0.0));
        // What is left becomes a fan.
        rest.reflex.clear();
        Ok(start)
    }

    fn is_ear(&mut self, rest: &Rest, corner: usize) -> Result<bool> {
        let [before, after] = rest.neighbours[corner];
        let [a, b, c] = [before, corner, after].map(|i| rest.corners[i]);
        self.spend(1)?;
        if area(a, b, c) <= 0.0 {
            return Ok(false);
        }
        let contains = |p: DVec2| {
            p != a
                && p != b
                && p != c
                && [area(a, b, p), area(b, c, p), area(c, a, p)]
                    .iter()
                    .all(|&side| side >= 0.0)
        };
        let mut others = rest.reflex.iter();
        let found = others.position(|&i| contains(rest.corners[i]));
        self.spend(found.map_or(rest.reflex.len(), |at| at + 1) as u64)?;
        Ok(found.is_none())
    }

    fn spend(&mut self, tests: u64) -> Result<()> {
        let rest = self.tests.checked_sub(tests);
        let message = "its concave polygons have too many corners";
        self.tests = rest.ok_or_else(|| Error::new(ErrorKind::Limit, message))?;
        Ok(())
    }
}

impl Rest {
    fn new(corners: Vec<DVec2>) -> Self {
        let count = corners.len();
        let around = |i: usize| [(i + count - 1) % count, (i + 1) % count];
        let neighbours: Vec<[usize; 2]> = (0..count).map(around).collect();
        let mut rest = Self {
            corners,
            neighbours,
            reflex: Vec::new(),
        };
        rest.reflex = (0..count).filter(|&i| rest.is_reflex(i)).collect();
        rest
    }

    fn is_reflex(&self, corner: usize) -> bool {
        let [before, after] = self.neighbours[corner];
        area(
            self.corners[before],
            self.corners[corner],
            self.corners[after],
        ) <= 0.0
    }

    /// Removes a corner. Its neighbours may become convex.
    fn cut(&mut self, corner: usize) {
        let [before, after] = self.neighbours[corner];
        self.neighbours[before][1] = after;
        self.neighbours[after][0] = before;
        let mut reflex = std::mem::take(&mut self.reflex);
        reflex.retain(|&i| i != corner && (i != before && i != after || self.is_reflex(i)));
        self.reflex = reflex;
    }
}

/// Returns twice the area of a triangle, negative if its corners go around clockwise.
fn area(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// Projects a polygon along the axis that gives the largest area, so that its corners go around counterclockwise.
/// None: its signed area is 0 in all projections.
fn flattened(corners: &[DVec3]) -> Option<Vec<DVec2>> {
    let first = corners[0];
    let cross = |pair: &[DVec3]| (pair[0] - first).cross(pair[1] - first);
    let normal: DVec3 = corners.windows(2).map(cross).sum();
    let size = normal.abs();
    let (axis, along) = if size.z >= size.x.max(size.y) {
        (2, normal.z)
    } else if size.y >= size.x {
        (1, normal.y)
    } else {
        (0, normal.x)
    };
    let [i, j] = if along < 0.0 {
        [(axis + 2) % 3, (axis + 1) % 3]
    } else {
        [(axis + 1) % 3, (axis + 2) % 3]
    };
    let flat = corners.iter().map(|p| DVec2::new(p[i], p[j]));
    (along != 0.0).then(|| flat.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corners(text: &str) -> Vec<[f32; 2]> {
        let number = |word: &str| word.parse().expect("a number");
        let corner = |pair: &str| pair.split_once(' ').map(|(x, y)| [number(x), number(y)]);
        text.split(", ").filter_map(corner).collect()
    }

    /// Splits a polygon in the plane z = x. Returns the areas of its triangles in the plane z = 0, and the
    /// number of polygons that cross themselves.
    fn split(corners: &[[f32; 2]], tests: u64) -> Result<(Vec<f64>, usize)> {
        let positions: Vec<[f32; 3]> = corners.iter().map(|&[x, y]| [x, y, x]).collect();
        let mut fan: Vec<[u32; 3]> = (1..corners.len() as u32 - 1)
            .map(|i| [0, i, i + 1])
            .collect();
        let mut splitter = Splitter::new(&positions, tests);
        splitter.split(&mut fan)?;
        let at = |i: u32| DVec2::from(corners[i as usize].map(f64::from));
        let areas = fan.iter().map(|triangle| {
            let [a, b, c] = triangle.map(at);
            area(a, b, c) / 2.0
        });
        Ok((areas.collect(), splitter.crossing))
    }

    /// The triangles of a polygon have the signs of its direction, and its area in all.
    #[track_caller]
    fn check(corners: &[[f32; 2]], expected: f64) {
        for turn in 0..corners.len() {
            let mut turned = corners.to_vec();
            turned.rotate_left(turn);
            for sign in [1.0, -1.0] {
                let Ok((areas, crossing)) = split(&turned, 10_000) else {
                    panic!("too many tests");
                };
                assert!(
                    areas.iter().all(|area| area * sign >= 0.0),
                    "{turned:?}: {areas:?}"
                );
                assert!((areas.iter().sum::<f64>() * sign - expected).abs() < 1e-5);
                assert_eq!((areas.len(), crossing), (corners.len() - 2, 0));
                turned.reverse();
            }
        }
    }

    #[test]
    fn polygons_are_covered_once() {
        // A pentagon, an arrow head, an L, a comb, a square with corners on its sides.
        check(&corners("0 0, 2 0, 3 1, 1 3, -1 1"), 7.0);
        check(&corners("0 0, 4 0, 1 1, 0 4"), 4.0);
        check(&corners("0 0, 2 0, 2 1, 1 1, 1 2, 0 2"), 3.0);
        let comb = "0 0, 8 0, 8 3, 7 3, 6 1, 5 3, 4 1, 3 3, 2 1, 1 3, 0 3";
        check(&corners(comb), 18.0);
        check(&corners("0 0, 1 0, 2 0, 2 1, 2 2, 1 2, 0 2, 0 1"), 4.0);
    }

    #[test]
    fn a_hole_may_be_joined_by_a_double_side() {
        let outer_and_hole = "0 0, 3 0, 3 3, 0 3, 0 0, 1 1, 1 2, 2 2, 2 1, 1 1";
        check(&corners(outer_and_hole), 8.0);
    }

    #[test]
    fn polygons_that_cross_themselves_are_counted() {
        let even = "0 0, 1 1, 1 0, 0 1";
        let spike = "0 0, 4 0, 4 4, 2 -1, 0 4";
        for polygon in ["0 0, 3 3, 3 0, 0 1", even, spike].map(corners) {
            let Ok((areas, crossing)) = split(&polygon, 1000) else {
                panic!("too many tests");
            };
            assert_eq!((areas.len(), crossing), (polygon.len() - 2, 1));
        }
    }

    #[test]
    fn the_work_for_a_polygon_is_limited() {
        // A saw, whose every second corner is concave.
        let saw: Vec<[f32; 2]> = (0..2000)
            .map(|i| [i as f32, (i % 2) as f32 + 1.0])
            .collect();
        let corners = [&[[1999.0, 0.0], [0.0, 0.0]][..], &saw].concat();
        let reversed: Vec<_> = corners.iter().rev().copied().collect();
        for polygon in [corners, reversed] {
            let refusal = split(&polygon, 1000).err();
            assert!(refusal.is_some_and(|broken| broken.message().contains("too many corners")));
        }
    }
}

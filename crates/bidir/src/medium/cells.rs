//! The cubes that a line goes through, in order \[Amanatides87\].

use crate::math::Vec3;

/// A line o + t d.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    pub(super) origin: Vec3,
    pub(super) direction: Vec3,
}

/// A part of a line, in units of its direction: from the first number to the second.
pub(super) type Range = [f32; 2];

/// A box of whole cubes: those from the first to the last number along each axis, both included.
#[derive(Clone, Copy, Debug)]
pub(super) struct CubeBox {
    pub(super) first: [i32; 3],
    pub(super) last: [i32; 3],
}

/// Iterates over the cubes that a line goes through, with the part of the line in each.
#[derive(Debug)]
pub(super) struct Cubes {
    line: Line,
    side: f32,
    within: CubeBox,
    cube: [i32; 3],
    /// Where the line leaves the cube along each axis, in units of its direction.
    leave: [f32; 3],
    range: Range,
}

impl Line {
    /// Returns the point at `t`.
    #[inline]
    pub(super) fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }

    /// Returns the part of `range` in the box between two corners. None: the line misses the box.
    pub(super) fn within(&self, [low, high]: [Vec3; 2], range: Range) -> Option<Range> {
        let [mut begin, mut end] = range;
        for axis in 0..3 {
            let (origin, direction) = (self.origin[axis], self.direction[axis]);
            if direction == 0.0 {
                if origin < low[axis] || origin > high[axis] {
                    return None;
                }
                continue;
            }
            let [a, b] = [low, high].map(|corner| (corner[axis] - origin) / direction);
            begin = begin.max(a.min(b));
            end = end.min(a.max(b));
        }
        (begin < end).then_some([begin, end])
    }

    /// Returns the cubes of `within` along a part of the line. They have this side, and corners at multiples of it.
    pub(super) fn cubes(&self, side: f32, within: CubeBox, range: Range) -> Cubes {
        let start = self.at(range[0]) / side;
        let nearest = |axis: usize| {
            let cube = start[axis].floor() as i32;
            cube.clamp(within.first[axis], within.last[axis])
        };
        let mut cubes = Cubes {
            line: *self,
            side,
            within,
            cube: std::array::from_fn(nearest),
            leave: [f32::INFINITY; 3],
            range,
        };
        for axis in 0..3 {
            cubes.leave[axis] = cubes.leave_along(axis);
        }
        cubes
    }
}

impl Cubes {
    /// Returns where the line leaves the cube along an axis. Computed from the number of the cube, so that errors do
    /// not add up.
    #[inline]
    fn leave_along(&self, axis: usize) -> f32 {
        let direction = self.line.direction[axis];
        if direction == 0.0 {
            return f32::INFINITY;
        }
        let face = self.cube[axis] + i32::from(direction > 0.0);
        (face as f32 * self.side - self.line.origin[axis]) / direction
    }
}

impl Iterator for Cubes {
    type Item = ([i32; 3], Range);

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        let [begin, end] = self.range;
        if begin >= end {
            return None;
        }
        let nearer = |a: usize, b: usize| if self.leave[b] < self.leave[a] { b } else { a };
        let axis = nearer(nearer(0, 1), 2);
        let found = self.cube;
        let leave = self.leave[axis].clamp(begin, end);
        let (step, last) = if self.line.direction[axis] > 0.0 {
            (1, self.within.last[axis])
        } else {
            (-1, self.within.first[axis])
        };
        // By rounding a line may leave the last cube a little before its end.
        if found[axis] == last {
            self.range[0] = end;
            return Some((found, [begin, end]));
        }
        self.cube[axis] += step;
        self.leave[axis] = self.leave_along(axis);
        self.range[0] = leave;
        Some((found, [begin, leave]))
    }
}

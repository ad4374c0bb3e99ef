//! A curve that fills space: points that follow each other on it lie near each other \[Morton66\].

use crate::math::Vec3;

/// The digits of a coordinate.
const DIGITS: u32 = 10;

/// The curve in a box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Curve {
    low: Vec3,
    /// How many steps of the curve's grid a unit of length has.
    scale: Vec3,
}

impl Curve {
    /// The bits of a position.
    pub(super) const BITS: u32 = 3 * DIGITS;

    /// Returns the curve in the box around `points`.
    pub(super) fn around(points: &[Vec3]) -> Self {
        let empty = [Vec3::INFINITY, Vec3::NEG_INFINITY];
        let grow = |[low, high]: [Vec3; 2], &point: &Vec3| [low.min(point), high.max(point)];
        let [low, high] = points.iter().fold(empty, grow);
        let steps = ((1 << DIGITS) - 1) as f32;
        Self {
            low,
            scale: steps / (high - low).max(Vec3::splat(f32::MIN_POSITIVE)),
        }
    }

    /// Returns the position of a point on the curve.
    #[inline]
    pub(super) fn position(&self, point: Vec3) -> u64 {
        let [x, y, z] = ((point - self.low) * self.scale).to_array().map(apart);
        x << 2 | y << 1 | z
    }
}

/// Returns the digits of a coordinate, two zeros between them.
#[inline]
fn apart(x: f32) -> u64 {
    let digits = (x as u64).min((1 << DIGITS) - 1);
    let digits = (digits | digits << 16) & 0x0300_00ff;
    let digits = (digits | digits << 8) & 0x0300_f00f;
    let digits = (digits | digits << 4) & 0x030c_30c3;
    (digits | digits << 2) & 0x0924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_part_of_the_box_is_a_part_of_the_curve() {
        let corner = |i: u32| Vec3::from([2, 1, 0].map(|bit| (i >> bit & 1) as f32));
        let low = Vec3::new(-3.0, 5.0, 1e3);
        let points: Vec<_> = (0..8).map(|i| low + 4.0 * corner(i)).collect();
        let curve = Curve::around(&points);
        assert_eq!(curve.position(points[0]), 0);
        assert_eq!(curve.position(points[7]), (1 << Curve::BITS) - 1);
        for (i, j) in (0..8).flat_map(|i| (0..8).map(move |j| (i, j))) {
            let position = curve.position(low + 2.0 * corner(i) + corner(j) + 0.5);
            assert_eq!(position >> 24, u64::from(8 * i + j));
        }
    }

    #[test]
    fn points_of_a_plane_have_positions() {
        let points = [Vec3::ZERO, Vec3::X];
        let curve = Curve::around(&points);
        assert!(curve.position(points[0]) < curve.position(points[1]));
        assert_eq!(Curve::around(&points[..1]).position(points[0]), 0);
    }
}

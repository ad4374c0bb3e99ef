//! Four vectors at once: a coordinate of each in a lane.

use super::Vec3;
use glam::{Mat4, Vec4};

/// The coordinates of four vectors.
pub(crate) type Vec3x4 = [Vec4; 3];

/// Returns `p` minus each of `from`.
#[inline]
pub(crate) fn offset(p: Vec3, from: &Vec3x4) -> Vec3x4 {
    [p.x - from[0], p.y - from[1], p.z - from[2]]
}

/// Returns the scalar products of pairs.
#[inline]
pub(crate) fn dot(a: &Vec3x4, b: &Vec3x4) -> Vec4 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Returns the scalar products of `v` with each of four.
#[inline]
pub(crate) fn dot_each(v: Vec3, of: &Vec3x4) -> Vec4 {
    v.x * of[0] + v.y * of[1] + v.z * of[2]
}

/// Transposes four vectors, each with a number.
#[inline]
pub(crate) fn gather([a, b, c, d]: [(Vec3, f32); 4]) -> (Vec3x4, Vec4) {
    let row = |(v, number): (Vec3, f32)| v.extend(number);
    let [x, y, z, numbers] = transpose([row(a), row(b), row(c), row(d)]);
    ([x, y, z], numbers)
}

/// Transposes a matrix.
#[inline]
pub(crate) fn transpose([a, b, c, d]: [Vec4; 4]) -> [Vec4; 4] {
    let columns = Mat4::from_cols(a, b, c, d).transpose();
    [
        columns.x_axis,
        columns.y_axis,
        columns.z_axis,
        columns.w_axis,
    ]
}

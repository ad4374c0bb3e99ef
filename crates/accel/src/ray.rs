//! [`Ray`] and [`Hit`].

use glam::Vec3;

/// The points `origin + t·direction` with `t_min ≤ t ≤ t_max`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// The point at `t = 0`.
    pub origin: Vec3,
    /// The direction. Its length, between 1e-37 and 1e37 in the space of an instance, too, is the unit of `t`.
    /// Components smaller than the smallest normal `f32` count as zero.
    pub direction: Vec3,
    /// The smallest `t` that counts as a hit, itself included. A negative value counts as zero.
    pub t_min: f32,
    /// The largest `t` that counts as a hit, itself included. May be infinite; a hit never is.
    pub t_max: f32,
}

impl Ray {
    /// Makes the whole half-line from `origin`: `t` in `[0, ∞)`.
    pub const fn new(origin: Vec3, direction: Vec3) -> Self {
        Self {
            origin,
            direction,
            t_min: 0.0,
            t_max: f32::INFINITY,
        }
    }
}

/// A point where a ray met a primitive. All numbers are finite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Distance from the ray's origin in units of its direction's length.
    pub t: f32,
    /// Index of the instance: 0 for the primitives of the [`Bvh`](crate::Bvh) itself, `i + 1` for instance `i`.
    pub instance: u32,
    /// Index of the primitive in the slice that the [`Bvh`](crate::Bvh), or the instance's object,
    /// was built from.
    pub primitive: u32,
    /// First surface parameter, in `[0, 1]`.
    /// Triangle: the weight of vertex 1. Quadrics: the angle φ over its maximum.
    pub u: f32,
    /// Second surface parameter, in `[0, 1]`.
    /// Triangle: the weight of vertex 2; `1 - u - v` can fall below zero by one rounding.
    /// Sphere: 0 at `z_min`, 1 at `z_max`, linear in θ. Disk: 0 at the rim, 1 at the inner radius. Cylinder: 0 at
    /// `z_min`, 1 at `z_max`, linear in z.
    pub v: f32,
}

impl Hit {
    /// Orders hits by `t`, then by instance, then by primitive.
    pub(crate) fn is_before(&self, other: &Self) -> bool {
        let id = |hit: &Self| (hit.instance, hit.primitive);
        self.t < other.t || (self.t <= other.t && id(self) < id(other))
    }
}

/// Returns the hit filter that lets every hit exist.
#[inline(always)]
pub fn accept_all(_: &Hit) -> bool {
    true
}

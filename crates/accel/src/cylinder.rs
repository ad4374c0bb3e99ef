//! Cylinders without caps, and parts of them.

use glam::{Affine3A, DVec2, DVec3, Vec3Swizzles};

use crate::aabb::Aabb;
use crate::primitive::{box_bounds, ellipsoid_bounds};
use crate::quadric::{LocalLine, Roots, azimuth, azimuth_limit, chord};

/// The points at `radius` from the z axis of its local space with `z_min ≤ z ≤ z_max` and an
/// azimuth of at most `phi_max`; the conventions are those of pbrt-v4.
///
/// `u = φ/phi_max`, with φ from `+x` toward `+y`. `v` is 0 at `z_min`, 1 at `z_max` and linear in
/// z. Without a positive radius, `z_min < z_max` or a positive `phi_max` it is never hit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cylinder {
    /// Any invertible affine map: a scale makes the section an ellipse.
    pub local_from_world: Affine3A,
    /// In local units.
    pub radius: f32,
    /// The lower end, in local units.
    pub z_min: f32,
    /// The upper end, in local units.
    pub z_max: f32,
    /// In radians; at 2π (up to rounding) or above nothing is cut.
    pub phi_max: f32,
}

impl Cylinder {
    /// Returns a box that contains the cylinder; see [`Primitive::bounds`](crate::Primitive::bounds).
    pub(crate) fn bounds(&self) -> Aabb {
        let shape = [self.radius, self.z_min, self.z_max, self.phi_max];
        if !shape.iter().all(|x| x.is_finite()) {
            return Aabb::EMPTY;
        }
        let radius = f64::from(self.radius.abs());
        let rim = |z: f32| {
            let center = DVec3::Z * f64::from(z);
            let radii = DVec3::new(radius, radius, 0.0);
            ellipsoid_bounds(&self.local_from_world, center, radii)
        };
        let [low, high] = [rim(self.z_min), rim(self.z_max)];
        let half = 0.5 * (f64::from(self.z_max) - f64::from(self.z_min)).abs();
        let middle = 0.5 * (f64::from(self.z_max) + f64::from(self.z_min));
        let half = DVec3::new(radius, radius, half);
        let whole = box_bounds(&self.local_from_world, DVec3::Z * middle, half);
        // A ruled surface lies between its rims; the box guards against their rounding.
        Aabb {
            min: low.min.min(high.min).max(whole.min),
            max: low.max.max(high.max).min(whole.max),
        }
    }
}

/// A [`Cylinder`] made ready for rays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CylinderTest {
    radius: f64,
    z_min: f64,
    z_max: f64,
    phi_max: f64,
}

impl CylinderTest {
    pub(crate) fn new(cylinder: &Cylinder) -> Self {
        Self {
            radius: f64::from(cylinder.radius.max(0.0)),
            z_min: f64::from(cylinder.z_min),
            z_max: f64::from(cylinder.z_max),
            phi_max: azimuth_limit(cylinder.phi_max),
        }
    }

    /// Solves `|o + t·d|² = r²` across the axis, around the point of the line closest to it. A line
    /// along the axis has no roots.
    pub(crate) fn roots(&self, line: &LocalLine) -> Roots {
        if self.radius == 0.0 {
            return [f64::NAN; 2];
        }
        let (origin, direction) = (line.origin.xy(), line.direction.xy());
        let square = direction.length_squared();
        let t_closest = -origin.dot(direction) / square;
        let closest: DVec2 = origin + t_closest * direction;
        let distance = closest.length();
        chord(
            t_closest,
            (self.radius - distance) * (self.radius + distance) / square,
        )
    }

    /// Returns `u` and `v` of a point on the cylinder. None: it is cut away.
    pub(crate) fn parameters(&self, p: DVec3) -> Option<[f64; 2]> {
        let phi = azimuth(p);
        let inside = p.z >= self.z_min && p.z <= self.z_max && phi <= self.phi_max;
        let v = (p.z - self.z_min) / (self.z_max - self.z_min);
        inside.then_some([phi / self.phi_max, v])
    }
}

//! Spheres, parts of spheres and ellipsoids.

use glam::{Affine3A, DVec3};

use crate::aabb::Aabb;
use crate::primitive::{box_bounds, ellipsoid_bounds};
use crate::quadric::{LocalLine, Roots, azimuth, azimuth_limit, chord};

/// The points of a sphere around the origin of its local space with `z_min ≤ z ≤ z_max` and
/// an azimuth of at most `phi_max`; the conventions are those of pbrt-v4.
///
/// `u = φ/phi_max`, with φ from `+x` toward `+y`. `v` is 0 at `z_min`, 1 at `z_max` and linear in
/// the polar angle. Without a positive radius, a height inside the sphere or a positive
/// `phi_max` it is never hit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    /// Any invertible affine map: a scale makes an ellipsoid.
    pub local_from_world: Affine3A,
    /// In local units.
    pub radius: f32,
    /// Lower cut, in local units; at or below `-radius` nothing is cut.
    pub z_min: f32,
    /// Upper cut, in local units; at or above `radius` nothing is cut.
    pub z_max: f32,
    /// In radians; at 2π (up to rounding) or above nothing is cut.
    pub phi_max: f32,
}

impl Sphere {
    /// Returns a box that contains the sphere; see [`Primitive::bounds`](crate::Primitive::bounds).
    pub(crate) fn bounds(&self) -> Aabb {
        let shape = [self.radius, self.z_min, self.z_max, self.phi_max];
        if !shape.iter().all(|x| x.is_finite()) {
            return Aabb::EMPTY;
        }
        let test = SphereTest::new(self);
        let radius = test.radius;
        let z_center = 0.5 * (test.z_min + test.z_max);
        let half = DVec3::new(radius, radius, 0.5 * (test.z_max - test.z_min).abs());
        let whole = ellipsoid_bounds(&self.local_from_world, DVec3::ZERO, DVec3::splat(radius));
        let cut = box_bounds(&self.local_from_world, DVec3::Z * z_center, half);
        Aabb {
            min: whole.min.max(cut.min),
            max: whole.max.min(cut.max),
        }
    }
}

/// A [`Sphere`] made ready for rays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SphereTest {
    radius: f64,
    z_min: f64,
    z_max: f64,
    phi_max: f64,
    /// Polar angles at `z_min` and `z_max`.
    theta_min: f64,
    theta_max: f64,
}

impl SphereTest {
    pub(crate) fn new(sphere: &Sphere) -> Self {
        let radius = f64::from(sphere.radius.max(0.0));
        let inside = |z: f32| f64::from(z).clamp(-radius, radius);
        let (z_min, z_max) = (inside(sphere.z_min), inside(sphere.z_max));
        Self {
            radius,
            z_min,
            z_max,
            phi_max: azimuth_limit(sphere.phi_max),
            theta_min: libm::acos(z_min / radius),
            theta_max: libm::acos(z_max / radius),
        }
    }

    /// Solves `|o + t·d|² = r²` around the point of the line closest to the center, so that the
    /// discriminant does not cancel for distant origins [PBRT4, §6.8.3].
    pub(crate) fn roots(&self, line: &LocalLine) -> Roots {
        let square = line.direction.length_squared();
        let t_closest = -line.origin.dot(line.direction) / square;
        let distance = line.at(t_closest).length();
        chord(
            t_closest,
            (self.radius - distance) * (self.radius + distance) / square,
        )
    }

    /// Returns `u` and `v` of a point on the sphere. None: it is cut away.
    pub(crate) fn parameters(&self, p: DVec3) -> Option<[f64; 2]> {
        // Rounding left the point near the sphere: put it on.
        let p = p * (self.radius / p.length());
        // Points of an uncut pole must not be lost to rounding.
        let above = p.z >= self.z_min || self.z_min <= -self.radius;
        let below = p.z <= self.z_max || self.z_max >= self.radius;
        let phi = azimuth(p);
        if !(above && below && phi <= self.phi_max) {
            return None;
        }
        let theta = libm::atan2((p.x * p.x + p.y * p.y).sqrt(), p.z);
        let v = (theta - self.theta_min) / (self.theta_max - self.theta_min);
        Some([phi / self.phi_max, v.clamp(0.0, 1.0)])
    }
}

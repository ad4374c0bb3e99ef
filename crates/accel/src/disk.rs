//! Disks, rings and sectors.

use glam::{Affine3A, DVec3};

use crate::aabb::Aabb;
use crate::primitive::ellipsoid_bounds;
use crate::quadric::{LocalLine, Roots, azimuth, azimuth_limit};

/// The points of the plane `z = height` of its local space at a distance from the z axis between
/// `inner_radius` and `radius` and an azimuth of at most `phi_max`; the conventions are those
/// of pbrt-v4.
///
/// `u = φ/phi_max`, with φ from `+x` toward `+y`. `v` is 0 at the rim and 1 at the inner radius.
/// Without a radius above the inner one and a positive `phi_max` it is never hit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disk {
    /// Any invertible affine map.
    pub local_from_world: Affine3A,
    /// The z at which the plane meets the z axis, in local units.
    pub height: f32,
    /// The radius of the rim, in local units.
    pub radius: f32,
    /// The radius of the hole, in local units; 0 for none.
    pub inner_radius: f32,
    /// In radians; at 2π (up to rounding) or above nothing is cut.
    pub phi_max: f32,
}

impl Disk {
    /// Returns a box that contains the disk; see [`Primitive::bounds`](crate::Primitive::bounds).
    pub(crate) fn bounds(&self) -> Aabb {
        let shape = [self.height, self.radius, self.inner_radius, self.phi_max];
        if !shape.iter().all(|x| x.is_finite()) {
            return Aabb::EMPTY;
        }
        let center = DVec3::Z * f64::from(self.height);
        let radius = f64::from(self.radius.abs());
        ellipsoid_bounds(
            &self.local_from_world,
            center,
            DVec3::new(radius, radius, 0.0),
        )
    }
}

/// A [`Disk`] made ready for rays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct DiskTest {
    height: f64,
    radius: f64,
    inner_radius: f64,
    phi_max: f64,
}

impl DiskTest {
    pub(crate) fn new(disk: &Disk) -> Self {
        Self {
            height: f64::from(disk.height),
            radius: f64::from(disk.radius),
            inner_radius: f64::from(disk.inner_radius),
            phi_max: azimuth_limit(disk.phi_max),
        }
    }

    /// Solves `o_z + t·d_z = height`: never finite for a line parallel to the plane.
    pub(crate) fn roots(&self, line: &LocalLine) -> Roots {
        [(self.height - line.origin.z) / line.direction.z, f64::NAN]
    }

    /// Returns `u` and `v` of a point in the disk's plane. None: it is outside, or cut away.
    pub(crate) fn parameters(&self, p: DVec3) -> Option<[f64; 2]> {
        let distance = (p.x * p.x + p.y * p.y).sqrt();
        let phi = azimuth(p);
        if distance > self.radius || distance < self.inner_radius || phi > self.phi_max {
            return None;
        }
        let v = (self.radius - distance) / (self.radius - self.inner_radius);
        Some([phi / self.phi_max, v])
    }
}

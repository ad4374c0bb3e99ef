//! Disks: flat rings and parts of them. An affine map scales all of their area by the same factor, so that points are
//! drawn with the constant density 1/area (1/m²) for any receiver.

use super::{
    Differentials, Orientation, Placement, ShapeSample, SurfacePoint, WorldFromObject, azimuth_part,
};
use crate::math::{Affine3A, PI, Vec2, Vec3, sin_cos, sqr};

/// The ring at `z = height` with radii from `inner_radius` to `radius` and azimuth below
/// `phi_max`, in its own space, under an affine map to the world. The front is +z.
#[derive(Clone, Copy, Debug)]
pub struct Disk {
    placement: Placement,
    height: f32,
    radius: f32,
    inner_radius: f32,
    phi_max: f32,
    orientation: Orientation,
}

impl Disk {
    /// Makes a ring between `inner_radius` and `radius` at `height`, up to azimuth `phi_max` (radians).
    pub fn new(
        world_from_local: Affine3A,
        height: f32,
        [inner_radius, radius]: [f32; 2],
        phi_max: f32,
        orientation: Orientation,
    ) -> Self {
        let placement = Placement::new(world_from_local);
        let phi_max = phi_max.clamp(0.0, 2.0 * PI);
        Self {
            placement,
            height,
            radius,
            inner_radius,
            phi_max,
            orientation,
        }
    }

    pub(super) fn primitive(&self) -> accel::Disk {
        accel::Disk {
            local_from_world: self.placement.local_from_world,
            height: self.height,
            radius: self.radius,
            inner_radius: self.inner_radius,
            phi_max: self.phi_max,
        }
    }

    /// Returns the area. Unit: m².
    pub fn area(&self) -> f32 {
        let local = self.phi_max / 2.0 * (sqr(self.radius) - sqr(self.inner_radius));
        local * self.placement.area_scale(Vec3::Z)
    }

    /// Returns the disk of an object, placed in the world. Its densities are still those of the object.
    #[inline]
    pub(super) fn at(&self, to_world: &WorldFromObject) -> Self {
        Self {
            placement: self.placement.at(to_world),
            ..*self
        }
    }

    /// Returns a bound of the absolute coordinates of its points.
    #[inline]
    pub(super) fn magnitude(&self) -> f32 {
        self.placement.magnitude(self.radius.max(self.height.abs()))
    }

    #[inline]
    pub(super) fn surface_point(&self, uv: Vec2, point: Vec3) -> SurfacePoint {
        let mut local = self.placement.local_from_world.transform_point3(point);
        local.z = self.height;
        self.placement
            .surface_point(local, Vec3::Z, self.orientation, uv)
    }

    /// Returns the geometric normal.
    pub(super) fn normal(&self) -> Vec3 {
        self.placement.normal(Vec3::Z).normalize() * self.orientation.sign()
    }

    pub(super) fn parameters_at(&self, p: Vec3) -> Vec2 {
        let local = self.placement.local_from_world.transform_point3(p);
        let width = self.radius - self.inner_radius;
        let inwards = (self.radius - local.truncate().length()) / width;
        Vec2::new(azimuth_part(local, self.phi_max), inwards.clamp(0.0, 1.0))
    }

    /// Returns the derivatives along azimuth and inwards.
    pub(super) fn differentials(&self, point: Vec3) -> Differentials {
        let local = self.placement.local_from_world.transform_point3(point);
        let along = Vec3::new(-local.y, local.x, 0.0) * self.phi_max;
        let outwards = Vec3::new(local.x, local.y, 0.0).normalize_or_zero();
        let inwards = outwards * (self.inner_radius - self.radius);
        let unchanged = [Vec3::ZERO; 2];
        self.placement
            .differentials([along, inwards], Vec3::Z, unchanged, self.orientation)
    }

    /// Draws a point uniformly over the area: the azimuth, and the square of the radius.
    #[inline]
    pub(super) fn sample(&self, u: Vec2) -> ShapeSample {
        let (outer2, inner2) = (sqr(self.radius), sqr(self.inner_radius));
        let r = (inner2 + (outer2 - inner2) * u.x).sqrt();
        let (sin, cos) = sin_cos(self.phi_max * u.y);
        let local = Vec3::new(r * cos, r * sin, self.height);
        let uv = Vec2::new(u.y, (self.radius - r) / (self.radius - self.inner_radius));
        let surface = self
            .placement
            .surface_point(local, Vec3::Z, self.orientation, uv);
        ShapeSample {
            surface,
            pdf: 1.0 / self.area(),
        }
    }
}

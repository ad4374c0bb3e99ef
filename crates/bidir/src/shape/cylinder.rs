//! Cylinders without caps, and parts of them, under any affine map. Points are drawn uniformly over local area, with
//! density 1 / (φ_max r (z_max - z_min)), divided by the stretch of the map. Measure: area, 1/m².

use super::{
    Differentials, Orientation, Placement, ShapeSample, SurfacePoint, WorldFromObject, azimuth_part,
};
use crate::math::{Affine3A, PI, Vec2, Vec3, sin_cos};

/// The points at the distance `radius` from the z axis with z in `[z_min, z_max]` and azimuth below `phi_max`, in
/// their own space, under an affine map to the world. The front is the outside.
#[derive(Clone, Copy, Debug)]
pub struct Cylinder {
    placement: Placement,
    radius: f32,
    z_min: f32,
    z_max: f32,
    phi_max: f32,
    orientation: Orientation,
    area: f32,
}

impl Cylinder {
    /// Makes the part of a cylinder of `radius` within `limits`: `z_min`, `z_max` and `phi_max` (radians).
    pub fn new(
        world_from_local: Affine3A,
        radius: f32,
        limits: Vec3,
        orientation: Orientation,
    ) -> Self {
        let mut cylinder = Self {
            placement: Placement::new(world_from_local),
            radius,
            z_min: limits.x.min(limits.y),
            z_max: limits.y.max(limits.x),
            phi_max: limits.z.clamp(0.0, 2.0 * PI),
            orientation,
            area: 0.0,
        };
        cylinder.area = cylinder.integrate_area();
        cylinder
    }

    fn local_area(&self) -> f32 {
        self.phi_max * self.radius * (self.z_max - self.z_min)
    }

    /// Returns the world area by the midpoint rule over φ.
    fn integrate_area(&self) -> f32 {
        let n = 1024;
        let scale = |i: i32| {
            let normal = self.normal((i as f32 + 0.5) / n as f32);
            f64::from(self.placement.area_scale(normal))
        };
        let mean = (0..n).map(scale).sum::<f64>() / f64::from(n);
        self.local_area() * mean as f32
    }

    /// Returns the local normal at the first parameter `u`.
    #[inline]
    fn normal(&self, u: f32) -> Vec3 {
        let (sin, cos) = sin_cos(self.phi_max * u);
        Vec3::new(cos, sin, 0.0)
    }

    pub(super) fn primitive(&self) -> accel::Cylinder {
        accel::Cylinder {
            local_from_world: self.placement.local_from_world,
            radius: self.radius,
            z_min: self.z_min,
            z_max: self.z_max,
            phi_max: self.phi_max,
        }
    }

    /// Returns the area. Unit: m².
    pub fn area(&self) -> f32 {
        self.area
    }

    /// Returns the cylinder of an object, placed in the world. Its densities are still those of the object.
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
        let height = self.z_min.abs().max(self.z_max.abs());
        self.placement.magnitude(self.radius.max(height))
    }

    #[inline]
    pub(super) fn surface_point(&self, uv: Vec2, point: Vec3) -> SurfacePoint {
        let local = self.placement.local_from_world.transform_point3(point);
        let normal = local.with_z(0.0).normalize_or(Vec3::X);
        self.at_local(normal, local.z, uv)
    }

    #[inline]
    fn at_local(&self, normal: Vec3, z: f32, uv: Vec2) -> SurfacePoint {
        let local = (normal * self.radius).with_z(z);
        self.placement
            .surface_point(local, normal, self.orientation, uv)
    }

    pub(super) fn parameters_at(&self, p: Vec3) -> Vec2 {
        let local = self.placement.local_from_world.transform_point3(p);
        let upwards = (local.z - self.z_min) / (self.z_max - self.z_min);
        Vec2::new(azimuth_part(local, self.phi_max), upwards.clamp(0.0, 1.0))
    }

    /// Returns the derivatives along azimuth and along z.
    pub(super) fn differentials(&self, point: Vec3) -> Differentials {
        let local = self.placement.local_from_world.transform_point3(point);
        let normal = local.with_z(0.0).normalize_or(Vec3::X);
        let turned = Vec3::new(-normal.y, normal.x, 0.0) * self.phi_max;
        let upwards = Vec3::Z * (self.z_max - self.z_min);
        self.placement.differentials(
            [turned * self.radius, upwards],
            normal,
            [turned, Vec3::ZERO],
            self.orientation,
        )
    }

    #[inline]
    pub(super) fn sample(&self, u: Vec2) -> ShapeSample {
        let normal = self.normal(u.y);
        let z = self.z_min + (self.z_max - self.z_min) * u.x;
        ShapeSample {
            surface: self.at_local(normal, z, Vec2::new(u.y, u.x)),
            pdf: self.pdf_at(normal),
        }
    }

    #[inline]
    fn pdf_at(&self, normal: Vec3) -> f32 {
        1.0 / (self.local_area() * self.placement.area_scale(normal))
    }

    #[inline]
    pub(crate) fn pdf(&self, point: Vec3) -> f32 {
        let local = self.placement.local_from_world.transform_point3(point);
        self.pdf_at(local.with_z(0.0).normalize_or(Vec3::X))
    }
}

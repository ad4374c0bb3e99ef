//! Spheres and parts of spheres, under any affine map. Densities are area measure, 1/m²:
//!
//! - uniformly over local area: 1 / (φ_max r (z_max - z_min)), divided by the stretch of the map;
//! - for a receiver outside a whole, undistorted sphere, uniformly in the cone in which it sees the sphere: cosθ /
//!   (d² 2π (1 - cosθ_max)) [PBRT4, §6.2.4]. For other receivers and spheres by area.

use super::{
    Differentials, Orientation, Placement, ShapeSample, SurfacePoint, WorldFromObject, azimuth_part,
};
use crate::math::{Affine3A, Frame, PI, Vec2, Vec3, safe_sqrt, sin_cos, sqr, warp};

/// The part of a sphere with z in `[z_min, z_max]` and azimuth below `phi_max`, in its own space,
/// under an affine map to the world. The front is the outside.
#[derive(Clone, Copy, Debug)]
pub struct Sphere {
    placement: Placement,
    radius: f32,
    z_min: f32,
    z_max: f32,
    phi_max: f32,
    orientation: Orientation,
    area: f32,
    /// The centre and the radius in the world. None: it is not a whole, undistorted sphere, and directions cannot be
    /// drawn in a cone.
    ball: Option<(Vec3, f32)>,
}

impl Sphere {
    /// Makes a whole sphere of `radius` around the origin of its own space.
    pub fn new(world_from_local: Affine3A, radius: f32, orientation: Orientation) -> Self {
        let whole = Vec3::new(-radius, radius, 2.0 * PI);
        Self::partial(world_from_local, radius, whole, orientation)
    }

    /// Makes the part of a sphere within `limits`: `z_min`, `z_max` and `phi_max` (radians).
    pub fn partial(
        world_from_local: Affine3A,
        radius: f32,
        limits: Vec3,
        orientation: Orientation,
    ) -> Self {
        let [z_min, z_max] = [limits.x, limits.y].map(|z| z.clamp(-radius, radius));
        let phi_max = limits.z.clamp(0.0, 2.0 * PI);
        let mut sphere = Self {
            placement: Placement::new(world_from_local),
            radius,
            z_min: z_min.min(z_max),
            z_max: z_max.max(z_min),
            phi_max,
            orientation,
            area: 0.0,
            ball: None,
        };
        sphere.area = sphere.integrate_area();
        sphere.ball = sphere.whole_ball();
        sphere
    }

    fn local_area(&self) -> f32 {
        self.phi_max * self.radius * (self.z_max - self.z_min)
    }

    /// Returns the world area by the midpoint rule over (z, φ), in which local area is uniform.
    fn integrate_area(&self) -> f32 {
        let n = 64;
        let scale = |i: i32| {
            let u = Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32;
            f64::from(self.placement.area_scale(self.local_point(u) / self.radius))
        };
        let mean = (0..n * n).map(scale).sum::<f64>() / f64::from(n * n);
        self.local_area() * mean as f32
    }

    /// Returns true where nothing is cut off.
    pub fn is_whole(&self) -> bool {
        self.z_min <= -self.radius && self.z_max >= self.radius && self.phi_max >= 2.0 * PI - 1e-6
    }

    /// Returns the enclosed volume, negative if the front is inside; 0 for parts of a sphere. Unit: m³.
    pub(super) fn enclosed(&self) -> f64 {
        let [radius, scale] = [self.radius, self.placement.volume_scale].map(f64::from);
        let ball = 4.0 / 3.0 * std::f64::consts::PI * radius * radius * radius * scale;
        f64::from(u8::from(self.is_whole())) * ball * f64::from(self.orientation.sign())
    }

    fn whole_ball(&self) -> Option<(Vec3, f32)> {
        let whole = self.is_whole();
        let m = self.placement.world_from_local.matrix3;
        let scale = m.x_axis.length();
        let lengths = [m.y_axis.length(), m.z_axis.length()];
        let shears = [
            m.x_axis.dot(m.y_axis),
            m.x_axis.dot(m.z_axis),
            m.y_axis.dot(m.z_axis),
        ];
        let even = lengths
            .iter()
            .all(|length| (length - scale).abs() < 1e-5 * scale)
            && shears.iter().all(|shear| shear.abs() < 1e-5 * sqr(scale));
        let centre = Vec3::from(self.placement.world_from_local.translation);
        (whole && even).then_some((centre, self.radius * scale))
    }

    pub(super) fn primitive(&self) -> accel::Sphere {
        accel::Sphere {
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

    /// Returns the sphere of an object, placed in the world. Its densities are still those of the object.
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
        self.placement.magnitude(self.radius)
    }

    #[inline]
    pub(super) fn surface_point(&self, uv: Vec2, point: Vec3) -> SurfacePoint {
        let local = self.placement.local_from_world.transform_point3(point);
        self.at_local(local.normalize_or(Vec3::Z), uv)
    }

    #[inline]
    fn at_local(&self, n: Vec3, uv: Vec2) -> SurfacePoint {
        self.placement
            .surface_point(n * self.radius, n, self.orientation, uv)
    }

    /// Returns the derivatives along azimuth and upwards from z_min.
    pub(super) fn differentials(&self, point: Vec3) -> Differentials {
        let local = self.placement.local_from_world.transform_point3(point);
        let n = local.normalize_or(Vec3::Z);
        let rho = (sqr(n.x) + sqr(n.y)).sqrt();
        let theta = |z: f32| libm::acosf((z / self.radius).clamp(-1.0, 1.0));
        let up = theta(self.z_min) - theta(self.z_max);
        let changes = [
            Vec3::new(-n.y, n.x, 0.0) * self.phi_max,
            Vec3::new(-n.x * n.z / rho, -n.y * n.z / rho, rho) * up,
        ];
        let tangents = changes.map(|change| change * self.radius);
        self.placement
            .differentials(tangents, n, changes, self.orientation)
    }

    /// Returns the local point for `u`, uniform over local area if `u` is uniform over the unit square.
    #[inline]
    fn local_point(&self, u: Vec2) -> Vec3 {
        let z = self.z_min + (self.z_max - self.z_min) * u.x;
        let (sin, cos) = sin_cos(self.phi_max * u.y);
        let rho = safe_sqrt(sqr(self.radius) - sqr(z));
        Vec3::new(rho * cos, rho * sin, z)
    }

    #[inline]
    pub(super) fn sample(&self, u: Vec2) -> ShapeSample {
        let n = self.local_point(u) / self.radius;
        let pdf = 1.0 / (self.local_area() * self.placement.area_scale(n));
        ShapeSample {
            surface: self.at_local(n, self.parameters(n)),
            pdf,
        }
    }

    #[inline]
    pub(crate) fn pdf(&self, point: Vec3) -> f32 {
        let local = self.placement.local_from_world.transform_point3(point);
        let n = local.normalize_or(Vec3::Z);
        1.0 / (self.local_area() * self.placement.area_scale(n))
    }

    /// Returns 1 - cosθ of the cone in which `reference` sees the ball, the distance of the centre, the centre, and
    /// the radius.
    ///
    /// None: this is not a ball, or the reference is inside or too near.
    #[inline]
    fn cone(&self, reference: Vec3) -> Option<(f32, f32, Vec3, f32)> {
        let (centre, radius) = self.ball?;
        let distance2 = centre.distance_squared(reference);
        let sin2 = sqr(radius) / distance2;
        let height = sin2 / (1.0 + safe_sqrt(1.0 - sin2));
        (sin2 < 0.9999).then(|| (height, distance2.sqrt(), centre, radius))
    }

    #[inline]
    pub(super) fn sample_from(&self, reference: Vec3, u: Vec2) -> ShapeSample {
        let Some((height, distance, centre, radius)) = self.cone(reference) else {
            return self.sample(u);
        };
        // The direction in the cone, then the angle α at the centre of the point it meets first,
        // without the distances, whose difference has no digits far away [PBRT4, §6.2.4].
        let direction = warp::uniform_cone(u, height);
        let sin2 = sqr(direction.x) + sqr(direction.y);
        let sin_max = radius / distance;
        let cos = sin2 / sin_max + direction.z * safe_sqrt(1.0 - sin2 / sqr(sin_max));
        let cos_alpha = cos.clamp(-1.0, 1.0);
        let sin_alpha = safe_sqrt(1.0 - sqr(cos_alpha));
        let around = Vec2::new(direction.x, direction.y).normalize_or(Vec2::X) * sin_alpha;
        let to_reference = Frame::from_z((reference - centre) / distance);
        let outward = to_reference.to_world(around.extend(cos_alpha));
        let local = self
            .placement
            .local_from_world
            .transform_point3(centre + outward * radius);
        let n = local.normalize_or(Vec3::Z);
        let surface = self.at_local(n, self.parameters(n));
        let pdf = self.pdf_from(reference, surface.point, surface.n_g);
        ShapeSample { surface, pdf }
    }

    #[inline]
    pub(crate) fn pdf_from(&self, reference: Vec3, point: Vec3, n_g: Vec3) -> f32 {
        let Some((height, ..)) = self.cone(reference) else {
            return self.pdf(point);
        };
        let to_reference = reference - point;
        let distance2 = to_reference.length_squared();
        let cos = n_g.dot(to_reference).abs() / distance2.sqrt();
        cos / (distance2 * 2.0 * PI * height)
    }

    pub(super) fn parameters_at(&self, p: Vec3) -> Vec2 {
        let local = self.placement.local_from_world.transform_point3(p);
        self.parameters(local.normalize_or(Vec3::Z))
    }

    /// Returns (u, v) of the point with unit local normal `n`, as the intersector gives them.
    fn parameters(&self, n: Vec3) -> Vec2 {
        let theta = |z: f32| libm::acosf((z / self.radius).clamp(-1.0, 1.0));
        let (bottom, top) = (theta(self.z_min), theta(self.z_max));
        let v = (theta(n.z * self.radius) - bottom) / (top - bottom);
        // Rounding may leave the unit square.
        Vec2::new(azimuth_part(n, self.phi_max), v.clamp(0.0, 1.0))
    }
}

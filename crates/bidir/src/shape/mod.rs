//! Surfaces: hits by rays, and points drawn on them.
//!
//! All geometry is in world space, except for the shapes of objects, which a [`WorldFromObject`] maps to it. A shape
//! gives its primitives to [`accel`], turns a hit into a [`SurfacePoint`], and, if it is a light, draws points by
//! area. Densities are in **area measure**, 1/m².
//!
//! The geometric normal `n_g` points to the front: the side that a one-sided light emits
//! to, and the outside of a dielectric. It is always on the side of the shading normal `n_s`.
//!
//! **Adding one**: a file, a variant in [`Shape`] with an arm in each match, its intersection in
//! `accel`, and a mapping in the scene reader.

mod cylinder;
mod differentials;
mod disk;
mod mesh;
mod sphere;
mod world_from_object;

#[cfg(test)]
mod tests;

pub use cylinder::Cylinder;
pub use differentials::Differentials;
pub use disk::Disk;
pub use mesh::Mesh;
pub use sphere::Sphere;
pub use world_from_object::WorldFromObject;

use crate::locus::Locus;
use crate::math::{Affine3A, Frame, PI, Vec2, Vec3};

/// The local geometry at a point of a surface.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// The point.
    pub point: Vec3,
    /// A bound of the distance between `point` and the surface of the intersector, by which ray origins are offset.
    pub error: f32,
    /// The geometric normal, unit, towards the front.
    pub n_g: Vec3,
    /// The shading frame: z is `n_s`, x follows ∂p/∂u.
    pub shading: Frame,
    /// Surface parameters, for textures.
    pub uv: Vec2,
}

impl SurfacePoint {
    /// Returns the place.
    #[inline]
    pub fn locus(&self) -> Locus {
        Locus::on_surface(self.point, self.n_g, self.error)
    }
}

/// A point drawn on a shape.
#[derive(Clone, Copy, Debug)]
pub struct ShapeSample {
    /// The point. On a triangle, the x of the shading frame is arbitrary.
    pub surface: SurfacePoint,
    /// Its density. Measure: area, 1/m².
    pub pdf: f32,
}

/// The geometric normals of a primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Normals {
    /// One normal for all points.
    One(Vec3),
    /// This normal or its opposite: shading normals are on both sides.
    Opposite(Vec3),
    /// Any normal: the surface is curved.
    Any,
}

/// A surface of the scene.
#[derive(Clone, Debug)]
pub enum Shape {
    /// Triangles that share vertices.
    Mesh(Mesh),
    /// A sphere, or part of one, under any affine map.
    Sphere(Sphere),
    /// A disk or ring, or a sector of one, under any affine map.
    Disk(Disk),
    /// A cylinder without caps, or part of one, under any affine map.
    Cylinder(Cylinder),
}

impl Shape {
    /// Returns the name of its kind, in one word.
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::Mesh(_) => "mesh",
            Self::Sphere(_) => "sphere",
            Self::Disk(_) => "disk",
            Self::Cylinder(_) => "cylinder",
        }
    }

    /// Returns the number of primitives that [`primitive`](Self::primitive) counts.
    pub fn primitive_count(&self) -> usize {
        match self {
            Self::Mesh(mesh) => mesh.triangle_count(),
            Self::Sphere(_) | Self::Disk(_) | Self::Cylinder(_) => 1,
        }
    }

    /// Returns primitive `i` for the intersector.
    pub fn primitive(&self, i: usize) -> accel::Primitive {
        match self {
            Self::Mesh(mesh) => accel::Primitive::Triangle(mesh.triangle(i)),
            Self::Sphere(sphere) => accel::Primitive::Sphere(sphere.primitive()),
            Self::Disk(disk) => accel::Primitive::Disk(disk.primitive()),
            Self::Cylinder(cylinder) => accel::Primitive::Cylinder(cylinder.primitive()),
        }
    }

    /// Returns the surface point of a hit of primitive `i`; `uv` are the intersector's parameters, and `point` is the
    /// hit as the ray computed it.
    #[inline]
    pub fn surface_point(&self, i: usize, uv: Vec2, point: Vec3) -> SurfacePoint {
        match self {
            Self::Mesh(mesh) => mesh.surface_point(i, uv),
            Self::Sphere(sphere) => sphere.surface_point(uv, point),
            Self::Disk(disk) => disk.surface_point(uv, point),
            Self::Cylinder(cylinder) => cylinder.surface_point(uv, point),
        }
    }

    /// Returns the intersector's parameters of the point `p` of primitive `i`.
    pub fn parameters(&self, i: usize, p: Vec3) -> Vec2 {
        match self {
            Self::Mesh(mesh) => mesh.barycentric(i, p),
            Self::Sphere(sphere) => sphere.parameters_at(p),
            Self::Disk(disk) => disk.parameters_at(p),
            Self::Cylinder(cylinder) => cylinder.parameters_at(p),
        }
    }

    /// Returns only the surface's parameters of such a hit.
    #[inline]
    pub fn uv(&self, i: usize, uv: Vec2) -> Vec2 {
        match self {
            Self::Mesh(mesh) => mesh.uv(i, uv),
            Self::Sphere(_) | Self::Disk(_) | Self::Cylinder(_) => uv,
        }
    }

    /// Returns the surface point of an object's shape under `to_world`, in world space; `point` is in world space,
    /// too.
    #[inline]
    pub fn surface_point_at(
        &self,
        to_world: &WorldFromObject,
        i: usize,
        uv: Vec2,
        point: Vec3,
    ) -> SurfacePoint {
        let (mut surface, magnitude) = match self {
            Self::Mesh(mesh) => return mesh.surface_point_at(to_world, i, uv),
            Self::Sphere(sphere) => (
                sphere.at(to_world).surface_point(uv, point),
                sphere.magnitude(),
            ),
            Self::Disk(disk) => (disk.at(to_world).surface_point(uv, point), disk.magnitude()),
            Self::Cylinder(cylinder) => (
                cylinder.at(to_world).surface_point(uv, point),
                cylinder.magnitude(),
            ),
        };
        surface.error += to_world.error(magnitude);
        surface
    }

    /// Returns the derivatives along the parameters at such a hit, of a shape of the world or of an object under
    /// `to_world`; `surface` is its [`surface_point`](Self::surface_point).
    pub fn differentials(
        &self,
        to_world: Option<&WorldFromObject>,
        i: usize,
        uv: Vec2,
        surface: &SurfacePoint,
    ) -> Differentials {
        match self {
            Self::Mesh(mesh) => mesh.differentials(to_world, i, uv),
            Self::Sphere(sphere) => to_world
                .map_or(*sphere, |map| sphere.at(map))
                .differentials(surface.point),
            Self::Disk(disk) => to_world
                .map_or(*disk, |map| disk.at(map))
                .differentials(surface.point),
            Self::Cylinder(cylinder) => to_world
                .map_or(*cylinder, |map| cylinder.at(map))
                .differentials(surface.point),
        }
    }

    /// Returns the area of primitive `i`. Unit: m².
    pub fn primitive_area(&self, i: usize) -> f32 {
        match self {
            Self::Mesh(mesh) => mesh.triangle_area(i),
            Self::Sphere(sphere) => sphere.area(),
            Self::Disk(disk) => disk.area(),
            Self::Cylinder(cylinder) => cylinder.area(),
        }
    }

    /// Returns two corners of a box around it.
    pub fn corners(&self) -> [Vec3; 2] {
        let bounds = (0..self.primitive_count()).map(|i| self.primitive(i).bounds());
        let all = bounds.fold(accel::Aabb::EMPTY, accel::Aabb::union);
        [all.min, all.max]
    }

    /// Returns the volume that the shape itself encloses; 0 if it is not closed. Unit: m³.
    pub fn enclosed(&self) -> f64 {
        match self {
            Self::Mesh(mesh) => mesh.enclosed(),
            Self::Sphere(sphere) => sphere.enclosed(),
            Self::Disk(_) | Self::Cylinder(_) => 0.0,
        }
    }

    /// Returns the geometric normals of primitive `i`.
    pub fn normals(&self, i: usize) -> Normals {
        match self {
            Self::Mesh(mesh) => mesh.triangle_normals(i),
            Self::Disk(disk) => Normals::One(disk.normal()),
            Self::Sphere(_) | Self::Cylinder(_) => Normals::Any,
        }
    }

    /// Draws a point of primitive `i`, uniformly over its area unless a map stretches it unevenly.
    #[inline]
    pub fn sample(&self, i: usize, u: Vec2) -> ShapeSample {
        match self {
            Self::Mesh(mesh) => mesh.sample(i, u),
            Self::Sphere(sphere) => sphere.sample(u),
            Self::Disk(disk) => disk.sample(u),
            Self::Cylinder(cylinder) => cylinder.sample(u),
        }
    }

    /// Returns the density of [`sample`](Self::sample) at `point`. Measure: area, 1/m².
    #[inline]
    pub fn pdf(&self, i: usize, point: Vec3) -> f32 {
        match self {
            Self::Mesh(mesh) => 1.0 / mesh.triangle_area(i),
            Self::Sphere(sphere) => sphere.pdf(point),
            Self::Disk(disk) => 1.0 / disk.area(),
            Self::Cylinder(cylinder) => cylinder.pdf(point),
        }
    }

    /// Draws a point of primitive `i` that is likely to be visible from `reference`.
    #[inline]
    pub fn sample_from(&self, i: usize, reference: Vec3, u: Vec2) -> ShapeSample {
        match self {
            Self::Mesh(_) | Self::Disk(_) | Self::Cylinder(_) => self.sample(i, u),
            Self::Sphere(sphere) => sphere.sample_from(reference, u),
        }
    }

    /// Returns the density of [`sample_from`](Self::sample_from) at `point`, whose normal is `n_g`.
    /// Measure: area, 1/m².
    #[inline]
    pub fn pdf_from(&self, i: usize, reference: Vec3, point: Vec3, n_g: Vec3) -> f32 {
        match self {
            Self::Mesh(_) | Self::Disk(_) | Self::Cylinder(_) => self.pdf(i, point),
            Self::Sphere(sphere) => sphere.pdf_from(reference, point, n_g),
        }
    }
}

/// Returns the azimuth of a local point, as a fraction of `phi_max`.
#[inline]
fn azimuth_part(local: Vec3, phi_max: f32) -> f32 {
    let angle = libm::atan2f(local.y, local.x);
    let phi = if angle < 0.0 { angle + 2.0 * PI } else { angle };
    (phi / phi_max).min(1.0)
}

/// The side of a surface that is the front.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Orientation {
    /// The side of the shape's own parametrisation or winding.
    #[default]
    Natural,
    /// The other side.
    Reversed,
}

impl Orientation {
    /// Returns 1, or -1 if reversed.
    #[inline]
    pub fn sign(self) -> f32 {
        match self {
            Self::Natural => 1.0,
            Self::Reversed => -1.0,
        }
    }
}

/// Returns a bound of the rounding error of a surface point computed from coordinates up to `magnitude`:
/// interpolation, the intersector's translation and its own arithmetic, with room.
#[inline]
pub(crate) fn position_error(magnitude: f32) -> f32 {
    32.0 * f32::EPSILON * magnitude
}

/// The map of a quadric between its own space and the world.
#[derive(Clone, Copy, Debug)]
struct Placement {
    world_from_local: Affine3A,
    local_from_world: Affine3A,
    /// |det| of the linear part.
    volume_scale: f32,
}

impl Placement {
    fn new(world_from_local: Affine3A) -> Self {
        Self {
            world_from_local,
            local_from_world: world_from_local.inverse(),
            volume_scale: world_from_local.matrix3.determinant().abs(),
        }
    }

    /// Returns the placement in the world of a quadric of an object.
    #[inline]
    fn at(&self, to_world: &WorldFromObject) -> Self {
        Self::new(to_world.compose(&self.world_from_local))
    }

    /// Returns a bound of the absolute world coordinates of points up to `distance` from the local origin.
    #[inline]
    fn magnitude(&self, distance: f32) -> f32 {
        let m = self.world_from_local.matrix3;
        let reach = (m.x_axis.abs() + m.y_axis.abs() + m.z_axis.abs()) * distance;
        (self.world_from_local.translation.abs() + reach).max_element()
    }

    /// Returns the world normal of a local one, by the inverse transpose; not normalised.
    #[inline]
    fn normal(&self, local: Vec3) -> Vec3 {
        self.local_from_world.matrix3.transpose() * local
    }

    /// Returns world area per local area at a point with unit local normal `n`: |det M|·|M⁻ᵀ n|.
    #[inline]
    fn area_scale(&self, n: Vec3) -> f32 {
        self.volume_scale * self.normal(n).length()
    }

    /// Returns the surface point of local geometry.
    #[inline]
    fn surface_point(
        &self,
        local: Vec3,
        normal: Vec3,
        orientation: Orientation,
        uv: Vec2,
    ) -> SurfacePoint {
        let point = self.world_from_local.transform_point3(local);
        let n_g = self.normal(normal).normalize() * orientation.sign();
        let vector = |v: Vec3| self.world_from_local.transform_vector3(v);
        let tangent = vector(Vec3::new(-local.y, local.x, 0.0));
        let reach = vector(local).abs().max_element();
        let origin = Vec3::from(self.world_from_local.translation)
            .abs()
            .max_element();
        SurfacePoint {
            point,
            error: position_error(origin + reach),
            n_g,
            shading: Frame::from_z_and_tangent(n_g, tangent),
            uv,
        }
    }
}

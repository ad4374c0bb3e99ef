//! Leaves of primitives that are not triangles: a closed set of kinds, intersected one at a time.
//!
//! Affine maps keep `t`, so a quadric is intersected in its own space, in `f64`: the error there
//! is far below that of the `f32` answer.

use std::f64::consts::TAU;

use glam::{DAffine3, DVec3};

use crate::aabb::Aabb;
use crate::cylinder::CylinderTest;
use crate::disk::DiskTest;
use crate::primitive::Primitive;
use crate::ray::Ray;
use crate::sphere::SphereTest;

/// A primitive of a quadric leaf, made ready for rays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Quadric {
    /// Index of the primitive.
    pub(crate) primitive: u32,
    /// Its bounds in the tree.
    pub(crate) bounds: Aabb,
    local_from_world: DAffine3,
    shape: Shape,
}

/// The kinds of quadrics. To add one, give it a test like the ones here and a [`Primitive`].
#[derive(Debug, Clone, Copy, PartialEq)]
enum Shape {
    Sphere(SphereTest),
    Disk(DiskTest),
    Cylinder(CylinderTest),
}

/// A line in the space of a quadric.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LocalLine {
    pub(crate) origin: DVec3,
    pub(crate) direction: DVec3,
}

impl LocalLine {
    pub(crate) fn at(&self, t: f64) -> DVec3 {
        self.origin + t * self.direction
    }
}

/// The `t` at which a line may pass a quadric: ascending, NaN for none.
pub(crate) type Roots = [f64; 2];

impl Quadric {
    /// Prepares a primitive. None: it is a triangle.
    pub(crate) fn new(index: u32, primitive: &Primitive) -> Option<Self> {
        let (local_from_world, shape) = match primitive {
            Primitive::Triangle(_) => return None,
            Primitive::Sphere(sphere) => (
                sphere.local_from_world,
                Shape::Sphere(SphereTest::new(sphere)),
            ),
            Primitive::Disk(disk) => (disk.local_from_world, Shape::Disk(DiskTest::new(disk))),
            Primitive::Cylinder(cylinder) => (
                cylinder.local_from_world,
                Shape::Cylinder(CylinderTest::new(cylinder)),
            ),
        };
        Some(Self {
            primitive: index,
            bounds: primitive.bounds(),
            local_from_world: to_f64(&local_from_world),
            shape,
        })
    }

    /// Calls `found` with `t` and `[u, v]` of every hit of the ray, in ascending `t`.
    pub(crate) fn intersect(&self, ray: &Ray, mut found: impl FnMut(f32, [f64; 2])) {
        let line = LocalLine {
            origin: self
                .local_from_world
                .transform_point3(ray.origin.as_dvec3()),
            direction: self
                .local_from_world
                .transform_vector3(ray.direction.as_dvec3()),
        };
        let roots = match &self.shape {
            Shape::Sphere(sphere) => sphere.roots(&line),
            Shape::Disk(disk) => disk.roots(&line),
            Shape::Cylinder(cylinder) => cylinder.roots(&line),
        };
        for t in roots {
            // Also false for the NaN of a missing root.
            if t as f32 >= ray.t_min && t as f32 <= ray.t_max {
                let parameters = match &self.shape {
                    Shape::Sphere(sphere) => sphere.parameters(line.at(t)),
                    Shape::Disk(disk) => disk.parameters(line.at(t)),
                    Shape::Cylinder(cylinder) => cylinder.parameters(line.at(t)),
                };
                // A shape without height, width or angle divides zero by zero.
                if let Some(parameters) = parameters.filter(|[u, v]| u.is_finite() && v.is_finite())
                {
                    found(t as f32, parameters);
                }
            }
        }
    }
}

pub(crate) fn to_f64(map: &glam::Affine3A) -> DAffine3 {
    DAffine3::from_cols(
        map.matrix3.x_axis.as_dvec3(),
        map.matrix3.y_axis.as_dvec3(),
        map.matrix3.z_axis.as_dvec3(),
        map.translation.as_dvec3(),
    )
}

/// Returns the ends of a chord whose middle is at `t_middle`, by the square of its half length in `t`.
#[inline]
pub(crate) fn chord(t_middle: f64, square: f64) -> Roots {
    let half = square.sqrt();
    [t_middle - half, t_middle + half]
}

/// Returns the largest azimuth in `f64`; an angle that is 2π up to rounding becomes 2π, lest a seam remain open.
pub(crate) fn azimuth_limit(phi_max: f32) -> f64 {
    let phi_max = f64::from(phi_max);
    if phi_max > TAU - 1e-6 { TAU } else { phi_max }
}

/// Returns the angle of `p` around the z axis from `+x` toward `+y`, in `[0, 2π]`.
pub(crate) fn azimuth(p: DVec3) -> f64 {
    let phi = libm::atan2(p.y, p.x);
    if phi < 0.0 { phi + TAU } else { phi }
}

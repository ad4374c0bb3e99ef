//! The primitives that a [`Bvh`](crate::Bvh) is built from.

use glam::{DAffine3, DVec3, Vec3};

use crate::aabb::Aabb;
use crate::cylinder::Cylinder;
use crate::disk::Disk;
use crate::quadric::to_f64;
use crate::sphere::Sphere;

/// A surface that rays can hit, in world space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Primitive {
    /// Three vertices. Without area it is never hit.
    Triangle([Vec3; 3]),
    /// A sphere, part of one, or its image under an affine map.
    Sphere(Sphere),
    /// A disk, ring or sector, or its image under an affine map.
    Disk(Disk),
    /// A cylinder without caps, part of one, or its image under an affine map.
    Cylinder(Cylinder),
}

impl Primitive {
    /// Returns a box that contains the primitive.
    ///
    /// Tight for triangles; curved primitives get the box of a whole sphere or disk (cut at
    /// `z_min` and `z_max`, but not at `phi_max`), a little widened against rounding.
    /// Not [valid](Aabb::is_valid) if a coordinate is not finite or a map has no inverse.
    pub fn bounds(&self) -> Aabb {
        match self {
            // `min` and `max` would skip a NaN.
            Self::Triangle(vertices) if !vertices.iter().all(|v| v.is_finite()) => Aabb::EMPTY,
            Self::Triangle(vertices) => Aabb::around(vertices),
            Self::Sphere(sphere) => sphere.bounds(),
            Self::Disk(disk) => disk.bounds(),
            Self::Cylinder(cylinder) => cylinder.bounds(),
        }
    }
}

/// Numbered primitives. Building a tree reads each of them twice, and keeps triangles in a form of its own: they need
/// not all be in memory at once.
pub trait Primitives: Sync {
    /// Returns the number of primitives. It is called once for a tree.
    fn count(&self) -> usize;

    /// Returns primitive `index`, less than [`count`](Self::count): the same one each time.
    ///
    /// Panics: building may panic if it returns another one.
    fn primitive(&self, index: usize) -> Primitive;
}

impl Primitives for [Primitive] {
    fn count(&self) -> usize {
        self.len()
    }

    fn primitive(&self, index: usize) -> Primitive {
        self[index]
    }
}

/// Returns bounds in world space of the ellipsoid that `x² + y² + z² ≤ 1` becomes after scaling by `radii` and moving
/// by `center` in the space of `local_from_world`.
///
/// Each world coordinate is a linear function of the unit ball: its largest value is the length
/// of its row in the combined matrix.
pub(crate) fn ellipsoid_bounds(
    local_from_world: &glam::Affine3A,
    center: DVec3,
    radii: DVec3,
) -> Aabb {
    let world_from_local = to_f64(local_from_world).inverse();
    let [x, y, z] = world_from_local
        .matrix3
        .to_cols_array_2d()
        .map(DVec3::from_array);
    let columns = [x * radii.x, y * radii.y, z * radii.z];
    let squares = columns.map(|column| column * column);
    let reach = (squares[0] + squares[1] + squares[2]).map(f64::sqrt);
    padded(world_from_local.transform_point3(center), reach)
}

/// Returns bounds in world space of a box in the space of `local_from_world`.
pub(crate) fn box_bounds(local_from_world: &glam::Affine3A, center: DVec3, half: DVec3) -> Aabb {
    let world_from_local: DAffine3 = to_f64(local_from_world).inverse();
    let reach = abs_times(&world_from_local, half);
    padded(world_from_local.transform_point3(center), reach)
}

/// Returns a bound of `|M p|` for `|p| ≤ extent`, without the translation.
pub(crate) fn abs_times(map: &DAffine3, extent: DVec3) -> DVec3 {
    let m = map.matrix3;
    m.x_axis.abs() * extent.x + m.y_axis.abs() * extent.y + m.z_axis.abs() * extent.z
}

/// Returns the box of `center ± reach`, rounded outward after widening by a millionth of its size: more
/// than what mapping a ray into local space loses, unless the map is close to singular.
fn padded(center: DVec3, reach: DVec3) -> Aabb {
    let reach = reach + DVec3::splat(1e-6 * reach.max_element());
    Aabb {
        min: Vec3::from_array((center - reach).to_array().map(|x| outward(x, -1.0))),
        max: Vec3::from_array((center + reach).to_array().map(|x| outward(x, 1.0))),
    }
}

/// Returns `value` rounded up if `direction` is 1, or down if it is -1.
pub(crate) fn outward(value: f64, direction: f64) -> f32 {
    let rounded = value as f32;
    match direction * (f64::from(rounded) - value) {
        inward if inward >= 0.0 => rounded,
        _ if direction > 0.0 => rounded.next_up(),
        _ => rounded.next_down(),
    }
}

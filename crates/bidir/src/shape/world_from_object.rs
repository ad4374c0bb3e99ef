//! The affine map of an instance, from the space of its object to the world.
//!
//! Points and tangents are mapped by the map, normals by its inverse transpose, in `f64`. Mirroring maps need no
//! exception: the front of a surface stays the front.

use super::position_error;
use crate::math::{Affine3A, DAffine3, Vec3};
use accel::Aabb;
use glam::{DMat3, DVec3};

/// The map of an instance to the world: any invertible affine map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldFromObject(pub DAffine3);

impl WorldFromObject {
    /// Maps a point of the object to the world.
    #[inline]
    pub(super) fn point(&self, p: Vec3) -> Vec3 {
        self.0.transform_point3(p.as_dvec3()).as_vec3()
    }

    /// Maps a vector of the object to the world.
    #[inline]
    pub(super) fn vector(&self, v: Vec3) -> Vec3 {
        self.0.transform_vector3(v.as_dvec3()).as_vec3()
    }

    /// Maps a normal of the object to the world. The result has unit length, or is zero if it is undefined.
    #[inline]
    pub(super) fn normal(&self, n: Vec3) -> Vec3 {
        (self.cofactors() * n.as_dvec3())
            .normalize_or_zero()
            .as_vec3()
            * self.sign()
    }

    /// Returns |det M|·M⁻ᵀ, up to the sign of the determinant.
    #[inline]
    fn cofactors(&self) -> DMat3 {
        let [x, y, z] = self.columns();
        DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y))
    }

    /// Returns 1, or -1 if the map mirrors.
    #[inline]
    pub(super) fn sign(&self) -> f32 {
        let [x, y, z] = self.columns();
        if x.dot(y.cross(z)) < 0.0 { -1.0 } else { 1.0 }
    }

    /// Returns a box in the world around a box of the object.
    pub(crate) fn bounds(&self, own: Aabb) -> Aabb {
        let corners = [own.min, own.max];
        let corner = |i: usize| {
            let [x, y, z] = std::array::from_fn(|axis| corners[i >> axis & 1][axis]);
            self.point(Vec3::new(x, y, z))
        };
        Aabb::around(&std::array::from_fn::<_, 8, _>(corner))
    }

    /// Returns |det M|: world volume per object volume.
    #[inline]
    pub(crate) fn volume_scale(&self) -> f64 {
        self.0.matrix3.determinant().abs()
    }

    #[inline]
    fn columns(&self) -> [DVec3; 3] {
        let m = self.0.matrix3;
        [m.x_axis, m.y_axis, m.z_axis]
    }

    /// Returns a bound of the world error of a point whose coordinates in the object's space are at most `magnitude`.
    #[inline]
    pub(super) fn error(&self, magnitude: f32) -> f32 {
        let [x, y, z] = self.columns();
        let stretch = (x.abs() + y.abs() + z.abs()).max_element() as f32;
        stretch * position_error(magnitude)
    }

    /// Returns the map of a quadric of the object to the world.
    #[inline]
    pub(super) fn compose(&self, object_from_local: &Affine3A) -> Affine3A {
        let m = object_from_local.matrix3;
        let columns = [m.x_axis, m.y_axis, m.z_axis].map(glam::Vec3A::as_dvec3);
        let linear = DMat3::from_cols(columns[0], columns[1], columns[2]);
        let local =
            DAffine3::from_mat3_translation(linear, object_from_local.translation.as_dvec3());
        (self.0 * local).as_affine3a()
    }
}

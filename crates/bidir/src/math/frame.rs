//! Orthonormal frames: conversion between world and local space by dot products [Duff17, listing 3].

use glam::Vec3;

/// A right-handed orthonormal frame; local z is the normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Local x in world space.
    pub x: Vec3,
    /// Local y in world space.
    pub y: Vec3,
    /// Local z in world space.
    pub z: Vec3,
}

impl Frame {
    /// Makes a frame around the unit vector `z`, without branches on its direction [Duff17, listing 3].
    #[inline]
    pub fn from_z(z: Vec3) -> Self {
        let sign = 1f32.copysign(z.z);
        let a = -1.0 / (sign + z.z);
        let b = z.x * z.y * a;
        Self {
            x: Vec3::new(1.0 + sign * z.x * z.x * a, sign * b, -sign * z.x),
            y: Vec3::new(b, sign + z.y * z.y * a, -z.y),
            z,
        }
    }

    /// Makes the frame around the unit vector `z` whose x is nearest to `tangent`; any frame if `tangent` is zero or
    /// parallel to `z`.
    #[inline]
    pub fn from_z_and_tangent(z: Vec3, tangent: Vec3) -> Self {
        let x = tangent - z * z.dot(tangent);
        let length_squared = x.length_squared();
        if length_squared <= 1e-12 * tangent.length_squared() || !length_squared.is_normal() {
            return Self::from_z(z);
        }
        let x = x / length_squared.sqrt();
        Self {
            x,
            y: z.cross(x),
            z,
        }
    }

    /// Converts a vector from world to local space.
    #[inline]
    pub fn to_local(&self, v: Vec3) -> Vec3 {
        Vec3::new(self.x.dot(v), self.y.dot(v), self.z.dot(v))
    }

    /// Converts a vector from local to world space.
    #[inline]
    pub fn to_world(&self, v: Vec3) -> Vec3 {
        self.x * v.x + self.y * v.y + self.z * v.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(frame: Frame) {
        let v = Vec3::new(0.3, -0.7, 0.2);
        assert!((frame.to_local(frame.to_world(v)) - v).length() < 1e-6);
        assert!((frame.x.cross(frame.y) - frame.z).length() < 1e-6);
        assert!((frame.x.length() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn frames_are_orthonormal_and_invertible() {
        for z in [
            Vec3::Z,
            -Vec3::Z,
            Vec3::X,
            Vec3::new(0.6, 0.0, -0.8),
            Vec3::new(1e-4, 0.0, -1.0),
        ] {
            let z = z.normalize();
            check(Frame::from_z(z));
            check(Frame::from_z_and_tangent(z, Vec3::new(0.1, 0.9, 0.3)));
            check(Frame::from_z_and_tangent(z, z));
            check(Frame::from_z_and_tangent(z, Vec3::ZERO));
        }
    }
}

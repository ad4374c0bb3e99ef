//! The points at which textures are evaluated: on surfaces, with the width of a pixel there (metres).

use crate::math::{Vec2, Vec3};
use crate::shape::{Differentials, SurfacePoint};

/// A point at which a texture is evaluated, in world space.
#[derive(Clone, Copy, Debug)]
pub struct TexturePoint {
    /// The surface's parameters.
    pub uv: Vec2,
    /// The point.
    pub point: Vec3,
    /// The shading normal before any relief, unit.
    pub normal: Vec3,
    /// The footprint of a pixel.
    pub footprint: Footprint,
    /// The side of the surface's second parameter; right-handed if it is unknown.
    pub handedness: Handedness,
}

/// The side of ∂p/∂v, seen along ∂p/∂u with the normal up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Handedness {
    /// ∂p/∂u, ∂p/∂v and the normal are right-handed.
    Right,
    /// Left-handed: the parameters are mirrored.
    Left,
}

impl Handedness {
    /// Returns the handedness of these differentials around a normal.
    #[inline]
    pub fn of(differentials: &Differentials, normal: Vec3) -> Self {
        let turn = differentials.dp_du.cross(differentials.dp_dv);
        if turn.dot(normal) < 0.0 {
            Self::Left
        } else {
            Self::Right
        }
    }

    /// Returns 1, or -1 if left-handed.
    #[inline]
    pub fn sign(self) -> f32 {
        match self {
            Self::Right => 1.0,
            Self::Left => -1.0,
        }
    }
}

/// The part of a surface that a pixel covers: a function of the point and the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint {
    /// Its width; 0: textures are not filtered. Unit: m.
    pub width: f32,
    /// ∇u over the surface; zero if it is unknown. Unit: 1/m.
    pub gradient_u: Vec3,
    /// ∇v over the surface; zero if it is unknown. Unit: 1/m.
    pub gradient_v: Vec3,
}

impl Footprint {
    /// A footprint without extent.
    pub const POINT: Self = Self {
        width: 0.0,
        gradient_u: Vec3::ZERO,
        gradient_v: Vec3::ZERO,
    };
}

impl TexturePoint {
    /// Makes a point of a surface, without a footprint.
    #[inline]
    pub fn new(surface: &SurfacePoint) -> Self {
        Self {
            uv: surface.uv,
            point: surface.point,
            normal: surface.shading.z,
            footprint: Footprint::POINT,
            handedness: Handedness::Right,
        }
    }

    /// Makes a point of which only the parameters are known.
    #[inline]
    pub fn of_parameters(uv: Vec2) -> Self {
        Self {
            uv,
            point: Vec3::ZERO,
            normal: Vec3::Z,
            footprint: Footprint::POINT,
            handedness: Handedness::Right,
        }
    }

    /// Returns the point with a pixel width of `width`, and with the gradients and the handedness of its parameters.
    #[inline]
    #[must_use]
    pub fn seen(self, width: f32, differentials: &Differentials) -> Self {
        let [gradient_u, gradient_v] = differentials.gradients();
        Self {
            footprint: Footprint {
                width,
                gradient_u,
                gradient_v,
            },
            handedness: Handedness::of(differentials, self.normal),
            ..self
        }
    }
}

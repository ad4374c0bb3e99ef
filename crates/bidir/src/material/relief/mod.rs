//! Relief: a shading frame that turns over the surface, as if it had bumps. Points stay where they
//! are, and so does the geometric normal.
//!
//! The frame is a function of the point and of the camera, so that the integrand stays one function of
//! the path. Scattering handles the directions on which the two normals disagree
//! ([`ScatteringEvent::scatter`](crate::path::ScatteringEvent::scatter)).

use super::{Material, Mixture, PrincipledMaterial};
use crate::bsdf::Thickness;
use crate::math::{Frame, Vec2, Vec3};
use crate::shape::{Differentials, SurfacePoint};
use crate::texture::{ColorTexture, FloatTexture, TexturePoint};
use std::sync::Arc;

/// A texture that turns the shading frame of a surface.
#[derive(Clone, Debug)]
pub enum Relief {
    /// The normals of the surface displaced along its normal by a height. Unit: m.
    Displacement(FloatTexture),
    /// The normals of an image.
    NormalMap(NormalMap),
}

/// Normals in the frame of the surface, stored as colours (n + 1)/2.
#[derive(Clone, Debug)]
pub struct NormalMap {
    /// The colours, linear as stored.
    pub texture: ColorTexture,
    /// The factor of their x and y.
    pub scale: f32,
    /// The direction of their y.
    pub bitangent: Bitangent,
}

/// The direction of the y of a [`NormalMap`]; its x follows the surface's tangent, its z is the shading
/// normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bitangent {
    /// The y that makes the frame right-handed, as in pbrt-v4.
    RightHanded,
    /// To the side of ∂p/∂v if x is along ∂p/∂u: to the left of x, or to the right if the parameters are mirrored.
    /// Mirrored parameters mirror the relief.
    AlongV,
}

/// Returns a frame whose z is `normal`, on the side of the geometric normal; if `normal` has no direction, the
/// shading frame of `surface`.
fn fronted(surface: &SurfacePoint, normal: Vec3, tangent: Vec3) -> Frame {
    let Some(normal) = normal.try_normalize() else {
        return surface.shading;
    };
    let front = if normal.dot(surface.n_g) < 0.0 {
        -normal
    } else {
        normal
    };
    Frame::from_z_and_tangent(front, tangent)
}

/// A material under a relief.
#[derive(Clone, Debug)]
pub struct Perturbed {
    pub(super) material: Material,
    pub(super) relief: Relief,
}

impl Material {
    /// Returns the material; a principled one is made thin-walled.
    #[must_use]
    pub fn into_thin(self) -> Self {
        match self {
            Self::Principled(material) => Self::Principled(Arc::new(PrincipledMaterial {
                thickness: Thickness::ThinWalled,
                ..(*material).clone()
            })),
            Self::Perturbed(perturbed) => {
                let material = perturbed.material.clone().into_thin();
                material.with_relief(perturbed.relief.clone())
            }
            material => material,
        }
    }

    /// Returns the material under `relief`. A material with a relief of its own keeps it; a mixture gives `relief` to
    /// its parts.
    #[must_use]
    pub fn with_relief(self, relief: Relief) -> Self {
        match self {
            Self::Perturbed(_) => self,
            Self::Mix(mixture) => {
                let perturb = |material: &Self| material.clone().with_relief(relief.clone());
                Self::Mix(Arc::new(Mixture {
                    materials: mixture.materials.each_ref().map(perturb),
                    amount: mixture.amount.clone(),
                }))
            }
            material => Self::Perturbed(Arc::new(Perturbed { material, relief })),
        }
    }
}

impl Relief {
    /// Returns the shading frame at a point. Its normal is on the side of the geometric normal, as in
    /// pbrt-v4; where it is undefined, the frame is that of the surface.
    pub fn frame(
        &self,
        surface: &SurfacePoint,
        differentials: &Differentials,
        at: &TexturePoint,
    ) -> Frame {
        let (normal, tangent) = match self {
            Self::Displacement(height) => displaced(height, surface, differentials, at),
            Self::NormalMap(map) => (map.normal(surface, at), surface.shading.x),
        };
        fronted(surface, normal, tangent)
    }
}

impl NormalMap {
    /// Returns the normal of the map at a point, on the side of the geometric normal.
    pub(super) fn front(&self, surface: &SurfacePoint, at: &TexturePoint) -> Vec3 {
        fronted(surface, self.normal(surface, at), surface.shading.x).z
    }

    fn normal(&self, surface: &SurfacePoint, at: &TexturePoint) -> Vec3 {
        let stored = Vec3::from(self.texture.eval(at)) * 2.0 - 1.0;
        let frame = &surface.shading;
        let side = match self.bitangent {
            Bitangent::RightHanded => 1.0,
            Bitangent::AlongV => at.handedness.sign(),
        };
        let scale = Vec3::new(self.scale, self.scale * side, 1.0);
        frame.to_world(stored * scale)
    }
}

/// Returns the normal of p + h n_s, not normalised, and its tangent along u, ∂p/∂u + ∂h/∂u n_s + h ∂n_s/∂u. The
/// normal is the cross product of this tangent and the one along v [PBRT4, §10.5.4].
///
/// ∂p/∂u and ∂p/∂v are projected to the plane of the shading normal, so that a constant height changes nothing on a
/// flat surface. Derivatives of h are differences over a step.
fn displaced(
    height: &FloatTexture,
    surface: &SurfacePoint,
    d: &Differentials,
    at: &TexturePoint,
) -> (Vec3, Vec3) {
    let n = surface.shading.z;
    let h = height.eval(at);
    let tangent = |axis: Vec2, gradient: Vec3, dp: Vec3, dn: Vec3| {
        let along = dp - n * n.dot(dp);
        let step = step(at, gradient);
        let moved = TexturePoint {
            uv: at.uv + axis * step,
            point: at.point + along * step,
            normal: (n + dn * step).normalize_or(n),
            footprint: at.footprint,
            handedness: at.handedness,
        };
        along + n * ((height.eval(&moved) - h) / step) + dn * h
    };
    let along_u = tangent(Vec2::X, at.footprint.gradient_u, d.dp_du, d.dn_du);
    let along_v = tangent(Vec2::Y, at.footprint.gradient_v, d.dp_dv, d.dn_dv);
    (along_u.cross(along_v), along_u)
}

/// Returns the distance between compared heights, in units of a parameter: the width of a pixel, but at least what
/// keeps their difference above rounding.
#[inline]
fn step(at: &TexturePoint, gradient: Vec3) -> f32 {
    let wide = at.footprint.width * gradient.length();
    let step = if wide > 0.0 && wide.is_finite() {
        wide
    } else {
        0.0005
    };
    step.max(2e-5 * at.uv.abs().max_element().max(1.0))
}

#[cfg(test)]
mod tests;

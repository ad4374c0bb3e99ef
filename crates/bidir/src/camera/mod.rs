//! The camera, at which paths end.
//!
//! The film's plane is measured in **raster** units: one pixel is one unit, (0, 0) the top left
//! corner. Importance and densities count per raster area, so that they do not change with a crop
//! and a pixel's value is ∫ h(x) L(x) dx over raster positions x:
//!
//! - W_e(p, ω) = (dx/dω) / (A_lens cosθ): importance at the lens point p, so that ∫∫ W_e cosθ dω dA
//!   over the lens and the directions of one pixel is 1;
//! - the density of ω given p is dx/dω: expected camera samples per pixel, 1.
//!
//! A pinhole's position is a Dirac distribution; its area counts 1. A camera of parallel rays is one
//! in direction instead, and stands at infinity: dx/dA takes the place of dx/dω.
//!
//! **Adding one**: a file, a variant in [`Camera`] with an arm in each match, and a mapping in the
//! scene reader.

mod orthographic;
mod perspective;
mod pose;
mod spherical;

#[cfg(test)]
mod tests;

pub use orthographic::{Orthographic, OrthographicSettings};
pub use perspective::{Perspective, PerspectiveSettings};
pub use pose::{Pose, Rotation};
pub use spherical::{Spherical, SphericalMapping};

use crate::locus::Locus;
use crate::math::{Vec2, Vec3};

/// A point on the lens.
#[derive(Clone, Copy, Debug)]
pub struct LensSample {
    /// The place, with the optical axis towards the scene as the normal; for parallel rays the direction
    /// towards the camera. Without a lens, in space.
    pub locus: Locus,
    /// Its density. Measure: area, 1/m²; 1 for a pinhole and for parallel rays.
    pub pdf: f32,
}

/// A ray that leaves the lens.
#[derive(Clone, Copy, Debug)]
pub struct CameraRay {
    /// The lens point that it leaves.
    pub lens: LensSample,
    /// The point from which it looks: the lens point, where that is finite.
    pub origin: Vec3,
    /// The unit direction.
    pub direction: Vec3,
}

/// The camera of the scene.
#[derive(Clone, Copy, Debug)]
pub enum Camera {
    /// A pinhole or thin lens in front of a plane.
    Perspective(Perspective),
    /// Parallel rays.
    Orthographic(Orthographic),
    /// All directions from a point.
    Spherical(Spherical),
}

impl Camera {
    /// Returns the name of its kind, in one word.
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::Perspective(_) => "perspective",
            Self::Orthographic(_) => "orthographic",
            Self::Spherical(_) => "spherical",
        }
    }

    /// Returns its position and the directions of its axes.
    pub fn pose(&self) -> Pose {
        match self {
            Self::Perspective(camera) => camera.pose,
            Self::Orthographic(camera) => camera.pose,
            Self::Spherical(camera) => camera.pose,
        }
    }

    /// Moves the camera to another pose.
    #[must_use]
    pub fn with_pose(mut self, pose: Pose) -> Self {
        match &mut self {
            Self::Perspective(camera) => camera.pose = pose,
            Self::Orthographic(camera) => camera.pose = pose,
            Self::Spherical(camera) => camera.pose = pose,
        }
        self
    }

    /// Returns true where all rays go the same way.
    pub fn is_parallel(&self) -> bool {
        matches!(self, Self::Orthographic(_))
    }

    /// Returns the same view on a film with `factor` times as many pixels to each side, all positive.
    #[must_use]
    pub fn resized(self, factor: Vec2) -> Self {
        match self {
            Self::Perspective(camera) => Self::Perspective(camera.resized(factor)),
            Self::Orthographic(camera) => Self::Orthographic(camera.resized(factor)),
            Self::Spherical(camera) => Self::Spherical(camera.resized(factor)),
        }
    }

    /// Returns a point of the lens. The numbers are asked for where the lens has an extent.
    #[inline]
    pub fn sample_lens(&self, u: impl FnOnce() -> Vec2) -> LensSample {
        match self {
            Self::Perspective(camera) => camera.sample_lens(u),
            Self::Orthographic(camera) => camera.lens(),
            Self::Spherical(camera) => camera.lens(),
        }
    }

    /// Returns the ray from the lens point of `u` whose image is `raster`.
    #[inline]
    pub fn sample_ray(&self, raster: Vec2, u: impl FnOnce() -> Vec2) -> CameraRay {
        match self {
            Self::Perspective(camera) => camera.sample_ray(raster, u),
            Self::Orthographic(camera) => camera.sample_ray(raster),
            Self::Spherical(camera) => camera.sample_ray(raster),
        }
    }

    /// Returns the raster position of the ray through `p` along the unit direction `w`, `p` being a lens
    /// point, or for parallel rays any point of the ray. None: it leaves backwards.
    #[inline]
    pub fn raster(&self, p: Vec3, w: Vec3) -> Option<Vec2> {
        match self {
            Self::Perspective(camera) => camera.raster(p, w),
            Self::Orthographic(camera) => camera.raster(p),
            Self::Spherical(camera) => Some(camera.raster(w)),
        }
    }

    /// Returns how far in front of the camera a point is: along the axis, where there is one.
    #[inline]
    pub fn depth(&self, p: Vec3) -> f32 {
        match self {
            Self::Perspective(camera) => camera.depth(p),
            Self::Orthographic(camera) => camera.depth(p),
            Self::Spherical(camera) => camera.depth(p),
        }
    }

    /// Returns the importance W_e of the unit direction `w` at any point of the lens; zero backwards.
    #[inline]
    pub fn importance(&self, w: Vec3) -> f32 {
        match self {
            Self::Perspective(camera) => camera.importance(w),
            Self::Orthographic(camera) => camera.density(w),
            Self::Spherical(camera) => camera.density(w),
        }
    }

    /// Returns the density of leaving the lens along `w`. Measure: solid angle, camera samples per pass
    /// and sr; for parallel rays area across them, camera samples per pass and m².
    #[inline]
    pub fn pdf_direction(&self, w: Vec3) -> f32 {
        match self {
            Self::Perspective(camera) => camera.pdf_direction(w),
            Self::Orthographic(camera) => camera.density(w),
            Self::Spherical(camera) => camera.density(w),
        }
    }

    /// Returns how wide a pixel is at the point `p`, across the view: textures there are averaged over it.
    /// A function of the point alone, of any point of the world, seen or not. Unit: m.
    #[inline]
    pub fn pixel_width(&self, p: Vec3) -> f32 {
        match self {
            Self::Perspective(camera) => camera.pixel_width(p),
            Self::Orthographic(camera) => camera.pixel_width(),
            Self::Spherical(camera) => camera.pixel_width(p),
        }
    }
}

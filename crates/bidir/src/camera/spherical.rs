//! W_e = dx/dω: a picture of everything around a point, which has no lens and no cosine. Densities
//! are raster area per solid angle, 1/sr.
//!
//! Two maps from the film to directions, y being up: by **longitude and latitude**, where
//! dx/dω = A / (2π² sinθ) of a film of area A, and by **equal areas**, where it is A / 4π.
//!
//! The film's opposite edge continues the image beyond an edge, but pixel filters do not know that: a filter must not
//! be wider than its pixel.

use super::pose::Pose;
use super::{CameraRay, LensSample};
use crate::locus::Locus;
use crate::math::{Affine3A, Mat3, PI, Vec2, Vec3, direction_to_square, square_to_direction};

/// The map from directions to the film of a [`Spherical`] camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SphericalMapping {
    /// Longitude to the right, from the camera's right side over the front; latitude down, from
    /// above.
    Equirectangular,
    /// The octahedral square of equal areas, the camera's up in its middle.
    EqualArea,
}

/// A point that sees all around it.
#[derive(Clone, Copy, Debug)]
pub struct Spherical {
    pub(super) pose: Pose,
    resolution: Vec2,
    mapping: SphericalMapping,
    /// The map from directions of camera space to the pose's axes, of determinant ±1, and its inverse. None:
    /// they are the same.
    stretch: Option<[Mat3; 2]>,
}

impl Spherical {
    /// Returns the camera at a place: x right, y up, z forward. Unit of `resolution`: pixels. None: the map is flat,
    /// or the film is empty.
    pub fn new(
        world_from_camera: &Affine3A,
        resolution: Vec2,
        mapping: SphericalMapping,
    ) -> Option<Self> {
        let (pose, stretch) = Pose::new(world_from_camera)?;
        let stretch = stretch.of_directions();
        resolution.cmpgt(Vec2::ZERO).all().then_some(Self {
            pose,
            resolution,
            mapping,
            stretch: stretch.map(|matrix| [matrix, matrix.inverse()]),
        })
    }

    pub(super) fn resized(self, factor: Vec2) -> Self {
        Self {
            resolution: self.resolution * factor,
            ..self
        }
    }

    #[inline]
    pub(super) fn lens(&self) -> LensSample {
        LensSample {
            locus: Locus::in_space(self.pose.origin),
            pdf: 1.0,
        }
    }

    #[inline]
    pub(super) fn sample_ray(&self, raster: Vec2) -> CameraRay {
        let p = raster / self.resolution;
        let local = match self.mapping {
            SphericalMapping::Equirectangular => {
                let (sin, cos) = libm::sincosf(PI * p.y);
                let (sin_phi, cos_phi) = libm::sincosf(2.0 * PI * p.x);
                Vec3::new(sin * cos_phi, cos, sin * sin_phi)
            }
            SphericalMapping::EqualArea => {
                let d = square_to_direction(p.clamp(Vec2::ZERO, Vec2::ONE));
                Vec3::new(d.x, d.z, d.y)
            }
        };
        let local = self.stretch.map_or(local, |[stretch, _]| stretch * local);
        CameraRay {
            lens: self.lens(),
            origin: self.pose.origin,
            direction: self.pose.to_world(local).normalize(),
        }
    }

    /// Converts a direction from the world to camera space. Returns it with dω_camera/dω_world = |det S⁻¹| / |S⁻¹ω|³.
    #[inline]
    fn in_camera(&self, w: Vec3) -> (Vec3, f32) {
        let local = self.pose.to_local(w);
        let Some([_, inverse]) = &self.stretch else {
            return (local, 1.0);
        };
        let stretched = *inverse * local;
        let length = stretched.length();
        (stretched / length, 1.0 / (length * length * length))
    }

    #[inline]
    pub(super) fn raster(&self, w: Vec3) -> Vec2 {
        let (local, _) = self.in_camera(w);
        let p = match self.mapping {
            SphericalMapping::Equirectangular => {
                let turn = libm::atan2f(local.z, local.x) / (2.0 * PI);
                let around = if turn < 0.0 { turn + 1.0 } else { turn };
                let across = libm::hypotf(local.x, local.z);
                Vec2::new(around, libm::atan2f(across, local.y) / PI)
            }
            SphericalMapping::EqualArea => {
                direction_to_square(Vec3::new(local.x, local.z, local.y))
            }
        };
        p * self.resolution
    }

    #[inline]
    pub(super) fn depth(&self, p: Vec3) -> f32 {
        p.distance(self.pose.origin)
    }

    /// Returns the width of a pixel at a point. It is that at the horizon, where pixels are widest.
    #[inline]
    pub(super) fn pixel_width(&self, p: Vec3) -> f32 {
        let area = self.resolution.x * self.resolution.y;
        let solid_angle = match self.mapping {
            SphericalMapping::Equirectangular => 2.0 * PI * PI / area,
            SphericalMapping::EqualArea => 4.0 * PI / area,
        };
        self.depth(p) * solid_angle.sqrt()
    }

    /// Returns dx/dω.
    #[inline]
    pub(super) fn density(&self, w: Vec3) -> f32 {
        let area = self.resolution.x * self.resolution.y;
        let (local, change) = self.in_camera(w);
        let density = match self.mapping {
            SphericalMapping::Equirectangular => {
                let sin = libm::hypotf(local.x, local.z);
                // At the pole itself a whole row of pixels sees one direction.
                area / (2.0 * PI * PI * sin.max(1e-6))
            }
            SphericalMapping::EqualArea => area / (4.0 * PI),
        };
        density * change
    }
}

//! W_e = dx/dA · δ(ω - forward): parallel rays that start on a plane. Densities are raster area per
//! area of the plane, 1/m²; the direction is a Dirac distribution, whose coefficient counts 1.
//!
//! On a path, such a camera is like a distant light at the other end: a vertex at infinity. Its "point" is the
//! direction towards it, and the density of the next vertex is raster area per area of a surface, dx/dA |cosθ|.

use super::pose::Pose;
use super::{CameraRay, LensSample};
use crate::locus::Locus;
use crate::math::{Affine3A, Vec2, Vec3, Vec3A};

/// The settings of an [`Orthographic`] camera.
#[derive(Clone, Copy, Debug)]
pub struct OrthographicSettings {
    /// The camera's place: x right, y up, z forward. Any map that is not flat: the screen of a stretched
    /// camera is stretched, and stands across its axis z.
    pub world_from_camera: Affine3A,
    /// The film's width and height. Unit: pixels.
    pub resolution: Vec2,
    /// Top left and bottom right corner of the film on the plane z = 0 of camera space.
    pub screen: [Vec2; 2],
}

/// Parallel rays from a plane. Surfaces behind the plane are not seen.
#[derive(Clone, Copy, Debug)]
pub struct Orthographic {
    pub(super) pose: Pose,
    /// Position on the plane = `screen_origin` + raster · `screen_per_raster` + (raster.y · `skew`, 0), in the unit
    /// of the world.
    screen_origin: Vec2,
    screen_per_raster: Vec2,
    skew: f32,
    /// Raster area per area of the plane.
    raster_density: f32,
}

impl Orthographic {
    /// Makes the camera. None: its map is flat, or the screen has no area.
    pub fn new(settings: &OrthographicSettings) -> Option<Self> {
        let (pose, stretch) = Pose::new(&across(&settings.world_from_camera))?;
        let screen = settings.screen.map(|corner| corner * stretch.unit);
        let per_raster = (screen[1] - screen[0]) / settings.resolution;
        let [right, down] = [Vec2::X, Vec2::Y].map(|axis| stretch.vector(axis * per_raster));
        let screen_per_raster = Vec2::new(right.x, down.y);
        let raster_density = 1.0 / (screen_per_raster.x * screen_per_raster.y).abs();
        raster_density.is_finite().then_some(Self {
            pose,
            screen_origin: stretch.vector(screen[0]),
            screen_per_raster,
            skew: down.x,
            raster_density,
        })
    }

    pub(super) fn resized(self, factor: Vec2) -> Self {
        Self {
            screen_per_raster: self.screen_per_raster / factor,
            skew: self.skew / factor.y,
            raster_density: self.raster_density * factor.x * factor.y,
            ..self
        }
    }

    #[inline]
    pub(super) fn lens(&self) -> LensSample {
        LensSample {
            locus: Locus::at_infinity(-self.pose.forward),
            pdf: 1.0,
        }
    }

    #[inline]
    pub(super) fn sample_ray(&self, raster: Vec2) -> CameraRay {
        let along_x = raster.y * self.skew;
        let screen = self.screen_origin + raster * self.screen_per_raster + Vec2::X * along_x;
        CameraRay {
            lens: self.lens(),
            origin: self.pose.origin + self.pose.right * screen.x + self.pose.up * screen.y,
            direction: self.pose.forward,
        }
    }

    /// Returns the raster position that sees the point `p`. None: it is behind the plane.
    #[inline]
    pub(super) fn raster(&self, p: Vec3) -> Option<Vec2> {
        let local = self.pose.to_local(p - self.pose.origin);
        let screen = local.truncate() - self.screen_origin;
        let y = screen.y / self.screen_per_raster.y;
        let raster = Vec2::new((screen.x - self.skew * y) / self.screen_per_raster.x, y);
        (local.z > 0.0).then_some(raster)
    }

    #[inline]
    pub(super) fn depth(&self, p: Vec3) -> f32 {
        self.pose.forward.dot(p - self.pose.origin)
    }

    /// Returns the width of a pixel, the same everywhere.
    #[inline]
    pub(super) fn pixel_width(&self) -> f32 {
        1.0 / self.raster_density.sqrt()
    }

    /// Returns dx/dA along the axis, the one direction there is.
    #[inline]
    pub(super) fn density(&self, w: Vec3) -> f32 {
        if self.pose.forward.dot(w) > 0.0 {
            self.raster_density
        } else {
            0.0
        }
    }
}

/// Returns the map of a camera whose axes x and y are as its axis z sees them: across it, if they are not already.
fn across(world_from_camera: &Affine3A) -> Affine3A {
    let m = world_from_camera.matrix3;
    let is_square =
        |axis: Vec3A| axis.dot(m.z_axis).abs() <= 1e-3 * axis.length() * m.z_axis.length();
    let seen = |axis: Vec3A| match m.z_axis.try_normalize() {
        Some(z) if !is_square(axis) => axis.reject_from_normalized(z),
        _ => axis,
    };
    let translation = world_from_camera.translation;
    Affine3A::from_cols(seen(m.x_axis), seen(m.y_axis), m.z_axis, translation)
}

//! dx/dω = 1 / (A_pixel cos³θ), W_e = dx/dω / (A_lens cosθ): a pinhole or a thin lens, A_pixel
//! being a pixel's area on the plane one unit in front. Densities are raster area per solid angle,
//! 1/sr.
//!
//! The lens is round and ideal: no distortion and no aberration.

use super::pose::{Pose, Stretch};
use super::{CameraRay, LensSample};
use crate::locus::Locus;
use crate::math::{Affine3A, PI, Vec2, Vec3, sqr, warp};

/// The settings of a [`Perspective`] camera.
#[derive(Clone, Copy, Debug)]
pub struct PerspectiveSettings {
    /// The camera's place: x right, y up, z forward. Any map that is not flat: of a stretched camera, the
    /// screen and the lens are stretched, and the lens stands in the plane of its axes x and y.
    pub world_from_camera: Affine3A,
    /// The film's width and height. Unit: pixels.
    pub resolution: Vec2,
    /// Top left and bottom right corner of the film on the plane z = 1 of camera space.
    pub screen: [Vec2; 2],
    /// Radius of the lens in camera space; 0 is a pinhole.
    pub lens_radius: f32,
    /// Distance of the plane in focus, along the axis, in camera space.
    pub focal_distance: f32,
}

/// A pinhole or thin lens in front of a plane.
#[derive(Clone, Copy, Debug)]
pub struct Perspective {
    pub(super) pose: Pose,
    /// Screen position = `screen_origin` + raster · `screen_per_raster` + (raster.y · `skew`, 0).
    screen_origin: Vec2,
    screen_per_raster: Vec2,
    skew: f32,
    /// Raster area per area of the plane z = 1.
    raster_density: f32,
    lens_radius: f32,
    focal_distance: f32,
    stretch: Stretch,
}

impl Perspective {
    /// Makes the camera. None: its map is flat, or a size is not finite and positive where it must be.
    pub fn new(settings: &PerspectiveSettings) -> Option<Self> {
        let (pose, stretch) = Pose::new(&settings.world_from_camera)?;
        let per_raster = (settings.screen[1] - settings.screen[0]) / settings.resolution;
        let [right, down] = [Vec2::X, Vec2::Y].map(|axis| stretch.vector(axis * per_raster));
        let screen_per_raster = Vec2::new(right.x, down.y);
        let raster_density = 1.0 / (screen_per_raster.x * screen_per_raster.y).abs();
        let finite = raster_density.is_finite()
            && settings.lens_radius >= 0.0
            && settings.focal_distance > 0.0;
        finite.then(|| Self {
            pose,
            screen_origin: stretch.on_plane(settings.screen[0]),
            screen_per_raster,
            skew: down.x,
            raster_density,
            lens_radius: settings.lens_radius * stretch.unit,
            focal_distance: settings.focal_distance * stretch.unit,
            stretch,
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
    pub(super) fn sample_lens(&self, u: impl FnOnce() -> Vec2) -> LensSample {
        let offset = if self.lens_radius > 0.0 {
            let disk = warp::concentric_disk(u()) * self.lens_radius;
            self.stretch.vector(disk)
        } else {
            Vec2::ZERO
        };
        let point = self.pose.origin + self.pose.right * offset.x + self.pose.up * offset.y;
        LensSample {
            locus: Locus::on_surface(point, self.pose.forward, 0.0),
            pdf: 1.0 / self.lens_area(),
        }
    }

    /// Returns the area of the lens; 1 for a pinhole, whose Dirac distribution cancels.
    #[inline]
    fn lens_area(&self) -> f32 {
        if self.lens_radius > 0.0 {
            PI * sqr(self.lens_radius) * self.stretch.area()
        } else {
            1.0
        }
    }

    #[inline]
    pub(super) fn sample_ray(&self, raster: Vec2, u: impl FnOnce() -> Vec2) -> CameraRay {
        let lens = self.sample_lens(u);
        let along_x = raster.y * self.skew;
        let screen = self.screen_origin + raster * self.screen_per_raster + Vec2::X * along_x;
        let through_centre = self.pose.to_world(screen.extend(1.0));
        // All rays of a raster position meet in the plane of focus; a pinhole needs no plane.
        let direction = if self.lens_radius > 0.0 {
            self.pose.origin + through_centre * self.focal_distance - lens.locus.point
        } else {
            through_centre
        };
        CameraRay {
            lens,
            origin: lens.locus.point,
            direction: direction.normalize(),
        }
    }

    #[inline]
    pub(super) fn raster(&self, p: Vec3, w: Vec3) -> Option<Vec2> {
        let local = self.pose.to_local(w);
        if local.z <= 0.0 {
            return None;
        }
        let direction = local.truncate() / local.z;
        let lens = self.pose.to_local(p - self.pose.origin).truncate();
        let screen = direction + lens / self.focal_distance - self.screen_origin;
        let y = screen.y / self.screen_per_raster.y;
        Some(Vec2::new(
            (screen.x - self.skew * y) / self.screen_per_raster.x,
            y,
        ))
    }

    #[inline]
    pub(super) fn depth(&self, p: Vec3) -> f32 {
        self.pose.forward.dot(p - self.pose.origin)
    }

    /// Returns dx/dω = raster density / cos³θ: the plane z = 1 seen at an angle.
    #[inline]
    pub(super) fn pdf_direction(&self, w: Vec3) -> f32 {
        let cos = self.pose.forward.dot(w);
        if cos <= 0.0 {
            0.0
        } else {
            self.raster_density / (cos * cos * cos)
        }
    }

    /// Returns distance times the width of a pixel in the middle of the view, one unit in front.
    #[inline]
    pub(super) fn pixel_width(&self, p: Vec3) -> f32 {
        p.distance(self.pose.origin) / self.raster_density.sqrt()
    }

    #[inline]
    pub(super) fn importance(&self, w: Vec3) -> f32 {
        let cos = self.pose.forward.dot(w);
        if cos <= 0.0 {
            0.0
        } else {
            self.pdf_direction(w) / (cos * self.lens_area())
        }
    }
}

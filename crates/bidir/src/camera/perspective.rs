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

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(lens_radius: f32) -> Perspective {
        let eye = Vec3::new(1.0, 2.0, 3.0);
        Perspective::new(&PerspectiveSettings {
            world_from_camera: Affine3A::from_cols(
                Vec3::new(0.0, 0.0, -2.0).into(),
                Vec3::new(0.0, 2.0, 0.0).into(),
                Vec3::new(2.0, 0.0, 0.0).into(),
                eye.into(),
            ),
            resolution: Vec2::new(40.0, 30.0),
            screen: [Vec2::new(-0.8, 0.6), Vec2::new(0.8, -0.6)],
            lens_radius,
            focal_distance: 4.0,
        })
        .unwrap()
    }

    #[test]
    fn raster_to_ray_to_raster() {
        for lens_radius in [0.0, 0.25] {
            let camera = camera(lens_radius);
            for raster in [
                Vec2::new(0.0, 0.0),
                Vec2::new(39.5, 3.25),
                Vec2::new(20.0, 15.0),
            ] {
                let ray = camera.sample_ray(raster, || Vec2::new(0.3, 0.8));
                let back = camera.raster(ray.lens.locus.point, ray.direction).unwrap();
                assert!(
                    (back - raster).length() < 1e-3,
                    "{back} instead of {raster}"
                );
            }
        }
    }

    #[test]
    fn the_density_is_the_jacobian_of_raster_positions() {
        let camera = camera(0.0);
        let at = |x: f32, y: f32| {
            camera
                .sample_ray(Vec2::new(x, y), || Vec2::splat(0.5))
                .direction
        };
        let (x, y, h) = (33.0, 7.0, 0.5);
        let (dx, dy) = (at(x + h, y) - at(x - h, y), at(x, y + h) - at(x, y - h));
        let solid_angle_per_pixel = dx.cross(dy).length();
        let density = camera.pdf_direction(at(x, y));
        assert!((solid_angle_per_pixel * density - 1.0).abs() < 1e-3);
    }

    #[test]
    fn nothing_leaves_backwards_and_flat_cameras_are_refused() {
        let camera = camera(0.0);
        assert!(camera.raster(Vec3::ZERO, -Vec3::X).is_none());
        assert!(camera.importance(-Vec3::X) == 0.0 && camera.pdf_direction(-Vec3::X) == 0.0);
        let flat = Affine3A::from_cols(
            Vec3::X.into(),
            Vec3::new(0.5, 0.0, 1.0).into(),
            Vec3::Z.into(),
            Vec3::ZERO.into(),
        );
        let settings = PerspectiveSettings {
            world_from_camera: flat,
            resolution: Vec2::splat(8.0),
            screen: [Vec2::new(-1.0, 1.0), Vec2::new(1.0, -1.0)],
            lens_radius: 0.0,
            focal_distance: 1.0,
        };
        assert!(Perspective::new(&settings).is_none());
    }
}

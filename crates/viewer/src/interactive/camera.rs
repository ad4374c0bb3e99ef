//! The camera that clients move. While it moves, the film has a quarter of the pixels per side.

use crate::command::Walk;
use crate::status::CameraStatus;
use bidir::camera::{Camera, Pose, Rotation};
use bidir::film::{FilmSettings, PixelRect};
use bidir::math::{Vec2, Vec3};
use bidir::sampler::{Domain, Sampler, SamplerKind};
use bidir::scene::{RayDraws, RenderSpace, Scene};
use bidir::view::{EmptyCrop, View};
use std::time::{Duration, Instant};

/// The time without a move after which the camera counts as still.
const REST: Duration = Duration::from_millis(500);
/// The factor by which each side of the film has fewer pixels while the camera moves.
const COARSENESS: u32 = 4;
/// The smallest and the largest distance of the camera from its target. Unit: the scene's radius.
const REACH: [f32; 2] = [1e-4, 1e3];

/// The camera and film of a scene, as clients move the camera.
#[derive(Debug)]
pub(super) struct CameraControl {
    space: RenderSpace,
    /// The scene's own view.
    home: View,
    camera: Camera,
    /// The point in the middle of the scene's own picture, in the axes of the camera.
    home_target: Vec3,
    /// The point that the camera moves around, in the axes of the camera.
    target: Vec3,
    /// The upward direction in the world.
    vertical: Vec3,
    /// The radius of the scene.
    radius: f32,
    /// The time of the last move. None: the camera is still.
    moved: Option<Instant>,
}

/// The reason why the camera cannot move as commanded.
pub(super) type Refusal = String;

impl CameraControl {
    /// Returns the control of a camera at the scene's own view.
    pub(super) fn new(scene: &Scene, home: View) -> Self {
        let camera = *home.camera();
        let target = target(scene, &home);
        Self {
            space: *scene.space(),
            home,
            camera,
            home_target: target,
            target,
            vertical: camera.pose().vertical(),
            radius: scene.light_context().radius,
            moved: None,
        }
    }

    /// Returns true while the camera moves.
    pub(super) fn is_preview(&self) -> bool {
        self.moved.is_some()
    }

    /// Returns true once, at the first call after the camera has become still.
    pub(super) fn settle(&mut self) -> bool {
        self.rest() == Some(Duration::ZERO) && self.moved.take().is_some()
    }

    /// Returns the time without a move until the camera counts as still. None: it is still.
    pub(super) fn rest(&self) -> Option<Duration> {
        let moved = self.moved?;
        Some(REST.saturating_sub(moved.elapsed()))
    }

    /// Returns the view to render now.
    pub(super) fn current(&self) -> Result<View, EmptyCrop> {
        let film = self.home.film();
        if !self.is_preview() {
            return self.home.moved(self.camera, film.clone());
        }
        let coarse = coarse(film);
        let [new, old] = [coarse.resolution, film.resolution]
            .map(|[width, height]| Vec2::new(width as f32, height as f32));
        self.home.moved(self.camera.resized(new / old), coarse)
    }

    /// Returns the status of the camera.
    pub(super) fn status(&self) -> CameraStatus {
        let pose = self.camera.pose();
        CameraStatus {
            kind: self.camera.kind(),
            origin: self.in_world(pose.origin),
            target: self.in_world(self.world_target(pose)),
            up: pose.up.to_array(),
            moved: self.is_elsewhere(),
        }
    }

    /// Maps a point from the render space to the coordinates of the scene file.
    fn in_world(&self, point: Vec3) -> [f32; 3] {
        self.space.world_point(point).as_vec3().to_array()
    }

    fn is_elsewhere(&self) -> bool {
        self.camera.pose() != self.home.camera().pose()
    }

    /// Returns a text that identifies the view. None: it is the scene's own view.
    pub(super) fn text(&self) -> Option<String> {
        let pose = self.camera.pose();
        let [origin, forward, up] = [pose.origin, pose.forward, pose.up].map(|v| v.to_array());
        let text = || format!("origin {origin:?} forward {forward:?} up {up:?}");
        self.is_elsewhere().then(text)
    }

    /// Moves the camera back to the scene's own view, at full resolution at once.
    pub(super) fn go_home(&mut self) {
        self.camera = *self.home.camera();
        self.target = self.home_target;
        self.moved = None;
    }

    /// Moves the camera around the target. Unit: radians.
    pub(super) fn orbit(&mut self, yaw: f32, pitch: f32) -> Result<(), Refusal> {
        self.check_is_flat("orbit")?;
        let pose = self.camera.pose();
        // A camera that moves right around its target turns left.
        let turn = Rotation {
            right: -yaw,
            up: -pitch,
        };
        self.go(
            pose.turned(self.world_target(pose), self.vertical, turn),
            self.target,
        )
    }

    /// Moves the camera to `factor` times its distance from the target.
    pub(super) fn dolly(&mut self, factor: f32) -> Result<(), Refusal> {
        self.check_is_flat("dolly")?;
        if self.camera.is_parallel() {
            return Err(
                "parallel rays show the same from any distance: `pan` moves them".to_owned(),
            );
        }
        if !(factor > 0.0 && factor.is_finite()) {
            return Err("the factor of `dolly` is a positive number".to_owned());
        }
        let distance = self.distance();
        let [nearest, farthest] = REACH.map(|reach| reach * self.radius);
        let factor = (distance * factor).clamp(nearest, farthest) / distance;
        let pose = self.camera.pose();
        let back = (pose.origin - self.world_target(pose)) * (factor - 1.0);
        self.go(pose.shifted(back), self.target * factor)
    }

    /// Moves the camera and the target across the view. Unit: the distance between them.
    pub(super) fn pan(&mut self, right: f32, up: f32) -> Result<(), Refusal> {
        self.check_is_flat("pan")?;
        self.walk(Walk {
            right,
            up,
            ..Walk::default()
        })
    }

    /// Moves and turns the camera, together with the target.
    pub(super) fn walk(&mut self, walk: Walk) -> Result<(), Refusal> {
        let (pose, unit) = (self.camera.pose(), self.distance());
        let step = pose.right * walk.right + pose.up * walk.up + pose.forward * walk.forward;
        let turn = Rotation {
            right: walk.yaw,
            up: walk.pitch,
        };
        let pose = pose.shifted(step * unit);
        self.go(pose.turned(pose.origin, self.vertical, turn), self.target)
    }

    fn go(&mut self, pose: Pose, target: Vec3) -> Result<(), Refusal> {
        let numbers = [pose.origin, pose.right, pose.up, pose.forward, target];
        if !numbers.iter().all(|vector| vector.is_finite()) {
            return Err("the camera cannot go there".to_owned());
        }
        self.camera = self.camera.with_pose(pose);
        self.target = target;
        self.moved = Some(Instant::now());
        Ok(())
    }

    /// Refuses a command that has no meaning for a picture of all directions.
    fn check_is_flat(&self, command: &str) -> Result<(), Refusal> {
        match self.camera {
            Camera::Spherical(_) => Err(format!(
                "`{command}` does not apply to a spherical camera: `walk` moves it"
            )),
            Camera::Perspective(_) | Camera::Orthographic(_) => Ok(()),
        }
    }

    fn world_target(&self, pose: Pose) -> Vec3 {
        pose.origin + pose.to_world(self.target)
    }

    fn distance(&self) -> f32 {
        self.target.length()
    }
}

/// Returns the point that is visible in the middle of the picture, in the axes of the camera. If nothing is visible
/// there, returns a point as far away as the middle of the scene.
fn target(scene: &Scene, view: &View) -> Vec3 {
    let (camera, film) = (view.camera(), view.film());
    let pose = camera.pose();
    let [width, height] = film.resolution.map(|side| side as f32);
    let (origin, direction) = match camera {
        Camera::Spherical(_) => (pose.origin, pose.forward),
        Camera::Perspective(_) | Camera::Orthographic(_) => {
            let middle = Vec2::new(width, height) / 2.0;
            let ray = camera.sample_ray(middle, || Vec2::splat(0.5));
            (ray.origin, ray.direction)
        }
    };
    let numbers = Sampler::new(SamplerKind::default(), 0).stream(Domain::Camera, 0, 0);
    let hit = scene.intersect(origin, direction, RayDraws::new(&numbers, 0));
    let whole = scene.light_context();
    let far = origin.distance(whole.centre).max(REACH[0] * whole.radius);
    let point = hit.map_or(origin + direction * far, |hit| hit.surface.point);
    pose.to_local(point - pose.origin)
}

/// Returns a film whose sides have 1 / [`COARSENESS`] of the pixels of `film`.
fn coarse(film: &FilmSettings) -> FilmSettings {
    let PixelRect { min, max } = film.crop;
    FilmSettings {
        resolution: film.resolution.map(|side| side.div_ceil(COARSENESS)),
        crop: PixelRect {
            min: min.map(|edge| edge / COARSENESS),
            max: max.map(|edge| edge.div_ceil(COARSENESS)),
        },
        ..film.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bidir::camera::{Orthographic, OrthographicSettings, Spherical, SphericalMapping};
    use bidir::film::Filter;
    use bidir::light::{InfiniteLight, Light};
    use bidir::math::{Affine3A, DVec3};
    use bidir::scene::SceneBuilder;

    const SIDE: f32 = 30.0;

    fn film() -> FilmSettings {
        FilmSettings::new([SIDE as u32; 2], Filter::default())
    }

    /// Returns the view of nothing but a sky.
    fn view(camera: Camera) -> CameraControl {
        view_in(RenderSpace::WORLD, camera)
    }

    fn view_in(space: RenderSpace, camera: Camera) -> CameraControl {
        let mut builder = SceneBuilder::new();
        builder.space(space);
        builder.light(Light::Infinite(InfiniteLight::constant([1.0; 3])));
        let view = View::new(camera, film()).unwrap();
        CameraControl::new(&builder.build().unwrap(), view)
    }

    #[test]
    fn a_camera_that_sees_all_around_can_only_walk() {
        let (place, size) = (Affine3A::IDENTITY, Vec2::splat(SIDE));
        let camera = Spherical::new(&place, size, SphericalMapping::EqualArea).unwrap();
        let mut view = view(Camera::Spherical(camera));
        assert!(view.orbit(0.1, 0.0).is_err() && view.dolly(2.0).is_err());
        assert!(view.pan(0.1, 0.0).is_err() && !view.is_preview());
        let walk = Walk {
            forward: 1.0,
            ..Walk::default()
        };
        view.walk(walk).unwrap();
        assert!(view.is_preview() && view.status().moved && view.text().is_some());
    }

    #[test]
    fn parallel_rays_are_not_moved_along_themselves() {
        let settings = OrthographicSettings {
            world_from_camera: Affine3A::IDENTITY,
            resolution: Vec2::splat(SIDE),
            screen: [Vec2::new(-1.0, 1.0), Vec2::new(1.0, -1.0)],
        };
        let camera = Orthographic::new(&settings).unwrap();
        let mut view = view(Camera::Orthographic(camera));
        assert!(view.dolly(2.0).is_err());
        view.orbit(0.1, 0.2).unwrap();
        view.pan(0.3, 0.0).unwrap();
        assert!(view.status().moved);
        view.go_home();
        assert!(!view.status().moved && view.text().is_none());
    }

    #[test]
    fn the_camera_is_reported_where_it_is_in_the_world() {
        let camera = |pose: Affine3A| {
            let size = Vec2::splat(SIDE);
            Spherical::new(&pose, size, SphericalMapping::EqualArea).unwrap()
        };
        let space = RenderSpace {
            origin: DVec3::new(1e6, 0.0, 0.0),
            unit: 4.0,
        };
        let pose = Affine3A::from_translation(Vec3::new(1.0, 2.0, 3.0));
        let status = view_in(space, Camera::Spherical(camera(pose))).status();
        let moved = [1e6 + 4.0, 8.0, 12.0];
        assert_eq!(status.origin.map(f32::to_bits), moved.map(f32::to_bits));
        assert!(status.target[2] > 12.0, "{:?}", status.target);
    }

    #[test]
    fn a_coarse_film_has_all_of_the_crop() {
        let film = FilmSettings {
            crop: PixelRect {
                min: [5, 0],
                max: [6, 30],
            },
            ..film()
        };
        let coarse = coarse(&film);
        assert_eq!(coarse.resolution, [8, 8]);
        assert_eq!((coarse.crop.min, coarse.crop.max), ([1, 0], [2, 8]));
    }
}

//! Examines a scene after reading, to find out whether its default camera and light suffice.
//!
//! **Camera.** A closed room is black from outside. If the file has lights but no camera, [`better`] searches for
//! a viewpoint inside. From it almost all rays hit a surface, and most of them its front; or else a lamp is inside, and
//! the scene is dark from outside. Of all such viewpoints and directions, it takes those with the farthest view.
//!
//! **Light.** Surfaces that emit suffice as light if at least half of all visible points are brighter than [`DARK`] in
//! a small picture: a lamp does, glowing eyes do not.

use super::view::looking;
use crate::import::Loaded;
use bidir::driver::{Resources, Session, Settings};
use bidir::film::FilmSettings;
use bidir::integrator::IntegratorKind;
use bidir::light::Light;
use bidir::locus::Locus;
use bidir::math::{Affine3A, Vec2, Vec3};
use bidir::sampler::{Domain, SampleStream, Sampler, SamplerKind};
use bidir::scene::{RayDraws, Scene};
use bidir::spectrum::luminance;
use bidir::view::View;
use glam::{DAffine3, DVec3};

/// The reader's choices for a file without a camera, or without sufficient light.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Outlook {
    /// The viewpoint inside a closed scene. None: the camera sees all from outside.
    pub(super) inside: Option<Place>,
    /// True to add a light although surfaces emit.
    pub(super) is_dark: bool,
}

/// A viewpoint and its direction. Space: world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    eye: DVec3,
    ahead: DVec3,
}

impl Place {
    /// Returns the frame of a camera at this viewpoint, in the render space.
    pub(super) fn camera(&self, render_from_world: &DAffine3) -> Affine3A {
        let eye = render_from_world.transform_point3(self.eye);
        looking(eye, self.ahead, DVec3::Y)
    }
}

/// The defaults that a file needed when it was read.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Needs {
    /// True if the file has no camera.
    pub(super) camera: bool,
    /// True if its only lights are surfaces that emit.
    pub(super) light: bool,
    /// True if the file has any light.
    pub(super) has_own_light: bool,
}

/// Luminance below which a pixel looks black on a screen.
const DARK: f32 = 0.001;

/// Returns better defaults than those that the scene was read with. None: these suffice.
pub(super) fn better(loaded: &Loaded, needs: Needs) -> Option<Outlook> {
    let (scene, view) = (&loaded.scene, &loaded.view);
    let may_be_room = needs.camera && needs.has_own_light;
    let search = || place_inside(scene, || is_dark(scene, view));
    let inside = may_be_room.then(search).flatten();
    // Light from outside does not come into a room: there, only what the camera will see counts.
    let is_dark = inside.is_none() && needs.light && is_dark(scene, view);
    (inside.is_some() || is_dark).then_some(Outlook { inside, is_dark })
}

/// Width and height of the small picture. Unit: pixels.
const SIZE: [u32; 2] = [32, 24];
const PASSES: u64 = 8;
/// Maximum number of scattering events of its paths: enough for a lamp behind several panes.
const DEPTH: u32 = 32;

/// Returns true if less than half of the visible points are lit.
fn is_dark(scene: &Scene, view: &View) -> bool {
    let film = view.film();
    let size = Vec2::from(SIZE.map(|side| side as f32));
    let factor = size / Vec2::from(film.resolution.map(|side| side as f32));
    let camera = view.camera().resized(factor);
    let small_film = FilmSettings::new(SIZE, film.filter.clone());
    let Ok(small) = View::new(camera, small_film) else {
        return false;
    };
    let mut settings = Settings::new(IntegratorKind::Bdpt);
    settings.path.max_depth = Some(DEPTH);
    let Ok(mut session) = Session::new(scene, &small, settings, &Resources::default()) else {
        return false;
    };
    while session.next_pass() < PASSES {
        session.step(&());
    }
    let picture = session.film().develop();
    let rays = Rays::new(scene);
    let is_surface = |i: usize| {
        let at = Vec2::new((i % SIZE[0] as usize) as f32, (i / SIZE[0] as usize) as f32) + 0.5;
        let ray = camera.sample_ray(at, || Vec2::splat(0.5));
        rays.hit(ray.origin, ray.direction).is_some()
    };
    let seen = picture
        .pixels
        .iter()
        .enumerate()
        .filter(|(i, _)| is_surface(*i));
    let (mut all, mut lit) = (0, 0);
    for (_, pixel) in seen {
        all += 1;
        lit += u32::from(luminance(*pixel) >= DARK);
    }
    2 * lit < all
}

/// Rays that look at a scene.
struct Rays<'a> {
    scene: &'a Scene,
    stream: SampleStream,
}

/// A surface that a ray sees.
struct Seen {
    distance: f32,
    is_front: bool,
    is_lamp: bool,
}

impl<'a> Rays<'a> {
    fn new(scene: &'a Scene) -> Self {
        let sampler = Sampler::new(SamplerKind::Independent, 0);
        let stream = sampler.stream(Domain::Camera, 0, 0);
        Self { scene, stream }
    }

    fn hit(&self, origin: Vec3, direction: Vec3) -> Option<Seen> {
        let chances = RayDraws::new(&self.stream, 1);
        let hit = self.scene.intersect(origin, direction, chances)?;
        let is_front = hit.surface.n_g.dot(direction) < 0.0;
        Some(Seen {
            distance: hit.surface.point.distance(origin),
            is_front,
            is_lamp: is_front && hit.light.is_some(),
        })
    }
}

/// Number of viewpoints along each side of the grid.
const PLACES: usize = 7;
/// The heights of viewpoints, relative to the scene's.
const HEIGHTS: [f32; 3] = [0.5, 0.3, 0.7];
/// Number of directions around a viewpoint.
const DIRECTIONS: usize = 96;
/// The part of all rays that may leave through gaps.
const GAPS: f64 = 0.02;

/// Searches for a viewpoint inside a closed scene. None: there is none, or the scene is a solid that is lit from
/// outside.
fn place_inside(scene: &Scene, is_dark_outside: impl FnOnce() -> bool) -> Option<Place> {
    let bounds = bounds(scene)?;
    let rays = Rays::new(scene);
    let mut best: Option<(f32, bool, Vec3, Vec3)> = None;
    for i in 0..PLACES * PLACES * HEIGHTS.len() {
        let part = |k: usize| (k as f32 + 0.5) / PLACES as f32;
        let at = Vec3::new(
            part(i % PLACES),
            HEIGHTS[i / (PLACES * PLACES)],
            part(i / PLACES % PLACES),
        );
        let eye = bounds[0] + (bounds[1] - bounds[0]) * at;
        let Some(is_room) = closed_around(&rays, eye) else {
            continue;
        };
        let (reach, ahead) = farthest(&rays, eye);
        if best.is_none_or(|(known, known_room, ..)| (is_room, reach) > (known_room, known)) {
            best = Some((reach, is_room, eye, ahead));
        }
    }
    let (_, is_room, eye, ahead) = best?;
    let world = |p: Vec3| scene.space().world_point(p);
    (is_room || is_dark_outside()).then(|| Place {
        eye: world(eye),
        ahead: ahead.as_dvec3(),
    })
}

/// Returns the lowest and highest corner of the scene's bounding box. None: the box is empty or flat.
fn bounds(scene: &Scene) -> Option<[Vec3; 2]> {
    let bounds = scene.bvh().bounds();
    let [low, high] = [bounds.min, bounds.max];
    (low.is_finite() && high.is_finite() && (high - low).min_element() > 0.0).then_some([low, high])
}

/// Returns true if the rays from `eye` hit mostly fronts, false if mostly backs although a lamp is visible. None: too
/// many rays escape, or `eye` is inside a solid.
fn closed_around(rays: &Rays<'_>, eye: Vec3) -> Option<bool> {
    let seen = (0..DIRECTIONS).filter_map(|i| rays.hit(eye, around(i)));
    let (mut hits, mut fronts, mut has_lamp) = (0, 0, false);
    for surface in seen {
        hits += 1;
        fronts += usize::from(surface.is_front);
        has_lamp |= surface.is_lamp;
    }
    let is_closed = hits as f64 >= (1.0 - GAPS) * DIRECTIONS as f64;
    let is_room = 2 * fronts > hits;
    (is_closed && (is_room || has_lamp || sees_point_light(rays.scene, eye))).then_some(is_room)
}

fn sees_point_light(scene: &Scene, eye: Vec3) -> bool {
    let is_seen = |position| {
        let ends = [eye, position].map(Locus::in_space);
        scene.transmittance(&ends[0], &ends[1]) > 0.0
    };
    scene.lights().iter().any(|light| match light {
        Light::Point(light) => is_seen(light.position),
        Light::Spot(light) => is_seen(light.position),
        _ => false,
    })
}

/// Returns direction `i` of [`DIRECTIONS`] evenly distributed ones, on a spiral.
fn around(i: usize) -> Vec3 {
    let y = 1.0 - 2.0 * (i as f32 + 0.5) / DIRECTIONS as f32;
    let golden = bidir::math::PI * (3.0 - 5.0_f32.sqrt());
    let (sin, cos) = bidir::math::sin_cos(golden * i as f32);
    let across = (1.0 - y * y).max(0.0).sqrt();
    Vec3::new(across * cos, y, across * sin)
}

/// Returns the largest mean distance of surfaces in a view, and its direction, of several horizontal ones.
fn farthest(rays: &Rays<'_>, eye: Vec3) -> (f32, Vec3) {
    /// Number of horizontal directions.
    const LEVEL: usize = 16;
    let towards = |turn: f32, tilt: f32| {
        let (sin, cos) = bidir::math::sin_cos(turn * 2.0 * bidir::math::PI / LEVEL as f32);
        Vec3::new(cos, tilt, sin).normalize()
    };
    let reach = |turn: usize| {
        let offsets = [-1.5, -0.5, 0.5, 1.5_f32];
        let view = offsets
            .iter()
            .flat_map(|&x| [-0.3, 0.0, 0.3].map(|tilt| (x, tilt)));
        let distances = view.map(|(x, tilt)| {
            let hit = rays.hit(eye, towards(turn as f32 + x, tilt));
            hit.map_or(0.0, |seen| seen.distance)
        });
        distances.sum::<f32>() / 12.0
    };
    let all = (0..LEVEL).map(|turn| (reach(turn), towards(turn as f32, 0.0)));
    all.fold(
        (0.0, Vec3::Z),
        |best, it| if it.0 > best.0 { it } else { best },
    )
}

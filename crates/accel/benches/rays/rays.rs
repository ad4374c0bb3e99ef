//! The rays of a scene: the same for every engine.

use bidir_accel::{Hit, Ray, accept_all};
use glam::Vec3;

use crate::ours::Ours;
use crate::scenes::{Mesh, Random, Scene};

/// Rays of one kind.
pub(crate) struct Batch {
    pub(crate) name: &'static str,
    pub(crate) question: Question,
    pub(crate) rays: Vec<Ray>,
}

/// The question that the rays of a batch ask.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Question {
    Closest,
    Occluded,
    /// The same of many rays at once, where the engine can: in calls of [`TOGETHER`].
    Together,
}

/// Rays of a call: about as many as a batch of samples has.
pub(crate) const TOGETHER: usize = 64;

/// Pixels of a side of the picture.
const SIDE: usize = 256;

/// How far rays stay away from the surfaces where they begin and end, in lengths of the scene and
/// relative to a shadow ray's length.
const OFFSET: f32 = 1e-4;

/// Rays of a camera, rays that bounce diffusely where these hit, and shadow rays from there to lights
/// and to points that other bounces hit, in equal shares; the shadow rays one by one and many at once.
pub(crate) fn batches(scene: &Scene, ours: &Ours) -> [Batch; 4] {
    let mut random = Random(13);
    let primary = primary(scene, &mut random);
    let points: Vec<_> = primary
        .iter()
        .filter_map(|ray| surface(scene, ours, ray))
        .collect();
    let bounce = |[point, normal]: &[Vec3; 2]| {
        let direction = (*normal + 0.999 * random.direction()).normalize();
        from(*point, direction)
    };
    let diffuse: Vec<_> = points.iter().map(bounce).collect();
    let ends: Vec<_> = diffuse
        .iter()
        .filter_map(|ray| surface(scene, ours, ray))
        .collect();
    let shadow = |(i, [point, _]): (usize, &[Vec3; 2])| {
        let end = if i % 2 == 0 {
            scene.lights[i / 2 % scene.lights.len()] + 0.2 * random.cube()
        } else {
            ends[random.below(ends.len())][0]
        };
        Ray {
            t_min: OFFSET,
            t_max: 1.0 - OFFSET,
            ..Ray::new(*point, end - *point)
        }
    };
    let shadow: Vec<_> = points.iter().enumerate().map(shadow).collect();
    let batch = |name, question, rays| Batch {
        name,
        question,
        rays,
    };
    [
        batch("primary", Question::Closest, primary),
        batch("diffuse", Question::Closest, diffuse),
        batch("shadow", Question::Occluded, shadow.clone()),
        batch("shadows", Question::Together, shadow),
    ]
}

fn from(origin: Vec3, direction: Vec3) -> Ray {
    Ray {
        t_min: OFFSET,
        ..Ray::new(origin, direction)
    }
}

fn primary(scene: &Scene, random: &mut Random) -> Vec<Ray> {
    let [eye, target] = scene.view;
    let forward = (target - eye).normalize();
    let right = forward.cross(Vec3::Y).normalize();
    let up = right.cross(forward);
    let pixel = |i: usize| {
        let mut on_film = |i: usize| 2.0 * (i as f32 + random.unit()) / SIDE as f32 - 1.0;
        let (x, y) = (on_film(i % SIDE), on_film(i / SIDE));
        from(eye, (forward + 0.8 * (x * right + y * up)).normalize())
    };
    (0..SIDE * SIDE).map(pixel).collect()
}

/// The point that a ray hits, and the normal on its side.
fn surface(scene: &Scene, ours: &Ours, ray: &Ray) -> Option<[Vec3; 2]> {
    let hit = ours.bvh().closest(ray, accept_all)?;
    let [a, b, c] = world_triangle(scene, &hit);
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let side = if normal.dot(ray.direction) > 0.0 {
        -1.0
    } else {
        1.0
    };
    Some([ray.origin + hit.t * ray.direction, side * normal])
}

fn world_triangle(scene: &Scene, hit: &Hit) -> [Vec3; 3] {
    let face = hit.primitive as usize;
    match (&scene.object, hit.instance.checked_sub(1)) {
        (Some((object, maps)), Some(instance)) => object.triangle(face).map(|p| {
            maps[instance as usize]
                .transform_point3(p.as_dvec3())
                .as_vec3()
        }),
        _ => scene.mesh.triangle(face),
    }
}

/// Rays from inside a closed mesh at its vertices, the middles of its edges and points on them, taken
/// to the world by `to_world`.
pub(crate) fn aimed(mesh: &Mesh, count: usize, to_world: impl Fn(Vec3) -> Vec3) -> Vec<Ray> {
    let mut random = Random(14);
    let ray = |i: usize| {
        let origin = to_world(0.6 * random.unit() * random.direction());
        let [a, b, _] = mesh.triangle(random.below(mesh.faces.len()));
        let at = [0.0, 0.5, random.unit()][i % 3];
        let target = to_world(a + at * (b - a));
        Ray::new(origin, target - origin)
    };
    (0..count).map(ray).collect()
}

//! No ray leaves a closed mesh, wherever it is aimed.

use bidir_accel::Ray;
use glam::{DVec3, Vec3};

use crate::scenes::{Mesh, Random, displace};
use crate::trees::{Trees, build};

const RAYS: usize = 1_000_000;

/// A vertex, or a point on an edge up to the rounding of its coordinates.
fn target(mesh: &Mesh, random: &mut Random) -> Vec3 {
    let face = mesh.faces[random.below(mesh.faces.len())];
    let [a, b] = [0, 1].map(|i| mesh.vertices[face[i]]);
    match random.below(3) {
        0 => a,
        1 => 0.5 * (a + b),
        _ => a
            .as_dvec3()
            .lerp(b.as_dvec3(), f64::from(random.unit()))
            .as_vec3(),
    }
}

/// Rays take turns with trees and questions, but for some that all are asked of.
#[track_caller]
fn check_no_leaks(trees: &Trees, rays: impl Iterator<Item = Ray>) {
    let is_hit = |turn: usize, ray: &Ray| match turn % 64 {
        0 => trees.is_hit(ray),
        _ => trees.is_hit_in_turn(turn, ray),
    };
    let rays = rays.enumerate();
    let mut leaks = rays.filter(|(turn, ray)| !is_hit(*turn, ray));
    let first = leaks.next();
    assert!(
        first.is_none(),
        "{} leaks, such as {first:?}",
        1 + leaks.count()
    );
}

/// Aims from inside at edges and vertices, with directions as subtracted and normalised.
fn aimed_from<'a>(
    mesh: &'a Mesh,
    mut origin: impl FnMut(&mut Random) -> Vec3 + 'a,
    count: usize,
) -> impl Iterator<Item = Ray> + 'a {
    let mut random = Random(7);
    (0..count).map(move |i| {
        let origin = origin(&mut random);
        let direction = target(mesh, &mut random) - origin;
        Ray::new(
            origin,
            if i % 2 == 0 {
                direction
            } else {
                direction.normalize()
            },
        )
    })
}

#[test]
fn sphere_from_inside() {
    let mesh = Mesh::sphere(5);
    let bvh = build(&mesh.primitives());
    check_no_leaks(&bvh, aimed_from(&mesh, |random| 0.9 * random.ball(), RAYS));
}

#[test]
fn displaced_sphere_from_inside() {
    let mesh = Mesh::sphere(5).map(displace);
    let bvh = build(&mesh.primitives());
    check_no_leaks(&bvh, aimed_from(&mesh, |random| 0.5 * random.ball(), RAYS));
}

#[test]
fn far_from_the_origin() {
    for offset in [Vec3::new(1e4, -2e4, 3e4), Vec3::new(1e6, 0.0, -1e6)] {
        let mesh = Mesh::sphere(5).map(|p| displace(p) + offset);
        let bvh = build(&mesh.primitives());
        let rays = aimed_from(&mesh, |random| offset + 0.4 * random.ball(), RAYS / 2);
        check_no_leaks(&bvh, rays);
    }
}

#[test]
fn seen_from_far_away() {
    let mesh = Mesh::sphere(4);
    let bvh = build(&mesh.primitives());
    let mut random = Random(8);
    let rays = std::iter::from_fn(|| {
        let target = target(&mesh, &mut random);
        // From somewhere above the target, so that the line goes through the inside.
        let up = (target.normalize() + 0.5 * random.ball()).normalize();
        let distance = [3.0, 1e2, 1e4][random.below(3)];
        let origin = up.as_dvec3() * distance + DVec3::splat(1e-3);
        Some(Ray::new(
            origin.as_vec3(),
            (target.as_dvec3() - origin).as_vec3(),
        ))
    });
    check_no_leaks(&bvh, rays.take(RAYS / 4));
}

#[test]
fn lines_in_the_planes_of_a_cube() {
    // Small integers everywhere: most lines meet edges and vertices exactly, and run in planes.
    let n = 4;
    let mesh = Mesh::cube(n);
    let bvh = build(&mesh.primitives());
    let mut random = Random(9);
    let mut integer = |limit: i32| random.below(2 * limit as usize + 1) as i32 - limit;
    let mut vector = move |limit: i32| Vec3::from_array([(); 3].map(|()| integer(limit) as f32));
    let rays = std::iter::from_fn(|| Some(Ray::new(vector(n), vector(3))));
    // Also from the surface itself: there `t = 0` counts.
    check_no_leaks(
        &bvh,
        rays.filter(|ray| ray.direction != Vec3::ZERO)
            .take(RAYS / 4),
    );
}

#[test]
fn tiny_and_huge() {
    for scale in [1e-30_f32, 1e-18, 1e-4, 1e4, 1e15, 1e30] {
        let mesh = Mesh::sphere(3).map(|p| displace(p) * scale);
        let bvh = build(&mesh.primitives());
        let rays = aimed_from(&mesh, |random| 0.4 * scale * random.ball(), RAYS / 10);
        // Normalising overflows beyond 1e19; the plain differences stay.
        check_no_leaks(&bvh, rays.step_by(2));
    }
}

#[test]
fn long_thin_triangles() {
    for squeeze in [Vec3::new(1.0, 1.0, 1e-4), Vec3::new(1e3, 1.0, 1e-3)] {
        let mesh = Mesh::sphere(4).map(|p| displace(p) * squeeze);
        let bvh = build(&mesh.primitives());
        let rays = aimed_from(&mesh, |random| 0.4 * random.ball() * squeeze, RAYS / 4);
        check_no_leaks(&bvh, rays);
    }
}

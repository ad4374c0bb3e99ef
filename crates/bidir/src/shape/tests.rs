//! Shapes of every kind, under even, uneven and mirrored maps: how points are drawn, and geometry.

mod directions;
mod geometry;
mod points;

use super::{Cylinder, Disk, Mesh, Orientation, Shape, Sphere};
use crate::math::{Affine3A, DVec3, Mat3, PI, Vec2, Vec3};
use crate::testing::check_variants;

/// Returns a map that stretches unevenly, shears and turns.
fn uneven() -> Affine3A {
    let stretch = Mat3::from_diagonal(Vec3::new(0.5, 2.0, 1.25));
    let shear = Mat3::from_cols(Vec3::X, Vec3::new(0.4, 1.0, 0.0), Vec3::new(0.0, -0.3, 1.0));
    let turn = Mat3::from_rotation_x(0.7) * Mat3::from_rotation_z(-1.1);
    Affine3A::from_mat3_translation(turn * stretch * shear, Vec3::new(3.0, -1.0, 2.0))
}

/// The same, mirrored.
fn mirrored() -> Affine3A {
    uneven() * Affine3A::from_scale(Vec3::new(1.0, 1.0, -1.0))
}

fn moved(centre: Vec3, scale: f32) -> Affine3A {
    Affine3A::from_mat3_translation(Mat3::from_rotation_y(0.4) * scale, centre)
}

fn triangle() -> Mesh {
    let corners = [[1.0, 0.0, 0.0], [3.0, 0.5, -1.0], [0.0, 2.0, 1.0]];
    Mesh {
        positions: corners.map(Vec3::from).to_vec(),
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    }
}

/// A shape with its parametrisation over the unit square, made anew from what it was made of.
struct Example {
    name: &'static str,
    shape: Shape,
    /// In double precision, so that areas can be had by differences.
    point: Box<dyn Fn(f64, f64) -> DVec3>,
    /// The square's point of a surface point.
    square: Box<dyn Fn(Vec3) -> Vec2>,
    world_from_local: Affine3A,
}

/// Returns `map` of a point, in double precision.
fn place(map: &Affine3A, p: [f64; 3]) -> DVec3 {
    let matrix = map.matrix3;
    let columns = [matrix.x_axis, matrix.y_axis, matrix.z_axis, map.translation];
    let [x, y, z, origin] = columns.map(|column| Vec3::from(column).as_dvec3());
    x * p[0] + y * p[1] + z * p[2] + origin
}

/// Returns the azimuth of a local point as part of `phi_max`.
fn azimuth(local: Vec3, phi_max: f32) -> f32 {
    if local.truncate().length() < 1e-3 {
        return 0.0; // At the pole it has none.
    }
    let phi = libm::atan2f(local.y, local.x);
    // Rounding around zero is not a turn.
    (if phi < -1e-5 { phi + 2.0 * PI } else { phi }) / phi_max
}

/// Makes an example of a surface of revolution: `profile` is the distance from its axis and the height at x, and
/// `column` the x of a local point.
fn revolved(
    name: &'static str,
    (shape, map, phi_max): (Shape, Affine3A, f32),
    profile: impl Fn(f64) -> [f64; 2] + 'static,
    column: impl Fn(Vec3) -> f32 + 'static,
) -> Example {
    Example {
        name,
        shape,
        point: Box::new(move |x, y| {
            let (sin, cos) = libm::sincos(f64::from(phi_max) * y);
            let [rho, z] = profile(x);
            place(&map, [rho * cos, rho * sin, z])
        }),
        square: Box::new(move |p| {
            let local = map.inverse().transform_point3(p);
            Vec2::new(column(local), azimuth(local, phi_max))
        }),
        world_from_local: map,
    }
}

/// `limits` are `z_min`, `z_max` and `phi_max`.
fn sphere(name: &'static str, map: Affine3A, radius: f32, limits: Vec3) -> Example {
    let [z_min, z_max, phi_max] = limits.to_array();
    let shape = Shape::Sphere(Sphere::partial(map, radius, limits, Orientation::Natural));
    let profile = move |x: f64| {
        let z = f64::from(z_min) + f64::from(z_max - z_min) * x;
        let rho2 = f64::from(radius) * f64::from(radius) - z * z;
        [rho2.max(0.0).sqrt(), z]
    };
    let column = move |local: Vec3| (local.z - z_min) / (z_max - z_min);
    revolved(name, (shape, map, phi_max), profile, column)
}

/// `limits` are `z_min`, `z_max` and `phi_max`.
fn cylinder(name: &'static str, map: Affine3A, radius: f32, limits: Vec3) -> Example {
    let [z_min, z_max, phi_max] = limits.to_array();
    let shape = Shape::Cylinder(Cylinder::new(map, radius, limits, Orientation::Natural));
    let z = move |x: f64| f64::from(z_min) + f64::from(z_max - z_min) * x;
    let column = move |local: Vec3| (local.z - z_min) / (z_max - z_min);
    let profile = move |x: f64| [f64::from(radius), z(x)];
    revolved(name, (shape, map, phi_max), profile, column)
}

fn disk(name: &'static str, map: Affine3A, [inner, outer]: [f32; 2], phi_max: f32) -> Example {
    let (height, front) = (0.3, Orientation::Natural);
    let shape = Shape::Disk(Disk::new(map, height, [inner, outer], phi_max, front));
    let rho = move |x: f64| f64::from(inner) + f64::from(outer - inner) * x;
    let column = move |local: Vec3| (local.truncate().length() - inner) / (outer - inner);
    let profile = move |x: f64| [rho(x), f64::from(height)];
    revolved(name, (shape, map, phi_max), profile, column)
}

fn mesh() -> Example {
    let [a, b, c] = triangle().triangle(0);
    let corners = Mat3::from_cols(b - a, c - a, (b - a).cross(c - a));
    let map = Affine3A::from_mat3_translation(corners, a);
    Example {
        name: "triangle",
        shape: Shape::Mesh(triangle()),
        // (x, y) to x·((1-y) of vertex 1, y of vertex 2).
        point: Box::new(move |x, y| place(&map, [x * (1.0 - y), x * y, 0.0])),
        square: Box::new(move |p| {
            let local = map.inverse().transform_point3(p);
            let x = local.x + local.y;
            Vec2::new(x, if x > 0.0 { local.y / x } else { 0.0 })
        }),
        world_from_local: map,
    }
}

fn examples() -> Vec<Example> {
    let whole = |radius: f32| Vec3::new(-radius, radius, 2.0 * PI);
    let mirror = Affine3A::from_scale(Vec3::new(1.0, -1.0, 1.0));
    let (uneven, mirrored) = (uneven(), mirrored());
    let (here, large) = (moved(Vec3::ONE, 1.0), moved(Vec3::ONE, 2.0));
    let ball = moved(Vec3::new(-2.0, 1.0, 0.5), 1.5);
    let limits = Vec3::new;
    vec![
        mesh(),
        sphere("ball", ball, 0.8, whole(0.8)),
        sphere("ball, mirrored", mirror, 1.0, whole(1.0)),
        sphere("partial", here, 1.0, limits(-0.3, 0.9, 4.0)),
        sphere("ellipsoid", uneven, 0.7, whole(0.7)),
        sphere("part, mirrored", mirrored, 1.0, limits(-1.0, 0.4, 2.5)),
        disk("disk", large, [0.0, 1.2], 2.0 * PI),
        disk("ring sector", here, [0.5, 1.2], 4.5),
        disk("ring sector, uneven", uneven, [0.2, 1.0], 3.0),
        disk("disk, mirrored", mirrored, [0.0, 1.0], 2.0 * PI),
        cylinder("cylinder", here, 0.7, limits(-0.5, 0.9, 2.0 * PI)),
        cylinder("wall, mirrored", mirrored, 0.6, limits(-0.2, 0.3, 4.0)),
        cylinder("wall, uneven", uneven, 0.6, limits(-0.2, 0.5, 5.0)),
    ]
}

#[test]
fn every_variant_has_an_example() {
    let shapes = examples().into_iter().map(|example| example.shape);
    check_variants!(shapes, Shape: Mesh Sphere Disk Cylinder);
}

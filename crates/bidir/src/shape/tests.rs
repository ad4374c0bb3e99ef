//! Shapes of every kind, under even, uneven and mirrored maps: how points are drawn, and geometry.

mod directions;
mod geometry;
mod points;

use super::{Cylinder, Disk, Mesh, Orientation, Shape, Sphere};
use crate::math::{Affine3A, Mat3, PI, Vec2, Vec3};

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
    Mesh {
        positions: vec![
            Vec3::new(1.0, 0.0, 0.0),
            Vec3::new(3.0, 0.5, -1.0),
            Vec3::new(0.0, 2.0, 1.0),
        ],
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    }
}

/// A shape with its parametrisation over the unit square, made anew from what it was made of.
struct Example {
    name: &'static str,
    shape: Shape,
    /// In double precision, so that areas can be had by differences.
    point: Box<dyn Fn(f64, f64) -> [f64; 3]>,
    /// The square's point of a surface point.
    square: Box<dyn Fn(Vec3) -> Vec2>,
    world_from_local: Affine3A,
}

/// Returns `map` of a point, in double precision.
fn place(map: &Affine3A, p: [f64; 3]) -> [f64; 3] {
    let columns = [
        map.matrix3.x_axis,
        map.matrix3.y_axis,
        map.matrix3.z_axis,
        map.translation,
    ]
    .map(|column| column.to_array().map(f64::from));
    std::array::from_fn(|i| {
        columns[0][i] * p[0] + columns[1][i] * p[1] + columns[2][i] * p[2] + columns[3][i]
    })
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

/// `limits` are `z_min`, `z_max` and `phi_max`.
fn sphere(name: &'static str, map: Affine3A, radius: f32, limits: Vec3) -> Example {
    let orientation = Orientation::Natural;
    let [z_min, z_max, phi_max] = limits.to_array();
    Example {
        name,
        shape: Shape::Sphere(Sphere::partial(map, radius, limits, orientation)),
        point: Box::new(move |x, y| {
            let z = f64::from(z_min) + f64::from(z_max - z_min) * x;
            let (sin, cos) = libm::sincos(f64::from(phi_max) * y);
            let rho = (f64::from(radius) * f64::from(radius) - z * z)
                .max(0.0)
                .sqrt();
            place(&map, [rho * cos, rho * sin, z])
        }),
        square: Box::new(move |p| {
            let local = map.inverse().transform_point3(p);
            Vec2::new((local.z - z_min) / (z_max - z_min), azimuth(local, phi_max))
        }),
        world_from_local: map,
    }
}

/// `limits` are `z_min`, `z_max` and `phi_max`.
fn cylinder(name: &'static str, map: Affine3A, radius: f32, limits: Vec3) -> Example {
    let [z_min, z_max, phi_max] = limits.to_array();
    Example {
        name,
        shape: Shape::Cylinder(Cylinder::new(map, radius, limits, Orientation::Natural)),
        point: Box::new(move |x, y| {
            let z = f64::from(z_min) + f64::from(z_max - z_min) * x;
            let (sin, cos) = libm::sincos(f64::from(phi_max) * y);
            let radius = f64::from(radius);
            place(&map, [radius * cos, radius * sin, z])
        }),
        square: Box::new(move |p| {
            let local = map.inverse().transform_point3(p);
            Vec2::new((local.z - z_min) / (z_max - z_min), azimuth(local, phi_max))
        }),
        world_from_local: map,
    }
}

fn disk(name: &'static str, map: Affine3A, radii: [f32; 2], phi_max: f32) -> Example {
    let height = 0.3;
    let [inner, outer] = radii;
    Example {
        name,
        shape: Shape::Disk(Disk::new(map, height, radii, phi_max, Orientation::Natural)),
        point: Box::new(move |x, y| {
            let r = f64::from(inner) + f64::from(outer - inner) * x;
            let (sin, cos) = libm::sincos(f64::from(phi_max) * y);
            place(&map, [r * cos, r * sin, f64::from(height)])
        }),
        square: Box::new(move |p| {
            let local = map.inverse().transform_point3(p);
            let r = local.truncate().length();
            Vec2::new((r - inner) / (outer - inner), azimuth(local, phi_max))
        }),
        world_from_local: map,
    }
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
    vec![
        mesh(),
        sphere(
            "ball",
            moved(Vec3::new(-2.0, 1.0, 0.5), 1.5),
            0.8,
            whole(0.8),
        ),
        sphere(
            "ball, mirrored",
            Affine3A::from_scale(Vec3::new(1.0, -1.0, 1.0)),
            1.0,
            whole(1.0),
        ),
        sphere(
            "partial",
            moved(Vec3::ONE, 1.0),
            1.0,
            Vec3::new(-0.3, 0.9, 4.0),
        ),
        sphere("ellipsoid", uneven(), 0.7, whole(0.7)),
        sphere(
            "partial ellipsoid, mirrored",
            mirrored(),
            1.0,
            Vec3::new(-1.0, 0.4, 2.5),
        ),
        disk("disk", moved(Vec3::ONE, 2.0), [0.0, 1.2], 2.0 * PI),
        disk("ring sector", moved(Vec3::ONE, 1.0), [0.5, 1.2], 4.5),
        disk("ring sector, uneven", uneven(), [0.2, 1.0], 3.0),
        disk("disk, mirrored", mirrored(), [0.0, 1.0], 2.0 * PI),
        cylinder(
            "cylinder",
            moved(Vec3::ONE, 1.5),
            0.7,
            Vec3::new(-0.5, 0.9, 2.0 * PI),
        ),
        cylinder(
            "partial cylinder, mirrored",
            mirrored(),
            0.6,
            Vec3::new(-0.2, 0.3, 4.0),
        ),
        cylinder(
            "partial cylinder, uneven",
            uneven(),
            0.6,
            Vec3::new(-0.2, 0.5, 5.0),
        ),
    ]
}

const VARIANTS: usize = 4;

/// Numbers the variants: a new one does not compile before it has a number here.
fn variant(shape: &Shape) -> usize {
    match shape {
        Shape::Mesh(_) => 0,
        Shape::Sphere(_) => 1,
        Shape::Disk(_) => 2,
        Shape::Cylinder(_) => 3,
    }
}

#[test]
fn every_variant_has_an_example() {
    let mut seen = [false; VARIANTS];
    for example in examples() {
        seen[variant(&example.shape)] = true;
    }
    assert_eq!(seen, [true; VARIANTS]);
}

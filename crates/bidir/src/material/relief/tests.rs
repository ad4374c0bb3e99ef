//! Relief against normals that are known: planes, spheres, mirrored parameters.

use super::*;
use crate::math::{Affine3A, PI, sin_cos};
use crate::shape::{Cylinder, Disk, Mesh, Orientation, Shape, Sphere, WorldFromObject};
use crate::testing::prelude::fbm;
use crate::texture::{Bilerp, Mapping, TextureSpace};

/// Returns the points of the first primitive with their frames under a relief, where a pixel is `width` wide.
fn frames(shape: &Shape, relief: &Relief, width: f32) -> Vec<(SurfacePoint, Frame)> {
    let points = (0..32).map(|i| {
        let u = Vec2::new(0.1 + 0.025 * i as f32, (0.05 + 0.618 * i as f32).fract());
        shape.sample(0, u).surface
    });
    let with_frame = |drawn: SurfacePoint| {
        let hit = match shape {
            Shape::Mesh(mesh) => barycentric(mesh, drawn.point),
            Shape::Sphere(_) | Shape::Disk(_) | Shape::Cylinder(_) => drawn.uv,
        };
        let surface = shape.surface_point(0, hit, drawn.point);
        let differentials = shape.differentials(None, 0, hit, &surface);
        let at = TexturePoint::new(&surface).seen(width, &differentials);
        (surface, relief.frame(&surface, &differentials, &at))
    };
    points.map(with_frame).collect()
}

fn barycentric(mesh: &Mesh, p: Vec3) -> Vec2 {
    let [a, b, c] = mesh.triangle(0);
    let n = (b - a).cross(c - a);
    let area = |from: Vec3, to: Vec3| n.dot((to - from).cross(p - from)) / n.length_squared();
    Vec2::new(area(c, a), area(a, b))
}

/// Returns the triangle (0,0), (2,0), (2,3) of the plane z = 0 with these parameters.
fn triangle(uvs: [Vec2; 3]) -> Mesh {
    Mesh {
        positions: vec![Vec3::ZERO, Vec3::X * 2.0, Vec3::new(2.0, 3.0, 0.0)],
        uvs: uvs.to_vec(),
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    }
}

/// Height `a`·u + `b`·v.
fn ramp(a: f32, b: f32) -> Relief {
    Relief::Displacement(FloatTexture::Bilerp(Arc::new(Bilerp {
        corners: [0.0, a, b, a + b],
        mapping: Mapping::IDENTITY,
    })))
}

fn normal_map(stored: [f32; 3], bitangent: Bitangent) -> Relief {
    Relief::NormalMap(map_of(stored, bitangent))
}

fn map_of(stored: [f32; 3], bitangent: Bitangent) -> NormalMap {
    NormalMap {
        texture: ColorTexture::Constant(stored),
        scale: 1.0,
        bitangent,
    }
}

fn reversed(mesh: Mesh) -> Shape {
    Shape::Mesh(Mesh {
        orientation: Orientation::Reversed,
        ..mesh
    })
}

#[track_caller]
fn check_normal(frame: &Frame, expected: Vec3) {
    let distance = frame.z.distance(expected);
    assert!(distance < 2e-3, "{} instead of {expected}", frame.z);
    let skew = frame.x.cross(frame.y).distance(frame.z);
    assert!(skew < 1e-5, "the frame is skewed by {skew}");
}

/// A linear ramp over a plane is a tilted plane, whatever the parameters' directions, and however
/// wide a pixel is.
#[test]
fn a_ramp_tilts_a_plane() {
    let along = [Vec2::ZERO, Vec2::X, Vec2::ONE];
    let turned = [Vec2::ZERO, Vec2::Y * 4.0, Vec2::new(-1.0, 4.0)];
    let mirrored = [Vec2::ZERO, -Vec2::X, Vec2::new(-1.0, 0.5)];
    for uvs in [along, turned, mirrored] {
        // The height is linear: its gradient over the plane follows from its corners.
        let [a, b, c] = uvs.map(|uv| 0.3 * uv.x - 0.2 * uv.y);
        let [dx, dy] = [(b - a) / 2.0, (c - b) / 3.0];
        for width in [0.0, 0.001, 0.3] {
            let check = |shape: &Shape, z| {
                for (_, frame) in frames(shape, &ramp(0.3, -0.2), width) {
                    check_normal(&frame, Vec3::new(-dx, -dy, z).normalize());
                }
            };
            check(&Shape::Mesh(triangle(uvs)), 1.0);
            // A reversed front pushes to its own side.
            check(&reversed(triangle(uvs)), -1.0);
        }
    }
}

/// A triangle between the points of a sphere with the sphere's normals is bumped as the sphere is:
/// the height changes the normal by its gradient over the smooth surface.
#[test]
fn interpolated_normals_are_pushed_along() {
    let corners = [[0.0, 0.0], [0.02, 0.0], [0.0, 0.02]].map(Vec2::from);
    let on_sphere = corners.map(|c| Vec3::new(c.x, c.y, (1.0 - c.length_squared()).sqrt()));
    let mesh = Mesh {
        positions: on_sphere.to_vec(),
        normals: on_sphere.to_vec(),
        uvs: corners.to_vec(),
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    };
    for (surface, frame) in frames(&Shape::Mesh(mesh), &ramp(0.5, 0.0), 1e-4) {
        let n = surface.shading.z;
        let gradient = Vec3::X - n * n.x;
        // At height h the sphere is 1 + h large, and the same gradient is that much smaller.
        let h = 0.5 * surface.uv.x;
        check_normal(&frame, (n - gradient * 0.5 / (1.0 + h)).normalize());
    }
}

/// A height of ε cos θ over a sphere of radius r: the normal of r(θ) = r + ε cos θ, which is known.
#[test]
fn a_sphere_bulges() {
    let (r, e) = (2.0, 0.4);
    // v runs from θ = π at the bottom; over a thin band the ramp of v is that of θ.
    let (limits, front) = (Vec3::new(-r, r, 2.0 * PI), Orientation::Natural);
    let sphere = Sphere::partial(Affine3A::IDENTITY, r, limits, front);
    for (surface, frame) in frames(&Shape::Sphere(sphere), &ramp(0.0, e), 1e-3) {
        let p = surface.point / r;
        let theta = PI * (1.0 - surface.uv.y);
        // h = e v, so dh/dθ = -e/π; the point at height h is r + h away.
        let slope = -e / PI / (r + e * surface.uv.y);
        let (sin, cos) = sin_cos(theta);
        let azimuth = Vec3::new(p.x, p.y, 0.0).normalize();
        let along_theta = azimuth * cos - Vec3::Z * sin;
        check_normal(&frame, (p - along_theta * slope).normalize());
    }
}

#[test]
fn a_constant_height_or_a_flat_map_changes_nothing() {
    let stretched = Affine3A::from_scale(Vec3::new(1.0, 2.0, 0.5));
    let [tilted, turned] = [
        Affine3A::from_rotation_x(1.0),
        Affine3A::from_rotation_y(2.0),
    ];
    let limits = Vec3::new(-0.4, 0.7, 5.0);
    let (front, back) = (Orientation::Natural, Orientation::Reversed);
    for shape in [
        Shape::Disk(Disk::new(tilted, 0.2, [0.1, 1.0], 4.0, back)),
        Shape::Mesh(triangle([Vec2::ZERO; 3])),
        Shape::Sphere(Sphere::new(stretched, 1.0, front)),
        Shape::Cylinder(Cylinder::new(turned, 0.6, limits, front)),
    ] {
        let level = Relief::Displacement(FloatTexture::Constant(0.0));
        for relief in [level, normal_map([0.5, 0.5, 1.0], Bitangent::RightHanded)] {
            for (surface, frame) in frames(&shape, &relief, 0.01) {
                assert!(frame.z.distance(surface.shading.z) < 1e-5);
            }
        }
    }
}

/// The stored y goes to the left of ∂p/∂u, or to the side of ∂p/∂v; they differ if parameters are mirrored.
#[test]
fn normal_maps_follow_the_parameters() {
    let n = Vec3::new(0.6, 0.0, 0.8);
    let sideways = Vec3::new(0.0, 0.6, 0.8);
    let stored = |n: Vec3| ((n + 1.0) / 2.0).to_array();
    let upright = [Vec2::ZERO, Vec2::X, Vec2::ONE];
    let mirrored = [Vec2::ZERO, Vec2::X, Vec2::new(1.0, -1.0)];
    let flipped = Vec3::new(0.0, -0.6, 0.8);
    let (right_handed, along_v) = (Bitangent::RightHanded, Bitangent::AlongV);
    for (uvs, tangent, map, bitangent, expected) in [
        (upright, None, n, right_handed, n),
        (upright, None, sideways, right_handed, sideways),
        (upright, None, sideways, along_v, sideways),
        (mirrored, None, sideways, right_handed, sideways),
        (mirrored, None, sideways, along_v, flipped),
        // With a tangent of its own a surface has the same sides, whatever the parameters' directions.
        (upright, Some(Vec3::Y), sideways, along_v, n.with_x(-0.6)),
        (mirrored, Some(Vec3::Y), sideways, along_v, n),
        (
            upright.map(|uv| -uv),
            Some(Vec3::Y),
            sideways,
            along_v,
            n.with_x(-0.6),
        ),
    ] {
        let mesh = Mesh {
            tangents: tangent.map_or(Vec::new(), |tangent| vec![tangent; 3]),
            ..triangle(uvs)
        };
        let relief = normal_map(stored(map), bitangent);
        for (_, frame) in frames(&Shape::Mesh(mesh), &relief, 0.0) {
            check_normal(&frame, expected);
        }
    }
    let half = Relief::NormalMap(NormalMap {
        scale: 0.5,
        ..map_of(stored(n), right_handed)
    });
    for (_, frame) in frames(&Shape::Mesh(triangle(upright)), &half, 0.0) {
        check_normal(&frame, Vec3::new(0.3, 0.0, 0.8).normalize());
    }
}

/// However rough: unit frames on the front, and nothing that is not a number.
#[test]
fn relief_stays_in_front() {
    let space = TextureSpace::new(Affine3A::from_scale(Vec3::splat(30.0)));
    let wild = fbm(8, 1.0, space);
    let sphere = Sphere::new(Affine3A::IDENTITY, 1.0, Orientation::Reversed);
    let nan = Relief::Displacement(FloatTexture::Constant(f32::NAN));
    let black = normal_map([0.5; 3], Bitangent::AlongV);
    for relief in [Relief::Displacement(wild), nan, black] {
        for (surface, frame) in frames(&Shape::Sphere(sphere), &relief, 0.0) {
            let is_unit = (frame.z.length() - 1.0).abs() < 1e-5;
            assert!(frame.z.dot(surface.n_g) >= 0.0 && is_unit);
        }
    }
}

/// Derivatives against differences of the surface itself, in the world and for objects in places.
#[test]
fn differentials_are_those_of_the_surface() {
    let map = Affine3A::from_rotation_y(0.4) * Affine3A::from_scale(Vec3::new(1.0, -2.0, 0.7));
    let limits = Vec3::new(-0.6, 0.9, 5.0);
    let place = WorldFromObject(glam::DAffine3::from_scale(glam::DVec3::new(1.0, 3.0, -0.5)));
    for place in [None, Some(&place)] {
        for shape in [
            Shape::Sphere(Sphere::partial(map, 1.0, limits, Orientation::Natural)),
            Shape::Disk(Disk::new(map, 0.3, [0.2, 1.5], 5.0, Orientation::Reversed)),
            Shape::Cylinder(Cylinder::new(map, 0.8, limits, Orientation::Reversed)),
        ] {
            check_differentials(&shape, place, |uv| local_point(&shape, map, uv));
        }
    }
}

/// Returns the point with parameters `uv`, by the parametrisation of the format.
fn local_point(shape: &Shape, map: Affine3A, uv: Vec2) -> Vec3 {
    let (sin, cos) = sin_cos(5.0 * uv.x);
    let local = match shape {
        Shape::Disk(_) => {
            let r = 1.5 - 1.3 * uv.y;
            Vec3::new(r * cos, r * sin, 0.3)
        }
        Shape::Cylinder(_) => Vec3::new(0.8 * cos, 0.8 * sin, -0.6 + 1.5 * uv.y),
        Shape::Sphere(_) | Shape::Mesh(_) => {
            let [bottom, top] = [-0.6, 0.9].map(libm::acosf);
            let (s, c) = sin_cos(bottom + (top - bottom) * uv.y);
            Vec3::new(s * cos, s * sin, c)
        }
    };
    map.transform_point3(local)
}

#[track_caller]
fn check_differentials(
    shape: &Shape,
    place: Option<&WorldFromObject>,
    point: impl Fn(Vec2) -> Vec3,
) {
    let world = |p: Vec3| match place {
        None => p,
        Some(place) => place.0.transform_point3(p.as_dvec3()).as_vec3(),
    };
    for i in 0..16 {
        let v = (0.3 + 0.37 * i as f32).fract() * 0.8 + 0.1;
        let uv = Vec2::new(0.1 + 0.05 * i as f32, v);
        let surface = |uv: Vec2| {
            let p = world(point(uv));
            match place {
                None => shape.surface_point(0, uv, p),
                Some(place) => shape.surface_point_at(place, 0, uv, p),
            }
        };
        let here = surface(uv);
        let d = shape.differentials(place, 0, uv, &here);
        let h = 2e-3;
        for (axis, dp, dn) in [(Vec2::X, d.dp_du, d.dn_du), (Vec2::Y, d.dp_dv, d.dn_dv)] {
            let (after, before) = (surface(uv + axis * h), surface(uv - axis * h));
            let slope = |a: Vec3, b: Vec3| (a - b) / (2.0 * h);
            let expected = slope(after.point, before.point);
            let is_near = dp.distance(expected) < 5e-3 * expected.length();
            assert!(is_near, "{dp}, {expected}");
            let expected = slope(after.shading.z, before.shading.z);
            let is_near = dn.distance(expected) < 5e-3 * (1.0 + expected.length());
            assert!(is_near, "{dn}, {expected}");
        }
        let [gradient_u, gradient_v] = d.gradients();
        assert!((gradient_u.dot(d.dp_du) - 1.0).abs() < 1e-3);
        assert!(gradient_u.dot(d.dp_dv).abs() < 1e-3 && gradient_v.dot(d.dp_du).abs() < 1e-3);
    }
}

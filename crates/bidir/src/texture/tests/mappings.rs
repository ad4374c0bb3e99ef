//! Mappings: known directions, and gradients.

use super::super::*;
use super::at_point;
use crate::math::{Affine3A, PI, Vec2};

#[test]
fn mappings_know_their_directions() {
    let spherical = Mapping::Spherical(TextureSpace::WORLD);
    let cylindrical = Mapping::Cylindrical(TextureSpace::WORLD);
    for (p, on_sphere, on_cylinder) in [
        (Vec3::X, [0.5, 0.0], [0.5, 0.0]),
        (Vec3::Y * 3.0, [0.5, 0.25], [0.75, 0.0]),
        (-Vec3::Y, [0.5, 0.75], [0.25, 0.0]),
        (Vec3::new(1.0, 0.0, 1.0), [0.25, 0.0], [0.5, 1.0]),
        (Vec3::new(0.0, 1.0, -1.0), [0.75, 0.25], [0.75, -1.0]),
    ] {
        for (mapping, expected) in [(&spherical, on_sphere), (&cylindrical, on_cylinder)] {
            let st = mapping.st(&at_point(p));
            assert!((st - Vec2::from(expected)).length() < 1e-6, "{p}: {st}");
        }
    }
    let turned = Affine3A::from_rotation_z(PI / 2.0) * Affine3A::from_scale(Vec3::splat(2.0));
    let planar = Mapping::planar(&turned, [Vec3::X, Vec3::Y * 3.0], Vec2::new(0.5, 0.0));
    let st = planar.st(&at_point(Vec3::new(1.0, 2.0, 7.0)));
    assert!((st - Vec2::new(-3.5, 6.0)).length() < 1e-5, "{st}");
}

/// Gradients against differences of the mapping itself, along the surface.
#[test]
fn gradients_are_those_of_the_mapping() {
    let map = Affine3A::from_rotation_y(0.7)
        * Affine3A::from_scale(Vec3::new(0.5, 2.0, 1.5))
        * Affine3A::from_translation(Vec3::new(0.2, 0.3, -0.1));
    let space = TextureSpace::new(map);
    let vectors = [Vec3::new(1.0, 0.5, 0.0), Vec3::new(0.0, 1.0, -2.0)];
    for mapping in [
        Mapping::Spherical(space),
        Mapping::Cylindrical(space),
        Mapping::planar(&map, vectors, Vec2::ZERO),
    ] {
        let normal = Vec3::new(0.3, -0.5, 0.8).normalize();
        let point = Vec3::new(0.9, 0.7, 0.4);
        let here = TexturePoint {
            normal,
            ..at_point(point)
        };
        let [ds, dt] = mapping.gradients(&here);
        for tangent in [normal.any_orthonormal_vector(), normal.cross(Vec3::X)] {
            let h = 1e-2;
            let st = |side: f32| mapping.st(&at_point(point + tangent * side * h));
            let difference = (st(1.0) - st(-1.0)) / (2.0 * h);
            let expected = Vec2::new(ds.dot(tangent), dt.dot(tangent));
            let is_near = difference.distance(expected) < 2e-3;
            assert!(is_near, "{difference} and {expected}");
        }
        assert!(ds.dot(normal).abs() < 1e-5 && dt.dot(normal).abs() < 1e-5);
    }
}

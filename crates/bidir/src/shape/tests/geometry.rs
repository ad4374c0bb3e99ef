use super::{Example, disk, examples, mirrored, moved, sphere, triangle, uneven};
use crate::locus::Locus;
use crate::math::{DAffine3, DVec3, ONE_MINUS_EPSILON, PI, warp};
use crate::scene::Scene;
use crate::shape::{Disk, Mesh, Orientation, Shape, Sphere, SurfacePoint, WorldFromObject};
use crate::testing::prelude::{
    Dimension, Purpose, Vec2, Vec3, builder, check_close, check_near, diffuse, samples,
};

/// Returns the points of the surface, drawn.
fn points(example: &Example) -> impl Iterator<Item = SurfacePoint> {
    samples(example.name, 200).map(|sample| {
        let u = sample.get_2d(Dimension::at(0, Purpose::LightPosition));
        example.shape.sample(0, u).surface
    })
}

/// Checks that normal, shading frame and error are what they say.
#[track_caller]
fn check_surface(example: &Example, at: &SurfacePoint) {
    let (name, frame) = (example.name, at.shading);
    check_near(at.n_g.length(), 1.0, 1e-5, name);
    assert!(frame.z.distance(at.n_g) < 1e-5, "{name}: n_s {}", frame.z);
    assert!(frame.x.dot(frame.z).abs() < 1e-5, "{name}");
    assert!(frame.x.cross(frame.y).distance(frame.z) < 1e-5, "{name}");
    // Neighbours on the surface lie across the normal.
    let square = (example.square)(at.point);
    let h = 1e-3;
    for (x, y) in [(h, 0.0), (-h, 0.0), (0.0, h), (0.0, -h)] {
        let [x, y] = [square.x + x, square.y + y].map(f64::from);
        if !(0.02..0.98).contains(&x) || !(0.0..1.0).contains(&y) {
            continue;
        }
        let away = ((example.point)(x, y).as_vec3() - at.point).normalize();
        let is_across = away.dot(at.n_g).abs() < 0.02;
        assert!(is_across, "{name}: {away} is not across {}", at.n_g);
    }
}

#[test]
fn normals_stand_upright_on_surfaces() {
    for example in examples() {
        for at in points(&example) {
            check_surface(&example, &at);
        }
    }
}

/// Points are where the parametrisation puts them, within the error that rays are pushed off by.
#[test]
fn points_lie_on_the_surface_within_their_error() {
    for example in examples() {
        for at in points(&example) {
            let square = (example.square)(at.point).clamp(Vec2::ZERO, Vec2::ONE);
            let exact = (example.point)(f64::from(square.x), f64::from(square.y));
            let offset = exact - at.point.as_dvec3();
            let distance = offset.dot(at.n_g.as_dvec3()).abs();
            let (name, error) = (example.name, at.error);
            assert!(distance <= f64::from(error), "{name}: {distance} > {error}");
        }
    }
}

/// The intersector finds the drawn surface at a drawn point.
#[test]
fn a_hit_has_the_geometry_of_the_sample() {
    for example in examples() {
        if matches!(example.shape, Shape::Mesh(_)) {
            continue; // Its intersector's parameters are not its surface parameters.
        }
        for at in points(&example) {
            let hit = example.shape.surface_point(0, at.uv, at.point);
            let close = (hit.point - at.point).length() < 1e-4
                && (hit.n_g - at.n_g).length() < 1e-3
                && (hit.shading.x - at.shading.x).length() < 1e-2;
            assert!(close, "{}: {hit:?} instead of {at:?}", example.name);
        }
    }
}

/// Rounding at the rim does not leave the unit square.
#[test]
fn parameters_of_a_part_of_a_sphere_stay_in_the_unit_square() {
    let map = moved(Vec3::ONE, 1.0);
    for phi_max in [0.3, 2.5, 4.0] {
        let part = sphere("partial", map, 1.0, Vec3::new(-0.3, 0.9, phi_max));
        for i in 0..=100 {
            let u = Vec2::new(i as f32 / 100.0, ONE_MINUS_EPSILON);
            let uv = part.shape.sample(0, u).surface.uv;
            assert!(uv == uv.clamp(Vec2::ZERO, Vec2::ONE), "{uv} for {phi_max}");
        }
    }
}

/// The outside of a sphere is its front under every map, mirrored or not; +z that of a disk.
#[test]
fn the_front_is_the_outside_unless_reversed() {
    let whole = Vec3::new(-0.7, 0.7, 2.0 * PI);
    for map in [uneven(), mirrored()] {
        let ball = sphere("ellipsoid", map, 0.7, whole);
        for at in points(&ball) {
            let outward = at.point - Vec3::from(ball.world_from_local.translation);
            assert!(at.n_g.dot(outward) > 0.0);
        }
        let reversed = Shape::Sphere(Sphere::new(map, 0.7, Orientation::Reversed));
        let flat = disk("disk", map, [0.0, 1.0], 2.0 * PI);
        let (radii, back) = ([0.0, 1.0], Orientation::Reversed);
        let flat_reversed = Shape::Disk(Disk::new(map, 0.3, radii, 2.0 * PI, back));
        for u in [Vec2::new(0.2, 0.3), Vec2::new(0.9, 0.8)] {
            let [natural, other] = [&ball.shape, &reversed].map(|s| s.sample(0, u).surface.n_g);
            assert!((natural + other).length() < 1e-6);
            let [natural, other] = [&flat.shape, &flat_reversed].map(|s| s.sample(0, u).surface);
            assert!((natural.n_g + other.n_g).length() < 1e-6);
            assert!(natural.n_g.dot(map.transform_vector3(Vec3::Z)) > 0.0);
        }
    }
}

/// The winding decides the front of a mesh, unless it has normals.
#[test]
fn the_front_of_a_mesh_follows_its_winding_or_its_normals() {
    let faceted = triangle();
    let [a, b, c] = faceted.triangle(0);
    let winding = (b - a).cross(c - a).normalize();
    let front = |mesh: &Mesh| {
        let shape = Shape::Mesh(mesh.clone());
        shape.sample(0, Vec2::splat(0.4)).surface
    };
    assert!((front(&faceted).n_g - winding).length() < 1e-6);
    let reversed = Mesh {
        orientation: Orientation::Reversed,
        ..faceted.clone()
    };
    assert!((front(&reversed).n_g + winding).length() < 1e-6);
    let tilted = (-winding + (b - a).normalize() * 0.5).normalize();
    for orientation in [Orientation::Natural, Orientation::Reversed] {
        let smooth = Mesh {
            normals: vec![tilted; 3],
            orientation,
            ..faceted.clone()
        };
        assert!((front(&smooth).shading.z - tilted).length() < 1e-6);
        assert!((front(&smooth).n_g + winding).length() < 1e-6);
    }
}

/// Tangents of vertices are interpolated, and count as far as they are not along the normal; objects
/// bring theirs to the world as points move.
#[test]
fn a_mesh_has_the_tangents_of_its_vertices() {
    let along_u = triangle();
    let [a, b, c] = along_u.triangle(0);
    let normal = (b - a).cross(c - a).normalize();
    let [first, second] = [(b - a).normalize(), (c - a).normalize()];
    let with = |tangents| Mesh {
        tangents,
        ..along_u.clone()
    };
    let mesh = with(vec![first + normal * 3.0, second - normal, Vec3::ZERO]);
    let at = Vec2::new(0.5, 0.2);
    let tangent = |mesh: &Mesh, place: Option<&WorldFromObject>| {
        let shape = Shape::Mesh(mesh.clone());
        let point = a * 0.3 + b * 0.5 + c * 0.2;
        let surface = match place {
            None => shape.surface_point(0, at, point),
            Some(place) => shape.surface_point_at(place, 0, at, place.point(point)),
        };
        surface.shading.x
    };
    let expected = first * 0.3 + second * 0.5;
    assert!(tangent(&mesh, None).distance(expected.normalize()) < 1e-6);
    let stretched = DVec3::new(1.0, -3.0, 0.5);
    let place = WorldFromObject(DAffine3::from_scale(stretched));
    let moved = (expected.as_dvec3() * stretched).as_vec3().normalize();
    let flat = with(vec![first, second, Vec3::ZERO]);
    assert!(tangent(&flat, Some(&place)).distance(moved) < 1e-6);
    assert!(tangent(&with(vec![normal; 3]), None).is_finite());
}

#[test]
fn triangles_of_any_size_have_their_area() {
    for size in [1e-18_f32, 1e-12, 1e-9, 1.0, 1e9, 1e12] {
        let triangle = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X * size, Vec3::Y * size],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        check_close(triangle.triangle_area(0), size * size / 2.0, 1e-5, size);
    }
}

/// Returns a scene of one shape, which is an object at `place` if there is one.
fn scene_of(shape: Shape, place: Option<DAffine3>) -> Scene {
    let mut builder = builder(1, 0.0);
    if let Some(place) = place {
        let (object, material) = (builder.object(), builder.material(diffuse([0.5; 3])));
        builder.object_shape(object, shape, material);
        builder.instance(object, place);
    } else {
        builder.add(shape, diffuse([0.5; 3]));
    }
    builder.build().scene
}

/// Rays are as inexact as they are long, surfaces as their coordinates are large.
#[test]
fn no_surface_shadows_itself_from_afar() {
    let (scale, shift) = (DVec3::new(0.02, -0.01, 0.03), DVec3::new(0.1, -0.04, 0.07));
    let turn = glam::DQuat::from_rotation_x(0.6);
    let place = DAffine3::from_scale_rotation_translation(scale, turn, shift);
    for example in examples() {
        for place in [None, Some(place)] {
            let name = (example.name, place.is_some());
            let scene = scene_of(example.shape.clone(), place);
            for (i, sample) in samples(example.name, 2000).enumerate() {
                let u = sample.get_2d(Dimension::at(0, Purpose::LightPosition));
                let own = example.shape.sample(0, u).surface;
                let at = place.map_or(own, |place| {
                    let place = WorldFromObject(place);
                    let uv = match example.shape {
                        Shape::Mesh(_) => warp::triangle(u),
                        _ => own.uv,
                    };
                    let point = place.point(own.point);
                    example.shape.surface_point_at(&place, 0, uv, point)
                });
                let u = sample.get_2d(Dimension::at(0, Purpose::Scatter));
                let towards = warp::cosine_hemisphere(u);
                let distance = [10.0, 1e3, 1e5][i % 3];
                let far = at.point + at.shading.to_world(towards) * distance;
                let ends = [at.locus(), Locus::in_space(far)];
                for [a, b] in [ends, [ends[1], ends[0]]] {
                    let seen = scene.transmittance(&a, &b);
                    assert!(seen > 0.0, "{name:?} at {} from {far}", at.point);
                }
            }
        }
    }
}

//! Queries give the right answers: equal to brute force, to a formula, and to their contract.

use bidir_accel::{Aabb, Primitive, Ray, accept_all};
use glam::Vec3;

use crate::oracle::{Single, plane_passage};
use crate::scenes::{Mesh, Random, displace, mixed, triangle_soup};
use crate::trees::build;

#[track_caller]
fn check_equals_brute_force(primitives: &[Primitive], random: &mut Random, rays: usize) {
    let (bvh, single) = (build(primitives), Single::new(primitives));
    for _ in 0..rays {
        let ray = Ray {
            t_min: 0.3 * random.unit(),
            t_max: 10.0 * random.unit(),
            ..random.ray()
        };
        for ray in [ray, Ray::new(ray.origin, ray.direction)] {
            let expected = single.closest(&ray, accept_all);
            bvh.check(&ray, accept_all, expected);
            assert_eq!(bvh.is_hit(&ray), expected.is_some(), "{ray:?}");
        }
    }
}

#[test]
fn equals_brute_force() {
    let mut random = Random(1);
    for count in [1, 2, 3, 4, 5, 8, 9, 33, 150] {
        check_equals_brute_force(&mixed(&mut random, count), &mut random, 1500);
        check_equals_brute_force(&triangle_soup(&mut random, count, 0.7), &mut random, 1500);
    }
}

#[test]
fn agrees_with_moller_trumbore() {
    let mut random = Random(2);
    let primitives = triangle_soup(&mut random, 300, 0.6);
    let bvh = build(&primitives);
    let passage = |ray: &Ray, primitive: usize| match primitives[primitive] {
        Primitive::Triangle(triangle) => plane_passage(ray, triangle),
        _ => unreachable!("only triangles"),
    };
    let mut hits = 0;
    for _ in 0..20_000 {
        let ray = Ray::new(2.0 * random.cube(), random.ball());
        let hit = bvh.closest(&ray, accept_all);
        // The nearest of those that are hit with a margin, and not edge-on.
        let clear = (0..primitives.len())
            .map(|i| passage(&ray, i))
            .filter(|[t, u, v]| *t > 1e-4 && *u > 1e-3 && *v > 1e-3 && u + v < 1.0 - 1e-3);
        let nearest = clear.map(|[t, ..]| t).fold(f64::INFINITY, f64::min);
        assert!(
            f64::from(hit.map_or(f32::INFINITY, |hit| hit.t)) <= nearest + 1e-4,
            "{ray:?}"
        );
        if let Some(hit) = hit {
            hits += 1;
            let [t, u, v] = passage(&ray, hit.primitive as usize);
            // How much a rounding of the vertices moves the answer depends on the slant: so compare
            // points, which must be on the ray and at the parameters alike.
            let point = ray.origin.as_dvec3() + f64::from(hit.t) * ray.direction.as_dvec3();
            let Primitive::Triangle(corners) = primitives[hit.primitive as usize] else {
                unreachable!("only triangles")
            };
            let [a, b, c] = corners.map(Vec3::as_dvec3);
            let at = a + f64::from(hit.u) * (b - a) + f64::from(hit.v) * (c - a);
            assert!(point.distance(at) < 2e-6, "{ray:?} {hit:?}");
            let slant = ray
                .direction
                .as_dvec3()
                .normalize()
                .dot((b - a).cross(c - a).normalize());
            let tolerance = 1e-6 / slant.abs();
            assert!((f64::from(hit.t) - t).abs() * f64::from(ray.direction.length()) < tolerance);
            assert!(u > -1e-3 && v > -1e-3 && u + v < 1.001 || slant.abs() < 1e-2);
        }
    }
    assert!(hits > 5000);
}

#[test]
fn limits_include_their_ends() {
    let at = |z| Primitive::Triangle([Vec3::ZERO, Vec3::X, Vec3::Y].map(|p| p + Vec3::Z * z));
    let bvh = build(&[at(1.0), at(2.0), at(3.0)]);
    let ray = |t_min, t_max| Ray {
        t_min,
        t_max,
        ..Ray::new(Vec3::new(0.2, 0.2, 0.0), Vec3::Z)
    };
    let found = |t_min, t_max| {
        let hit = bvh.closest(&ray(t_min, t_max), accept_all);
        assert_eq!(bvh.is_hit(&ray(t_min, t_max)), hit.is_some());
        hit.map(|hit| hit.primitive)
    };
    assert_eq!(found(0.0, f32::INFINITY), Some(0));
    assert_eq!(found(1.0, 1.0), Some(0));
    assert_eq!(found(2.0, 9.0), Some(1));
    assert_eq!(found(2.0_f32.next_up(), 3.0), Some(2));
    assert_eq!(found(2.0_f32.next_up(), 3.0_f32.next_down()), None);
    assert_eq!(found(0.0, 1.0_f32.next_down()), None);
    // An origin on a surface, a negative minimum, an empty range and numbers that are none.
    let on = Ray::new(Vec3::new(0.2, 0.2, 1.0), Vec3::Z);
    assert_eq!(
        bvh.closest(&on, accept_all).map(|hit| hit.primitive),
        Some(0)
    );
    let back = Ray {
        t_min: -5.0,
        t_max: 0.5,
        ..Ray::new(Vec3::new(0.2, 0.2, 4.0), Vec3::Z)
    };
    assert_eq!(bvh.closest(&back, accept_all), None);
    assert_eq!(found(4.0, 1.0), None);
    assert_eq!(found(f32::NAN, 9.0), None);
    assert_eq!(found(0.0, f32::NAN), None);
    for (origin, direction) in [
        (Vec3::NAN, Vec3::Z),
        (Vec3::INFINITY, Vec3::Z),
        (Vec3::ZERO, Vec3::NAN),
        (Vec3::ZERO, Vec3::INFINITY),
        (Vec3::splat(0.1), Vec3::ZERO),
    ] {
        bvh.check(&Ray::new(origin, direction), accept_all, None);
    }
}

#[test]
fn hits_at_the_limits_are_found_and_none_beyond() {
    let mut random = Random(17);
    let mut hits = 0;
    for round in 0..40_000 {
        let scale = ((round % 61) as f32 - 30.0).exp2();
        // Some far from the origin, some flat, some that rays begin on.
        let middle = [0.0, 1.0, 100.0][round % 3] * random.cube();
        let flat = [1.0, 1e-4][round % 2];
        let corner =
            |random: &mut Random| (middle + random.cube() * Vec3::new(1.0, 1.0, flat)) * scale;
        let triangle = [(); 3].map(|()| corner(&mut random));
        let bvh = build(&[Primitive::Triangle(triangle)]);
        let [a, b, c] = triangle;
        let [u, v] = [random.unit(), random.unit()];
        let on = a + (b - a) * u + (c - a) * (v * (1.0 - u));
        let away = [1e-6, 1e-3, 1.0][round / 6 % 3] * scale;
        let ray = Ray::new(on + random.cube() * away, random.ball());
        let Some(hit) = bvh.closest(&ray, accept_all) else {
            continue;
        };
        hits += 1;
        let is_hit = |t_min, t_max| {
            let limited = Ray {
                t_min,
                t_max,
                ..ray
            };
            let found = bvh.closest(&limited, accept_all).is_some();
            assert_eq!(bvh.is_hit(&limited), found);
            found
        };
        assert!(is_hit(hit.t, f32::INFINITY) && is_hit(0.0, hit.t) && is_hit(hit.t, hit.t));
        assert!(!is_hit(hit.t.next_up(), f32::INFINITY));
        assert!(hit.t <= 0.0 || !is_hit(0.0, hit.t.next_down()));
    }
    assert!(hits > 5000, "{hits}");
}

#[test]
fn t_is_in_units_of_the_direction() {
    let triangle = [
        Vec3::new(-1.0, -1.0, 2.0),
        Vec3::new(3.0, -1.0, 2.0),
        Vec3::new(-1.0, 3.0, 2.0),
    ];
    let bvh = build(&[Primitive::Triangle(triangle)]);
    for exponent in [-100, -30, -1, 0, 1, 30, 100] {
        let scale = (f64::from(exponent)).exp2() as f32;
        let ray = Ray::new(Vec3::ZERO, Vec3::Z * scale);
        assert_eq!(
            bvh.closest(&ray, accept_all).map(|hit| hit.t),
            Some(2.0 / scale)
        );
    }
}

#[test]
fn filtered_primitives_do_not_exist() {
    let mut random = Random(3);
    let primitives = mixed(&mut random, 60);
    let (bvh, single) = (build(&primitives), Single::new(&primitives));
    for _ in 0..4000 {
        let ray = random.ray();
        // Filters refuse some primitives, or parts of all.
        let rejected = random.below(3) as u32;
        let by_primitive = |hit: &bidir_accel::Hit| hit.primitive % 3 != rejected;
        let by_place = |hit: &bidir_accel::Hit| hit.u + hit.v > 0.3;
        bvh.check(&ray, by_primitive, single.closest(&ray, by_primitive));
        bvh.check(&ray, by_place, single.closest(&ray, by_place));
        bvh.check(&ray, |_| false, None);
    }
}

#[test]
fn equal_distances_go_to_the_lowest_primitive() {
    let mut random = Random(4);
    let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y].map(|p| p - Vec3::new(0.2, 0.2, 0.0));
    let rotations = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1]];
    for copies in [2, 5, 40, 300] {
        // Coincident triangles with vertices in any order, hidden among others.
        let mut primitives = triangle_soup(&mut random, 200, 0.1);
        primitives.retain(|p| p.bounds().min.z > 0.05 || p.bounds().max.z < -0.05);
        for _ in 0..copies {
            let order = rotations[random.below(4)];
            let copy = Primitive::Triangle(order.map(|i| triangle[i]));
            primitives.insert(random.below(primitives.len() + 1), copy);
        }
        let first = primitives
            .iter()
            .position(|p| p.bounds().extent().z <= 0.0)
            .unwrap();
        let bvh = build(&primitives);
        let only_copies =
            |hit: &bidir_accel::Hit| primitives[hit.primitive as usize].bounds().extent().z <= 0.0;
        for _ in 0..200 {
            let target = triangle[0] + 0.4 * Vec3::new(random.unit(), random.unit(), 0.0);
            let origin = target + random.ball() + Vec3::Z;
            let hit = bvh
                .closest(&Ray::new(origin, target - origin), only_copies)
                .unwrap();
            assert_eq!(hit.primitive as usize, first);
        }
    }
}

#[test]
fn ties_at_shared_vertices_equal_brute_force() {
    // The triangles around a vertex are in different leaves, whose boxes begin at the vertex: one of
    // them must not be skipped because rounding puts its box behind the hit.
    let mesh = Mesh::sphere(3).map(displace);
    let primitives = mesh.primitives();
    let (bvh, single) = (build(&primitives), Single::new(&primitives));
    let mut random = Random(6);
    for _ in 0..8000 {
        let origin = 0.5 * random.ball();
        let ray = Ray::new(
            origin,
            mesh.vertices[random.below(mesh.vertices.len())] - origin,
        );
        let expected = single.closest(&ray, accept_all);
        bvh.check(&ray, accept_all, expected);
        // With the hit as the limit, boxes and triangles meet it again.
        let limited = Ray {
            t_max: expected.map_or(0.0, |hit| hit.t),
            ..ray
        };
        assert!(expected.is_some());
        bvh.check(&limited, accept_all, expected);
    }
}

#[test]
fn ties_survive_the_rounding_of_boxes() {
    let mut random = Random(10);
    for _ in 0..100 {
        // Integers, so that all triangles are hit in their common corner at exactly `t`, whereas
        // `t·d·(1/d)`, where their boxes are entered, is often above.
        let mut integer = || (3 + random.below(500)) as f32;
        let (direction, t) = (Vec3::from_array([(); 3].map(|()| integer())), integer());
        let corner = t * direction;
        let mut beyond = || corner + Vec3::from_array([(); 3].map(|()| 1000.0 * integer()));
        let primitives: Vec<_> = (0..400)
            .map(|_| Primitive::Triangle([corner, beyond(), beyond()]))
            .collect();
        let hit = build(&primitives).closest(&Ray::new(Vec3::ZERO, direction), accept_all);
        assert_eq!(
            hit.map(|hit| (hit.t.to_bits(), hit.primitive)),
            Some((t.to_bits(), 0))
        );
    }
}

#[test]
fn order_of_primitives_does_not_change_the_distance() {
    let mut random = Random(5);
    let primitives = mixed(&mut random, 100);
    let reversed: Vec<_> = primitives.iter().rev().copied().collect();
    let (bvh, other) = (build(&primitives), build(&reversed));
    for _ in 0..20_000 {
        let ray = random.ray();
        let (a, b) = (
            bvh.closest(&ray, accept_all),
            other.closest(&ray, accept_all),
        );
        assert_eq!(a.map(|hit| hit.t.to_bits()), b.map(|hit| hit.t.to_bits()));
    }
}

#[test]
fn nothing_is_a_scene() {
    let bvh = build(&[]);
    let ray = Ray::new(Vec3::ZERO, Vec3::X);
    assert_eq!(bvh.closest(&ray, accept_all), None);
    assert!(!bvh.is_blocked(&ray));
    assert_eq!(
        (bvh.bounds(), bvh.memory_bytes(), bvh.primitive_count()),
        (Aabb::EMPTY, 0, 0)
    );
}

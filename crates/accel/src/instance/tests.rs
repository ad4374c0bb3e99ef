//! Bounds that no local ray can leave, and maps that are refused.

use super::*;
use crate::{BuildOptions, Bvh, Primitive, accept_all};
use glam::{DMat3, Vec3};
use std::sync::Arc;

const UNIT: Aabb = Aabb {
    min: Vec3::NEG_ONE,
    max: Vec3::ONE,
};

fn place(world_from_object: DAffine3) -> Option<(Placement, Aabb)> {
    let instance = Instance {
        object: 3,
        world_from_object,
    };
    Placement::new(&instance, &UNIT, &[UNIT])
}

#[test]
fn bounds_are_wider_than_the_mapped_box_but_hardly() {
    let map = DAffine3::from_translation(DVec3::new(10.0, 0.0, 0.0));
    let (placement, bounds) = place(map).expect("a translation");
    let exact = Aabb {
        min: Vec3::new(9.0, -1.0, -1.0),
        max: Vec3::new(11.0, 1.0, 1.0),
    };
    assert!(bounds.contains(&exact) && bounds != exact);
    assert!((bounds.extent() - exact.extent()).max_element() < 3e-5);
    assert_eq!(placement.object, 3);
}

#[test]
fn bounds_of_a_turned_ball_are_hardly_wider_than_the_ball() {
    let mut state = 1;
    let mut point = || vector(&mut state).normalize().as_vec3();
    let triangles: Vec<_> = (0..4000)
        .map(|_| Primitive::Triangle([point(); 3]))
        .collect();
    let options = BuildOptions::default();
    let ball = Arc::new(Bvh::build(&triangles, &options).expect("finite"));
    let instance = Instance {
        object: 0,
        world_from_object: DAffine3::from_rotation_y(0.25 * std::f64::consts::PI),
    };
    let bvh = Bvh::with_instances(&[][..], vec![ball], &[instance], &options).expect("valid");
    assert_eq!(bvh.validate(), Ok(()));
    let extent = bvh.bounds().extent();
    // Its own box, turned, has 2.83, 2 and 2.83.
    assert!(extent.max_element() < 2.3, "{extent}");
}

#[test]
fn maps_without_inverse_are_refused() {
    for scale in [
        DVec3::new(1.0, 0.0, 1.0),
        DVec3::ZERO,
        DVec3::new(f64::NAN, 1.0, 1.0),
        DVec3::splat(1e-300),
        DVec3::splat(1e300),
    ] {
        assert_eq!(place(DAffine3::from_scale(scale)), None, "{scale}");
    }
    let far = DAffine3::from_translation(DVec3::splat(1e300));
    assert_eq!(place(far), None);
    // Two columns that are nearly the same direction.
    let mut shear = DAffine3::IDENTITY;
    shear.matrix3.y_axis = DVec3::new(1.0, 1e-9, 0.0);
    assert_eq!(place(shear), None);
    let flat = DAffine3::from_scale(DVec3::new(1.0, -1e-12, 1.0));
    assert!(
        place(flat).is_some(),
        "flat along an axis is well-conditioned"
    );
}

#[test]
fn local_rays_begin_at_the_ball() {
    let (placement, _) = place(DAffine3::from_scale(DVec3::splat(2.0))).expect("a scale");
    let near = Ray::new(Vec3::ZERO, Vec3::X);
    let (local, object) = placement.view(&near, &Approach::new(&near), 1);
    assert!(object.start <= 0.0 && local.t_min <= 0.0);
    assert_eq!((local.origin, local.direction), (Vec3::ZERO, Vec3::X / 2.0));
    let far = Ray::new(Vec3::X * -1e6, Vec3::X);
    let (local, object) = placement.view(&far, &Approach::new(&far), 1);
    assert!((object.start - 1e6 + 2.0 * 3.0_f64.sqrt()).abs() < 0.1);
    let hit = Hit {
        t: -2.0 * local.origin.x,
        instance: 0,
        primitive: 7,
        u: 0.0,
        v: 0.0,
    };
    let world = object.world_hit(hit).expect("no limits");
    assert_eq!((world.t, world.instance, world.primitive), (1e6, 1, 7));
}

/// Numbers in [-1, 1).
fn random(state: &mut u64) -> f64 {
    *state = state
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1_442_695_040_888_963_407);
    (*state >> 40) as f64 / f64::from(1 << 23) - 1.0
}

fn vector(state: &mut u64) -> DVec3 {
    DVec3::new(random(state), random(state), random(state))
}

/// Returns the answer without the box in the world that might cull it.
fn unculled(bvh: &Bvh, ray: &Ray) -> Option<f32> {
    let (local, space) = bvh.placements[0].view(ray, &Approach::new(ray), 1);
    let hit = bvh.objects[0].closest(&local, accept_all)?;
    space.world_hit(hit).map(|hit| hit.t)
}

#[test]
fn no_hit_is_culled_by_the_world_box() {
    let mut state = 5;
    let mut hits = 0;
    for round in 0..400 {
        // Triangles that end at the box, so that silhouettes are on it; some far from their origin.
        let offset = [0.0, 1.0, 1e6][round % 3] * vector(&mut state);
        let corner = |state: &mut u64| (vector(state) + offset).as_vec3();
        // One leaf, or a tree of several levels, whose third has the boxes that count.
        let count = [6, 6, 6, 600][round / 18 % 4];
        let primitives: Vec<_> = (0..count)
            .map(|_| [(); 3].map(|()| corner(&mut state)))
            .map(Primitive::Triangle)
            .collect();
        let mut linear =
            DMat3::from_cols(vector(&mut state), vector(&mut state), vector(&mut state));
        linear.y_axis *= [1.0, 1e-3, 30.0][round / 3 % 3];
        if round % 5 == 0 {
            // The mapped box is as tight as the local one.
            linear = DMat3::from_diagonal(vector(&mut state));
        }
        // Some of these come back to the world's origin, where the box alone has few digits.
        let back = [0.0, 1.0][round / 9 % 2] * (linear * offset);
        let world_from_object =
            DAffine3::from_mat3_translation(linear, 10.0 * vector(&mut state) - back);
        // The rounding of local coordinates.
        let blur = 1e-7 * (1.0 + offset.length());
        let options = BuildOptions::default();
        let object = Arc::new(Bvh::build(&primitives, &options).expect("finite"));
        let instance = Instance {
            object: 0,
            world_from_object,
        };
        let bvh = Bvh::with_instances(&[][..], vec![object], &[instance], &options);
        // Nearly singular, by chance.
        let Ok(bvh) = bvh else { continue };
        assert_eq!(bvh.validate(), Ok(()));
        for i in 0..300 {
            // At a corner of a triangle, from near and far: half of the rays pass just beside.
            let Primitive::Triangle(triangle) = primitives[i % count] else {
                unreachable!("only triangles")
            };
            let corner = triangle[i / count % 3].as_dvec3() + blur * vector(&mut state);
            let target = world_from_object.transform_point3(corner);
            let far = [0.0, 1.0, 100.0, 1e5][i % 4];
            let origin = (target + far * vector(&mut state)).as_vec3();
            let ray = Ray::new(origin, target.as_vec3() - origin);
            let expected = unculled(&bvh, &ray);
            hits += u32::from(expected.is_some());
            let found = bvh.closest(&ray, accept_all).map(|hit| hit.t);
            assert_eq!(
                found.map(f32::to_bits),
                expected.map(f32::to_bits),
                "{ray:?}"
            );
            // The hit as the limit, where it ties with itself.
            let limited = Ray {
                t_max: expected.unwrap_or(0.0),
                ..ray
            };
            assert_eq!(bvh.is_blocked(&limited), expected.is_some());
        }
    }
    assert!(hits > 20_000, "{hits} hits do not say much");
}

#[test]
fn corrupted_places_are_refused() {
    let options = BuildOptions::default();
    let triangle = Primitive::Triangle([Vec3::ZERO, Vec3::X, Vec3::Y]);
    let object = Arc::new(Bvh::build(&[triangle], &options).expect("finite"));
    let instance = Instance {
        object: 0,
        world_from_object: DAffine3::IDENTITY,
    };
    let mut bvh =
        Bvh::with_instances(&[][..], vec![object], &[instance; 2], &options).expect("valid");
    assert_eq!(bvh.validate(), Ok(()));
    bvh.placements[1].object_from_world.translation.x += 1.0;
    assert!(bvh.validate().expect_err("moved").contains("instance 1"));
    bvh.placements.push(bvh.placements[0]);
    bvh.placements.swap(1, 2);
    let error = bvh.validate().expect_err("not in the tree");
    assert!(error.contains("instance 2"), "{error}");
}

//! Instances: the same answers as copies, as tight as what they are made of, and errors for bad ones.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use bidir_accel::{
    Aabb, BuildError, BuildOptions, Bvh, Hit, Instance, InstanceError, Isa, Primitive, Ray, Stop,
    accept_all,
};
use glam::{DAffine3, DMat3, DVec3, Vec3};

use crate::oracle::hit_bits;
use crate::scenes::{Mesh, Random, displace, mixed, triangle_soup};
use crate::trees::{Trees, build, build_one, on_threads};

const TRIANGLE: Primitive = Primitive::Triangle([Vec3::ZERO, Vec3::X, Vec3::Y]);
const HERE: Instance = Instance {
    object: 0,
    world_from_object: DAffine3::IDENTITY,
};

fn vector(random: &mut Random) -> DVec3 {
    random.ball().as_dvec3()
}

/// A map that turns, scales, shears and mirrors, but is no threat to precision.
fn map(random: &mut Random) -> DAffine3 {
    loop {
        let linear = DMat3::from_cols(vector(random), vector(random), vector(random));
        if linear.determinant().abs() > 0.1 {
            return DAffine3::from_mat3_translation(linear, 2.0 * vector(random));
        }
    }
}

fn placed_one(own: &[Primitive], objects: &[&[Primitive]], instances: &[Instance]) -> Bvh {
    let objects = objects.iter().map(|object| Arc::new(build_one(object)));
    let options = BuildOptions::default();
    Bvh::with_instances(own, objects.collect(), instances, &options).expect("valid")
}

pub(crate) fn placed(own: &[Primitive], objects: &[&[Primitive]], instances: &[Instance]) -> Trees {
    Trees::new(&placed_one(own, objects, instances))
}

pub(crate) fn instances(random: &mut Random, count: usize, objects: usize) -> Vec<Instance> {
    let instance = |_| Instance {
        object: random.below(objects) as u32,
        world_from_object: map(random),
    };
    (0..count).map(instance).collect()
}

fn moved(primitives: &[Primitive], map: &DAffine3) -> Vec<Primitive> {
    let moved = |primitive: &Primitive| match primitive {
        Primitive::Triangle(corners) => {
            let corner = |p: Vec3| map.transform_point3(p.as_dvec3()).as_vec3();
            Primitive::Triangle(corners.map(corner))
        }
        _ => unreachable!("only triangles"),
    };
    primitives.iter().map(moved).collect()
}

#[test]
fn equal_copies_but_for_rounding() {
    let mut random = Random(50);
    let objects = [20, 70].map(|count| triangle_soup(&mut random, count, 0.4));
    let own = triangle_soup(&mut random, 10, 0.5);
    let instances = instances(&mut random, 30, 2);
    let bvh = placed(&own, &[&objects[0], &objects[1]], &instances);
    let mut copies = own.clone();
    let mut numbers: Vec<_> = (0..own.len() as u32).map(|i| (0, i)).collect();
    for (number, instance) in (1..).zip(&instances) {
        let object = &objects[instance.object as usize];
        copies.extend(moved(object, &instance.world_from_object));
        numbers.extend((0..object.len() as u32).map(|i| (number, i)));
    }
    let flat = build(&copies);
    let (mut same, mut hits) = (0, 0);
    for _ in 0..20_000 {
        let ray = Ray::new(3.0 * random.cube(), random.ball());
        let (a, b) = (
            bvh.closest(&ray, accept_all),
            flat.closest(&ray, accept_all),
        );
        hits += usize::from(b.is_some());
        if let (Some(a), Some(b)) = (a, b)
            && (a.instance, a.primitive) == numbers[b.primitive as usize]
        {
            same += 1;
            let steep = (a.t - b.t).abs() > 1e-5 || (a.u - b.u).abs() > 1e-3;
            assert!(!steep || (a.t - b.t).abs() < 1e-2, "{ray:?} {a:?} {b:?}");
        }
    }
    assert!(
        hits > 4000 && same as f64 > 0.999 * hits as f64,
        "{same} of {hits}"
    );
}

/// The first by `(t, instance)` of trees with one instance each.
fn closest_of_each(each: &[Bvh], ray: &Ray, accept: impl Fn(&Hit) -> bool) -> Option<Hit> {
    let mut best: Option<Hit> = None;
    for (instance, bvh) in (1..).zip(each) {
        let hit = bvh.closest(ray, |hit| accept(&Hit { instance, ..*hit }));
        if let Some(hit) = hit.filter(|hit| best.is_none_or(|best| hit.t < best.t)) {
            best = Some(Hit { instance, ..hit });
        }
    }
    best
}

#[test]
fn equal_brute_force_over_instances() {
    let mut random = Random(51);
    let objects = [mixed(&mut random, 12), mixed(&mut random, 60), Vec::new()];
    let objects = [&objects[0][..], &objects[1], &objects[2]];
    let mut instances = instances(&mut random, 40, 3);
    // Some stand in the same place: their hits tie.
    instances.extend_from_within(..10);
    let trees = placed(&[], &objects, &instances);
    let each: Vec<_> = instances
        .iter()
        .map(|instance| placed_one(&[], &objects, &[*instance]))
        .collect();
    let mut hits = 0;
    for i in 0..20_000 {
        let mut ray = Ray {
            t_min: 0.3 * random.unit(),
            t_max: 10.0 * random.unit(),
            ..random.ray()
        };
        if i % 2 == 0 {
            let origin = ray.origin * [1.0, 1e3][i / 2 % 2];
            ray = Ray::new(origin, 1.5 * random.cube() - origin);
        }
        let refused = random.below(3) as u32;
        let accept = |hit: &Hit| (hit.instance + hit.primitive) % 3 != refused;
        let expected = closest_of_each(&each, &ray, accept);
        hits += usize::from(expected.is_some());
        trees.check(&ray, accept, expected);
    }
    assert!(hits > 2500, "{hits} hits do not say much");
}

#[test]
fn closed_objects_do_not_leak() {
    let mut random = Random(52);
    for levels in [1, 4] {
        let mesh = Mesh::sphere(levels).map(displace);
        let object = mesh.primitives();
        for round in 0..20 {
            let mut map = map(&mut random);
            match round % 5 {
                0 => map.translation *= 1e5,
                1 => map.matrix3 *= 1e-4,
                2 => map.matrix3.x_axis *= 1e-3,
                3 => map.matrix3 *= 1e6,
                _ => {}
            }
            let instance = Instance {
                object: 0,
                world_from_object: map,
            };
            let trees = placed(&[], &[&object], &[instance]);
            for i in 0..20_000 {
                // From the middle half of the inside at edges and vertices, as subtracted.
                let origin = map.transform_point3(0.5 * vector(&mut random)).as_vec3();
                let face = mesh.faces[random.below(mesh.faces.len())];
                let [a, b] = [0, 1].map(|k| mesh.vertices[face[k]]);
                let local = a.lerp(b, [0.0, 0.5, random.unit()][i % 3]);
                let target = map.transform_point3(local.as_dvec3()).as_vec3();
                let ray = Ray::new(origin, target - origin);
                // At 10⁵ the world's numbers no longer separate the inside of small ones from the outside.
                assert!(trees.is_hit(&ray), "{ray:?} {map:?}");
            }
        }
    }
}

#[test]
fn own_primitives_come_first_in_ties() {
    let ray = Ray::new(Vec3::new(0.2, 0.2, 2.0), -Vec3::Z);
    let both = placed(&[TRIANGLE], &[&[TRIANGLE]], &[HERE; 3]);
    let id = |bvh: &Trees| {
        let hit = bvh.closest(&ray, accept_all);
        hit.map(|hit| (hit.t.to_bits(), hit.instance))
    };
    assert_eq!(id(&both), Some((2.0_f32.to_bits(), 0)));
    let only = placed(&[], &[&[TRIANGLE]], &[HERE; 3]);
    assert_eq!(id(&only), Some((2.0_f32.to_bits(), 1)));
    let behind = |hit: &Hit| hit.instance > 2;
    assert_eq!(only.closest(&ray, behind).map(|hit| hit.instance), Some(3));
}

/// A thousand instances in one place, of which a ray looks at none after somebody asked to stop.
#[test]
fn stopped_rays_look_at_no_more_instances() {
    let ray = Ray::new(Vec3::new(0.2, 0.2, 2.0), -Vec3::Z);
    for isa in Isa::supported() {
        let bvh = placed_one(&[], &[&[TRIANGLE]], &vec![HERE; 1000]);
        let bvh = bvh.with_isa(isa).expect("supported");
        for (stops, expected) in [(false, 1000), (true, 1)] {
            let (flag, seen) = (AtomicBool::new(false), AtomicUsize::new(0));
            let stop = Stop::when(&flag);
            let _ = bvh.until(stop).each_hit(&ray, |_| {
                seen.fetch_add(1, Ordering::Relaxed);
                flag.store(stops, Ordering::Relaxed);
                ControlFlow::Continue(())
            });
            assert_eq!(seen.load(Ordering::Relaxed), expected, "{isa}");
            // From then on no question is answered.
            let mut blocked = Vec::new();
            bvh.until(stop).are_blocked(&[ray; 9], &mut blocked);
            assert_eq!(blocked, [!stops; 9], "{isa}");
            assert_eq!(bvh.until(stop).is_blocked(&ray), !stops);
            let hit = bvh.until(stop).closest(&ray, accept_all);
            assert_eq!(hit.is_some(), !stops, "{isa}");
        }
    }
}

#[test]
fn threads_do_not_matter() {
    let mut random = Random(53);
    let object = mixed(&mut random, 30);
    let own = mixed(&mut random, 3000);
    let instances = instances(&mut random, 5000, 1);
    let trees =
        [1, 5].map(|threads| on_threads(threads, || placed_one(&own, &[&object], &instances)));
    assert_eq!(trees[0].memory_bytes(), trees[1].memory_bytes());
    for _ in 0..5000 {
        let ray = random.ray();
        let [a, b] = [0, 1].map(|i: usize| hit_bits(trees[i].closest(&ray, accept_all)));
        assert_eq!(a, b);
    }
}

#[test]
fn nothing_in_many_places_is_nothing() {
    let bvh = placed(&[], &[&[]], &[HERE; 5]);
    assert!(!bvh.is_blocked(&Ray::new(Vec3::ZERO, Vec3::X)));
    assert_eq!((bvh.bounds(), bvh.instance_count()), (Aabb::EMPTY, 5));
}

#[test]
fn bad_instances_are_refused() {
    let options = BuildOptions::default();
    let object = Arc::new(build_one(&[TRIANGLE]));
    let at = |object, scale| Instance {
        object,
        world_from_object: DAffine3::from_scale(scale),
    };
    let good = at(0, DVec3::ONE);
    let check = |objects: Vec<Arc<Bvh>>, bad: Instance, reason| {
        let error = Bvh::with_instances(&[][..], objects, &[good, bad], &options);
        let expected = BuildError::BadInstance {
            instance: 1,
            reason,
        };
        assert_eq!(error.map(|_| ()), Err(expected));
    };
    let one = || vec![object.clone()];
    check(one(), at(1, DVec3::ONE), InstanceError::NoObject);
    check(
        one(),
        at(0, DVec3::new(1.0, 1.0, 0.0)),
        InstanceError::NotInvertible,
    );
    check(
        one(),
        at(0, DVec3::splat(f64::NAN)),
        InstanceError::NotInvertible,
    );
    check(
        one(),
        at(0, DVec3::splat(1e30)),
        InstanceError::NotInvertible,
    );
    let group = Bvh::with_instances(&[][..], one(), &[good], &options).expect("valid");
    let nested = vec![object.clone(), Arc::new(group)];
    check(nested, at(1, DVec3::ONE), InstanceError::Nested);
}

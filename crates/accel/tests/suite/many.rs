//! Many rays at once get the answers of single ones.

use bidir_accel::Ray;
use glam::Vec3;

use crate::instances::{instances, placed};
use crate::scenes::{Mesh, Random, displace, mixed, triangle_soup};
use crate::trees::{Trees, build};

/// Calls of no ray, of fewer and more than go in step, and of many.
const CALLS: [usize; 8] = [0, 1, 2, 7, 8, 9, 61, 1000];

/// Some rays are invalid; they must not change the answers of others.
fn rays(random: &mut Random, count: usize) -> Vec<Ray> {
    let mut ray = || {
        let ray = Ray {
            t_min: 0.3 * random.unit(),
            t_max: 10.0 * random.unit(),
            ..random.ray()
        };
        match random.below(12) {
            0 => Ray::new(Vec3::NAN, ray.direction),
            1 => Ray::new(ray.origin, Vec3::ZERO),
            2 => Ray { t_max: -1.0, ..ray },
            3..6 => Ray::new(ray.origin, ray.direction),
            _ => ray,
        }
    };
    (0..count).map(|_| ray()).collect()
}

#[track_caller]
fn check(trees: &Trees, random: &mut Random, is_full: impl Fn(f64) -> bool) {
    let (mut blocked, mut all) = (0, 0);
    for count in CALLS {
        let rays = rays(random, count);
        let expected: Vec<_> = rays.iter().map(|ray| trees.is_blocked(ray)).collect();
        assert_eq!(trees.are_blocked(&rays), expected, "{count} rays");
        blocked += expected.iter().filter(|&&is_blocked| is_blocked).count();
        all += count;
    }
    let share = blocked as f64 / all as f64;
    assert!(is_full(share), "a share of {share} does not say much");
}

#[test]
fn of_shapes() {
    let mut random = Random(71);
    check(&build(&[]), &mut random, |share| share == 0.0);
    check(&build(&mixed(&mut random, 1)), &mut random, |share| {
        share > 0.0
    });
    for count in [9, 150, 3000] {
        check(&build(&mixed(&mut random, count)), &mut random, |share| {
            share > 0.001
        });
        let triangles = triangle_soup(&mut random, count, 0.5);
        check(&build(&triangles), &mut random, |share| share > 0.001);
    }
    let mesh = Mesh::sphere(5).map(displace);
    check(&build(&mesh.primitives()), &mut random, |share| {
        (0.05..0.9).contains(&share)
    });
}

#[test]
fn of_instances() {
    let mut random = Random(72);
    let objects = [mixed(&mut random, 12), triangle_soup(&mut random, 400, 0.5)];
    let objects = [&objects[0][..], &objects[1]];
    let own = mixed(&mut random, 30);
    let places = instances(&mut random, 40, 2);
    check(&placed(&own, &objects, &places), &mut random, |share| {
        (0.2..0.9).contains(&share)
    });
    check(&placed(&[], &objects, &places[..1]), &mut random, |share| {
        share > 0.01
    });
}

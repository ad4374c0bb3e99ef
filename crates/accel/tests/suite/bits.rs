//! The same bits for every instruction set, number of threads and order of asking.

use bidir_accel::{Primitive, Ray, accept_all};

use crate::oracle::hit_bits;
use crate::scenes::{Mesh, Random, displace, mixed};
use crate::trees::{build, build_one, on_threads};

#[track_caller]
fn check_isas_agree(primitives: &[Primitive], mut ray: impl FnMut(&mut Random) -> Ray) {
    let mut random = Random(20);
    let trees = build(primitives);
    let mut hits = 0;
    for _ in 0..120_000 {
        let ray = ray(&mut random);
        hits += usize::from(trees.is_hit(&ray));
    }
    assert!(hits > 10_000, "{hits} hits do not say much");
}

#[test]
fn isas_agree_on_a_mixed_scene() {
    let primitives = mixed(&mut Random(21), 1000);
    check_isas_agree(&primitives, Random::ray);
}

#[test]
fn isas_agree_on_edges() {
    let mesh = Mesh::sphere(3).map(displace);
    check_isas_agree(&mesh.primitives(), |random| {
        let origin = 3.0 * random.ball();
        Ray::new(
            origin,
            mesh.vertices[random.below(mesh.vertices.len())] - origin,
        )
    });
}

#[test]
fn threads_do_not_matter() {
    // So many that sums have two parts, and that threads build subtrees.
    let primitives = mixed(&mut Random(22), 50_000);
    let trees = [1, 2, 5].map(|threads| on_threads(threads, || build_one(&primitives)));
    let mut random = Random(23);
    for bvh in &trees {
        assert_eq!(bvh.validate(), Ok(()));
        assert_eq!(bvh.memory_bytes(), trees[0].memory_bytes());
    }
    for _ in 0..20_000 {
        let ray = random.ray();
        let [a, b, c] = [0, 1, 2].map(|i: usize| hit_bits(trees[i].closest(&ray, accept_all)));
        assert_eq!((a, a), (b, c));
    }
}

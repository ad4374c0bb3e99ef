//! Inputs that a scene should not have, but has.

use bidir_accel::{BuildError, BuildOptions, Bvh, Primitive, Ray, accept_all};
use glam::Vec3;
use proptest::prelude::*;

use crate::oracle::Single;
use crate::scenes::{Random, triangle_soup};
use crate::trees::build;

#[track_caller]
fn check_rays(primitives: &[Primitive], random: &mut Random) {
    let bvh = build(primitives);
    let bounds = bvh.bounds();
    // A ray may meet every primitive.
    let rays = 500.min(400_000 / primitives.len());
    let mut ray = || {
        let target = bounds.center() + bounds.extent() * 0.5 * random.cube();
        let origin = bounds.center() + bounds.extent() * random.cube();
        Ray::new(origin, target - origin)
    };
    let rays: Vec<_> = (0..rays).map(|_| ray()).collect();
    for (ray, is_blocked) in rays.iter().zip(bvh.are_blocked(&rays)) {
        let hit = bvh.closest(ray, accept_all);
        assert_eq!(bvh.is_blocked(ray), hit.is_some());
        assert_eq!(is_blocked, hit.is_some());
        if let Some(hit) = hit {
            assert!(
                hit.t.is_finite() && hit.u.is_finite() && hit.v.is_finite(),
                "{hit:?}"
            );
        }
    }
}

#[test]
fn builds_anything_finite() {
    let mut random = Random(40);
    let one = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let copies = vec![Primitive::Triangle(one); 5000];
    check_rays(&copies, &mut random);
    check_rays(&copies[..1], &mut random);
    let points: Vec<_> = (0..500)
        .map(|_| Primitive::Triangle([random.cube(); 3]))
        .collect();
    check_rays(&points, &mut random);
    let same_point = vec![Primitive::Triangle([Vec3::ONE; 3]); 3000];
    check_rays(&same_point, &mut random);
    let needles: Vec<_> = (0..500)
        .map(|_| [random.cube(), random.cube()])
        .map(|[a, b]| Primitive::Triangle([a, b, a]))
        .collect();
    check_rays(&needles, &mut random);
    for scale in [1e-38_f32, 1e-30, 1e-20, 1e10, 1e25, 1.5e38] {
        let scaled = triangle_soup(&mut random, 1000, 0.2)
            .into_iter()
            .map(|primitive| {
                let Primitive::Triangle(vertices) = primitive else {
                    unreachable!("a soup")
                };
                Primitive::Triangle(vertices.map(|p| p * scale))
            });
        check_rays(&scaled.collect::<Vec<_>>(), &mut random);
    }
}

#[test]
fn widely_spread_sizes_stay_shallow_enough() {
    // Each triangle is ten thousand times smaller than the next: the heuristic cuts off one or few
    // at a time, and on top of that many centers fall together.
    let mut primitives = Vec::new();
    for exponent in -37..38 {
        let size = libm::exp2(f64::from(exponent) * 3.3) as f32;
        for copy in 0..40 {
            let p = Vec3::splat(size) * (1.0 + 0.001 * copy as f32);
            primitives.push(Primitive::Triangle([
                p,
                p + Vec3::X * size,
                p + Vec3::Y * size,
            ]));
        }
    }
    check_rays(&primitives, &mut Random(41));
    // A geometric series along one axis.
    let series = (0..2000).map(|i| {
        let p = Vec3::X * libm::exp2(f64::from(i) * 0.12 - 120.0) as f32;
        Primitive::Triangle([p, p + 0.1 * Vec3::X * p.x, p + 0.1 * Vec3::Y * p.x])
    });
    check_rays(&series.collect::<Vec<_>>(), &mut Random(42));
}

#[test]
fn values_that_are_not_finite_are_refused() {
    let good = [Vec3::ZERO, Vec3::X, Vec3::Y];
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for (vertex, axis) in [(0, 0), (1, 1), (2, 2)] {
            let mut triangle = good;
            triangle[vertex][axis] = bad;
            let primitives = [good, good, triangle, triangle].map(Primitive::Triangle);
            let error = Bvh::build(&primitives, &BuildOptions::default()).unwrap_err();
            assert_eq!(error, BuildError::NotFinite { primitive: 2 });
            assert_eq!(error.to_string(), "primitive 2 has no finite bounds");
        }
    }
}

/// Coordinates on a coarse grid, so that everything coincides with something.
fn grid_point() -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(-2i8..=2).prop_map(|p| Vec3::from_array(p.map(f32::from)))
}

fn wild_float() -> impl Strategy<Value = f32> {
    prop_oneof![
        -2.0f32..2.0,
        Just(0.0f32),
        Just(-0.0f32),
        // Areas must be finite; a filter would reject too many.
        prop::num::f32::NORMAL.prop_map(|x| if x.abs() < 1e30 { x } else { 1.0 / x }),
        prop::num::f32::SUBNORMAL,
    ]
}

fn wild_point() -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(wild_float()).prop_map(Vec3::from_array)
}

fn triangles(point: impl Strategy<Value = Vec3>) -> impl Strategy<Value = Vec<Primitive>> {
    let triangle = prop::array::uniform3(point).prop_map(Primitive::Triangle);
    prop::collection::vec(triangle, 1..60)
}

proptest! {
    #[test]
    fn grids_equal_brute_force(
        primitives in triangles(grid_point()),
        rays in prop::collection::vec((grid_point(), grid_point()), 100),
    ) {
        let (bvh, single) = (build(&primitives), Single::new(&primitives));
        let rays: Vec<_> = rays.into_iter().map(|(o, d)| Ray::new(o, d)).collect();
        for (ray, is_blocked) in rays.iter().zip(bvh.are_blocked(&rays)) {
            let expected = single.closest(ray, accept_all);
            bvh.check(ray, accept_all, expected);
            prop_assert_eq!(is_blocked, expected.is_some());
        }
    }

    #[test]
    fn wild_numbers_give_finite_hits(
        primitives in triangles(wild_point()),
        rays in prop::collection::vec((wild_point(), wild_point()), 50),
    ) {
        let bvh = build(&primitives);
        let rays: Vec<_> = rays.into_iter().map(|(o, d)| Ray::new(o, d)).collect();
        for (ray, is_blocked) in rays.iter().zip(bvh.are_blocked(&rays)) {
            let hit = bvh.closest(ray, accept_all);
            prop_assert_eq!(bvh.is_blocked(ray), hit.is_some());
            prop_assert_eq!(is_blocked, hit.is_some());
            if let Some(hit) = hit {
                prop_assert!(hit.t >= 0.0 && hit.t.is_finite());
                prop_assert!((0.0..=1.0).contains(&hit.u) && (0.0..=1.0).contains(&hit.v));
            }
        }
    }
}

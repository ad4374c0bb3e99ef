//! Quadrics against formulas.

use std::f64::consts::{PI, TAU};

use bidir_accel::{
    BuildError, BuildOptions, Bvh, Cylinder, Disk, Hit, Primitive, Ray, Sphere, accept_all,
};
use glam::{Affine3A, DVec3, Mat3, Vec3};

use crate::scenes::{Random, cylinder, disk, sphere};
use crate::trees::build;

/// A point of the surface in local space, from its parameters by the definition.
fn local_point(primitive: &Primitive, hit: &Hit) -> DVec3 {
    let (u, v) = (f64::from(hit.u), f64::from(hit.v));
    match primitive {
        Primitive::Sphere(sphere) => {
            let theta = |z: f32| (f64::from(z) / f64::from(sphere.radius)).acos();
            let theta = theta(sphere.z_min) + v * (theta(sphere.z_max) - theta(sphere.z_min));
            let phi = u * f64::from(sphere.phi_max);
            f64::from(sphere.radius) * from_angles(theta, phi)
        }
        Primitive::Disk(disk) => {
            let distance = f64::from(disk.radius) * (1.0 - v) + f64::from(disk.inner_radius) * v;
            let around = from_angles(0.5 * PI, u * f64::from(disk.phi_max));
            DVec3::new(
                distance * around.x,
                distance * around.y,
                f64::from(disk.height),
            )
        }
        Primitive::Cylinder(cylinder) => {
            let [low, high] = [cylinder.z_min, cylinder.z_max].map(f64::from);
            let around = from_angles(0.5 * PI, u * f64::from(cylinder.phi_max));
            let across = f64::from(cylinder.radius) * around;
            DVec3::new(across.x, across.y, low + v * (high - low))
        }
        Primitive::Triangle(_) => unreachable!("not a quadric"),
    }
}

fn from_angles(theta: f64, phi: f64) -> DVec3 {
    let (sin, cos) = (libm::sin(theta), libm::cos(theta));
    DVec3::new(sin * libm::cos(phi), sin * libm::sin(phi), cos)
}

fn map_of(primitive: &Primitive) -> Affine3A {
    match primitive {
        Primitive::Sphere(sphere) => sphere.local_from_world,
        Primitive::Disk(disk) => disk.local_from_world,
        Primitive::Cylinder(cylinder) => cylinder.local_from_world,
        Primitive::Triangle(_) => unreachable!("not a quadric"),
    }
}

fn local_from_world(primitive: &Primitive) -> impl Fn(DVec3) -> DVec3 {
    let map = map_of(primitive);
    let matrix = Mat3::from(map.matrix3).as_dmat3();
    move |p| matrix * p + Vec3::from(map.translation).as_dvec3()
}

/// All `t` of a line on the whole surface, found as roots of its equation in local space by the
/// textbook formula, and whether the point there belongs to the part that is kept.
fn passages(primitive: &Primitive, o: DVec3, d: DVec3) -> Vec<(f64, bool)> {
    let kept = |p: DVec3, phi_max: f32| p.y.atan2(p.x).rem_euclid(TAU) <= f64::from(phi_max);
    match primitive {
        Primitive::Sphere(sphere) => {
            let cuts = [sphere.z_min, sphere.z_max, sphere.phi_max];
            roots(o, d, sphere.radius, (o, d), cuts)
        }
        Primitive::Cylinder(cylinder) => {
            let cuts = [cylinder.z_min, cylinder.z_max, cylinder.phi_max];
            let across = DVec3::new(1.0, 1.0, 0.0);
            roots(o * across, d * across, cylinder.radius, (o, d), cuts)
        }
        Primitive::Disk(disk) => {
            let t = (f64::from(disk.height) - o.z) / d.z;
            let p = o + t * d;
            let (inner, outer) = (f64::from(disk.inner_radius), f64::from(disk.radius));
            let distance = p.x.hypot(p.y);
            vec![(
                t,
                inner <= distance && distance <= outer && kept(p, disk.phi_max),
            )]
        }
        Primitive::Triangle(_) => unreachable!("not a quadric"),
    }
}

/// The solutions of |o + t d| = radius, and whether the points there of `line` are between the cuts.
fn roots(
    o: DVec3,
    d: DVec3,
    radius: f32,
    line: (DVec3, DVec3),
    [z_min, z_max, phi_max]: [f32; 3],
) -> Vec<(f64, bool)> {
    let (a, b) = (d.dot(d), 2.0 * o.dot(d));
    let c = o.dot(o) - f64::from(radius) * f64::from(radius);
    let root = (b * b - 4.0 * a * c).sqrt();
    let roots = [(-b - root) / (2.0 * a), (-b + root) / (2.0 * a)];
    let is_kept = |t: f64| {
        let p = line.0 + t * line.1;
        let inside = p.z >= f64::from(z_min) && p.z <= f64::from(z_max);
        inside && p.y.atan2(p.x).rem_euclid(TAU) <= f64::from(phi_max)
    };
    let finite = roots.into_iter().filter(|t| t.is_finite());
    finite.map(|t| (t, is_kept(t))).collect()
}

/// True if a surface point moves in or out of the kept part with a change of `1e-4`.
fn is_near_a_cut(primitive: &Primitive, o: DVec3, d: DVec3) -> bool {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let mut shifts = axes.into_iter().flat_map(|axis| [axis, -axis]);
    let kept = |o: DVec3| {
        passages(primitive, o, d)
            .iter()
            .map(|p| p.1)
            .collect::<Vec<_>>()
    };
    let here = kept(o);
    shifts.any(|shift| kept(o + 1e-4 * shift) != here)
}

#[track_caller]
fn check_against_formula(make: fn(&mut Random) -> Primitive) {
    let mut random = Random(30);
    let (mut hits, mut misses) = (0, 0);
    for _ in 0..300 {
        let primitive = make(&mut random);
        let bvh = build(&[primitive]);
        let to_local = local_from_world(&primitive);
        let bounds = bvh.bounds();
        for _ in 0..200 {
            let origin = 2.0 * random.cube();
            let aim = bounds.min + bounds.extent() * (0.5 + 0.6 * random.cube());
            let ray = Ray::new(origin, aim - origin);
            let o = to_local(ray.origin.as_dvec3());
            let d = to_local(ray.origin.as_dvec3() + ray.direction.as_dvec3()) - o;
            if is_near_a_cut(&primitive, o, d) {
                continue;
            }
            let found = passages(&primitive, o, d);
            let expected = found
                .iter()
                .find(|(t, kept)| *kept && *t >= 0.0)
                .map(|p| p.0);
            let hit = bvh.closest(&ray, accept_all);
            assert_eq!(hit.is_some(), expected.is_some(), "{primitive:?} {ray:?}");
            if let (Some(hit), Some(t)) = (hit, expected) {
                hits += 1;
                assert!(
                    (f64::from(hit.t) - t).abs() <= 1e-6 * t + 1e-9,
                    "{hit:?} {t}"
                );
                let at = local_point(&primitive, &hit);
                // Near a pole the polar angle needs more digits than `v` has.
                assert!(at.distance(o + t * d) < 1e-6, "{primitive:?} {hit:?}");
                assert!((0.0..=1.0).contains(&hit.u) && (0.0..=1.0).contains(&hit.v));
            } else {
                misses += 1;
            }
        }
    }
    assert!(
        hits > 10_000 && misses > 5_000,
        "{hits} hits, {misses} misses"
    );
}

#[test]
fn spheres_agree_with_the_formula() {
    check_against_formula(sphere);
}

#[test]
fn disks_agree_with_the_formula() {
    check_against_formula(disk);
}

#[test]
fn cylinders_agree_with_the_formula() {
    check_against_formula(cylinder);
}

/// The azimuth of a whole turn.
const WHOLE: f32 = std::f32::consts::TAU;

fn sphere_of(radius: f32, [z_min, z_max]: [f32; 2], phi_max: f32) -> Sphere {
    Sphere {
        local_from_world: Affine3A::IDENTITY,
        radius,
        z_min,
        z_max,
        phi_max,
    }
}

fn disk_of(radius: f32, inner_radius: f32, phi_max: f32) -> Disk {
    Disk {
        local_from_world: Affine3A::IDENTITY,
        height: 0.0,
        radius,
        inner_radius,
        phi_max,
    }
}

fn cylinder_of(radius: f32, [z_min, z_max]: [f32; 2], phi_max: f32) -> Primitive {
    Primitive::Cylinder(Cylinder {
        local_from_world: Affine3A::IDENTITY,
        radius,
        z_min,
        z_max,
        phi_max,
    })
}

/// A ray along the axis meets nothing, on the surface or off it.
#[test]
fn a_cylinder_has_no_caps() {
    let bvh = build(&[cylinder_of(1.0, [-1.0, 1.0], WHOLE)]);
    for x in [0.0, 0.5, 1.0, 2.0] {
        let ray = Ray::new(Vec3::new(x, 0.0, 3.0), -Vec3::Z);
        assert_eq!(bvh.closest(&ray, accept_all), None, "{x}");
    }
    let ray = Ray::new(Vec3::new(0.0, 0.0, 3.0), Vec3::new(1.0, 0.0, -2.5));
    assert!(bvh.closest(&ray, accept_all).is_some());
}

/// The distance and the parameters of a ray that meets nothing.
const MISS: [f32; 3] = [f32::NAN; 3];

/// Each row: origin, direction, and `t`, `u`, `v` of the hit.
#[track_caller]
fn check_hits(primitive: Primitive, rows: &[[[f32; 3]; 3]]) {
    let bvh = build(&[primitive]);
    for [origin, direction, expected] in rows.iter().map(|row| row.map(Vec3::from_array)) {
        let hit = bvh.closest(&Ray::new(origin, direction), accept_all);
        let found = hit.map_or(Vec3::NAN, |hit| Vec3::new(hit.t, hit.u, hit.v));
        let is_same = found.abs_diff_eq(expected, 1e-6) || found.is_nan() && expected.is_nan();
        assert!(is_same, "{origin} {direction}: {hit:?}, not {expected}");
    }
}

#[test]
fn conventions_of_the_sphere() {
    let whole = sphere_of(1.0, [-1.0, 1.0], WHOLE);
    check_hits(
        Primitive::Sphere(whole),
        &[
            [[3.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [2.0, 0.0, 0.5]],
            [[0.0, 3.0, 0.0], [0.0, -1.0, 0.0], [2.0, 0.25, 0.5]],
            [[0.0, -3.0, 0.0], [0.0, 1.0, 0.0], [2.0, 0.75, 0.5]],
            [[1e-9, 1e-9, 3.0], [0.0, 0.0, -1.0], [2.0, 0.125, 1.0]],
            [[1e-9, 1e-9, -3.0], [0.0, 0.0, 1.0], [2.0, 0.125, 0.0]],
            [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 0.0, 0.5]],
            [[3.0, 0.0, 0.0], [1.0, 0.0, 0.0], MISS],
        ],
    );
    // The upper half, seen through its open bottom, and a quarter around +x.
    let upper = Primitive::Sphere(sphere_of(1.0, [0.0, 1.0], WHOLE));
    check_hits(
        upper,
        &[[[0.0, 1e-9, -3.0], [0.0, 0.0, 1.0], [4.0, 0.25, 1.0]]],
    );
    check_hits(
        Primitive::Sphere(sphere_of(1.0, [-1.0, 1.0], 0.25 * WHOLE)),
        &[
            [[-3.0, 0.0, 0.0], [1.0, 0.0, 0.0], [4.0, 0.0, 0.5]],
            [
                [3.0, 3.0, 0.0],
                [-1.0, -1.0, 0.0],
                [3.0 - 0.5_f32.sqrt(), 0.5, 0.5],
            ],
        ],
    );
    // An ellipsoid three units long.
    let long = Primitive::Sphere(Sphere {
        local_from_world: Affine3A::from_scale(Vec3::new(1.0, 1.0, 3.0)).inverse(),
        ..whole
    });
    check_hits(
        long,
        &[[[1e-9, 0.0, 5.0], [0.0, 0.0, -1.0], [2.0, 0.0, 1.0]]],
    );
    let extent = build(&[long]).bounds().extent();
    assert!(
        extent.abs_diff_eq(Vec3::new(2.0, 2.0, 6.0), 1e-4),
        "{extent}"
    );
}

#[test]
fn conventions_of_the_disk() {
    let down = [0.0, 0.0, -1.0];
    check_hits(
        Primitive::Disk(disk_of(1.0, 0.0, WHOLE)),
        &[
            [[0.25, 0.0, 2.0], down, [2.0, 0.0, 0.75]],
            [[0.0, -1.0, 2.0], down, [2.0, 0.75, 0.0]],
            [[0.8, 0.8, 2.0], down, MISS],
            [[0.0; 3], [1.0, 0.0, 0.0], MISS],
            [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], MISS],
        ],
    );
    let ring = Primitive::Disk(Disk {
        height: 1.0,
        ..disk_of(1.0, 0.5, WHOLE)
    });
    check_hits(
        ring,
        &[
            [[0.0, 0.75, 2.0], down, [1.0, 0.25, 0.5]],
            [[0.25, 0.25, 2.0], down, MISS],
        ],
    );
}

#[test]
fn pointless_parameters_are_never_hit() {
    let spheres = [
        (0.0, [-1.0, 1.0], WHOLE),
        (-1.0, [-1.0, 1.0], WHOLE),
        (1.0, [0.5, 0.2], WHOLE),
        (1.0, [0.5, 0.5], WHOLE),
        (1.0, [2.0, 3.0], WHOLE),
        (1.0, [-1.0, 1.0], 0.0),
        (1.0, [-1.0, 1.0], -1.0),
    ];
    let disks = [
        (0.0, 0.0, WHOLE),
        (-1.0, 0.0, WHOLE),
        (1.0, 1.0, WHOLE),
        (1.0, 0.0, 0.0),
    ];
    let cylinders = [
        (0.0, [-1.0, 1.0], WHOLE),
        (1.0, [0.5, 0.5], WHOLE),
        (1.0, [-1.0, 1.0], 0.0),
    ];
    check_never_hit(spheres.map(|(r, z, phi)| Primitive::Sphere(sphere_of(r, z, phi))));
    check_never_hit(disks.map(|(r, inner, phi)| Primitive::Disk(disk_of(r, inner, phi))));
    check_never_hit(cylinders.map(|(r, z, phi)| cylinder_of(r, z, phi)));
}

#[track_caller]
fn check_never_hit(all: impl IntoIterator<Item = Primitive>) {
    let mut random = Random(31);
    for primitive in all {
        let bvh = build(&[primitive]);
        // Also rays through the axis and the cuts, where 0/0 lurks.
        for x in [0.0, 1.0, 0.5, 0.75_f32.sqrt(), random.unit()] {
            for ray in [
                Ray::new(Vec3::new(x, 0.0, 3.0), -Vec3::Z),
                Ray::new(Vec3::new(3.0, 0.0, x), -Vec3::X),
                Ray::new(Vec3::new(3.0, 0.0, x), Vec3::new(-3.0, 0.0, -x)),
            ] {
                assert_eq!(bvh.closest(&ray, accept_all), None, "{primitive:?}");
            }
        }
    }
}

#[test]
fn maps_must_be_invertible_and_finite() {
    let flat = Affine3A::from_mat3(Mat3::from_diagonal(Vec3::new(1.0, 1.0, 0.0)));
    let far = Affine3A::from_translation(Vec3::new(0.0, f32::INFINITY, 0.0));
    let (sphere, disk) = (sphere_of(1.0, [-1.0, 1.0], WHOLE), disk_of(1.0, 0.0, WHOLE));
    for local_from_world in [flat, far] {
        for bad in [
            Primitive::Sphere(Sphere {
                local_from_world,
                ..sphere
            }),
            Primitive::Disk(Disk {
                local_from_world,
                ..disk
            }),
        ] {
            let primitives = [Primitive::Sphere(sphere), bad];
            let error = Bvh::build(&primitives, &BuildOptions::default()).unwrap_err();
            assert_eq!(error, BuildError::NotFinite { primitive: 1 });
        }
    }
}

#[test]
fn bounds_contain_the_surface() {
    let mut random = Random(32);
    for _ in 0..500 {
        for make in [sphere, disk, cylinder] {
            let primitive = make(&mut random);
            let map = map_of(&primitive);
            let bounds = primitive.bounds();
            let matrix = Mat3::from(map.matrix3).as_dmat3().inverse();
            for _ in 0..50 {
                let (u, v) = (random.unit(), random.unit());
                let hit = Hit {
                    t: 0.0,
                    instance: 0,
                    primitive: 0,
                    u,
                    v,
                };
                let local = local_point(&primitive, &hit);
                let p = matrix * (local - Vec3::from(map.translation).as_dvec3());
                assert!(p.cmpge(bounds.min.as_dvec3()).all(), "{p} {bounds:?}");
                assert!(p.cmple(bounds.max.as_dvec3()).all(), "{p} {bounds:?}");
            }
        }
    }
}

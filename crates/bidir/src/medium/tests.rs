//! Grids: lines through them, integrals against sums over many points, and the inverse of the integral.

use super::cells::{CubeBox, Line};
use super::*;
use crate::math::Affine3A;
use crate::testing::prelude::{check_close, check_near, coefficients, smoke};
use accel::Ray;
use proptest::prelude::*;

fn vector(reach: f32) -> impl Strategy<Value = Vec3> {
    let number = -reach..reach;
    (number.clone(), number.clone(), number).prop_map(Vec3::from)
}

/// Returns directions of which some are along axes.
fn direction() -> impl Strategy<Value = Vec3> {
    let some = (vector(1.0), 0..8_u32).prop_map(|(w, axes)| {
        let keep = |axis: u32| if axes & 1 << axis == 0 { 1.0 } else { 0.0 };
        w * Vec3::new(keep(0), keep(1), keep(2))
    });
    some.prop_filter("a length", |w| w.length() > 0.1)
}

/// Returns a turned, stretched and shifted box.
fn place() -> Affine3A {
    let turned = Affine3A::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), 0.7);
    Affine3A::from_translation(Vec3::new(0.3, -0.2, 0.1))
        * turned
        * Affine3A::from_scale(Vec3::new(2.0, 1.5, 1.0))
}

/// Returns a grid with an empty corner of several blocks.
fn grid() -> Grid<1> {
    let size = [37, 20, 11];
    let at = |i: usize| [i % 37, i / 37 % 20, i / 740];
    let value = |[x, y, z]: [usize; 3]| match [x, y] {
        [..18, ..10] => 0.0,
        _ => ((x * 7 + y * 13 + z * 29) % 17) as f32 / 4.0,
    };
    let values = (0..37 * 20 * 11).map(|i| [value(at(i))]).collect();
    Grid::new(size, values, place()).expect("a grid")
}

/// Absorbs by 1, 0.5 and 2 per density and metre.
fn medium() -> Medium {
    smoke(
        coefficients([0.5, 0.25, 1.0], [0.5, 0.25, 1.0]),
        grid(),
        0.0,
    )
}

fn lanes(rgb: Rgb) -> Spectrum {
    Lanes::Rgb.unbounded(rgb)
}

fn stretch(ray: &Ray, range: [f32; 2]) -> Stretch<'_> {
    let unit = ray.direction.length();
    Stretch { ray, range, unit }
}

/// Returns ∫ of the density along a ray by the midpoints of many parts, with zero outside of the box.
fn sum(grid: &Grid<1>, ray: &Ray, [begin, end]: [f32; 2]) -> f64 {
    const PARTS: u32 = 20_000;
    let cube_from_world = place().inverse();
    let step = (end - begin) / PARTS as f32;
    let parts = (0..PARTS).map(|i| begin + (i as f32 + 0.5) * step);
    let density = |t: f32| {
        let p = ray.origin + ray.direction * t;
        let q = cube_from_world.transform_point3(p);
        let is_inside = q.cmpge(Vec3::ZERO).all() && q.cmple(Vec3::ONE).all();
        if is_inside { grid.at(p)[0] } else { 0.0 }
    };
    let total: f64 = parts.map(|t| f64::from(density(t))).sum();
    total * f64::from(step * ray.direction.length())
}

proptest! {
    #[test]
    fn cubes_of_a_line_lie_one_behind_the_other(
        origin in vector(12.0), direction in direction(), side in prop::sample::select(vec![1.0, 4.0])
    ) {
        let line = Line { origin, direction };
        let box_of_cubes = CubeBox { first: [-2; 3], last: [1, 2, 3] };
        let corner = |cube: [i32; 3]| Vec3::from_array(cube.map(|n| n as f32 * side));
        let faces = [corner([-2; 3]), corner([2, 3, 4])];
        let Some(range) = line.within(faces, [0.0, f32::INFINITY]) else {
            return Ok(());
        };
        let mut reached = range[0];
        for (cube, [begin, end]) in line.cubes(side, box_of_cubes, range) {
            prop_assert_eq!(begin.to_bits(), reached.to_bits());
            let low = corner(cube);
            let middle = line.at(0.5 * (begin + end));
            let slack = 1e-4 * side;
            prop_assert!(middle.cmpge(low - slack).all(), "{middle} in {low}");
            prop_assert!(middle.cmple(low + side + slack).all(), "{middle} in {low}");
            reached = end;
        }
        prop_assert_eq!(reached.to_bits(), range[1].to_bits());
    }

    #[test]
    fn depths_are_integrals(origin in vector(3.0), target in vector(1.0)) {
        let ray = Ray::new(origin, target - origin);
        let found = medium().depth(&stretch(&ray, [0.0, 2.0]), Detail::Full, lanes);
        let expected = sum(&grid(), &ray, [0.0, 2.0]);
        let error = (f64::from(found[0]) - expected).abs();
        prop_assert!(error <= 2e-3 * expected + 2e-3, "{} for {expected}", found[0]);
        prop_assert!((found[1] - 0.5 * found[0]).abs() <= 1e-4 * found[0]);
    }

    #[test]
    fn a_walk_stops_where_its_depth_is_reached(
        origin in vector(3.0), target in vector(1.0), part in 0.001_f32..0.999, lane in 0..3_usize
    ) {
        let ray = Ray::new(origin, (target - origin).normalize());
        let (medium, end) = (medium(), 8.0);
        let to = |t: f32| medium.depth(&stretch(&ray, [0.0, t]), Detail::Full, lanes);
        let whole = to(end);
        if whole[lane] == 0.0 {
            return Ok(());
        }
        let depth = part * whole[lane];
        let stopped = medium.fly(&stretch(&ray, [0.0, end]), Drawn { lane, depth }, lanes);
        let t = stopped.reached.expect("less than the whole depth was drawn");
        for found in [stopped.depth, to(t)] {
            // Places are known to a micrometre, and σ_t is up to 8 / m.
            prop_assert!((found[lane] - depth).abs() <= 1e-4 * whole[lane] + 1e-5);
        }
        let past = Drawn { lane, depth: 1.001 * whole[lane] };
        let passed = medium.fly(&stretch(&ray, [0.0, end]), past, lanes);
        prop_assert_eq!(passed.reached, None);
        prop_assert!((passed.depth[lane] - whole[lane]).abs() <= 1e-5 * whole[lane]);
    }
}

#[test]
fn one_cell_is_as_many_equal_cells() {
    let ray = Ray::new(Vec3::new(-3.0, 0.4, 0.2), Vec3::new(1.0, 0.1, 0.05));
    let depths = [1, 5, 32].map(|n| {
        let grid = Grid::new([n; 3], vec![[1.5]; n * n * n], place()).expect("a grid");
        let medium = smoke(coefficients([1.0; 3], [0.0; 3]), grid, 0.0);
        medium.depth(&stretch(&ray, [0.0, 10.0]), Detail::Full, lanes)[0]
    });
    assert!(depths[0] > 0.5);
    for depth in depths {
        check_close(depth, depths[0], 1e-5, "cells");
    }
}

#[test]
fn means_of_blocks_are_close_to_the_grid() {
    let medium = medium();
    let ray = Ray::new(Vec3::new(-3.0, 0.4, 0.2), Vec3::new(1.0, 0.1, 0.05));
    let of = |detail| medium.depth(&stretch(&ray, [0.0, 10.0]), detail, lanes)[0];
    check_close(of(Detail::Means), of(Detail::Full), 0.16, "means");
}

#[test]
fn grids_with_wrong_numbers_are_refused() {
    let new = |size, values| Grid::<1>::new(size, values, place());
    assert!(new([2, 1, 1], vec![[1.0]; 3]).is_none());
    assert!(new([0, 1, 1], vec![]).is_none());
    assert!(new([1, 1, 1], vec![[-1.0]]).is_none());
    assert!(new([1, 1, 1], vec![[f32::NAN]]).is_none());
    let flat = Affine3A::from_scale(Vec3::new(1.0, 0.0, 1.0));
    assert!(Grid::new([1; 3], vec![[1.0]], flat).is_none());
}

/// A mean over a cell is the mean of the points of a fine lattice in it, whose own error is below 1 %.
#[test]
fn means_of_cells_are_those_of_their_points() {
    let grid = grid();
    let means = grid.cell_means(|i| grid.values()[i][0]);
    let [nx, ny, nz] = grid.size();
    let largest = grid.most();
    let counts = Vec3::new(nx as f32, ny as f32, nz as f32);
    for [x, y, z] in [
        [0, 0, 0],
        [18, 10, 5],
        [36, 19, 10],
        [20, 0, 3],
        [17, 9, 10],
    ] {
        let values = (0..512).map(|i| {
            let part = [i & 7, i >> 3 & 7, i >> 6].map(|k| (k as f32 + 0.5) / 8.0);
            let at = Vec3::new(x as f32, y as f32, z as f32) + Vec3::from_array(part);
            grid.at(grid.world_from_cube().transform_point3(at / counts))[0]
        });
        let (found, expected) = (means[(z * ny + y) * nx + x], values.sum::<f32>() / 512.0);
        let bound = 0.01 * f64::from(largest);
        check_near(found, expected, bound, format!("{x} {y} {z}"));
    }
}

#[test]
fn light_that_is_none_or_too_much_is_refused() {
    let thick = coefficients([1e9; 3], [0.0; 3]);
    let phase = HenyeyGreenstein::new(0.0).unwrap();
    let medium = Medium::homogeneous(thick, phase);
    let glowing = |radiance: Rgb| medium.clone().glowing(Glow::Even(radiance.into()));
    for radiance in [[f32::NAN, 1.0, 1.0], [-1.0, 1.0, 1.0], [1e10; 3]] {
        assert!(glowing(radiance).is_none(), "{radiance:?}");
    }
    assert!(glowing([1.0, 0.0, 0.0]).unwrap().glows());
    assert!(!glowing([0.0; 3]).unwrap().glows());
    let light = Grid::new([1, 1, 2], vec![[1.0; 3]; 2], Affine3A::IDENTITY).unwrap();
    assert!(medium.clone().glowing(Glow::Grid(light.clone())).is_none());
    let of_density = |size: [usize; 3]| {
        let values = vec![[1.0]; size.iter().product()];
        let density = Grid::new(size, values, Affine3A::IDENTITY).unwrap();
        smoke(coefficients([1.0; 3], [0.0; 3]), density, 0.0)
    };
    let glow = || Glow::Grid(light.clone());
    assert!(of_density([1, 2, 1]).glowing(glow()).is_none());
    assert!(of_density([1, 1, 2]).glowing(glow()).is_some());
}

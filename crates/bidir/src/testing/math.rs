//! The machinery on densities that are known exactly: warps, distributions, the octahedral map.

use super::{Battery, Domain, Grid, samples};
use crate::math::{
    Distribution1d, Distribution2d, Frame, INV_PI, PI, Vec2, Vec3, direction_to_square,
    square_to_direction, warp,
};
use crate::sampler::{Dimension, Purpose};

const N: u64 = 1 << 20;

/// Adds the test that `warp` draws by `pdf` over `domain`.
fn add(
    battery: &mut Battery,
    name: &str,
    domain: Domain,
    warp: impl Fn(Vec2) -> Vec3,
    pdf: impl Fn(Vec3) -> f32,
) {
    let grid = Grid {
        domain,
        columns: 20,
        rows: 24,
    };
    let draw = |u| Some(warp(u));
    let numbers = samples(name, N).map(|s| s.get_2d(Dimension::at(0, Purpose::Film)));
    battery.chi2(name, &grid, pdf, numbers.map(draw));
}

/// Returns a triangle's point as a point of the square: (b1, b2) to ((b1+b2)², b1/(b1+b2)), of even area.
fn triangle_to_square(b: Vec2) -> Vec3 {
    let sum = b.x + b.y;
    Vec3::new(sum * sum, if sum > 0.0 { b.x / sum } else { 0.0 }, 0.0)
}

#[test]
fn warps_follow_their_densities() {
    let around_z = |height| Domain::Cone(Frame::from_z(Vec3::Z), height);
    let mut battery = Battery::new("warps");
    add(
        &mut battery,
        "disk",
        Domain::Disk(1.0),
        |u| warp::concentric_disk(u).extend(0.0),
        |_| INV_PI,
    );
    add(
        &mut battery,
        "cosine hemisphere",
        Domain::sphere(),
        warp::cosine_hemisphere,
        |w| warp::cosine_hemisphere_pdf(w.z),
    );
    add(
        &mut battery,
        "sphere",
        Domain::sphere(),
        warp::uniform_sphere,
        |_| INV_PI / 4.0,
    );
    for height in [1e-5, 0.3, 1.7] {
        let pdf = 1.0 / (2.0 * PI * height);
        let name = format!("cone of height {height}");
        add(
            &mut battery,
            &name,
            around_z(height),
            |u| warp::uniform_cone(u, height),
            |_| pdf,
        );
    }
    add(
        &mut battery,
        "triangle",
        Domain::Square,
        |u| triangle_to_square(warp::triangle(u)),
        |_| 1.0,
    );
    battery.check();
}

#[test]
fn the_octahedral_map_keeps_areas_both_ways() {
    let mut battery = Battery::new("octahedral map");
    add(
        &mut battery,
        "to the sphere",
        Domain::sphere(),
        square_to_direction,
        |_| INV_PI / 4.0,
    );
    let to_square = |u| direction_to_square(warp::uniform_sphere(u)).extend(0.0);
    add(
        &mut battery,
        "to the square",
        Domain::Square,
        to_square,
        |_| 1.0,
    );
    battery.check();
}

#[test]
fn distributions_follow_their_densities() {
    let mut battery = Battery::new("distributions");
    let weights = [0.0, 3.0, 0.0, 1.0, 10.0, 0.01, 2.0, 0.0];
    let line = Distribution1d::new(weights);
    let on_line = |u: Vec2| Vec3::new(line.sample_continuous(u.x).0, u.y, 0.0);
    add(&mut battery, "line", Domain::Square, on_line, |p| {
        line.pdf(p.x)
    });
    let weights: Vec<f32> = (0..35u16)
        .map(|i| f32::from(i * i % 11) * f32::from(i % 7))
        .collect();
    let square = Distribution2d::new(&weights, 5);
    let in_square = |u| square.sample(u).0.extend(0.0);
    add(&mut battery, "square", Domain::Square, in_square, |p| {
        square.pdf(p.truncate())
    });
    let black = Distribution2d::new(&[0.0; 12], 4);
    let in_black = |u| black.sample(u).0.extend(0.0);
    add(
        &mut battery,
        "square of nothing",
        Domain::Square,
        in_black,
        |p| black.pdf(p.truncate()),
    );
    battery.check();
}

/// A density that is wrong by two per cent on one half fails; the same one, right, does not.
#[test]
fn a_bias_of_the_density_itself_is_noticed() {
    let grid = Grid {
        domain: Domain::sphere(),
        columns: 20,
        rows: 40,
    };
    let p_value = |pdf: &dyn Fn(Vec3) -> f32| {
        let numbers = samples("bias", N).map(|s| s.get_2d(Dimension::at(0, Purpose::Film)));
        let observed = grid.histogram(numbers.map(|u| Some(warp::cosine_hemisphere(u))));
        super::chi2::p_value(&observed, &grid.expected(pdf, N))
    };
    let right = |w: Vec3| warp::cosine_hemisphere_pdf(w.z);
    assert!(p_value(&right) > 1e-3);
    assert!(p_value(&|w| right(w) * if w.x > 0.0 { 1.02 } else { 0.98 }) < 1e-6);
    // Not renormalised: the sum of what is expected differs from the number of samples.
    assert!(p_value(&|w| right(w) * if w.x > 0.0 { 1.02 } else { 1.0 }) < 1e-3);
}

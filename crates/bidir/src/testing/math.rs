//! The machinery on densities that are known exactly: warps, distributions, the octahedral map.

use super::{Battery, Domain, Grid, samples};
use crate::math::{
    Distribution1d, Distribution2d, Frame, INV_PI, PI, Vec2, Vec3, direction_to_square,
    square_to_direction, warp,
};
use crate::sampler::{Dimension, Purpose};

const N: u64 = 1 << 20;

type Warp<'a> = &'a dyn Fn(Vec2) -> Vec3;
type Density<'a> = &'a dyn Fn(Vec3) -> f32;

/// Checks that each warp draws by its density over its domain.
#[track_caller]
fn check(battery: &'static str, cases: &[(&str, Domain, Warp<'_>, Density<'_>)]) {
    let mut battery = Battery::new(battery);
    for &(name, domain, warp, pdf) in cases {
        let numbers = samples(name, N).map(|s| s.get_2d(Dimension::at(0, Purpose::Film)));
        let draws = numbers.map(|u| Some(warp(u)));
        battery.chi2(name, &Grid::new(domain, [20, 24]), pdf, draws);
    }
    battery.check();
}

/// Returns a triangle's point as a point of the square: (b1, b2) to ((b1+b2)², b1/(b1+b2)), of even area.
fn triangle_to_square(b: Vec2) -> Vec3 {
    let sum = b.x + b.y;
    Vec3::new(sum * sum, if sum > 0.0 { b.x / sum } else { 0.0 }, 0.0)
}

#[test]
fn warps_follow_their_densities() {
    let around_z = |height| Domain::Cone(Frame::from_z(Vec3::Z), height);
    let (square, sphere) = (Domain::Square, Domain::sphere());
    let disk: Warp<'_> = &|u| warp::concentric_disk(u).extend(0.0);
    let cosine: Density<'_> = &|w| warp::cosine_hemisphere_pdf(w.z);
    let triangle: Warp<'_> = &|u| triangle_to_square(warp::triangle(u));
    check(
        "warps",
        &[
            ("disk", Domain::Disk(1.0), disk, &|_| INV_PI),
            (
                "cosine hemisphere",
                sphere,
                &warp::cosine_hemisphere,
                cosine,
            ),
            ("sphere", sphere, &warp::uniform_sphere, &|_| INV_PI / 4.0),
            ("triangle", square, triangle, &|_| 1.0),
        ],
    );
    for height in [1e-5, 0.3, 1.7] {
        let (pdf, name) = (1.0 / (2.0 * PI * height), format!("height {height}"));
        let cone: Warp<'_> = &|u| warp::uniform_cone(u, height);
        check("cones", &[(&name, around_z(height), cone, &|_| pdf)]);
    }
}

#[test]
fn the_octahedral_map_keeps_areas_both_ways() {
    let to_square: Warp<'_> = &|u| direction_to_square(warp::uniform_sphere(u)).extend(0.0);
    let (square, sphere) = (Domain::Square, Domain::sphere());
    check(
        "octahedral map",
        &[
            ("to the sphere", sphere, &square_to_direction, &|_| {
                INV_PI / 4.0
            }),
            ("to the square", square, to_square, &|_| 1.0),
        ],
    );
}

#[test]
fn distributions_follow_their_densities() {
    let line = Distribution1d::new([0.0, 3.0, 0.0, 1.0, 10.0, 0.01, 2.0, 0.0]);
    let on_line = |u: Vec2| Vec3::new(line.sample_continuous(u.x).0, u.y, 0.0);
    let weights = (0..35u16).map(|i| f32::from(i * i % 11) * f32::from(i % 7));
    let uneven = Distribution2d::new(&weights.collect::<Vec<_>>(), 5);
    let black = Distribution2d::new(&[0.0; 12], 4);
    let [in_uneven, in_black] = [&uneven, &black].map(|of| move |u| of.sample(u).0.extend(0.0));
    let square = Domain::Square;
    check(
        "distributions",
        &[
            ("line", square, &on_line, &|p| line.pdf(p.x)),
            ("square", square, &in_uneven, &|p| uneven.pdf(p.truncate())),
            ("square of nothing", square, &in_black, &|p| {
                black.pdf(p.truncate())
            }),
        ],
    );
}

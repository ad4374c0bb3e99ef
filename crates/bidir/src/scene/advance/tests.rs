//! Collisions are as likely as weights take them to be, and as closed forms say.

use super::*;
use crate::medium::{Grid as Cells, Medium};
use crate::sampler::SampleStream;
use crate::scene::Edge;
use crate::scene::passage::Crossing;
use crate::spectrum::Rgb;
use crate::testing::{Domain, Grid, prelude::*};
use accel::Stop;
use std::sync::atomic::AtomicBool;

/// How far collisions are counted, from `START` along +z. Unit: m.
const REACH: f32 = 6.0;
const START: Vec3 = Vec3::new(0.1, -0.2, -3.0);

const AROUND: [Rgb; 2] = [[0.02, 0.05, 0.0], [0.1, 0.2, 0.4]];
const INSIDE: [Rgb; 2] = [[0.1, 0.0, 0.3], [1.5, 0.4, 0.1]];

/// Returns a scene in one medium.
fn filled(medium: Medium) -> (ShotBuilder, MediumId) {
    let mut builder = builder(1, 0.0);
    let around = builder.fill(medium);
    (builder, around)
}

fn fog() -> (ShotBuilder, MediumId) {
    filled(medium(AROUND[0], AROUND[1], 0.3))
}

/// Fog around a ball of another medium.
fn ball_in_fog() -> Scene {
    let (mut builder, outside) = fog();
    let inside = builder.medium(medium(INSIDE[0], INSIDE[1], 0.3));
    builder.bound(sphere(Vec3::ZERO, 1.0), outside, inside);
    builder.build().scene
}

/// Smoke in cells of a box around the origin, without a boundary.
fn cells() -> Scene {
    let size = [4, 4, 8];
    let value = |i: usize| [((i * 7 + i / 16 * 2) % 9) as f32 / 3.0];
    let place =
        Affine3A::from_translation(Vec3::splat(-2.0)) * Affine3A::from_scale(Vec3::splat(4.0));
    let cells = Cells::new(size, (0..128).map(value).collect(), place).expect("a grid");
    let smoke = smoke(coefficients(INSIDE[0], INSIDE[1]), cells, 0.3);
    filled(smoke).0.build().scene
}

/// Returns the place of a collision as a part of `REACH`. None: there is none up to there.
fn collision(scene: &Scene, stream: &SampleStream) -> Option<Vec3> {
    let ray = Ray::new(START, Vec3::Z);
    let chances = RayDraws::new(stream, 1);
    let advance = scene.advance(&ray, scene.medium_at(START), chances, Lanes::Rgb);
    let Interaction::Medium(locus, _) = advance.interaction else {
        return None;
    };
    let part = (locus.point.z - START.z) / REACH;
    (part < 1.0).then_some(Vec3::new(part, 0.5, 0.0))
}

/// Returns the density of collisions `t` from the start, as weights find it. Unit: 1/m.
fn density(scene: &Scene, t: f32) -> f32 {
    let medium = MediumSides::all(scene.medium_at(START));
    let start = Locus::in_space(START).within(medium);
    let point = START + Vec3::Z * t;
    let here = scene.medium_at(point);
    let bounds = scene.medium(here).and_then(Medium::bounds);
    if bounds.is_some_and(|b| point.clamp(b.min, b.max) != point) {
        return 0.0;
    }
    let end = Locus::in_medium(point, here);
    let edge = scene.edge([&start, &end], Lanes::Rgb, Stop::NEVER);
    edge.map_or(0.0, |edge| edge.to_b)
}

/// Nothing arrives by a ray that nobody waits for, and a walk ends where its ray began.
#[test]
fn stopped_rays_go_through_no_media() {
    let (scene, flag) = (ball_in_fog(), AtomicBool::new(true));
    let ends = [START, -START].map(Locus::in_space);
    let edge = |stop| scene.edge([&ends[0], &ends[1]], Lanes::Rgb, stop);
    assert!(edge(Stop::NEVER).is_some() && edge(Stop::when(&flag)).is_none());
}

#[test]
fn collisions_follow_their_density() {
    let grid = Grid::new(Domain::Square, [96, 1]);
    let mut battery = Battery::new("distances in media");
    let even = fog().0.build().scene;
    for (case, scene) in [
        ("even", even),
        ("a ball in fog", ball_in_fog()),
        ("cells", cells()),
    ] {
        let pdf = |p: Vec3| density(&scene, p.x * REACH) * REACH;
        let draws = samples(case, 1 << 20).map(|stream| collision(&scene, &stream));
        battery.chi2(case, &grid, pdf, draws);
    }
    battery.check();
}

/// Lanes are drawn evenly: p(t) is the mean of σ_t exp(-τ(t)).
#[test]
fn densities_are_those_of_closed_forms() {
    let scene = ball_in_fog();
    let half = libm::sqrtf(1.0 - START.truncate().length_squared());
    let (enter, leave) = (3.0 - half, 3.0 + half);
    for t in [0.5_f32, 1.9, 2.5, 3.6, 4.5, 5.9] {
        let within = t.clamp(enter, leave) - enter;
        let lanes = (0..3).map(|lane| {
            let [outside, inside] = [AROUND, INSIDE].map(|[a, s]| a[lane] + s[lane]);
            let is_inside = t > enter && t < leave;
            let here = if is_inside { inside } else { outside };
            here * libm::expf(-outside * (t - within) - inside * within)
        });
        let expected = lanes.sum::<f32>() / 3.0;
        check_close(density(&scene, t), expected, 1e-4, format!("t = {t}"));
    }
}

/// The intersector reports hits in any order, which depends on its instructions.
#[test]
fn boundaries_in_one_place_have_one_order() {
    let crossing = |primitive: u32| Crossing {
        t: 1.0,
        leaves: false,
        surface: (0, primitive),
        from: MediumId::VACUUM,
        into: MediumId::new(primitive as usize).expect("few media"),
    };
    let [a, b] = [3, 5].map(crossing);
    for order in [[a, b], [b, a]] {
        let crossings = &mut order.into_iter().collect();
        let last = Passage::new(MediumId::VACUUM, crossings, 2.0).last();
        assert_eq!(last, b.into);
    }
}

/// A guess stands where nothing was crossed, and the medium is the same everywhere and not too thick.
#[test]
fn right_guesses_are_known_as_such() {
    let even = || fog().0.build().scene;
    let (side, end) = (Vec3::X * 2.0, -START);
    for (case, scene, [from, to], expected) in [
        ("fog", even(), [START, end], true),
        ("thick fog", even(), [START, START + Vec3::Z * 20.0], false),
        (
            "past a ball",
            ball_in_fog(),
            [START + side, end + side],
            true,
        ),
        ("into a ball", ball_in_fog(), [START, Vec3::ZERO], false),
        ("through a ball", ball_in_fog(), [START, end], false),
        (
            "in a ball",
            ball_in_fog(),
            [Vec3::Z * -0.1, Vec3::Z * 0.2],
            true,
        ),
        ("smoke", cells(), [Vec3::ZERO, Vec3::Z], false),
    ] {
        let [a, b] = [from, to].map(|point| Locus::in_medium(point, scene.medium_at(point)));
        let (ends, lanes) = ([&a, &b], Lanes::Rgb);
        let edge = scene.edge(ends, lanes, Stop::NEVER);
        let edge = edge.expect("nothing is opaque");
        assert_eq!(edge.is_guessed, expected, "{case}");
        let guess = scene.guessed_edge(&a, &b, lanes);
        let numbers = |edge: &Edge| {
            let [r, g, b] = [0, 1, 2].map(|lane| edge.transmittance[lane]);
            [r, g, b, edge.to_b, edge.to_a].map(f32::to_bits)
        };
        assert_eq!(numbers(&edge) == numbers(&guess), expected, "{case}");
    }
}

//! Participating media: images that are known, and estimators that agree.

mod closed_forms;
mod glow;

use crate::common::prelude::*;
use bidir::driver::Stop;
use bidir::light::{Light, SpotLight};
use bidir::locus::Locus;
use bidir::medium::{Grid, Medium, MediumId, MediumSides};
use bidir::select::ShadowRays;
use bidir::spectrum::Lanes;
use bidir::texture::FloatTexture;

/// The film's mean and its quarters.
const QUARTERS: &[usize] = &[WHOLE, 4];
const VACUUM: MediumId = MediumId::VACUUM;

/// A grid of `n`³ cells between two corners, with a density that is a function of the numbers of a cell.
fn grid(n: usize, [low, high]: [Vec3; 2], density: impl Fn([usize; 3]) -> f32) -> Grid<1> {
    let place = Affine3A::from_translation(low) * Affine3A::from_scale(high - low);
    let at = |i: usize| [i % n, i / n % n, i / (n * n)];
    let values = (0..n * n * n).map(|i| [density(at(i))]).collect();
    Grid::new([n; 3], values, place).expect("a grid")
}

/// Puffs, with nothing between some of them.
fn puffs([x, y, z]: [usize; 3]) -> f32 {
    ((x * 5 + y * 3 + z * 7) % 6) as f32 * f32::from(u8::from(x > 3 || y > 5))
}

/// Absorbs a little, scatters more, and the more so the bluer the light.
fn fog() -> Medium {
    medium([0.02, 0.05, 0.1], [0.1, 0.2, 0.4], 0.5)
}

/// The inside of a sphere that reflects half of what it receives and emits the rest.
fn furnace() -> ShotBuilder {
    let mut builder = builder(8, 0.0);
    let wall = builder.material(diffuse([0.5; 3]));
    let inside = Sphere::new(Affine3A::IDENTITY, 2.0, Orientation::Reversed);
    builder.shape(Shape::Sphere(inside), wall, emission([0.5; 3]));
    builder
}

fn furnace_full_of(g: f32) -> Shot {
    let mut builder = furnace();
    builder.fill(medium([0.0; 3], [0.2, 0.5, 1.0], g));
    builder.build()
}

/// Three balls, one in the other, that absorb nothing.
fn nested_furnace() -> Shot {
    let mut builder = furnace();
    let thin = builder.medium(medium([0.0; 3], [0.3, 0.4, 0.5], 0.0));
    let thick = builder.medium(medium([0.0; 3], [2.0, 1.0, 0.5], 0.6));
    builder.bound(sphere(Vec3::ZERO, 1.6), VACUUM, thin);
    builder.bound(sphere(Vec3::ZERO, 1.0), thin, thick);
    builder.bound(sphere(Vec3::ZERO, 0.5), thick, thin);
    builder.build()
}

/// Puffs of smoke that absorb nothing, in a box without a boundary.
fn furnace_with_smoke() -> Shot {
    let mut builder = furnace();
    fill_with_smoke(&mut builder);
    builder.build()
}

/// The same under nothing but a sky.
fn smoke_under_sky() -> Shot {
    let mut builder = builder(8, 0.0);
    builder.sky([1.0; 3]);
    fill_with_smoke(&mut builder);
    builder.build()
}

fn fill_with_smoke(builder: &mut ShotBuilder) {
    let corners = [Vec3::splat(-1.0), Vec3::splat(1.0)];
    let density = grid(10, corners, puffs);
    builder.fill(smoke(coefficients([0.0; 3], [0.2, 0.4, 0.8]), density, 0.4));
}

#[track_caller]
fn check_is(name: &str, result: &Replicates, expected: [f64; 3]) {
    check_agree(name, result, &result.exactly(expected), QUARTERS);
}

#[track_caller]
fn check_furnace(name: &str, shot: &Shot, integrator: IntegratorKind, passes: u64) {
    let result = replicates(shot, &settings(integrator, None), passes);
    check_is(&format!("{name}, {integrator}"), &result, [1.0; 3]);
}

#[test]
fn a_furnace_full_of_fog_that_absorbs_nothing_has_radiance_one() {
    for integrator in [IntegratorKind::Path, IntegratorKind::Bdpt] {
        check_furnace("forward", &furnace_full_of(0.8), integrator, 2048);
    }
}

#[test]
fn nested_media_that_absorb_nothing_are_not_seen_in_a_furnace() {
    for integrator in [IntegratorKind::Path, IntegratorKind::Lvc] {
        check_furnace("nested", &nested_furnace(), integrator, 2048);
    }
}

#[test]
fn smoke_that_absorbs_nothing_is_not_seen_in_a_furnace() {
    for integrator in [IntegratorKind::Path, IntegratorKind::Bdpt] {
        check_furnace("smoke", &furnace_with_smoke(), integrator, 2048);
        check_furnace("sky", &smoke_under_sky(), integrator, 2048);
    }
}

fn ground() -> Shape {
    quad(Vec3::new(-6.0, -1.2, -6.0), Vec3::Z * 12.0, Vec3::X * 12.0)
}

#[test]
fn light_from_infinity_does_not_pass_a_medium_without_end() {
    let mut builder = builder(8, 0.0);
    builder.add(ground(), diffuse([0.5; 3]));
    builder.sky([1.0; 3]);
    // Two lanes are clear.
    builder.fill(medium([0.0, 0.0, 1.0], [0.0; 3], 0.0));
    let shot = builder.build();
    for integrator in METHODS {
        let result = replicates(&shot, &settings(integrator, Some(3)), 32);
        assert!(result.mean().abs() <= 0.0, "{integrator}");
    }
}

/// The tangent of half the field of view of the camera before a slab.
const HALF_FIELD: f32 = 0.05;

/// The front at z = 0 and the back at z = 1, which face outwards.
fn sides_of_slab() -> [Shape; 2] {
    let [across, up] = [Vec3::X, Vec3::Y].map(|axis| axis * 10.0);
    let corner = |z| Vec3::new(-5.0, -5.0, z);
    [quad(corner(0.0), up, across), quad(corner(1.0), across, up)]
}

/// A lamp behind one metre of `liquid`, which only absorbs.
fn slab(liquid: Medium) -> Shot {
    let camera = narrow_camera(Vec3::new(0.0, 0.0, -3.0), 8, HALF_FIELD);
    let mut builder = ShotBuilder::new(camera, 8);
    let black = builder.material(diffuse([0.0; 3]));
    let lamp = quad(Vec3::new(-1.0, -1.0, 3.0), Vec3::Y * 2.0, Vec3::X * 2.0);
    builder.shape(lamp, black, emission([1.0; 3]));
    let inside = builder.medium(liquid);
    for side in sides_of_slab() {
        builder.bound(side, VACUUM, inside);
    }
    builder.build()
}

/// The mean of exp(-τ / cosθ) over the film, as Beer and Lambert have it.
fn behind_slab(depth: f64) -> f64 {
    const STEPS: usize = 32;
    let at = |i: usize| f64::from(HALF_FIELD) * (i as f64 + 0.5) / STEPS as f64;
    let places = (0..STEPS).flat_map(|i| (0..STEPS).map(move |j| [at(i), at(j)]));
    let arriving = places.map(|[x, y]| libm::exp(-depth * (1.0 + x * x + y * y).sqrt()));
    arriving.sum::<f64>() / (STEPS * STEPS) as f64
}

#[track_caller]
fn check_slab(integrator: IntegratorKind, passes: u64) {
    let expected = [1.0, 0.5, 2.0].map(behind_slab);
    let coefficients = coefficients([1.0, 0.5, 2.0], [0.0; 3]);
    let around = [Vec3::splat(-6.0), Vec3::splat(6.0)];
    let cells = |n| smoke(coefficients, grid(n, around, |_| 1.0), 0.0);
    let liquids = [
        ("liquid", Medium::homogeneous(coefficients, phase(0.0))),
        ("one cell", cells(1)),
        ("32³ cells", cells(32)),
    ];
    for (name, liquid) in liquids {
        let result = replicates(&slab(liquid), &settings(integrator, Some(3)), passes);
        check_is(&format!("{name}, {integrator}"), &result, expected);
    }
}

#[test]
fn a_slab_lets_through_an_exponential_of_its_depth() {
    check_slab(IntegratorKind::Path, 4096);
    check_slab(IntegratorKind::Bdpt, 4096);
}

/// A front of which one half is there, and behind it one metre of a medium up to an open boundary.
#[test]
fn light_that_passes_a_hole_in_a_boundary_is_in_the_medium_behind_it() {
    let mut builder = builder(8, 0.0);
    let inside = builder.medium(medium([1.0; 3], [0.0; 3], 0.0));
    let outside = VACUUM;
    let [front, back] = sides_of_slab();
    let front = builder.add(front, diffuse([0.5; 3]));
    builder.sides(front, MediumSides { outside, inside });
    builder.alpha(front, FloatTexture::Constant(0.5));
    builder.bound(back, outside, inside);
    let scene = builder.build().scene;
    let [near, far] = [-1.0, 2.0].map(|z| Locus::in_space(Vec3::new(0.1, 0.2, z)));
    for (a, b) in [(&near, &far), (&far, &near)] {
        let edge = scene.edge([a, b], Lanes::Rgb, Stop::NEVER);
        let arrives = edge.expect("half of the light passes").transmittance[0];
        assert!((arrives - 0.5 * libm::expf(-1.0)).abs() < 1e-4, "{arrives}");
    }
}

/// A room with a lamp in the ceiling.
fn room() -> ShotBuilder {
    let mut builder = builder(8, 0.0);
    add_lit_walls(&mut builder, diffuse([0.7, 0.6, 0.5]));
    builder
}

fn foggy_room() -> Shot {
    let mut builder = room();
    builder.fill(fog());
    builder.build()
}

/// Checks that estimators agree with bidirectional path tracing of so many passes.
#[track_caller]
fn check_estimators(
    name: &str,
    shot: &Shot,
    passes: u64,
    others: &[(IntegratorKind, ShadowRays, u64)],
) {
    let bdpt = replicates(shot, &settings(IntegratorKind::Bdpt, Some(5)), passes);
    for &(integrator, shadow_rays, passes) in others {
        let mut settings = settings(integrator, Some(5));
        settings.shadow_rays = shadow_rays;
        let other = replicates(shot, &settings, passes);
        let name = format!("{name}: {integrator} by {shadow_rays}");
        check_agree(&name, &other, &bdpt, QUARTERS);
    }
}

#[test]
fn estimators_agree_in_a_room_full_of_fog() {
    let others = [
        (IntegratorKind::Lvc, ShadowRays::Budget(2), 1024),
        (IntegratorKind::Bdpt, ShadowRays::PerPair, 1536),
    ];
    check_estimators("fog", &foggy_room(), 1024, &others);
}

/// Comparisons that need millions of samples.
mod statistics {
    use super::*;

    use IntegratorKind::{Bdpt, Light as Tracer, Lvc, Path};
    use ShadowRays::{All, Budget, PerLightVertex, PerPair, RayRoulette};

    #[test]
    #[ignore = "statistics: .ci/run statistics"]
    fn every_estimator_knows_fog_in_a_furnace() {
        for (name, g) in [("backward", -0.5), ("isotropic", 0.0), ("forward", 0.8)] {
            let shot = furnace_full_of(g);
            check_furnace(name, &shot, Path, 16384);
            check_furnace(name, &shot, Bdpt, 4096);
            check_furnace(name, &shot, Lvc, 4096);
        }
        check_furnace("nested", &nested_furnace(), Bdpt, 2048);
        check_furnace("smoke", &furnace_with_smoke(), Lvc, 4096);
        check_furnace("sky", &smoke_under_sky(), Lvc, 4096);
    }

    #[test]
    #[ignore = "statistics: .ci/run statistics"]
    fn the_light_tracer_knows_media() {
        check_slab(Tracer, 131072);
        check_slab(Lvc, 8192);
    }

    #[test]
    #[ignore = "statistics: .ci/run statistics"]
    fn the_path_tracer_and_all_rules_agree_in_fog() {
        let others = [
            (Path, All, 8192),
            (Lvc, All, 2048),
            (Bdpt, Budget(2), 2048),
            (Bdpt, RayRoulette(0.1), 2048),
            (Bdpt, PerLightVertex, 2048),
        ];
        check_estimators("fog", &foggy_room(), 2048, &others);
    }

    /// The lamp stands in a bubble: without it, next-event estimation would have no variance.
    #[test]
    #[ignore = "statistics: .ci/run statistics"]
    fn estimators_agree_on_a_spot_light_in_fog() {
        let mut builder = builder(8, 0.0);
        let wall = builder.material(diffuse([0.7, 0.6, 0.5]));
        add_walls(&mut builder, wall);
        let lamp = Vec3::new(-1.0, 1.0, 0.5);
        let axis = Vec3::new(1.0, -0.8, 0.2).normalize();
        let angles = [20.0, 30.0].map(f32::to_radians);
        let spot = SpotLight::new(lamp, axis, [20.0, 25.0, 30.0], angles);
        builder.light(Light::Spot(spot));
        let around = builder.fill(fog());
        builder.bound(sphere(lamp, 0.3), around, VACUUM);
        let others = [(Path, All, 40960), (Lvc, Budget(2), 4096)];
        check_estimators("spot", &builder.build(), 4096, &others);
    }

    /// The camera is in no medium, so that light subpaths do not come near to it.
    #[test]
    #[ignore = "statistics: .ci/run statistics"]
    fn estimators_agree_on_rough_glass_full_of_ink() {
        let mut builder = room();
        let inside = builder.medium(medium([2.0, 0.5, 0.1], [0.2, 0.3, 0.4], -0.3));
        let ball = builder.add(sphere(Vec3::new(-0.4, -0.5, 0.7), 0.7), glass(0.4));
        let outside = VACUUM;
        builder.sides(ball, MediumSides { outside, inside });
        let others = [
            (Path, All, 16384),
            (Tracer, All, 16384),
            (Lvc, PerPair, 4096),
        ];
        check_estimators("ink", &builder.build(), 4096, &others);
    }

    #[test]
    #[ignore = "statistics: .ci/run statistics"]
    fn estimators_agree_on_a_cloud_under_a_sky() {
        let mut builder = builder(8, 0.0);
        builder.add(ground(), diffuse([0.5; 3]));
        builder.sky([1.0, 1.2, 1.5]);
        // Lanes of 1 : 4 : 16.
        let cloud = builder.medium(medium([0.02, 0.08, 0.32], [0.18, 0.72, 2.88], 0.3));
        let ball = sphere(Vec3::new(0.0, 0.1, 0.6), 0.8);
        builder.bound(ball, VACUUM, cloud);
        let others = [(Path, All, 2048), (Lvc, Budget(2), 2048)];
        check_estimators("cloud", &builder.build(), 2048, &others);
    }

    #[test]
    #[ignore = "statistics: .ci/run statistics"]
    fn estimators_agree_on_smoke_between_lamp_and_wall() {
        let mut builder = room();
        let corners = [Vec3::new(-0.9, -0.2, -0.6), Vec3::new(0.8, 1.2, 1.1)];
        let light = coefficients([0.02, 0.05, 0.1], [0.2, 0.4, 0.8]);
        builder.fill(smoke(light, grid(10, corners, puffs), 0.4));
        let others = [
            (Path, All, 4096),
            (Tracer, All, 8192),
            (Lvc, Budget(2), 2048),
            (Bdpt, PerPair, 2048),
            (Bdpt, RayRoulette(0.1), 2048),
        ];
        check_estimators("smoke", &builder.build(), 2048, &others);
    }

    #[test]
    #[ignore = "statistics: .ci/run statistics"]
    fn estimators_agree_with_the_camera_and_a_lamp_in_media_of_their_own() {
        let mut builder = room();
        let (camera, lamp) = (Vec3::new(0.0, 0.0, -1.8), Vec3::new(0.8, -0.4, 0.8));
        let near = medium([0.1, 0.2, 0.3], [0.4; 3], 0.7);
        for (centre, radius, inside) in [(camera, 0.15, near), (lamp, 0.7, fog())] {
            let inside = builder.medium(inside);
            builder.bound(sphere(centre, radius), VACUUM, inside);
        }
        let material = builder.material(diffuse([0.3; 3]));
        builder.shape(sphere(lamp, 0.2), material, emission([9.0, 8.0, 7.0]));
        let others = [(Path, All, 4096), (Lvc, PerPair, 2048)];
        check_estimators("islands", &builder.build(), 2048, &others);
    }
}

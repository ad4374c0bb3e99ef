//! Media that glow: in equilibrium with a sky, along a line, and as the only light of a room.

use super::{VACUUM, check_furnace, grid, puffs};
use crate::common::prelude::*;
use bidir::medium::{Glow, Grid, Medium};

fn glowing(medium: Medium, glow: Glow) -> Medium {
    medium
        .glowing(glow)
        .expect("light that can be computed with")
}

/// Puffs of smoke with an even L_e.
fn glowing_puffs(absorption: Rgb, scattering: Rgb) -> Medium {
    let corners = [Vec3::splat(-1.0), Vec3::splat(1.0)];
    let density = grid(10, corners, puffs);
    let smoke = smoke(coefficients(absorption, scattering), density, 0.4);
    glowing(smoke, Glow::Even([1.0; 3].into()))
}

/// Matter as bright as the sky around it: where L_e and the sky are 1, so is radiance everywhere.
fn equilibrium(matter: Medium) -> Shot {
    let mut builder = builder(8, 0.0);
    builder.sky([1.0; 3]);
    builder.fill(matter);
    builder.build()
}

/// A grey ball of glowing fog, seen from the vacuum, on a sky of its own brightness.
fn ball_of_fog() -> Shot {
    let mut builder = builder(8, 0.0);
    builder.sky([1.0; 3]);
    let fog = medium([0.4, 0.2, 0.1], [0.3, 0.5, 1.0], 0.3);
    let inside = builder.medium(glowing(fog, Glow::Even([1.0; 3].into())));
    builder.bound(sphere(Vec3::Z * 2.5, 1.0), VACUUM, inside);
    builder.build()
}

#[test]
fn matter_in_equilibrium_is_not_seen() {
    for integrator in FROM_THE_CAMERA {
        let smoke = glowing_puffs([0.2, 0.4, 0.6], [0.6, 0.3, 0.0]);
        check_furnace("puffs", &equilibrium(smoke), integrator, 1024);
        check_furnace("fog", &ball_of_fog(), integrator, 1024);
    }
}

/// A ball of radius 1 before a camera that sees nothing but its middle.
fn ball_ahead(inside: Medium) -> Shot {
    let camera = narrow_camera(Vec3::new(0.0, 0.0, -3.0), 4, 0.01);
    let mut builder = ShotBuilder::new(camera, 4);
    let inside = builder.medium(inside);
    builder.bound(sphere(Vec3::ZERO, 1.0), VACUUM, inside);
    builder.build()
}

/// L_e (1 - exp(-2 σ_a)) along the diameter; the sights of the film differ from it by 1e-4.
#[test]
fn a_ball_that_only_absorbs_and_glows_has_the_radiance_of_its_diameter() {
    let absorption: Rgb = [0.1, 0.5, 2.0];
    let radiance: Rgb = [3.0, 1.0, 0.5];
    let fire = glowing(
        medium(absorption, [0.0; 3], 0.0),
        Glow::Even(radiance.into()),
    );
    let shot = ball_ahead(fire);
    let expected = std::array::from_fn(|i| {
        f64::from(radiance[i]) * -libm::expm1(-2.0 * f64::from(absorption[i]))
    });
    for integrator in FROM_THE_CAMERA {
        let result = replicates(&shot, &settings(integrator, None), 4096);
        let name = format!("diameter, {integrator}");
        check_agree(&name, &result, &result.exactly(expected), &[WHOLE]);
    }
}

/// A fire in a corner of a room without another light: a grid with colours of its own, of which a ball holds a part.
fn room_with_fire() -> Shot {
    let mut builder = builder(8, 0.0);
    let white = builder.material(diffuse([0.7, 0.6, 0.5]));
    add_walls(&mut builder, white);
    let corners = [Vec3::new(-0.8, -0.9, 0.6), Vec3::new(0.2, 0.5, 1.6)];
    let density = grid(6, corners, |[x, y, z]| ((x + 2 * y + z) % 4) as f32);
    let place =
        Affine3A::from_translation(corners[0]) * Affine3A::from_scale(corners[1] - corners[0]);
    let color = |i: usize| [(i % 5) as f32, (i % 3) as f32, (i % 2) as f32];
    let radiance = Grid::new([6; 3], (0..216).map(color).collect(), place).expect("a grid");
    let smoke = smoke(coefficients([0.5, 0.8, 1.0], [0.5; 3]), density, 0.2);
    let fire = builder.medium(glowing(smoke, Glow::Grid(radiance)));
    builder.bound(sphere(Vec3::new(-0.2, -0.3, 1.2), 0.5), VACUUM, fire);
    builder.build()
}

#[test]
#[ignore = "statistics: .ci/run statistics"]
fn estimators_agree_in_a_room_with_a_fire() {
    let shot = room_with_fire();
    let path = replicates(&shot, &settings(IntegratorKind::Path, Some(2)), 16384);
    for integrator in &METHODS[1..] {
        let other = replicates(&shot, &settings(*integrator, Some(2)), 16384);
        check_agree(&format!("fire, {integrator}"), &other, &path, &[WHOLE]);
    }
}

//! Blind spots against what the estimators make of small scenes.

use super::*;
use crate::material::ScaledFloat;
use crate::medium::{Glow, MediumId};
use crate::testing::prelude::*;

/// Balls of materials, and lights, before a camera of one pixel.
pub(super) fn shot(materials: &[Material], lights: Vec<Light>) -> Shot {
    let mut builder = builder(1, 0.0);
    for material in materials {
        builder.add(sphere(Vec3::ZERO, 1.0), material.clone());
    }
    // A material of no surface does not count.
    builder.material(Material::ThinDielectric { eta: 1.5.into() });
    for light in lights {
        builder.light(light);
    }
    builder.build()
}

pub(super) fn grey() -> Material {
    diffuse([0.5; 3])
}

pub(super) fn point() -> Light {
    point_light(Vec3::ZERO)
}

pub(super) fn even_sky() -> Light {
    sky([1.0; 3])
}

/// The blind spots of an estimator.
fn spots(shot: &Shot, integrator: IntegratorKind) -> Vec<BlindSpot> {
    blind_spots(&shot.scene, &shot.view, integrator)
}

#[test]
fn where_nothing_is_specular_all_is_seen() {
    let shot = shot(&[grey(), metal(0.2)], vec![point(), even_sky()]);
    for (_, integrator) in IntegratorKind::NAMES {
        assert_eq!(spots(&shot, integrator), []);
    }
}

#[test]
fn lights_that_rays_hit_are_noisy_where_others_are_missing() {
    use BlindSpot::{
        Caustics, CausticsSeenBySpecular, ChanceCaustics, ChanceCausticsSeenBySpecular,
        SeenBySpecular,
    };
    let both = shot(&[grey(), metal(0.0)], vec![point(), even_sky()]);
    let of = |integrator| spots(&both, integrator);
    assert_eq!(of(IntegratorKind::Path), [Caustics, ChanceCaustics]);
    assert_eq!(of(IntegratorKind::Light), [SeenBySpecular]);
    let bidirectional = [CausticsSeenBySpecular, ChanceCausticsSeenBySpecular];
    assert_eq!(of(IntegratorKind::Bdpt), bidirectional);
    let lit_by_sky = shot(&[metal(0.0)], vec![even_sky()]);
    let found = spots(&lit_by_sky, IntegratorKind::Bdpt);
    assert_eq!(found, [ChanceCausticsSeenBySpecular]);
    assert!(Caustics.is_missing() && !ChanceCaustics.is_missing());
}

/// Returns a medium without a boundary around everything, which glows.
fn endless_glow() -> Shot {
    let mut builder = builder(1, 0.0);
    let gas = medium([0.1; 3], [0.1; 3], 0.0);
    let gas = builder.fill(gas.glowing(Glow::Even([1.0; 3].into())).unwrap());
    builder.bound(sphere(Vec3::ZERO, 0.2), gas, MediumId::VACUUM);
    builder.build()
}

#[test]
fn light_without_an_end_is_found_by_camera_walks_alone() {
    let shot = endless_glow();
    let found = spots(&shot, IntegratorKind::Light);
    assert_eq!(found, [BlindSpot::EndlessGlow]);
    assert_eq!(spots(&shot, IntegratorKind::Bdpt), []);
    let settings = PathSettings {
        strategies: "all,-s0".parse().unwrap(),
        ..PathSettings::default()
    };
    let lost = lost_light(&shot.scene, &shot.view, IntegratorKind::Bdpt, &settings);
    assert!(matches!(lost, Some(LostLight::Lengths(_))), "{lost:?}");
}

#[test]
fn what_is_rarely_specular_is_a_blind_spot() {
    let mixed = mix([grey(), metal(0.0)], 1e-3);
    // A clear coat over a tenth of a rough surface, whose lobe is drawn about once in forty times.
    let coated = principled(|material| material.coat = ScaledFloat::constant(0.1));
    for material in [coated, mixed] {
        let shot = shot(&[grey(), material], vec![point()]);
        assert_eq!(spots(&shot, IntegratorKind::Path), [BlindSpot::Caustics]);
    }
}

#[test]
fn light_is_missing_where_paths_are_long_enough_for_it() {
    let shot = shot(&[grey(), metal(0.0)], vec![point(), even_sky()]);
    let of = |integrator, depth| {
        let settings = PathSettings {
            max_depth: Some(depth),
            ..PathSettings::default()
        };
        missing_light(&shot.scene, &shot.view, integrator, &settings)
    };
    // L S D E has two scattering events.
    assert_eq!(of(IntegratorKind::Path, 1), []);
    assert_eq!(of(IntegratorKind::Path, 2), [BlindSpot::Caustics]);
    assert_eq!(of(IntegratorKind::Light, 0), []);
    assert_eq!(of(IntegratorKind::Light, 1), [BlindSpot::SeenBySpecular]);
    let concerned = |spot: BlindSpot| [point(), even_sky()].map(|light| spot.concerns(&light));
    assert_eq!(concerned(BlindSpot::Caustics), [true, false]);
    assert_eq!(concerned(BlindSpot::ChanceCaustics), [false, true]);
    assert_eq!(concerned(BlindSpot::Sky), [false, true]);
}

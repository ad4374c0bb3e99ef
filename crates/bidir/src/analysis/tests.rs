//! Blind spots against what the estimators make of small scenes.

use super::*;
use crate::bsdf::FacetScattering;
use crate::film::{FilmSettings, Filter};
use crate::light::{InfiniteLight, PointLight};
use crate::material::{ConductorIndex, Mixture, PrincipledMaterial, Roughness, ScaledFloat};
use crate::math::{Affine3A, Vec3};
use crate::medium::{Coefficients, Glow, HenyeyGreenstein, Medium, MediumId, MediumSides};
use crate::scene::SceneBuilder;
use crate::shape::{Orientation, Shape, Sphere};
use crate::texture::{ColorTexture, FloatTexture};
use std::sync::Arc;

pub(super) fn scene(materials: &[Material], lights: Vec<Light>) -> Scene {
    let mut builder = SceneBuilder::new();
    for material in materials {
        let material = builder.material(material.clone());
        let ball = Sphere::new(Affine3A::IDENTITY, 1.0, Orientation::Natural);
        builder.shape(Shape::Sphere(ball), material, None);
    }
    // A material of no surface does not count.
    builder.material(Material::ThinDielectric { eta: 1.5 });
    for light in lights {
        builder.light(light);
    }
    builder.build().unwrap()
}

/// Returns a pixel that sees it.
pub(super) fn view() -> View {
    crate::testing::view(FilmSettings::new([1, 1], Filter::default()))
}

pub(super) fn diffuse() -> Material {
    Material::Diffuse {
        reflectance: ColorTexture::Constant([0.5; 3]),
    }
}

pub(super) fn metal(roughness: f32) -> Material {
    Material::Conductor {
        index: ConductorIndex::Reflectance(ColorTexture::Constant([0.9; 3])),
        scattering: FacetScattering::Single,
        roughness: Roughness {
            u: FloatTexture::Constant(roughness),
            v: FloatTexture::Constant(roughness),
            ..Roughness::SMOOTH
        },
    }
}

pub(super) fn point() -> Light {
    Light::Point(PointLight {
        position: Vec3::ZERO,
        intensity: [1.0; 3],
    })
}

pub(super) fn sky() -> Light {
    Light::Infinite(InfiniteLight::constant([1.0; 3]))
}

#[test]
fn where_nothing_is_specular_all_is_seen() {
    let scene = scene(&[diffuse(), metal(0.2)], vec![point(), sky()]);
    for (_, integrator) in IntegratorKind::NAMES {
        assert_eq!(blind_spots(&scene, &view(), integrator), []);
    }
}

#[test]
fn lights_that_rays_hit_are_noisy_where_others_are_missing() {
    use BlindSpot::{
        Caustics, CausticsSeenBySpecular, ChanceCaustics, ChanceCausticsSeenBySpecular,
        SeenBySpecular,
    };
    let both = scene(&[diffuse(), metal(0.0)], vec![point(), sky()]);
    let of = |integrator| blind_spots(&both, &view(), integrator);
    assert_eq!(of(IntegratorKind::Path), [Caustics, ChanceCaustics]);
    assert_eq!(of(IntegratorKind::Light), [SeenBySpecular]);
    let bidirectional = [CausticsSeenBySpecular, ChanceCausticsSeenBySpecular];
    assert_eq!(of(IntegratorKind::Bdpt), bidirectional);
    let lit_by_sky = scene(&[metal(0.0)], vec![sky()]);
    assert_eq!(
        blind_spots(&lit_by_sky, &view(), IntegratorKind::Bdpt),
        [ChanceCausticsSeenBySpecular]
    );
    assert!(Caustics.is_missing() && !ChanceCaustics.is_missing());
}

/// Returns a clear coat over a tenth of a rough surface, whose lobe is drawn about once in forty times.
fn thinly_coated() -> Material {
    Material::Principled(Arc::new(PrincipledMaterial {
        coat: ScaledFloat::constant(0.1),
        ..PrincipledMaterial::default()
    }))
}

/// Returns a medium without a boundary around everything, which glows.
fn endless_glow() -> Scene {
    let mut builder = SceneBuilder::new();
    let coefficients = Coefficients::new([0.1; 3], [0.1; 3]).unwrap();
    let gas = Medium::homogeneous(coefficients, HenyeyGreenstein::new(0.0).unwrap());
    let gas = builder.medium(gas.glowing(Glow::Even([1.0; 3])).unwrap());
    builder.medium_at(Vec3::ZERO, gas);
    let ball = Sphere::new(Affine3A::IDENTITY, 0.2, Orientation::Natural);
    let media = MediumSides {
        outside: gas,
        inside: MediumId::VACUUM,
    };
    builder.boundary(Shape::Sphere(ball), media);
    builder.build().unwrap()
}

#[test]
fn light_without_an_end_is_found_by_camera_walks_alone() {
    let scene = endless_glow();
    let spots = |integrator| blind_spots(&scene, &view(), integrator);
    assert_eq!(spots(IntegratorKind::Light), [BlindSpot::EndlessGlow]);
    assert_eq!(spots(IntegratorKind::Bdpt), []);
    let settings = PathSettings {
        strategies: "all,-s0".parse().unwrap(),
        ..PathSettings::default()
    };
    let lost = lost_light(&scene, &view(), IntegratorKind::Bdpt, &settings);
    assert!(matches!(lost, Some(LostLight::Lengths(_))), "{lost:?}");
}

#[test]
fn what_is_rarely_specular_is_a_blind_spot() {
    let rarely = [diffuse(), metal(0.0)];
    let rarely = Mixture {
        materials: rarely,
        amount: FloatTexture::Constant(1e-3),
    };
    for material in [thinly_coated(), Material::Mix(rarely.into())] {
        let scene = scene(&[diffuse(), material], vec![point()]);
        let spots = blind_spots(&scene, &view(), IntegratorKind::Path);
        assert_eq!(spots, [BlindSpot::Caustics]);
    }
}

#[test]
fn light_is_missing_where_paths_are_long_enough_for_it() {
    let scene = scene(&[diffuse(), metal(0.0)], vec![point(), sky()]);
    let of = |integrator, depth| {
        let settings = PathSettings {
            max_depth: Some(depth),
            ..PathSettings::default()
        };
        missing_light(&scene, &view(), integrator, &settings)
    };
    // L S D E has two scattering events.
    assert_eq!(of(IntegratorKind::Path, 1), []);
    assert_eq!(of(IntegratorKind::Path, 2), [BlindSpot::Caustics]);
    assert_eq!(of(IntegratorKind::Light, 0), []);
    assert_eq!(of(IntegratorKind::Light, 1), [BlindSpot::SeenBySpecular]);
    let concerned = |spot: BlindSpot| [point(), sky()].map(|light| spot.concerns(&light));
    assert_eq!(concerned(BlindSpot::Caustics), [true, false]);
    assert_eq!(concerned(BlindSpot::ChanceCaustics), [false, true]);
    assert_eq!(concerned(BlindSpot::Sky), [false, true]);
}

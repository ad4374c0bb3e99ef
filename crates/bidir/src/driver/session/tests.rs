//! The meaning of lanes belongs to groups of samples, and only the edges of light transport know it.

use super::*;
use crate::bsdf::{FacetScattering, Wall};
use crate::film::{FilmSettings, Filter, Picture};
use crate::light::{EmissionSides, InfiniteLight, Light};
use crate::material::{
    CLEAR, CoatSettings, CoatedConductorMaterial, CoatedDiffuseMaterial, ConductorIndex, Material,
    PrincipledMaterial, Roughness, RoughnessMapping, ScaledColor, ScaledFloat,
};
use crate::math::{Affine3A, Vec3};
use crate::medium::{Coefficients, HenyeyGreenstein, Medium, MediumSides};
use crate::scene::{Emission, SceneBuilder};
use crate::shape::{Orientation, Shape, Sphere};
use crate::spectrum::Rgb;
use crate::spectrum::permuted::Order as LaneOrder;
use crate::testing;
use crate::texture::{ColorTexture, FloatTexture};
use std::sync::Arc;

/// The side of a film of 16 groups of shared light subpaths, or of four groups that share none.
const SIZE: u32 = 32;

/// Orders of lanes, one of which has no two lanes in a place that another has.
const ORDERS: [Lanes; 3] = [
    Lanes::Permuted(LaneOrder([3, 0, 1, 2])),
    Lanes::Permuted(LaneOrder([2, 3, 0, 1])),
    Lanes::Permuted(LaneOrder([1, 2, 3, 0])),
];

const METHODS: [IntegratorKind; 4] = [
    IntegratorKind::Path,
    IntegratorKind::Light,
    IntegratorKind::Bdpt,
    IntegratorKind::Lvc,
];

fn colour(rgb: Rgb) -> ColorTexture {
    ColorTexture::Constant(rgb)
}

fn roughness(alpha: f32) -> Roughness {
    let alpha = FloatTexture::Constant(alpha);
    Roughness {
        u: alpha.clone(),
        v: alpha,
        mapping: RoughnessMapping::Identity,
    }
}

fn coat(albedo: ColorTexture) -> CoatSettings {
    CoatSettings {
        eta: 1.5,
        roughness: roughness(0.2),
        thickness: FloatTexture::Constant(0.3),
        albedo,
        g: FloatTexture::Constant(0.0),
    }
}

fn principled() -> Material {
    Material::Principled(Arc::new(PrincipledMaterial {
        color: ScaledColor::constant([0.8, 0.5, 0.3]),
        metallic: ScaledFloat::constant(0.4),
        roughness: ScaledFloat::constant(0.5),
        specular_color: ScaledColor::constant([0.3, 0.9, 1.4]),
        transmission: ScaledFloat::constant(0.4),
        wall: Wall::Solid,
        diffuse_transmission: ScaledFloat::constant(0.3),
        diffuse_transmission_color: ScaledColor::constant([0.2, 0.9, 0.4]),
        coat: ScaledFloat::constant(0.7),
        sheen: ScaledColor::constant([0.1, 0.3, 0.5]),
        ..PrincipledMaterial::default()
    }))
}

/// A material of each kind that has a colour.
fn materials() -> [Material; 8] {
    let [copper, gold] = [[0.2, 0.9, 1.1], [3.9, 2.4, 2.1]].map(colour);
    let index = ConductorIndex::Complex {
        eta: copper,
        k: gold,
    };
    let scattering = FacetScattering::Multiple;
    let lacquered = coat(CLEAR);
    [
        Material::Conductor {
            index: index.clone(),
            roughness: roughness(0.4),
            scattering,
        },
        Material::Dielectric {
            eta: 1.5,
            roughness: roughness(0.0),
            scattering,
        },
        Material::Dielectric {
            eta: 1.5,
            roughness: roughness(0.3),
            scattering,
        },
        Material::DiffuseTransmission {
            reflectance: colour([0.5, 0.3, 0.2]),
            transmittance: colour([0.2, 0.4, 0.7]),
            scale: 0.9,
        },
        Material::CoatedDiffuse(CoatedDiffuseMaterial::new(
            coat(colour([0.3, 0.6, 0.9])),
            colour([0.7, 0.3, 0.1]),
        )),
        Material::CoatedConductor(CoatedConductorMaterial::new(
            lacquered,
            ConductorIndex::Reflectance(colour([0.9, 0.7, 0.4])),
            roughness(0.2),
        )),
        principled(),
        Material::Diffuse {
            reflectance: colour([0.9, 0.2, 0.5]),
        },
    ]
}

fn ball(centre: Vec3, radius: f32) -> Shape {
    let place = Affine3A::from_translation(centre);
    Shape::Sphere(Sphere::new(place, radius, Orientation::Natural))
}

fn medium(absorption: Rgb, scattering: Rgb) -> Medium {
    let coefficients = Coefficients::new(absorption, scattering).expect("valid coefficients");
    Medium::homogeneous(coefficients, HenyeyGreenstein::new(0.4).expect("a cosine"))
}

/// A large ball with a ball of each material in it, under a lamp and a sky that shines through holes of the large one;
/// in air, or in fog with a bubble of ink.
fn scene(fog: Option<[Rgb; 2]>) -> Scene {
    let mut builder = SceneBuilder::new();
    let wall = builder.material(Material::Diffuse {
        reflectance: colour([0.6, 0.7, 0.4]),
    });
    let room = builder.shape(ball(Vec3::ZERO, 8.0), wall, None);
    builder.coverage(room, FloatTexture::Constant(0.8));
    builder.light(Light::Infinite(InfiniteLight::constant([0.4, 0.8, 1.6])));
    let lamp = Emission {
        radiance: [9.0, 5.0, 2.0],
        pattern: None,
        sides: EmissionSides::Front,
    };
    builder.shape(ball(Vec3::new(0.0, 3.0, 3.0), 1.0), wall, Some(lamp));
    for (i, material) in (0u8..).zip(materials()) {
        let material = builder.material(material);
        let [row, column] = [i / 4, i % 4].map(f32::from);
        let centre = Vec3::new(1.6 * column - 2.4, 1.7 * row - 2.0, 5.0 - row);
        builder.shape(ball(centre, 0.7), material, None);
    }
    if let Some([absorption, scattering]) = fog {
        let outside = builder.medium(medium(absorption, scattering));
        let inside = builder.medium(medium(scattering, absorption));
        builder.medium_at(Vec3::ZERO, outside);
        let bubble = ball(Vec3::new(0.0, 1.0, 2.2), 0.6);
        builder.boundary(bubble, MediumSides { outside, inside });
    }
    builder.build().expect("the scene is valid")
}

fn scenes() -> [Scene; 2] {
    [None, Some([[0.02, 0.05, 0.0], [0.08, 0.02, 0.05]])].map(scene)
}

/// Starts a session whose groups have these lanes, one after another and over again.
fn session<'a>(scene: &'a Scene, integrator: IntegratorKind, lanes: &[Lanes]) -> Session<'a> {
    let view = testing::view(FilmSettings::new([SIZE; 2], Filter::default()));
    let settings = Settings {
        seed: 3,
        ..Settings::new(integrator)
    };
    let session = Session::new(scene, &view, settings, &Resources::default());
    Session {
        lanes: lanes.to_vec(),
        ..session.expect("a small film")
    }
}

fn picture(scene: &Scene, integrator: IntegratorKind, lanes: &[Lanes]) -> Picture {
    let mut session = session(scene, integrator, lanes);
    for _ in 0..2 {
        assert!(session.step(&()), "nobody stops it");
    }
    session.film().develop()
}

fn bits(picture: &Picture) -> Vec<[u32; 3]> {
    let pixels = picture.pixels.iter();
    pixels.map(|pixel| pixel.map(f32::to_bits)).collect()
}

/// Checks that pictures do not depend on the order of lanes.
#[track_caller]
fn check_pictures(lanes: &[Lanes]) {
    for scene in scenes() {
        for integrator in METHODS {
            let expected = picture(&scene, integrator, &[Lanes::Rgb]);
            let of_lanes = picture(&scene, integrator, lanes);
            let case = format!("{integrator}: {lanes:?}, media: {}", scene.has_media());
            assert_eq!(bits(&of_lanes), bits(&expected), "{case}");
        }
    }
}

#[test]
fn nothing_between_the_edges_knows_which_lane_is_which() {
    for lanes in ORDERS {
        check_pictures(&[lanes]);
    }
}

#[test]
fn groups_may_have_lanes_of_their_own() {
    check_pictures(&[Lanes::Rgb, ORDERS[0], ORDERS[1], ORDERS[2], Lanes::Rgb]);
}

/// A sample that is made again has the lanes of its group, with which it was made.
#[test]
fn replays_have_the_lanes_of_their_group() {
    let (scene, lanes) = (&scenes()[1], [ORDERS[1], Lanes::Rgb, ORDERS[2]]);
    for integrator in METHODS {
        let of_lanes = session(scene, integrator, &lanes);
        let rgb = session(scene, integrator, &[Lanes::Rgb]);
        let mut seen = Vec::new();
        for i in 0..24 {
            let pixel = [i * 13 % SIZE, i * 7 % SIZE];
            let [again, expected] = [&of_lanes, &rgb].map(|session| {
                let replay = session.replay(pixel, 1).expect("the pixel is in the film");
                seen.push(replay.lanes);
                replay.lanes.to_rgb(replay.value()).map(f32::to_bits)
            });
            assert_eq!(again, expected, "{integrator}, {pixel:?}");
        }
        assert!(lanes.iter().all(|lanes| seen.contains(lanes)));
    }
}

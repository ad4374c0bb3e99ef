//! The meaning of lanes belongs to groups of samples, and only the edges of light transport know their order.

use super::*;
use crate::bsdf::{FacetScattering, Thickness};
use crate::film::{Aov, FilmSettings, Filter, Layers};
use crate::light::{EmissionSides, InfiniteLight, Light};
use crate::material::{
    Bitangent, CoatSettings, CoatedConductorMaterial, CoatedDiffuseMaterial, ConductorIndex,
    Material, Mixture, NormalMap, PrincipledMaterial, Relief, Roughness, RoughnessMapping,
    ScaledColor, ScaledFloat,
};
use crate::math::{Affine3A, Vec3};
use crate::medium::{Coefficients, Glow, Grid, HenyeyGreenstein, Medium, MediumId, MediumSides};
use crate::scene::{Emission, SceneBuilder};
use crate::shape::{Orientation, Shape, Sphere};
use crate::spectrum::Rgb;
use crate::spectrum::permuted::Order as LaneOrder;
use crate::testing;
use crate::texture::{ColorTexture, FloatTexture};
use std::sync::Arc;

/// The side of a film of 16 groups of shared light subpaths, or of four groups that share none.
const SIZE: u32 = 32;

/// Orders of lanes. In each place they have different lanes, and none has that of `Lanes::Rgb`.
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
        thickness: Thickness::Solid,
        diffuse_transmission: ScaledFloat::constant(0.3),
        diffuse_transmission_color: ScaledColor::constant([0.2, 0.9, 0.4]),
        coat: ScaledFloat::constant(0.7),
        sheen: ScaledColor::constant([0.1, 0.3, 0.5]),
        ..PrincipledMaterial::default()
    }))
}

fn metals() -> [Material; 2] {
    let [eta, k] = [[0.2, 0.9, 1.1], [3.9, 2.4, 2.1]].map(colour);
    [
        Material::Conductor {
            index: ConductorIndex::Complex { eta, k },
            roughness: roughness(0.4),
            scattering: FacetScattering::Multiple,
        },
        Material::CoatedConductor(CoatedConductorMaterial::new(
            coat(colour([0.9, 0.2, 0.6])),
            ConductorIndex::Reflectance(colour([0.9, 0.7, 0.4])),
            roughness(0.2),
        )),
    ]
}

fn glass(alpha: f32) -> Material {
    Material::Dielectric {
        eta: 1.5,
        roughness: roughness(alpha),
        scattering: FacetScattering::Multiple,
    }
}

fn paper() -> Material {
    Material::DiffuseTransmission {
        reflectance: colour([0.5, 0.3, 0.2]),
        transmittance: colour([0.2, 0.4, 0.7]),
        scale: 0.9,
    }
}

/// Makes materials that scatter in different ways.
fn materials() -> [Material; 8] {
    let [metal, lacquered] = metals();
    let haze = coat(colour([0.3, 0.6, 0.9]));
    let varnished = CoatedDiffuseMaterial::new(haze, colour([0.7, 0.3, 0.1]));
    let mixed = Mixture {
        materials: [paper(), Material::ThinDielectric { eta: 1.5 }],
        amount: FloatTexture::Constant(0.4),
    };
    let slant = NormalMap {
        texture: colour([0.7, 0.4, 1.0]),
        scale: 1.0,
        bitangent: Bitangent::AlongV,
    };
    [
        metal.with_relief(Relief::NormalMap(slant)),
        glass(0.0),
        glass(0.3),
        Material::Mix(Arc::new(mixed)),
        Material::CoatedDiffuse(varnished),
        lacquered,
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

/// Fills the inside of a room with fog in which a ball of coloured smoke glows.
fn add_fog(builder: &mut SceneBuilder) {
    let phase = HenyeyGreenstein::new(0.4).expect("a cosine");
    let coefficients = Coefficients::new([0.02, 0.05, 0.0], [0.08, 0.02, 0.05]);
    let fog = Medium::homogeneous(coefficients.expect("valid coefficients"), phase);
    let corner = Affine3A::from_translation(Vec3::new(-0.8, 0.2, 1.4));
    let place = corner * Affine3A::from_scale(Vec3::splat(1.6));
    let grid = |scale: f32| {
        let value = |i: u8| [0.9, 0.3, 0.5].map(|part| scale * part * (1.0 + f32::from(i)));
        Grid::new([2; 3], (0..8).map(value).collect(), place).expect("a grid")
    };
    let dark = Medium::chromatic(grid(0.4), grid(0.2), phase).expect("smoke");
    let glowing = dark.glowing(Glow::Even([0.3, 0.1, 0.6]));
    let [fog, smoke] = [fog, glowing.expect("a glow")].map(|medium| builder.medium(medium));
    builder.medium_at(Vec3::ZERO, fog);
    let sides = |outside, inside| MediumSides { outside, inside };
    builder.boundary(ball(Vec3::ZERO, 7.0), sides(MediumId::VACUUM, fog));
    builder.boundary(ball(Vec3::new(0.0, 1.0, 2.2), 0.7), sides(fog, smoke));
}

/// Makes a large ball with a ball of each material in it, under a lamp, and under a sky that shines through holes of the
/// large one.
fn scene(add_media: impl Fn(&mut SceneBuilder)) -> Scene {
    let mut builder = SceneBuilder::new();
    let wall = builder.material(Material::Diffuse {
        reflectance: colour([0.6, 0.7, 0.4]),
    });
    let room = builder.shape(ball(Vec3::ZERO, 8.0), wall, None);
    builder.alpha(room, FloatTexture::Constant(0.8));
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
    add_media(&mut builder);
    builder.build().expect("the scene is valid")
}

fn scenes() -> [Scene; 2] {
    [scene(|_| {}), scene(add_fog)]
}

/// Starts a session that keeps such layers, and whose groups take these lanes in turn.
fn session<'a>(
    scene: &'a Scene,
    integrator: IntegratorKind,
    layers: Layers,
    lanes: &[Lanes],
) -> Session<'a> {
    let view = testing::view(FilmSettings::new([SIZE; 2], Filter::default()));
    let settings = Settings {
        seed: 3,
        layers,
        ..Settings::new(integrator)
    };
    let session = Session::new(scene, &view, settings, &Resources::default());
    Session {
        lanes: lanes.to_vec(),
        ..session.expect("a small film")
    }
}

/// Renders two passes, and returns the sums of the film.
fn sums(mut session: Session<'_>) -> Vec<i128> {
    for _ in 0..2 {
        assert!(session.step(&()), "nobody stops it");
    }
    let sums = session.film().sums();
    assert!(sums.iter().any(|&sum| sum != 0), "the film is black");
    sums.to_vec()
}

/// Checks that films have the same bits with these lanes.
#[track_caller]
fn check_films(lanes: &[Lanes]) {
    let layers = Layers::new(&[], &[], 4).with_raw();
    let features = Layers::new(&[Aov::Albedo], &[], 0);
    let kept = |layers: &Layers| METHODS.map(|integrator| (integrator, layers.clone()));
    let mut cases = Vec::from(kept(&layers));
    cases.push((IntegratorKind::Path, features));
    for scene in scenes() {
        for (integrator, layers) in &cases {
            let film = |lanes| sums(session(&scene, *integrator, layers.clone(), lanes));
            let case = format!("{integrator}: {lanes:?}, media: {}", scene.has_media());
            assert!(film(lanes) == film(&[Lanes::Rgb]), "{case}");
        }
    }
}

#[test]
fn nothing_between_the_edges_depends_on_the_order_of_lanes() {
    for lanes in ORDERS {
        check_films(&[lanes]);
    }
}

#[test]
fn groups_may_have_lanes_of_their_own() {
    check_films(&[Lanes::Rgb, ORDERS[0], ORDERS[1], ORDERS[2], Lanes::Rgb]);
}

/// Returns what a sample adds to its own pixel and to the light image.
fn added(replay: &Replay) -> Vec<[u32; 3]> {
    let splats = replay
        .splats()
        .map(|(contribution, _)| contribution.value());
    let all = std::iter::once(replay.value()).chain(splats);
    all.map(|value| replay.lanes.to_rgb(value).map(f32::to_bits))
        .collect()
}

/// A sample that is made again has the lanes of its group, with which it was made.
#[test]
fn replays_have_the_lanes_of_their_group() {
    let (scene, lanes) = (&scenes()[1], [ORDERS[1], Lanes::Rgb, ORDERS[2]]);
    for integrator in METHODS {
        let of = |lanes| session(scene, integrator, Layers::default(), lanes);
        let (of_lanes, rgb) = (of(&lanes), of(&[Lanes::Rgb]));
        let (mut seen, mut splats) = (Vec::new(), 0);
        for i in 0..24 {
            let pixel = [i * 13 % SIZE, i * 7 % SIZE];
            let replay =
                |session: &Session<'_>| session.replay(pixel, 1).expect("the pixel is there");
            let (again, expected) = (replay(&of_lanes), replay(&rgb));
            assert_eq!(added(&again), added(&expected), "{integrator}, {pixel:?}");
            seen.push(again.lanes);
            splats += again.splats().count();
        }
        assert!(lanes.iter().all(|lanes| seen.contains(lanes)));
        assert_eq!(
            splats > 0,
            integrator != IntegratorKind::Path,
            "{integrator}"
        );
    }
}

//! The meaning of lanes belongs to groups of samples, and only the edges of light transport know their order.

use super::*;
use crate::bsdf::{FacetScattering, Thickness};
use crate::film::{Aov, Layers};
use crate::material::{
    CoatSettings, CoatedConductorMaterial, CoatedDiffuseMaterial, ConductorIndex, Material, Relief,
    ScaledColor, ScaledFloat,
};
use crate::medium::{Glow, Grid, Medium, MediumId};
use crate::spectrum::Rgb;
use crate::spectrum::permuted::Order as LaneOrder;
use crate::testing::prelude::*;

/// The side of a film of 16 groups of shared light subpaths, or of four groups that share none.
const SIZE: u32 = 32;

/// Orders of lanes. In each place they have different lanes, and none has that of `Lanes::Rgb`.
const ORDERS: [Lanes; 3] = [
    Lanes::Permuted(LaneOrder([3, 0, 1, 2])),
    Lanes::Permuted(LaneOrder([2, 3, 0, 1])),
    Lanes::Permuted(LaneOrder([1, 2, 3, 0])),
];

/// Varnish or lacquer whose coat is a coloured haze.
fn haze(albedo: Rgb) -> CoatSettings {
    CoatSettings {
        albedo: ColorTexture::Constant(albedo),
        thickness: FloatTexture::Constant(0.3),
        ..coat(0.2)
    }
}

/// Every lobe of principled materials, in colours.
fn colourful() -> Material {
    principled(|material| {
        material.color = ScaledColor::constant([0.8, 0.5, 0.3]);
        material.metallic = ScaledFloat::constant(0.4);
        material.roughness = ScaledFloat::constant(0.5);
        material.specular_color = ScaledColor::constant([0.3, 0.9, 1.4]);
        material.transmission = ScaledFloat::constant(0.4);
        material.thickness = Thickness::Solid;
        material.diffuse_transmission = ScaledFloat::constant(0.3);
        material.diffuse_transmission_color = ScaledColor::constant([0.2, 0.9, 0.4]);
        material.coat = ScaledFloat::constant(0.7);
        material.sheen = ScaledColor::constant([0.1, 0.3, 0.5]);
    })
}

/// Makes materials that scatter in different ways.
fn materials() -> [Material; 8] {
    let [eta, k] = [[0.2, 0.9, 1.1], [3.9, 2.4, 2.1]].map(ColorTexture::Constant);
    let copper = Material::Conductor {
        index: ConductorIndex::Complex { eta, k },
        roughness: roughness(0.4),
        scattering: FacetScattering::Multiple,
    };
    let index = reflecting([0.9, 0.7, 0.4]);
    let lacquered = CoatedConductorMaterial::new(haze([0.9, 0.2, 0.6]), index, roughness(0.2));
    let base = ColorTexture::Constant([0.7, 0.3, 0.1]);
    let varnished = CoatedDiffuseMaterial::new(haze([0.3, 0.6, 0.9]), base);
    [
        copper.with_relief(Relief::NormalMap(slant(0.4, -0.2))),
        glass(0.0),
        glass(0.3),
        mix([paper(), Material::ThinDielectric { eta: 1.5.into() }], 0.4),
        Material::CoatedDiffuse(varnished),
        Material::CoatedConductor(lacquered),
        colourful(),
        diffuse([0.9, 0.2, 0.5]),
    ]
}

/// Fills the inside of a room with fog in which a ball of coloured smoke glows.
fn add_fog(builder: &mut ShotBuilder) {
    let fog = builder.fill(medium([0.02, 0.05, 0.0], [0.08, 0.02, 0.05], 0.4));
    let corner = Affine3A::from_translation(Vec3::new(-0.8, 0.2, 1.4));
    let place = corner * Affine3A::from_scale(Vec3::splat(1.6));
    let grid = |scale: f32| {
        let value = |i: u8| [0.9, 0.3, 0.5].map(|part| scale * part * (1.0 + f32::from(i)));
        Grid::new([2; 3], (0..8).map(value).collect(), place).expect("a grid")
    };
    let dark = Medium::chromatic(grid(0.4), grid(0.2), phase(0.4)).expect("smoke");
    let glowing = dark.glowing(Glow::Even([0.3, 0.1, 0.6].into()));
    let smoke = builder.medium(glowing.expect("a glow"));
    builder.bound(sphere(Vec3::ZERO, 7.0), MediumId::VACUUM, fog);
    builder.bound(sphere(Vec3::new(0.0, 1.0, 2.2), 0.7), fog, smoke);
}

/// Makes a large ball with a ball of each material in it, under a lamp, and under a sky that shines through holes of the
/// large one.
fn shot(add_media: impl Fn(&mut ShotBuilder)) -> Shot {
    let mut builder = ShotBuilder::new(narrow_camera(Vec3::ZERO, SIZE, 1.0), SIZE);
    let wall = builder.material(diffuse([0.6, 0.7, 0.4]));
    let room = builder.shape(sphere(Vec3::ZERO, 8.0), wall, None);
    builder.alpha(room, FloatTexture::Constant(0.8));
    builder.sky([0.4, 0.8, 1.6]);
    let lamp = sphere(Vec3::new(0.0, 3.0, 3.0), 1.0);
    builder.shape(lamp, wall, emission([9.0, 5.0, 2.0]));
    for (i, material) in (0u8..).zip(materials()) {
        let [row, column] = [i / 4, i % 4].map(f32::from);
        let centre = Vec3::new(1.6 * column - 2.4, 1.7 * row - 2.0, 5.0 - row);
        builder.add(sphere(centre, 0.7), material);
    }
    add_media(&mut builder);
    builder.build()
}

fn shots() -> [Shot; 2] {
    [shot(|_| {}), shot(add_fog)]
}

/// Starts a session that keeps such layers, and whose groups take these lanes in turn.
fn session<'a>(
    shot: &'a Shot,
    integrator: IntegratorKind,
    layers: Layers,
    lanes: &[Lanes],
) -> Session<'a> {
    let settings = Settings {
        seed: 3,
        layers,
        ..Settings::new(integrator)
    };
    Session {
        lanes: lanes.to_vec(),
        ..shot.session(settings, 0)
    }
}

/// Renders two passes, and returns the sums of the film.
fn sums(mut session: Session<'_>) -> Vec<i128> {
    steps(&mut session, 2);
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
    for shot in shots() {
        for (integrator, layers) in &cases {
            let film = |lanes| sums(session(&shot, *integrator, layers.clone(), lanes));
            let case = format!("{integrator}: {lanes:?}, media: {}", shot.has_media());
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
    let bits = |value| replay.lanes.to_rgb(value).map(f32::to_bits);
    all.map(bits).collect()
}

/// A sample that is made again has the lanes of its group, with which it was made.
#[test]
fn replays_have_the_lanes_of_their_group() {
    let (shot, lanes) = (&shots()[1], [ORDERS[1], Lanes::Rgb, ORDERS[2]]);
    for integrator in METHODS {
        let of = |lanes| session(shot, integrator, Layers::default(), lanes);
        let (of_lanes, rgb) = (of(&lanes), of(&[Lanes::Rgb]));
        let (mut seen, mut splats) = (Vec::new(), 0);
        for i in 0..24 {
            let pixel = [i * 13 % SIZE, i * 7 % SIZE];
            let replays = [&of_lanes, &rgb].map(|session| session.replay(pixel, 1));
            let [again, expected] = replays.map(|replay| replay.expect("the pixel is there"));
            assert_eq!(added(&again), added(&expected), "{integrator}, {pixel:?}");
            seen.push(again.lanes);
            splats += again.splats().count();
        }
        assert!(lanes.iter().all(|lanes| seen.contains(lanes)));
        let is_path = integrator == IntegratorKind::Path;
        assert_eq!(splats == 0, is_path, "{integrator}");
    }
}

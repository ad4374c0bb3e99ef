//! All estimators agree on every material: a floor and a ball of it in a closed room, with a ceiling
//! light and a small bright ball whose light the floor and the ball throw on as caustics.
//!
//! The Dirac lobe of a material, and its other lobes, have to count once in each.

use crate::common::prelude::*;
use bidir::material::Material;
use bidir::path::MisHeuristic;
use bidir::texture::TexturePoint;

/// The film's mean and its quarters.
const QUARTERS: &[usize] = &[WHOLE, 4];

fn scene(material: Material) -> Shot {
    let mut builder = builder(8, 0.0);
    let wall = add_lit_walls(&mut builder, diffuse([0.6, 0.5, 0.4]));
    let bulb = sphere(Vec3::new(0.9, -0.6, 0.9), 0.3);
    builder.shape(bulb, wall, emission([8.0, 10.0, 12.0]));
    let floor = quad(Vec3::new(-1.9, -1.3, -1.5), Vec3::Z * 3.3, Vec3::X * 3.8);
    builder.add(floor, material.clone());
    builder.add(sphere(Vec3::new(-0.5, -0.6, 0.9), 0.6), material);
    builder.build()
}

fn render(scene: &Shot, integrator: IntegratorKind, mis: MisHeuristic) -> Replicates {
    let mut settings = settings(integrator, Some(4));
    settings.path.mis = mis;
    let passes = match integrator {
        IntegratorKind::Path => 12288,
        IntegratorKind::Light => 5120,
        // Weights that do not look at densities leave the tails heavy.
        IntegratorKind::Bdpt if mis == MisHeuristic::Uniform => 12288,
        IntegratorKind::Bdpt | IntegratorKind::Lvc | IntegratorKind::Auto => 2048,
    };
    replicates(scene, &settings, passes)
}

/// The lobes of a material, which decide if the light tracer can see all of it.
#[derive(Clone, Copy, PartialEq)]
enum Lobes {
    /// None is a Dirac distribution.
    Finite,
    /// Some are: no light subpath finds the light that they show the lens.
    Dirac,
}

/// Every lobe has its turn under all that look at densities.
const ONE: &[MisHeuristic] = &[MisHeuristic::Balance];
const GOOD: &[MisHeuristic] = &[MisHeuristic::Balance, MisHeuristic::Power];

/// Compares the path tracer with the bidirectional one under each heuristic, and with the light
/// tracer where it can see all.
#[track_caller]
fn check(heuristics: &[MisHeuristic], material: Material, lobes: Lobes) {
    let name = material.kind();
    let scene = scene(material);
    let reference = render(&scene, IntegratorKind::Path, MisHeuristic::Balance);
    for &mis in heuristics {
        let (name, result) = (
            format!("{name}, {mis:?}"),
            render(&scene, IntegratorKind::Bdpt, mis),
        );
        check_agree(&name, &result, &reference, QUARTERS);
    }
    if lobes == Lobes::Finite {
        let light = render(&scene, IntegratorKind::Light, MisHeuristic::Balance);
        check_agree(&format!("{name}, light"), &light, &reference, QUARTERS);
    }
}

#[test]
fn a_smooth_varnish() {
    let all = MisHeuristic::NAMES.map(|(_, mis)| mis);
    check(&all, varnish(0.0), Lobes::Dirac);
}

#[test]
fn rough_layers() {
    check(GOOD, varnish(0.3), Lobes::Finite);
    check(GOOD, lacquer(0.3, 0.2), Lobes::Finite);
}

#[test]
fn a_smooth_lacquer_on_rough_metal() {
    check(GOOD, lacquer(0.0, 0.3), Lobes::Dirac);
}

#[test]
fn sheets_panes_and_bubbles() {
    check(
        GOOD,
        Material::ThinDielectric { eta: 1.5.into() },
        Lobes::Dirac,
    );
    check(GOOD, paper(), Lobes::Finite);
}

#[test]
fn mixtures_within_mixtures() {
    let rough = mix([metal(0.3), diffuse([0.2, 0.5, 0.8])], 0.3);
    check(GOOD, rough.clone(), Lobes::Finite);
    let smooth = mix([glass(0.0), varnish(0.0)], 0.6);
    check(GOOD, mix([rough, smooth], 0.5), Lobes::Dirac);
}

/// Rough lobes, and three Dirac lobes beside others: smooth coat and smooth glass over a base that is partly diffuse.
#[test]
fn principled_surfaces() {
    check(ONE, principled_rough(), Lobes::Finite);
    check(ONE, principled_smooth(), Lobes::Dirac);
}

/// Walks from a light draw no mirrored direction by a normal that only the camera sees; of rough glass the light
/// tracer alone is too noisy to tell.
#[test]
fn slanted_normals() {
    for material in [diffuse([0.8, 0.6, 0.4]), varnish(0.3), metal(0.3)] {
        check(ONE, slanted(material), Lobes::Finite);
    }
    for material in [metal(0.0), glass(0.0), glass(0.4), varnish(0.0)] {
        check(ONE, slanted(material), Lobes::Dirac);
    }
}

#[test]
fn a_coat_with_normals_of_its_own() {
    for map in [None, Some(slant(-0.5, 0.3))] {
        check(ONE, slanted(principled_layers(0.5, map)), Lobes::Finite);
    }
}

/// The albedo of a mixture's camera samples is the mean of its parts'.
#[test]
fn a_mixture_is_its_parts_in_the_given_shares() {
    let share = |amount: f32| {
        let black_or_white = mix([diffuse([0.0; 3]), diffuse([1.0; 3])], amount);
        let nested = mix([black_or_white, diffuse([0.0; 3])], 0.25);
        let n = 100_000;
        let white = (0..n).filter(|&i| {
            let u = (i as f32 + 0.5) / n as f32;
            let at = TexturePoint::of_parameters(Vec2::ZERO);
            let chosen = nested.choose(&at, || u);
            matches!(chosen, Material::Diffuse { reflectance }
                if reflectance.eval(&at)[0] > 0.5)
        });
        white.count() as f32 / n as f32
    };
    for amount in [0.0, 0.2, 0.7, 1.0] {
        assert!((share(amount) - 0.75 * amount).abs() < 1e-3, "{amount}");
    }
}

//! All estimators agree on every material: a floor and a ball of it in a closed room, with a ceiling
//! light and a small bright ball whose light the floor and the ball throw on as caustics.
//!
//! The Dirac lobe of a material, and its other lobes, have to count once in each.

use crate::common::Shot;
use crate::common::statistics::{Replicates, WHOLE, check_agree, replicates};
use crate::common::{
    add_walls, builder, diffuse, emission, glass, lacquer, metal, mix, paper, principled_layers,
    principled_rough, principled_smooth, quad, slant, slanted, sphere, varnish,
};
use bidir::driver::Settings;
use bidir::integrator::IntegratorKind;
use bidir::material::Material;
use bidir::math::{Vec2, Vec3};
use bidir::path::{MisHeuristic, PathSettings};
use bidir::shape::Shape;
use bidir::texture::TexturePoint;

/// The film's mean and its quarters.
const QUARTERS: &[usize] = &[WHOLE, 4];

fn scene(material: Material) -> Shot {
    let mut builder = builder(8, 0.0);
    let wall = builder.material(diffuse([0.6, 0.5, 0.4]));
    let material = builder.material(material);
    add_walls(&mut builder, wall);
    let light = quad(Vec3::new(-0.7, 1.9, -0.5), Vec3::X * 1.4, Vec3::Z);
    builder.shape(Shape::Mesh(light), wall, emission([6.0, 5.0, 4.0]));
    let bulb = sphere(Vec3::new(0.9, -0.6, 0.9), 0.3);
    builder.shape(bulb, wall, emission([8.0, 10.0, 12.0]));
    let floor = quad(Vec3::new(-1.9, -1.3, -1.5), Vec3::Z * 3.3, Vec3::X * 3.8);
    builder.shape(Shape::Mesh(floor), material, None);
    builder.shape(sphere(Vec3::new(-0.5, -0.6, 0.9), 0.6), material, None);
    builder.build().expect("the scene is valid")
}

fn render(scene: &Shot, integrator: IntegratorKind, mis: MisHeuristic) -> Replicates {
    let path = PathSettings {
        max_depth: Some(4),
        mis,
        ..PathSettings::default()
    };
    let settings = Settings {
        path,
        ..Settings::new(integrator)
    };
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

#[track_caller]
fn check(material: Material, lobes: Lobes) {
    let good = |(_, mis): &_| *mis != MisHeuristic::Uniform;
    check_under(
        material,
        lobes,
        MisHeuristic::NAMES.into_iter().filter(good),
    );
}

/// Compares the path tracer with the bidirectional one under each heuristic, and with the light
/// tracer where it can see all.
#[track_caller]
fn check_under(
    material: Material,
    lobes: Lobes,
    heuristics: impl Iterator<Item = (&'static str, MisHeuristic)>,
) {
    let name = material.kind();
    let scene = scene(material);
    let reference = render(&scene, IntegratorKind::Path, MisHeuristic::Balance);
    for (heuristic, mis) in heuristics {
        let result = render(&scene, IntegratorKind::Bdpt, mis);
        check_agree(
            &format!("{name}, {heuristic}"),
            &result,
            &reference,
            QUARTERS,
        );
    }
    if lobes == Lobes::Finite {
        let light = render(&scene, IntegratorKind::Light, MisHeuristic::Balance);
        check_agree(&format!("{name}, light"), &light, &reference, QUARTERS);
    }
}

#[test]
fn a_smooth_varnish() {
    check_under(varnish(0.0), Lobes::Dirac, MisHeuristic::NAMES.into_iter());
}

#[test]
fn a_rough_varnish() {
    check(varnish(0.3), Lobes::Finite);
}

#[test]
fn a_smooth_lacquer_on_rough_metal() {
    check(lacquer(0.0, 0.3), Lobes::Dirac);
}

#[test]
fn a_rough_lacquer() {
    check(lacquer(0.3, 0.2), Lobes::Finite);
}

#[test]
fn a_pane_and_a_bubble() {
    check(Material::ThinDielectric { eta: 1.5 }, Lobes::Dirac);
}

#[test]
fn diffuse_transmission() {
    check(paper(), Lobes::Finite);
}

#[test]
fn mixtures_within_mixtures() {
    let rough = mix([metal(0.3), diffuse([0.2, 0.5, 0.8])], 0.3);
    check(rough.clone(), Lobes::Finite);
    let smooth = mix([glass(0.0), varnish(0.0)], 0.6);
    check(mix([rough, smooth], 0.5), Lobes::Dirac);
}

/// Compares with the balance heuristic alone: every lobe has its turn in the other tests.
#[track_caller]
fn check_balance(material: Material, lobes: Lobes) {
    let balance = |(_, mis): &_| *mis == MisHeuristic::Balance;
    check_under(
        material,
        lobes,
        MisHeuristic::NAMES.into_iter().filter(balance),
    );
}

#[test]
fn a_principled_surface_of_rough_lobes() {
    check_balance(principled_rough(), Lobes::Finite);
}

/// Smooth coat and smooth glass over a base that is partly diffuse: three Dirac lobes beside others.
#[test]
fn a_principled_surface_of_smooth_lobes() {
    check_balance(principled_smooth(), Lobes::Dirac);
}

#[test]
fn slanted_normals() {
    for material in [diffuse([0.8, 0.6, 0.4]), varnish(0.3), metal(0.3)] {
        check_balance(slanted(material), Lobes::Finite);
    }
}

/// Walks from a light draw no mirrored direction by a normal that only the camera sees; of rough glass the light
/// tracer alone is too noisy to tell.
#[test]
fn slanted_mirrors_and_glass() {
    for material in [metal(0.0), glass(0.0), glass(0.4), varnish(0.0)] {
        check_balance(slanted(material), Lobes::Dirac);
    }
}

#[test]
fn a_coat_with_normals_of_its_own() {
    for map in [None, Some(slant(-0.5, 0.3))] {
        check_balance(slanted(principled_layers(0.5, map)), Lobes::Finite);
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

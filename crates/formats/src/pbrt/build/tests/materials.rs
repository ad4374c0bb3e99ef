use super::world;
use bidir::bsdf::{Bsdf, TransportMode};
use bidir::material::Material;
use bidir::math::{Vec2, Vec3};
use bidir::sampler::{Domain, Sampler, SamplerKind};
use bidir::scene::{RayDraws, Scene};
use bidir::spectrum::Lanes;
use bidir::texture::TexturePoint;
use std::sync::Arc;

/// Returns the BSDF of the last material; `u` chooses a part of a mixture.
#[track_caller]
fn bsdf(text: &str, u: f32) -> Bsdf {
    let scene = world(&format!("{text} Shape \"sphere\""));
    let material = scene.materials().last().expect("there is a material");
    let at = TexturePoint::of_parameters(Vec2::ZERO);
    let chosen = material.choose(&at, || u);
    chosen.bsdf(&at, Lanes::Rgb)
}

/// Checks that two ways to write a material are equal.
#[track_caller]
fn check_same(text: &str, spelled_out: &str) {
    assert_eq!(bsdf(text, 0.0), bsdf(spelled_out, 0.0));
}

#[track_caller]
fn check_different(text: &str, other: &str) {
    assert_ne!(bsdf(text, 0.0), bsdf(other, 0.0));
}

#[test]
fn omitted_parameters_have_the_defaults_of_the_format() {
    check_same(
        "Material \"coateddiffuse\"",
        "Material \"coateddiffuse\" \"rgb reflectance\" [.5 .5 .5] \"float roughness\" 0 \
         \"float thickness\" .01 \"float eta\" 1.5 \"float g\" 0 \"rgb albedo\" [0 0 0] \
         \"integer maxdepth\" 10 \"bool remaproughness\" true",
    );
    check_same(
        "Material \"coatedconductor\"",
        "Material \"coatedconductor\" \"float interface.roughness\" 0 \"float interface.eta\" 1.5 \
         \"float thickness\" .01 \"spectrum conductor.eta\" \"metal-Cu-eta\" \
         \"spectrum conductor.k\" \"metal-Cu-k\" \"float conductor.roughness\" 0 \
         \"integer maxdepth\" 10",
    );
    check_same(
        "Material \"thindielectric\"",
        "Material \"thindielectric\" \"float eta\" 1.5",
    );
    check_same(
        "Material \"diffusetransmission\"",
        "Material \"diffusetransmission\" \"rgb reflectance\" [.5 .5 .5] \
         \"rgb transmittance\" [.5 .5 .5] \"float scale\" .5",
    );
}

#[test]
fn every_parameter_of_a_layer_changes_something() {
    let plain = "Material \"coateddiffuse\" \"float roughness\" .3";
    for parameter in [
        "\"rgb reflectance\" [.2 .2 .2]",
        "\"float thickness\" .5",
        "\"float eta\" 1.3",
        "\"rgb albedo\" [.5 .5 .5]",
        "\"bool remaproughness\" false",
        "\"float uroughness\" .1",
        "\"float vroughness\" .1",
    ] {
        check_different(plain, &format!("{plain} {parameter}"));
    }
    let plain = "Material \"coatedconductor\" \"float conductor.roughness\" .3";
    for parameter in [
        "\"float interface.roughness\" .1",
        "\"float interface.uroughness\" .1",
        "\"float interface.vroughness\" .1",
        "\"float interface.eta\" 1.3",
        "\"float conductor.uroughness\" .1",
        "\"float conductor.vroughness\" .1",
        "\"rgb reflectance\" [.2 .2 .2]",
        "\"rgb conductor.k\" [1 1 1]",
        "\"float thickness\" .5",
        "\"bool remaproughness\" false",
    ] {
        check_different(plain, &format!("{plain} {parameter}"));
    }
}

/// The part of light along the normal that white surfaces scatter is 1 if facets scatter often, and less by pbrt-v4's model.
#[test]
fn facets_scatter_often_where_the_file_says_so() {
    for kind in ["conductor", "dielectric", "subsurface"] {
        let plain = format!("Material \"{kind}\" \"float roughness\" .5");
        check_same(&plain, &format!("{plain} \"bool multiscatter\" false"));
        check_different(&plain, &format!("{plain} \"bool multiscatter\" true"));
    }
    let metal = "Material \"conductor\" \"rgb reflectance\" [1 1 1] \"float roughness\" 1";
    for (asked, expected) in [("false", 0.307), ("true", 1.0)] {
        let metal = bsdf(&format!("{metal} \"bool multiscatter\" {asked}"), 0.0);
        let n = 1000u16;
        let at = |i: u16| {
            let cos = (f32::from(i) + 0.5) / f32::from(n);
            let wi = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
            metal.eval(Vec3::Z, wi, TransportMode::Radiance).f[0] * cos
        };
        let part = std::f32::consts::TAU * (0..n).map(at).sum::<f32>() / f32::from(n);
        assert!((part - expected).abs() < 0.02, "{asked}: {part}");
    }
}

#[test]
fn unequal_slopes_of_a_coat_turn_with_the_surface() {
    let text = "Material \"coateddiffuse\" \"float uroughness\" .5 \"float vroughness\" .05";
    let Bsdf::CoatedDiffuse(bsdf) = bsdf(text, 0.0) else {
        panic!("the material is a coated diffuse one");
    };
    let bsdf = Bsdf::CoatedDiffuse(bsdf);
    let along = |w: Vec3| {
        let value = bsdf.eval(Vec3::Z, w.normalize(), TransportMode::Radiance);
        value.pdf
    };
    assert!(along(Vec3::new(0.5, 0.0, 1.0)) > 1.2 * along(Vec3::new(0.0, 0.5, 1.0)));
}

const PARTS: &str = "MakeNamedMaterial \"a\" \"string type\" \"diffuse\"\n\
                     MakeNamedMaterial \"b\" \"string type\" \"dielectric\"\n";

#[test]
fn a_mixture_is_its_second_material_with_probability_amount() {
    let of = |parameters: &str, u| bsdf(&format!("{PARTS}Material \"mix\" {parameters}"), u);
    let both = "\"string materials\" [\"a\" \"b\"]";
    assert!(matches!(of(both, 0.4), Bsdf::Dielectric(_)));
    assert!(matches!(of(both, 0.6), Bsdf::Diffuse(_)));
    let few = format!("{both} \"float amount\" .1");
    assert!(matches!(of(&few, 0.05), Bsdf::Dielectric(_)));
    assert!(matches!(of(&few, 0.15), Bsdf::Diffuse(_)));
    // A mixture within, defined after it is named.
    let nested = "\"string materials\" [\"a\" \"m\"]\n\
                  MakeNamedMaterial \"m\" \"string type\" \"mix\" \"string materials\" [\"b\" \"a\"]";
    let scene = world(&format!(
        "{PARTS}Material \"mix\" {nested} Shape \"sphere\""
    ));
    let mixtures = scene.materials().iter();
    let mixtures = mixtures.filter(|material| matches!(material, Material::Mix(_)));
    assert_eq!(mixtures.count(), 2);
}

/// The part of a sphere that rays meet, whose material is the last one.
#[track_caller]
fn covered(materials: &str) -> (f64, Arc<Scene>) {
    let text = format!("{PARTS}MakeNamedMaterial \"i\" \"string type\" \"interface\"\n{materials}");
    let scene = world(&format!("{text} Shape \"sphere\""));
    let sampler = Sampler::new(SamplerKind::Independent, 7);
    let rays = 4096;
    let meets = |i: &u64| {
        let stream = sampler.stream(Domain::Camera, 0, *i);
        let chances = RayDraws::new(&stream, 1);
        scene.intersect(Vec3::ZERO, Vec3::Z, chances).is_some()
    };
    let met = (0..rays).filter(meets).count();
    (met as f64 / rays as f64, scene)
}

#[track_caller]
fn check_covered(materials: &str, expected: f64) -> Arc<Scene> {
    let (part, scene) = covered(materials);
    // Four standard errors.
    assert!(
        (part - expected).abs() < 0.03,
        "{materials}: {part} instead of {expected}"
    );
    scene
}

/// Rays pass through the `interface` of a mixture, as in pbrt-v4.
#[test]
fn a_mixture_with_an_interface_is_there_in_part() {
    let mix = |first: &str, second: &str, amount: &str| {
        format!(
            "Material \"mix\" \"string materials\" [\"{first}\" \"{second}\"] \
             \"float amount\" {amount}"
        )
    };
    check_covered(&mix("a", "i", ".25"), 0.75);
    check_covered(&mix("i", "a", ".25"), 0.25);
    check_covered(&mix("i", "i", ".25"), 0.0);
    let named = |name: &str, parts: [&str; 2], amount: &str| {
        let [first, second] = parts;
        format!(
            "MakeNamedMaterial \"{name}\" \"string type\" \"mix\" \"string materials\" \
             [\"{first}\" \"{second}\"] \"float amount\" {amount}\n"
        )
    };
    let half = named("h", ["i", "a"], ".5");
    check_covered(&(half.clone() + &mix("h", "i", ".5")), 0.25);
    // 0.75 · 0.5 of the first and 0.25 of the second: 0.4 of what is there is glass.
    let scene = check_covered(&(half + &mix("h", "b", ".25")), 0.625);
    let Some(Material::Mix(mixture)) = scene.materials().last() else {
        panic!("it is a mixture");
    };
    let of_second = mixture
        .amount
        .eval(&TexturePoint::of_parameters(Vec2::ZERO));
    assert!((of_second - 0.4).abs() < 1e-6, "{of_second}");
    // With `alpha` it is their product.
    let text = mix("i", "a", ".5");
    let (part, _) = covered(&format!(
        "{text} Shape \"sphere\" \"float radius\" .5 \"float alpha\" .5\n\
        Material \"interface\""
    ));
    assert!((part - 0.25).abs() < 0.03, "{part}");
}

/// An index may have any of the format's types of spectra, or be a number.
#[test]
fn an_index_of_refraction_is_a_number_or_any_spectrum() {
    let eta = |parameter: &str| {
        let scene = world(&format!(
            "Material \"dielectric\" {parameter} Shape \"sphere\""
        ));
        let Some(Material::Dielectric { eta, .. }) = scene.materials().last() else {
            panic!("it is glass");
        };
        eta.at_d_line()
    };
    let check = |parameter: &str, expected: f32| {
        let eta = eta(parameter);
        assert!((eta - expected).abs() < 1e-4, "{parameter}: {eta}");
    };
    check("", 1.5);
    check("\"float eta\" 1.3", 1.3);
    check("\"rgb eta\" [1.7 1.7 1.7]", 1.7);
    check("\"spectrum eta\" [300 1.2 800 1.2]", 1.2);
    check("\"spectrum eta\" \"glass-BK7\"", 1.5168);
    // The luminance of the colour; the spectrum has priority over the number.
    check("\"rgb eta\" [1.5 1.6 1.7] \"float eta\" 3", 1.5859);
}

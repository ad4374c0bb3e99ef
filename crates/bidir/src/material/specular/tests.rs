//! The test of materials for Dirac distributions, against known answers and against draws.

use super::*;
use crate::bsdf::{FacetScattering, Thickness, TransportMode};
use crate::material::{Anisotropy, CoatSettings};
use crate::math::{ONE_MINUS_EPSILON, Vec2, Vec3};
use crate::spectrum::Lanes;
use crate::testing::prelude::{coat, diffuse, image_map, mix, principled, reflecting};
use crate::texture::{ColorTexture, FloatTexture, ImageFilter, TexturePoint};
use std::sync::Arc;

/// Numbers that are even but for one texel of 64 x 64.
fn speck(even: f32, other: f32) -> FloatTexture {
    let mut texels = vec![[even]; 64 * 64];
    texels[70] = [other];
    FloatTexture::Image(Arc::new(image_map(64, texels, ImageFilter::Point)))
}

fn grey() -> Material {
    diffuse([0.5; 3])
}

fn rough(u: FloatTexture, v: FloatTexture) -> Roughness {
    let mapping = RoughnessMapping::SquareRoot;
    Roughness { u, v, mapping }
}

fn evenly(value: f32) -> Roughness {
    let texture = FloatTexture::Constant(value);
    rough(texture.clone(), texture)
}

fn metal(roughness: Roughness) -> Material {
    Material::Conductor {
        index: reflecting([0.5; 3]),
        roughness,
        scattering: FacetScattering::Single,
    }
}

fn mirror() -> Material {
    metal(Roughness::SMOOTH)
}

fn glass(eta: f32, roughness: Roughness) -> Material {
    Material::Dielectric {
        eta: eta.into(),
        roughness,
        scattering: FacetScattering::Single,
    }
}

fn coat_of(eta: f32, roughness: Roughness) -> CoatSettings {
    CoatSettings {
        eta,
        roughness,
        ..coat(0.0)
    }
}

fn varnish(eta: f32, roughness: Roughness) -> Material {
    let base = ColorTexture::Constant([0.5; 3]);
    Material::CoatedDiffuse(CoatedDiffuseMaterial::new(coat_of(eta, roughness), base))
}

fn lacquer(eta: f32, interface: f32, metal: f32) -> Material {
    let (coat, index) = (coat_of(eta, evenly(interface)), reflecting([0.5; 3]));
    Material::CoatedConductor(CoatedConductorMaterial::new(coat, index, evenly(metal)))
}

fn mixture(amount: FloatTexture, materials: [Material; 2]) -> Material {
    Material::Mix(Arc::new(Mixture { materials, amount }))
}

/// Returns the mirrors of this part beside what is diffuse.
fn mirrors(amount: f32) -> Material {
    mix([grey(), mirror()], amount)
}

/// Returns true where draws at the middle of all texels, by the least and the largest numbers and some between,
/// find a Dirac distribution.
fn draws_find_dirac(material: &Material) -> bool {
    let numbers = || [0.0, 0.25, 0.5, 0.75, ONE_MINUS_EPSILON].into_iter();
    (0..64 * 64).any(|i| {
        let uv = (Vec2::new((i % 64) as f32, (i / 64) as f32) + 0.5) / 64.0;
        let at = TexturePoint::of_parameters(uv);
        numbers().any(|part| {
            let part = material.choose(&at, || part);
            let bsdf = part.bsdf(&at, Lanes::Rgb);
            [0.9f32, 0.2, -0.9, -0.2].into_iter().any(|z| {
                let wo = Vec3::new((1.0 - z * z).sqrt(), 0.0, z);
                numbers().any(|u_lobe| {
                    let u = Vec2::splat(0.37);
                    let drawn = bsdf.sample(wo, TransportMode::Radiance, || u_lobe, u);
                    drawn.is_some_and(|drawn| drawn.is_delta)
                })
            })
        })
    })
}

#[track_caller]
fn check_all(is_specular: bool, materials: impl IntoIterator<Item = Material>) {
    for (i, material) in materials.into_iter().enumerate() {
        let kind = material.kind();
        assert_eq!(material.may_be_specular(), is_specular, "{kind} {i}");
        assert_eq!(draws_find_dirac(&material), is_specular, "{kind} {i} drawn");
    }
}

#[track_caller]
fn specular(materials: impl IntoIterator<Item = Material>) {
    check_all(true, materials);
}

#[track_caller]
fn finite(materials: impl IntoIterator<Item = Material>) {
    check_all(false, materials);
}

#[test]
fn interfaces_are_specular_where_they_are_smooth() {
    let [smooth, across] = [0.0, 0.3].map(FloatTexture::Constant);
    let nan = rough(speck(0.3, f32::NAN), smooth.clone());
    let speckled = rough(speck(0.3, 0.0), speck(0.2, 0.0));
    specular([mirror(), metal(evenly(1e-7)), metal(speckled), metal(nan)]);
    let away = rough(speck(0.3, 0.1), FloatTexture::Constant(0.2));
    finite([grey(), metal(evenly(0.1)), metal(away)]);
    finite([metal(rough(smooth, across)), glass(1.5, evenly(0.5))]);
    specular([glass(1.5, Roughness::SMOOTH), glass(1.0, evenly(0.5))]);
    specular([Material::ThinDielectric { eta: 1.5.into() }]);
}

#[test]
fn coats_are_specular_where_they_are_smooth_and_reflect() {
    let speckled = rough(speck(0.3, 0.0), speck(0.3, 0.0));
    specular([varnish(1.5, Roughness::SMOOTH), varnish(1.5, speckled)]);
    specular([(1.5, 0.3), (1.5, 0.0), (1.0, 0.0)].map(|(eta, metal)| lacquer(eta, 0.0, metal)));
    finite([varnish(1.5, evenly(0.3))]);
    // By Fresnel's equations it reflects what rounding leaves.
    assert!(!varnish(1.0, Roughness::SMOOTH).may_be_specular());
    finite([lacquer(1.5, 0.3, 0.0), lacquer(1.5, 0.3, 0.3)]);
}

#[test]
fn principled_materials_are_specular_where_a_layer_is() {
    let zero = || ScaledFloat::constant(0.0);
    let coated = |factor, roughness| {
        principled(|material| {
            material.coat = ScaledFloat::constant(factor);
            material.coat_roughness = ScaledFloat::constant(roughness);
        })
    };
    specular([coated(1.0, 0.0), coated(0.1, 0.0), coated(1e-3, 0.02)]);
    finite([coated(0.0, 0.0), coated(1.0, 0.2)]);
    let speckled = |even: f32, other: f32| {
        principled(|material| material.roughness.texture = Some(speck(even, other)))
    };
    specular([speckled(0.6, 0.0), speckled(0.6, 0.03)]);
    finite([principled(|_| ()), speckled(0.6, 0.1)]);
    let brushed = |strength| {
        principled(|material| {
            material.roughness = zero();
            material.anisotropy = Anisotropy {
                strength,
                direction: Vec2::X,
                texture: None,
            };
        })
    };
    specular([brushed(0.0)]);
    finite([brushed(0.5)]);
    let cloth = |transmission| {
        principled(|material| {
            (material.metallic, material.specular, material.roughness) = (zero(), zero(), zero());
            material.transmission = ScaledFloat::constant(transmission);
            material.thickness = Thickness::Solid;
        })
    };
    specular([cloth(0.1)]);
    finite([cloth(0.0)]);
}

#[test]
fn mixtures_are_specular_where_a_part_is_however_small() {
    specular([1.0, 0.2, 1e-3, 0.9999].map(mirrors));
    specular([mixture(speck(0.0, 0.01), [grey(), mirror()])]);
    specular([mix([grey(), mirrors(0.01)], 0.5)]);
    finite([mirrors(0.0), mix([mirror(), grey()], 1.0)]);
}

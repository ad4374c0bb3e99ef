//! The test of materials for Dirac distributions, against known answers and against draws.

use super::*;
use crate::bsdf::{FacetScattering, Thickness, TransportMode};
use crate::material::{Anisotropy, ConductorIndex};
use crate::math::{ONE_MINUS_EPSILON, Vec2, Vec3};
use crate::spectrum::Lanes;
use crate::texture::{
    Beyond, Change, ColorTexture, FloatTexture, Image, ImageFilter, ImageMap, Mapping,
    TexturePoint, Wrap,
};
use std::sync::Arc;

/// Numbers that are even but for one texel of 64 x 64.
fn speck(even: f32, other: f32) -> FloatTexture {
    let mut texels = vec![[even]; 64 * 64];
    texels[70] = [other];
    FloatTexture::Image(Arc::new(ImageMap {
        image: Arc::new(Image::new(64, texels).unwrap()),
        wrap: Wrap::all(Beyond::Repeat),
        filter: ImageFilter::Point,
        change: Change::Scale(1.0),
        mapping: Mapping::IDENTITY,
    }))
}

fn grey() -> ColorTexture {
    ColorTexture::Constant([0.5; 3])
}

fn rough(u: FloatTexture, v: FloatTexture) -> Roughness {
    let mapping = RoughnessMapping::SquareRoot;
    Roughness { u, v, mapping }
}

fn evenly(value: f32) -> Roughness {
    let texture = FloatTexture::Constant(value);
    rough(texture.clone(), texture)
}

fn diffuse() -> Material {
    Material::Diffuse {
        reflectance: grey(),
    }
}

fn metal(roughness: Roughness) -> Material {
    let index = ConductorIndex::Reflectance(grey());
    Material::Conductor {
        index,
        roughness,
        scattering: FacetScattering::Single,
    }
}

fn glass(eta: f32, roughness: Roughness) -> Material {
    Material::Dielectric {
        eta,
        roughness,
        scattering: FacetScattering::Single,
    }
}

fn coat(eta: f32, roughness: Roughness) -> CoatSettings {
    CoatSettings {
        eta,
        roughness,
        thickness: FloatTexture::Constant(0.01),
        albedo: ColorTexture::Constant([0.0; 3]),
        g: FloatTexture::Constant(0.0),
    }
}

fn varnish(eta: f32, roughness: Roughness) -> Material {
    Material::CoatedDiffuse(CoatedDiffuseMaterial::new(coat(eta, roughness), grey()))
}

fn lacquer(eta: f32, interface: f32, metal: f32) -> Material {
    let (coat, index) = (
        coat(eta, evenly(interface)),
        ConductorIndex::Reflectance(grey()),
    );
    let material = CoatedConductorMaterial::new(coat, index, evenly(metal));
    Material::CoatedConductor(material)
}

fn principled(change: impl FnOnce(&mut PrincipledMaterial)) -> Material {
    let mut material = PrincipledMaterial::default();
    change(&mut material);
    Material::Principled(Arc::new(material))
}

fn mixture(amount: FloatTexture, materials: [Material; 2]) -> Material {
    Material::Mix(Arc::new(Mixture { materials, amount }))
}

/// Returns the mirrors of this part beside what is diffuse.
fn mirrors(amount: f32) -> Material {
    mixture(
        FloatTexture::Constant(amount),
        [diffuse(), metal(Roughness::SMOOTH)],
    )
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
fn check(is_specular: bool, materials: impl IntoIterator<Item = Material>) {
    for (i, material) in materials.into_iter().enumerate() {
        let kind = material.kind();
        assert_eq!(material.may_be_specular(), is_specular, "{kind} {i}");
        assert_eq!(draws_find_dirac(&material), is_specular, "{kind} {i} drawn");
    }
}

#[test]
fn interfaces_are_specular_where_they_are_smooth() {
    check(true, [metal(Roughness::SMOOTH), metal(evenly(1e-7))]);
    check(true, [metal(rough(speck(0.3, 0.0), speck(0.2, 0.0)))]);
    let nan = rough(speck(0.3, f32::NAN), FloatTexture::Constant(0.0));
    check(true, [metal(nan)]);
    let across = rough(FloatTexture::Constant(0.0), FloatTexture::Constant(0.3));
    let away = rough(speck(0.3, 0.1), FloatTexture::Constant(0.2));
    check(
        false,
        [diffuse(), metal(evenly(0.1)), metal(across), metal(away)],
    );
    check(
        true,
        [glass(1.5, Roughness::SMOOTH), glass(1.0, evenly(0.5))],
    );
    check(true, [Material::ThinDielectric { eta: 1.5 }]);
    check(false, [glass(1.5, evenly(0.5))]);
}

#[test]
fn coats_are_specular_where_they_are_smooth_and_reflect() {
    check(
        true,
        [varnish(1.5, Roughness::SMOOTH), lacquer(1.5, 0.0, 0.3)],
    );
    check(true, [lacquer(1.5, 0.0, 0.0), lacquer(1.0, 0.0, 0.0)]);
    check(
        true,
        [varnish(1.5, rough(speck(0.3, 0.0), speck(0.3, 0.0)))],
    );
    check(false, [varnish(1.5, evenly(0.3))]);
    // By Fresnel's equations it reflects what rounding leaves.
    assert!(!varnish(1.0, Roughness::SMOOTH).may_be_specular());
    check(false, [lacquer(1.5, 0.3, 0.0), lacquer(1.5, 0.3, 0.3)]);
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
    check(
        true,
        [coated(1.0, 0.0), coated(0.1, 0.0), coated(1e-3, 0.02)],
    );
    check(false, [coated(0.0, 0.0), coated(1.0, 0.2)]);
    let speckled = |even: f32, other: f32| {
        principled(|material| material.roughness.texture = Some(speck(even, other)))
    };
    check(true, [speckled(0.6, 0.0), speckled(0.6, 0.03)]);
    check(false, [principled(|_| ()), speckled(0.6, 0.1)]);
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
    check(true, [brushed(0.0)]);
    check(false, [brushed(0.5)]);
    let cloth = |transmission| {
        principled(|material| {
            (material.metallic, material.specular, material.roughness) = (zero(), zero(), zero());
            material.transmission = ScaledFloat::constant(transmission);
            material.thickness = Thickness::Solid;
        })
    };
    check(true, [cloth(0.1)]);
    check(false, [cloth(0.0)]);
}

#[test]
fn mixtures_are_specular_where_a_part_is_however_small() {
    check(
        true,
        [mirrors(1.0), mirrors(0.2), mirrors(1e-3), mirrors(0.9999)],
    );
    check(false, [mirrors(0.0)]);
    let parts = || [diffuse(), metal(Roughness::SMOOTH)];
    check(true, [mixture(speck(0.0, 0.01), parts())]);
    let [first, second] = parts();
    check(
        false,
        [mixture(FloatTexture::Constant(1.0), [second, first])],
    );
    check(
        true,
        [mixture(
            FloatTexture::Constant(0.5),
            [diffuse(), mirrors(0.01)],
        )],
    );
}

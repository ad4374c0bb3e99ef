#![allow(dead_code, reason = "every test uses a part of this module")]
//! Materials for the tests of units and of whole paths.

use bidir::bsdf::{FacetScattering, Thickness};
use bidir::material::{
    Anisotropy, Bitangent, CLEAR, CoatSettings, CoatedConductorMaterial, CoatedDiffuseMaterial,
    ConductorIndex, Material, Mixture, NormalMap, PrincipledMaterial, Relief, Roughness,
    RoughnessMapping, ScaledColor, ScaledFloat,
};
use bidir::math::Vec2;
use bidir::spectrum::Rgb;
use bidir::texture::{
    Beyond, Change, ColorTexture, FloatTexture, Image, ImageFilter, ImageMap, Mapping, Noise,
    NoiseKind, TextureSpace, Wrap,
};
use std::sync::Arc;

pub(crate) fn diffuse(reflectance: Rgb) -> Material {
    Material::Diffuse {
        reflectance: ColorTexture::Constant(reflectance),
    }
}

/// Facets of this slope in all directions.
pub(crate) fn roughness(alpha: f32) -> Roughness {
    Roughness {
        u: FloatTexture::Constant(alpha),
        v: FloatTexture::Constant(alpha),
        mapping: RoughnessMapping::Identity,
    }
}

/// The index of a metal that reflects so much along its normal.
pub(crate) fn reflecting(reflectance: Rgb) -> ConductorIndex {
    ConductorIndex::Reflectance(ColorTexture::Constant(reflectance))
}

pub(crate) fn metal(alpha: f32) -> Material {
    Material::Conductor {
        index: reflecting([0.9, 0.7, 0.4]),
        roughness: roughness(alpha),
        scattering: FacetScattering::Multiple,
    }
}

pub(crate) fn glass(alpha: f32) -> Material {
    Material::Dielectric {
        eta: 1.5.into(),
        roughness: roughness(alpha),
        scattering: FacetScattering::Multiple,
    }
}

/// A thin clear coat.
pub(crate) fn coat(alpha: f32) -> CoatSettings {
    CoatSettings {
        eta: 1.5,
        roughness: roughness(alpha),
        thickness: FloatTexture::Constant(0.05),
        albedo: CLEAR,
        g: FloatTexture::Constant(0.0),
    }
}

pub(crate) fn varnish(alpha: f32) -> Material {
    let base = ColorTexture::Constant([0.7, 0.3, 0.1]);
    Material::CoatedDiffuse(CoatedDiffuseMaterial::new(coat(alpha), base))
}

pub(crate) fn lacquer(coat_alpha: f32, metal_alpha: f32) -> Material {
    let (coat, metal) = (coat(coat_alpha), roughness(metal_alpha));
    let index = reflecting([0.9, 0.7, 0.4]);
    Material::CoatedConductor(CoatedConductorMaterial::new(coat, index, metal))
}

pub(crate) fn mix(materials: [Material; 2], amount: f32) -> Material {
    Material::Mix(Arc::new(Mixture {
        materials,
        amount: FloatTexture::Constant(amount),
    }))
}

/// Reflects and transmits.
pub(crate) fn paper() -> Material {
    Material::DiffuseTransmission {
        reflectance: ColorTexture::Constant([0.5, 0.3, 0.2]),
        transmittance: ColorTexture::Constant([0.2, 0.4, 0.7]),
        scale: 0.9,
    }
}

/// A principled material: the default one but for what `change` says.
pub(crate) fn principled(change: impl FnOnce(&mut PrincipledMaterial)) -> Material {
    let mut material = PrincipledMaterial::default();
    change(&mut material);
    Material::Principled(Arc::new(material))
}

/// Brushed metal and plastic of this roughness by shares, under sheen.
fn brushed(material: &mut PrincipledMaterial, roughness: f32) {
    material.color = ScaledColor::constant([0.8, 0.5, 0.3]);
    material.metallic = ScaledFloat::constant(0.4);
    material.roughness = ScaledFloat::constant(roughness);
    material.anisotropy = Anisotropy {
        strength: 0.6,
        direction: Vec2::new(0.8, 0.6),
        texture: None,
    };
    material.sheen = ScaledColor::constant([0.1, 0.3, 0.5]);
    material.sheen_roughness = ScaledFloat::constant(0.6);
}

/// Brushed metal, rough plastic and rough glass by shares, under sheen and a rough coat.
pub(crate) fn principled_rough() -> Material {
    principled(|material| {
        brushed(material, 0.55);
        material.transmission = ScaledFloat::constant(0.4);
        material.thickness = Thickness::Solid;
        material.diffuse_transmission = ScaledFloat::constant(0.3);
        material.coat = ScaledFloat::constant(0.7);
        material.coat_roughness = ScaledFloat::constant(0.5);
    })
}

/// Brushed metal and plastic under a coat of this roughness, which has the normals of the mesh or of a map.
pub(crate) fn principled_layers(roughness: f32, coat_normal: Option<NormalMap>) -> Material {
    principled(|material| {
        brushed(material, 0.6);
        material.coat = ScaledFloat::constant(0.8);
        material.coat_roughness = ScaledFloat::constant(roughness);
        material.coat_normal = coat_normal;
    })
}

/// Plastic and glass by shares, smooth, under a smooth coat.
pub(crate) fn principled_smooth() -> Material {
    principled(|material| {
        material.color = ScaledColor::constant([0.8, 0.5, 0.3]);
        material.metallic = ScaledFloat::constant(0.1);
        material.roughness = ScaledFloat::constant(0.0);
        material.transmission = ScaledFloat::constant(0.5);
        material.thickness = Thickness::Solid;
        material.coat = ScaledFloat::constant(0.8);
    })
}

/// A map of normals that are all tilted so far along x and y.
pub(crate) fn slant(x: f32, y: f32) -> NormalMap {
    NormalMap {
        texture: ColorTexture::Constant([(x + 1.0) / 2.0, (y + 1.0) / 2.0, 1.0]),
        scale: 1.0,
        bitangent: Bitangent::AlongV,
    }
}

/// The material under a map of normals, 45° steep.
pub(crate) fn slanted(material: Material) -> Material {
    material.with_relief(Relief::NormalMap(slant(0.9, -0.45)))
}

/// A square image that repeats, as it is.
pub(crate) fn image_map<const N: usize>(
    width: usize,
    texels: Vec<[f32; N]>,
    filter: ImageFilter,
) -> ImageMap<N> {
    let image = Image::new(width, texels).expect("rows of texels");
    ImageMap {
        image: Arc::new(image.with_copies()),
        wrap: Wrap::all(Beyond::Repeat),
        filter,
        change: Change::Scale(1.0),
        mapping: Mapping::IDENTITY,
    }
}

/// Noise of some octaves in a space.
pub(crate) fn fbm(octaves: u32, roughness: f32, space: TextureSpace) -> FloatTexture {
    let kind = NoiseKind::Fbm { octaves, roughness };
    FloatTexture::Noise(Arc::new(Noise { kind, space }))
}

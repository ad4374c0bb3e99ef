//! Materials.
//!
//! A mixture names its parts, which are built before it; a cycle of mixtures is an error.

use super::color::Purpose;
use super::context::Context;
use super::reader::Reader;
use super::spectral;
use super::texture::Textures;
use crate::pbrt::known;
use crate::pbrt::lexer::shorten;
use crate::pbrt::parameters::{ParameterType, Values};
use crate::pbrt::scene::{Entity, MaterialDescription};
use crate::source::{Fault, Span};
use bidir::material::{
    Bitangent, CLEAR, CoatSettings, CoatedConductorMaterial, CoatedDiffuseMaterial, ConductorIndex,
    Material, Mixture, NormalMap, Relief, Roughness, RoughnessMapping,
};
use bidir::scene::RenderSpace;
use bidir::texture::{ColorTexture, FloatTexture, Scale};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Builds the materials of a description one by one.
pub(super) struct Materials<'a> {
    described: &'a [MaterialDescription],
    /// The named materials by name.
    named: BTreeMap<&'a str, usize>,
    /// The materials in construction, the innermost last, to find cycles of mixtures.
    open: Vec<usize>,
}

impl<'a> Materials<'a> {
    pub(super) fn new(described: &'a [MaterialDescription]) -> Self {
        let named = described.iter().enumerate();
        Self {
            named: named
                .filter_map(|(index, material)| Some((material.name.as_deref()?, index)))
                .collect(),
            described,
            open: Vec::new(),
        }
    }

    /// Builds material number `index`; one without an entity is the default material.
    ///
    /// None: the surface is not visible, and rays pass through it, shadow rays included. Such a shape does
    /// not emit, and can be left out as it bounds no medium.
    pub(super) fn build(
        &mut self,
        context: &mut Context<'_>,
        textures: &mut Textures<'_>,
        index: usize,
    ) -> Result<Option<Material>, Fault> {
        let described = self.described;
        let Some(entity) = described[index].entity.as_ref() else {
            return Ok(Some(grey()));
        };
        let mut reader = Reader::new(entity);
        let material = match entity.kind.as_str() {
            "diffuse" => diffuse(context, textures, &mut reader)?,
            "diffusetransmission" => diffuse_transmission(context, textures, &mut reader)?,
            "conductor" => conductor(context, textures, &mut reader)?,
            "dielectric" => dielectric(context, textures, &mut reader)?,
            "thindielectric" => Material::ThinDielectric {
                eta: spectral::read_eta(context, &mut reader, "eta")?,
            },
            "coateddiffuse" => coated_diffuse(context, textures, &mut reader)?,
            "coatedconductor" => coated_conductor(context, textures, &mut reader)?,
            "mix" => {
                let material = self.mix(context, textures, index, &mut reader)?;
                reader.finish()?;
                return Ok(Some(material));
            }
            "interface" | "none" | "" => {
                reader.finish()?;
                return Ok(None);
            }
            _ => return substitute(context, textures, entity),
        };
        let relief = relief(context, textures, &mut reader)?;
        reader.finish()?;
        Ok(Some(match relief {
            Some(relief) => material.embossed(relief),
            None => material,
        }))
    }

    fn mix(
        &mut self,
        context: &mut Context<'_>,
        textures: &mut Textures<'_>,
        index: usize,
        reader: &mut Reader<'_>,
    ) -> Result<Material, Fault> {
        let amount = textures.float(context, reader, "amount")?;
        let Some(parameter) = reader.find(ParameterType::String, "materials") else {
            let message = "the parameter `string materials` is missing";
            return Err(Fault::scene(reader.span(), message));
        };
        let (Values::Strings(names), span) = (&parameter.values, parameter.value_span) else {
            return Err(Fault::scene(parameter.value_span, "expected names"));
        };
        let [first, second] = names.as_slice() else {
            let message = format!("`materials` has two names, found {}", names.len());
            return Err(Fault::scene(span, message));
        };
        self.open.push(index);
        let parts = [first, second].map(|name| self.part(context, textures, name, span));
        self.open.pop();
        let [first, second] = parts;
        Ok(Material::Mix(Arc::new(Mixture {
            materials: [first?, second?],
            amount: amount.unwrap_or(FloatTexture::Constant(0.5)),
        })))
    }

    /// Builds the part `name` of a mixture.
    fn part(
        &mut self,
        context: &mut Context<'_>,
        textures: &mut Textures<'_>,
        name: &str,
        span: Span,
    ) -> Result<Material, Fault> {
        let Some(&index) = self.named.get(&*known::normalized(name)) else {
            let fault = Fault::scene(span, format!("unknown material `{}`", shorten(name)));
            return Err(fault.with_nearest(name, self.named.keys().copied()));
        };
        if self.open.contains(&index) {
            let message = format!("the mixture `{}` is a part of itself", shorten(name));
            return Err(Fault::scene(span, message));
        }
        if self.open.len() >= DEEPEST {
            let message = format!("mixtures are nested deeper than {DEEPEST}");
            return Err(Fault::scene(span, message));
        }
        self.build(context, textures, index)?.ok_or_else(|| {
            let message = format!("the material `{}` is not a surface", shorten(name));
            Fault::scene(span, message).with_hint("a mixture needs two surfaces")
        })
    }
}

/// Maximum depth of mixtures, as each level doubles the number of materials.
const DEEPEST: usize = 8;

fn grey() -> Material {
    Material::Diffuse {
        reflectance: ColorTexture::Constant([0.5; 3]),
    }
}

/// Reads the normal map, or else the bump map, which is a texture of heights.
fn relief(
    context: &mut Context<'_>,
    textures: &mut Textures<'_>,
    reader: &mut Reader<'_>,
) -> Result<Option<Relief>, Fault> {
    let height = textures.float(context, reader, "displacement")?;
    let normals = textures.normals(context, reader, "normalmap")?;
    if let Some(texture) = normals {
        return Ok(Some(Relief::NormalMap(NormalMap {
            texture,
            scale: 1.0,
            bitangent: Bitangent::RightHanded,
        })));
    }
    Ok(height.map(|height| Relief::Displacement(in_space(height, &context.layout.space))))
}

/// Converts heights from the world to the unit of a space.
fn in_space(height: FloatTexture, space: &RenderSpace) -> FloatTexture {
    if *space == RenderSpace::WORLD {
        return height;
    }
    FloatTexture::Scale(Arc::new(Scale {
        texture: height,
        factor: FloatTexture::Constant((1.0 / space.unit) as f32),
    }))
}

fn diffuse(
    context: &mut Context<'_>,
    textures: &mut Textures<'_>,
    reader: &mut Reader<'_>,
) -> Result<Material, Fault> {
    let reflectance = textures.color(context, reader, "reflectance", Purpose::Albedo)?;
    Ok(Material::Diffuse {
        reflectance: reflectance.unwrap_or(ColorTexture::Constant([0.5; 3])),
    })
}

fn diffuse_transmission(
    context: &mut Context<'_>,
    textures: &mut Textures<'_>,
    reader: &mut Reader<'_>,
) -> Result<Material, Fault> {
    let quarter = ColorTexture::Constant([0.25; 3]);
    let reflectance = textures.color(context, reader, "reflectance", Purpose::Albedo)?;
    let transmittance = textures.color(context, reader, "transmittance", Purpose::Albedo)?;
    Ok(Material::DiffuseTransmission {
        reflectance: reflectance.unwrap_or_else(|| quarter.clone()),
        transmittance: transmittance.unwrap_or(quarter),
        scale: reader.float_within("scale", 1.0, [0.0, f32::MAX])?,
    })
}

fn conductor(
    context: &mut Context<'_>,
    textures: &mut Textures<'_>,
    reader: &mut Reader<'_>,
) -> Result<Material, Fault> {
    Ok(Material::Conductor {
        index: conductor_index(context, textures, reader, ["eta", "k"])?,
        roughness: roughness(context, textures, reader, &SURFACE)?,
    })
}

/// Reads the index of refraction of a metal, whose parts are called `eta` and `k`.
fn conductor_index(
    context: &mut Context<'_>,
    textures: &mut Textures<'_>,
    reader: &mut Reader<'_>,
    [eta, k]: [&'static str; 2],
) -> Result<ConductorIndex, Fault> {
    let reflectance = textures.color(context, reader, "reflectance", Purpose::Albedo)?;
    if let Some(reflectance) = reflectance {
        let kinds = [
            ParameterType::Texture,
            ParameterType::Spectrum,
            ParameterType::Rgb,
        ];
        let mut is_given = |name| kinds.iter().any(|&kind| reader.find(kind, name).is_some());
        if is_given(eta) || is_given(k) {
            let message = format!("a conductor has `reflectance` or `{eta}` and `{k}`, not both");
            return Err(Fault::scene(reader.span(), message));
        }
        return Ok(ConductorIndex::Reflectance(reflectance));
    }
    if let Some((eta, k)) = spectral::read_metal(context, reader, [eta, k])? {
        return Ok(ConductorIndex::Complex {
            eta: ColorTexture::Constant(eta),
            k: ColorTexture::Constant(k),
        });
    }
    let (of_copper, k_of_copper) = spectral::copper();
    let mut part = |name, copper| -> Result<ColorTexture, Fault> {
        let given = textures.color(context, reader, name, Purpose::Unbounded)?;
        Ok(given.unwrap_or(ColorTexture::Constant(copper)))
    };
    Ok(ConductorIndex::Complex {
        eta: part(eta, of_copper)?,
        k: part(k, k_of_copper)?,
    })
}

fn dielectric(
    context: &mut Context<'_>,
    textures: &mut Textures<'_>,
    reader: &mut Reader<'_>,
) -> Result<Material, Fault> {
    let eta = spectral::read_eta(context, reader, "eta")?;
    Ok(Material::Dielectric {
        eta,
        roughness: roughness(context, textures, reader, &SURFACE)?,
    })
}

fn coated_diffuse(
    context: &mut Context<'_>,
    textures: &mut Textures<'_>,
    reader: &mut Reader<'_>,
) -> Result<Material, Fault> {
    let reflectance = textures.color(context, reader, "reflectance", Purpose::Albedo)?;
    let coat = coat(context, textures, reader, ("eta", &SURFACE))?;
    let reflectance = reflectance.unwrap_or(ColorTexture::Constant([0.5; 3]));
    Ok(Material::CoatedDiffuse(CoatedDiffuseMaterial::new(
        coat,
        reflectance,
    )))
}

fn coated_conductor(
    context: &mut Context<'_>,
    textures: &mut Textures<'_>,
    reader: &mut Reader<'_>,
) -> Result<Material, Fault> {
    let names = ["conductor.eta", "conductor.k"];
    let index = conductor_index(context, textures, reader, names)?;
    let of_metal = roughness(context, textures, reader, &METAL)?;
    let coat = coat(context, textures, reader, ("interface.eta", &INTERFACE))?;
    Ok(Material::CoatedConductor(CoatedConductorMaterial::new(
        coat, index, of_metal,
    )))
}

/// Reads a layer, whose index and roughness have these names.
fn coat(
    context: &mut Context<'_>,
    textures: &mut Textures<'_>,
    reader: &mut Reader<'_>,
    (eta, names): (&'static str, &[&'static str; 3]),
) -> Result<CoatSettings, Fault> {
    let thickness = textures.float(context, reader, "thickness")?;
    let albedo = textures.color(context, reader, "albedo", Purpose::Albedo)?;
    let g = textures.float(context, reader, "g")?;
    reader.ignore(context, ParameterType::Integer, "maxdepth");
    reader.ignore(context, ParameterType::Integer, "nsamples");
    Ok(CoatSettings {
        eta: spectral::read_eta(context, reader, eta)?,
        roughness: roughness(context, textures, reader, names)?,
        thickness: thickness.unwrap_or(FloatTexture::Constant(0.01)),
        albedo: albedo.unwrap_or(CLEAR),
        g: g.unwrap_or(FloatTexture::Constant(0.0)),
    })
}

/// The names of a roughness: in both directions, along u, along v.
const SURFACE: [&str; 3] = ["roughness", "uroughness", "vroughness"];
/// The names of the roughness of a layer's interface.
const INTERFACE: [&str; 3] = [
    "interface.roughness",
    "interface.uroughness",
    "interface.vroughness",
];
/// The names of the roughness of the metal under a layer.
const METAL: [&str; 3] = [
    "conductor.roughness",
    "conductor.uroughness",
    "conductor.vroughness",
];

fn roughness(
    context: &mut Context<'_>,
    textures: &mut Textures<'_>,
    reader: &mut Reader<'_>,
    [both, u, v]: &[&'static str; 3],
) -> Result<Roughness, Fault> {
    let both = textures.float(context, reader, both)?;
    let both = both.unwrap_or(FloatTexture::Constant(0.0));
    let u = textures.float(context, reader, u)?;
    let v = textures.float(context, reader, v)?;
    let mapping = if reader.bool("remaproughness", true)? {
        RoughnessMapping::SquareRoot
    } else {
        RoughnessMapping::Identity
    };
    Ok(Roughness {
        u: u.unwrap_or_else(|| both.clone()),
        v: v.unwrap_or(both),
        mapping,
    })
}

/// Returns the substitute of a material that is not supported, whose parameters are not checked.
fn substitute(
    context: &mut Context<'_>,
    textures: &mut Textures<'_>,
    entity: &Entity,
) -> Result<Option<Material>, Fault> {
    let what = format!("the material `{}`", entity.kind);
    let mut accept = |substitute| context.unsupported(entity.span, &what, substitute);
    let mut reader = Reader::new(entity);
    if entity.kind == "subsurface" {
        accept("`diffuse` with its reflectance is used instead")?;
        return diffuse(context, textures, &mut reader).map(Some);
    }
    accept("`diffuse` with reflectance 0.5 is used instead")?;
    Ok(Some(grey()))
}

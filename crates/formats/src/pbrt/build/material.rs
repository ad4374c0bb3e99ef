//! Materials.

use super::color::{self, Purpose};
use super::context::Context;
use super::reader::Reader;
use super::texture::Textures;
use crate::pbrt::parameters::ParameterType;
use crate::pbrt::scene::Entity;
use crate::source::Fault;
use bidir::material::{ConductorIndex, Material, Roughness, RoughnessMapping};
use bidir::texture::{ColorTexture, FloatTexture};

/// Builds a material; without an entity it is the one that shapes have before any is named.
///
/// None: there is no surface.
pub(super) fn build(
    context: &mut Context<'_>,
    textures: &mut Textures<'_>,
    entity: Option<&Entity>,
) -> Result<Option<Material>, Fault> {
    let Some(entity) = entity else {
        return Ok(Some(grey()));
    };
    let mut reader = Reader::new(entity);
    let material = match entity.kind.as_str() {
        "diffuse" => diffuse(context, textures, &mut reader)?,
        "conductor" => conductor(context, textures, &mut reader)?,
        "dielectric" => dielectric(context, textures, &mut reader)?,
        _ => return stand_in(context, textures, entity),
    };
    bump(context, &mut reader)?;
    reader.finish()?;
    Ok(Some(material))
}

fn grey() -> Material {
    Material::Diffuse {
        reflectance: ColorTexture::Constant([0.5; 3]),
    }
}

fn bump(context: &mut Context<'_>, reader: &mut Reader<'_>) -> Result<(), Fault> {
    let flat = "the surface stays smooth";
    reader.unsupported(context, (ParameterType::Texture, "displacement"), flat)?;
    reader.unsupported(context, (ParameterType::String, "normalmap"), flat)
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

fn conductor(
    context: &mut Context<'_>,
    textures: &mut Textures<'_>,
    reader: &mut Reader<'_>,
) -> Result<Material, Fault> {
    let reflectance = textures.color(context, reader, "reflectance", Purpose::Albedo)?;
    let eta = textures.color(context, reader, "eta", Purpose::Unbounded)?;
    let k = textures.color(context, reader, "k", Purpose::Unbounded)?;
    let index = match (reflectance, eta, k) {
        (Some(reflectance), None, None) => ConductorIndex::Reflectance(reflectance),
        (Some(_), _, _) => {
            let message = "a conductor has `reflectance` or `eta` and `k`, not both";
            return Err(Fault::scene(reader.span(), message));
        }
        (None, eta, k) => ConductorIndex::Complex {
            eta: eta.unwrap_or(ColorTexture::Constant(color::COPPER.0)),
            k: k.unwrap_or(ColorTexture::Constant(color::COPPER.1)),
        },
    };
    Ok(Material::Conductor {
        index,
        roughness: roughness(context, textures, reader)?,
    })
}

fn dielectric(
    context: &mut Context<'_>,
    textures: &mut Textures<'_>,
    reader: &mut Reader<'_>,
) -> Result<Material, Fault> {
    let eta = color::read_eta(context, reader)?;
    Ok(Material::Dielectric {
        eta,
        roughness: roughness(context, textures, reader)?,
    })
}

fn roughness(
    context: &mut Context<'_>,
    textures: &mut Textures<'_>,
    reader: &mut Reader<'_>,
) -> Result<Roughness, Fault> {
    let both = textures.float(context, reader, "roughness")?;
    let both = both.unwrap_or(FloatTexture::Constant(0.0));
    let u = textures.float(context, reader, "uroughness")?;
    let v = textures.float(context, reader, "vroughness")?;
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

/// What is accepted in place of a material that is not built yet. Its own parameters are not
/// looked through.
fn stand_in(
    context: &mut Context<'_>,
    textures: &mut Textures<'_>,
    entity: &Entity,
) -> Result<Option<Material>, Fault> {
    let what = format!("the material `{}`", entity.kind);
    let mut accept = |stand_in| context.unsupported(entity.span, &what, stand_in);
    let mut reader = Reader::new(entity);
    match entity.kind.as_str() {
        "interface" | "none" | "" => {
            accept("its shapes are left out")?;
            Ok(None)
        }
        "thindielectric" => {
            accept("a smooth `dielectric` stands in")?;
            dielectric(context, textures, &mut reader).map(Some)
        }
        "coateddiffuse" | "diffusetransmission" | "subsurface" => {
            accept("`diffuse` of its reflectance stands in")?;
            diffuse(context, textures, &mut reader).map(Some)
        }
        "coatedconductor" => {
            accept("smooth copper stands in")?;
            let index = ConductorIndex::Complex {
                eta: ColorTexture::Constant(color::COPPER.0),
                k: ColorTexture::Constant(color::COPPER.1),
            };
            Ok(Some(Material::Conductor {
                index,
                roughness: Roughness::SMOOTH,
            }))
        }
        _ => {
            accept("`diffuse` of 0.5 stands in")?;
            Ok(Some(grey()))
        }
    }
}

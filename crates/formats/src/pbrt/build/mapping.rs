//! Maps from surfaces to textures: the parameter `mapping`, and the space of a `Texture` directive.

use super::context::Context;
use super::reader::Reader;
use crate::pbrt::parameters::ParameterType;
use crate::pbrt::scene::TextureDescription;
use crate::source::Fault;
use bidir::math::{Affine3A, Vec2, Vec3};
use bidir::texture::{Mapping, TextureSpace};
use glam::DAffine3;

/// Returns the map from the render space to that of a texture.
fn from_world(context: &mut Context<'_>, texture: &TextureDescription) -> Result<DAffine3, Fault> {
    let span = texture.entity.span;
    if texture.transforms.is_animated() {
        let message = "textures cannot move: the first position of the texture is used";
        context.warn(span, message);
    }
    let inverse = context.place(&texture.transforms).inverse();
    if inverse.is_finite() && inverse.as_affine3a().is_finite() {
        return Ok(inverse);
    }
    let message = "the transformation of the texture cannot be inverted";
    Err(Fault::scene(span, message))
}

/// Returns the space of a three-dimensional texture.
pub(super) fn space(
    context: &mut Context<'_>,
    texture: &TextureDescription,
) -> Result<TextureSpace, Fault> {
    let from_world = from_world(context, texture)?;
    Ok(TextureSpace::new(from_world.as_affine3a()))
}

/// Reads a direction of texture space. Returns the unit vector in the world.
pub(super) fn direction(
    texture: &TextureDescription,
    reader: &mut Reader<'_, '_>,
    name: &'static str,
    default: Vec3,
) -> Result<Vec3, Fault> {
    let local = vector(reader, name, default)?;
    let world = texture.transforms.start.transform_vector3(local.as_dvec3());
    let direction = world.try_normalize().map(glam::DVec3::as_vec3);
    direction.ok_or_else(|| {
        let message = format!("the direction `{name}` has no length");
        reader.fault(message)
    })
}

/// Reads the map from points of a surface to points of a two-dimensional texture.
pub(super) fn read(
    texture: &TextureDescription,
    reader: &mut Reader<'_, '_>,
) -> Result<Mapping, Fault> {
    let kinds = ["uv", "spherical", "cylindrical", "planar"].map(|kind| (kind, kind));
    match reader.choice("mapping", "mapping", &kinds)? {
        "uv" => {
            let scale = Vec2::new(reader.float("uscale", 1.0)?, reader.float("vscale", 1.0)?);
            let offset = offset(reader)?;
            Ok(Mapping::Parameters { scale, offset })
        }
        "spherical" => Ok(Mapping::Spherical(space(reader.context, texture)?)),
        "cylindrical" => Ok(Mapping::Cylindrical(space(reader.context, texture)?)),
        _ => {
            let vectors = [
                vector(reader, "v1", Vec3::X)?,
                vector(reader, "v2", Vec3::Y)?,
            ];
            let from_world: Affine3A = from_world(reader.context, texture)?.as_affine3a();
            Ok(Mapping::planar(&from_world, vectors, offset(reader)?))
        }
    }
}

fn offset(reader: &mut Reader<'_, '_>) -> Result<Vec2, Fault> {
    Ok(Vec2::new(
        reader.float("udelta", 0.0)?,
        reader.float("vdelta", 0.0)?,
    ))
}

fn vector(reader: &mut Reader<'_, '_>, name: &'static str, default: Vec3) -> Result<Vec3, Fault> {
    let values = reader.triple(ParameterType::Vector3, name, default.to_array())?;
    Ok(Vec3::from(values))
}

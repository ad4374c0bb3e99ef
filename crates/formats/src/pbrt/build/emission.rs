//! The emission of shapes.

use super::color;
use super::context::Context;
use super::group;
use super::light;
use super::reader::Reader;
use super::shape::Geometry;
use crate::pbrt::parameters::ParameterType;
use crate::pbrt::scene::Entity;
use crate::source::{Fault, Span};
use bidir::light::EmissionSides;
use bidir::math::PI;
use bidir::scene::Emission;
use bidir::shape::{Mesh, Shape};
use bidir::spectrum::{Illuminant, luminance};
use bidir::texture::{Beyond, Change, ColorTexture, ImageFilter, ImageMap, Mapping, Wrap};
use std::ops::Range;
use std::sync::Arc;

/// The warning for a shape of several faces, each of which has the given power.
const POWER_OF_EACH: &str = "`power` is that of each face of a mesh, as in pbrt-v4: the mesh has as many times the power as it has \
     faces; divide `power` by their number, or give `L`";

/// The emission of an area light.
#[derive(Clone)]
pub(super) struct AreaEmission {
    radiance: Illuminant,
    /// A texture over the surface's parameters that scales the radiance, and the mean luminance of the texture.
    pattern: Option<(ColorTexture, f32)>,
    sides: EmissionSides,
    /// The power of each face in the render space, and the place of the parameter. None: the file gives the radiance.
    power: Option<(f32, Span)>,
    /// The name of the light group.
    pub(super) group: Option<String>,
    span: Span,
}

impl AreaEmission {
    pub(super) fn read(context: &mut Context<'_>, entity: &Entity) -> Result<Self, Fault> {
        let mut reader = Reader::new(context, entity);
        let light = color::read_light(&mut reader, "L")?;
        let scale = reader.float_within("scale", 1.0, [0.0, f32::MAX])?;
        let power = reader.optional_float("power")?.filter(|&power| power > 0.0);
        let parameter = reader.find(ParameterType::Float, "power");
        let place = parameter.map_or(entity.span, |parameter| parameter.value_span);
        let sides = if reader.bool("twosided", false)? {
            EmissionSides::Both
        } else {
            EmissionSides::Front
        };
        let pattern = pattern(&mut reader)?;
        if light.is_some() && pattern.is_some() {
            return Err(reader.fault("an area light has `L` or `filename`, not both"));
        }
        let group = group::read(&mut reader)?;
        reader.finish()?;
        Ok(Self {
            radiance: light
                .unwrap_or([1.0; 3].into())
                .map(|channel| channel * scale),
            pattern,
            sides,
            // Power per area does not depend on the unit, nor does power per squared distance.
            power: power.map(|power| (context.layout.space.intensity(power), place)),
            group,
            span: entity.span,
        })
    }

    /// Returns the emission of a shape. If the file gives power, every face has to be a separate shape: see
    /// [`parts`](Self::parts).
    pub(super) fn of(&self, shape: &Shape) -> Result<Emission, Fault> {
        let factor = match self.power {
            Some((power, _)) => {
                let sides = if self.sides == EmissionSides::Both {
                    2.0
                } else {
                    1.0
                };
                let area: f32 = (0..shape.primitive_count())
                    .map(|i| shape.primitive_area(i))
                    .sum();
                let mean = self.pattern.as_ref().map_or(1.0, |(_, mean)| *mean);
                let factor = power / (area * PI * sides * mean);
                // A triangle without area, or an image without light, emits nothing, whatever its radiance.
                if factor.is_finite() { factor } else { 0.0 }
            }
            None => 1.0,
        };
        Ok(Emission {
            radiance: color::scaled_light(self.span, self.radiance.clone(), factor)?,
            pattern: self.pattern.as_ref().map(|(pattern, _)| pattern.clone()),
            sides: self.sides,
        })
    }

    /// Returns the number of [`parts`](Self::parts) of a shape.
    pub(super) fn part_count(&self, geometry: &Geometry) -> u64 {
        match (self.power, geometry) {
            (Some(_), Geometry::Mesh(mesh)) => mesh.face_count() as u64,
            _ => 1,
        }
    }

    /// Warns that a shape of several faces has several times the power.
    pub(super) fn warn_of_parts(&self, context: &mut Context<'_>, geometry: &Geometry) {
        if let Some((_, place)) = self.power
            && self.part_count(geometry) > 1
        {
            context.warn(place, POWER_OF_EACH);
        }
    }

    /// Returns the parts of a placed shape that are separate lights.
    pub(super) fn parts(&self, geometry: &Geometry, shape: Shape) -> Vec<Shape> {
        match (self.power, geometry, shape) {
            (Some(_), Geometry::Mesh(faces), Shape::Mesh(mesh)) => {
                let faces = faces.faces().into_iter();
                faces.map(|face| Shape::Mesh(part(&mesh, face))).collect()
            }
            (_, _, shape) => vec![shape],
        }
    }
}

/// Reads the image of a light over its shape. None: the emission is uniform.
fn pattern(reader: &mut Reader<'_, '_>) -> Result<Option<(ColorTexture, f32)>, Fault> {
    let Some((name, span)) = reader.string("filename")? else {
        return Ok(None);
    };
    let image = light::radiance_image(reader.context, name, span)?;
    let texels = image.texels().iter().copied();
    let brightest = texels.clone().flatten().fold(0.0, f32::max);
    color::check_emission(span, [brightest; 3])?;
    let sum: f64 = texels.map(|texel| f64::from(luminance(texel))).sum();
    let mean = sum / image.texels().len() as f64;
    let pattern = ColorTexture::Image(Arc::new(ImageMap {
        image: Arc::new(image),
        wrap: Wrap::all(Beyond::Clamp),
        filter: ImageFilter::Bilinear,
        change: Change::Scale(1.0),
        mapping: Mapping::IDENTITY,
    }));
    Ok(Some((pattern, mean as f32)))
}

/// Returns the mesh of some of the triangles, with three vertices for each.
fn part(mesh: &Mesh, triangles: Range<usize>) -> Mesh {
    let flat = mesh.triangles[triangles.clone()].as_flattened();
    let corners = flat.iter().map(|&corner| corner as usize);
    let first = |i: u32| [3 * i, 3 * i + 1, 3 * i + 2];
    Mesh {
        positions: corners.clone().map(|i| mesh.positions[i]).collect(),
        normals: corners
            .clone()
            .filter_map(|i| mesh.normals.get(i).copied())
            .collect(),
        uvs: corners.filter_map(|i| mesh.uvs.get(i).copied()).collect(),
        triangles: (0..triangles.len() as u32).map(first).collect(),
        orientation: mesh.orientation,
        ..Mesh::default()
    }
}

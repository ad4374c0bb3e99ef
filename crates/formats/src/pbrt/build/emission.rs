//! The emission of shapes.

use super::color::{self, Purpose};
use super::context::Context;
use super::group;
use super::light;
use super::reader::Reader;
use super::shape::Geometry;
use crate::pbrt::scene::Entity;
use crate::source::{Fault, Span};
use bidir::light::EmissionSides;
use bidir::math::PI;
use bidir::scene::Emission;
use bidir::shape::{Mesh, Shape};
use bidir::spectrum::luminance;
use bidir::texture::{Beyond, Change, ColorTexture, ImageFilter, ImageMap, Mapping, Wrap};
use std::sync::Arc;

/// The emission of an area light.
#[derive(Clone)]
pub(super) struct AreaEmission {
    radiance: [f32; 3],
    /// A texture over the surface's parameters that scales the radiance, and its mean luminance.
    pattern: Option<(ColorTexture, f32)>,
    sides: EmissionSides,
    /// The power of each primitive in the render space. None: the file gives the radiance.
    power: Option<f32>,
    /// The name of its light group.
    pub(super) group: Option<String>,
    span: Span,
}

impl AreaEmission {
    pub(super) fn read(context: &mut Context<'_>, entity: &Entity) -> Result<Self, Fault> {
        let mut reader = Reader::new(context, entity);
        let radiance = color::read(&mut reader, "L", Purpose::Illuminant)?;
        let scale = reader.float_within("scale", 1.0, [0.0, f32::MAX])?;
        let power = reader.optional_float("power")?.filter(|&power| power > 0.0);
        let sides = if reader.bool("twosided", false)? {
            EmissionSides::Both
        } else {
            EmissionSides::Front
        };
        let pattern = pattern(&mut reader)?;
        if radiance.is_some() && pattern.is_some() {
            let message = "an area light has `L` or `filename`, not both";
            return Err(Fault::scene(reader.span(), message));
        }
        let group = group::read(&mut reader)?;
        reader.finish()?;
        let radiance = radiance.unwrap_or([1.0; 3]).map(|channel| channel * scale);
        // Power per area does not depend on the unit, nor does power per squared distance.
        let power = power.map(|power| context.layout.space.intensity(power));
        Ok(Self {
            radiance,
            pattern,
            sides,
            power,
            group,
            span: entity.span,
        })
    }

    /// Returns the emission of a shape. If the file gives power, every primitive has to be a shape of its
    /// own: see [`parts`](Self::parts).
    pub(super) fn of(&self, shape: &Shape) -> Result<Emission, Fault> {
        let factor = match self.power {
            Some(power) => {
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
        let radiance = self.radiance.map(|channel| channel * factor);
        let radiance = color::check_emission(self.span, radiance)?;
        Ok(Emission {
            radiance,
            pattern: self.pattern.as_ref().map(|(pattern, _)| pattern.clone()),
            sides: self.sides,
        })
    }

    /// Returns the number of [`parts`](Self::parts) of a shape.
    pub(super) fn part_count(&self, geometry: &Geometry) -> u64 {
        match (self.power, geometry) {
            (Some(_), Geometry::Mesh(_)) => geometry.primitives(),
            _ => 1,
        }
    }

    /// Returns the parts of a shape that are lights of their own.
    pub(super) fn parts(&self, shape: Shape) -> Vec<Shape> {
        match (self.power, shape) {
            (Some(_), Shape::Mesh(mesh)) => split(&mesh),
            (_, shape) => vec![shape],
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

/// Returns a mesh for every triangle.
fn split(mesh: &Mesh) -> Vec<Shape> {
    let corners = |triangle: &[u32; 3]| triangle.map(|corner| corner as usize);
    let triangles = mesh.triangles.iter().map(corners).map(|corners| Mesh {
        positions: corners.map(|corner| mesh.positions[corner]).into(),
        normals: corners
            .iter()
            .filter_map(|&corner| mesh.normals.get(corner).copied())
            .collect(),
        uvs: corners
            .iter()
            .filter_map(|&corner| mesh.uvs.get(corner).copied())
            .collect(),
        triangles: vec![[0, 1, 2]],
        orientation: mesh.orientation,
        ..Mesh::default()
    });
    triangles.map(Shape::Mesh).collect()
}

//! The pixel filter.

use super::camera::CameraSettings;
use super::context::Context;
use super::reader::Reader;
use crate::pbrt::scene::Entity;
use crate::source::Fault;
use bidir::film::{Filter, FilterKind};
use bidir::math::Vec2;

/// The range of half widths. Unit: pixels.
const RADII: [f32; 2] = [1e-3, 32.0];

/// The valid range of a filter's parameters. Beyond it, a filter is a point or constant, and its integral
/// cannot be computed.
const SHAPES: [f32; 2] = [0.05, 100.0];

/// The radius along an axis below which a filter causes a warning. Unit: pixels.
const NARROW: f32 = 0.25;

/// Builds the pixel filter, or returns the format's default.
///
/// If `camera` sees all around, returns a box of one pixel: opposite edges of the film meet, but no filter
/// crosses them.
pub(super) fn build(context: &mut Context<'_>, camera: &CameraSettings) -> Result<Filter, Fault> {
    let pixel = Filter::new(FilterKind::Box, Vec2::splat(0.5));
    let Some(entity) = &context.document.filter else {
        if camera.sees_all_around() {
            return Ok(pixel);
        }
        let kind = FilterKind::Gaussian { sigma: 0.5 };
        return Ok(Filter::new(kind, Vec2::splat(1.5)));
    };
    let mut reader = Reader::new(context, entity);
    let (kind, radius) = read_kind(&mut reader, entity)?;
    let radius = Vec2::new(
        reader.float_within("xradius", radius, RADII)?,
        reader.float_within("yradius", radius, RADII)?,
    );
    reader.finish()?;
    if camera.sees_all_around() && radius.max_element() > 0.5 {
        let message = "the filter would cross the edges of a spherical image; using a box filter \
             of one pixel";
        context.warn(entity.span, message);
        return Ok(pixel);
    }
    let narrowest = effective_radius(kind, radius.x).min(effective_radius(kind, radius.y));
    if narrowest < NARROW {
        let message = format!(
            "the filter is as narrow as a box with a radius of {narrowest:.3} pixels: light \
             subpaths rarely hit it, so `bdpt` and `light` will be noisy"
        );
        context.warn(entity.span, message);
    }
    Ok(Filter::new(kind, radius))
}

/// Reads the kind of a filter. Returns it with its default radius.
fn read_kind(reader: &mut Reader<'_, '_>, entity: &Entity) -> Result<(FilterKind, f32), Fault> {
    Ok(match entity.kind.as_str() {
        "box" => (FilterKind::Box, 0.5),
        "triangle" => (FilterKind::Triangle, 2.0),
        "mitchell" => {
            let third = 1.0 / 3.0;
            let (b, c) = (reader.float("B", third)?, reader.float("C", third)?);
            (FilterKind::Mitchell { b, c }, 2.0)
        }
        "sinc" => {
            let tau = reader.float_within("tau", 3.0, SHAPES)?;
            (FilterKind::Sinc { tau }, 4.0)
        }
        _ => {
            let sigma = reader.float_within("sigma", 0.5, SHAPES)?;
            (FilterKind::Gaussian { sigma }, 1.5)
        }
    })
}

/// Returns the radius of the box with the same maximum as the filter, along one axis. The filter scales
/// splats, but MIS weights ignore it: the variance of the light image grows with the maximum, and no other
/// strategy compensates.
fn effective_radius(kind: FilterKind, radius: f32) -> f32 {
    let height = Filter::new(kind, Vec2::splat(radius)).eval(Vec2::ZERO);
    0.5 / height.sqrt()
}

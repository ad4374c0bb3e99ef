//! Media whose densities and temperatures are in a NanoVDB file.

use super::super::reader::Reader;
use super::grid::{Cells, build, placed};
use super::{glow, own_coefficients, phase, scale, scaled};
use crate::error::Error;
use crate::nanovdb::{self, CellBox, Grid};
use crate::pbrt::lexer::shorten;
use crate::pbrt::transform::Transforms;
use crate::source::{Fault, Span};
use bidir::medium::Medium;
use glam::{DAffine3, DVec3};

/// Reads a medium of the densities of a file, which are linear between the cells that it numbers, and fade over one
/// cell around those that are active.
pub(super) fn read(reader: &mut Reader<'_, '_>, transforms: &Transforms) -> Result<Medium, Fault> {
    let Some((file, span)) = reader.string("filename")? else {
        return Err(Fault::scene(reader.span(), "the medium has no `filename`"));
    };
    let path = reader.context.document.resolve(file);
    let bytes = reader.context.read_grids(&path, span)?;
    let refuse = |error: Error| Fault::from_error(span, &error.in_file(&path));
    let name = |given: Option<(&str, Span)>, name: &str| {
        given.map_or_else(|| name.to_owned(), |(given, _)| given.to_owned())
    };
    let density_name = name(reader.string("gridname")?, "density");
    let density = nanovdb::find(&bytes, &density_name).map_err(refuse)?;
    let density = density.ok_or_else(|| {
        let message = format!("the file has no grid `{}`", shorten(&density_name));
        Fault::scene(span, message).with_hint("`gridname` is the name of the densities")
    })?;
    let within = density.bounds.grown();
    let values = density.values(within).map_err(refuse)?;
    if let Some(wrong) = values
        .iter()
        .find(|value| !(0.0..=f32::MAX).contains(*value))
    {
        let message = format!(
            "the grid `{}` has the density {wrong}",
            shorten(&density_name)
        );
        return Err(Fault::scene(span, message));
    }
    let cells = cells(reader, transforms, &density, within)?;
    let temperature_name = name(reader.string("temperaturename")?, "temperature");
    let temperatures = nanovdb::find(&bytes, &temperature_name).map_err(refuse)?;
    if let Some(grid) = &temperatures
        && grid.world_from_cells != density.world_from_cells
    {
        let message = "the temperatures have other cells than the densities";
        return Err(Fault::scene(span, message));
    }
    let temperatures = temperatures.map(|grid| grid.values(within)).transpose();
    let temperatures = temperatures.map_err(refuse)?;
    let light = glow::of_temperatures(reader, span, temperatures.as_deref(), cells)?;
    let given = own_coefficients(reader)?.map(|given| given.unwrap_or([1.0; 3]));
    let scale = scale(reader)?;
    let coefficients = scaled(reader, given, scale)?;
    let phase = phase(reader)?;
    let grid = build(
        span,
        values.into_iter().map(|value| [value]).collect(),
        cells,
    )?;
    let medium = Medium::of_density(coefficients, grid, phase);
    let message = "the coefficients of the medium are too large";
    let medium = medium.ok_or_else(|| Fault::scene(span, message))?;
    glow::add(reader, medium, light)
}

/// The cells of a box, each around its number.
fn cells(
    reader: &mut Reader<'_, '_>,
    transforms: &Transforms,
    grid: &Grid<'_>,
    within: CellBox,
) -> Result<Cells, Fault> {
    let size = within.size();
    let first = DVec3::from_array(within.first.map(f64::from)) - 0.5;
    let scale = DVec3::from_array(size.map(|n| n as f64));
    let cube = DAffine3::from_translation(first) * DAffine3::from_scale(scale);
    let place = placed(reader, transforms, grid.world_from_cells * cube)?;
    let size = size.map(|n| n as usize);
    Ok(Cells { size, place })
}

//! Media whose densities and temperatures are in a NanoVDB file.

use super::super::reader::Reader;
use super::grid::{Cells, build, placed};
use super::{Recipe, TOO_DENSE, glow, own_coefficients, phase, ready, scale, scaled};
use crate::import::Content;
use crate::limits::LARGEST_GRID;
use crate::nanovdb::{self, CellBox, Found, Grid};
use crate::pbrt::lexer::shorten;
use crate::pbrt::transform::Transforms;
use crate::source::{Fault, Span};
use bidir::medium::{Coefficients, Glow, HenyeyGreenstein, Medium};
use glam::{DAffine3, DVec3};

/// A grid, and the box of its cells to read.
struct Part {
    grid: Grid,
    within: CellBox,
}

/// The parameters and grids of a medium.
struct Smoke {
    span: Span,
    density: Part,
    temperature: Option<Part>,
    cells: Cells,
    heat: glow::Heat,
    coefficients: Coefficients,
    phase: HenyeyGreenstein,
}

/// Reads a medium from the densities of a file. They are interpolated linearly between the centres of cells, and fade
/// to the background over one cell around the active ones.
pub(super) fn read(reader: &mut Reader<'_, '_>, transforms: &Transforms) -> Result<Recipe, Fault> {
    let Some((name, span)) = reader.string("filename")? else {
        return Err(reader.fault("the medium has no `filename`"));
    };
    let path = reader.context.document.resolve(name);
    let context = &mut *reader.context;
    let bytes = context.read(&path, LARGEST_GRID, Content::Grid, span)?;
    let heat = glow::Heat::read(reader)?;
    let given = own_coefficients(reader)?.map(|given| given.unwrap_or([1.0; 3]));
    let scale = scale(reader)?;
    let coefficients = scaled(reader, given, scale)?;
    let phase = phase(reader)?;
    let density = reader
        .string("gridname")?
        .map_or("density", |(name, _)| name);
    let named = reader.string("temperaturename")?;
    let temperatures = named.map_or("temperature", |(name, _)| name);
    let find = |name| {
        let found = nanovdb::find(&bytes, name);
        found.map_err(|error| Fault::from_error(span, &error.in_file(&path)))
    };
    let grid = match find(density)? {
        Found::Grid(grid) => grid,
        Found::Nothing => {
            let message = format!("the file has no grid `{}`", shorten(density));
            let hint = "`gridname` is the name of the densities";
            return Err(Fault::scene(span, message).with_hint(hint));
        }
        Found::Unsupported(what) => {
            (reader.context).unsupported(span, &what, "vacuum is used instead")?;
            let nothing = scaled(reader, [[0.0; 3]; 2], 1.0)?;
            return Ok(ready(Medium::homogeneous(nothing, phase)));
        }
    };
    let within = grid.bounds.grown();
    let density = Part { grid, within };
    let temperature = match find(temperatures)? {
        Found::Grid(grid) => Some(Part { grid, within }),
        Found::Nothing => None,
        Found::Unsupported(what) => {
            (reader.context).unsupported(span, &what, "the medium does not glow")?;
            None
        }
    };
    if let Some(part) = &temperature
        && !are_close(part.grid.world_from_cells, density.grid.world_from_cells)
    {
        let message = "the temperatures have other cells than the densities";
        return Err(Fault::scene(span, message));
    }
    for part in [Some(&density), temperature.as_ref()].into_iter().flatten() {
        let counted = reader.context.log.reading.cells(part.within.count());
        counted.map_err(|error| Fault::from_error(span, &error))?;
    }
    let cells = cells(reader, transforms, &density)?;
    let smoke = Smoke {
        span,
        density,
        temperature,
        cells,
        heat,
        coefficients,
        phase,
    };
    Ok(Box::new(move || smoke.medium()))
}

/// Returns true if two maps differ only by rounding.
fn are_close(a: DAffine3, b: DAffine3) -> bool {
    let (a, b) = (a.to_cols_array(), b.to_cols_array());
    let size = a.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-6 * size)
}

impl Part {
    fn values(&self, span: Span) -> Result<Vec<f32>, Fault> {
        let values = self.grid.values(self.within);
        values.map_err(|error| Fault::from_error(span, &error))
    }
}

impl Smoke {
    fn medium(&self) -> Result<Medium, Fault> {
        let Self { span, cells, .. } = *self;
        // Filters leave densities a little below 0.
        let densities = self.density.values(span)?.into_iter();
        let values = densities.map(|value| [value.max(0.0)]).collect();
        let grid = build(span, values, cells)?;
        let medium = Medium::of_density(self.coefficients, grid, self.phase);
        let too_dense = || Fault::scene(span, TOO_DENSE);
        glow::add(span, medium.ok_or_else(too_dense)?, self.light()?)
    }

    fn light(&self) -> Result<Option<Glow>, Fault> {
        let Some(part) = &self.temperature else {
            return Ok(None);
        };
        let values = part.values(self.span)?;
        self.heat.glow(self.span, &values, self.cells).map(Some)
    }
}

/// Returns the cells to read, placed so that the centre of each is its index.
fn cells(
    reader: &mut Reader<'_, '_>,
    transforms: &Transforms,
    part: &Part,
) -> Result<Cells, Fault> {
    let size = part.within.size();
    let first = DVec3::from_array(part.within.first.map(f64::from)) - 0.5;
    let scale = DVec3::from_array(size.map(|n| n as f64));
    let cube = DAffine3::from_translation(first) * DAffine3::from_scale(scale);
    let place = placed(reader, transforms, part.grid.world_from_cells * cube)?;
    Ok(Cells {
        size: size.map(|n| n as usize),
        place,
    })
}

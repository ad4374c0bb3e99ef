//! Media whose scene file has a value for each cell of a grid: `uniformgrid` and `rgbgrid`.

use super::super::color::to_rec709;
use super::super::reader::Reader;
use super::{TOO_DENSE, color, glow, own_coefficients, phase, scale, scaled};
use crate::error::ErrorKind;
use crate::import::{box_corners, check_point};
use crate::limits::LONGEST_GRID;
use crate::pbrt::parameters::{Parameter, ParameterType};
use crate::pbrt::transform::Transforms;
use crate::source::{Fault, Span};
use bidir::math::Affine3A;
use bidir::medium::{Grid, Medium};
use color::Purpose;
use glam::{DAffine3, DVec3, Vec3};

/// Reads a medium with a density for each cell.
pub(super) fn uniform(
    reader: &mut Reader<'_, '_>,
    transforms: &Transforms,
) -> Result<Medium, Fault> {
    let cells = cells(reader, transforms)?;
    let given = own_coefficients(reader)?.map(|given| given.unwrap_or([1.0; 3]));
    let scale = scale(reader)?;
    let coefficients = scaled(reader, given, scale)?;
    let light = glow::of_cells(reader, cells)?;
    let phase = phase(reader)?;
    let Some(density) = reader.find(ParameterType::Float, "density") else {
        return Err(reader.fault("the medium has no `density`"));
    };
    let densities = numbers(density, cells.size, 1)?.iter();
    let values = densities.map(|&value| [value]).collect();
    let grid = build(density.value_span, values, cells)?;
    let medium = Medium::of_density(coefficients, grid, phase);
    glow::add(
        reader.span(),
        medium.ok_or_else(|| too_dense(density))?,
        light,
    )
}

/// Reads a medium with coefficients for each cell.
pub(super) fn rgb(reader: &mut Reader<'_, '_>, transforms: &Transforms) -> Result<Medium, Fault> {
    let cells = cells(reader, transforms)?;
    let scale = scale(reader)? * reader.context.layout.space.unit as f32;
    let light = glow::of_colors(reader, cells)?;
    let phase = phase(reader)?;
    let [absorption, scattering] =
        ["sigma_a", "sigma_s"].map(|name| reader.find(ParameterType::Rgb, name));
    if light.is_some() && absorption.is_none() {
        return Err(reader.fault("a medium with `Le` needs `sigma_a`"));
    }
    let Some(any) = absorption.or(scattering) else {
        return Err(reader.fault("the medium has neither `sigma_a` nor `sigma_s`"));
    };
    let count = numbers(any, cells.size, 3)?.len() / 3;
    let read = |parameter: Option<&Parameter>| {
        // Coefficients that the file does not have are 1.
        let Some(parameter) = parameter else {
            return Ok(vec![[scale; 3]; count]);
        };
        let values = numbers(parameter, cells.size, 3)?;
        let colors = values.as_chunks::<3>().0.iter();
        let convert = |&rgb| to_rec709(parameter.color_space, rgb, Purpose::Unbounded);
        Ok(colors
            .map(|rgb| convert(rgb).map(|channel| channel.max(0.0) * scale))
            .collect::<Vec<_>>())
    };
    let [absorption, scattering] = [read(absorption)?, read(scattering)?];
    let sum = |(a, s): (&[f32; 3], &[f32; 3])| std::array::from_fn(|i| a[i] + s[i]);
    let sums = absorption.iter().zip(&scattering).map(sum).collect();
    let extinction = build(any.value_span, sums, cells)?;
    let scattered = build(any.value_span, scattering, cells)?;
    let medium = Medium::chromatic(extinction, scattered, phase);
    glow::add(reader.span(), medium.ok_or_else(|| too_dense(any))?, light)
}

/// The size and the placement of a grid of cells.
#[derive(Clone, Copy)]
pub(super) struct Cells {
    /// Number of cells along each axis.
    pub(super) size: [usize; 3],
    /// The map from the unit cube to the box in the render space.
    pub(super) place: Affine3A,
}

impl Cells {
    /// Returns the number of all cells.
    pub(super) fn count(&self) -> usize {
        self.size.iter().product()
    }
}

fn cells(reader: &mut Reader<'_, '_>, transforms: &Transforms) -> Result<Cells, Fault> {
    let place = place(reader, transforms)?;
    let size = size(reader)?;
    Ok(Cells { size, place })
}

/// Reads the corners of the box, and returns the map from the unit cube to it, in the render space.
pub(super) fn place(
    reader: &mut Reader<'_, '_>,
    transforms: &Transforms,
) -> Result<Affine3A, Fault> {
    let [low, high] = [
        reader.point3("p0", [0.0; 3])?,
        reader.point3("p1", [1.0; 3])?,
    ]
    .map(|corner| Vec3::from_array(corner).as_dvec3());
    if !low.cmplt(high).all() {
        return Err(reader
            .fault("the box of the medium is empty: `p0` must be below `p1` in every coordinate"));
    }
    let cube = DAffine3::from_translation(low) * DAffine3::from_scale(high - low);
    placed(reader, transforms, cube)
}

/// Returns the map from the unit cube to the render space; `cube` maps the unit cube to the medium's own space.
pub(super) fn placed(
    reader: &mut Reader<'_, '_>,
    transforms: &Transforms,
    cube: DAffine3,
) -> Result<Affine3A, Fault> {
    if transforms.is_animated() {
        let (span, what) = (reader.span(), "a medium that moves");
        let substitute = "it stays where it is at the start";
        reader.context.unsupported(span, what, substitute)?;
    }
    let placed = reader.context.place(transforms) * cube;
    for corner in box_corners([DVec3::ZERO, DVec3::ONE]) {
        check_point(placed.transform_point3(corner), &reader.span())?;
    }
    Ok(Affine3A {
        matrix3: placed.matrix3.as_mat3().into(),
        translation: placed.translation.as_vec3a(),
    })
}

/// Reads the number of cells along each axis.
fn size(reader: &mut Reader<'_, '_>) -> Result<[usize; 3], Fault> {
    let mut count = |name| Ok(reader.integer(name, 1, 1)? as usize);
    Ok([count("nx")?, count("ny")?, count("nz")?])
}

/// Returns the values of a parameter with `channels` numbers for each cell. Errors: one is negative or not finite, or
/// their number is wrong.
pub(super) fn numbers(
    parameter: &Parameter,
    size: [usize; 3],
    channels: usize,
) -> Result<&[f32], Fault> {
    let values = signed_numbers(parameter, size, channels)?;
    let is_wrong = |value: &&f32| !(0.0..=f32::MAX).contains(*value);
    if let Some(wrong) = values.iter().find(is_wrong) {
        let message = format!(
            "`{}` has the value {wrong}, but must have none below 0",
            parameter.name
        );
        return Err(Fault::scene(parameter.value_span, message));
    }
    Ok(values)
}

/// Returns the values of a parameter with `channels` numbers for each cell. Errors: their number is wrong.
pub(super) fn signed_numbers(
    parameter: &Parameter,
    size: [usize; 3],
    channels: usize,
) -> Result<&[f32], Fault> {
    let expected = size.iter().try_fold(channels, |n, &k| n.checked_mul(k));
    let values = parameter.values.floats();
    if expected != Some(values.len()) {
        let [nx, ny, nz] = size;
        let message = format!(
            "`{}` has {} values, but must have {nx} · {ny} · {nz}",
            parameter.name,
            values.len() / channels
        );
        return Err(Fault::scene(parameter.value_span, message));
    }
    Ok(values)
}

fn too_dense(parameter: &Parameter) -> Fault {
    Fault::scene(parameter.value_span, TOO_DENSE)
}

/// Returns the grid of these values; `span` is the place of errors.
pub(super) fn build<const N: usize>(
    span: Span,
    values: Vec<[f32; N]>,
    cells: Cells,
) -> Result<Grid<N>, Fault> {
    let [nx, ny, nz] = cells.size;
    if nx.max(ny).max(nz) > LONGEST_GRID {
        let message = format!(
            "the grid has {nx} · {ny} · {nz} cells, but may have only {LONGEST_GRID} along an axis"
        );
        let hint = "make it coarser, or cut it into media side by side";
        return Err(Fault::new(ErrorKind::Limit, span, message).with_hint(hint));
    }
    Grid::new(cells.size, values, cells.place).ok_or_else(|| {
        let message = "the box of the medium has no volume, or its coefficients are too large";
        Fault::scene(span, message)
    })
}

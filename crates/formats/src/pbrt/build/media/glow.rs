//! Emission of media, L_e: a colour, a colour for each cell, or a temperature for each cell.

use super::super::color::{self, Purpose, check_emission, scaled_light, to_rec709};
use super::super::reader::Reader;
use super::grid::{Cells, build, numbers, signed_numbers};
use crate::pbrt::parameters::ParameterType;
use crate::source::{Fault, Span};
use bidir::medium::{Glow, Medium};
use bidir::spectrum::{self, Rgb};
use std::sync::LazyLock;

/// Temperature up to which L_e is 0. Unit: K.
const COLD: f32 = 100.0;
/// The largest temperature. Unit: K.
const HOTTEST: f32 = 1e8;

/// Adds emission to a medium. Errors: it emits too much light.
pub(super) fn add(span: Span, medium: Medium, glow: Option<Glow>) -> Result<Medium, Fault> {
    let Some(glow) = glow else { return Ok(medium) };
    medium
        .glowing(glow)
        .ok_or_else(|| Fault::scene(span, "the medium emits too much light"))
}

/// Reads L_e of a homogeneous medium. None: it does not emit.
pub(super) fn even(reader: &mut Reader<'_, '_>) -> Result<Option<Glow>, Fault> {
    let radiance = color::read_light(reader, "Le")?;
    let scale = reader.float_within("Lescale", 1.0, [0.0, f32::MAX])?;
    let glow = |radiance| scaled_light(reader.span(), radiance, scale).map(Glow::Even);
    radiance.map(glow).transpose()
}

/// Reads L_e of a `uniformgrid`: a colour or temperatures, times a factor for each cell. None: it does not emit.
pub(super) fn of_cells(reader: &mut Reader<'_, '_>, cells: Cells) -> Result<Option<Glow>, Fault> {
    let light = color::read_light(reader, "Le")?;
    let scale = reader.find(ParameterType::Float, "Lescale");
    let temperatures = temperatures(reader, cells)?;
    let factors = match scale {
        Some(scale) => Some(numbers(scale, cells.size, 1)?),
        None => None,
    };
    let factor = |i: usize| factors.map_or(1.0, |factors| factors[i]);
    let radiance: Vec<Rgb> = match (light, temperatures) {
        (None, None) => return Ok(None),
        (Some(_), Some(_)) => {
            return Err(reader.fault("the medium has both `Le` and `temperature`"));
        }
        (Some(light), None) if scale.is_none() => {
            let radiance = scaled_light(reader.span(), light, 1.0)?;
            return Ok(Some(Glow::Even(radiance)));
        }
        (Some(light), None) => vec![light.color(); cells.count()],
        (None, Some(radiance)) => radiance,
    };
    let numbered = radiance.iter().enumerate();
    let values = numbered.map(|(i, &radiance)| bright(reader, scaled(radiance, factor(i))));
    grid(reader, values.collect::<Result<_, _>>()?, cells)
}

/// Reads L_e of an `rgbgrid`, which the format does not normalise: white has the luminance of a spectrum that is 1
/// everywhere. None: it does not emit.
pub(super) fn of_colors(reader: &mut Reader<'_, '_>, cells: Cells) -> Result<Option<Glow>, Fault> {
    let scale = reader.float_within("Lescale", 1.0, [0.0, f32::MAX])? * spectrum::LUMINANCE_OF_ONE;
    let Some(parameter) = reader.find(ParameterType::Rgb, "Le") else {
        return Ok(None);
    };
    let colors = numbers(parameter, cells.size, 3)?.as_chunks::<3>().0.iter();
    let values = colors.map(|&color| {
        let rgb = to_rec709(parameter.color_space, color, Purpose::Illuminant);
        bright(reader, scaled(rgb.map(|channel| channel.max(0.0)), scale))
    });
    grid(reader, values.collect::<Result<_, _>>()?, cells)
}

/// Reads the temperature of each cell, and returns L_e of black bodies. None: the file has no temperatures.
fn temperatures(reader: &mut Reader<'_, '_>, cells: Cells) -> Result<Option<Vec<Rgb>>, Fault> {
    let [offset, scale] = kelvins(reader)?;
    let Some(parameter) = reader.find(ParameterType::Float, "temperature") else {
        return Ok(None);
    };
    let values = signed_numbers(parameter, cells.size, 1)?;
    let to_kelvin = |value| (value - offset) * scale;
    black_bodies(parameter.value_span, values, to_kelvin).map(Some)
}

/// The map from the temperatures in a file to L_e.
pub(super) struct Heat {
    offset: f32,
    scale: f32,
    factor: f32,
}

impl Heat {
    /// Reads the map from the numbers of a file to L_e.
    pub(super) fn read(reader: &mut Reader<'_, '_>) -> Result<Self, Fault> {
        let [offset, scale] = kelvins(reader)?;
        let factor = reader.float_within("Lescale", 1.0, [0.0, f32::MAX])?;
        Ok(Self {
            offset,
            scale,
            factor,
        })
    }

    /// Returns L_e of cells with these temperatures; `span` is the place of errors.
    pub(super) fn glow(&self, span: Span, values: &[f32], cells: Cells) -> Result<Glow, Fault> {
        let to_kelvin = |value| (value - self.offset) * self.scale;
        let bodies = black_bodies(span, values, to_kelvin)?.into_iter();
        let glows = bodies.map(|radiance| check_emission(span, scaled(radiance, self.factor)));
        build(span, glows.collect::<Result<_, _>>()?, cells).map(Glow::Grid)
    }
}

/// Reads `[offset, scale]`, which map numbers of the file to (number - offset) · scale. Unit: K.
fn kelvins(reader: &mut Reader<'_, '_>) -> Result<[f32; 2], Fault> {
    let old = reader.float("temperaturecutoff", 0.0)?;
    let offset = reader.float("temperatureoffset", old)?;
    Ok([offset, reader.float("temperaturescale", 1.0)?])
}

/// Returns L_e of black bodies, relative to the peak of Planck's law, as the format defines it; `span` is the place of
/// errors.
fn black_bodies(
    span: Span,
    values: &[f32],
    to_kelvin: impl Fn(f32) -> f32,
) -> Result<Vec<Rgb>, Fault> {
    let radiance = |&value: &f32| {
        let kelvin = to_kelvin(value);
        if !(f32::MIN..=HOTTEST).contains(&kelvin) {
            let message = format!("a temperature is above {HOTTEST:e} kelvin, or not a number");
            return Err(Fault::scene(span, message));
        }
        Ok(black_body(kelvin))
    };
    values.iter().map(radiance).collect()
}

/// Returns L_e of a black body from a table. Interpolates linearly in 1/T, as log L_e is nearly linear in it.
fn black_body(kelvin: f32) -> Rgb {
    const STEPS: usize = 4096;
    static TABLE: LazyLock<Vec<Rgb>> = LazyLock::new(|| {
        let inverse = |i: usize| i as f64 / STEPS as f64 / f64::from(COLD);
        let kelvins = (0..=STEPS).map(|i| 1.0 / inverse(i).max(1.0 / f64::from(HOTTEST)));
        kelvins.map(spectrum::black_body).collect()
    });
    if kelvin <= COLD {
        return [0.0; 3];
    }
    let place = COLD / kelvin * STEPS as f32;
    let i = (place as usize).min(STEPS - 1);
    let [low, high] = [TABLE[i], TABLE[i + 1]];
    std::array::from_fn(|k| low[k] + (high[k] - low[k]) * (place - i as f32))
}

fn scaled(radiance: Rgb, scale: f32) -> Rgb {
    radiance.map(|channel| channel * scale)
}

fn bright(reader: &Reader<'_, '_>, radiance: Rgb) -> Result<Rgb, Fault> {
    check_emission(reader.span(), radiance)
}

fn grid(reader: &Reader<'_, '_>, values: Vec<Rgb>, cells: Cells) -> Result<Option<Glow>, Fault> {
    build(reader.span(), values, cells).map(|grid| Some(Glow::Grid(grid)))
}

//! Light of media: L_e, by a colour, by colours of cells, or by their temperatures.

use super::super::color::{self, Purpose, check_emission, to_rec709};
use super::super::reader::Reader;
use super::grid::{Cells, build, numbers};
use crate::pbrt::parameters::ParameterType;
use crate::source::{Fault, Span};
use crate::spectra;
use bidir::medium::{Glow, Medium};
use bidir::spectrum::Rgb;

/// The temperature up to which nothing glows. Unit: K.
const COLD: f32 = 100.0;
/// The largest temperature. Unit: K.
const HOTTEST: f32 = 1e8;

/// Gives a medium its light, if it has any.
pub(super) fn add(
    reader: &Reader<'_, '_>,
    medium: Medium,
    glow: Option<Glow>,
) -> Result<Medium, Fault> {
    let Some(glow) = glow else { return Ok(medium) };
    medium
        .glowing(glow)
        .ok_or_else(|| Fault::scene(reader.span(), "the medium emits too much light"))
}

/// Reads L_e of a medium that is the same everywhere.
pub(super) fn even(reader: &mut Reader<'_, '_>) -> Result<Option<Glow>, Fault> {
    let radiance = color::read(reader, "Le", Purpose::Illuminant)?;
    let scale = reader.float_within("Lescale", 1.0, [0.0, f32::MAX])?;
    let glow = |radiance| bright(reader, scaled(radiance, scale)).map(Glow::Even);
    radiance.map(glow).transpose()
}

/// Reads L_e of a medium of densities: a colour or temperatures, times a factor for each cell.
pub(super) fn of_cells(reader: &mut Reader<'_, '_>, cells: Cells) -> Result<Option<Glow>, Fault> {
    let radiance = color::read(reader, "Le", Purpose::Illuminant)?;
    let factors = reader.find(ParameterType::Float, "Lescale");
    let temperatures = temperatures(reader, cells)?;
    let factor = match factors {
        Some(factors) => Some(numbers(factors, cells.size, 1)?),
        None => None,
    };
    let factor = |i: usize| factor.map_or(1.0, |factor| factor[i]);
    let radiance: Vec<Rgb> = match (radiance, temperatures) {
        (None, None) => return Ok(None),
        (Some(_), Some(_)) => {
            let message = "the medium has both `Le` and `temperature`";
            return Err(Fault::scene(reader.span(), message));
        }
        (Some(radiance), None) if factors.is_none() => {
            return bright(reader, radiance).map(|radiance| Some(Glow::Even(radiance)));
        }
        (Some(radiance), None) => vec![radiance; cells.count()],
        (None, Some(radiance)) => radiance,
    };
    let values = radiance.iter().enumerate();
    let values = values.map(|(i, &radiance)| bright(reader, scaled(radiance, factor(i))));
    grid(reader, values.collect::<Result<_, _>>()?, cells)
}

/// Reads L_e of a medium of colours, which the format does not normalise: white has the luminance of a spectrum that
/// is 1 everywhere.
pub(super) fn of_colors(reader: &mut Reader<'_, '_>, cells: Cells) -> Result<Option<Glow>, Fault> {
    let scale = reader.float_within("Lescale", 1.0, [0.0, f32::MAX])? * spectra::LUMINANCE_OF_ONE;
    let Some(parameter) = reader.find(ParameterType::Rgb, "Le") else {
        return Ok(None);
    };
    let values = numbers(parameter, cells.size, 3)?.as_chunks::<3>().0.iter();
    let values = values.map(|&rgb| {
        let rgb = to_rec709(parameter.color_space, rgb, Purpose::Illuminant);
        bright(reader, scaled(rgb.map(|channel| channel.max(0.0)), scale))
    });
    grid(reader, values.collect::<Result<_, _>>()?, cells)
}

/// Reads L_e of black bodies of the temperatures of cells.
fn temperatures(reader: &mut Reader<'_, '_>, cells: Cells) -> Result<Option<Vec<Rgb>>, Fault> {
    let to_kelvin = kelvins(reader)?;
    let Some(parameter) = reader.find(ParameterType::Float, "temperature") else {
        return Ok(None);
    };
    let values = numbers(parameter, cells.size, 1)?;
    black_bodies(parameter.value_span, values, to_kelvin).map(Some)
}

/// Reads L_e of the temperatures of a file's cells, which stand at `span`, if it has any.
pub(super) fn of_temperatures(
    reader: &mut Reader<'_, '_>,
    span: Span,
    temperatures: Option<&[f32]>,
    cells: Cells,
) -> Result<Option<Glow>, Fault> {
    let to_kelvin = kelvins(reader)?;
    let scale = reader.float_within("Lescale", 1.0, [0.0, f32::MAX])?;
    let Some(temperatures) = temperatures else {
        return Ok(None);
    };
    let values = black_bodies(span, temperatures, to_kelvin)?.into_iter();
    let values = values.map(|radiance| bright(reader, scaled(radiance, scale)));
    grid(reader, values.collect::<Result<_, _>>()?, cells)
}

/// Reads the map from the numbers of a file to K.
fn kelvins(reader: &mut Reader<'_, '_>) -> Result<impl Fn(f32) -> f32 + use<>, Fault> {
    let old = reader.float("temperaturecutoff", 0.0)?;
    let offset = reader.float("temperatureoffset", old)?;
    let scale = reader.float("temperaturescale", 1.0)?;
    Ok(move |value| (value - offset) * scale)
}

/// L_e of black bodies, by Planck's law relative to its peak, as the format has it; from a table, between whose
/// entries it is linear. The values stand at `span`.
fn black_bodies(
    span: Span,
    values: &[f32],
    to_kelvin: impl Fn(f32) -> f32,
) -> Result<Vec<Rgb>, Fault> {
    const STEPS: usize = 4096;
    let kelvins: Vec<f32> = values.iter().map(|&value| to_kelvin(value)).collect();
    let hottest = kelvins.iter().copied().fold(COLD, f32::max);
    if hottest > HOTTEST || kelvins.iter().any(|kelvin| kelvin.is_nan()) {
        let message = format!("a temperature is above {HOTTEST:e} kelvin, or not a number");
        return Err(Fault::scene(span, message));
    }
    let step = (hottest - COLD) / STEPS as f32;
    let table: Vec<Rgb> = (0..=STEPS)
        .map(|i| spectra::black_body(f64::from(COLD + step * i as f32)))
        .collect();
    let at = |&kelvin: &f32| {
        if kelvin <= COLD {
            return [0.0; 3];
        }
        let place = (kelvin - COLD) / step;
        let i = (place as usize).min(STEPS - 1);
        let [low, high] = [table[i], table[i + 1]];
        std::array::from_fn(|k| low[k] + (high[k] - low[k]) * (place - i as f32))
    };
    Ok(kelvins.iter().map(at).collect())
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

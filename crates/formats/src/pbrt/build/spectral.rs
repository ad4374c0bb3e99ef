//! Reads spectra given by samples, names, files or temperatures.

use super::color::{self, Purpose};
use super::context::Context;
use super::reader::{Reader, single};
use crate::pbrt::lexer::shorten;
use crate::pbrt::parameters::{Parameter, ParameterType, Values};
use crate::source::{Fault, Span};
use crate::spectra::{self, Beyond, Spectrum};
use crate::text::number;
use bidir::spectrum::{Rgb, luminance};

/// The range of temperatures, beyond which no light is visible. Unit: K.
const TEMPERATURES: [f32; 2] = [100.0, 1e8];

/// Reads a parameter given as `spectrum` or `blackbody`. None: the file has none.
pub(super) fn read<'a>(
    reader: &mut Reader<'a, '_>,
    name: &'static str,
) -> Result<Option<(Spectrum, &'a Parameter)>, Fault> {
    if let Some(parameter) = reader.find(ParameterType::Spectrum, name) {
        return Ok(Some((spectrum(reader.context, parameter)?, parameter)));
    }
    let Some(parameter) = reader.find(ParameterType::Blackbody, name) else {
        return Ok(None);
    };
    let kelvin = *single(parameter, parameter.values.floats())?;
    if !(TEMPERATURES[0]..=TEMPERATURES[1]).contains(&kelvin) {
        let [low, high] = TEMPERATURES.map(number);
        let found = number(kelvin);
        let message =
            format!("a temperature must be between {low} and {high} kelvin, found {found}");
        return Err(Fault::scene(parameter.value_span, message));
    }
    Ok(Some((Spectrum::blackbody(f64::from(kelvin)), parameter)))
}

fn spectrum(context: &mut Context<'_>, parameter: &Parameter) -> Result<Spectrum, Fault> {
    match &parameter.values {
        Values::Strings(names) => named(context, parameter, single(parameter, names)?),
        Values::Floats(values) => {
            let numbers: Vec<f64> = values.iter().copied().map(f64::from).collect();
            if numbers.len() == 2 {
                let message = "a spectrum of one sample is zero at all other wavelengths";
                context.warn(parameter.value_span, message);
            }
            Spectrum::from_pairs(&numbers, Beyond::Zero)
                .map_err(|error| Fault::scene(parameter.value_span, error))
        }
        _ => Err(Fault::scene(parameter.value_span, "expected a spectrum")),
    }
}

/// Returns the format's spectrum of this name, or else reads the file of this name.
fn named(context: &mut Context<'_>, parameter: &Parameter, name: &str) -> Result<Spectrum, Fault> {
    if let Some(spectrum) = spectra::named(name) {
        return Ok(spectrum);
    }
    let span = parameter.value_span;
    let path = context.document.resolve(name);
    if path.is_file() {
        return context.read_spectrum(&path, span);
    }
    let known: Vec<String> = spectra::names().collect();
    let message = format!(
        "`{}` is neither a spectrum's name nor a file",
        shorten(name)
    );
    let fault = Fault::scene(span, message).with_nearest(name, known.iter().map(String::as_str));
    if fault.hint.is_some() {
        return Err(fault);
    }
    Err(fault.with_hint("files have pairs of wavelength (nm) and value"))
}

/// Reads the index of refraction of a metal from the spectra `eta` and `k`, by default those of copper.
/// None: one of them is not a spectrum.
pub(super) fn read_metal(
    reader: &mut Reader<'_, '_>,
    eta: &'static str,
    k: &'static str,
) -> Result<Option<(Rgb, Rgb)>, Fault> {
    let mut part = |name, copper| -> Result<Option<Spectrum>, Fault> {
        let is_color = reader.find(ParameterType::Rgb, name).is_some();
        if is_color || reader.find(ParameterType::Texture, name).is_some() {
            return Ok(None);
        }
        let given = read(reader, name)?;
        Ok(given.map_or_else(|| spectra::named(copper), |(given, _)| Some(given)))
    };
    let parts = (part(eta, "metal-Cu-eta")?, part(k, "metal-Cu-k")?);
    Ok(match parts {
        (Some(eta), Some(k)) => Some(spectra::conductor(&eta, &k)),
        _ => None,
    })
}

/// Reads the index of refraction `name` of a dielectric: a number, the luminance of a colour, or the value of
/// a spectrum at the d line.
pub(super) fn read_eta(
    reader: &mut Reader<'_, '_>,
    name: &'static str,
    default: f32,
) -> Result<f32, Fault> {
    let number = reader.optional_float(name)?;
    let Some((eta, span)) = spectral_eta(reader, name)? else {
        return positive(reader, name, number.unwrap_or(default));
    };
    if number.is_some() {
        let message = format!("`float {name}` has no effect beside the spectrum `{name}`");
        reader.context.warn(span, message);
    }
    positive(reader, name, eta)
}

/// Reads an index of refraction that depends on the wavelength, and replaces it by a constant one. None: the file
/// has none.
fn spectral_eta(
    reader: &mut Reader<'_, '_>,
    name: &'static str,
) -> Result<Option<(f32, Span)>, Fault> {
    let (eta, span, is_constant) = if let Some(parameter) = reader.find(ParameterType::Rgb, name) {
        let rgb = color::rgb(parameter, Purpose::Unbounded)?;
        let bits = rgb.map(f32::to_bits);
        let is_grey = bits == [bits[0]; 3];
        let eta = if is_grey { rgb[0] } else { luminance(rgb) };
        (eta, parameter.value_span, is_grey)
    } else if let Some((spectrum, parameter)) = read(reader, name)? {
        (spectrum.index(), parameter.value_span, false)
    } else {
        return Ok(None);
    };
    if !is_constant {
        let message =
            format!("`{name}` has no dispersion here: the index is {eta:.4} at every wavelength");
        reader.context.warn(span, message);
    }
    Ok(Some((eta, span)))
}

fn positive(reader: &Reader<'_, '_>, name: &str, eta: f32) -> Result<f32, Fault> {
    if eta > 0.0 {
        Ok(eta)
    } else {
        let message = format!("the index of refraction `{name}` is not positive");
        Err(reader.fault(message))
    }
}

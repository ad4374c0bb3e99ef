//! Reads spectra given by samples, names, files or temperatures.

use super::color::{self, Purpose};
use super::context::Context;
use super::reader::{Reader, single};
use crate::pbrt::lexer::shorten;
use crate::pbrt::parameters::{Parameter, ParameterType, Values};
use crate::source::{Fault, Span};
use crate::text::number;
use bidir::spectrum::{self, Beyond, Curve, Metal, RefractiveIndex, luminance};

/// The range of temperatures, beyond which no light is visible. Unit: K.
const TEMPERATURES: [f32; 2] = [100.0, 1e8];

/// Reads a parameter given as `spectrum` or `blackbody`. None: the file has none.
pub(super) fn read<'a>(
    reader: &mut Reader<'a, '_>,
    name: &'static str,
) -> Result<Option<(Curve, &'a Parameter)>, Fault> {
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
    Ok(Some((Curve::blackbody(f64::from(kelvin)), parameter)))
}

fn spectrum(context: &mut Context<'_>, parameter: &Parameter) -> Result<Curve, Fault> {
    match &parameter.values {
        Values::Strings(names) => named(context, parameter, single(parameter, names)?),
        Values::Floats(values) => {
            let numbers: Vec<f64> = values.iter().copied().map(f64::from).collect();
            if numbers.len() == 2 {
                let message = "a spectrum of one sample is zero at all other wavelengths";
                context.warn(parameter.value_span, message);
            }
            Curve::from_pairs(&numbers, Beyond::Zero)
                .map_err(|error| Fault::scene(parameter.value_span, error.to_string()))
        }
        _ => Err(Fault::scene(parameter.value_span, "expected a spectrum")),
    }
}

/// Reads a text of pairs; `#` begins a comment. Errors: the reason why it is no spectrum.
pub(super) fn parse(text: &str) -> Result<Curve, String> {
    let mut numbers = Vec::new();
    for (line, content) in (1..).zip(text.lines()) {
        let content = content.split('#').next().unwrap_or_default();
        let words = content.split(|c: char| c.is_whitespace() || c == ',');
        for word in words.filter(|word| !word.is_empty()) {
            let number = word.parse().ok().filter(|number: &f64| number.is_finite());
            let wrong =
                || format!("line {line} of the spectrum has something that is not a number");
            numbers.push(number.ok_or_else(wrong)?);
        }
    }
    Curve::from_pairs(&numbers, Beyond::Zero).map_err(|error| error.to_string())
}

/// Returns the format's spectrum of this name, or else reads the file of this name.
fn named(context: &mut Context<'_>, parameter: &Parameter, name: &str) -> Result<Curve, Fault> {
    if let Some(spectrum) = spectrum::named(name) {
        return Ok(spectrum);
    }
    let span = parameter.value_span;
    let path = context.document.resolve(name);
    if path.is_file() {
        return context.read_spectrum(&path, span);
    }
    let known: Vec<String> = spectrum::names().collect();
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
) -> Result<Option<Metal>, Fault> {
    let mut part = |name, copper| -> Result<Option<Curve>, Fault> {
        let is_color = reader.find(ParameterType::Rgb, name).is_some();
        if is_color || reader.find(ParameterType::Texture, name).is_some() {
            return Ok(None);
        }
        let given = read(reader, name)?;
        Ok(given.map_or_else(|| spectrum::named(copper), |(given, _)| Some(given)))
    };
    let (eta, k) = (part(eta, "metal-Cu-eta")?, part(k, "metal-Cu-k")?);
    Ok(eta.zip(k).map(|(eta, k)| Metal::new(eta, k)))
}

/// Reads the index of refraction `name` of a dielectric: a number, the luminance of a colour, or a spectrum.
pub(super) fn read_eta(
    reader: &mut Reader<'_, '_>,
    name: &'static str,
    default: f32,
) -> Result<RefractiveIndex, Fault> {
    let number = reader.optional_float(name)?;
    let given = spectral_eta(reader, name)?;
    if let (Some(_), Some((_, span))) = (number, &given) {
        let message = format!("`float {name}` has no effect beside the spectrum `{name}`");
        reader.context.warn(*span, message);
    }
    let constant = || number.unwrap_or(default).into();
    let eta = given.map_or_else(constant, |(eta, _)| eta);
    if eta.at_d_line() > 0.0 {
        return Ok(eta);
    }
    let message = format!("the index of refraction `{name}` is not positive");
    Err(reader.fault(message))
}

/// Reads an index of refraction that depends on the wavelength, and its place. None: the file has none.
fn spectral_eta(
    reader: &mut Reader<'_, '_>,
    name: &'static str,
) -> Result<Option<(RefractiveIndex, Span)>, Fault> {
    let (eta, span, is_constant) = if let Some(parameter) = reader.find(ParameterType::Rgb, name) {
        let rgb = color::rgb(parameter, Purpose::Unbounded)?;
        let bits = rgb.map(f32::to_bits);
        let is_grey = bits == [bits[0]; 3];
        let eta = if is_grey { rgb[0] } else { luminance(rgb) };
        (eta.into(), parameter.value_span, is_grey)
    } else if let Some((curve, parameter)) = read(reader, name)? {
        let eta = RefractiveIndex::of_curve(curve);
        (eta, parameter.value_span, false)
    } else {
        return Ok(None);
    };
    if !is_constant {
        let constant = eta.at_d_line();
        let message = format!(
            "`{name}` has no dispersion here: the index is {constant:.4} at every wavelength"
        );
        reader.context.warn(span, message);
    }
    Ok(Some((eta, span)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_pairs_with_comments() {
        let spectrum = parse("# a lamp\n400 1\n 500, 3 # peak\n\n600\t0").unwrap();
        assert!((spectrum.at(450.0) - 2.0).abs() < 1e-12);
        for (text, words) in [
            ("", "at least one pair"),
            ("400 1 500", "has no value"),
            ("400 1\n500 x", "line 2"),
            ("400 1\n500 nan", "line 2"),
            ("500 1 400 2", "must increase"),
            ("500 1 500 2", "must increase"),
        ] {
            let reason = parse(text).unwrap_err();
            assert!(reason.contains(words), "{text:?}: {reason}");
        }
    }
}

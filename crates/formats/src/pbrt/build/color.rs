//! Colours and spectra as linear Rec. 709.

use super::context::Context;
use super::reader::{Reader, single, three};
use crate::error::ErrorKind;
use crate::pbrt::parameters::{Parameter, ParameterType, Values};
use crate::pbrt::scene::ColorSpace;
use crate::source::{Fault, Span};
use bidir::spectrum::Rgb;
use glam::{DMat3, DVec3};

/// Real and imaginary index of refraction of the named metals at 650, 550 and 450 nm.
const METALS: &[(&str, Rgb, Rgb)] = &[
    ("Ag", [0.139, 0.125, 0.152], [4.129, 3.340, 2.470]),
    ("Al", [1.475, 0.959, 0.618], [7.794, 6.687, 5.469]),
    ("Au", [0.168, 0.350, 1.508], [3.138, 2.714, 1.879]),
    ("Cu", [0.217, 0.958, 1.166], [3.638, 2.577, 2.394]),
    ("CuZn", [0.444, 0.527, 1.094], [3.695, 2.765, 1.829]),
    ("MgO", [1.734, 1.740, 1.752], [0.0, 0.0, 0.0]),
    ("TiO2", [2.860, 2.955, 3.165], [0.0, 0.0, 0.0]),
];

/// η and k of copper: what a conductor is made of unless the file says otherwise.
pub(super) const COPPER: (Rgb, Rgb) = (METALS[3].1, METALS[3].2);

/// Index of refraction of the named glasses at 550 nm.
const GLASSES: &[(&str, f32)] = &[
    ("glass-BK7", 1.5185),
    ("glass-BAF10", 1.6731),
    ("glass-FK51A", 1.4878),
    ("glass-LASF9", 1.8558),
    ("glass-F5", 1.6771),
    ("glass-SF5", 1.6771),
    ("glass-F10", 1.7336),
    ("glass-SF10", 1.7336),
    ("glass-F11", 1.7911),
    ("glass-SF11", 1.7911),
];

/// What a colour is for: what values it may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Purpose {
    /// Between 0 and 1.
    Albedo,
    /// Not negative.
    Unbounded,
    /// Not negative; relative to the white of its colour space.
    Illuminant,
}

impl Purpose {
    /// The largest value.
    fn most(self) -> f32 {
        match self {
            Self::Albedo => 1.0,
            Self::Unbounded | Self::Illuminant => f32::MAX,
        }
    }

    /// Refuses values that are too large.
    fn check(self, parameter: &Parameter, value: Rgb) -> Result<Rgb, Fault> {
        if value.iter().all(|&channel| channel <= self.most()) {
            return Ok(value);
        }
        let message = format!("the reflectance `{}` is above 1", parameter.name);
        Err(Fault::scene(parameter.value_span, message))
    }
}

/// Reads a colour given as `rgb`, `spectrum` or `blackbody`. None: where the file gives none.
pub(super) fn read(
    context: &mut Context<'_>,
    reader: &mut Reader<'_>,
    name: &'static str,
    purpose: Purpose,
) -> Result<Option<Rgb>, Fault> {
    if let Some(parameter) = reader.find(ParameterType::Rgb, name) {
        return rgb(context, parameter, purpose).map(Some);
    }
    if let Some(parameter) = reader.find(ParameterType::Spectrum, name) {
        return spectrum(context, parameter, purpose).map(Some);
    }
    if let Some(parameter) = reader.find(ParameterType::Blackbody, name) {
        context.unsupported(parameter.span, "a blackbody spectrum", "white stands in")?;
        return Ok(Some([1.0; 3]));
    }
    Ok(None)
}

/// The most that anything emits: products with areas and distances stay finite below it.
const BRIGHTEST: f32 = 1e12;

/// Refuses emission that is no number or too large to compute with.
pub(super) fn check_emission(span: Span, emission: Rgb) -> Result<Rgb, Fault> {
    if emission.iter().all(|&channel| channel <= BRIGHTEST) {
        return Ok(emission);
    }
    Err(Fault::new(
        ErrorKind::Limit,
        span,
        format!("the light emits more than {BRIGHTEST:e}"),
    ))
}

/// Reads the index of refraction of a dielectric, called `name`: a number, or a spectrum's middle.
pub(super) fn read_eta(
    context: &mut Context<'_>,
    reader: &mut Reader<'_>,
    name: &'static str,
) -> Result<f32, Fault> {
    if let Some(eta) = reader.optional_float(name)? {
        return positive(reader, name, eta);
    }
    let Some(parameter) = reader.find(ParameterType::Spectrum, name) else {
        return Ok(1.5);
    };
    if let Values::Strings(names) = &parameter.values {
        let name = single(parameter, names)?;
        if let Some((_, eta)) = GLASSES.iter().find(|(glass, _)| glass == name) {
            context.warn(
                parameter.value_span,
                format!("`{name}` has no dispersion here: its index is {eta}"),
            );
            return Ok(*eta);
        }
    }
    let [_, middle, _] = spectrum(context, parameter, Purpose::Unbounded)?;
    positive(reader, name, middle)
}

fn positive(reader: &Reader<'_>, name: &str, eta: f32) -> Result<f32, Fault> {
    if eta > 0.0 {
        Ok(eta)
    } else {
        Err(Fault::scene(
            reader.span(),
            format!("the index of refraction `{name}` is not positive"),
        ))
    }
}

fn rgb(context: &mut Context<'_>, parameter: &Parameter, purpose: Purpose) -> Result<Rgb, Fault> {
    let value = purpose.check(parameter, three(parameter)?)?;
    if value.iter().any(|&channel| channel < 0.0) {
        let message = format!("the colour `{}` has a negative part", parameter.name);
        return Err(Fault::scene(parameter.value_span, message));
    }
    if parameter.color_space == ColorSpace::Aces2065 {
        let what = "the colour space `aces2065-1`";
        context.unsupported(parameter.value_span, what, "the numbers are taken as sRGB")?;
    }
    let value = to_rec709(parameter.color_space, value);
    Ok(value.map(|channel| channel.clamp(0.0, purpose.most())))
}

/// Linear Rec. 709 of a colour in another space with the same white.
fn to_rec709(space: ColorSpace, rgb: Rgb) -> Rgb {
    let from = match space {
        ColorSpace::Srgb | ColorSpace::Aces2065 => return rgb,
        ColorSpace::DciP3 => [[0.68, 0.32], [0.265, 0.690], [0.15, 0.06]],
        ColorSpace::Rec2020 => [[0.708, 0.292], [0.170, 0.797], [0.131, 0.046]],
    };
    let to = [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]];
    let converted =
        xyz_from_rgb(to).inverse() * xyz_from_rgb(from) * DVec3::from(rgb.map(f64::from));
    converted.as_vec3().into()
}

/// XYZ of the primaries with these chromaticities, scaled so that they add up to D65.
fn xyz_from_rgb(primaries: [[f64; 2]; 3]) -> DMat3 {
    let xyz = |[x, y]: [f64; 2]| DVec3::new(x / y, 1.0, (1.0 - x - y) / y);
    let [r, g, b] = primaries.map(xyz);
    let unscaled = DMat3::from_cols(r, g, b);
    let amounts = unscaled.inverse() * xyz([0.3127, 0.3290]);
    unscaled * DMat3::from_diagonal(amounts)
}

fn spectrum(
    context: &mut Context<'_>,
    parameter: &Parameter,
    purpose: Purpose,
) -> Result<Rgb, Fault> {
    let neutral = if purpose == Purpose::Albedo {
        [0.5; 3]
    } else {
        [1.0; 3]
    };
    match &parameter.values {
        Values::Strings(names) => {
            let name = single(parameter, names)?;
            if purpose == Purpose::Illuminant && name == "stdillum-D65" {
                return Ok([1.0; 3]);
            }
            if let Some(value) = metal(name) {
                return purpose.check(parameter, value);
            }
            let what = format!("the spectrum `{name}`");
            let stand_in = format!("{} stands in", neutral[0]);
            context.unsupported(parameter.value_span, &what, &stand_in)?;
            Ok(neutral)
        }
        Values::Floats(values) => {
            let (pairs, rest) = values.as_chunks::<2>();
            let increasing = pairs.windows(2).all(|pair| pair[0][0] < pair[1][0]);
            if pairs.is_empty() || !rest.is_empty() || !increasing {
                let message = "a spectrum is pairs of increasing wavelength and value";
                return Err(Fault::scene(parameter.value_span, message));
            }
            let stand_in = "its values at 650, 550 and 450 nm stand in";
            context.unsupported(parameter.value_span, "a spectrum of samples", stand_in)?;
            Ok([650.0, 550.0, 450.0].map(|nm| interpolate(pairs, nm).clamp(0.0, purpose.most())))
        }
        _ => Ok(neutral),
    }
}

fn metal(name: &str) -> Option<Rgb> {
    let (metal, part) = name.strip_prefix("metal-")?.rsplit_once('-')?;
    let (_, eta, k) = METALS.iter().find(|(known, ..)| *known == metal)?;
    match part {
        "eta" => Some(*eta),
        "k" => Some(*k),
        _ => None,
    }
}

/// Linear between the pairs, zero outside.
fn interpolate(pairs: &[[f32; 2]], at: f32) -> f32 {
    let segment = pairs
        .windows(2)
        .find(|pair| pair[0][0] <= at && at <= pair[1][0]);
    segment.map_or(0.0, |pair| {
        let ([x0, y0], [x1, y1]) = (pair[0], pair[1]);
        y0 + (y1 - y0) * (at - x0) / (x1 - x0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check_interpolation(at: f32, expected: f32) {
        let pairs = [[400.0, 1.0], [500.0, 3.0], [600.0, 0.0]];
        assert!((interpolate(&pairs, at) - expected).abs() < 1e-6);
    }

    #[test]
    fn samples_are_joined_by_lines_and_nothing_lies_outside() {
        check_interpolation(399.0, 0.0);
        check_interpolation(400.0, 1.0);
        check_interpolation(450.0, 2.0);
        check_interpolation(600.0, 0.0);
        check_interpolation(700.0, 0.0);
    }

    #[test]
    fn white_stays_white_and_wide_green_leaves_rec709() {
        for space in [ColorSpace::DciP3, ColorSpace::Rec2020] {
            for channel in to_rec709(space, [1.0; 3]) {
                assert!((channel - 1.0).abs() < 1e-5);
            }
        }
        let [r, g, b] = to_rec709(ColorSpace::Rec2020, [0.0, 1.0, 0.0]);
        assert!(r < -0.5 && g > 1.1 && b < 0.0);
    }

    #[test]
    fn metals_have_two_parts() {
        assert_eq!(metal("metal-CuZn-k"), Some([3.695, 2.765, 1.829]));
        assert_eq!(metal("metal-Cu"), None);
        assert_eq!(metal("metal-Cu-n"), None);
    }
}

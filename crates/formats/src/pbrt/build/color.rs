//! Converts colours of any type to linear Rec. 709.

use super::reader::{Reader, three};
use super::spectral;
use crate::error::ErrorKind;
use crate::pbrt::parameters::{Parameter, ParameterType};
use crate::pbrt::scene::ColorSpace;
use crate::source::{Fault, Span};
use bidir::spectrum::{Curve, Illuminant, Primaries, Rgb, reflectance, rgb_from_rgb};
use glam::DVec3;

/// The purpose of a colour, which determines its valid values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Purpose {
    /// An albedo: between 0 and 1.
    Albedo,
    /// Any colour that is not negative.
    Unbounded,
    /// Emission: not negative, and relative to the white of its colour space.
    Illuminant,
}

impl Purpose {
    /// Returns the largest valid value.
    fn most(self) -> f32 {
        match self {
            Self::Albedo => 1.0,
            Self::Unbounded | Self::Illuminant => f32::MAX,
        }
    }
}

/// Reads a reflectance or another factor given as `rgb`, `spectrum` or `blackbody`. None: the file has none.
pub(super) fn read(
    reader: &mut Reader<'_, '_>,
    name: &'static str,
    purpose: Purpose,
) -> Result<Option<Rgb>, Fault> {
    if let Some(parameter) = reader.find(ParameterType::Rgb, name) {
        return rgb(parameter, purpose).map(Some);
    }
    let Some((curve, parameter)) = read_positive(reader, name)? else {
        return Ok(None);
    };
    if purpose == Purpose::Albedo && curve.peak() > 1.0 {
        return Err(above_one(parameter));
    }
    let color = reflectance(&curve);
    Ok(Some(
        color.map(|channel| channel.clamp(0.0, purpose.most())),
    ))
}

/// Reads the light that a source emits. That of a spectrum has luminance 1, as the format demands. None: the file has
/// none.
pub(super) fn read_light(
    reader: &mut Reader<'_, '_>,
    name: &'static str,
) -> Result<Option<Illuminant>, Fault> {
    if let Some(parameter) = reader.find(ParameterType::Rgb, name) {
        let color = rgb(parameter, Purpose::Illuminant)?;
        return Ok(Some(color.into()));
    }
    let Some((curve, parameter)) = read_positive(reader, name)? else {
        return Ok(None);
    };
    let light = Illuminant::of_curve(curve).ok_or_else(|| {
        let message = format!("the spectrum `{}` of a light is black", parameter.name);
        Fault::scene(parameter.value_span, message)
    })?;
    Ok(Some(light.map(|channel| channel.min(f32::MAX))))
}

/// Reads a curve without negative values. None: the file has none.
fn read_positive<'a>(
    reader: &mut Reader<'a, '_>,
    name: &'static str,
) -> Result<Option<(Curve, &'a Parameter)>, Fault> {
    let given = spectral::read(reader, name)?;
    if let Some((curve, parameter)) = &given
        && !curve.is_positive()
    {
        let message = format!("the spectrum `{}` has negative values", parameter.name);
        return Err(Fault::scene(parameter.value_span, message));
    }
    Ok(given)
}

fn above_one(parameter: &Parameter) -> Fault {
    let message = format!("the reflectance `{}` is above 1", parameter.name);
    Fault::scene(parameter.value_span, message)
}

/// Maximum emission. Up to it, products with areas and distances stay finite.
const BRIGHTEST: f32 = 1e12;

/// Refuses emission that is NaN or too large to compute with.
pub(super) fn check_emission(span: Span, emission: Rgb) -> Result<Rgb, Fault> {
    if emission.iter().all(|&channel| channel <= BRIGHTEST) {
        return Ok(emission);
    }
    let message = format!("the light emits more than {BRIGHTEST:e}");
    Err(Fault::new(ErrorKind::Limit, span, message))
}

/// Returns `scale` times `light`. Errors: those of [`check_emission`].
pub(super) fn scaled_light(span: Span, light: Illuminant, scale: f32) -> Result<Illuminant, Fault> {
    let scaled = light.map(|channel| channel * scale);
    check_emission(span, scaled.color())?;
    Ok(scaled)
}

/// Returns the colour of an `rgb`.
pub(super) fn rgb(parameter: &Parameter, purpose: Purpose) -> Result<Rgb, Fault> {
    let value = three(parameter)?;
    if value.iter().any(|&channel| channel > purpose.most()) {
        return Err(above_one(parameter));
    }
    if value.iter().any(|&channel| channel < 0.0) {
        let message = format!("the colour `{}` has a negative component", parameter.name);
        return Err(Fault::scene(parameter.value_span, message));
    }
    let rec709 = to_rec709(parameter.color_space, value, purpose);
    Ok(rec709.map(|channel| channel.clamp(0.0, purpose.most())))
}

/// Converts a colour from another space to linear Rec. 709. A white reflectance is 1 in all spaces; white
/// light is the white of the space.
pub(super) fn to_rec709(space: ColorSpace, color: Rgb, purpose: Purpose) -> Rgb {
    let rec709 = Primaries::rec709();
    let from = match space {
        ColorSpace::Srgb => return color,
        ColorSpace::DciP3 => Primaries {
            xy: [[0.68, 0.32], [0.265, 0.690], [0.15, 0.06]],
            ..Primaries::rec709()
        },
        ColorSpace::Rec2020 => Primaries {
            xy: [[0.708, 0.292], [0.170, 0.797], [0.131, 0.046]],
            ..Primaries::rec709()
        },
        ColorSpace::Aces2065 => Primaries::new(
            [[0.7347, 0.2653], [0.0, 1.0], [0.0001, -0.077]],
            [0.32168, 0.33767],
        ),
    };
    let white: DVec3 = match purpose {
        Purpose::Albedo | Purpose::Unbounded => rec709.white,
        Purpose::Illuminant => from.white,
    };
    rgb_from_rgb(&from, white, color)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_stays_white_and_wide_green_leaves_rec709() {
        let spaces = [ColorSpace::DciP3, ColorSpace::Rec2020, ColorSpace::Aces2065];
        for space in spaces {
            for channel in to_rec709(space, [1.0; 3], Purpose::Albedo) {
                assert!((channel - 1.0).abs() < 1e-5, "{space:?}");
            }
        }
        let [r, g, b] = to_rec709(ColorSpace::Rec2020, [0.0, 1.0, 0.0], Purpose::Albedo);
        assert!(r < -0.5 && g > 1.1 && b < 0.0);
    }

    #[test]
    fn white_light_of_aces_is_warmer_than_daylight() {
        let [r, g, b] = to_rec709(ColorSpace::Aces2065, [1.0; 3], Purpose::Illuminant);
        assert!(
            r > 1.03 && (g - 0.99).abs() < 0.02 && b < 0.93,
            "{r} {g} {b}"
        );
    }
}

//! Quantities of a scene that depend on the wavelength: the light of a lamp, the index of a metal or of glass.
//!
//! Each keeps its curve, where one is known, beside what linear Rec. 709 needs of it, which is computed once.
//! [`Lanes`](super::Lanes) converts where light is emitted or scattered.

use super::colorimetry::{conductor, emission, luminance_of};
use super::{Curve, Rgb, luminance, named};
use std::sync::Arc;

/// The d line of helium, by which glasses are specified. Unit: nm.
const D_LINE: f64 = 587.56;

/// Emitted light: radiance, intensity or irradiance.
#[derive(Clone, Debug, PartialEq)]
pub struct Illuminant {
    color: Rgb,
    /// The spectrum at luminance 1. None: only the colour is known.
    hue: Option<Arc<Curve>>,
}

impl Illuminant {
    /// Makes light of this spectrum and luminance 1; its colour is clamped to Rec. 709. None: the spectrum has no
    /// luminance.
    pub fn of_curve(curve: Curve) -> Option<Self> {
        let color = emission(&curve)?;
        let per_luminance = 1.0 / luminance_of(&curve);
        Some(Self {
            color,
            hue: Some(Arc::new(curve.scaled(per_luminance))),
        })
    }

    /// Returns the linear Rec. 709 colour.
    #[inline]
    pub const fn color(&self) -> Rgb {
        self.color
    }

    /// Returns the luminance.
    #[inline]
    pub fn luminance(&self) -> f32 {
        luminance(self.color)
    }

    /// Returns the spectrum at luminance 1. None: only the colour is known.
    pub fn hue(&self) -> Option<&Curve> {
        self.hue.as_deref()
    }

    /// Returns the light with `f` applied to each channel of its colour: a scale, or a limit.
    #[must_use]
    pub fn map(self, f: impl FnMut(f32) -> f32) -> Self {
        Self {
            color: self.color.map(f),
            ..self
        }
    }
}

impl From<Rgb> for Illuminant {
    /// Makes light of a linear Rec. 709 colour.
    fn from(color: Rgb) -> Self {
        Self { color, hue: None }
    }
}

/// A metal: its complex index of refraction η + ik.
#[derive(Clone, Debug, PartialEq)]
pub struct Metal {
    /// η and k.
    curves: [Curve; 2],
    /// η and k by the channels of linear Rec. 709.
    channels: [Rgb; 2],
}

impl Metal {
    /// Makes the metal of these curves.
    pub fn new(eta: Curve, k: Curve) -> Self {
        Self {
            channels: conductor(&eta, &k),
            curves: [eta, k],
        }
    }

    /// Returns the metal with this chemical symbol. None: it is not known.
    pub fn named(symbol: &str) -> Option<Self> {
        let [eta, k] = ["eta", "k"].map(|part| named(&format!("metal-{symbol}-{part}")));
        Some(Self::new(eta?, k?))
    }

    /// Returns η and k by wavelength.
    pub const fn curves(&self) -> &[Curve; 2] {
        &self.curves
    }

    /// Returns η and k for each channel of linear Rec. 709, which reflect at normal incidence as the metal does under
    /// daylight.
    #[inline]
    pub const fn channels(&self) -> [Rgb; 2] {
        self.channels
    }
}

/// The real index of refraction of a dielectric, relative to the medium outside.
#[derive(Clone, Debug, PartialEq)]
pub struct RefractiveIndex {
    at_d_line: f32,
    /// None: it is the same at every wavelength.
    curve: Option<Arc<Curve>>,
}

impl RefractiveIndex {
    /// Makes the index of a glass that disperses light.
    pub fn of_curve(curve: Curve) -> Self {
        Self {
            at_d_line: curve.at(D_LINE) as f32,
            curve: Some(Arc::new(curve)),
        }
    }

    /// Returns the index at the d line of helium, 587.56 nm.
    #[inline]
    pub const fn at_d_line(&self) -> f32 {
        self.at_d_line
    }

    /// Returns the index by wavelength. None: it is the same at every wavelength.
    pub fn curve(&self) -> Option<&Curve> {
        self.curve.as_deref()
    }
}

impl From<f32> for RefractiveIndex {
    /// Makes an index that is the same at every wavelength.
    fn from(eta: f32) -> Self {
        Self {
            at_d_line: eta,
            curve: None,
        }
    }
}

//! Colours of spectra: XYZ = ∫ S(λ) (x̄, ȳ, z̄)(λ) dλ as sums over whole nanometres from 360 to 830, and
//! its linear RGB.

use super::named::daylight;
use super::table::OBSERVER;
use super::{Curve, Rgb};
use glam::{DMat3, DVec3};
use std::sync::LazyLock;

/// The primaries and the white of a colour space.
pub struct Primaries {
    /// The chromaticities of the three primaries.
    pub xy: [[f64; 2]; 3],
    /// XYZ of white at luminance 1.
    pub white: DVec3,
}

impl Primaries {
    /// Returns Rec. 709, whose primaries sRGB shares, with D65 as in the tables.
    pub fn rec709() -> Self {
        Self {
            xy: [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]],
            white: OBSERVED.white,
        }
    }

    /// Returns M in XYZ = M · RGB, with the primaries scaled to add up to white.
    fn xyz_from_rgb(&self) -> DMat3 {
        let [r, g, b] = self.xy.map(xyz);
        let unscaled = DMat3::from_cols(r, g, b);
        unscaled * DMat3::from_diagonal(unscaled.inverse() * self.white)
    }
}

/// Returns XYZ of a chromaticity at luminance 1.
fn xyz([x, y]: [f64; 2]) -> DVec3 {
    DVec3::new(x / y, 1.0, (1.0 - x - y) / y)
}

/// The observer and daylight, nanometre by nanometre.
struct Observed {
    /// For each step: the wavelength (nm), the observer's functions, and D65 relative to its luminance.
    steps: Vec<(f64, DVec3, f64)>,
    /// XYZ of D65.
    white: DVec3,
}

static OBSERVED: LazyLock<Observed> = LazyLock::new(|| {
    let d65 = daylight([0.31272, 0.32903]);
    let bars = ["x_bar", "y_bar", "z_bar"].map(|name| OBSERVER.column(name));
    let bar = |i: usize, nm| bars[i].as_ref().map_or(0.0, |bar| bar.at(nm));
    let steps = (360..=830).map(|nm| {
        let nm = f64::from(nm);
        (
            nm,
            DVec3::new(bar(0, nm), bar(1, nm), bar(2, nm)),
            d65.at(nm),
        )
    });
    let mut steps: Vec<_> = steps.collect();
    let luminance: f64 = steps.iter().map(|(_, bars, light)| bars.y * light).sum();
    for (_, _, light) in &mut steps {
        *light /= luminance;
    }
    let white = steps.iter().map(|(_, bars, light)| bars * light).sum();
    Observed { steps, white }
});

fn rgb_from_xyz() -> DMat3 {
    Primaries::rec709().xyz_from_rgb().inverse()
}

fn rgb(xyz: DVec3) -> Rgb {
    (rgb_from_xyz() * xyz).as_vec3().into()
}

/// Returns ∫ value · D65 in linear Rec. 709: white for a value of 1. Not clamped.
fn under_daylight(value: impl Fn(f64) -> f64) -> Rgb {
    let steps = OBSERVED.steps.iter();
    rgb(steps.map(|(nm, bars, d65)| bars * (d65 * value(*nm))).sum())
}

/// Returns the colour of a reflectance, or another factor, under daylight in linear Rec. 709. Not clamped.
pub fn reflectance(spectrum: &Curve) -> Rgb {
    under_daylight(|nm| spectrum.at(nm))
}

/// Returns XYZ of light, not normalised: Y is ∫ S ȳ dλ.
fn xyz_of(light: &Curve) -> DVec3 {
    let steps = OBSERVED.steps.iter();
    steps.map(|(nm, bars, _)| bars * light.at(*nm)).sum()
}

/// Returns the luminance ∫ S ȳ dλ of light.
pub(super) fn luminance_of(light: &Curve) -> f64 {
    xyz_of(light).y
}

/// Returns the colour of a light at luminance 1; channels outside of Rec. 709 are clamped. None: the light
/// has no luminance.
pub(super) fn emission(light: &Curve) -> Option<Rgb> {
    let xyz = xyz_of(light);
    if !(xyz.y > 0.0 && xyz.is_finite()) {
        return None;
    }
    let clamped = (rgb_from_xyz() * xyz).max(DVec3::ZERO);
    // Clamping adds light, which the division removes.
    let luminance = (Primaries::rec709().xyz_from_rgb() * clamped).y;
    Some((clamped / luminance).as_vec3().into())
}

/// The luminance of a spectrum that is 1 everywhere: ∫ ȳ dλ. Unit: nm.
pub const LUMINANCE_OF_ONE: f32 = 106.856_895;

/// Returns the colour of Planck's law relative to its peak, not normalised to luminance 1.
pub fn black_body(kelvin: f64) -> Rgb {
    let spectrum = Curve::blackbody(kelvin);
    let luminance = luminance_of(&spectrum);
    let of_one = emission(&spectrum).unwrap_or_default();
    of_one.map(|channel| channel * luminance as f32)
}

/// Returns [η, k] of a metal for each channel, so that its reflectance R at normal incidence, under daylight,
/// equals the reflectance by the spectral index: η is the mean over the channel, and k follows from
/// R = ((η - 1)² + k²) / ((η + 1)² + k²).
pub(super) fn conductor(eta: &Curve, k: &Curve) -> [Rgb; 2] {
    let sqr = |x: f64| x * x;
    let normal = |nm: f64| {
        let (eta, k2) = (eta.at(nm), sqr(k.at(nm)));
        (sqr(eta - 1.0) + k2) / (sqr(eta + 1.0) + k2)
    };
    let seen = reflectance(eta).map(|eta| eta.max(0.0));
    let reflected = under_daylight(normal).map(|r| f64::from(r).clamp(0.0, 0.9999));
    let k = std::array::from_fn(|channel| {
        let (eta, r) = (f64::from(seen[channel]), reflected[channel]);
        let k2 = (r * sqr(eta + 1.0) - sqr(eta - 1.0)) / (1.0 - r);
        libm::sqrt(k2.max(0.0)) as f32
    });
    [seen, k]
}

/// Converts a colour from the primaries `from` to linear Rec. 709. Maps the white of `from` to `white`.
pub fn rgb_from_rgb(from: &Primaries, white: DVec3, color: Rgb) -> Rgb {
    let xyz = from.xyz_from_rgb() * DVec3::from(color.map(f64::from));
    rgb(bradford(from.white, white) * xyz)
}

/// Returns the matrix on linear Rec. 709 that adapts a scene lit by `white` to D65.
pub fn adapted(white: DVec3) -> DMat3 {
    let primaries = Primaries::rec709();
    let xyz_from_rgb = primaries.xyz_from_rgb();
    xyz_from_rgb.inverse() * bradford(white, primaries.white) * xyz_from_rgb
}

/// Returns the chromatic adaptation that maps the white `from` to the white `to`, by von Kries' rule in the
/// cone space of Lam's Bradford matrix.
fn bradford(from: DVec3, to: DVec3) -> DMat3 {
    let cones = DMat3::from_cols(
        DVec3::new(0.8951, -0.7502, 0.0389),
        DVec3::new(0.2664, 1.7135, -0.0685),
        DVec3::new(-0.1614, 0.0367, 1.0296),
    );
    let ratio = (cones * to) / (cones * from);
    cones.inverse() * DMat3::from_diagonal(ratio) * cones
}

/// Returns XYZ of a CIE daylight at luminance 1, for `kelvin` from 4000 to 25000 (CIE 15).
pub fn daylight_white(kelvin: f64) -> DVec3 {
    let t = 1e3 / kelvin;
    let x = if kelvin <= 7000.0 {
        ((-4.6070 * t + 2.9678) * t + 0.09911) * t + 0.244063
    } else {
        ((-2.0064 * t + 1.9018) * t + 0.24748) * t + 0.237040
    };
    xyz([x, (-3.0 * x + 2.870) * x - 0.275])
}

/// Returns XYZ of a blackbody at luminance 1.
pub fn planckian_white(kelvin: f64) -> DVec3 {
    let xyz = xyz_of(&Curve::blackbody(kelvin));
    xyz / xyz.y
}

impl Primaries {
    /// Returns primaries with a white of this chromaticity.
    pub fn new(xy: [[f64; 2]; 3], white: [f64; 2]) -> Self {
        Self {
            xy,
            white: xyz(white),
        }
    }
}

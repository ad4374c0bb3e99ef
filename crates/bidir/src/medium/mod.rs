//! Participating media: smoke, fog and liquids, which absorb and scatter light between surfaces.
//!
//! Along a segment of a path
//!
//! T(a, b) = exp(-τ), τ = ∫ σ_t, σ_t = σ_a + σ_s
//!
//! of the light arrives \[Chandrasekhar60\], lane by lane. A vertex in a medium scatters σ_s p, where p is the
//! [phase function](HenyeyGreenstein).
//!
//! A walk that leaves a with a density p_ω of directions reaches b with the density
//!
//! p_ω |cosθ_b| / d² · mean(T) on a surface, p_ω / d² · mean(σ_t T) in a medium,
//!
//! means over lanes: it draws its distance by one lane, each as likely as others, so that the density is one
//! function of the path, from whichever end it is walked (docs/derivations/media.md).
//!
//! Places name media: every [`Locus`](crate::locus::Locus) has one on each side.

mod phase;

pub use phase::HenyeyGreenstein;

use crate::spectrum::{ColorModel, Rgb, Spectrum, Wavelengths};

/// A medium of a scene, by number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MediumId(u8);

impl MediumId {
    /// Empty space.
    pub const VACUUM: Self = Self(0);
    /// The most media of a scene, besides the vacuum.
    pub const MOST: usize = u8::MAX as usize;

    /// Medium number `index` of a scene that has so many; the vacuum is none of them. None: beyond
    /// [`MOST`](Self::MOST).
    pub(crate) fn new(index: usize) -> Option<Self> {
        u8::try_from(index + 1).ok().map(Self)
    }

    /// The number among the media of a scene. None: the vacuum.
    #[inline]
    pub(crate) fn index(self) -> Option<usize> {
        usize::from(self.0).checked_sub(1)
    }
}

/// The media on both sides of a place; the same where no boundary is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MediumSides {
    /// On the side of the geometric normal.
    pub outside: MediumId,
    /// On the other.
    pub inside: MediumId,
}

impl MediumSides {
    /// Vacuum all around.
    pub const VACUUM: Self = Self::all(MediumId::VACUUM);

    /// One medium all around.
    pub const fn all(medium: MediumId) -> Self {
        Self {
            outside: medium,
            inside: medium,
        }
    }

    /// True where two media meet.
    #[inline]
    pub fn is_boundary(self) -> bool {
        self.outside != self.inside
    }

    /// The medium of a ray that leaves along `w`, where `cos` is that of `w` to the geometric normal.
    #[inline]
    pub fn toward(self, cos: f32) -> MediumId {
        if cos < 0.0 { self.inside } else { self.outside }
    }
}

/// A medium that is the same everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    absorption: Rgb,
    scattering: Rgb,
    phase: HenyeyGreenstein,
}

impl Medium {
    /// A medium of these coefficients, σ_a and σ_s, in 1/m. None: one of them is negative, or σ_t is not finite.
    pub fn homogeneous(absorption: Rgb, scattering: Rgb, phase: HenyeyGreenstein) -> Option<Self> {
        let valid = 0.0..=f32::MAX;
        let mut pairs = absorption.iter().zip(&scattering);
        let is_valid = |(a, s): (&f32, &f32)| {
            valid.contains(a) && valid.contains(s) && valid.contains(&(a + s))
        };
        pairs.all(is_valid).then_some(Self {
            absorption,
            scattering,
            phase,
        })
    }

    /// σ_t. Unit: 1/m.
    #[inline]
    pub fn extinction(&self, color: ColorModel, wavelengths: &Wavelengths) -> Spectrum {
        let all = std::array::from_fn(|i| self.absorption[i] + self.scattering[i]);
        color.unbounded(all, wavelengths)
    }

    /// The scattering of a vertex in the medium.
    #[inline]
    pub fn scattering(&self, color: ColorModel, wavelengths: &Wavelengths) -> MediumScattering {
        let coefficient = color.unbounded(self.scattering, wavelengths);
        let extinction = self.extinction(color, wavelengths);
        let part = |s: f32, t: f32| if t > 0.0 { s / t } else { 0.0 };
        MediumScattering {
            coefficient,
            albedo: coefficient.zip(extinction, part),
            phase: self.phase,
        }
    }
}

/// The scattering of a vertex in a medium: σ_s p.
#[derive(Clone, Copy, Debug)]
pub struct MediumScattering {
    /// σ_s. Unit: 1/m.
    pub coefficient: Spectrum,
    /// σ_s / σ_t.
    pub albedo: Spectrum,
    /// p.
    pub phase: HenyeyGreenstein,
}

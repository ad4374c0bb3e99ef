//! Light that facets scatter more than once: f = k(o) k(i) / (π k̄) · part, 1/sr, \[Kulla17\].
//!
//! Facets send light on to other facets. Walter's f, for a single facet, loses the fraction k(w) of the light from w.
//! If any number of facets scatter, this light leaves as if it had lost its direction: in proportion to k itself,
//! with k̄ = ∫ 2μ k dμ. So f is symmetric, and a surface that absorbs nothing scatters (1 - k) + k = 1. `part` is the
//! fraction that absorption leaves.
//!
//! [`loss`] has fits of k. k̄ is integrated when the BSDF is made, at the directions of [`Spread`], by which the lobe
//! is drawn: their density is about k μ, because k falls off where μ is above the slope.
//!
//! An interface has a k on either side. Of the light that one side loses, the fraction x leaves on the other side:
//! x_o / k̄_i = η² x_i / k̄_o by reciprocity, which leaves one x free; it is chosen by Fresnel's mean reflectance.

mod loss;
mod tables;

pub(super) use loss::{of_interface, of_mirrors};

use super::microfacet::Ggx;
use crate::math::{INV_PI, PI, Vec2, Vec3, sin_cos, sqr};
use crate::spectrum::Spectrum;

/// The number of facets that may scatter light in one scattering event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FacetScattering {
    /// One: light that would meet another is lost.
    Single,
    /// Any number.
    Multiple,
}

/// The number of cosines of an integral over directions.
const COSINES: u16 = 8;
/// The number of azimuths in a quarter of the circle, if slopes differ.
const AZIMUTHS: u16 = 3;

/// A distribution of directions: the cosine distribution times 1 / (μ² + c²), with c near the slope.
#[derive(Clone, Copy)]
pub(super) struct Spread {
    c2: f32,
    /// ln(1 + 1/c²).
    range: f32,
}

impl Spread {
    #[inline]
    pub(super) fn new(ggx: Ggx) -> Self {
        let c2 = sqr(ggx.mean_alpha().clamp(0.03, 1.0));
        Self {
            c2,
            range: libm::logf(1.0 + 1.0 / c2),
        }
    }

    /// Returns the density of a direction of cosine `cos`. Measure: solid angle, 1/sr.
    #[inline]
    pub(super) fn pdf(self, cos: f32) -> f32 {
        INV_PI * cos.abs() / (self.range * (sqr(cos) + self.c2))
    }

    /// Returns the cosine below which the fraction `u` of directions is: u = ln(1 + μ²/c²) / ln(1 + 1/c²).
    #[inline]
    fn cosine(self, u: f32) -> f32 {
        let squared = self.c2 * (libm::expf(u * self.range) - 1.0);
        squared.clamp(1e-12, 1.0).sqrt()
    }

    /// Draws a direction on the side of `w`.
    #[inline]
    pub(super) fn sample(self, w: Vec3, u: Vec2) -> Vec3 {
        let cos = self.cosine(u.x);
        around(cos.copysign(w.z), 2.0 * PI * u.y)
    }

    /// Returns ∫ 2μ k dμ, averaged over azimuths.
    fn mean(self, azimuths: u16, k: impl Fn(Vec3) -> f32) -> f32 {
        let at = |index: u16| {
            let cos = self.cosine((f32::from(index % COSINES) + 0.5) / f32::from(COSINES));
            let phi = (f32::from(index / COSINES) + 0.5) / f32::from(azimuths) * (PI / 2.0);
            k(around(cos, phi)) * self.range * (sqr(cos) + self.c2)
        };
        let n = COSINES * azimuths;
        (0..n).map(at).sum::<f32>() / f32::from(n)
    }
}

/// Returns the direction of cosine `cos` at azimuth `phi`.
#[inline]
fn around(cos: f32, phi: f32) -> Vec3 {
    let (y, x) = sin_cos(phi);
    let sin = (1.0 - sqr(cos)).max(0.0).sqrt();
    Vec3::new(sin * x, sin * y, cos)
}

#[inline]
fn azimuths(ggx: Ggx) -> u16 {
    if ggx.is_isotropic() { 1 } else { AZIMUTHS }
}

/// Returns k̄ of facets that mirror.
pub(super) fn mean_of_mirrors(ggx: Ggx) -> f32 {
    Spread::new(ggx).mean(azimuths(ggx), |w| of_mirrors(ggx, w))
}

/// Returns the fraction of the light lost by one facet that leaves after several, for a mean reflectance `mean`: F̄²
/// Ē / (1 - F̄ (1 - Ē)), with Ē = 1 - k̄ \[Kulla17\].
#[inline]
pub(super) fn remaining(mean: Spectrum, lost: f32) -> Spectrum {
    mean.map(|f| sqr(f) * (1.0 - lost) / (1.0 - f * lost).max(1e-6))
}

/// Returns ∫ 2μ F dμ by Gauss's rule for this weight, exact for cubics.
#[inline]
pub(super) fn mean_fresnel(fresnel: impl Fn(f32) -> Spectrum) -> Spectrum {
    fresnel(0.355_051_03) * 0.363_917_24 + fresnel(0.844_948_97) * 0.636_082_76
}

/// k̄ on both sides of an interface: the side of the normal, and the other. Zero: light that facets lose is lost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sides([f32; 2]);

impl Sides {
    pub(super) const NONE: Self = Self([0.0; 2]);

    /// Integrates k̄ on both sides of an interface of index `eta`, inside over outside.
    pub(super) fn new(ggx: Ggx, eta: f32) -> Self {
        let spread = Spread::new(ggx);
        let mean = |across| spread.mean(azimuths(ggx), |w| of_interface(ggx, across, w));
        Self([eta, 1.0 / eta].map(mean))
    }

    #[inline]
    pub(super) fn is_none(self) -> bool {
        self.0[0] <= 0.0 || self.0[1] <= 0.0
    }

    /// Returns k̄ on the side of `w`.
    #[inline]
    pub(super) fn of(self, w: Vec3) -> f32 {
        self.0[usize::from(w.z < 0.0)]
    }

    /// Returns x, the fraction of light from the side of `w` that leaves on the other side. `across` is the index of
    /// the other side over that of this side.
    #[inline]
    pub(super) fn crossing(self, w: Vec3, across: f32) -> f32 {
        let (here, there) = (self.of(w), self.of(-w));
        // The formula is for the less dense side, which loses less; the other x follows, and is at most 1.
        if across >= 1.0 {
            outer_crossing(across, there / here)
        } else {
            outer_crossing(1.0 / across, here / there) * sqr(across) * there / here
        }
    }
}

/// Returns x on the less dense side: 1 - F̄ \[Kulla17\], or less, so that x on the other side is at most 1. `ratio`
/// is k̄ of the denser side over k̄ of this side.
#[inline]
fn outer_crossing(eta: f32, ratio: f32) -> f32 {
    mean_transmittance(eta).min(sqr(eta) * ratio)
}

/// Returns 1 - ∫ 2μ F dμ of an interface of index `eta` above 1, from the less dense side \[Kulla17\].
#[inline]
pub(super) fn mean_transmittance(eta: f32) -> f32 {
    1.0 - (eta - 1.0) / (4.08567 + 1.00071 * eta)
}

//! k, the fraction of light along a direction that one scattering event at a facet loses, by fits.
//!
//! The fraction of light from w that facets of slope α do not shadow is t = 1 / (1 + 2Λ(w)), which combines the
//! cosine and the slope along w. k is a smooth function of t, this slope, and the slope across w, or the index of an
//! interface. If a direction is oblique to the axes, facets on both sides of it contribute to the slope across it: it
//! is a mean of the slope across and of the slope of those facets that do not tilt along it.
//!
//! Each fit is lowered by its largest error, so that no surface gains energy.

use super::tables::{MIRRORS, OUTSIDE, Polynomial, WITHIN};
use crate::bsdf::microfacet::Ggx;
use crate::math::{Vec3, sqr};
use glam::Vec4;

/// The largest errors of the fits.
const SLACK_OF_MIRRORS: f32 = 0.0035;
const SLACK_OUTSIDE: f32 = 0.008;
const SLACK_WITHIN: f32 = 0.015;
/// The weight, in the slope across a direction, of facets that do not tilt along it.
const UPRIGHT: f32 = 0.35;
/// The range of indices of the fits; k fades out beyond it.
const INDICES: [f32; 2] = [1.2, 3.0];

/// Returns k of facets that reflect all light.
#[inline]
pub(in crate::bsdf) fn of_mirrors(ggx: Ggx, w: Vec3) -> f32 {
    let [along, across] = slopes(ggx, w);
    let fit = value(&MIRRORS, [ggx.unshadowed(w), along, across]);
    (fit - SLACK_OF_MIRRORS).max(0.0)
}

/// Returns k of facets between two media, `across` the index of the other side over that of `w`.
#[inline]
pub(in crate::bsdf) fn of_interface(ggx: Ggx, across: f32, w: Vec3) -> f32 {
    let eta = across.max(1.0 / across);
    let within = ((eta - 1.0) / (INDICES[0] - 1.0)).min(INDICES[1] + 1.0 - eta);
    if within <= 0.0 {
        return 0.0;
    }
    let bend = (INDICES[0] / eta.clamp(INDICES[0], INDICES[1]) - 0.4) / 0.6;
    // The fit is for equal slopes, and grows with them.
    let alpha = slopes(ggx, w).into_iter().fold(1.0, f32::min);
    let t = ggx.unshadowed(w);
    let lost = if across > 1.0 {
        value(&OUTSIDE, [t.sqrt(), alpha, bend]) - SLACK_OUTSIDE
    } else {
        value(&WITHIN, [t, alpha, bend]) - SLACK_WITHIN
    };
    lost.max(0.0) * within.min(1.0)
}

/// Returns the slopes α of `ggx` along the azimuth of `w` and across it, each at most 1.
#[inline]
fn slopes(ggx: Ggx, w: Vec3) -> [f32; 2] {
    let [x2, y2] = ggx.alphas().map(|alpha| sqr(alpha.min(1.0)));
    if ggx.is_isotropic() {
        return [x2.sqrt(); 2];
    }
    let [cos2, sin2] = [sqr(w.x), sqr(w.y)];
    // The normal has no azimuth.
    let [cos2, sin2] = [cos2, sin2].map(|part| (part + 1e-6) / (cos2 + sin2 + 2e-6));
    let along = x2 * cos2 + y2 * sin2;
    let upright = x2 * y2 / along;
    let across = (1.0 - UPRIGHT) * (x2 + y2 - along) + UPRIGHT * upright;
    [along.sqrt(), across.sqrt()]
}

/// Returns the value of the polynomial; variables are between 0 and 1.
#[inline]
fn value(table: &Polynomial, variables: [f32; 3]) -> f32 {
    let [t, a, y] = variables.map(|x| 2.0 * x - 1.0);
    let row = |of_t: &[[f32; 4]; 4]| {
        let sum = |sum: Vec4, of_a: &[f32; 4]| sum * a + Vec4::from(*of_a);
        of_t.iter().rev().fold(Vec4::ZERO, sum)
    };
    let sum = table
        .iter()
        .rev()
        .fold(Vec4::ZERO, |sum, of_t| sum * t + row(of_t));
    let [p, q, r, s] = sum.to_array();
    p + y * (q + y * (r + y * s))
}

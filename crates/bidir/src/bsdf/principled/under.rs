//! The light that a layer leaves for the lobes under it: bounds of directional albedos in closed form.
//!
//! A lobe on top reflects the fraction E(μ) of the light from a direction of cosine μ. The lobe below is scaled
//! by 1 - Ẽ(μ) for each of its two directions, Ẽ ≥ E, so that both together never gain energy. The bounds were
//! fitted to quadratures, as docs/derivations/principled.md describes; they are at most 0.08 above the true values
//! for α > 0.05.

use crate::bsdf::fresnel;
use crate::math::sqr;

/// Returns W̃(μ): a bound of ∫ (1 - wo·m)⁵ D G₂ / (4 |cosθ_o cosθ_i|) cosθ_i dω for facets of slope `alpha`.
#[inline]
pub(super) fn facet_weight(cos: f32, alpha: f32) -> f32 {
    let cos = cos.clamp(0.0, 1.0);
    let smooth = fresnel::schlick(cos);
    let spread = 14.8 * sqr(alpha) / (alpha + 0.03) + 5.5 * sqr(alpha);
    let tail = 0.011 * cos * (1.0 - cos) * (8.0 * alpha).min(1.0);
    smooth / (1.0 + smooth * spread) + tail
}

/// Returns a lower bound of ∫ 2μ W̃(μ) dμ.
#[inline]
pub(super) fn mean_facet_weight(alpha: f32) -> f32 {
    let alpha = alpha.clamp(0.0, 1.0);
    0.047 / (1.0 + 3.4 * alpha - 0.6 * sqr(alpha))
}

/// Returns a bound of the directional albedo of [`sheen`](super::sheen), for slopes from
/// [`SHEEN_ALPHA`](super::sheen::SHEEN_ALPHA) to 1.
#[inline]
pub(super) fn sheen_albedo(cos: f32, alpha: f32) -> f32 {
    let cos = cos.clamp(0.0, 1.0);
    let facing = 0.18 * alpha;
    facing + (0.97 - facing) * (1.0 - cos) / (1.0 + (1.05 + 0.4 / alpha) * cos)
}

//! Sheen, the light on fibres of cloth: D / (4 |cosθ_o cosθ_i| (1 + Λ(o) + Λ(i))) with
//! D(m) = (2 + 1/α) sin^{1/α} θ_m / (2π) and a fitted Λ \[Conty17\]. Unit: 1/sr.
//!
//! The least slope is 0.1: below it, the fit lets more light leave than arrives.

use crate::math::{PI, Vec3, sqr};

/// The smallest slope.
pub(super) const SHEEN_ALPHA: f32 = 0.1;

/// p, q, r, s, t of l(x) = p / (1 + q x^r) + s x + t at the largest slope, then at the smallest.
const FITS: [[f32; 5]; 2] = [
    [21.5473, 3.82987, 0.19823, -1.97760, -4.32054],
    [25.3245, 3.32435, 0.16801, -1.27393, -4.85967],
];

/// Returns f of white fibres for directions on one side.
#[inline]
pub(super) fn eval(wo: Vec3, wi: Vec3, alpha: f32) -> f32 {
    // The fit of Λ does not include grazing angles, where Λ is finite: cosines are limited at the largest f.
    let (cos_o, cos_i) = (wo.z.abs().max(1e-3), wi.z.abs().max(1e-3));
    let sin2 = (1.0 - sqr((wo + wi).normalize().z)).max(0.0);
    let d = (2.0 + 1.0 / alpha) * libm::powf(sin2, 0.5 / alpha) / (2.0 * PI);
    d / (4.0 * cos_o * cos_i * (1.0 + lambda(cos_o, alpha) + lambda(cos_i, alpha)))
}

#[inline]
fn lambda(cos: f32, alpha: f32) -> f32 {
    let t = sqr(1.0 - alpha);
    let [p, q, r, s, end] = std::array::from_fn(|i| FITS[0][i] + (FITS[1][i] - FITS[0][i]) * t);
    let l = |x: f32| p / (1.0 + q * libm::powf(x, r)) + s * x + end;
    if cos < 0.5 {
        libm::expf(l(cos))
    } else {
        libm::expf(2.0 * l(0.5) - l(1.0 - cos))
    }
}

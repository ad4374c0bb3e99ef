//! What a rough interface does to diffuse light, integrated once for each material.
//!
//! With D_w(m) the density of facets that w sees, F Fresnel's reflectance and G₂/G₁ the part of light
//! that facets do not shadow on its way out [Walter07, eq. 20 and 21]:
//!
//! - T(μ) = ∫ D_w(m) (1 - F) G₂/G₁ dm from outside, where the refracted direction is below;
//! - R̄ = ∫ 2μ ∫ D_w(m) F G₂/G₁ dm dμ from within, where the reflected direction is within.
//!
//! Smooth: T = 1 - F, and R̄ = 1 - T̄/η² with T̄ = ∫ 2μ T dμ, because radiance over η² is kept.

use super::{Curve, mean, spread_cosine};
use crate::bsdf::dielectric::refract;
use crate::bsdf::fresnel;
use crate::bsdf::microfacet::Ggx;
use crate::math::{Vec2, Vec3, safe_sqrt, sqr};

/// Points of an integral over facets, in each dimension.
const FACETS: usize = 48;

/// The tabulated quantities of an interface, with isotropic facets of one slope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// Index of refraction of the layer, divided by that outside.
    pub(super) eta: f32,
    /// g, as in [`Coat`](super::Coat).
    pub(super) grazing: f32,
    /// q, as in [`Coat`](super::Coat).
    pub(super) ratio: Curve,
    /// R̄: the part of diffuse light within that the interface throws back.
    pub(in crate::bsdf) internal: f32,
    /// T̄: the part of diffuse light from outside that it lets through.
    pub(in crate::bsdf) transmitted: f32,
    /// The mean of 2/cosθ over the light that is thrown back: how far it crosses the layer.
    pub(in crate::bsdf) path: f32,
}

impl Layer {
    /// Integrates for an index `eta` and facets of slope `alpha`, the same in all directions.
    pub fn new(eta: f32, alpha: f32) -> Self {
        let ggx = Ggx::new(alpha, alpha);
        let smooth = Self::smooth(eta);
        if ggx.is_smooth() {
            return smooth;
        }
        let inside = |cos: f32| facet_means(ggx, eta, -cos)[0];
        let layer = Self {
            grazing: grazing_cosine(eta, facet_means(ggx, eta, 0.01)[1]),
            internal: mean(inside),
            ..smooth
        };
        let ratio = Curve::through(|cos| {
            let through = 1.0 - fresnel::dielectric(spread_cosine(cos, layer.grazing), eta);
            if through > 1e-3 {
                facet_means(ggx, eta, cos)[1] / through
            } else {
                1.0
            }
        });
        Self {
            ratio,
            transmitted: mean(|cos| facet_means(ggx, eta, cos)[1]),
            ..layer
        }
    }

    fn smooth(eta: f32) -> Self {
        let points = 2048;
        let integral = |value: &dyn Fn(f32) -> f32| {
            let at = |i| f64::from(value((i as f32 + 0.5) / points as f32));
            ((0..points).map(at).sum::<f64>() / f64::from(points)) as f32
        };
        let transmitted = integral(&|cos| 2.0 * cos * (1.0 - fresnel::dielectric(cos, eta)));
        let internal = (1.0 - transmitted / sqr(eta)).clamp(0.0, 1.0);
        let path = integral(&|cos| 4.0 * fresnel::dielectric(-cos, eta)) / internal.max(1e-6);
        Self {
            eta,
            grazing: 0.0,
            ratio: Curve::ONE,
            internal,
            transmitted,
            path: path.clamp(2.0, 20.0),
        }
    }

    /// Between two layers of one index.
    #[must_use]
    pub fn lerp(&self, other: &Self, t: f32) -> Self {
        let mix = |a: f32, b: f32| a + (b - a) * t;
        Self {
            eta: self.eta,
            grazing: mix(self.grazing, other.grazing),
            ratio: self.ratio.lerp(other.ratio, t),
            internal: mix(self.internal, other.internal),
            transmitted: mix(self.transmitted, other.transmitted),
            path: mix(self.path, other.path),
        }
    }
}

/// The parts of light with cosine `cos`, from within where it is negative, that facets reflect and
/// transmit to the proper sides.
fn facet_means(ggx: Ggx, eta: f32, cos: f32) -> [f32; 2] {
    let w = Vec3::new(safe_sqrt(1.0 - sqr(cos)), 0.0, cos);
    let across = if cos > 0.0 { eta } else { 1.0 / eta };
    let unshadowed = |out: Vec3| ggx.g2(w, out) / ggx.g1(w);
    let mut sums = [0.0; 2];
    for i in 0..FACETS * FACETS {
        let (x, y) = (i % FACETS, i / FACETS);
        let u = (Vec2::new(x as f32, y as f32) + 0.5) / FACETS as f32;
        let m = ggx.sample_visible(w, u);
        let reflectance = fresnel::dielectric(w.dot(m), eta);
        let mirrored = m * (2.0 * w.dot(m)) - w;
        if mirrored.z * cos > 0.0 {
            sums[0] += reflectance * unshadowed(mirrored);
        }
        match refract(w, m, across) {
            Some(bent) if bent.z * cos < 0.0 => sums[1] += (1.0 - reflectance) * unshadowed(bent),
            _ => {}
        }
    }
    sums.map(|sum| sum / (FACETS * FACETS) as f32)
}

/// The cosine at which a smooth interface transmits as much: by bisection, since F falls with it.
fn grazing_cosine(eta: f32, transmittance: f32) -> f32 {
    let (mut low, mut high) = (0.0f32, 1.0);
    for _ in 0..24 {
        let middle = f32::midpoint(low, high);
        if 1.0 - fresnel::dielectric(middle, eta) < transmittance {
            low = middle;
        } else {
            high = middle;
        }
    }
    f32::midpoint(low, high)
}

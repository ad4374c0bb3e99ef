//! What leaves a layer over white metal, after one reflection at the metal and after more.
//!
//! E₁(μ) is the part of light that leaves after exactly one reflection, E(μ) after two or more, and
//! m_k the share of that which leaves after exactly k, from all directions. They are integrated by
//! walks between the two surfaces, with facets on both, by numbers that do not depend on the scene.
//!
//! The closed form of one reflection has a factor T = (1 - F(μ̂)) q(√μ) for each direction. Here q is
//! such that it scatters E₁: a fixed point, which is near after some rounds because the reflected
//! direction has about the cosine of the other.

use super::{Coat, Curve, KNOTS, Layer, seen_through};
use crate::bsdf::microfacet::Ggx;
use crate::bsdf::{Conductor, Dielectric, TransportMode};
use crate::math::{Vec2, Vec3, safe_sqrt, sqr};
use crate::sampler::{Dimension, Domain, Purpose, SampleStream, Sampler, SamplerKind};
use crate::spectrum::Spectrum;

/// Walks for each value of the curve.
const WALKS: u64 = 1 << 13;
/// The most reflections of a walk: few need as many.
const MOST: usize = 100;
/// Reflections that are told apart; the last stands for all that are more.
const ORDERS: usize = 32;
/// Points of an integral over facets, in each dimension.
const FACETS: usize = 32;
/// Rounds towards the fixed point.
const ROUNDS: usize = 4;

/// The tabulated quantities of a layer over metal, with isotropic facets on both surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reflections {
    /// q.
    pub(super) ratio: Curve,
    /// E.
    pub(in crate::bsdf) part: Curve,
    /// Ē = ∫ 2μ E dμ.
    pub(in crate::bsdf) mean: f32,
    /// m_k, from k = 2.
    shares: [f32; ORDERS - 1],
}

/// Two surfaces, one above the other.
struct Surfaces {
    coat: Dielectric,
    metal: Conductor,
}

impl Reflections {
    /// Integrates for a layer with facets of slope `coat_alpha`, over metal of slope `metal_alpha`.
    pub fn new(layer: &Layer, [coat_alpha, metal_alpha]: [f32; 2]) -> Self {
        let surfaces = Surfaces {
            coat: Dielectric {
                eta: layer.eta,
                ggx: Ggx::new(coat_alpha, coat_alpha),
            },
            metal: Conductor {
                eta: Spectrum::ZERO,
                k: Spectrum::ONE,
                ggx: Ggx::new(metal_alpha, metal_alpha),
            },
        };
        let leaving = KNOTS.map(|knot| surfaces.leaving(sqr(knot)));
        let once = Curve(leaving.map(|parts| parts[0]));
        let part = Curve(leaving.map(|parts| parts[1..].iter().sum()));
        let of_order = |k: usize| Curve(leaving.map(|parts| parts[k - 1])).mean();
        let shares: [f32; ORDERS - 1] = std::array::from_fn(|i| of_order(i + 2).max(0.0));
        let sum = shares.iter().sum::<f32>().max(1e-6);
        Self {
            ratio: surfaces.ratio(layer, once),
            part,
            mean: part.mean().max(1e-6),
            shares: shares.map(|share| share / sum),
        }
    }

    /// Between two tables of one index.
    #[must_use]
    pub fn lerp(&self, other: &Self, t: f32) -> Self {
        let mix = |a: f32, b: f32| a + (b - a) * t;
        Self {
            ratio: self.ratio.lerp(other.ratio, t),
            part: self.part.lerp(other.part, t),
            mean: mix(self.mean, other.mean),
            shares: std::array::from_fn(|i| mix(self.shares[i], other.shares[i])),
        }
    }

    /// Σ m_k F^k a^(k-1) over k ≥ 2: what a metal of reflectance `fresnel` leaves of E, under a layer
    /// that leaves the part `trip` between two reflections.
    #[inline]
    pub(in crate::bsdf) fn remaining(&self, fresnel: f32, trip: f32) -> f32 {
        let x = fresnel * trip;
        let sum = self.shares.iter().rev().fold(0.0, |sum, m| m + x * sum);
        sum * fresnel * x
    }
}

impl Surfaces {
    /// q: that the closed form of one reflection scatters `once`.
    fn ratio(&self, layer: &Layer, once: Curve) -> Curve {
        let (coat, metal) = (self.coat.ggx, self.metal.ggx);
        if coat.is_smooth() {
            return Curve::ONE;
        }
        let metal = seen_through(metal, coat, layer.eta);
        let mut ratio = Curve::ONE;
        for _ in 0..ROUNDS {
            let coat = Coat {
                ratio,
                ..Coat::new(layer, coat, Spectrum::ZERO)
            };
            let closed = KNOTS.map(|knot| once_in_closed_form(&coat, metal, sqr(knot)));
            ratio = Curve(std::array::from_fn(|i| {
                let scale = (once.0[i] / closed[i].max(1e-4)).sqrt();
                ratio.0[i] * scale.clamp(0.5, 2.0)
            }));
        }
        ratio
    }

    /// The parts of light with cosine `cos` that leave after one reflection, after two, and so on.
    fn leaving(&self, cos: f32) -> [f32; ORDERS] {
        let wo = Vec3::new(safe_sqrt(1.0 - sqr(cos)), 0.0, cos);
        let sampler = Sampler::new(SamplerKind::Sobol, 0);
        let mut sums = [0.0; ORDERS];
        for index in 0..WALKS {
            let stream = sampler.stream(Domain::Light, 0, index);
            if let Some((reflections, weight)) = self.walk(wo, &stream) {
                sums[reflections.min(ORDERS) - 1] += weight;
            }
        }
        sums.map(|sum| sum / WALKS as f32)
    }

    /// A walk from outside: after how many reflections at the metal it leaves, and with what weight.
    /// None: it does not enter, is lost below a surface, or is reflected too often.
    fn walk(&self, wo: Vec3, stream: &SampleStream) -> Option<(usize, f32)> {
        let (mut w, mut weight) = self.meet_coat(wo, stream, 0)?;
        if w.z > 0.0 {
            return None;
        }
        for reflections in 1..=MOST {
            let at = Dimension::at(reflections, Purpose::Scatter);
            let reflected = self.metal.sample(-w, stream.get_2d(at))?;
            let (next, passed) = self.meet_coat(-reflected.wi, stream, reflections)?;
            weight *= reflected.weight[0] * passed;
            if next.z > 0.0 {
                return Some((reflections, weight));
            }
            w = next;
        }
        None
    }

    /// Where light goes that meets the interface coming from `wo`, and its weight.
    fn meet_coat(&self, wo: Vec3, stream: &SampleStream, step: usize) -> Option<(Vec3, f32)> {
        let u_lobe = stream.get_1d(Dimension::at(step, Purpose::Lobe));
        let u = stream.get_2d(Dimension::at(step, Purpose::LightDirection));
        let sample = self.coat.sample(wo, TransportMode::Importance, u_lobe, u)?;
        Some((sample.wi, sample.weight[0]))
    }
}

/// The part of light with cosine `cos` that white metal reflects once under `coat`, as
/// `CoatedConductor` has it.
fn once_in_closed_form(coat: &Coat, metal: Ggx, cos: f32) -> f32 {
    let wo = Vec3::new(safe_sqrt(1.0 - sqr(cos)), 0.0, cos);
    let Some(inner) = coat.refracted(wo) else {
        return 0.0;
    };
    let mut sum = 0.0;
    for i in 0..FACETS * FACETS {
        let (x, y) = (i % FACETS, i / FACETS);
        let u = (Vec2::new(x as f32, y as f32) + 0.5) / FACETS as f32;
        if let Some(reflected) = metal.sample_mirror(inner, u)
            && let Some(wi) = coat.emerging(reflected)
        {
            let unshadowed = metal.g2(inner, reflected) / metal.g1(inner);
            sum += unshadowed * coat.transmittance(wo) * coat.transmittance(wi);
        }
    }
    sum / (FACETS * FACETS) as f32
}

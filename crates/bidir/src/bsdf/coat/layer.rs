//! Transmittance and reflectance of an interface, integrated over its facets once for each material.
//!
//! With D_w(m) the density of facets visible from w, F Fresnel's reflectance, and G₂/G₁ the fraction of light that
//! facets do not shadow on its way out [Walter07, eq. 20 and 21], the transmittance from outside is T(μ) = ∫ D_w(m)
//! (1 - F) G₂/G₁ dm, over facets whose refracted direction is below. A smooth interface has T = 1 - F.

use super::{Curve, mean, spread_cosine};
use crate::bsdf::dielectric::refract;
use crate::bsdf::fresnel;
use crate::bsdf::microfacet::Ggx;
use crate::math::{Vec2, Vec3, safe_sqrt, sqr};

/// The number of points of an integral over facets, in each dimension.
pub(super) const FACETS: usize = 72;
/// The number of coefficients of q.
pub(in crate::bsdf) const KNOTS: usize = 10;

/// Facets between the outside and a layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Interface {
    /// Index of refraction of the layer, divided by that outside.
    pub(super) eta: f32,
    pub(super) ggx: Ggx,
}

/// A direction in which light leaves an interface, and the fraction that does.
pub(super) type Ray = (Vec3, f32);

/// The light that a facet reflects and refracts. None: it goes to the wrong side.
pub(super) struct Split {
    pub(super) reflected: Option<Ray>,
    pub(super) refracted: Option<Ray>,
}

impl Interface {
    /// Splits light from `w`, on either side, at a facet that `u` draws among those visible from `w`.
    #[inline]
    pub(super) fn split(&self, w: Vec3, u: Vec2) -> Split {
        let m = if self.ggx.is_smooth() {
            Vec3::Z
        } else {
            self.ggx.sample_visible(w, u)
        };
        let reflectance = fresnel::dielectric(w.dot(m), self.eta);
        let across = if w.z > 0.0 { self.eta } else { 1.0 / self.eta };
        let mirrored = m * (2.0 * w.dot(m)) - w;
        let unshadowed = |out: Vec3| {
            if self.ggx.is_smooth() {
                1.0
            } else {
                self.ggx.g2(w, out) / self.ggx.g1(w)
            }
        };
        let refracted = refract(w, m, across).filter(|bent| bent.z * w.z < 0.0);
        Split {
            reflected: (mirrored.z * w.z > 0.0)
                .then(|| (mirrored, reflectance * unshadowed(mirrored))),
            refracted: refracted.map(|bent| (bent, (1.0 - reflectance) * unshadowed(bent))),
        }
    }

    /// Returns the mean of `value` over the splits at `n`² facets, for light of cosine `cos`. It comes from within if
    /// `cos` is negative.
    pub(super) fn mean(&self, cos: f32, n: usize, value: impl Fn(Split) -> f32) -> f32 {
        let w = Vec3::new(safe_sqrt(1.0 - sqr(cos)), 0.0, cos);
        let n = if self.ggx.is_smooth() { 1 } else { n };
        let at = |i: usize| {
            let u = (Vec2::new((i % n) as f32, (i / n) as f32) + 0.5) / n as f32;
            value(self.split(w, u))
        };
        (0..n * n).map(at).sum::<f32>() / (n * n) as f32
    }

    /// Returns T.
    pub(super) fn transmittance(&self, cos: f32) -> f32 {
        self.mean(cos, FACETS, |split| {
            split.refracted.map_or(0.0, |(_, part)| part)
        })
    }
}

/// The tabulated transmittance of an interface with isotropic facets of one slope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    pub(super) interface: Interface,
    /// g, as in [`Coat`](super::Coat).
    pub(super) grazing: f32,
    /// q, as in [`Coat`](super::Coat).
    pub(in crate::bsdf) ratio: Curve<KNOTS>,
    /// T̄ = ∫ 2μ T dμ.
    pub(in crate::bsdf) transmitted: f32,
}

impl Layer {
    /// Integrates for an index `eta` and isotropic facets of slope `alpha`.
    pub fn new(eta: f32, alpha: f32) -> Self {
        let ggx = Ggx::new(alpha, alpha);
        let interface = Interface { eta, ggx };
        if ggx.is_smooth() {
            return Self {
                interface,
                grazing: 0.0,
                ratio: Curve::ONE,
                transmitted: mean(64, |cos| 1.0 - fresnel::dielectric(cos, eta)),
            };
        }
        let grazing = grazing_cosine(eta, interface.transmittance(0.01));
        let through = |cos: f32| 1.0 - fresnel::dielectric(spread_cosine(cos, grazing), eta);
        let ratio = Curve::through(Curve::<KNOTS>::cosines().map(|cos| {
            if through(cos) > 1e-3 {
                interface.transmittance(cos) / through(cos)
            } else {
                1.0
            }
        }));
        Self {
            interface,
            grazing,
            ratio,
            transmitted: mean(64, |cos| through(cos) * ratio.at(cos)),
        }
    }

    /// Returns T.
    pub(super) fn transmittance(&self, cos: f32) -> f32 {
        let through = 1.0 - fresnel::dielectric(spread_cosine(cos, self.grazing), self.eta());
        through * self.ratio.at(cos)
    }

    /// Returns the index of refraction of the layer, divided by that outside.
    #[inline]
    pub(super) fn eta(&self) -> f32 {
        self.interface.eta
    }

    /// Interpolates between two layers with the same index.
    #[must_use]
    pub fn lerp(&self, other: &Self, t: f32) -> Self {
        let mix = |a: f32, b: f32| a + (b - a) * t;
        Self {
            interface: self.interface,
            grazing: mix(self.grazing, other.grazing),
            ratio: self.ratio.lerp(other.ratio, t),
            transmitted: mix(self.transmitted, other.transmitted),
        }
    }
}

/// Returns the cosine at which a smooth interface has this transmittance: by bisection, because F falls with the
/// cosine.
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

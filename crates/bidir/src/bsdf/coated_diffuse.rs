//! f = F D G₂ / (4 |cosθ_o cosθ_i|) + T(wo) T(wi) A(wo) A(wi) ρ Σ_k (ρ r)^k / (π η²), 1/sr: varnish,
//! plastic, polished wood.
//!
//! The base is Lambertian, so light that the interface throws back comes to it as any diffuse light
//! does: each round trip leaves the part ρ r of it, r = R̄ exp(-τ l) with R̄ and the mean path l of
//! [`Layer`]. The sum over all k is 1 / (1 - ρ r): pbrt-v4's random walk in closed form
//! [PBRT4, §14.3], without its limit of events.
//!
//! A layer that scatters with albedo ϖ absorbs the optical depth τ (1-ϖ), and lies as a diffuser over
//! the base: that is an approximation, exact for ϖ = 0 and where nothing is absorbed.

use super::coat::{Coat, Layer, all_orders};
use super::microfacet::Ggx;
use super::{BsdfSample, same_hemisphere};
use crate::math::{INV_PI, PI, Vec2, Vec3, sqr, warp};
use crate::spectrum::Spectrum;

/// A dielectric layer over a diffuse base; both sides of the surface look alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoatedDiffuse {
    coat: Coat,
    /// ρ / (π η² (1 - ρ r)).
    base: Spectrum,
    /// ∫ T cosθ dω: what of the base leaves the layer.
    escape: f32,
}

/// What fills a layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filling {
    /// The optical depth of the layer, scattering and absorption together.
    pub thickness: f32,
    /// The part of it that scatters.
    pub albedo: Spectrum,
    /// The mean cosine of the angle of scattering.
    pub g: f32,
}

impl Filling {
    /// The optical depth of absorption.
    #[inline]
    pub(crate) fn absorption(&self) -> Spectrum {
        self.albedo.map(|albedo| self.thickness * (1.0 - albedo))
    }

    /// The reflectance of a base of `reflectance` under the part that scatters: a layer that throws
    /// back R of diffuse light and lets 1 - R through shows R + (1-R)² ρ / (1 - R ρ).
    #[inline]
    fn cover(&self, reflectance: Spectrum) -> Spectrum {
        reflectance.zip(self.albedo, |rho, albedo| {
            // Diffuse light crosses 2τ on average, and half of what scatters evenly turns back.
            let depth = (1.0 - self.g) * self.thickness * albedo;
            let back = depth / (1.0 + depth);
            back + sqr(1.0 - back) * rho / (1.0 - back * rho).max(1e-6)
        })
    }
}

impl CoatedDiffuse {
    /// A base of `reflectance` under an interface of `ggx`, tabulated as `layer`.
    pub fn new(layer: &Layer, ggx: Ggx, filling: &Filling, reflectance: Spectrum) -> Self {
        let absorption = filling.absorption();
        let coat = Coat::new(layer, ggx, absorption);
        let trips = absorption.map(|depth| layer.internal * libm::expf(-depth * layer.path));
        let base = filling.cover(reflectance).zip(trips, |rho, trip| {
            rho * all_orders(rho * trip) * INV_PI / sqr(coat.eta())
        });
        Self {
            coat,
            base,
            escape: PI * layer.transmitted,
        }
    }

    /// True where the base is black under a smooth coat: a Dirac distribution alone.
    #[inline]
    pub(super) fn is_delta(&self) -> bool {
        self.coat.is_smooth() && self.base.is_black()
    }

    #[inline]
    fn base_albedo(&self, w: Vec3) -> Spectrum {
        self.base * (self.coat.transmittance(w) * self.escape)
    }

    #[inline]
    pub(super) fn albedo(&self, wo: Vec3) -> Spectrum {
        let coat = Spectrum::splat(self.coat.reflectance(wo));
        let unfilled = self.base_albedo(wo) * self.coat.attenuation(wo, Vec3::Z);
        (coat + unfilled).map(|lane| lane.min(1.0))
    }

    /// The probability of drawing from the interface. It depends on |cosθ| alone, so that a mirrored
    /// direction has the same.
    #[inline]
    fn coat_prob(&self, w: Vec3) -> f32 {
        let coat = self.coat.reflectance(w);
        let base = self.base_albedo(w).max_lane();
        if coat > 0.0 {
            coat / (coat + base)
        } else {
            0.0
        }
    }

    #[inline]
    pub(super) fn eval(&self, wo: Vec3, wi: Vec3) -> Spectrum {
        if !same_hemisphere(wo, wi) {
            return Spectrum::ZERO;
        }
        let through = self.coat.transmittance(wo) * self.coat.transmittance(wi);
        let base = self.base * self.coat.attenuation(wo, wi) * through;
        Spectrum::splat(self.coat.eval(wo, wi)) + base
    }

    #[inline]
    pub(super) fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        if !same_hemisphere(wo, wi) {
            return 0.0;
        }
        let prob = self.coat_prob(wo);
        let base = warp::cosine_hemisphere_pdf(wi.z.abs());
        prob * self.coat.pdf(wo, wi) + (1.0 - prob) * base
    }

    #[inline]
    pub(super) fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        let prob = self.coat_prob(wo);
        let wi = if u_lobe >= prob {
            if self.base.is_black() {
                return None;
            }
            let wi = warp::cosine_hemisphere(u);
            Vec3::new(wi.x, wi.y, wi.z.copysign(wo.z))
        } else if self.coat.is_smooth() {
            return Some(self.mirror(wo, prob));
        } else {
            self.coat.sample(wo, u)?
        };
        BsdfSample::of_densities(wi, self.eval(wo, wi), [self.pdf(wo, wi), self.pdf(wi, wo)])
    }

    #[inline]
    fn mirror(&self, wo: Vec3, prob: f32) -> BsdfSample {
        BsdfSample::mirror(wo, Spectrum::splat(self.coat.reflectance(wo)), prob)
    }

    pub(super) fn examples() -> impl Iterator<Item = (&'static str, Self)> {
        let coated = |eta, [x, y]: [f32; 2], thickness, albedo| {
            let ggx = Ggx::new(x, y);
            let filling = Filling {
                thickness,
                albedo: Spectrum::splat(albedo),
                g: 0.3,
            };
            let reflectance = Spectrum([0.9, 0.5, 0.05, 1.0]);
            Self::new(
                &Layer::new(eta, ggx.mean_alpha()),
                ggx,
                &filling,
                reflectance,
            )
        };
        [
            ("coated diffuse smooth", coated(1.5, [0.0; 2], 0.01, 0.0)),
            ("coated diffuse, thick", coated(1.3, [0.0; 2], 0.7, 0.0)),
            ("coated diffuse sharp", coated(1.5, [0.1; 2], 0.01, 0.0)),
            ("coated diffuse rough", coated(1.5, [0.4; 2], 0.3, 0.8)),
            (
                "coated diffuse anisotropic",
                coated(1.8, [0.5, 0.2], 0.0, 0.0),
            ),
        ]
        .into_iter()
    }
}

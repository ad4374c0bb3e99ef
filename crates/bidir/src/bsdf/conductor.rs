//! f = F(wo·m) D(m) G₂(wo, wi) / (4 |cosθ_o cosθ_i|) [Walter07, eq. 20]: metal, 1/sr.
//!
//! Facets are drawn by their visibility from `wo`. The density of `wi` is that of the facet over 4 |wo·m| (solid
//! angle, 1/sr). Light that a facet sends to other facets is lost, or leaves by a lobe of its own ([`multiple`]).

use super::microfacet::Ggx;
use super::multiple::{self, FacetScattering, Spread};
use super::{BsdfSample, BsdfValue, fresnel, same_hemisphere};
use crate::math::{INV_PI, Vec2, Vec3};
use crate::spectrum::Spectrum;

/// A metal: Fresnel reflection from GGX facets, or from a mirror where the surface is smooth.
///
/// f = F(wo·m) D(m) G₂(wo, wi) / (4 |cosθ_o cosθ_i|) with m halfway between [Walter07, eq. 20].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conductor {
    /// Real part of the index of refraction.
    pub eta: Spectrum,
    /// Imaginary part of the index of refraction: absorption.
    pub k: Spectrum,
    /// The distribution of facets.
    pub ggx: Ggx,
    /// The fraction of the light lost by one facet that leaves after several; black if it is all lost.
    multiple: Spectrum,
    /// k̄.
    lost: f32,
}

impl Conductor {
    /// Makes a metal of index η + ik.
    pub fn new(eta: Spectrum, k: Spectrum, ggx: Ggx, scattering: FacetScattering) -> Self {
        let single = Self {
            eta,
            k,
            ggx,
            multiple: Spectrum::ZERO,
            lost: 0.0,
        };
        if scattering == FacetScattering::Single || ggx.is_smooth() {
            return single;
        }
        let lost = multiple::mean_of_mirrors(ggx);
        let mean = multiple::mean_fresnel(|cos| single.fresnel(cos));
        Self {
            multiple: multiple::remaining(mean, lost),
            lost,
            ..single
        }
    }

    /// Returns false if light between facets is lost.
    #[inline]
    fn is_multiple(&self) -> bool {
        self.lost > 0.0
    }

    #[inline]
    pub(super) fn is_smooth(&self) -> bool {
        self.ggx.is_smooth()
    }

    #[inline]
    fn fresnel(&self, cos: f32) -> Spectrum {
        fresnel::conductor(cos, self.eta, self.k)
    }

    #[inline]
    pub(super) fn albedo(&self, wo: Vec3) -> Spectrum {
        if !self.is_multiple() {
            return self.fresnel(wo.z);
        }
        let lost = multiple::of_mirrors(self.ggx, wo);
        self.fresnel(wo.z) * (1.0 - lost) + self.multiple * lost
    }

    /// Returns the probability of drawing from the lobe of light that one facet loses, k being `lost`.
    #[inline]
    fn multiple_prob(&self, w: Vec3, lost: f32) -> f32 {
        let [once, often] = [self.fresnel(w.z), self.multiple].map(Spectrum::max_lane);
        let share = lost * often;
        share / (share + (1.0 - lost) * once).max(f32::MIN_POSITIVE)
    }

    #[inline]
    pub(super) fn eval(&self, wo: Vec3, wi: Vec3) -> BsdfValue {
        if self.is_smooth() || !same_hemisphere(wo, wi) {
            return BsdfValue::NONE;
        }
        let mirror = self.ggx.mirror(wo, wi);
        let [pdf, pdf_reverse] = mirror.densities;
        let once = BsdfValue {
            f: self.fresnel(mirror.cos) * mirror.facets,
            pdf,
            pdf_reverse,
            albedo_reverse: self.albedo(wi).max_lane(),
        };
        if self.is_multiple() {
            self.with_multiple(once, [wo, wi])
        } else {
            once
        }
    }

    /// Adds the lobe of light that one facet loses.
    #[inline]
    fn with_multiple(&self, once: BsdfValue, [wo, wi]: [Vec3; 2]) -> BsdfValue {
        let lost = [wo, wi].map(|w| multiple::of_mirrors(self.ggx, w));
        let prob = [0, 1].map(|i| self.multiple_prob([wo, wi][i], lost[i]));
        let spread = Spread::new(self.ggx);
        let mixed = |prob: f32, pdf: f32, to: Vec3| (1.0 - prob) * pdf + prob * spread.pdf(to.z);
        BsdfValue {
            f: once.f + self.multiple * (lost[0] * lost[1] * INV_PI / self.lost),
            pdf: mixed(prob[0], once.pdf, wi),
            pdf_reverse: mixed(prob[1], once.pdf_reverse, wo),
            ..once
        }
    }

    #[inline]
    pub(super) fn sample(
        &self,
        wo: Vec3,
        u_lobe: impl FnOnce() -> f32,
        u: Vec2,
    ) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        if self.is_smooth() {
            let reflectance = self.fresnel(wo.z);
            return Some(BsdfSample::mirror(wo, reflectance, 1.0, reflectance));
        }
        let is_lost = self.is_multiple() && {
            let lost = multiple::of_mirrors(self.ggx, wo);
            u_lobe() < self.multiple_prob(wo, lost)
        };
        let wi = if is_lost {
            Spread::new(self.ggx).sample(wo, u)
        } else {
            self.ggx.sample_mirror(wo, u)?
        };
        BsdfSample::of_value(wi, &self.eval(wo, wi))
    }

    pub(super) fn examples() -> impl Iterator<Item = (&'static str, Self)> {
        let gold = |alpha_x, alpha_y, scattering| {
            Self::new(
                Spectrum([0.168, 0.350, 1.508, 1.508]),
                Spectrum([3.138, 2.714, 1.879, 1.879]),
                Ggx::new(alpha_x, alpha_y),
                scattering,
            )
        };
        let (single, multiple) = (FacetScattering::Single, FacetScattering::Multiple);
        [
            ("conductor smooth", gold(0.0, 0.0, multiple)),
            ("conductor sharp", gold(0.05, 0.05, single)),
            ("conductor rough", gold(0.3, 0.3, single)),
            ("conductor anisotropic", gold(0.5, 0.1, single)),
            ("conductor sharp, multiple", gold(0.1, 0.1, multiple)),
            ("conductor roughest, multiple", gold(1.0, 1.0, multiple)),
            ("conductor anisotropic, multiple", gold(0.7, 0.2, multiple)),
        ]
        .into_iter()
    }
}

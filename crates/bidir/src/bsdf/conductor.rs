//! f = F(wo·m) D(m) G₂(wo, wi) / (4 |cosθ_o cosθ_i|) [Walter07, eq. 20]: metal, 1/sr.
//!
//! Facets are drawn as `wo` sees them, and the density of `wi` is that of the facet over 4 |wo·m|
//! (solid angle, 1/sr). Light that a facet sends below the surface is lost: there is no multiple
//! scattering.

use super::microfacet::Ggx;
use super::{BsdfSample, BsdfValue, fresnel, same_hemisphere};
use crate::math::{Vec2, Vec3};
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
}

impl Conductor {
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
        self.fresnel(wo.z)
    }

    #[inline]
    pub(super) fn eval(&self, wo: Vec3, wi: Vec3) -> BsdfValue {
        if self.is_smooth() || !same_hemisphere(wo, wi) {
            return BsdfValue::NONE;
        }
        let mirror = self.ggx.mirror(wo, wi);
        let [pdf, pdf_reverse] = mirror.densities;
        BsdfValue {
            f: self.fresnel(mirror.cos) * mirror.facets,
            pdf,
            pdf_reverse,
            albedo_reverse: self.albedo(wi).max_lane(),
        }
    }

    #[inline]
    pub(super) fn sample(&self, wo: Vec3, u: Vec2) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        if self.is_smooth() {
            let reflectance = self.fresnel(wo.z);
            return Some(BsdfSample::mirror(wo, reflectance, 1.0, reflectance));
        }
        let wi = self.ggx.sample_mirror(wo, u)?;
        BsdfSample::of_value(wi, &self.eval(wo, wi))
    }

    pub(super) fn examples() -> impl Iterator<Item = (&'static str, Self)> {
        let gold = |alpha_x, alpha_y| Self {
            eta: Spectrum([0.168, 0.350, 1.508, 1.508]),
            k: Spectrum([3.138, 2.714, 1.879, 1.879]),
            ggx: Ggx::new(alpha_x, alpha_y),
        };
        [
            ("conductor smooth", gold(0.0, 0.0)),
            ("conductor sharp", gold(0.05, 0.05)),
            ("conductor rough", gold(0.3, 0.3)),
            ("conductor anisotropic", gold(0.5, 0.1)),
        ]
        .into_iter()
    }
}

//! f = ρ/π (1/sr), drawn with density |cosθ|/π (solid angle, 1/sr). Both sides reflect, none
//! transmits.

use super::{BsdfSample, BsdfValue, same_hemisphere};
use crate::math::{INV_PI, Vec2, Vec3, warp};
use crate::spectrum::Spectrum;

/// Lambertian reflection on the side of `wo`: f = ρ/π.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Diffuse {
    /// The reflectance ρ. Range: `[0, 1]` per lane.
    pub reflectance: Spectrum,
}

impl Diffuse {
    #[inline]
    pub(super) fn eval(&self, wo: Vec3, wi: Vec3) -> BsdfValue {
        if !same_hemisphere(wo, wi) {
            return BsdfValue::NONE;
        }
        BsdfValue {
            f: self.reflectance * INV_PI,
            pdf: warp::cosine_hemisphere_pdf(wi.z.abs()),
            pdf_reverse: warp::cosine_hemisphere_pdf(wo.z.abs()),
            albedo_reverse: self.reflectance.max_lane(),
        }
    }

    #[inline]
    pub(super) fn sample(&self, wo: Vec3, u: Vec2) -> Option<BsdfSample> {
        let mut wi = warp::cosine_hemisphere(u);
        wi.z = wi.z.copysign(wo.z);
        // At grazing directions the density is zero and cannot be used.
        if wi.z == 0.0 || wo.z == 0.0 || self.reflectance.is_black() {
            return None;
        }
        let value = self.eval(wo, wi);
        Some(BsdfSample {
            wi,
            weight: self.reflectance,
            pdf: value.pdf,
            pdf_reverse: value.pdf_reverse,
            albedo_reverse: value.albedo_reverse,
            is_delta: false,
        })
    }

    pub(super) fn examples() -> impl Iterator<Item = (&'static str, Self)> {
        [
            ("diffuse grey", Spectrum::splat(0.5)),
            ("diffuse red", Spectrum([0.8, 0.1, 0.05, 0.0])),
            ("diffuse white", Spectrum::ONE),
        ]
        .into_iter()
        .map(|(name, reflectance)| (name, Self { reflectance }))
    }
}

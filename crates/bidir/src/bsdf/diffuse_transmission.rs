//! f = r/π on the side of `wo`, t/π through the surface (1/sr): paper, leaves, cloth.
//!
//! A draw chooses the side of `wi`, with probability proportional to the largest lane of r or t, and a
//! cosine-distributed direction on it. No interface is crossed: radiance is not scaled.

use super::{BsdfSample, BsdfValue, same_hemisphere};
use crate::math::{INV_PI, Vec2, Vec3, warp};
use crate::spectrum::Spectrum;

/// Lambertian reflection and transmission, the same from both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiffuseTransmission {
    /// The reflectance r. Range: `[0, 1]` per lane.
    pub reflectance: Spectrum,
    /// The transmittance t. Range: `[0, 1]` per lane; r + t above 1 creates light.
    pub transmittance: Spectrum,
}

impl DiffuseTransmission {
    #[inline]
    pub(super) fn albedo(&self) -> Spectrum {
        (self.reflectance + self.transmittance).map(|lane| lane.min(1.0))
    }

    /// Returns the probability of drawing a reflected direction. None: nothing is scattered.
    #[inline]
    fn reflection_prob(&self) -> Option<f32> {
        let (r, t) = (self.reflectance.max_lane(), self.transmittance.max_lane());
        (r + t > 0.0).then(|| r / (r + t))
    }

    #[inline]
    pub(super) fn eval(&self, wo: Vec3, wi: Vec3) -> BsdfValue {
        let Some(prob) = self.reflection_prob() else {
            return BsdfValue::NONE;
        };
        if wo.z == 0.0 || wi.z == 0.0 {
            return BsdfValue::NONE;
        }
        let (part, prob) = if same_hemisphere(wo, wi) {
            (self.reflectance, prob)
        } else {
            (self.transmittance, 1.0 - prob)
        };
        let [pdf, pdf_reverse] = [wi, wo].map(|w| prob * warp::cosine_hemisphere_pdf(w.z.abs()));
        BsdfValue {
            f: part * INV_PI,
            pdf,
            pdf_reverse,
            albedo_reverse: self.albedo().max_lane(),
        }
    }

    #[inline]
    pub(super) fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        let prob = self.reflection_prob()?;
        let side = if u_lobe < prob { wo.z } else { -wo.z };
        let upper = warp::cosine_hemisphere(u);
        let wi = upper.with_z(upper.z.copysign(side));
        BsdfSample::of_value(wi, &self.eval(wo, wi))
    }

    pub(super) fn examples() -> impl Iterator<Item = (&'static str, Self)> {
        let of = |reflectance, transmittance| Self {
            reflectance: Spectrum(reflectance),
            transmittance: Spectrum(transmittance),
        };
        [
            (
                "diffuse transmission",
                of([0.3, 0.4, 0.1, 0.0], [0.2, 0.3, 0.5, 0.0]),
            ),
            ("diffuse transmission only", of([0.0; 4], [1.0; 4])),
        ]
        .into_iter()
    }
}

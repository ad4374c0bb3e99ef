//! A pane between two parallel interfaces: R' = R + T² R / (1 - R²) is mirrored and 1 - R' goes
//! straight on, where R and T = 1 - R are Fresnel's of one interface: the sum over all reflections
//! within [PBRT4, §9.5]. Dirac distributions, with coefficients P |cosθ|.
//!
//! Both sides are outside, so radiance is not scaled. The pane shifts nothing and absorbs nothing.

use super::{BsdfSample, fresnel};
use crate::math::Vec3;
use crate::spectrum::Spectrum;

/// A pane of a transparent medium, much thinner than it is wide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinDielectric {
    /// Index of refraction of the pane, divided by that around it.
    pub eta: f32,
}

impl ThinDielectric {
    /// Returns R'.
    #[inline]
    fn reflectance(self, w: Vec3) -> f32 {
        // Light enters from outside on both sides.
        let once = fresnel::dielectric(w.z.abs(), self.eta);
        // R + T² R / (1 - R²), without the quotient that is 0/0 at grazing incidence.
        2.0 * once / (1.0 + once)
    }

    #[inline]
    pub(super) fn sample(self, wo: Vec3, u_lobe: f32) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        let reflectance = self.reflectance(wo);
        let mirrored =
            BsdfSample::mirror(wo, Spectrum::splat(reflectance), reflectance, Spectrum::ONE);
        if u_lobe < reflectance {
            return Some(mirrored);
        }
        let pdf = (1.0 - reflectance) * wo.z.abs();
        Some(BsdfSample {
            wi: -wo,
            weight: Spectrum::ONE,
            pdf,
            pdf_reverse: pdf,
            ..mirrored
        })
    }

    pub(super) fn examples() -> impl Iterator<Item = (&'static str, Self)> {
        [("thin dielectric", 1.5), ("thin dielectric, bubble", 0.75)]
            .map(|(name, eta)| (name, Self { eta }))
            .into_iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rays between the interfaces, one by one: R + T² R (1 + R² + R⁴ + …).
    #[test]
    fn a_pane_reflects_what_all_ways_through_it_add_up_to() {
        let pane = ThinDielectric { eta: 1.5 };
        for cos in [0.05f32, 0.3, 1.0] {
            let w = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
            let once = fresnel::dielectric(cos, 1.5);
            let (mut sum, mut inside) = (once, (1.0 - once) * once);
            for _ in 0..200 {
                sum += inside * (1.0 - once);
                inside *= once * once;
            }
            assert!((pane.reflectance(w) - sum).abs() < 1e-5, "{cos}");
        }
    }
}

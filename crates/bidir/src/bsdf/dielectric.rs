//! The BSDF of glass or water: reflection F D G₂ / (4 |cosθ_o cosθ_i|) and refraction (1 - F) D G₂ |wo·m| |wi·m| /
//! (|cosθ_o cosθ_i| (wi·m + wo·m/η)²), with η the index of the side of `wi` relative to that of `wo` [Walter07, eq.
//! 20 and 21]. Unit: 1/sr.
//!
//! Radiance is divided by η² when it crosses; importance is not [Veach97, §5.2]. There is no absorption within, and
//! no dispersion. Light that a facet sends to other facets is lost, or leaves by a lobe of its own on either side
//! ([`multiple`]).

use super::microfacet::Ggx;
use super::multiple::{self, FacetScattering, Sides, Spread};
use super::{BsdfSample, BsdfValue, TransportMode, fresnel, same_hemisphere};
use crate::math::{INV_PI, ONE_MINUS_EPSILON, Vec2, Vec3, safe_sqrt, sqr};
use crate::spectrum::Spectrum;

/// An interface between two transparent media; the normal points to the outside.
///
/// Radiance that crosses it is scaled by (η_o/η_i)², o the side it goes to and i the side it comes
/// from; importance is not [Veach97, §5.2]. Rough: [Walter07, eq. 20 and 21].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dielectric {
    /// Index of refraction inside, divided by that outside.
    pub eta: f32,
    /// The distribution of facets.
    pub ggx: Ggx,
    /// The light that single facets lose.
    pub(super) lost: Sides,
}

/// The two lobes of a facet.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Lobe {
    Reflection,
    Transmission,
}

/// Refraction by the facets with one normal m, without their transmittance 1 - F.
pub(super) struct Crossing {
    /// D G₂ |wo·m| |wi·m| / (|cosθ_o cosθ_i| (wi·m + wo·m/η)²), without the factor 1/η² of radiance. Unit: 1/sr.
    pub(super) facets: f32,
    /// The densities of drawing wi for wo, and wo for wi, given a draw of m: D_v(m) |dω_m / dω| [Walter07, eq. 17].
    /// Measure: solid angle, 1/sr.
    pub(super) densities: [f32; 2],
}

/// The lobe of light that one facet loses.
pub(super) struct Multiple {
    /// k(o) k(i) x / (π k̄), without the factor 1/η² of radiance; with 1 - x for x if light stays on its side. Unit:
    /// 1/sr.
    pub(super) f: f32,
    /// The probabilities k of drawing this lobe, for each of both directions as wo.
    pub(super) probs: [f32; 2],
    /// The densities of drawing wi for wo, and wo for wi, by this lobe. Measure: solid angle, 1/sr.
    pub(super) densities: [f32; 2],
}

impl Dielectric {
    /// Makes an interface of index `eta`, inside over outside.
    pub fn new(eta: f32, ggx: Ggx, scattering: FacetScattering) -> Self {
        let single = Self {
            eta,
            ggx,
            lost: Sides::NONE,
        };
        if scattering == FacetScattering::Single || single.is_smooth() {
            return single;
        }
        Self {
            lost: Sides::new(ggx, eta),
            ..single
        }
    }

    /// Returns the interface with `index` outside in place of 1.
    pub(super) fn within(self, index: f32) -> Self {
        let scattering = if self.lost == Sides::NONE {
            FacetScattering::Single
        } else {
            FacetScattering::Multiple
        };
        Self::new(self.eta / index, self.ggx, scattering)
    }

    /// Returns true if it has no facets, or matched indices: such an interface bends nothing, however rough it is.
    #[inline]
    pub(crate) fn is_smooth(&self) -> bool {
        self.ggx.is_smooth() || (self.eta - 1.0).abs() < 1e-6
    }

    /// Returns η of the other side divided by η of the side of `w`.
    #[inline]
    pub(super) fn eta_across(&self, w: Vec3) -> f32 {
        if w.z > 0.0 { self.eta } else { 1.0 / self.eta }
    }

    /// Returns the absolute index on the side of `w`, the outside counting 1.
    #[inline]
    pub(super) fn eta_at(&self, w: Vec3) -> f32 {
        if w.z > 0.0 { 1.0 } else { self.eta }
    }

    /// Returns the factor of a crossing on the quantity of `mode` that a walk from `wo` carries.
    #[inline]
    pub(super) fn crossing_scale(&self, wo: Vec3, mode: TransportMode) -> f32 {
        match mode {
            TransportMode::Radiance => 1.0 / sqr(self.eta_across(wo)),
            TransportMode::Importance => 1.0,
        }
    }

    /// Returns the facet in the upper hemisphere that sends `wo` to `wi`, and its lobe.
    ///
    /// None: the facet is seen from behind, or the directions are degenerate.
    #[inline]
    pub(super) fn facet(&self, wo: Vec3, wi: Vec3) -> Option<(Vec3, Lobe)> {
        if wo.z == 0.0 || wi.z == 0.0 {
            return None;
        }
        let (half, lobe) = if same_hemisphere(wo, wi) {
            (wo + wi, Lobe::Reflection)
        } else {
            (wo + wi * self.eta_across(wo), Lobe::Transmission)
        };
        if half.length_squared() == 0.0 {
            return None;
        }
        let unit = half.normalize();
        let m = if unit.z < 0.0 { -unit } else { unit };
        let seen = wo.dot(m) * wo.z > 0.0 && wi.dot(m) * wi.z > 0.0;
        seen.then_some((m, lobe))
    }

    #[inline]
    pub(super) fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> BsdfValue {
        if self.is_smooth() {
            return BsdfValue::NONE;
        }
        let once = self.eval_once(wo, wi, mode);
        if self.lost.is_none() || wo.z == 0.0 || wi.z == 0.0 {
            return once;
        }
        let often = self.multiple([wo, wi]);
        let scale = if same_hemisphere(wo, wi) {
            1.0
        } else {
            self.crossing_scale(wo, mode)
        };
        let mixed = |i: usize, pdf: f32| {
            let prob = often.probs[i];
            (1.0 - prob) * pdf + prob * often.densities[i]
        };
        BsdfValue {
            f: once.f + Spectrum::splat(often.f * scale),
            pdf: mixed(0, once.pdf),
            pdf_reverse: mixed(1, once.pdf_reverse),
            albedo_reverse: 1.0,
        }
    }

    /// Returns k of the direction `w`.
    #[inline]
    pub(super) fn lost_of(&self, w: Vec3) -> f32 {
        multiple::of_interface(self.ggx, self.eta_across(w), w)
    }

    /// Returns the scattering by more than one facet, for directions that are not grazing.
    #[inline]
    pub(super) fn multiple(&self, [wo, wi]: [Vec3; 2]) -> Multiple {
        let probs = [wo, wi].map(|w| self.lost_of(w));
        let parts = [wo, wi].map(|w| {
            let crossing = self.lost.crossing(w, self.eta_across(w));
            if same_hemisphere(wo, wi) {
                1.0 - crossing
            } else {
                crossing
            }
        });
        let spread = Spread::new(self.ggx);
        Multiple {
            f: probs[0] * probs[1] * parts[0] * INV_PI / self.lost.of(wi),
            probs,
            densities: [parts[0] * spread.pdf(wi.z), parts[1] * spread.pdf(wo.z)],
        }
    }

    /// Draws a direction of the light that one facet loses; `u_side` chooses the side.
    #[inline]
    pub(super) fn sample_multiple(&self, wo: Vec3, u_side: f32, u: Vec2) -> Vec3 {
        let crossing = self.lost.crossing(wo, self.eta_across(wo));
        let side = if u_side < crossing { -wo } else { wo };
        Spread::new(self.ggx).sample(side, u)
    }

    /// Evaluates scattering by one facet.
    #[inline]
    fn eval_once(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> BsdfValue {
        let Some((m, lobe)) = self.facet(wo, wi) else {
            return BsdfValue::NONE;
        };
        let fresnel = fresnel::dielectric(wo.dot(m), self.eta);
        let (f, [pdf, pdf_reverse]) = match lobe {
            Lobe::Reflection => {
                let mirror = self.ggx.mirror(wo, wi);
                let densities = mirror.densities.map(|pdf| fresnel * pdf);
                (mirror.facets * fresnel, densities)
            }
            Lobe::Transmission => {
                let crossing = self.crossing(wo, wi, m);
                let scale = self.crossing_scale(wo, mode);
                let densities = crossing.densities.map(|pdf| (1.0 - fresnel) * pdf);
                (crossing.facets * (1.0 - fresnel) * scale, densities)
            }
        };
        BsdfValue {
            f: Spectrum::splat(f),
            pdf,
            pdf_reverse,
            albedo_reverse: 1.0,
        }
    }

    /// Evaluates refraction between two directions by facets with normal `m`.
    #[inline]
    pub(super) fn crossing(&self, wo: Vec3, wi: Vec3, m: Vec3) -> Crossing {
        let (d, eta) = (self.ggx.d(m), self.eta_across(wo));
        let [cos_o, cos_i] = [wo, wi].map(|w| w.dot(m).abs());
        let jacobian = 1.0 / sqr(wi.dot(m) + wo.dot(m) / eta);
        let g1 = [wo, wi].map(|w| self.ggx.g1(w) / w.z.abs());
        let both = d * cos_o * cos_i * jacobian;
        Crossing {
            facets: both * self.ggx.g2(wo, wi) / (wo.z * wi.z).abs(),
            densities: [g1[0] * both, g1[1] * both / sqr(eta)],
        }
    }

    /// Draws the facet, then reflection or refraction by its Fresnel reflectance.
    #[inline]
    pub(super) fn sample(
        &self,
        wo: Vec3,
        mode: TransportMode,
        u_lobe: f32,
        u: Vec2,
    ) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        let u_lobe = if self.lost.is_none() {
            u_lobe
        } else {
            let lost = self.lost_of(wo);
            if u_lobe < lost {
                let wi = self.sample_multiple(wo, u_lobe / lost, u);
                return BsdfSample::of_value(wi, &self.eval(wo, wi, mode));
            }
            ((u_lobe - lost) / (1.0 - lost)).min(ONE_MINUS_EPSILON)
        };
        let m = if self.is_smooth() {
            Vec3::Z
        } else {
            self.ggx.sample_visible(wo, u)
        };
        let fresnel = fresnel::dielectric(wo.dot(m), self.eta);
        let (lobe, prob) = if u_lobe < fresnel {
            (Lobe::Reflection, fresnel)
        } else {
            (Lobe::Transmission, 1.0 - fresnel)
        };
        let (wi, scale) = match lobe {
            Lobe::Reflection => (m * (2.0 * wo.dot(m)) - wo, 1.0),
            Lobe::Transmission => (
                refract(wo, m, self.eta_across(wo))?,
                self.crossing_scale(wo, mode),
            ),
        };
        // A facet may send light to the wrong side of the surface: that light is lost.
        if wi.z == 0.0 || same_hemisphere(wo, wi) != (lobe == Lobe::Reflection) {
            return None;
        }
        if self.is_smooth() {
            return Some(self.smooth_sample(wo, wi, scale, prob));
        }
        BsdfSample::of_value(wi, &self.eval(wo, wi, mode))
    }

    /// Returns the sample `wi` of a flat interface, whose lobe has the probability `prob`.
    #[inline]
    fn smooth_sample(&self, wo: Vec3, wi: Vec3, scale: f32, prob: f32) -> BsdfSample {
        BsdfSample {
            wi,
            weight: Spectrum::splat(scale),
            pdf: prob * sqr(self.eta_at(wi)) * wi.z.abs(),
            pdf_reverse: prob * sqr(self.eta_at(wo)) * wo.z.abs(),
            albedo_reverse: 1.0,
            is_delta: true,
        }
    }

    pub(super) fn examples() -> impl Iterator<Item = (&'static str, Self)> {
        let (single, multiple) = (FacetScattering::Single, FacetScattering::Multiple);
        [
            ("dielectric smooth", 1.5, [0.0; 2], multiple),
            (
                "dielectric smooth, from within",
                1.0 / 1.33,
                [0.0; 2],
                single,
            ),
            ("dielectric rough", 1.5, [0.3; 2], single),
            (
                "dielectric rough, less dense inside",
                0.75,
                [0.4; 2],
                single,
            ),
            ("dielectric anisotropic", 1.8, [0.5, 0.15], single),
            ("dielectric sharp, multiple", 1.5, [0.1; 2], multiple),
            ("dielectric roughest, multiple", 1.5, [1.0; 2], multiple),
            (
                "dielectric less dense inside, multiple",
                0.6,
                [0.5; 2],
                multiple,
            ),
            (
                "dielectric anisotropic, multiple",
                1.8,
                [0.5, 0.15],
                multiple,
            ),
        ]
        .into_iter()
        .map(|(name, eta, [x, y], scattering)| (name, Self::new(eta, Ggx::new(x, y), scattering)))
    }
}

/// Refracts `wo` at a facet with normal `m`; `eta` is the index across divided by that of the side
/// of `wo`. None: total internal reflection.
#[inline]
pub(super) fn refract(wo: Vec3, m: Vec3, eta: f32) -> Option<Vec3> {
    let cos_o = wo.dot(m);
    let sin2_t = (1.0 - sqr(cos_o)).max(0.0) / sqr(eta);
    if sin2_t >= 1.0 {
        return None;
    }
    let cos_t = safe_sqrt(1.0 - sin2_t).copysign(cos_o);
    Some((m * (cos_o / eta - cos_t) - wo / eta).normalize())
}

//! Draws directions: first a lobe, by its approximate albedo, then a direction from it. The density is the sum over
//! all lobes.

use super::{Lobe, Principled, Probs, Thickness, coat_fresnel, mirrored_below};
use crate::bsdf::dielectric::refract;
use crate::bsdf::multiple::Spread;
use crate::bsdf::{BsdfSample, TransportMode, same_hemisphere};
use crate::math::{ONE_MINUS_EPSILON, Vec2, Vec3, sqr, warp};
use crate::spectrum::Spectrum;

impl Principled {
    /// Returns the probability that light which is scattered diffusely stays on its side.
    #[inline]
    pub(super) fn diffuse_reflection_prob(&self) -> f32 {
        let [back, through] = [self.tint * self.diffuse, self.through].map(Spectrum::max_lane);
        if through > 0.0 {
            back / (back + through)
        } else {
            1.0
        }
    }

    #[inline]
    pub(in crate::bsdf) fn sample(
        &self,
        wo: Vec3,
        mode: TransportMode,
        u_lobe: f32,
        u: Vec2,
    ) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        let wo = self.along_grain(wo);
        let (lobe, rest) = self.probs(wo)?.choose(u_lobe);
        let drawn = match lobe {
            Lobe::Coat if self.coat_ggx().is_smooth() => Some(self.mirror(wo)),
            Lobe::Facets if self.ggx.is_smooth() => self.sample_smooth(wo, mode, rest),
            _ => {
                let wi = self.sample_lobe(lobe, wo, rest, u)?;
                self.finite_sample(wo, wi, mode)
            }
        }?;
        Some(BsdfSample {
            wi: self.off_grain(drawn.wi),
            ..drawn
        })
    }

    /// Returns the sample `wi`, with its value and densities; both directions are in the axes of the grain.
    #[inline]
    fn finite_sample(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> Option<BsdfSample> {
        let along = Self {
            grain: Vec2::X,
            ..*self
        };
        BsdfSample::of_value(wi, &along.eval(wo, wi, mode))
    }

    /// Draws a direction from a lobe that is not a Dirac distribution. None: the light does not leave.
    #[inline]
    pub(super) fn sample_lobe(&self, lobe: Lobe, wo: Vec3, rest: f32, u: Vec2) -> Option<Vec3> {
        let facing = |wi: Vec3| Vec3::new(wi.x, wi.y, wi.z.copysign(wo.z));
        match lobe {
            Lobe::Coat => self.coat_ggx().sample_mirror(wo, u),
            Lobe::Facets => self.sample_facet(wo, rest, u),
            Lobe::Sheen => Some(facing(warp::uniform_cone(u, 1.0))),
            Lobe::Diffuse => {
                let wi = facing(warp::cosine_hemisphere(u));
                let stays = rest < self.diffuse_reflection_prob();
                Some(if stays { wi } else { mirrored_below(wi) })
            }
        }
    }

    #[inline]
    fn sample_facet(&self, wo: Vec3, u_lobe: f32, u: Vec2) -> Option<Vec3> {
        let mut rest = u_lobe;
        if self.is_multiple() {
            let [stays, crosses] = self.multiple_probs(wo);
            let often = stays + crosses;
            if rest < often {
                let side = if rest < stays { wo } else { -wo };
                return Some(Spread::new(self.ggx).sample(side, u));
            }
            rest = ((rest - often) / (1.0 - often)).min(ONE_MINUS_EPSILON);
        }
        let m = self.ggx.sample_visible(wo, u);
        let cos = wo.dot(m);
        let reflected = m * (2.0 * cos) - wo;
        if rest < self.reflection_prob(cos)? {
            return same_hemisphere(wo, reflected).then_some(reflected);
        }
        let wi = match self.thickness {
            // The mirrored direction has to leave on the side of `wo` to be mirrored below.
            Thickness::ThinWalled => {
                let stays = same_hemisphere(wo, reflected);
                stays.then(|| mirrored_below(reflected))?
            }
            Thickness::Solid => refract(wo, m, self.interface().eta_across(wo))?,
        };
        (wi.z != 0.0 && !same_hemisphere(wo, wi)).then_some(wi)
    }

    /// Returns the sample of the mirrored direction, with the sum of all Dirac lobes that lead there.
    #[inline]
    fn mirror(&self, wo: Vec3) -> BsdfSample {
        let (mut reflectance, mut prob) = (Spectrum::ZERO, 0.0);
        let probs = self.probs(wo);
        if self.coat_ggx().is_smooth() && !self.is_bare(wo) {
            reflectance += Spectrum::splat(self.coat * coat_fresnel(wo.z.abs()));
            prob += probs.map_or(0.0, |probs| probs.coat);
        }
        if self.ggx.is_smooth() {
            reflectance += self.facet(wo.z).0 * self.layers(wo).below();
            prob += self.smooth_probs(wo)[0];
        }
        let drawn = BsdfSample::mirror(wo, reflectance, prob, self.albedo(wo));
        let pdf = drawn.pdf * sqr(if self.is_bare(wo) { self.eta } else { 1.0 });
        BsdfSample {
            pdf,
            pdf_reverse: pdf,
            ..drawn
        }
    }

    /// Returns the probabilities that the smooth base is drawn and reflects, and that it is drawn and transmits.
    #[inline]
    fn smooth_probs(&self, w: Vec3) -> [f32; 2] {
        let facets = self.probs(w).map_or(0.0, |probs| probs.facets);
        let reflects = self.reflection_prob(w.z).unwrap_or(0.0);
        [facets * reflects, facets * (1.0 - reflects)]
    }

    /// Draws from a smooth base. None: it transmits nothing.
    #[inline]
    fn sample_smooth(&self, wo: Vec3, mode: TransportMode, rest: f32) -> Option<BsdfSample> {
        if rest < self.reflection_prob(wo.z)? {
            return Some(self.mirror(wo));
        }
        let (wi, scale, [index_o, index_i]) = match self.thickness {
            Thickness::ThinWalled => (-wo, 1.0, [1.0; 2]),
            Thickness::Solid => {
                let interface = self.interface();
                let wi = refract(wo, Vec3::Z, interface.eta_across(wo))?;
                let indices = [wo, wi].map(|w| interface.eta_at(w));
                (wi, interface.crossing_scale(wo, mode), indices)
            }
        };
        let [prob, reverse] = [wo, wi].map(|w| self.smooth_probs(w)[1]);
        let below = self.layers(wo).below().min(self.layers(wi).below());
        let value = self.facet(wo.z).1 * (scale * below);
        (wi.z != 0.0 && prob > 0.0).then(|| BsdfSample {
            wi,
            weight: value / prob,
            pdf: prob * sqr(index_i) * wi.z.abs(),
            pdf_reverse: reverse * sqr(index_o) * wo.z.abs(),
            albedo_reverse: self.albedo(wi).max_lane(),
            is_delta: true,
        })
    }
}

impl Probs {
    /// Returns the lobe that the number `u` chooses, and the rest of `u`, uniform in `[0, 1)`.
    #[inline]
    pub(super) fn choose(self, u: f32) -> (Lobe, f32) {
        let lobes = [
            (Lobe::Coat, self.coat),
            (Lobe::Facets, self.facets),
            (Lobe::Sheen, self.sheen),
        ];
        let mut rest = u;
        for (lobe, prob) in lobes {
            if rest < prob {
                return (lobe, (rest / prob).clamp(0.0, ONE_MINUS_EPSILON));
            }
            rest -= prob;
        }
        // Rounding may leave a little where there is nothing diffuse.
        let last = if self.diffuse > 0.0 {
            Lobe::Diffuse
        } else {
            Lobe::Facets
        };
        let rest = rest / self.diffuse.max(f32::MIN_POSITIVE);
        (last, rest.clamp(0.0, ONE_MINUS_EPSILON))
    }
}

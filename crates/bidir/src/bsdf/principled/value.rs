//! Value and densities of the scattering: sums over all lobes that are not Dirac distributions.

use super::{EVEN, Layers, Principled, Side, Thickness, coat_fresnel, mirrored_below, sheen};
use crate::bsdf::{BsdfValue, TransportMode, same_hemisphere};
use crate::math::{Vec3, warp};
use crate::spectrum::Spectrum;

/// f of one lobe between two directions, and the densities of drawing each direction for the other.
#[derive(Clone, Copy)]
pub(super) struct LobeValue {
    pub(super) f: Spectrum,
    pub(super) densities: [f32; 2],
}

impl LobeValue {
    const NONE: Self = Self {
        f: Spectrum::ZERO,
        densities: [0.0; 2],
    };
}

impl Principled {
    #[inline]
    pub(in crate::bsdf) fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> BsdfValue {
        self.eval_layers([[wo; 2], [wi; 2]], [1.0; 2], mode)
    }

    /// Evaluates base and coat for directions in their own frames; f of each is multiplied by its ratio.
    #[inline]
    pub(crate) fn eval_layers(
        &self,
        [wo, wi]: [[Vec3; 2]; 2],
        ratios: [f32; 2],
        mode: TransportMode,
    ) -> BsdfValue {
        if [wo, wi].iter().flatten().any(|w| w.z == 0.0) {
            return BsdfValue::NONE;
        }
        let of_coat = [wo[1], wi[1]];
        let pair = [wo, wi].map(|[base, _]| self.along_grain(base));
        let seen = [0, 1].map(|end| self.layers_between([pair[end], of_coat[end]]));
        let shares = [0, 1].map(|end| self.shares(pair[end], &seen[end]));
        let [is_reflected, by_coat] = [pair, of_coat].map(|[wo, wi]| same_hemisphere(wo, wi));
        let coat = if by_coat {
            self.coat_lobe(of_coat)
        } else {
            LobeValue::NONE
        };
        let once = if is_reflected {
            self.reflecting_facets(pair)
        } else {
            self.crossing_facets(pair, mode)
        };
        let facets = if self.is_multiple() {
            self.with_multiple(once, pair, mode)
        } else {
            once
        };
        let base = if is_reflected {
            self.reflected(pair, &seen, facets.f)
        } else {
            self.crossed(&seen, facets.f)
        };
        let f = base * ratios[0] + coat.f * ratios[1];
        let stays = self.diffuse_reflection_prob();
        let side = if is_reflected { stays } else { 1.0 - stays };
        let even = if is_reflected { EVEN } else { 0.0 };
        let pdf = |from: usize| {
            let probs = self.probs_of(&shares[from])?;
            let diffuse = side * warp::cosine_hemisphere_pdf(pair[1 - from].z.abs());
            let of_facets = probs.facets * facets.densities[from];
            let of_coat = probs.coat * coat.densities[from];
            Some(probs.diffuse * diffuse + probs.sheen * even + of_facets + of_coat)
        };
        BsdfValue {
            f,
            pdf: pdf(0).unwrap_or(0.0),
            pdf_reverse: pdf(1).unwrap_or(0.0),
            albedo_reverse: Self::albedo_of(&shares[1]).max_lane(),
        }
    }

    /// Returns f of reflection by all lobes but the coat; `facets` is f of the base's facets.
    #[inline]
    fn reflected(&self, [wo, wi]: [Vec3; 2], [o, i]: &[Layers; 2], facets: Spectrum) -> Spectrum {
        let mut base = facets;
        if self.diffuse > 0.0 {
            base += self.tint * (self.diffuse * self.uncovered(o) * self.uncovered(i));
        }
        base *= Spectrum::splat(o.below().min(i.below()));
        if self.sheen.is_black() || self.is_bare(wo) {
            return base;
        }
        let under_coat = 1.0 - o.coat.max(i.coat);
        base + self.sheen * (sheen::eval(wo, wi, self.sheen_alpha) * under_coat)
    }

    /// Returns f of transmission by all lobes; `facets` is f of the base's facets.
    #[inline]
    fn crossed(&self, [o, i]: &[Layers; 2], facets: Spectrum) -> Spectrum {
        let diffuse = self.through * (self.uncovered(o) * self.uncovered(i));
        (facets + diffuse) * o.below().min(i.below())
    }

    #[inline]
    fn coat_lobe(&self, [wo, wi]: [Vec3; 2]) -> LobeValue {
        let ggx = self.coat_ggx();
        if self.coat <= 0.0 || self.is_bare(wo) || ggx.is_smooth() {
            return LobeValue::NONE;
        }
        let mirror = ggx.mirror(wo, wi);
        let reflected = self.coat * mirror.facets * coat_fresnel(mirror.cos.abs());
        LobeValue {
            f: Spectrum::splat(reflected),
            densities: mirror.densities,
        }
    }

    /// Evaluates reflection by the base's facets, without the layers above.
    #[inline]
    fn reflecting_facets(&self, [wo, wi]: [Vec3; 2]) -> LobeValue {
        if self.ggx.is_smooth() {
            return LobeValue::NONE;
        }
        let mirror = self.ggx.mirror(wo, wi);
        let cos = mirror.cos.abs().copysign(wo.z);
        let prob = self.reflection_prob(cos).unwrap_or(0.0);
        LobeValue {
            f: self.facet(cos).0 * mirror.facets,
            densities: mirror.densities.map(|pdf| prob * pdf),
        }
    }

    /// Evaluates transmission by the base's facets, without the layers above.
    #[inline]
    fn crossing_facets(&self, [wo, wi]: [Vec3; 2], mode: TransportMode) -> LobeValue {
        if self.glass <= 0.0 || self.ggx.is_smooth() {
            return LobeValue::NONE;
        }
        let crossing_prob = |cos| 1.0 - self.reflection_prob(cos).unwrap_or(1.0);
        if self.thickness == Thickness::ThinWalled {
            let mirror = self.ggx.mirror(wo, mirrored_below(wi));
            let prob = crossing_prob(mirror.cos);
            return LobeValue {
                f: self.facet(mirror.cos).1 * mirror.facets,
                densities: mirror.densities.map(|pdf| prob * pdf),
            };
        }
        let interface = self.interface();
        let Some((m, Side::Transmission)) = interface.facet(wo, wi) else {
            return LobeValue::NONE;
        };
        let crossing = interface.crossing(wo, wi, m);
        let [pdf, pdf_reverse] = crossing.densities;
        let scale = crossing.facets * interface.crossing_scale(wo, mode);
        LobeValue {
            f: self.facet(wo.dot(m)).1 * scale,
            densities: [
                crossing_prob(wo.dot(m)) * pdf,
                crossing_prob(wi.dot(m)) * pdf_reverse,
            ],
        }
    }
}

//! The material of glTF 2.0: metal, or a dielectric layer over a diffuse or transparent base, under
//! sheen and a clear coat.
//!
//! f = C(o) C(i) { S(o) S(i) [ F(m) D G₂ / (4 |cosθ_o cosθ_i|) + k(o) k(i) ρ / (π k̄) + T(m) … ] + sheen }
//! + coat, 1/sr, where
//!
//! - F = f₀ + (f₉₀ - f₀) (1 - o·m)⁵ [Schlick94] of metal and opaque dielectric, plus Fresnel's own
//!   reflectance for the transparent part, which T takes its rest of: refraction [Walter07, eq. 21],
//!   or for a thin wall the lobe of F mirrored to the other side;
//! - k = 1 - Ẽ is what the dielectric's reflection leaves of each direction and k̄ its mean, so that a
//!   white base under it is white [Kelemen01];
//! - S and C are what sheen and coat leave, 1 - Ẽ likewise (`under`).
//!
//! Each factor belongs to one direction, or is symmetric in both, so f is; and no layer hands on more
//! than its own lobe leaves, so nothing gains (docs/derivations/principled.md).

mod parameters;
mod sheen;
#[cfg(test)]
mod tests;
mod under;

pub use parameters::{Coat as PrincipledCoat, PrincipledParameters, Wall};

use super::dielectric::{Dielectric, Lobe as Side, refract};
use super::microfacet::Ggx;
use super::{BsdfSample, TransportMode, fresnel, same_hemisphere};
use crate::math::{INV_PI, ONE_MINUS_EPSILON, PI, Vec2, Vec3, sqr, warp};
use crate::spectrum::Spectrum;

/// F₀ of a clear coat, whose index is 1.5.
const COAT_F0: f32 = 0.04;
/// The density of an even direction on one side. Unit: 1/sr.
const EVEN: f32 = 0.5 * INV_PI;

/// Metal, plastic, glass, cloth and lacquer, and what lies between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Principled {
    /// The base colour: of the diffuse part, and what crossing the surface tints.
    tint: Spectrum,
    /// f₀ of metal and opaque dielectric, with their shares.
    f0: Spectrum,
    /// f₉₀ of both, likewise.
    f90: f32,
    /// The share of the transparent part.
    glass: f32,
    /// What Fresnel's reflectance of the transparent part is scaled by.
    specular: f32,
    /// Index of refraction of the transparent part, inside over outside.
    eta: f32,
    /// Facets along the axes of the surface's own grain.
    ggx: Ggx,
    /// Cosine and sine of the grain's angle to the tangent.
    grain: Vec2,
    /// (share of the diffuse part) / (π k̄).
    diffuse: f32,
    /// The same of what goes through diffusely, with its colour.
    through: Spectrum,
    /// f₀ and f₉₀ that k is of.
    cover: [f32; 2],
    /// How much of the surface a clear coat covers.
    coat: f32,
    coat_alpha: f32,
    sheen: Spectrum,
    sheen_alpha: f32,
    wall: Wall,
}

/// The ways in which light leaves, as they are drawn.
#[derive(Clone, Copy, PartialEq)]
enum Lobe {
    Coat,
    Facets,
    Diffuse,
    Sheen,
}

/// The probabilities of the lobes, seen from one direction.
#[derive(Clone, Copy)]
struct Probs {
    coat: f32,
    facets: f32,
    diffuse: f32,
    sheen: f32,
}

impl Principled {
    /// The slope that bounds go by.
    #[inline]
    fn alpha(&self) -> f32 {
        self.ggx.mean_alpha()
    }

    #[inline]
    fn coat_ggx(&self) -> Ggx {
        Ggx::new(self.coat_alpha, self.coat_alpha)
    }

    /// True where no coat and no sheen lies on the side of `w`: within a solid.
    #[inline]
    fn is_bare(&self, w: Vec3) -> bool {
        self.wall == Wall::Solid && w.z < 0.0
    }

    /// Ẽ of the coat, times how much it covers.
    #[inline]
    fn coat_albedo(&self, w: Vec3) -> f32 {
        if self.coat <= 0.0 || self.is_bare(w) {
            return 0.0;
        }
        let weight = under::facet_weight(w.z.abs(), self.coat_alpha);
        self.coat * (COAT_F0 + (1.0 - COAT_F0) * weight).min(1.0)
    }

    /// Ẽ of the sheen's brightest lane.
    #[inline]
    fn sheen_albedo(&self, w: Vec3) -> f32 {
        if self.sheen.is_black() || self.is_bare(w) {
            return 0.0;
        }
        self.sheen.max_lane() * under::sheen_albedo(w.z.abs(), self.sheen_alpha)
    }

    /// What coat and sheen leave of light along `w`.
    #[inline]
    fn layers(&self, w: Vec3) -> f32 {
        (1.0 - self.coat_albedo(w)) * (1.0 - self.sheen_albedo(w))
    }

    /// k: what the dielectric's reflection leaves for a diffuse base.
    #[inline]
    fn uncovered(&self, w: Vec3) -> f32 {
        let [f0, f90] = self.cover;
        let weight = under::facet_weight(w.z.abs(), self.alpha());
        (1.0 - f0 - (f90 - f0) * weight).clamp(0.0, 1.0)
    }

    /// The part of light that facets of the transparent part reflect; `cos` is positive outside.
    #[inline]
    fn clear_reflectance(&self, cos: f32) -> f32 {
        let cos = if self.wall == Wall::Solid {
            cos
        } else {
            cos.abs()
        };
        match fresnel::dielectric(cos, self.eta) {
            total if total >= 1.0 => 1.0,
            part => part * self.specular,
        }
    }

    /// F, where light meets facets at the cosine `cos` and Schlick's weight is `weight`.
    #[inline]
    fn reflectance(&self, cos: f32, weight: f32) -> Spectrum {
        let opaque = self.f0.map(|f0| f0 + (self.f90 - f0) * weight);
        if self.glass <= 0.0 {
            return opaque;
        }
        opaque + Spectrum::splat(self.glass * self.clear_reflectance(cos))
    }

    /// F and T at the cosine `cos` between a direction and a facet.
    #[inline]
    fn facet(&self, cos: f32) -> (Spectrum, Spectrum) {
        let reflected = self.reflectance(cos, under::schlick(cos.abs()));
        if self.glass <= 0.0 {
            return (reflected, Spectrum::ZERO);
        }
        let crossing = self.glass * (1.0 - self.clear_reflectance(cos));
        (reflected, self.tint * crossing)
    }

    /// The probability that a facet met at `cos` reflects, where it is drawn. None: it is black.
    #[inline]
    fn reflection_prob(&self, cos: f32) -> Option<f32> {
        let (reflected, crossing) = self.facet(cos);
        let [r, t] = [reflected, crossing].map(Spectrum::max_lane);
        (r + t > 0.0).then(|| r / (r + t))
    }

    /// About the part of light along `w` that each lobe scatters.
    #[inline]
    fn shares(&self, w: Vec3) -> [Spectrum; 4] {
        let coat = self.coat_albedo(w);
        let sheen = (1.0 - coat) * self.sheen_albedo(w);
        let below = self.layers(w);
        let weight = under::facet_weight(w.z.abs(), self.alpha());
        let (_, crossing) = self.facet(w.z);
        // Facets tilted away from `w` reflect where the bound says that none does.
        let tilted = 0.01 * self.f90.max(self.glass);
        let facets = self.reflectance(w.z, weight) + crossing + Spectrum::splat(tilted);
        let diffuse = self.tint * self.diffuse + self.through;
        [
            Spectrum::splat(coat),
            facets * below,
            diffuse * (PI * below * self.uncovered(w)),
            self.sheen.map(|lane| lane.min(1.0)) * sheen,
        ]
    }

    /// The probabilities of drawing from each lobe; they depend on |cosθ| and the side alone. None:
    /// nothing is scattered.
    #[inline]
    fn probs(&self, w: Vec3) -> Option<Probs> {
        let mut shares = self.shares(w).map(Spectrum::max_lane);
        if self.f0.is_black() && self.f90 <= 0.0 && self.glass <= 0.0 {
            shares[1] = 0.0;
        }
        let sum: f32 = shares.iter().sum();
        let [coat, facets, diffuse, sheen] = shares.map(|share| share / sum);
        (sum > 0.0).then_some(Probs {
            coat,
            facets,
            diffuse,
            sheen,
        })
    }

    #[inline]
    pub(super) fn is_delta(&self) -> bool {
        let no_base = self.diffuse <= 0.0 || self.tint.is_black();
        let is_bare = self.coat <= 0.0 || self.coat_ggx().is_smooth();
        self.ggx.is_smooth()
            && is_bare
            && no_base
            && self.through.is_black()
            && self.sheen.is_black()
    }

    #[inline]
    pub(super) fn albedo(&self, wo: Vec3) -> Spectrum {
        let [coat, facets, diffuse, sheen] = self.shares(wo);
        (coat + facets + diffuse + sheen).map(|lane| lane.clamp(0.0, 1.0))
    }

    /// A direction in the axes of the grain.
    #[inline]
    fn to_grain(&self, w: Vec3) -> Vec3 {
        let Vec2 { x: cos, y: sin } = self.grain;
        Vec3::new(w.x * cos + w.y * sin, w.y * cos - w.x * sin, w.z)
    }

    #[inline]
    fn from_grain(&self, w: Vec3) -> Vec3 {
        let Vec2 { x: cos, y: sin } = self.grain;
        Vec3::new(w.x * cos - w.y * sin, w.y * cos + w.x * sin, w.z)
    }

    /// The transparent part alone.
    #[inline]
    fn interface(&self) -> Dielectric {
        Dielectric {
            eta: self.eta,
            ggx: self.ggx,
        }
    }

    #[inline]
    pub(super) fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> Spectrum {
        if wo.z == 0.0 || wi.z == 0.0 {
            return Spectrum::ZERO;
        }
        let (wo, wi) = (self.to_grain(wo), self.to_grain(wi));
        if same_hemisphere(wo, wi) {
            self.eval_reflection(wo, wi)
        } else {
            self.eval_transmission(wo, wi, mode)
        }
    }

    #[inline]
    fn eval_reflection(&self, wo: Vec3, wi: Vec3) -> Spectrum {
        let mut base = Spectrum::ZERO;
        if !self.ggx.is_smooth() {
            let (facets, cos) = self.ggx.mirror(wo, wi);
            let (reflected, _) = self.facet(cos.abs().copysign(wo.z));
            base += reflected * facets;
        }
        if self.diffuse > 0.0 {
            base += self.tint * (self.diffuse * self.uncovered(wo) * self.uncovered(wi));
        }
        base = base * (self.layers(wo) * self.layers(wi));
        if self.is_bare(wo) {
            return base;
        }
        let under_coat = (1.0 - self.coat_albedo(wo)) * (1.0 - self.coat_albedo(wi));
        if !self.sheen.is_black() {
            base += self.sheen * (sheen::eval(wo, wi, self.sheen_alpha) * under_coat);
        }
        base + Spectrum::splat(self.eval_coat(wo, wi))
    }

    #[inline]
    fn eval_coat(&self, wo: Vec3, wi: Vec3) -> f32 {
        let ggx = self.coat_ggx();
        if self.coat <= 0.0 || ggx.is_smooth() {
            return 0.0;
        }
        let (facets, cos) = ggx.mirror(wo, wi);
        self.coat * facets * coat_fresnel(cos.abs())
    }

    #[inline]
    fn eval_transmission(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> Spectrum {
        let mut f = Spectrum::ZERO;
        if !self.through.is_black() {
            f += self.through * (self.uncovered(wo) * self.uncovered(wi));
        }
        if self.glass > 0.0 && !self.ggx.is_smooth() {
            f += match self.wall {
                Wall::Solid => self.eval_refraction(wo, wi, mode),
                Wall::Thin => {
                    let (facets, cos) = self.ggx.mirror(wo, mirrored_below(wi));
                    self.facet(cos).1 * facets
                }
            };
        }
        f * (self.layers(wo) * self.layers(wi))
    }

    #[inline]
    fn eval_refraction(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> Spectrum {
        let interface = self.interface();
        let Some((m, Side::Transmission)) = interface.facet(wo, wi) else {
            return Spectrum::ZERO;
        };
        let facets = self.ggx.d(m) * self.ggx.g2(wo, wi) / (wo.z * wi.z).abs();
        let bend = (wo.dot(m) * wi.dot(m)).abs() * interface.refraction_jacobian(wo, wi, m);
        self.facet(wo.dot(m)).1 * (facets * bend * interface.crossing_scale(wo, mode))
    }

    #[inline]
    pub(super) fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        if wo.z == 0.0 || wi.z == 0.0 {
            return 0.0;
        }
        let (wo, wi) = (self.to_grain(wo), self.to_grain(wi));
        let Some(probs) = self.probs(wo) else {
            return 0.0;
        };
        let is_reflected = same_hemisphere(wo, wi);
        let side = if is_reflected {
            self.diffuse_reflection_prob()
        } else {
            1.0 - self.diffuse_reflection_prob()
        };
        let mut pdf = probs.diffuse * side * warp::cosine_hemisphere_pdf(wi.z.abs());
        if is_reflected {
            pdf += probs.sheen * EVEN;
            if probs.coat > 0.0 && !self.coat_ggx().is_smooth() {
                pdf += probs.coat * self.coat_ggx().mirror_pdf(wo, wi);
            }
        }
        if probs.facets > 0.0 && !self.ggx.is_smooth() {
            pdf += probs.facets * self.facets_pdf(wo, wi);
        }
        pdf
    }

    /// The density of `wi` where a facet is drawn that `wo` sees, and reflects or lets through.
    #[inline]
    fn facets_pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        if same_hemisphere(wo, wi) {
            let m = (wo + wi).normalize();
            let cos = wo.dot(m).abs().copysign(wo.z);
            let prob = self.reflection_prob(cos).unwrap_or(0.0);
            return prob * self.ggx.mirror_pdf(wo, wi);
        }
        if self.glass <= 0.0 {
            return 0.0;
        }
        if self.wall == Wall::Thin {
            let wi = mirrored_below(wi);
            let cos = wo.dot((wo + wi).normalize());
            let prob = 1.0 - self.reflection_prob(cos).unwrap_or(1.0);
            return prob * self.ggx.mirror_pdf(wo, wi);
        }
        let interface = self.interface();
        let Some((m, Side::Transmission)) = interface.facet(wo, wi) else {
            return 0.0;
        };
        let prob = 1.0 - self.reflection_prob(wo.dot(m)).unwrap_or(1.0);
        let jacobian = wi.dot(m).abs() * interface.refraction_jacobian(wo, wi, m);
        prob * self.ggx.visible_pdf(wo, m) * jacobian
    }

    /// The probability that light which is scattered diffusely stays on its side.
    #[inline]
    fn diffuse_reflection_prob(&self) -> f32 {
        let [back, through] = [self.tint * self.diffuse, self.through].map(Spectrum::max_lane);
        if through > 0.0 {
            back / (back + through)
        } else {
            1.0
        }
    }

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
        let wo = self.to_grain(wo);
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
            wi: self.from_grain(drawn.wi),
            ..drawn
        })
    }

    /// `wi` with value and densities; both directions in the axes of the grain.
    #[inline]
    fn finite_sample(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> Option<BsdfSample> {
        let along = Self {
            grain: Vec2::X,
            ..*self
        };
        let densities = [along.pdf(wo, wi), along.pdf(wi, wo)];
        BsdfSample::of_densities(wi, along.eval(wo, wi, mode), densities)
    }

    /// Draws a direction from a lobe that is no Dirac distribution. None: it does not leave.
    #[inline]
    fn sample_lobe(&self, lobe: Lobe, wo: Vec3, rest: f32, u: Vec2) -> Option<Vec3> {
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
    fn sample_facet(&self, wo: Vec3, rest: f32, u: Vec2) -> Option<Vec3> {
        let m = self.ggx.sample_visible(wo, u);
        let cos = wo.dot(m);
        let reflected = m * (2.0 * cos) - wo;
        if rest < self.reflection_prob(cos)? {
            return same_hemisphere(wo, reflected).then_some(reflected);
        }
        let wi = match self.wall {
            // The mirrored direction has to leave on the side of `wo` to be mirrored below.
            Wall::Thin => {
                let stays = same_hemisphere(wo, reflected);
                stays.then(|| mirrored_below(reflected))?
            }
            Wall::Solid => refract(wo, m, self.interface().eta_across(wo))?,
        };
        (wi.z != 0.0 && !same_hemisphere(wo, wi)).then_some(wi)
    }

    /// The mirrored direction, by all Dirac lobes that lead there.
    #[inline]
    fn mirror(&self, wo: Vec3) -> BsdfSample {
        let (mut reflectance, mut prob) = (Spectrum::ZERO, 0.0);
        let probs = self.probs(wo);
        if self.coat_ggx().is_smooth() && !self.is_bare(wo) {
            reflectance += Spectrum::splat(self.coat * coat_fresnel(wo.z.abs()));
            prob += probs.map_or(0.0, |probs| probs.coat);
        }
        if self.ggx.is_smooth() {
            reflectance += self.facet(wo.z).0 * sqr(self.layers(wo));
            prob += self.smooth_probs(wo)[0];
        }
        let drawn = BsdfSample::mirror(wo, reflectance, prob);
        let pdf = drawn.pdf * sqr(if self.is_bare(wo) { self.eta } else { 1.0 });
        BsdfSample {
            pdf,
            pdf_reverse: pdf,
            ..drawn
        }
    }

    /// The probabilities that a smooth base is drawn and reflects, and that it lets through.
    #[inline]
    fn smooth_probs(&self, w: Vec3) -> [f32; 2] {
        let facets = self.probs(w).map_or(0.0, |probs| probs.facets);
        let reflects = self.reflection_prob(w.z).unwrap_or(0.0);
        [facets * reflects, facets * (1.0 - reflects)]
    }

    /// Draws from a smooth base. None: it lets nothing through.
    #[inline]
    fn sample_smooth(&self, wo: Vec3, mode: TransportMode, rest: f32) -> Option<BsdfSample> {
        if rest < self.reflection_prob(wo.z)? {
            return Some(self.mirror(wo));
        }
        let (wi, scale, [index_o, index_i]) = match self.wall {
            Wall::Thin => (-wo, 1.0, [1.0; 2]),
            Wall::Solid => {
                let interface = self.interface();
                let wi = refract(wo, Vec3::Z, interface.eta_across(wo))?;
                let indices = [wo, wi].map(|w| interface.eta_at(w));
                (wi, interface.crossing_scale(wo, mode), indices)
            }
        };
        let [prob, reverse] = [wo, wi].map(|w| self.smooth_probs(w)[1]);
        let value = self.facet(wo.z).1 * (scale * self.layers(wo) * self.layers(wi));
        (wi.z != 0.0 && prob > 0.0).then(|| BsdfSample {
            wi,
            weight: value / prob,
            pdf: prob * sqr(index_i) * wi.z.abs(),
            pdf_reverse: reverse * sqr(index_o) * wo.z.abs(),
            is_delta: true,
        })
    }
}

#[cfg(test)]
impl Principled {
    pub(super) fn is_solid(&self) -> bool {
        self.wall == Wall::Solid
    }

    pub(super) fn index_inside(&self) -> f32 {
        if self.is_solid() { self.eta } else { 1.0 }
    }
}

impl Probs {
    /// The lobe of the number `u`, and what of `u` is left to choose by.
    #[inline]
    fn choose(self, u: f32) -> (Lobe, f32) {
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

#[inline]
fn mirrored_below(w: Vec3) -> Vec3 {
    Vec3::new(w.x, w.y, -w.z)
}

#[inline]
fn coat_fresnel(cos: f32) -> f32 {
    COAT_F0 + (1.0 - COAT_F0) * under::schlick(cos)
}

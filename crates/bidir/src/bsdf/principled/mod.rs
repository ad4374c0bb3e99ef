//! The material of glTF 2.0: metal, or a dielectric layer over a diffuse or transparent base, under
//! sheen and a clear coat.
//!
//! f = C { S [ F(m) D G₂ / (4 |cosθ_o cosθ_i|) + k(o) k(i) ρ / (π k̄) + T(m) … + turns ] + sheen } + coat, 1/sr, where
//!
//! - F = f₀ + (f₉₀ - f₀) (1 - o·m)⁵ \[Schlick94\] for metal and opaque dielectric, plus Fresnel's reflectance for the
//!   transparent part. T transmits the rest of that part: by refraction [Walter07, eq. 21], or for a thin wall by the
//!   lobe of F mirrored to the other side;
//! - turns is the light that facets scatter more than once (`multiple`);
//! - k = 1 - Ẽ is the fraction of light from each direction that the dielectric's reflection leaves, and k̄ its mean,
//!   so that a white base under it is white \[Kelemen01\];
//! - S and C are the fractions that sheen and coat leave, the smaller 1 - Ẽ of both directions (`under`).
//!
//! Each factor depends on one direction or is symmetric in both, so f is symmetric. No layer passes on more than its
//! own lobe leaves, so nothing gains energy (docs/derivations/principled.md).

mod draw;
mod layers;
mod multiple;
mod parameters;
mod sheen;
#[cfg(test)]
mod tests;
mod under;
mod value;

pub use layers::Layer;
pub use parameters::{Coat as PrincipledCoat, PrincipledParameters, Thickness};

use super::dielectric::{Dielectric, Lobe as Side};
use super::fresnel;
use super::microfacet::Ggx;
use super::multiple::Sides;
use crate::math::{INV_PI, PI, Vec2, Vec3};
use crate::spectrum::Spectrum;

/// F₀ of a clear coat, whose index is 1.5.
const COAT_F0: f32 = 0.04;
/// The density of an even direction on one side. Unit: 1/sr.
const EVEN: f32 = 0.5 * INV_PI;

/// Metal, plastic, glass, cloth and lacquer, and mixtures of these.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Principled {
    /// The base colour: of the diffuse part, and of light that crosses the surface.
    tint: Spectrum,
    /// The share of metal, whose f₀ is the base colour.
    metal: f32,
    /// f₀ of opaque dielectric, times its share.
    f0: Spectrum,
    /// f₉₀ of metal and opaque dielectric, times their shares.
    f90: f32,
    /// The share of the transparent part.
    glass: f32,
    /// The factor of Fresnel's reflectance of the transparent part.
    specular: f32,
    /// Index of refraction of the transparent part, inside over outside.
    eta: f32,
    /// Facets along the axes of the surface's own grain.
    ggx: Ggx,
    /// Cosine and sine of the grain's angle to the tangent.
    grain: Vec2,
    /// (share of the diffuse part) / (π k̄).
    diffuse: f32,
    /// The share of diffuse transmission / (π k̄), times its colour.
    through: Spectrum,
    /// The f₀ and f₉₀ that determine k.
    cover: [f32; 2],
    /// The fraction of the surface that a clear coat covers.
    coat: f32,
    coat_alpha: f32,
    sheen: Spectrum,
    sheen_alpha: f32,
    /// k̄ of facets that mirror. Zero: the light that they lose is lost.
    lost: f32,
    /// k̄ of a transparent solid's facets. Zero: the light that they lose is lost.
    lost_through: Sides,
    thickness: Thickness,
    /// The normal of the coat, in the frame of the base. Unit: 1/[`i16::MAX`].
    coat_normal: [i16; 3],
}

/// The lobes that are drawn.
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

/// Albedos of the layers above the base for light along one direction.
struct Layers {
    /// Ẽ of the coat, times how much it covers.
    coat: f32,
    /// Ẽ of the sheen's brightest lane.
    sheen: f32,
    /// W̃: the weight of f₉₀ in the albedo of the base's facets.
    weight: f32,
}

impl Layers {
    /// Returns the fraction of light that coat and sheen leave for the base.
    #[inline]
    fn below(&self) -> f32 {
        (1.0 - self.coat) * (1.0 - self.sheen)
    }
}

impl Principled {
    /// Returns the slope that bounds depend on.
    #[inline]
    fn alpha(&self) -> f32 {
        self.ggx.mean_alpha()
    }

    #[inline]
    fn coat_ggx(&self) -> Ggx {
        Ggx::new(self.coat_alpha, self.coat_alpha)
    }

    /// Returns true if no coat and no sheen is on the side of `w`: within a solid.
    #[inline]
    fn is_bare(&self, w: Vec3) -> bool {
        self.thickness == Thickness::Solid && w.z < 0.0
    }

    /// Returns Ẽ of the coat, times how much it covers.
    #[inline]
    fn coat_albedo(&self, w: Vec3) -> f32 {
        if self.coat <= 0.0 || self.is_bare(w) {
            return 0.0;
        }
        let weight = under::facet_weight(w.z.abs(), self.coat_alpha);
        self.coat * (COAT_F0 + (1.0 - COAT_F0) * weight).min(1.0)
    }

    /// Returns Ẽ of the sheen's brightest lane.
    #[inline]
    fn sheen_albedo(&self, w: Vec3) -> f32 {
        if self.sheen.is_black() || self.is_bare(w) {
            return 0.0;
        }
        self.sheen.max_lane() * under::sheen_albedo(w.z.abs(), self.sheen_alpha)
    }

    /// Returns the albedos of the layers for light along `w`.
    #[inline]
    fn layers(&self, w: Vec3) -> Layers {
        self.layers_between([w; 2])
    }

    /// Returns the albedos of the layers for light along a direction, given in the frames of base and coat.
    #[inline]
    fn layers_between(&self, [base, coat]: [Vec3; 2]) -> Layers {
        Layers {
            coat: self.coat_albedo(coat),
            sheen: self.sheen_albedo(base),
            weight: under::facet_weight(base.z.abs(), self.alpha()),
        }
    }

    /// Returns k, the fraction that the dielectric's reflection leaves for a diffuse base.
    #[inline]
    fn uncovered(&self, seen: &Layers) -> f32 {
        let [f0, f90] = self.cover;
        (1.0 - f0 - (f90 - f0) * seen.weight).clamp(0.0, 1.0)
    }

    /// Returns the reflectance of facets of the transparent part; `cos` is positive outside.
    #[inline]
    fn clear_reflectance(&self, cos: f32) -> f32 {
        let cos = if self.thickness == Thickness::Solid {
            cos
        } else {
            cos.abs()
        };
        match fresnel::dielectric(cos, self.eta) {
            total if total >= 1.0 => 1.0,
            part => part * self.specular,
        }
    }

    /// Returns f₀ of metal and opaque dielectric.
    #[inline]
    fn normal_reflectance(&self) -> Spectrum {
        self.tint * self.metal + self.f0
    }

    /// Returns F for light that meets facets at the cosine `cos`, with Schlick's weight `weight`.
    #[inline]
    fn reflectance(&self, cos: f32, weight: f32) -> Spectrum {
        let opaque = self
            .normal_reflectance()
            .map(|f0| f0 + (self.f90 - f0) * weight);
        if self.glass <= 0.0 {
            return opaque;
        }
        opaque + Spectrum::splat(self.glass * self.clear_reflectance(cos))
    }

    /// Returns F and T at the cosine `cos` between a direction and a facet.
    #[inline]
    fn facet(&self, cos: f32) -> (Spectrum, Spectrum) {
        let reflected = self.reflectance(cos, fresnel::schlick(cos.abs()));
        if self.glass <= 0.0 {
            return (reflected, Spectrum::ZERO);
        }
        let crossing = self.glass * (1.0 - self.clear_reflectance(cos));
        (reflected, self.tint * crossing)
    }

    /// Returns the probability that a drawn facet reflects light that meets it at `cos`. None: the facet is black.
    #[inline]
    fn reflection_prob(&self, cos: f32) -> Option<f32> {
        let (reflected, crossing) = self.facet(cos);
        let [r, t] = [reflected, crossing].map(Spectrum::max_lane);
        (r + t > 0.0).then(|| r / (r + t))
    }

    /// Returns the approximate albedo of each lobe for light along `w`.
    #[inline]
    fn shares(&self, w: Vec3, seen: &Layers) -> [Spectrum; 4] {
        let (_, crossing) = self.facet(w.z);
        // Facets that are tilted away from `w` reflect even if the bound is zero.
        let tilted = 0.01 * self.f90.max(self.glass);
        let facets = self.reflectance(w.z, seen.weight) + crossing + Spectrum::splat(tilted);
        let diffuse = self.tint * self.diffuse + self.through;
        [
            Spectrum::splat(seen.coat),
            facets * seen.below(),
            diffuse * (PI * seen.below() * self.uncovered(seen)),
            self.sheen.map(|lane| lane.min(1.0)) * ((1.0 - seen.coat) * seen.sheen),
        ]
    }

    /// Returns the probabilities of drawing from each lobe, for light along `w`; they depend only on |cosθ| and the
    /// side. None: nothing is scattered.
    #[inline]
    fn probs(&self, w: Vec3) -> Option<Probs> {
        self.probs_of(&self.shares(w, &self.layers(w)))
    }

    /// Returns the probabilities of drawing from each lobe, given the shares.
    #[inline]
    fn probs_of(&self, shares: &[Spectrum; 4]) -> Option<Probs> {
        let mut shares = shares.map(Spectrum::max_lane);
        if self.normal_reflectance().is_black() && self.f90 <= 0.0 && self.glass <= 0.0 {
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
    pub(super) fn transmits(&self) -> bool {
        self.glass > 0.0 || !self.through.is_black()
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
        Self::albedo_of(&self.shares(wo, &self.layers(wo)))
    }

    /// Returns the albedo: the sum of the shares, in `[0, 1]`.
    #[inline]
    fn albedo_of([coat, facets, diffuse, sheen]: &[Spectrum; 4]) -> Spectrum {
        (*coat + *facets + *diffuse + *sheen).map(|lane| lane.clamp(0.0, 1.0))
    }

    /// Converts a direction to the axes of the grain.
    #[inline]
    fn along_grain(&self, w: Vec3) -> Vec3 {
        let Vec2 { x: cos, y: sin } = self.grain;
        Vec3::new(w.x * cos + w.y * sin, w.y * cos - w.x * sin, w.z)
    }

    #[inline]
    fn off_grain(&self, w: Vec3) -> Vec3 {
        let Vec2 { x: cos, y: sin } = self.grain;
        Vec3::new(w.x * cos - w.y * sin, w.y * cos + w.x * sin, w.z)
    }

    /// Returns only the transparent part.
    #[inline]
    fn interface(&self) -> Dielectric {
        Dielectric {
            eta: self.eta,
            ggx: self.ggx,
            lost: self.lost_through,
        }
    }
}

#[cfg(test)]
impl Principled {
    pub(super) fn is_solid(&self) -> bool {
        self.thickness == Thickness::Solid
    }

    pub(super) fn index_inside(&self) -> f32 {
        if self.is_solid() { self.eta } else { 1.0 }
    }
}

#[inline]
fn mirrored_below(w: Vec3) -> Vec3 {
    Vec3::new(w.x, w.y, -w.z)
}

#[inline]
fn coat_fresnel(cos: f32) -> f32 {
    COAT_F0 + (1.0 - COAT_F0) * fresnel::schlick(cos)
}

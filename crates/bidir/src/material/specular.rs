//! A test whether a material scatters by a Dirac distribution anywhere, from its numbers and the bounds of its
//! textures. Random draws would miss rare lobes, and sample points what lies between them.

use super::{
    CoatSettings, CoatedConductorMaterial, CoatedDiffuseMaterial, Material, Mixture,
    PrincipledMaterial, Roughness, RoughnessMapping, ScaledFloat,
};
use crate::bsdf::microfacet::{Ggx, SMOOTH_ALPHA};
use crate::bsdf::{Dielectric, FacetScattering};
use crate::math::sqr;
use crate::texture::{FloatTexture, Range};

impl Material {
    /// Returns false only if no point of it scatters by Dirac distributions; true if its textures leave it open.
    pub fn may_be_specular(&self) -> bool {
        match self {
            Self::Diffuse { .. } | Self::DiffuseTransmission { .. } => false,
            Self::Conductor { roughness, .. } => roughness.may_be_smooth(),
            Self::Dielectric { eta, roughness, .. } => {
                let ggx = Ggx::new(1.0, 1.0);
                let is_matched =
                    Dielectric::new(eta.at_d_line(), ggx, FacetScattering::Single).is_smooth();
                is_matched || roughness.may_be_smooth()
            }
            Self::ThinDielectric { .. } => true,
            Self::CoatedDiffuse(material) => material.may_be_specular(),
            Self::CoatedConductor(material) => material.may_be_specular(),
            Self::Principled(material) => material.may_be_specular(),
            Self::Mix(mixture) => mixture.may_be_specular(),
            Self::Perturbed(perturbed) => perturbed.material.may_be_specular(),
        }
    }
}

/// Returns true if slopes from `least` on may be those of a smooth surface, or if `least` is NaN.
fn is_smooth(least: f32) -> bool {
    least.is_nan() || least < SMOOTH_ALPHA
}

impl Roughness {
    pub(super) fn may_be_smooth(&self) -> bool {
        let least = self.u.range().least.max(self.v.range().least).max(0.0);
        is_smooth(match self.mapping {
            RoughnessMapping::SquareRoot => least.sqrt(),
            RoughnessMapping::Identity => least,
        })
    }
}

impl CoatSettings {
    /// Returns true if the interface may be a mirror; with η = 1 it is none.
    fn may_mirror(&self) -> bool {
        (self.eta - 1.0).abs() > 0.0 && self.roughness.may_be_smooth()
    }
}

impl CoatedDiffuseMaterial {
    fn may_be_specular(&self) -> bool {
        self.coat.may_mirror()
    }
}

impl CoatedConductorMaterial {
    /// Returns true if the interface may be a mirror, or the metal under a smooth interface: a rough interface
    /// scatters what smooth metal mirrors.
    fn may_be_specular(&self) -> bool {
        let are_smooth = || self.coat.roughness.may_be_smooth() && self.roughness.may_be_smooth();
        self.coat.may_mirror() || are_smooth()
    }
}

impl ScaledFloat {
    /// Returns the bounds of the product, clamped to 0 to 1.
    fn shares(&self) -> Range {
        let texels = self
            .texture
            .as_ref()
            .map_or(Range::of(1.0), FloatTexture::range);
        let product = texels.times(Range::of(self.factor));
        product.map(|value| value.clamp(0.0, 1.0))
    }

    fn may_be_positive(&self) -> bool {
        self.shares().most > 0.0
    }
}

impl PrincipledMaterial {
    fn may_be_specular(&self) -> bool {
        let has_facets = [&self.metallic, &self.specular, &self.transmission];
        let is_mirror = || has_facets.into_iter().any(ScaledFloat::may_be_positive);
        self.has_smooth_coat() || self.has_smooth_facets() && is_mirror()
    }

    fn has_smooth_coat(&self) -> bool {
        self.coat.may_be_positive() && is_smooth(sqr(self.coat_roughness.shares().least))
    }

    /// Returns true if facets may be smooth along the grain, where they are roughest.
    fn has_smooth_facets(&self) -> bool {
        let across = sqr(self.roughness.shares().least);
        let strength = match self.anisotropy.texture {
            None => self.anisotropy.strength,
            Some(_) => 0.0,
        };
        is_smooth(across + (1.0 - across) * sqr(strength))
    }
}

impl Mixture {
    /// Returns true if a part that is chosen anywhere, however seldom, may be specular.
    fn may_be_specular(&self) -> bool {
        let Range { least, most } = self.amount.range();
        let is_part = [least < 1.0, most > 0.0];
        let mut parts = self.materials.iter().zip(is_part);
        parts.any(|(material, is_part)| is_part && material.may_be_specular())
    }
}

#[cfg(test)]
mod tests;

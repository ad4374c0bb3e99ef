//! The scattering of light at a surface point.
//!
//! A [`Bsdf`] is the material at one point with its textures looked up: a small `Copy` value. It
//! works in the local shading frame: z is the shading normal `n_s`, and both `wo` and `wi` point away
//! from the surface. `wo` is the known direction, `wi` the sampled one; [`TransportMode`] decides
//! which of them the light comes from.
//!
//! - `sample(wo)` draws `wi`, and returns `weight = f·|cosθ_i| / density`.
//! - `eval(wo, wi)` returns a [`BsdfValue`]: f, without the cosine, and the densities of `sample` in both directions,
//!   which have most terms in common. Zero for Dirac distributions.
//!
//! Both describe the same distribution; the batteries in `bsdf/tests` prove it for every
//! value of [`Bsdf::examples`].
//!
//! **Dirac distributions.** A smooth interface scatters into one direction, so its density has a
//! Dirac factor. Two walks through it in opposite directions see Dirac factors that differ by the
//! Jacobian of refraction: η_i² cosθ_i dω_i = η_t² cosθ_t dω_t. [`BsdfSample::pdf`] is therefore the
//! coefficient of the Dirac factor in the measure common to both, `probability · η² · |cosθ|` with
//! the η and θ of the sampled side. Ratios of the two are then the true ratios of densities, which is
//! all that multiple importance sampling needs.
//!
//! **Mixed lobes.** A smooth coat reflects by a Dirac lobe, and its base does not. `eval` is the sum of the other
//! lobes; its densities include the probability of drawing them. Each sample has a mark of its kind. Almost no path
//! that one kind makes can be made by the other, so that on every path the vertex is of one kind
//! (docs/derivations/mis-weights.md).
//!
//! **Adding one**: a file with the model and its tests, a variant here with an arm in each match (the
//! compiler lists them), and a constructor in [`material`](crate::material).

pub mod coat;
mod coated_conductor;
mod coated_diffuse;
mod conductor;
mod dielectric;
mod diffuse;
mod diffuse_transmission;
pub mod fresnel;
pub mod microfacet;
mod multiple;
mod principled;
#[cfg(test)]
mod tests;
mod thin_dielectric;

pub use coated_conductor::{CoatedConductor, CoatedMetal};
pub use coated_diffuse::{CoatedDiffuse, InterlayerMedium};
pub use conductor::Conductor;
pub use dielectric::Dielectric;
pub use diffuse::Diffuse;
pub use diffuse_transmission::DiffuseTransmission;
pub use multiple::FacetScattering;
pub use principled::{Layer, Principled, PrincipledCoat, PrincipledParameters, Thickness};
pub use thin_dielectric::ThinDielectric;

use crate::math::{Vec2, Vec3};
use crate::spectrum::Spectrum;

/// The quantity that a walk carries, which determines the side of the light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TransportMode {
    /// The walk comes from the camera: `wi` points to where light comes from.
    Radiance,
    /// The walk comes from a light: `wo` points to where light comes from.
    Importance,
}

impl TransportMode {
    /// Returns the other mode: that of a walk through the same vertex in the opposite direction.
    #[inline]
    #[must_use]
    pub fn reversed(self) -> Self {
        match self {
            Self::Radiance => Self::Importance,
            Self::Importance => Self::Radiance,
        }
    }
}

/// The scattering between two directions, without Dirac lobes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfValue {
    /// f, which is symmetric except for η². Unit: 1/sr.
    pub f: Spectrum,
    /// The density with which `sample(wo)` draws `wi`; it integrates to the probability of all lobes that are not Dirac.
    /// Measure: solid angle, 1/sr.
    pub pdf: f32,
    /// The density with which `sample(wi)` draws `wo`.
    pub pdf_reverse: f32,
    /// The largest lane of `albedo(wi)`; 0 in [`Self::NONE`].
    pub albedo_reverse: f32,
}

impl BsdfValue {
    /// Nothing is scattered.
    pub const NONE: Self = Self {
        f: Spectrum::ZERO,
        pdf: 0.0,
        pdf_reverse: 0.0,
        albedo_reverse: 0.0,
    };
}

/// A direction drawn by `Bsdf::sample`.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    /// The sampled direction. Space: local.
    pub wi: Vec3,
    /// f·|cosθ_i| / density: the factor of throughput.
    pub weight: Spectrum,
    /// The density of `wi`. Measure: solid angle, 1/sr; for a Dirac distribution the coefficient
    /// `probability · η² · |cosθ_i|` of the module's page.
    pub pdf: f32,
    /// The coefficient or density of drawing `wo` by a walk that arrives along `wi`.
    pub pdf_reverse: f32,
    /// The largest lane of the albedo for that walk.
    pub albedo_reverse: f32,
    /// True if a Dirac lobe was drawn: on this path no strategy may connect at this vertex.
    pub is_delta: bool,
}

impl BsdfSample {
    /// Makes the sample of the mirrored direction, drawn with probability `prob` from a Dirac lobe of `reflectance`.
    /// `prob` and `albedo` are the same for `wo` and the mirrored direction.
    #[inline]
    fn mirror(wo: Vec3, reflectance: Spectrum, prob: f32, albedo: Spectrum) -> Self {
        let pdf = prob * wo.z.abs();
        Self {
            wi: Vec3::new(-wo.x, -wo.y, wo.z),
            weight: reflectance / prob,
            pdf,
            pdf_reverse: pdf,
            albedo_reverse: albedo.max_lane(),
            is_delta: true,
        }
    }

    /// Makes the sample `wi` drawn for `wo`; `value` is the scattering between them. None: its density underflows.
    #[inline]
    fn of_value(wi: Vec3, value: &BsdfValue) -> Option<Self> {
        (value.pdf > 0.0 && wi.z != 0.0).then(|| Self {
            wi,
            weight: value.f * (wi.z.abs() / value.pdf),
            pdf: value.pdf,
            pdf_reverse: value.pdf_reverse,
            albedo_reverse: value.albedo_reverse,
            is_delta: false,
        })
    }
}

/// The kinds of lobes of a surface, which determine the normals that may be seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lobes {
    /// Diffuse lobes, under facets of this gloss: 1 for a mirror, 0 for the roughest, and 0 without facets.
    Diffuse(f32),
    /// Only facets, which scatter around mirrored or refracted directions.
    Glossy,
}

/// The scattering of one surface point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bsdf {
    /// Lambertian reflection.
    Diffuse(Diffuse),
    /// A metal, smooth or rough.
    Conductor(Conductor),
    /// An interface between two transparent media, smooth or rough.
    Dielectric(Dielectric),
    /// A pane.
    ThinDielectric(ThinDielectric),
    /// Lambertian reflection and transmission.
    DiffuseTransmission(DiffuseTransmission),
    /// A dielectric layer over a diffuse base.
    CoatedDiffuse(CoatedDiffuse),
    /// A dielectric layer over metal.
    CoatedConductor(CoatedConductor),
    /// Metal, plastic, glass and cloth by the parameters of glTF.
    Principled(Principled),
}

impl Bsdf {
    /// Returns f, densities and albedo for two directions, without Dirac lobes. `mode` is that of a walk that knows
    /// `wo`.
    ///
    /// Paths call [`ScatteringEvent`](crate::path::ScatteringEvent) instead, which corrects for shading normals.
    #[inline]
    pub fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> BsdfValue {
        match self {
            Self::Diffuse(bsdf) => bsdf.eval(wo, wi),
            Self::Conductor(bsdf) => bsdf.eval(wo, wi),
            Self::Dielectric(bsdf) => bsdf.eval(wo, wi, mode),
            Self::ThinDielectric(_) => BsdfValue::NONE,
            Self::DiffuseTransmission(bsdf) => bsdf.eval(wo, wi),
            Self::CoatedDiffuse(bsdf) => bsdf.eval(wo, wi),
            Self::CoatedConductor(bsdf) => bsdf.eval(wo, wi),
            Self::Principled(bsdf) => bsdf.eval(wo, wi, mode),
        }
    }

    /// Draws a direction by `u`, and by `u_lobe`, which is called only if there is a choice of lobes.
    ///
    /// None: nothing is scattered, or the draw is below the surface.
    #[inline]
    pub(crate) fn sample(
        &self,
        wo: Vec3,
        mode: TransportMode,
        u_lobe: impl FnOnce() -> f32,
        u: Vec2,
    ) -> Option<BsdfSample> {
        let sample = match self {
            Self::Diffuse(bsdf) => bsdf.sample(wo, u),
            Self::Conductor(bsdf) => bsdf.sample(wo, u_lobe, u),
            Self::Dielectric(bsdf) => bsdf.sample(wo, mode, u_lobe(), u),
            Self::ThinDielectric(bsdf) => bsdf.sample(wo, u_lobe()),
            Self::DiffuseTransmission(bsdf) => bsdf.sample(wo, u_lobe(), u),
            Self::CoatedDiffuse(bsdf) => bsdf.sample(wo, u_lobe(), u),
            Self::CoatedConductor(bsdf) => bsdf.sample(wo, u_lobe(), u),
            Self::Principled(bsdf) => bsdf.sample(wo, mode, u_lobe(), u),
        };
        // If the density underflows, there is no sample.
        sample.filter(|sample| sample.pdf > 0.0)
    }

    /// Sets the index of refraction around the surface, in place of air. It matters only to a transparent part.
    #[inline]
    pub fn put_within(&mut self, index: f32) {
        if index.to_bits() == 1f32.to_bits() {
            return;
        }
        match self {
            Self::Dielectric(bsdf) => *bsdf = bsdf.within(index),
            Self::Principled(bsdf) => *bsdf = bsdf.within(index),
            Self::Diffuse(_)
            | Self::Conductor(_)
            | Self::ThinDielectric(_)
            | Self::DiffuseTransmission(_)
            | Self::CoatedDiffuse(_)
            | Self::CoatedConductor(_) => {}
        }
    }

    /// Returns true if all scattering is a Dirac distribution.
    #[inline]
    pub fn is_delta(&self) -> bool {
        match self {
            Self::Diffuse(_) | Self::DiffuseTransmission(_) => false,
            Self::Conductor(bsdf) => bsdf.is_smooth(),
            Self::Dielectric(bsdf) => bsdf.is_smooth(),
            Self::ThinDielectric(_) => true,
            Self::CoatedDiffuse(bsdf) => bsdf.is_delta(),
            Self::CoatedConductor(bsdf) => bsdf.is_delta(),
            Self::Principled(bsdf) => bsdf.is_delta(),
        }
    }

    /// Returns the kinds of its lobes, without a coat that has a normal of its own.
    pub fn lobes(&self) -> Lobes {
        match self {
            Self::Diffuse(_) | Self::DiffuseTransmission(_) => Lobes::Diffuse(0.0),
            Self::CoatedDiffuse(bsdf) => Lobes::Diffuse(bsdf.gloss()),
            Self::Conductor(_)
            | Self::Dielectric(_)
            | Self::ThinDielectric(_)
            | Self::CoatedConductor(_) => Lobes::Glossy,
            Self::Principled(bsdf) => bsdf.lobes(),
        }
    }

    /// Returns the normal of a clear coat in the local frame. None: the layers of the surface have one frame.
    #[inline]
    pub fn coat_normal(&self) -> Option<Vec3> {
        match self {
            Self::Principled(bsdf) => bsdf.coat_normal(),
            _ => None,
        }
    }

    /// Sets the normal `n` of the clear coat, if there is one. Space: local.
    #[inline]
    pub fn put_coat_normal(&mut self, n: Vec3) {
        if let Self::Principled(bsdf) = self {
            bsdf.put_coat_normal(n);
        }
    }

    /// Returns false if all light stays on its side.
    #[inline]
    pub fn transmits(&self) -> bool {
        match self {
            Self::Diffuse(_)
            | Self::Conductor(_)
            | Self::CoatedDiffuse(_)
            | Self::CoatedConductor(_) => false,
            Self::Dielectric(_) | Self::ThinDielectric(_) | Self::DiffuseTransmission(_) => true,
            Self::Principled(bsdf) => bsdf.transmits(),
        }
    }

    /// Returns the approximate fraction of light along `wo` that is scattered, for path roulette. It is a function of
    /// `self` and `wo`, positive if anything is scattered, but not an exact integral. Range: `[0, 1]` per lane.
    #[inline(always)] // Most surfaces are diffuse, which is one load.
    pub fn albedo(&self, wo: Vec3) -> Spectrum {
        match self {
            Self::Diffuse(bsdf) => bsdf.reflectance,
            Self::Conductor(bsdf) => bsdf.albedo(wo),
            Self::Dielectric(_) | Self::ThinDielectric(_) => Spectrum::ONE,
            Self::DiffuseTransmission(bsdf) => bsdf.albedo(),
            Self::CoatedDiffuse(bsdf) => bsdf.albedo(wo),
            Self::CoatedConductor(bsdf) => bsdf.albedo(wo),
            Self::Principled(bsdf) => bsdf.albedo(wo),
        }
    }

    /// Returns the values that every test battery runs over.
    pub fn examples() -> Vec<(&'static str, Self)> {
        let mut examples = Vec::new();
        examples.extend(Diffuse::examples().map(|(name, bsdf)| (name, Self::Diffuse(bsdf))));
        examples.extend(Conductor::examples().map(|(name, bsdf)| (name, Self::Conductor(bsdf))));
        examples.extend(Dielectric::examples().map(|(name, bsdf)| (name, Self::Dielectric(bsdf))));
        let thin = ThinDielectric::examples();
        examples.extend(thin.map(|(name, bsdf)| (name, Self::ThinDielectric(bsdf))));
        let leaves = DiffuseTransmission::examples();
        examples.extend(leaves.map(|(name, bsdf)| (name, Self::DiffuseTransmission(bsdf))));
        let varnish = CoatedDiffuse::examples();
        examples.extend(varnish.map(|(name, bsdf)| (name, Self::CoatedDiffuse(bsdf))));
        let lacquer = CoatedConductor::examples();
        examples.extend(lacquer.map(|(name, bsdf)| (name, Self::CoatedConductor(bsdf))));
        let principled = Principled::examples();
        examples.extend(principled.map(|(name, bsdf)| (name, Self::Principled(bsdf))));
        examples
    }
}

/// Returns true where two local directions lie on the same side of the surface.
#[inline]
pub(crate) fn same_hemisphere(a: Vec3, b: Vec3) -> bool {
    a.z * b.z > 0.0
}

//! How a surface point scatters light.
//!
//! A [`Bsdf`] is the material at one point with its textures looked up: a small `Copy` value. It
//! works in the local shading frame: z is the shading normal `n_s`, and both `wo` and `wi` point away
//! from the surface. `wo` is the known direction, `wi` the sampled one; which of them the light
//! comes from is told by [`TransportMode`].
//!
//! - `eval(wo, wi)` is f, without the cosine. Unit: 1/sr. Zero for Dirac distributions.
//! - `sample(wo)` draws `wi`, and returns `weight = f·|cosθ_i| / density`.
//! - `pdf(wo, wi)` is the density of `sample`. Measure: solid angle, 1/sr. Zero for Dirac
//!   distributions.
//!
//! The three describe the same distribution; the batteries in `bsdf/tests` prove it for every
//! value of [`Bsdf::examples`].
//!
//! **Dirac distributions.** A smooth interface scatters into one direction, so its density has a
//! Dirac factor. Two walks through it in opposite directions see Dirac factors that differ by the
//! Jacobian of refraction: η_i² cosθ_i dω_i = η_t² cosθ_t dω_t. [`BsdfSample::pdf`] is therefore the
//! coefficient of the Dirac factor in the measure common to both, `probability · η² · |cosθ|` with
//! the η and θ of the sampled side. Ratios of the two are then the true ratios of densities, which is
//! all that multiple importance sampling needs.
//!
//! **Adding one**: a file with the model and its tests, a variant here with an arm in each match (the
//! compiler lists them), and a constructor in [`material`](crate::material).

mod conductor;
mod dielectric;
mod diffuse;
pub mod fresnel;
pub mod microfacet;
#[cfg(test)]
mod tests;

pub use conductor::Conductor;
pub use dielectric::Dielectric;
pub use diffuse::Diffuse;

use crate::math::{Vec2, Vec3};
use crate::spectrum::Spectrum;

/// Which quantity flows along a walk, and so on which side the light is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TransportMode {
    /// The walk comes from the camera: `wi` points to where light comes from.
    Radiance,
    /// The walk comes from a light: `wo` points to where light comes from.
    Importance,
}

impl TransportMode {
    /// The other mode: that of a walk through the same vertex in the opposite direction.
    #[inline]
    #[must_use]
    pub fn reversed(self) -> Self {
        match self {
            Self::Radiance => Self::Importance,
            Self::Importance => Self::Radiance,
        }
    }
}

/// A direction drawn by `Bsdf::sample`.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    /// The sampled direction. Space: local.
    pub wi: Vec3,
    /// f·|cosθ_i| / density: what throughput is multiplied by.
    pub weight: Spectrum,
    /// The density of `wi`. Measure: solid angle, 1/sr; for a Dirac distribution the coefficient
    /// `probability · η² · |cosθ_i|` of the module's page.
    pub pdf: f32,
    /// The coefficient or density of drawing `wo` by a walk that arrives along `wi`.
    pub pdf_reverse: f32,
    /// True where the scattering is a Dirac distribution: no strategy may connect at this vertex.
    pub is_delta: bool,
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
}

impl Bsdf {
    /// f for light that goes from one direction to the other. Unit: 1/sr. Zero for a Dirac
    /// distribution.
    ///
    /// Only [`Vertex::scatter`](crate::path::Vertex::scatter) calls this.
    #[inline]
    pub(crate) fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> Spectrum {
        match self {
            Self::Diffuse(bsdf) => bsdf.eval(wo, wi),
            Self::Conductor(bsdf) => bsdf.eval(wo, wi),
            Self::Dielectric(bsdf) => bsdf.eval(wo, wi, mode),
        }
    }

    /// Draws a direction from `u`, and from `u_lobe` where there is a choice between lobes.
    ///
    /// None: where nothing is scattered, or the draw fell below the surface.
    #[inline]
    pub(crate) fn sample(
        &self,
        wo: Vec3,
        mode: TransportMode,
        u_lobe: f32,
        u: Vec2,
    ) -> Option<BsdfSample> {
        let sample = match self {
            Self::Diffuse(bsdf) => bsdf.sample(wo, u),
            Self::Conductor(bsdf) => bsdf.sample(wo, u),
            Self::Dielectric(bsdf) => bsdf.sample(wo, mode, u_lobe, u),
        };
        // Where the density underflows there is no sample.
        sample.filter(|sample| sample.pdf > 0.0)
    }

    /// The density of `sample` at `wi`. Measure: solid angle, 1/sr.
    #[inline]
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        match self {
            Self::Diffuse(_) => Diffuse::pdf(wo, wi),
            Self::Conductor(bsdf) => bsdf.pdf(wo, wi),
            Self::Dielectric(bsdf) => bsdf.pdf(wo, wi),
        }
    }

    /// True where all scattering is a Dirac distribution.
    #[inline]
    pub fn is_delta(&self) -> bool {
        match self {
            Self::Diffuse(_) => false,
            Self::Conductor(bsdf) => bsdf.is_smooth(),
            Self::Dielectric(bsdf) => bsdf.is_smooth(),
        }
    }

    /// About which part of the light that arrives along `wo` is scattered: what path roulette
    /// goes by. Deterministic in (`self`, `wo`), and positive where anything is scattered, but no
    /// exact integral. Range: `[0, 1]` per lane.
    #[inline]
    pub fn albedo(&self, wo: Vec3) -> Spectrum {
        match self {
            Self::Diffuse(bsdf) => bsdf.reflectance,
            Self::Conductor(bsdf) => bsdf.albedo(wo),
            Self::Dielectric(_) => Spectrum::ONE,
        }
    }

    /// The values that every test battery runs over.
    pub fn examples() -> Vec<(&'static str, Self)> {
        let mut examples = Vec::new();
        examples.extend(Diffuse::examples().map(|(name, bsdf)| (name, Self::Diffuse(bsdf))));
        examples.extend(Conductor::examples().map(|(name, bsdf)| (name, Self::Conductor(bsdf))));
        examples.extend(Dielectric::examples().map(|(name, bsdf)| (name, Self::Dielectric(bsdf))));
        examples
    }
}

/// True where two local directions lie on the same side of the surface.
#[inline]
pub(crate) fn same_hemisphere(a: Vec3, b: Vec3) -> bool {
    a.z * b.z > 0.0
}

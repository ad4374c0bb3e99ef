//! What a surface is made of: textures that become a [`Bsdf`] at a point.
//!
//! **Adding one**: a variant here that builds the [`Bsdf`], and a mapping in the scene reader.

use crate::bsdf::microfacet::Ggx;
use crate::bsdf::{Bsdf, Conductor, Dielectric, Diffuse};
use crate::math::Vec2;
use crate::spectrum::{ColorModel, Rgb, Spectrum, Wavelengths};
use crate::texture::{ColorTexture, FloatTexture};

/// How a described roughness becomes a slope α.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RoughnessMapping {
    /// α = √roughness: steps of roughness look even.
    SquareRoot,
    /// α = roughness.
    Identity,
}

/// Roughness along the two tangents of a surface.
#[derive(Clone, Debug)]
pub struct Roughness {
    /// Along ∂p/∂u.
    pub u: FloatTexture,
    /// Across it.
    pub v: FloatTexture,
    /// How the textures' values become slopes.
    pub mapping: RoughnessMapping,
}

impl Roughness {
    /// A perfectly smooth surface.
    pub const SMOOTH: Self = Self {
        u: FloatTexture::Constant(0.0),
        v: FloatTexture::Constant(0.0),
        mapping: RoughnessMapping::Identity,
    };

    #[inline]
    fn ggx(&self, uv: Vec2) -> Ggx {
        let [x, y] = [&self.u, &self.v].map(|texture| {
            let roughness = texture.eval(uv).max(0.0);
            match self.mapping {
                RoughnessMapping::SquareRoot => roughness.sqrt(),
                RoughnessMapping::Identity => roughness,
            }
        });
        Ggx::new(x, y)
    }
}

/// The index of refraction of a metal.
#[derive(Clone, Debug)]
pub enum ConductorIndex {
    /// As measured: real and imaginary part.
    Complex {
        /// Real part.
        eta: ColorTexture,
        /// Imaginary part.
        k: ColorTexture,
    },
    /// The index that reflects this colour at normal incidence: η = 1, k = 2√r / √(1-r).
    Reflectance(ColorTexture),
}

/// The material of a shape.
#[derive(Clone, Debug)]
pub enum Material {
    /// Lambertian reflection.
    Diffuse {
        /// The albedo.
        reflectance: ColorTexture,
    },
    /// A metal.
    Conductor {
        /// Its index of refraction.
        index: ConductorIndex,
        /// Its roughness.
        roughness: Roughness,
    },
    /// A transparent medium's surface.
    Dielectric {
        /// Index of refraction inside divided by that outside.
        eta: f32,
        /// Its roughness.
        roughness: Roughness,
    },
}

impl Material {
    /// The name of its kind, in one word.
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::Diffuse { .. } => "diffuse",
            Self::Conductor { .. } => "conductor",
            Self::Dielectric { .. } => "dielectric",
        }
    }

    /// The scattering at `uv`.
    #[inline]
    pub fn bsdf(&self, uv: Vec2, color: ColorModel, wavelengths: &Wavelengths) -> Bsdf {
        let albedo = |texture: &ColorTexture| color.albedo(unit(texture.eval(uv)), wavelengths);
        let unbounded = |rgb: Rgb| color.unbounded(rgb, wavelengths);
        match self {
            Self::Diffuse { reflectance } => Bsdf::Diffuse(Diffuse {
                reflectance: albedo(reflectance),
            }),
            Self::Conductor { index, roughness } => {
                let (eta, k) = match index {
                    ConductorIndex::Complex { eta, k } => {
                        (unbounded(eta.eval(uv)), unbounded(k.eval(uv)))
                    }
                    ConductorIndex::Reflectance(r) => {
                        let k = unit(r.eval(uv)).map(absorption_of_reflectance);
                        (Spectrum::ONE, unbounded(k))
                    }
                };
                Bsdf::Conductor(Conductor {
                    eta,
                    k,
                    ggx: roughness.ggx(uv),
                })
            }
            Self::Dielectric { eta, roughness } => Bsdf::Dielectric(Dielectric {
                eta: *eta,
                ggx: roughness.ggx(uv),
            }),
        }
    }
}

/// A reflectance between 0 and 1; NaN stays NaN, to be found and counted where light carries it.
#[inline]
fn unit(rgb: Rgb) -> Rgb {
    rgb.map(|channel| channel.clamp(0.0, 1.0))
}

/// The k that reflects `r` at normal incidence where η = 1.
#[inline]
fn absorption_of_reflectance(r: f32) -> f32 {
    let r = r.min(0.9999);
    2.0 * r.sqrt() / (1.0 - r).sqrt()
}

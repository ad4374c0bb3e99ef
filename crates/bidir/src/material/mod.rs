//! Materials of surfaces: textures that become a [`Bsdf`] at a point.
//!
//! A mixture is one of its materials at each vertex, chosen by a random number of the path. The choice is part of the
//! path, and equally likely for walks from both ends, so that it cancels in densities.
//!
//! **Adding one**: a variant here that builds the [`Bsdf`], and a mapping in the scene reader.

mod coated;
mod principled;
mod relief;
mod specular;

pub use coated::{CLEAR, CoatSettings, CoatedConductorMaterial, CoatedDiffuseMaterial};
pub use principled::{Anisotropy, PrincipledMaterial, ScaledColor, ScaledFloat};
pub use relief::{Bitangent, NormalMap, Perturbed, Relief};

use crate::bsdf::microfacet::Ggx;
use crate::bsdf::{
    Bsdf, Conductor, Dielectric, Diffuse, DiffuseTransmission, FacetScattering, ThinDielectric,
};
use crate::math::{ONE_MINUS_EPSILON, Vec3};
use crate::shape::SurfacePoint;
use crate::spectrum::{Lanes, Metal, RefractiveIndex, Rgb, Spectrum};
use crate::texture::{ColorTexture, FloatTexture, RequiredInputs, TexturePoint};
use std::sync::Arc;

/// The map from a given roughness to a slope α.
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
    /// The map from the values of the textures to slopes.
    pub mapping: RoughnessMapping,
}

impl Roughness {
    /// A perfectly smooth surface.
    pub const SMOOTH: Self = Self {
        u: FloatTexture::Constant(0.0),
        v: FloatTexture::Constant(0.0),
        mapping: RoughnessMapping::Identity,
    };

    fn needs(&self) -> RequiredInputs {
        self.u.needs().and(self.v.needs())
    }

    #[inline]
    fn ggx(&self, at: &TexturePoint) -> Ggx {
        let [x, y] = [&self.u, &self.v].map(|texture| {
            let roughness = texture.eval(at).max(0.0);
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
    /// That of a known metal.
    Measured(Arc<Metal>),
    /// The real and the imaginary part, for each channel of linear Rec. 709.
    Complex {
        /// Real part.
        eta: ColorTexture,
        /// Imaginary part.
        k: ColorTexture,
    },
    /// The index that reflects this colour at normal incidence: η = 1, k = 2√r / √(1-r).
    Reflectance(ColorTexture),
}

impl ConductorIndex {
    fn needs(&self) -> RequiredInputs {
        match self {
            Self::Measured(_) => RequiredInputs::NOTHING,
            Self::Complex { eta, k } => eta.needs().and(k.needs()),
            Self::Reflectance(reflectance) => reflectance.needs(),
        }
    }

    /// Returns the real and the imaginary part.
    #[inline]
    fn eval(&self, at: &TexturePoint, lanes: Lanes) -> [Spectrum; 2] {
        match self {
            Self::Measured(metal) => lanes.metal(metal),
            Self::Complex { eta, k } => [eta, k].map(|part| lanes.unbounded(part.eval(at))),
            Self::Reflectance(r) => {
                let k = unit(r.eval(at)).map(absorption_of_reflectance);
                [Spectrum::ONE, lanes.unbounded(k)]
            }
        }
    }
}

/// One of two materials at each point.
#[derive(Clone, Debug)]
pub struct Mixture {
    /// The materials.
    pub materials: [Material; 2],
    /// The probability of the second.
    pub amount: FloatTexture,
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
        /// The number of facets that may scatter light.
        scattering: FacetScattering,
    },
    /// A transparent medium's surface.
    Dielectric {
        /// Index of refraction inside divided by that outside.
        eta: RefractiveIndex,
        /// Its roughness.
        roughness: Roughness,
        /// The number of facets that may scatter light.
        scattering: FacetScattering,
    },
    /// A pane.
    ThinDielectric {
        /// Index of refraction of the pane divided by that around it.
        eta: RefractiveIndex,
    },
    /// Lambertian reflection and transmission.
    DiffuseTransmission {
        /// The part that is reflected.
        reflectance: ColorTexture,
        /// The part that goes through.
        transmittance: ColorTexture,
        /// The factor of both.
        scale: f32,
    },
    /// A dielectric layer over a diffuse base.
    CoatedDiffuse(CoatedDiffuseMaterial),
    /// A dielectric layer over metal.
    CoatedConductor(CoatedConductorMaterial),
    /// Metal, plastic, glass and cloth by the parameters of glTF.
    Principled(Arc<PrincipledMaterial>),
    /// One of two materials at each point.
    Mix(Arc<Mixture>),
    /// A material whose shading frame turns.
    Perturbed(Arc<Perturbed>),
}

impl Material {
    /// Returns the name of its kind, in one word.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Diffuse { .. } => "diffuse",
            Self::Conductor { .. } => "conductor",
            Self::Dielectric { .. } => "dielectric",
            Self::ThinDielectric { .. } => "thindielectric",
            Self::DiffuseTransmission { .. } => "diffusetransmission",
            Self::CoatedDiffuse(_) => "coateddiffuse",
            Self::CoatedConductor(_) => "coatedconductor",
            Self::Principled(_) => "principled",
            Self::Mix(_) => "mix",
            Self::Perturbed(perturbed) => perturbed.material.kind(),
        }
    }

    /// Returns the relief that turns the shading frame. None: there is none, or the material is a mixture, whose
    /// parts have their own.
    #[inline]
    pub fn relief(&self) -> Option<&Relief> {
        match self {
            Self::Perturbed(perturbed) => Some(&perturbed.relief),
            _ => None,
        }
    }

    /// Returns the unit normal of a clear coat at a point. None: there is no coat.
    #[inline]
    pub fn coat_normal(&self, surface: &SurfacePoint, at: &TexturePoint) -> Option<Vec3> {
        match self {
            Self::Principled(material) => material.coat_normal(surface, at),
            Self::Perturbed(perturbed) => perturbed.material.coat_normal(surface, at),
            _ => None,
        }
    }

    /// Returns the material of a mixture that the number `u` chooses at a point; any other material itself.
    #[inline]
    pub fn choose(&self, at: &TexturePoint, u: impl FnOnce() -> f32) -> &Self {
        match self {
            Self::Mix(mixture) => mixture.choose(at, u()),
            material => material,
        }
    }

    /// Returns the inputs, besides the parameters, that its textures and its relief need.
    pub fn needs(&self) -> RequiredInputs {
        match self {
            Self::Diffuse { reflectance } => reflectance.needs(),
            Self::Conductor {
                index, roughness, ..
            } => index.needs().and(roughness.needs()),
            Self::Dielectric { roughness, .. } => roughness.needs(),
            Self::ThinDielectric { .. } => RequiredInputs::NOTHING,
            Self::DiffuseTransmission {
                reflectance,
                transmittance,
                ..
            } => reflectance.needs().and(transmittance.needs()),
            Self::CoatedDiffuse(material) => material.needs(),
            Self::CoatedConductor(material) => material.needs(),
            Self::Principled(material) => material.needs(),
            Self::Mix(mixture) => {
                let [first, second] = &mixture.materials;
                let parts = first.needs().and(second.needs());
                parts.and(mixture.amount.needs())
            }
            // Relief needs tangents, and the width of a pixel as the distance between compared heights.
            Self::Perturbed(_) => RequiredInputs::ALL,
        }
    }

    /// Returns the scattering at a point; for a mixture, of its first material: call [`choose`](Self::choose) first.
    #[inline]
    pub fn bsdf(&self, at: &TexturePoint, lanes: Lanes) -> Bsdf {
        let albedo = |texture: &ColorTexture| lanes.albedo(unit(texture.eval(at)));
        match self {
            Self::Diffuse { reflectance } => Bsdf::Diffuse(Diffuse {
                reflectance: albedo(reflectance),
            }),
            Self::Conductor {
                index,
                roughness,
                scattering,
            } => {
                let [eta, k] = index.eval(at, lanes);
                Bsdf::Conductor(Conductor::new(eta, k, roughness.ggx(at), *scattering))
            }
            Self::Dielectric {
                eta,
                roughness,
                scattering,
            } => Bsdf::Dielectric(Dielectric::new(
                lanes.index(eta),
                roughness.ggx(at),
                *scattering,
            )),
            Self::ThinDielectric { eta } => Bsdf::ThinDielectric(ThinDielectric {
                eta: lanes.index(eta),
            }),
            Self::DiffuseTransmission {
                reflectance,
                transmittance,
                scale,
            } => {
                let part = |texture: &ColorTexture| {
                    let scaled = texture.eval(at).map(|channel| channel * scale);
                    lanes.albedo(unit(scaled))
                };
                Bsdf::DiffuseTransmission(DiffuseTransmission {
                    reflectance: part(reflectance),
                    transmittance: part(transmittance),
                })
            }
            Self::CoatedDiffuse(material) => material.bsdf(at, lanes),
            Self::CoatedConductor(material) => material.bsdf(at, lanes),
            Self::Principled(material) => material.bsdf(at, lanes),
            Self::Mix(mixture) => mixture.materials[0].bsdf(at, lanes),
            Self::Perturbed(perturbed) => perturbed.material.bsdf(at, lanes),
        }
    }
}

impl Mixture {
    /// Returns the material that `u` chooses. It rescales `u` for the choice in a nested mixture.
    fn choose(&self, at: &TexturePoint, u: f32) -> &Material {
        let amount = self.amount.eval(at).clamp(0.0, 1.0);
        let [first, second] = &self.materials;
        // If the amount is NaN, the first material is chosen.
        let (material, rest) = if u < amount {
            (second, u / amount)
        } else {
            (first, (u - amount) / (1.0 - amount))
        };
        material.choose(at, || rest.clamp(0.0, ONE_MINUS_EPSILON))
    }
}

/// Clamps a reflectance to 0 to 1; NaN stays NaN, to be found and counted where light carries it.
#[inline]
fn unit(rgb: Rgb) -> Rgb {
    rgb.map(|channel| channel.clamp(0.0, 1.0))
}

/// Returns the k that reflects `r` at normal incidence if η = 1.
#[inline]
fn absorption_of_reflectance(r: f32) -> f32 {
    let r = r.min(0.9999);
    2.0 * r.sqrt() / (1.0 - r).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::TransportMode;
    use crate::spectrum::permuted::Order as LaneOrder;
    use crate::spectrum::{Beyond, Curve};
    use crate::testing::prelude::*;

    fn line(low: f64, high: f64) -> Curve {
        Curve::from_pairs(&[300.0, low, 900.0, high], Beyond::Last).unwrap()
    }

    /// Returns the part of light that a smooth material reflects at normal incidence.
    fn reflected(material: &Material, lanes: Lanes) -> Spectrum {
        let bsdf = material.bsdf(&TexturePoint::of_parameters(Vec2::ZERO), lanes);
        let sample = bsdf.sample(Vec3::Z, TransportMode::Radiance, || 0.0, Vec2::ZERO);
        let drawn = sample.expect("a mirror reflects");
        assert!(drawn.wi.z > 0.0);
        // At this incidence the coefficient is the probability.
        drawn.weight * drawn.pdf
    }

    /// Metals and glasses scatter by their curves where lanes are wavelengths.
    #[test]
    fn surfaces_scatter_by_their_spectra() {
        let lanes = Lanes::Permuted(LaneOrder([2, 0, 3, 1]));
        let (eta, k) = (line(0.2, 2.0), line(4.0, 1.0));
        let metal = Material::Conductor {
            index: ConductorIndex::Measured(Metal::new(eta.clone(), k.clone()).into()),
            roughness: Roughness::SMOOTH,
            scattering: FacetScattering::Single,
        };
        let found = reflected(&metal, lanes);
        for (lane, nm) in [(0, 465.0), (1, 610.0), (3, 550.0)] {
            let (eta, k2) = (eta.at(nm), k.at(nm) * k.at(nm));
            let ratio = ((eta - 1.0) * (eta - 1.0) + k2) / ((eta + 1.0) * (eta + 1.0) + k2);
            check_near(found[lane], ratio as f32, 1e-5, "metal");
        }
        let glass = line(1.9, 1.3);
        let pane = Material::ThinDielectric {
            eta: RefractiveIndex::of_curve(glass.clone()),
        };
        for (lanes, nm) in [(lanes, 465.0), (Lanes::Rgb, 587.56)] {
            let eta = glass.at(nm);
            let once = (eta - 1.0) * (eta - 1.0) / ((eta + 1.0) * (eta + 1.0));
            let twice = 2.0 * once / (1.0 + once);
            check_near(reflected(&pane, lanes)[0], twice as f32, 1e-5, "pane");
        }
    }
}

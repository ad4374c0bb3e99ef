//! Coated materials: their textures, and what is integrated for their surfaces before rendering.
//!
//! The integrals depend on slopes. Where those are constant there is one of each; where they are
//! textures, some for slopes between 0 and 1, and what lies between is interpolated.

use super::{Roughness, unit};
use crate::bsdf::coat::{Layer, Reflections};
use crate::bsdf::{Bsdf, CoatedConductor, CoatedDiffuse, CoatedMetal, Filling};
use crate::math::{Vec2, sqr};
use crate::spectrum::{ColorModel, Wavelengths};
use crate::texture::{ColorTexture, FloatTexture, Needs, TexturePoint};
use std::sync::Arc;

/// A dielectric layer.
#[derive(Clone, Debug)]
pub struct CoatSettings {
    /// Index of refraction of the layer, divided by that outside. Positive.
    pub eta: f32,
    /// The roughness of its interface.
    pub roughness: Roughness,
    /// Its optical depth.
    pub thickness: FloatTexture,
    /// The part of the optical depth that scatters.
    pub albedo: ColorTexture,
    /// The mean cosine of the angle of scattering.
    pub g: FloatTexture,
}

impl CoatSettings {
    fn needs(&self) -> Needs {
        let filling = self.thickness.needs().and(self.g.needs());
        filling.and(self.albedo.needs()).and(self.roughness.needs())
    }

    fn filling(&self, at: &TexturePoint, color: ColorModel, wavelengths: &Wavelengths) -> Filling {
        Filling {
            thickness: self.thickness.eval(at).max(0.0),
            albedo: color.albedo(unit(self.albedo.eval(at)), wavelengths),
            g: self.g.eval(at).clamp(-1.0, 1.0),
        }
    }
}

/// Slopes that something was integrated for: increasing.
#[derive(Clone, Debug)]
struct Axis(Vec<f32>);

impl Axis {
    /// One slope where it is constant; else some from 0 to 1, closer where they are small.
    fn of(roughness: &Roughness) -> Self {
        let is_constant = |texture: &FloatTexture| matches!(texture, FloatTexture::Constant(_));
        if is_constant(&roughness.u) && is_constant(&roughness.v) {
            return Self(vec![
                roughness
                    .ggx(&TexturePoint::of_parameters(Vec2::ZERO))
                    .mean_alpha(),
            ]);
        }
        let steps = 8;
        Self((0..=steps).map(|i| sqr(i as f32 / steps as f32)).collect())
    }

    /// The indices of the slopes on both sides of `alpha`, and where it is between them.
    #[inline]
    fn locate(&self, alpha: f32) -> (usize, usize, f32) {
        let after = self.0.partition_point(|&node| node < alpha);
        let (low, high) = (after.saturating_sub(1), after.min(self.0.len() - 1));
        let width = self.0[high] - self.0[low];
        let t = if width > 0.0 {
            ((alpha - self.0[low]) / width).clamp(0.0, 1.0)
        } else {
            0.0
        };
        (low, high, t)
    }
}

/// Layers by slope.
#[derive(Clone, Debug)]
struct Layers {
    axis: Axis,
    layers: Arc<[Layer]>,
}

impl Layers {
    fn new(coat: &CoatSettings) -> Self {
        let axis = Axis::of(&coat.roughness);
        let layers = axis.0.iter().map(|&alpha| Layer::new(coat.eta, alpha));
        Self {
            layers: layers.collect(),
            axis,
        }
    }

    #[inline]
    fn at(&self, alpha: f32) -> Layer {
        let (low, high, t) = self.axis.locate(alpha);
        self.layers[low].lerp(&self.layers[high], t)
    }
}

/// A diffuse base under a layer.
#[derive(Clone, Debug)]
pub struct CoatedDiffuseMaterial {
    pub(super) coat: CoatSettings,
    reflectance: ColorTexture,
    layers: Layers,
}

impl CoatedDiffuseMaterial {
    /// A base of `reflectance`.
    pub fn new(coat: CoatSettings, reflectance: ColorTexture) -> Self {
        Self {
            layers: Layers::new(&coat),
            coat,
            reflectance,
        }
    }

    pub(super) fn needs(&self) -> Needs {
        self.coat.needs().and(self.reflectance.needs())
    }

    pub(super) fn bsdf(
        &self,
        at: &TexturePoint,
        color: ColorModel,
        wavelengths: &Wavelengths,
    ) -> Bsdf {
        let ggx = self.coat.roughness.ggx(at);
        let filling = self.coat.filling(at, color, wavelengths);
        let reflectance = color.albedo(unit(self.reflectance.eval(at)), wavelengths);
        let layer = self.layers.at(ggx.mean_alpha());
        Bsdf::CoatedDiffuse(CoatedDiffuse::new(&layer, ggx, &filling, reflectance))
    }
}

/// Metal under a layer.
#[derive(Clone, Debug)]
pub struct CoatedConductorMaterial {
    pub(super) coat: CoatSettings,
    index: super::ConductorIndex,
    pub(super) roughness: Roughness,
    layers: Layers,
    metal_axis: Axis,
    /// By slope of the interface, then of the metal.
    reflections: Arc<[Reflections]>,
}

impl CoatedConductorMaterial {
    /// Metal of `index` and `roughness`.
    pub fn new(coat: CoatSettings, index: super::ConductorIndex, roughness: Roughness) -> Self {
        let layers = Layers::new(&coat);
        let metal_axis = Axis::of(&roughness);
        let of_coat = |layer: &Layer, alpha: f32| {
            let metal = metal_axis.0.iter();
            let tables = metal.map(|&metal| Reflections::new(layer, [alpha, metal]));
            tables.collect::<Vec<_>>()
        };
        let coats = layers.layers.iter().zip(&layers.axis.0);
        let reflections = coats.flat_map(|(layer, &alpha)| of_coat(layer, alpha));
        let reflections = reflections.collect();
        Self {
            coat,
            index,
            roughness,
            layers,
            metal_axis,
            reflections,
        }
    }

    #[inline]
    fn reflections(&self, coat: f32, metal: f32) -> Reflections {
        let (low, high, t) = self.layers.axis.locate(coat);
        let (m_low, m_high, m_t) = self.metal_axis.locate(metal);
        let row = |i: usize| {
            let row = &self.reflections[i * self.metal_axis.0.len()..];
            row[m_low].lerp(&row[m_high], m_t)
        };
        row(low).lerp(&row(high), t)
    }

    pub(super) fn needs(&self) -> Needs {
        let metal = self.index.needs().and(self.roughness.needs());
        self.coat.needs().and(metal)
    }

    pub(super) fn bsdf(
        &self,
        at: &TexturePoint,
        color: ColorModel,
        wavelengths: &Wavelengths,
    ) -> Bsdf {
        let (ggx, facets) = (self.coat.roughness.ggx(at), self.roughness.ggx(at));
        let filling = self.coat.filling(at, color, wavelengths);
        let (eta, k) = self.index.eval(at, color, wavelengths);
        let metal = CoatedMetal {
            eta: eta / self.coat.eta,
            k: k / self.coat.eta,
            ggx: facets,
        };
        let (coat_alpha, metal_alpha) = (ggx.mean_alpha(), facets.mean_alpha());
        let layer = self.layers.at(coat_alpha);
        let reflections = self.reflections(coat_alpha, metal_alpha);
        let tables = (&layer, &reflections);
        Bsdf::CoatedConductor(CoatedConductor::new(tables, ggx, &filling, metal))
    }
}

/// No scattering within a layer.
pub const CLEAR: ColorTexture = ColorTexture::Constant([0.0; 3]);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::microfacet::Ggx;
    use crate::math::Vec3;
    use crate::spectrum::Spectrum;

    #[test]
    fn slopes_are_found_between_their_neighbours() {
        let axis = Axis(vec![0.0, 0.25, 1.0]);
        assert_eq!(axis.locate(0.0), (0, 0, 0.0));
        assert_eq!(axis.locate(0.5), (1, 2, 1.0 / 3.0));
        assert_eq!(axis.locate(3.0), (2, 2, 0.0));
        assert_eq!(Axis(vec![0.3]).locate(0.3), (0, 0, 0.0));
    }

    #[test]
    fn a_textured_slope_has_about_what_is_integrated_for_it() {
        let eta = 1.5;
        let axis: Vec<f32> = (0..=8).map(|i| sqr(i as f32 / 8.0)).collect();
        let layers = Layers {
            layers: axis.iter().map(|&alpha| Layer::new(eta, alpha)).collect(),
            axis: Axis(axis),
        };
        for alpha in [0.05, 0.2, 0.7] {
            let [between, exact] = [layers.at(alpha), Layer::new(eta, alpha)].map(|layer| {
                let ggx = Ggx::new(alpha, alpha);
                let filling = Filling {
                    thickness: 0.0,
                    albedo: Spectrum::ZERO,
                    g: 0.0,
                };
                let white = Spectrum::ONE;
                let bsdf = CoatedDiffuse::new(&layer, ggx, &filling, white);
                Bsdf::CoatedDiffuse(bsdf).albedo(Vec3::Z)[0]
            });
            assert!((between - exact).abs() < 0.02, "{between} and {exact}");
        }
    }
}

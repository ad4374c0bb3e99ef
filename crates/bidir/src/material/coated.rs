//! Coated materials: their textures, and the integrals that are tabulated for them before rendering.
//!
//! The integrals depend on slopes. For constant slopes there is one of each; for textures there are several, for
//! slopes between 0 and 1, and values between them are interpolated.

use super::{Roughness, unit};
use crate::bsdf::coat::{Filled, Layer, Reflections, Slab};
use crate::bsdf::{Bsdf, CoatedConductor, CoatedDiffuse, CoatedMetal, InterlayerMedium};
use crate::math::{Vec2, sqr};
use crate::spectrum::Lanes;
use crate::texture::{ColorTexture, FloatTexture, RequiredInputs, TexturePoint};
use rayon::prelude::*;
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
    /// The fraction of the optical depth that scatters.
    pub albedo: ColorTexture,
    /// The mean cosine of the angle of scattering.
    pub g: FloatTexture,
}

impl CoatSettings {
    fn needs(&self) -> RequiredInputs {
        let medium = self.thickness.needs().and(self.g.needs());
        medium.and(self.albedo.needs()).and(self.roughness.needs())
    }

    fn medium(&self, at: &TexturePoint, lanes: Lanes) -> InterlayerMedium {
        InterlayerMedium {
            thickness: self.thickness.eval(at).max(0.0),
            // The empty lane repeats another, so that grey layers have one table.
            albedo: lanes.unbounded(unit(self.albedo.eval(at))),
            g: self.g.eval(at).clamp(-1.0, 1.0),
        }
    }

    fn is_clear(&self) -> bool {
        match self.albedo {
            ColorTexture::Constant(albedo) => albedo.iter().all(|&part| part <= 0.0),
            _ => false,
        }
    }
}

/// The values of a parameter for which integrals are tabulated, increasing.
#[derive(Clone, Debug)]
struct Axis(Vec<f32>);

impl Axis {
    /// Returns one slope if it is constant; otherwise several from 0 to 1, closer where they are small.
    fn of(roughness: &Roughness) -> Self {
        let is_constant = |texture: &FloatTexture| matches!(texture, FloatTexture::Constant(_));
        if is_constant(&roughness.u) && is_constant(&roughness.v) {
            let anywhere = TexturePoint::of_parameters(Vec2::ZERO);
            return Self(vec![roughness.ggx(&anywhere).mean_alpha()]);
        }
        let steps = 8;
        Self((0..=steps).map(|i| sqr(i as f32 / steps as f32)).collect())
    }

    /// Returns one value if the texture is constant; otherwise `nodes`.
    fn of_texture(texture: &FloatTexture, nodes: impl Iterator<Item = f32>) -> Self {
        match texture {
            FloatTexture::Constant(value) => Self(vec![*value]),
            _ => Self(nodes.collect()),
        }
    }

    /// Returns the position of `value`, clamped to the ends.
    #[inline]
    fn locate(&self, value: f32) -> Position {
        let after = self.0.partition_point(|&node| node < value);
        let (low, high) = (after.saturating_sub(1), after.min(self.0.len() - 1));
        let width = self.0[high] - self.0[low];
        let t = if width > 0.0 {
            ((value - self.0[low]) / width).clamp(0.0, 1.0)
        } else {
            0.0
        };
        Position { low, high, t }
    }
}

/// A position on an [`Axis`]: between the values with the indices `low` and `high`, at the fraction `t` of the way.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Position {
    low: usize,
    high: usize,
    t: f32,
}

/// Layers, tabulated by the slope of the interface.
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
        let Position { low, high, t } = self.axis.locate(alpha);
        self.layers[low].lerp(&self.layers[high], t)
    }
}

/// Filled layers, tabulated by slope, optical depth, mean cosine and albedo of scattering.
#[derive(Clone, Debug)]
struct InterlayerTables {
    depths: Axis,
    cosines: Axis,
    albedos: Axis,
    tables: Arc<[Filled]>,
}

impl InterlayerTables {
    fn new(coat: &CoatSettings, layers: &Layers) -> Self {
        let nodes = (0..=8).map(|i| 4.0 * sqr(i as f32 / 8.0));
        let mut depths = Axis::of_texture(&coat.thickness, nodes);
        (depths.0.iter_mut()).for_each(|depth| *depth = depth.max(0.0));
        let cosines = Axis::of_texture(&coat.g, (-2..=2).map(|i| 0.45 * i as f32));
        let (cosines, albedos) = if coat.is_clear() {
            (Axis(vec![0.0]), Axis(vec![0.0]))
        } else {
            // The nodes are closer where light scatters often.
            let albedos = (0..=16).map(|i| 1.0 - sqr(1.0 - i as f32 / 16.0));
            (cosines, Axis(albedos.collect()))
        };
        let mut slabs = Vec::new();
        for layer in &*layers.layers {
            let of_depth = |&depth| cosines.0.iter().map(move |&g| Slab::new(layer, depth, g));
            let of_layer = depths.0.iter().flat_map(of_depth);
            slabs.extend(of_layer.map(|slab| (layer, slab)));
        }
        let tables: Vec<_> = (slabs.par_iter())
            .flat_map(|(layer, slab)| slab.tables(layer, &albedos.0))
            .collect();
        Self {
            depths,
            cosines,
            albedos,
            tables: tables.into(),
        }
    }

    /// Returns the interpolated table of each lane; `slope` is the position between the slopes of the layers.
    fn at(&self, slope: Position, medium: &InterlayerMedium) -> [Filled; 4] {
        if let [only] = *self.tables {
            return [only; 4];
        }
        let depth = self.depths.locate(medium.thickness);
        let cosine = self.cosines.locate(medium.g);
        let at = |albedo| self.mixed([slope, depth, cosine, self.albedos.locate(albedo)]);
        let first = at(medium.albedo[0]);
        let is_first = |albedo: f32| albedo.to_bits() == medium.albedo[0].to_bits();
        let lanes = medium.albedo.0;
        lanes.map(|albedo| if is_first(albedo) { first } else { at(albedo) })
    }

    /// Returns the interpolated table at a point, which is given by its position on each axis.
    fn mixed(&self, point: [Position; 4]) -> Filled {
        let sizes = [
            self.depths.0.len(),
            self.cosines.0.len(),
            self.albedos.0.len(),
        ];
        let corner = |number: usize| {
            let ends: [(usize, f32); 4] = std::array::from_fn(|axis| {
                let Position { low, high, t } = point[axis];
                match number >> axis & 1 {
                    0 => (low, 1.0 - t),
                    _ => (high, t),
                }
            });
            let [a, b, c, d] = ends.map(|(index, _)| index);
            let row = (a * sizes[0] + b) * sizes[1] + c;
            let weight = ends.iter().map(|(_, weight)| weight).product::<f32>();
            (weight, self.tables[row * sizes[2] + d])
        };
        let corners = (0..16).map(corner).filter(|&(weight, _)| weight > 0.0);
        Filled::mixed(corners)
    }
}

/// A diffuse base under a layer.
#[derive(Clone, Debug)]
pub struct CoatedDiffuseMaterial {
    pub(super) coat: CoatSettings,
    reflectance: ColorTexture,
    layers: Layers,
    tables: InterlayerTables,
}

impl CoatedDiffuseMaterial {
    /// Makes a base of `reflectance`.
    pub fn new(coat: CoatSettings, reflectance: ColorTexture) -> Self {
        let layers = Layers::new(&coat);
        Self {
            tables: InterlayerTables::new(&coat, &layers),
            layers,
            coat,
            reflectance,
        }
    }

    pub(super) fn needs(&self) -> RequiredInputs {
        self.coat.needs().and(self.reflectance.needs())
    }

    pub(super) fn bsdf(&self, at: &TexturePoint, lanes: Lanes) -> Bsdf {
        let ggx = self.coat.roughness.ggx(at);
        let medium = self.coat.medium(at, lanes);
        let reflectance = lanes.albedo(unit(self.reflectance.eval(at)));
        let alpha = ggx.mean_alpha();
        let layer = self.layers.at(alpha);
        let filled = self.tables.at(self.layers.axis.locate(alpha), &medium);
        let mean = Filled::mean(lanes.carrying().map(|lane| filled[lane]));
        Bsdf::CoatedDiffuse(CoatedDiffuse::new(&layer, ggx, &filled, &mean, reflectance))
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
    /// Tables by the slope of the interface, then of the metal.
    reflections: Arc<[Reflections]>,
}

impl CoatedConductorMaterial {
    /// Makes metal of `index` and `roughness` under a layer.
    pub fn new(coat: CoatSettings, index: super::ConductorIndex, roughness: Roughness) -> Self {
        let layers = Layers::new(&coat);
        let metal_axis = Axis::of(&roughness);
        // The reflections within the layer hardly depend on its depth.
        let depth = match coat.thickness {
            FloatTexture::Constant(depth) => depth,
            _ => 0.1,
        };
        let of_coat = |layer| {
            let metal = metal_axis.0.par_iter();
            metal.map(move |&metal| Reflections::new(layer, metal, depth))
        };
        let reflections: Vec<_> = layers.layers.par_iter().flat_map(of_coat).collect();
        Self {
            coat,
            index,
            roughness,
            layers,
            metal_axis,
            reflections: reflections.into(),
        }
    }

    #[inline]
    fn reflections(&self, coat: f32, metal: f32) -> Reflections {
        let Position { low, high, t } = self.layers.axis.locate(coat);
        let metal = self.metal_axis.locate(metal);
        let row = |i: usize| {
            let row = &self.reflections[i * self.metal_axis.0.len()..];
            row[metal.low].lerp(&row[metal.high], metal.t)
        };
        row(low).lerp(&row(high), t)
    }

    pub(super) fn needs(&self) -> RequiredInputs {
        let metal = self.index.needs().and(self.roughness.needs());
        self.coat.needs().and(metal)
    }

    pub(super) fn bsdf(&self, at: &TexturePoint, lanes: Lanes) -> Bsdf {
        let (ggx, facets) = (self.coat.roughness.ggx(at), self.roughness.ggx(at));
        let medium = self.coat.medium(at, lanes);
        let [eta, k] = self.index.eval(at, lanes);
        let metal = CoatedMetal {
            eta: eta / self.coat.eta,
            k: k / self.coat.eta,
            ggx: facets,
        };
        let (coat_alpha, metal_alpha) = (ggx.mean_alpha(), facets.mean_alpha());
        let layer = self.layers.at(coat_alpha);
        let reflections = self.reflections(coat_alpha, metal_alpha);
        let coated = CoatedConductor::new(&layer, &reflections, ggx, &medium, metal);
        Bsdf::CoatedConductor(coated)
    }
}

/// No scattering within a layer.
pub const CLEAR: ColorTexture = ColorTexture::Constant([0.0; 3]);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::TransportMode;
    use crate::bsdf::microfacet::Ggx;
    use crate::math::Vec3;
    use crate::spectrum::{Rgb, Spectrum};
    use crate::testing::{check_close, check_near, materials};

    #[test]
    fn slopes_are_found_between_their_neighbours() {
        let axis = Axis(vec![0.0, 0.25, 1.0]);
        let position = |low, high, t| Position { low, high, t };
        assert_eq!(axis.locate(0.0), position(0, 0, 0.0));
        assert_eq!(axis.locate(0.5), position(1, 2, 1.0 / 3.0));
        assert_eq!(axis.locate(3.0), position(2, 2, 0.0));
        assert_eq!(Axis(vec![0.3]).locate(0.3), position(0, 0, 0.0));
    }

    /// Makes a base of 0.6 under a haze of this albedo.
    fn haze(albedo: Rgb) -> Bsdf {
        let coat = CoatSettings {
            thickness: FloatTexture::Constant(1.0),
            albedo: ColorTexture::Constant(albedo),
            g: FloatTexture::Constant(0.2),
            ..materials::coat(0.3)
        };
        let material = CoatedDiffuseMaterial::new(coat, ColorTexture::Constant([0.6; 3]));
        material.bsdf(&TexturePoint::of_parameters(Vec2::ZERO), Lanes::Rgb)
    }

    /// The lane that carries no light has no part in those that do, whichever colour it repeats.
    #[test]
    fn a_haze_looks_the_same_with_its_channels_exchanged() {
        let albedo = [0.0, 0.5, 0.95];
        for [z_o, z_i] in [[1.0, 0.9], [0.9, 0.2], [0.3, 0.3], [0.1, 0.6]] {
            let [wo, wi] = [z_o, z_i].map(|z: f32| Vec3::new((1.0 - z * z).sqrt(), 0.0, z));
            let value = |bsdf: &Bsdf| bsdf.eval(wo, wi, TransportMode::Radiance);
            let as_given = value(&haze(albedo));
            for turn in 1..3 {
                let turned = value(&haze([0, 1, 2].map(|i| albedo[(i + turn) % 3])));
                for i in 0..3 {
                    check_close(turned.f[i], as_given.f[(i + turn) % 3], 1e-4, "f");
                }
                check_close(turned.pdf, as_given.pdf, 1e-4, "density");
            }
        }
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
            let filled = |layer: &Layer| Slab::new(layer, 0.0, 0.0).tables(layer, &[0.0])[0];
            let Position { low, high, t } = layers.axis.locate(alpha);
            let ends =
                [(1.0 - t, low), (t, high)].map(|(weight, i)| (weight, filled(&layers.layers[i])));
            let own = Layer::new(eta, alpha);
            let coats = [
                (layers.at(alpha), Filled::mixed(ends.into_iter())),
                (own, filled(&own)),
            ];
            let [between, exact] = coats.map(|(layer, filled)| {
                let ggx = Ggx::new(alpha, alpha);
                let white = Spectrum::ONE;
                let bsdf = CoatedDiffuse::new(&layer, ggx, &[filled; 4], &filled, white);
                Bsdf::CoatedDiffuse(bsdf).albedo(Vec3::Z)[0]
            });
            check_near(between, exact, 0.02, alpha);
        }
    }
}

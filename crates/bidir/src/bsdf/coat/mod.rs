//! A dielectric layer over an opaque base: the common part of both coated materials.
//!
//! Light that the interface lets through reaches the base along refracted directions, and leaves through the
//! interface again. A base with the BSDF f_b inside the layer has, seen from outside,
//!
//! f = T(wo) T(wi) A(wo) A(wi) f_b / η²,
//!
//! with T the directional transmittance of the interface, A = exp(-D ℓ) the fraction of light that the layer does not
//! absorb in one crossing, and 1/η² the compression of radiance (docs/derivations/layered-materials.md). Each factor
//! depends on one direction, so f is symmetric.
//!
//! T of a rough interface has no closed form. It is (1 - F(μ̂)) q(√μ), where μ̂² = μ² + (1-μ²) g² keeps Fresnel's
//! equations away from grazing angles, as facets do. q and ℓ are polynomials (`Curve`) through values that were
//! integrated when the material was built: over a diffuse base by [`Layer`] and [`Slab`], over metal by
//! [`Reflections`]. For a smooth interface g = 0 and q = 1.

mod curve;
mod filled;
mod layer;
mod reflections;

pub(super) use curve::Curve;
pub use filled::{Filled, Slab};
pub(super) use filled::{LENGTHS, SHAPES};
pub(super) use layer::KNOTS as RATIOS;
pub use layer::Layer;
pub use reflections::Reflections;
pub(super) use reflections::{KNOTS as METAL_SHAPES, MetalCoat};

use super::fresnel;
use super::microfacet::{Ggx, SMOOTH_ALPHA};
use crate::math::{Vec2, Vec3, sqr};
use crate::spectrum::Spectrum;

/// The interface of a layer, and the attenuation by the layer. Both sides of the surface have it.
///
/// `R` and `L` are the numbers of coefficients of q and ℓ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Coat<const R: usize, const L: usize> {
    /// D: the mean depth of a crossing.
    depth: Spectrum,
    /// Index of refraction of the layer, divided by that outside.
    eta: f32,
    pub(super) ggx: Ggx,
    /// g: the cosine at which light of grazing directions meets facets.
    grazing: f32,
    /// q: the factor by which facets shadow the transmitted light.
    ratio: Curve<R>,
    /// ℓ: the depth of a crossing, divided by D.
    length: Curve<L>,
}

/// Reflectance and transmittance of an interface for light along one direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    /// The approximate fraction of light that the interface reflects; exact for a smooth interface.
    pub(super) reflected: f32,
    /// T: the fraction that the interface lets through to the base.
    pub(super) through: f32,
}

impl<const R: usize, const L: usize> Coat<R, L> {
    /// Makes a coat with facets of `ggx` and the index of `layer`; `ratio` is q.
    pub(super) fn new(
        layer: &Layer,
        ggx: Ggx,
        ratio: Curve<R>,
        depth: Spectrum,
        length: Curve<L>,
    ) -> Self {
        Self {
            depth,
            eta: layer.eta(),
            ggx,
            grazing: layer.grazing,
            ratio,
            length,
        }
    }

    #[inline]
    pub(super) fn eta(&self) -> f32 {
        self.eta
    }

    /// Returns true if it has no facets. An index-matched interface reflects and bends nothing.
    #[inline]
    pub(super) fn is_smooth(&self) -> bool {
        self.ggx.is_smooth()
    }

    /// Returns the approximate reflectance of the interface for light along `w`; exact if it is smooth.
    #[inline]
    pub(super) fn reflectance(&self, w: Vec3) -> f32 {
        fresnel::dielectric(spread_cosine(w.z, self.grazing).max(1e-7), self.eta)
    }

    /// Returns T(w), the fraction of light along `w` that the interface lets through to the base.
    #[inline]
    pub(super) fn transmittance(&self, w: Vec3) -> f32 {
        self.interface(w).through
    }

    /// Returns reflectance and transmittance for light along `w`.
    #[inline]
    pub(super) fn interface(&self, w: Vec3) -> Seen {
        self.interfaces([w; 2])[0]
    }

    /// Returns reflectance and transmittance for light along each of two directions.
    #[inline]
    pub(super) fn interfaces(&self, w: [Vec3; 2]) -> [Seen; 2] {
        let reflected = w.map(|w| self.reflectance(w));
        let mut through = reflected.map(|reflected| 1.0 - reflected);
        if !self.is_smooth() {
            let ratios = self.ratio.at_both(w.map(|w| w.z.abs()));
            through = [0, 1].map(|i| (through[i] * ratios[i]).clamp(0.0, 1.0));
        }
        [0, 1].map(|i| Seen {
            reflected: reflected[i],
            through: through[i],
        })
    }

    /// Returns the direction within the layer, on the same side, after refraction by a smooth interface. None: total
    /// reflection.
    #[inline]
    pub(super) fn refracted(&self, w: Vec3) -> Option<Vec3> {
        let (x, y) = (w.x / self.eta, w.y / self.eta);
        let cos2 = 1.0 - sqr(x) - sqr(y);
        (cos2 > 0.0).then(|| Vec3::new(x, y, cos2.sqrt().copysign(w.z)))
    }

    /// Returns the direction outside, given the one within the layer. None: total reflection.
    #[inline]
    pub(super) fn emerging(&self, w: Vec3) -> Option<Vec3> {
        let (x, y) = (w.x * self.eta, w.y * self.eta);
        let cos2 = 1.0 - sqr(x) - sqr(y);
        (cos2 > 0.0).then(|| Vec3::new(x, y, cos2.sqrt().copysign(w.z)))
    }

    /// Returns A(wo) A(wi), the fraction of light that the layer does not absorb in crossings along both directions.
    #[inline]
    pub(super) fn attenuation(&self, wo: Vec3, wi: Vec3) -> Spectrum {
        if self.depth.is_black() {
            return Spectrum::ONE;
        }
        let [of_wo, of_wi] = self.length.at_both([wo, wi].map(|w| w.z.abs()));
        let both = of_wo + of_wi;
        let left = |depth: f32| libm::expf(-depth * both.max(0.0));
        let first = left(self.depth[0]);
        // Most layers are grey.
        self.depth.map(|depth| {
            if depth.to_bits() == self.depth[0].to_bits() {
                first
            } else {
                left(depth)
            }
        })
    }

    /// Returns f of the interface's reflection, and the densities with which [`sample`](Self::sample) draws `wi` for
    /// `wo`, and `wo` for `wi`. Unit of all: 1/sr. Zero where it is smooth.
    #[inline]
    pub(super) fn eval(&self, wo: Vec3, wi: Vec3) -> (f32, [f32; 2]) {
        if self.is_smooth() {
            return (0.0, [0.0; 2]);
        }
        let mirror = self.ggx.mirror(wo, wi);
        let reflected = fresnel::dielectric(mirror.cos.abs(), self.eta);
        (mirror.facets * reflected, mirror.densities)
    }

    /// Draws a reflected direction of the rough interface. None: it is below the surface.
    #[inline]
    pub(super) fn sample(&self, wo: Vec3, u: Vec2) -> Option<Vec3> {
        self.ggx.sample_mirror(wo, u)
    }
}

/// Returns ∫ 2μ value(μ) dμ over `[0, 1]`, with `points` even in μ².
fn mean(points: usize, value: impl Fn(f32) -> f32) -> f32 {
    let at = |i| f64::from(value(((i as f32 + 0.5) / points as f32).sqrt()));
    ((0..points).map(at).sum::<f64>() / points as f64) as f32
}

/// Returns the facets of a metal as they appear through the facets `coat` of an interface of index `eta`.
///
/// A facet of the interface that is tilted by t turns refracted light by t (1 - 1/η), twice on its way; a facet of
/// the metal turns reflected light by 2t.
pub(super) fn seen_through(metal: Ggx, coat: Ggx, eta: f32) -> Ggx {
    if coat.is_smooth() {
        return metal;
    }
    let scale = (1.0 - 1.0 / eta).abs() * std::f32::consts::FRAC_1_SQRT_2;
    let broad = metal.broadened(coat, scale);
    if broad.is_smooth() {
        Ggx::new(SMOOTH_ALPHA, SMOOTH_ALPHA)
    } else {
        broad
    }
}

/// Returns μ̂ = √(μ² + (1-μ²) g²).
#[inline]
fn spread_cosine(cos: f32, grazing: f32) -> f32 {
    (sqr(cos) + (1.0 - sqr(cos)).max(0.0) * sqr(grazing)).sqrt()
}

/// Returns Σ x^k over all k, for light that is reflected back k times. It is finite even if a layer keeps all light.
#[inline]
pub(super) fn all_orders(x: f32) -> f32 {
    1.0 / (1.0 - x.min(0.9999))
}

//! The light that leaves a layer over white metal, after one reflection at the metal and after more.
//!
//! E₁(μ) is the fraction of light that leaves after exactly one reflection, E(μ) the fraction after two or more, and
//! m_k the share of E, from all directions, that leaves after exactly k. They come from random walks between the two
//! surfaces, with facets on both, by random numbers that do not depend on the scene.
//!
//! The closed form of one reflection has a factor T = (1 - F(μ̂)) q(√μ) for each direction. Here q is chosen so that
//! this form reflects E₁: a fixed point, which some rounds approach because the reflected direction has about the
//! same cosine. The walks also measure the length of paths within the layer, and the cosines at the facets of the
//! metal.

use super::layer::Interface;
use super::{Coat, Curve, Layer, mean, seen_through};
use crate::bsdf::fresnel;
use crate::bsdf::microfacet::Ggx;
use crate::math::{Vec2, Vec3, safe_sqrt, sqr};
use crate::sampler::{Dimension, Domain, Purpose, SampleStream, Sampler, SamplerKind};
use crate::spectrum::Spectrum;

/// The number of walks for each value of a curve.
const WALKS: u64 = 1 << 12;
/// The fraction of light below which a walk ends.
const FAINT: f32 = 3e-4;
/// The most reflections of a walk; few reach it.
const MOST: usize = 100;
/// The number of orders of reflection that are kept apart; the last stands for all higher ones.
const ORDERS: usize = 32;
/// The number of points of an integral over facets, in each dimension.
const FACETS: usize = 32;
/// The number of rounds towards the fixed point.
const ROUNDS: usize = 6;
/// The number of coefficients of q and e over metal.
pub(in crate::bsdf) const KNOTS: usize = 8;
/// The number of coefficients of ℓ over metal.
pub(in crate::bsdf) const LENGTHS: usize = 4;

/// The coat of a metal.
pub(in crate::bsdf) type MetalCoat = Coat<KNOTS, LENGTHS>;

/// The tabulated quantities of a layer over metal, with isotropic facets on both surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reflections {
    /// q.
    pub(in crate::bsdf) ratio: Curve<KNOTS>,
    /// ℓ: half of the path length of light that is reflected once. Unit: thicknesses of the layer.
    pub(in crate::bsdf) length: Curve<LENGTHS>,
    /// e, which E = Ē (1 - F(μ̂)) e defines.
    pub(in crate::bsdf) shape: Curve<KNOTS>,
    /// Ē = ∫ 2μ E dμ.
    pub(in crate::bsdf) mean: f32,
    /// The path length between two reflections. Unit: thicknesses of the layer.
    pub(in crate::bsdf) path: f32,
    /// The mean and the standard deviation of cosθ at the facets of more than one reflection.
    pub(in crate::bsdf) cosine: [f32; 2],
    /// s: at the facet of a single reflection, (1 - cosθ)⁵ is larger by s (1-μ)⁵ than in the closed form.
    pub(in crate::bsdf) steepness: f32,
    /// m_k, for k from 2 on.
    shares: [f32; ORDERS - 1],
}

/// Two surfaces, one above the other.
struct Surfaces {
    coat: Interface,
    metal: Ggx,
    /// The optical depth between them.
    depth: f32,
}

/// Light between the surfaces.
#[derive(Clone, Copy)]
struct Light {
    w: Vec3,
    part: f32,
    /// The path length so far. Unit: thicknesses of the layer.
    way: f32,
    /// Σ cosθ, Σ cos²θ and Σ (1 - cosθ)⁵ over the facets of the metal.
    cosines: [f32; 3],
}

/// The fractions of the light from one direction that leave.
#[derive(Clone, Copy)]
struct Leaving {
    /// The fractions by the number of reflections, from 1.
    parts: [f32; ORDERS],
    /// Of `parts[0]`: the fraction that is not absorbed, and the sum with the weight (1 - cosθ)⁵.
    once: [f32; 2],
    /// After more than one reflection, with weights w: Σ w length, Σ w (reflections - 1), Σ w cosθ, Σ w cos²θ, Σ w
    /// reflections.
    more: [f32; 5],
}

impl Leaving {
    fn more_than_once(&self) -> f32 {
        self.parts[1..].iter().sum()
    }

    fn add(&mut self, reflections: usize, light: &Light, depth: f32) {
        let Light {
            part, way, cosines, ..
        } = *light;
        self.parts[reflections.min(ORDERS) - 1] += part;
        if reflections == 1 {
            self.once[0] += part * libm::expf(-depth * way);
            self.once[1] += part * cosines[2];
            return;
        }
        let count = reflections as f32;
        self.more[0] += part * way;
        self.more[1] += part * (count - 1.0);
        // The weights decrease with the count: coloured metals reflect little light more than twice.
        let early = part * libm::exp2f(-count);
        self.more[2] += early * cosines[0];
        self.more[3] += early * cosines[1];
        self.more[4] += early * count;
    }
}

impl Reflections {
    /// Integrates for the interface of `layer` over metal of slope `metal_alpha`, with the optical
    /// depth `depth` between them.
    pub fn new(layer: &Layer, metal_alpha: f32, depth: f32) -> Self {
        let surfaces = Surfaces {
            coat: layer.interface,
            metal: Ggx::new(metal_alpha, metal_alpha),
            depth: depth.clamp(1e-3, 10.0),
        };
        let leaving = Curve::<KNOTS>::cosines().map(|cos| surfaces.leaving(cos));
        let coat = surfaces.fitted_coat(layer, &leaving);
        let entering = |cos: f32| 1.0 - coat.reflectance(along(cos));
        let cosines = Curve::<KNOTS>::cosines();
        let part = |i: usize| leaving[i].more_than_once() / entering(cosines[i]).max(1e-3);
        let shape = Curve::<KNOTS>::through(std::array::from_fn(part));
        let trapped = mean(64, |cos| entering(cos) * shape.at(cos).max(0.0)).max(1e-6);
        let of_order = |k: usize| Curve::through(leaving.map(|of| of.parts[k - 1])).mean();
        let shares: [f32; ORDERS - 1] = std::array::from_fn(|i| of_order(i + 2).max(0.0));
        let sum = shares.iter().sum::<f32>().max(1e-6);
        let more = |i: usize| leaving.iter().map(|of| of.more[i]).sum::<f32>();
        let crossings = surfaces.crossings(&leaving);
        let in_and_out = leaving
            .iter()
            .zip(crossings)
            .map(|(of, crossing)| 2.0 * crossing * of.more_than_once());
        let cosine = more(2) / more(4).max(1e-6);
        Self {
            ratio: coat.ratio,
            length: coat.length,
            shape: shape.scaled(1.0 / trapped),
            mean: trapped,
            path: ((more(0) - in_and_out.sum::<f32>()) / more(1).max(1e-6)).clamp(2.0, 20.0),
            cosine: [cosine, safe_sqrt(more(3) / more(4).max(1e-6) - sqr(cosine))],
            steepness: surfaces.steepness(&coat, &leaving),
            shares: shares.map(|share| share / sum),
        }
    }

    /// Interpolates between two tables with the same index.
    #[must_use]
    pub fn lerp(&self, other: &Self, t: f32) -> Self {
        let mix = |a: f32, b: f32| a + (b - a) * t;
        Self {
            ratio: self.ratio.lerp(other.ratio, t),
            length: self.length.lerp(other.length, t),
            shape: self.shape.lerp(other.shape, t),
            mean: mix(self.mean, other.mean),
            path: mix(self.path, other.path),
            cosine: std::array::from_fn(|i| mix(self.cosine[i], other.cosine[i])),
            steepness: mix(self.steepness, other.steepness),
            shares: std::array::from_fn(|i| mix(self.shares[i], other.shares[i])),
        }
    }

    /// Returns Σ m_k F^k a^(k-1) over k ≥ 2: the fraction of E for a metal of reflectance `fresnel`, with a = `trip`
    /// the fraction that the layer does not absorb between two reflections.
    #[inline]
    pub(in crate::bsdf) fn remaining(&self, fresnel: f32, trip: f32) -> f32 {
        let x = fresnel * trip;
        let sum = self.shares.iter().rev().fold(0.0, |sum, m| m + x * sum);
        sum * fresnel * x
    }
}

/// Returns the direction of cosine `cos` in the plane of incidence.
fn along(cos: f32) -> Vec3 {
    Vec3::new(safe_sqrt(1.0 - sqr(cos)), 0.0, cos)
}

impl Surfaces {
    /// Returns half of the path length of one reflection at the cosines of q. Unit: thicknesses of the layer.
    fn crossings(&self, leaving: &[Leaving; KNOTS]) -> [f32; KNOTS] {
        leaving.map(|of| crossing(of.once[0] / of.parts[0].max(1e-6), self.depth))
    }

    /// Returns the coat whose q reflects E₁ in the closed form of one reflection, and whose ℓ absorbs as much as the
    /// walks.
    fn fitted_coat(&self, layer: &Layer, leaving: &[Leaving; KNOTS]) -> MetalCoat {
        let ggx = self.coat.ggx;
        let cosines = Curve::<KNOTS>::cosines();
        let inner = |cos: f32| safe_sqrt(1.0 - (1.0 - sqr(cos)) / sqr(layer.eta())).max(0.05);
        let mut ratios = cosines.map(|cos| layer.ratio.at(cos));
        let mut lengths = cosines.map(|cos| 1.0 / inner(cos));
        let coat = |ratios, lengths| {
            let lengths = Curve::<KNOTS>::through(lengths);
            let length = Curve::through(Curve::<LENGTHS>::cosines().map(|cos| lengths.at(cos)));
            let ratio = Curve::through(ratios);
            Coat::new(layer, ggx, ratio, Spectrum::splat(self.depth), length)
        };
        if ggx.is_smooth() {
            return coat([1.0; KNOTS], lengths);
        }
        let metal = seen_through(self.metal, ggx, layer.eta());
        let crossings = self.crossings(leaving);
        for _ in 0..ROUNDS {
            let fitted = coat(ratios, lengths);
            for i in 0..KNOTS {
                let closed = once_in_closed_form(&fitted, metal, cosines[i]);
                let scale = (leaving[i].parts[0] / closed.part.max(1e-4)).sqrt();
                ratios[i] *= scale.clamp(0.5, 2.0);
                let longer = crossings[i] - closed.crossing(self.depth);
                lengths[i] = (lengths[i] + longer).clamp(1.0, 20.0);
            }
        }
        coat(ratios, lengths)
    }

    /// Returns s, by least squares.
    fn steepness(&self, coat: &MetalCoat, leaving: &[Leaving; KNOTS]) -> f32 {
        if self.coat.ggx.is_smooth() {
            return 0.0;
        }
        let metal = seen_through(self.metal, self.coat.ggx, self.coat.eta);
        let cosines = Curve::<KNOTS>::cosines();
        let (mut products, mut squares) = (0.0, 0.0);
        for (of, cos) in leaving.iter().zip(cosines) {
            let closed = once_in_closed_form(coat, metal, cos);
            let more = of.once[1] / of.parts[0].max(1e-6) - closed.steep / closed.part.max(1e-6);
            let scale = fresnel::schlick(cos);
            products += more * scale;
            squares += sqr(scale);
        }
        (products / squares).clamp(0.0, 1.0)
    }

    /// Returns the fractions of light with cosine `cos` that leave.
    fn leaving(&self, cos: f32) -> Leaving {
        let wo = along(cos);
        let sampler = Sampler::new(SamplerKind::Sobol, 0);
        let mut leaving = Leaving {
            parts: [0.0; ORDERS],
            once: [0.0; 2],
            more: [0.0; 5],
        };
        for index in 0..WALKS {
            let stream = sampler.stream(Domain::Light, 0, index);
            self.walk(wo, &stream, |reflections, light| {
                leaving.add(reflections, &light, self.depth);
            });
        }
        let scale = 1.0 / WALKS as f32;
        Leaving {
            parts: leaving.parts.map(|part| part * scale),
            once: leaving.once.map(|part| part * scale),
            more: leaving.more.map(|part| part * scale),
        }
    }

    /// Walks from outside, and calls `leaves` for the light that leaves after each reflection at the metal.
    fn walk(&self, wo: Vec3, stream: &SampleStream, mut leaves: impl FnMut(usize, Light)) {
        let at = |step| stream.get_2d(Dimension::at(step, Purpose::LightDirection));
        let Some((w, part)) = self.coat.split(wo, at(0)).refracted else {
            return;
        };
        let mut light = Light {
            w,
            part,
            way: 0.0,
            cosines: [0.0; 3],
        };
        for reflections in 1..=MOST {
            let u = stream.get_2d(Dimension::at(reflections, Purpose::Scatter));
            let Some(up) = self.reflected(&light, u) else {
                return;
            };
            let split = self.coat.split(-up.w, at(reflections));
            if let Some((_, share)) = split.refracted {
                let part = up.part * share;
                leaves(reflections, Light { part, ..up });
            }
            let Some((w, share)) = split.reflected else {
                return;
            };
            light = Light {
                w,
                part: up.part * share,
                ..up
            };
            if light.part < FAINT {
                return;
            }
        }
    }

    /// Returns light that comes down, after its reflection at the metal and its way back to the interface. None: a
    /// facet sends it below the surface.
    fn reflected(&self, light: &Light, u: Vec2) -> Option<Light> {
        let v = -light.w;
        let (w, unshadowed) = if self.metal.is_smooth() {
            (Vec3::new(-v.x, -v.y, v.z), 1.0)
        } else {
            let w = self.metal.sample_mirror(v, u)?;
            (w, self.metal.g2(v, w) / self.metal.g1(v))
        };
        let cos = safe_sqrt((1.0 + v.dot(w)) / 2.0);
        let [sum, squares, steep] = light.cosines;
        Some(Light {
            w,
            part: light.part * unshadowed,
            way: light.way + 1.0 / v.z.max(1e-3) + 1.0 / w.z.max(1e-3),
            cosines: [sum + cos, squares + sqr(cos), steep + fresnel::schlick(cos)],
        })
    }
}

/// Returns half of the path length after which the fraction `left` remains at the optical depth `depth`. Unit:
/// thicknesses of the layer.
fn crossing(left: f32, depth: f32) -> f32 {
    -libm::logf(left.clamp(1e-9, 1.0)) / (2.0 * depth)
}

/// The light that white metal reflects once, in closed form.
#[derive(Default)]
struct Once {
    part: f32,
    /// The sum with the weight (1 - cosθ)⁵ at the metal's facets.
    steep: f32,
    /// Of `part`: the fraction that is not absorbed.
    left: f32,
}

impl Once {
    fn crossing(&self, depth: f32) -> f32 {
        crossing(self.left / self.part.max(1e-6), depth)
    }
}

/// Returns the light with cosine `cos` that white metal reflects once under `coat`, as in `CoatedConductor` except
/// for the number of points.
fn once_in_closed_form(coat: &MetalCoat, metal: Ggx, cos: f32) -> Once {
    let wo = along(cos);
    let mut once = Once::default();
    let Some(inner) = coat.refracted(wo) else {
        return once;
    };
    for i in 0..FACETS * FACETS {
        let u = (Vec2::new((i % FACETS) as f32, (i / FACETS) as f32) + 0.5) / FACETS as f32;
        if let Some(reflected) = metal.sample_mirror(inner, u)
            && let Some(wi) = coat.emerging(reflected)
        {
            let unshadowed = metal.g2(inner, reflected) / metal.g1(inner);
            let through = coat.transmittance(wo) * coat.transmittance(wi);
            let part = unshadowed * through / (FACETS * FACETS) as f32;
            let cos = safe_sqrt((1.0 + inner.dot(reflected)) / 2.0);
            once.part += part;
            once.steep += part * fresnel::schlick(cos);
            once.left += part * coat.attenuation(wo, wi)[0];
        }
    }
    once
}

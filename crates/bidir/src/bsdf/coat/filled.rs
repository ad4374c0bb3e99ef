//! A layer filled with a medium: the light that it scatters back and lets through to a black base, and its reflection
//! of diffuse light from below.
//!
//! - B(μ) is the fraction of light from outside that reaches the base;
//! - E(μ) is the fraction that scatters within the layer and leaves without reaching the base;
//! - R is the fraction of diffuse light from the base that returns to it.
//!
//! The reflection of a Lambertian base depends only on B and R, so these give it exactly
//! (docs/derivations/layered-materials.md). Without scattering they are integrals over facets: of T exp(-τ/μ') from
//! outside, and of 2μ exp(-τ/μ) F exp(-τ/μ_r) from within, with μ_r the cosine after reflection. With scattering they
//! come from random walks, whose random numbers do not depend on the scene. The walks separate the numbers k of
//! scattering events: each quantity is a polynomial Σ_k ϖ^k S_k in the albedo ϖ.

use super::layer::{FACETS, Interface};
use super::{Curve, Layer, mean};
use crate::math::{Frame, PI, Vec2, Vec3, safe_sqrt, sin_cos, sqr, warp};
use crate::sampler::{Dimension, Domain, Purpose, SampleStream, Sampler, SamplerKind};

/// The number of walks for each value of a curve, and from the base.
const WALKS: u64 = 1 << 13;
/// The most scattering events of a walk; few reach it.
const MOST: usize = 256;
/// The number of scattering counts that are kept apart; the last stands for all larger ones.
const ORDERS: usize = 32;
/// The number of points of the integral over the cosine from within, and over facets.
const POINTS: u32 = 1 << 17;
/// The largest optical depth: beyond it no light gets through.
const DEEPEST: f32 = 10.0;
/// The number of coefficients of ℓ.
pub(in crate::bsdf) const LENGTHS: usize = 8;
/// The number of coefficients of e.
pub(in crate::bsdf) const SHAPES: usize = 6;

/// The tabulated quantities of a filled layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filled {
    /// D: the mean of -ln(B/T).
    pub(in crate::bsdf) depth: f32,
    /// ℓ, which B = T exp(-D ℓ) defines.
    pub(in crate::bsdf) length: Curve<LENGTHS>,
    /// R.
    pub(in crate::bsdf) internal: f32,
    /// Ē = ∫ 2μ E dμ.
    pub(in crate::bsdf) thrown: f32,
    /// e, which E = Ē T e defines.
    pub(in crate::bsdf) shape: Curve<SHAPES>,
}

impl Filled {
    const NONE: Self = Self {
        depth: 0.0,
        length: Curve::NONE,
        internal: 0.0,
        thrown: 0.0,
        shape: Curve::NONE,
    };

    /// Returns the mean of tables with equal weights.
    pub fn mean(mut parts: impl ExactSizeIterator<Item = Self> + Clone) -> Self {
        let weight = 1.0 / parts.len() as f32;
        let all = parts.clone();
        match parts.next() {
            Some(first) if parts.all(|part| part == first) => first,
            _ => Self::mixed(all.map(|part| (weight, part))),
        }
    }

    /// Returns the mean of tables with weights that sum to 1.
    pub fn mixed(mut parts: impl Iterator<Item = (f32, Self)>) -> Self {
        let Some((first_weight, first)) = parts.next() else {
            return Self::NONE;
        };
        if first_weight >= 1.0 {
            return first;
        }
        std::iter::once((first_weight, first)).chain(parts).fold(
            Self::NONE,
            |sum, (weight, part)| Self {
                depth: sum.depth + weight * part.depth,
                length: sum.length.plus(part.length, weight),
                internal: sum.internal + weight * part.internal,
                thrown: sum.thrown + weight * part.thrown,
                shape: sum.shape.plus(part.shape, weight),
            },
        )
    }
}

/// The light of a walk, by the number of scattering events.
type Orders = [f32; ORDERS];

/// Returns Σ_k ϖ^k S_k.
fn at_albedo(orders: &Orders, albedo: f32) -> f32 {
    orders
        .iter()
        .rev()
        .fold(0.0, |sum, part| sum * albedo + part)
}

/// A layer of optical depth τ whose scattering has the mean cosine g.
pub struct Slab {
    interface: Interface,
    depth: f32,
    g: f32,
}

/// The fractions of light that arrives from outside.
struct Arriving {
    /// T: the fraction that enters.
    entering: f32,
    /// B.
    base: Orders,
    /// E.
    thrown: Orders,
}

/// Light within the layer, travelling along `w`.
#[derive(Clone, Copy)]
struct Light {
    w: Vec3,
    part: f32,
    height: f32,
    order: usize,
}

/// A surface at which a walk ends.
#[derive(Clone, Copy, PartialEq)]
enum End {
    Base,
    Outside,
}

impl Slab {
    /// Makes a layer under the interface of `layer`.
    pub fn new(layer: &Layer, depth: f32, g: f32) -> Self {
        Self {
            interface: layer.interface,
            depth: depth.min(DEEPEST),
            g,
        }
    }

    /// Returns the tables for each of `albedos`. No walks are needed if nothing scatters.
    pub fn tables(&self, layer: &Layer, albedos: &[f32]) -> Vec<Filled> {
        let scatters = self.depth > 0.0 && albedos.iter().any(|&albedo| albedo > 0.0);
        let arriving = |cos| self.arriving(cos, scatters);
        let lengths = Curve::<LENGTHS>::cosines().map(arriving);
        let shapes = scatters.then(|| Curve::<SHAPES>::cosines().map(arriving));
        let internal = self.returning(scatters);
        let table = |&albedo: &f32| {
            let (depth, length) = length(&lengths, albedo);
            let (thrown, shape) = shapes
                .as_ref()
                .map_or((0.0, Curve::NONE), |shapes| shape(layer, shapes, albedo));
            Filled {
                depth,
                length,
                internal: at_albedo(&internal, albedo).clamp(0.0, 1.0),
                thrown,
                shape,
            }
        };
        albedos.iter().map(table).collect()
    }

    /// Returns T, B and E of light with cosine `cos`.
    fn arriving(&self, cos: f32, scatters: bool) -> Arriving {
        let mut sums = Arriving {
            entering: self.interface.transmittance(cos),
            base: [0.0; ORDERS],
            thrown: [0.0; ORDERS],
        };
        sums.base[0] = self.interface.mean(cos, FACETS, |split| {
            split
                .refracted
                .map_or(0.0, |(w, part)| part * libm::expf(-self.depth / w.z.abs()))
        });
        if !scatters {
            return sums;
        }
        let wo = Vec3::new(safe_sqrt(1.0 - sqr(cos)), 0.0, cos);
        for stream in streams(WALKS) {
            let u = stream.get_2d(Dimension::at(0, Purpose::LightDirection));
            let Some((w, part)) = self.interface.split(wo, u).refracted else {
                continue;
            };
            let light = self.scattered_once(w, part, &stream);
            self.walk(light, &stream, |end, order, part| {
                let orders = match end {
                    End::Base => &mut sums.base,
                    End::Outside => &mut sums.thrown,
                };
                orders[order] += part / WALKS as f32;
            });
        }
        sums
    }

    /// Returns light that came through the interface along `w`, after its first scattering event.
    fn scattered_once(&self, w: Vec3, part: f32, stream: &SampleStream) -> Light {
        let least = libm::expf(-self.depth / w.z.abs());
        let u = stream.get_1d(Dimension::at(0, Purpose::Roulette));
        let flight = -libm::logf(1.0 - u * (1.0 - least)) * w.z.abs();
        let u = stream.get_2d(Dimension::at(0, Purpose::Lens));
        Light {
            w: henyey_greenstein(w, self.g, u),
            part: part * (1.0 - least),
            height: (self.depth - flight).max(0.0),
            order: 1,
        }
    }

    /// Returns R.
    fn returning(&self, scatters: bool) -> Orders {
        let left = |cos: f32| libm::expf(-self.depth / cos.abs());
        let mut sums = [0.0; ORDERS];
        let mut clear = 0.0;
        for index in 0..POINTS {
            let [cos2, x, y] = even_point(index);
            let w = Vec3::new(safe_sqrt(1.0 - cos2), 0.0, -cos2.sqrt());
            let u = Vec2::new(x, y);
            if let Some((back, part)) = self.interface.split(w, u).reflected {
                clear += f64::from(part * left(w.z) * left(back.z));
            }
        }
        sums[0] = (clear / POINTS as f64) as f32;
        if !scatters {
            return sums;
        }
        for stream in streams(WALKS) {
            let u = stream.get_2d(Dimension::at(0, Purpose::LightDirection));
            let light = Light {
                w: warp::cosine_hemisphere(u),
                part: 1.0,
                height: 0.0,
                order: 0,
            };
            self.walk(light, &stream, |end, order, part| {
                if end == End::Base && order > 0 {
                    sums[order] += part / WALKS as f32;
                }
            });
        }
        sums
    }

    /// Follows light until it reaches the base. Calls `count` for the light that reaches it, and for light that
    /// leaves.
    fn walk(
        &self,
        mut light: Light,
        stream: &SampleStream,
        mut count: impl FnMut(End, usize, f32),
    ) {
        for step in 1..MOST {
            let u = stream.get_1d(Dimension::at(step, Purpose::Roulette));
            let flight = -libm::logf(1.0 - u);
            let height = light.height + flight * light.w.z;
            if height > 0.0 && height < self.depth {
                let u = stream.get_2d(Dimension::at(step, Purpose::Lens));
                light = Light {
                    w: henyey_greenstein(light.w, self.g, u),
                    height,
                    order: (light.order + 1).min(ORDERS - 1),
                    ..light
                };
                continue;
            }
            if light.w.z <= 0.0 {
                return count(End::Base, light.order, light.part);
            }
            let u = stream.get_2d(Dimension::at(step, Purpose::LightDirection));
            let split = self.interface.split(-light.w, u);
            if let Some((_, share)) = split.refracted {
                count(End::Outside, light.order, light.part * share);
            }
            let Some((w, share)) = split.reflected else {
                return;
            };
            light = Light {
                w,
                part: light.part * share,
                height: self.depth,
                ..light
            };
        }
    }
}

/// Returns D and ℓ, of a curve through `arriving`.
fn length(arriving: &[Arriving; LENGTHS], albedo: f32) -> (f32, Curve<LENGTHS>) {
    let depth = |arriving: &Arriving| {
        let left = at_albedo(&arriving.base, albedo) / arriving.entering.max(1e-6);
        -libm::logf(left.clamp(1e-12, 1.0))
    };
    let depths = Curve::through(std::array::from_fn(|i| depth(&arriving[i])));
    let mean = depths.mean();
    if mean > 1e-6 {
        (mean, depths.scaled(1.0 / mean))
    } else {
        (0.0, Curve::ONE)
    }
}

/// Returns Ē and e, of a curve through `arriving`.
fn shape(layer: &Layer, arriving: &[Arriving; SHAPES], albedo: f32) -> (f32, Curve<SHAPES>) {
    let ratio =
        |arriving: &Arriving| at_albedo(&arriving.thrown, albedo) / arriving.entering.max(1e-6);
    let ratios = Curve::through(std::array::from_fn(|i| ratio(&arriving[i])));
    let thrown = mean(64, |cos| layer.transmittance(cos) * ratios.at(cos));
    if thrown > 1e-6 {
        (thrown, ratios.scaled(1.0 / thrown))
    } else {
        (0.0, Curve::NONE)
    }
}

/// Returns a point of a Kronecker sequence, which fills the unit cube evenly: multiples of the powers of 1/φ,
/// φ⁴ = φ + 1.
fn even_point(index: u32) -> [f32; 3] {
    const STEPS: [f64; 3] = [
        0.819_172_513_396_164_4,
        0.671_043_606_703_789_2,
        0.549_700_477_901_970_3,
    ];
    STEPS.map(|step| ((f64::from(index) + 0.5) * step).fract() as f32)
}

/// Returns the random numbers of `n` walks.
fn streams(n: u64) -> impl Iterator<Item = SampleStream> {
    let sampler = Sampler::new(SamplerKind::Sobol, 0);
    (0..n).map(move |index| sampler.stream(Domain::Light, 0, index))
}

/// Draws the direction of light along `w` after scattering with the mean cosine `g`.
fn henyey_greenstein(w: Vec3, g: f32, u: Vec2) -> Vec3 {
    let g = g.clamp(-0.999, 0.999);
    let cos = if g.abs() < 1e-3 {
        1.0 - 2.0 * u.x
    } else {
        (1.0 + sqr(g) - sqr((1.0 - sqr(g)) / (1.0 + g - 2.0 * g * u.x))) / (2.0 * g)
    };
    let (sin_phi, cos_phi) = sin_cos(2.0 * PI * u.y);
    let sin = safe_sqrt(1.0 - sqr(cos));
    Frame::from_z(w).to_world(Vec3::new(sin * cos_phi, sin * sin_phi, cos))
}

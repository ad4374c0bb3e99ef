//! Random numbers as a pure function of their use.
//!
//! The address of a number is (seed, [`Domain`], stream, index, [`Dimension`]). It depends on nothing else: no state,
//! no thread, no task. Hence a single sample can be replayed, a render can stop and go on, and any split of the work
//! gives the same bits.
//!
//! - Camera sample of pass `p` at pixel `q`: stream `q`, index `p`.
//! - Its light path: member `q` of a [family](Sampler::member), index `p`. The light paths of a pass are stratified
//!   over the light, for the light image, and those of a pixel over its passes, for connections.
//!
//! Any range of indices is exact; ranges aligned to powers of two are also well stratified.

mod dimension;
mod hash;
mod sobol;

pub use dimension::{Dimension, Purpose};

use crate::math::{ONE_MINUS_EPSILON, Vec2};
use crate::names::named;
use hash::mix;
use sobol::Digits;

/// The relation of the numbers of a stream.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SamplerKind {
    /// Independent numbers, for statistics.
    Independent,
    /// Owen-scrambled Sobol' points, two dimensions at a time, each pair with its own shuffle \[Burley20\], for
    /// pictures.
    #[default]
    Sobol,
}

named!(SamplerKind {
    "independent" => Independent,
    "sobol" => Sobol,
});

/// The use of a stream; streams of different domains are unrelated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Domain {
    /// Camera subpaths of the image.
    Camera,
    /// Light subpaths of the image.
    Light,
    /// Camera subpaths of the training render, which never enter the film.
    TrainingCamera,
    /// Light subpaths of the training render, which never enter the film.
    TrainingLight,
}

/// Returns point `k` of the Kronecker sequence that begins with `u`: u + k (1 ∕ φ, 1 ∕ φ²) modulo 1, where φ³ = φ +
/// 1. If `u` is uniform, each point is, and together they fill the square evenly.
#[inline]
pub fn kronecker_point(u: Vec2, k: u16) -> Vec2 {
    const STEP: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3];
    let moved = |x: f32, step: f64| (f64::from(x) + f64::from(k) * step).fract() as f32;
    let point = Vec2::new(moved(u.x, STEP[0]), moved(u.y, STEP[1]));
    point.min(Vec2::splat(ONE_MINUS_EPSILON))
}

/// Returns number `k` of the sequence u + k / φ modulo 1, φ² = φ + 1: a third coordinate of [`kronecker_point`]s.
#[inline]
pub fn kronecker_number(u: f32, k: u16) -> f32 {
    const STEP: f64 = 0.618_033_988_749_894_8;
    let moved = (f64::from(u) + f64::from(k) * STEP).fract() as f32;
    moved.min(ONE_MINUS_EPSILON)
}

/// The source of all streams of a render.
#[derive(Clone, Copy, Debug)]
pub struct Sampler {
    kind: SamplerKind,
    seed: u64,
}

impl Sampler {
    /// Makes a sampler; different seeds give unrelated renders.
    pub fn new(kind: SamplerKind, seed: u64) -> Self {
        Self { kind, seed }
    }

    /// Returns the numbers of point `index` of a stream, which is unrelated to other streams.
    #[inline]
    pub fn stream(&self, domain: Domain, stream: u64, index: u64) -> SampleStream {
        let key = mix(self.key(domain) ^ stream);
        match self.kind {
            SamplerKind::Independent => SampleStream::independent(key, index),
            // A sequence has 2³² points; later points are from another sequence.
            SamplerKind::Sobol => SampleStream {
                source: Source::Sequence(reversed(index)),
                key: mix(key ^ (index >> 32)),
            },
        }
    }

    /// Returns the numbers of point `index` of one of many streams that complement each other: the points
    /// of a member are stratified over the indices, and the points of an index over the members.
    ///
    /// A point is S(index) ⊕ S'(member), digit by digit: a digital shift keeps the evenness of either sequence.
    #[inline]
    pub fn member(&self, domain: Domain, member: u64, index: u64) -> SampleStream {
        let key = self.key(domain);
        match self.kind {
            SamplerKind::Independent => SampleStream::independent(mix(key ^ member), index),
            SamplerKind::Sobol => SampleStream {
                source: Source::Product(reversed(index), reversed(member)),
                key: mix(mix(key ^ (index >> 32)) ^ (member >> 32)),
            },
        }
    }

    #[inline]
    fn key(&self, domain: Domain) -> u64 {
        mix(self.seed ^ mix(domain as u64 + 1))
    }
}

/// Returns the low 32 bits of an index in reverse order.
#[inline]
fn reversed(index: u64) -> u32 {
    (index as u32).reverse_bits()
}

/// The source of a stream's numbers.
#[derive(Clone, Copy, Debug)]
enum Source {
    /// A hash of the key.
    Independent,
    /// The point of a sequence: its index, in reverse order.
    Sequence(u32),
    /// The sum of points of two sequences: their indices, in reverse order.
    Product(u32, u32),
}

/// The random numbers of one sample, addressed by dimension.
#[derive(Clone, Copy, Debug)]
pub struct SampleStream {
    source: Source,
    key: u64,
}

impl SampleStream {
    #[inline]
    fn independent(key: u64, index: u64) -> Self {
        Self {
            source: Source::Independent,
            key: mix(key ^ mix(index)),
        }
    }

    /// Returns the number of `dimension`. Range: `[0, 1)`.
    #[inline]
    pub fn get_1d(&self, dimension: Dimension) -> f32 {
        unit(self.get_bits(dimension))
    }

    /// Returns the number of `dimension`. Unit: 2⁻³². [`get_1d`](Self::get_1d) is its upper 24 bits.
    #[inline]
    pub fn get_bits(&self, dimension: Dimension) -> u32 {
        let key = mix(self.key ^ dimension.key());
        match self.source {
            Source::Independent => key as u32,
            Source::Sequence(index) => Digits::new(index, key).x(),
            Source::Product(index, member) => Digits::moved(index, member, key).x(),
        }
    }

    /// Returns the number of `dimension` for one of many items without an order, each with its own key. The numbers
    /// of different items are unrelated. Range: `[0, 1)`.
    #[inline]
    pub fn get_for(&self, dimension: Dimension, key: u64) -> f32 {
        // The hashes are nested: their sum would cancel if key and index are equal.
        let of_dimension = mix(self.key ^ dimension.key());
        let of_sample = match self.source {
            Source::Independent => of_dimension,
            Source::Sequence(index) => mix(of_dimension ^ u64::from(index)),
            Source::Product(index, member) => {
                mix(of_dimension ^ (u64::from(index) << 32 | u64::from(member)))
            }
        };
        unit(mix(of_sample ^ key) as u32)
    }

    /// Returns the pair of numbers of `dimension`. Range: `[0, 1)²`.
    #[inline]
    pub fn get_2d(&self, dimension: Dimension) -> Vec2 {
        let key = mix(self.key ^ dimension.key());
        let digits = match self.source {
            Source::Independent => {
                return Vec2::new(unit(key as u32), unit((key >> 32) as u32));
            }
            Source::Sequence(index) => Digits::new(index, key),
            Source::Product(index, member) => Digits::moved(index, member, key),
        };
        let [x, y] = digits.xy();
        Vec2::new(unit(x), unit(y))
    }
}

/// Returns the upper 24 bits as a number of `[0, 1)`: exact in `f32`, never rounded up to 1.
#[inline]
fn unit(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / 16_777_216.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const DIMENSION: Dimension = Dimension::at(3, Purpose::Scatter);

    /// Checks that the points `begin .. begin + 2^log2_n` of a stream have exactly one point in
    /// every elementary interval of area 2^-log2_n.
    #[track_caller]
    fn check_elementary_intervals(begin: u64, log2_n: u32, stream: impl Fn(u64) -> SampleStream) {
        let n = 1u64 << log2_n;
        for log2_columns in 0..=log2_n {
            let (columns, rows) = (1u64 << log2_columns, 1u64 << (log2_n - log2_columns));
            let mut seen = vec![false; n as usize];
            for index in begin..begin + n {
                let p = stream(index).get_2d(DIMENSION);
                let cell = (p.y * rows as f32) as u64 * columns + (p.x * columns as f32) as u64;
                let was_seen = std::mem::replace(&mut seen[cell as usize], true);
                assert!(!was_seen, "{columns}x{rows}");
            }
        }
    }

    #[test]
    fn aligned_ranges_are_nets() {
        let sampler = Sampler::new(SamplerKind::Sobol, 7);
        let stream = |index| sampler.stream(Domain::Camera, 5, index);
        let far = (1 << 40) + (5 << 10);
        for (begin, log2_n) in [(0, 8), (3 << 8, 8), (1 << 20, 10), (far, 10)] {
            check_elementary_intervals(begin, log2_n, stream);
            check_elementary_intervals(begin, log2_n, |i| sampler.member(Domain::Light, 9, i));
            check_elementary_intervals(begin, log2_n, |i| sampler.member(Domain::Light, i, 9));
        }
    }

    #[test]
    fn numbers_beyond_two_to_the_32_differ_from_those_below() {
        let sampler = Sampler::new(SamplerKind::Sobol, 1);
        let at = |index| sampler.stream(Domain::Light, 0, index).get_2d(DIMENSION);
        assert_ne!(at(17), at(17 + (1 << 32)));
    }

    /// Checks the mean and the variance of a uniform number, and its correlation with another's.
    #[track_caller]
    fn check_moments(draw: impl Fn(u64) -> (f32, f32)) {
        let n = 1u64 << 16;
        let (mut mean, mut square, mut product) = (0.0, 0.0, 0.0);
        for i in 0..n {
            let (a, b) = draw(i);
            let (a, b) = (f64::from(a) - 0.5, f64::from(b) - 0.5);
            mean += a / n as f64;
            square += a * a / n as f64;
            product += a * b / n as f64;
        }
        // Five standard deviations of the mean of n independent numbers.
        let bound = 5.0 * (1.0 / 12.0 / n as f64).sqrt();
        assert!(mean.abs() < bound, "mean {mean}");
        assert!((square - 1.0 / 12.0).abs() < bound, "variance {square}");
        assert!(product.abs() < bound, "covariance {product}");
    }

    #[test]
    fn numbers_for_things_are_uniform_and_unrelated() {
        for kind in [SamplerKind::Independent, SamplerKind::Sobol] {
            let sampler = Sampler::new(kind, 3);
            let stream = |index| sampler.stream(Domain::Camera, 9, index);
            let get = |index, dimension, key| stream(index).get_for(dimension, key);
            let other = Dimension::at(4, Purpose::Alpha);
            check_moments(|i| (get(i, DIMENSION, 1), get(i, DIMENSION, 2)));
            check_moments(|i| (get(7, DIMENSION, i), get(8, DIMENSION, i)));
            check_moments(|i| (get(i, DIMENSION, 5), get(i, other, 5)));
            check_moments(|i| (get(i, DIMENSION, i), get(i + 1, DIMENSION, i)));
        }
    }

    #[test]
    fn numbers_are_uniform_and_unrelated_across_every_part_of_the_address() {
        for kind in [SamplerKind::Independent, SamplerKind::Sobol] {
            let sampler = Sampler::new(kind, 3);
            let get = |domain, stream, index, dimension: Dimension| {
                sampler.stream(domain, stream, index).get_1d(dimension)
            };
            let other = Dimension::at(4, Purpose::Scatter);
            let base = |i| get(Domain::Camera, 9, i, DIMENSION);
            check_moments(|i| (base(i), get(Domain::Camera, 9, i, other)));
            check_moments(|i| (base(i), get(Domain::Camera, 10, i, DIMENSION)));
            check_moments(|i| (base(i), get(Domain::Light, 9, i, DIMENSION)));
            check_moments(|i| (get(Domain::Camera, i, 4, DIMENSION), base(i)));
            let seeded = |i| Sampler::new(kind, 4).stream(Domain::Camera, 9, i);
            let member = |member, index, dimension| {
                let stream = sampler.member(Domain::Light, member, index);
                stream.get_1d(dimension)
            };
            check_moments(|i| (member(i, 3, DIMENSION), member(i, 3, other)));
            check_moments(|i| (member(3, i, DIMENSION), member(3, i, other)));
            check_moments(|i| (base(i), seeded(i).get_1d(DIMENSION)));
        }
    }
}

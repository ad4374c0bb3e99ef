//! Gradient noise on a lattice \[Perlin02\], its sums over octaves, and marble.
//!
//! The constants are those of pbrt-v4, whose scenes were made with them. Octaves finer than a pixel are left out; the
//! last one fades out.

use super::{TexturePoint, TextureSpace};
use crate::math::{Vec3, sin_cos};
use crate::spectrum::Rgb;

/// Perlin's permutation of the numbers from 0 to 255 \[Perlin02\].
const PERMUTATION: [u8; 256] = [
    151, 160, 137, 91, 90, 15, 131, 13, 201, 95, 96, 53, 194, 233, 7, 225, 140, 36, 103, 30, 69,
    142, 8, 99, 37, 240, 21, 10, 23, 190, 6, 148, 247, 120, 234, 75, 0, 26, 197, 62, 94, 252, 219,
    203, 117, 35, 11, 32, 57, 177, 33, 88, 237, 149, 56, 87, 174, 20, 125, 136, 171, 168, 68, 175,
    74, 165, 71, 134, 139, 48, 27, 166, 77, 146, 158, 231, 83, 111, 229, 122, 60, 211, 133, 230,
    220, 105, 92, 41, 55, 46, 245, 40, 244, 102, 143, 54, 65, 25, 63, 161, 1, 216, 80, 73, 209, 76,
    132, 187, 208, 89, 18, 169, 200, 196, 135, 130, 116, 188, 159, 86, 164, 100, 109, 198, 173,
    186, 3, 64, 52, 217, 226, 250, 124, 123, 5, 202, 38, 147, 118, 126, 255, 82, 85, 212, 207, 206,
    59, 227, 47, 16, 58, 17, 182, 189, 28, 42, 223, 183, 170, 213, 119, 248, 152, 2, 44, 154, 163,
    70, 221, 153, 101, 155, 167, 43, 172, 9, 129, 22, 39, 253, 19, 98, 108, 110, 79, 113, 224, 232,
    178, 185, 112, 104, 218, 246, 97, 228, 251, 34, 242, 193, 238, 210, 144, 12, 191, 179, 162,
    241, 81, 51, 145, 235, 249, 14, 239, 107, 49, 192, 214, 31, 181, 199, 106, 157, 184, 84, 204,
    176, 115, 121, 50, 45, 127, 4, 150, 254, 138, 236, 205, 93, 222, 114, 67, 29, 24, 72, 243, 141,
    128, 195, 78, 66, 215, 61, 156, 180,
];

/// The gradients at lattice points: they point to the middles of a cube's edges, some of them twice.
const GRADIENTS: [Vec3; 16] = [
    Vec3::new(1.0, 1.0, 0.0),
    Vec3::new(-1.0, 1.0, 0.0),
    Vec3::new(1.0, -1.0, 0.0),
    Vec3::new(-1.0, -1.0, 0.0),
    Vec3::new(1.0, 0.0, 1.0),
    Vec3::new(-1.0, 0.0, 1.0),
    Vec3::new(1.0, 0.0, -1.0),
    Vec3::new(-1.0, 0.0, -1.0),
    Vec3::new(0.0, 1.0, 1.0),
    Vec3::new(0.0, -1.0, 1.0),
    Vec3::new(0.0, 1.0, -1.0),
    Vec3::new(0.0, -1.0, -1.0),
    Vec3::new(1.0, 1.0, 0.0),
    Vec3::new(-1.0, 1.0, 0.0),
    Vec3::new(0.0, 1.0, -1.0),
    Vec3::new(0.0, -1.0, -1.0),
];

/// Returns a smooth function of space between about -1 and 1, 0 at whole numbers, with features of size 1.
pub(super) fn noise(p: Vec3) -> f32 {
    let cell = p.floor();
    let within = p - cell;
    // Only the last eight bits of these whole numbers matter; infinity and NaN become some number.
    let corner = [cell.x, cell.y, cell.z].map(|x| x as i64);
    let permuted = |x: i64| i64::from(PERMUTATION[(x & 255) as usize]);
    let gradient = |offset: [i64; 3]| {
        let [x, y, z] = [0, 1, 2].map(|axis| corner[axis] + offset[axis]);
        let hash = permuted(permuted(permuted(x) + y) + z);
        let from_corner = within - Vec3::from(offset.map(|x| x as f32));
        GRADIENTS[(hash & 15) as usize].dot(from_corner)
    };
    let weight = within * within * within * (within * (within * 6.0 - 15.0) + 10.0);
    let along_x = |y, z| lerp(gradient([0, y, z]), gradient([1, y, z]), weight.x);
    let along_y = |z| lerp(along_x(0, z), along_x(1, z), weight.y);
    lerp(along_y(0), along_y(1), weight.z)
}

#[inline]
fn lerp(a: f32, b: f32, t: f32) -> f32 {
    a * (1.0 - t) + b * t
}

/// The ratio of the frequencies of successive octaves, λ.
const LACUNARITY: f32 = 1.99;

/// Octaves of noise. The amplitude of each is `gain` times that of the one before.
#[derive(Clone, Copy, Debug)]
struct Octaves {
    count: u32,
    gain: f32,
}

impl Octaves {
    /// Returns Σ gain^i · `shape`(noise(λ^i p)) for a pixel of width `width`. An octave that is left out counts as
    /// `mean`.
    fn sum(self, p: Vec3, width: f32, mean: f32, shape: impl Fn(f32) -> f32) -> f32 {
        let most = self.count as f32;
        let visible = if width > 0.0 {
            (-1.0 - libm::log2f(width)).clamp(0.0, most)
        } else {
            most
        };
        let (mut sum, mut frequency, mut amplitude) = (0.0, 1.0, 1.0);
        for octave in 0..self.count {
            let part = smoothstep(visible - octave as f32);
            let value = if part > 0.0 {
                lerp(mean, shape(noise(p * frequency)), part)
            } else {
                mean
            };
            sum += amplitude * value;
            frequency *= LACUNARITY;
            amplitude *= self.gain;
        }
        sum
    }
}

/// Returns a function that rises smoothly from 0 below 0.3 to 1 above 0.7.
#[inline]
fn smoothstep(x: f32) -> f32 {
    let t = ((x - 0.3) / 0.4).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Returns Σ ωⁱ noise(λⁱ p) over all `octaves`, with ω = `roughness`.
pub fn fractal_noise(p: Vec3, octaves: u32, roughness: f32) -> f32 {
    let octaves = Octaves {
        count: octaves,
        gain: roughness,
    };
    fbm(octaves, p, 0.0)
}

fn fbm(octaves: Octaves, p: Vec3, width: f32) -> f32 {
    octaves.sum(p, width, 0.0, |value| value)
}

/// The functions made of noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoiseKind {
    /// Σ ωⁱ noise(λⁱ p).
    Fbm {
        /// The number of octaves.
        octaves: u32,
        /// ω.
        roughness: f32,
    },
    /// Σ ωⁱ |noise(λⁱ p)|.
    Wrinkled {
        /// The number of octaves.
        octaves: u32,
        /// ω.
        roughness: f32,
    },
    /// Waves whose height varies in space.
    Windy,
}

/// Noise in texture space.
#[derive(Clone, Copy, Debug)]
pub struct Noise {
    /// The function made of it.
    pub kind: NoiseKind,
    /// The space in which it is defined.
    pub space: TextureSpace,
}

impl Noise {
    pub(super) fn eval(&self, at: &TexturePoint) -> f32 {
        let (p, width) = (self.space.point(at), self.space.width(at));
        let of = |count, gain| Octaves { count, gain };
        match self.kind {
            NoiseKind::Fbm { octaves, roughness } => fbm(of(octaves, roughness), p, width),
            // The mean of |noise| is about 0.2.
            NoiseKind::Wrinkled { octaves, roughness } => {
                of(octaves, roughness).sum(p, width, 0.2, f32::abs)
            }
            NoiseKind::Windy => {
                let wind = fbm(of(3, 0.5), p * 0.1, width * 0.1);
                wind.abs() * fbm(of(6, 0.5), p, width)
            }
        }
    }
}

/// Layers along y, disturbed by noise.
#[derive(Clone, Copy, Debug)]
pub struct Marble {
    /// The number of octaves of the noise.
    pub octaves: u32,
    /// The factor between them.
    pub roughness: f32,
    /// The factor of the point.
    pub scale: f32,
    /// The strength of the noise.
    pub variation: f32,
    /// The space in which it is defined.
    pub space: TextureSpace,
}

/// The control points of the colour curve of marble.
const VEINS: [Rgb; 9] = [
    [0.58, 0.58, 0.6],
    [0.58, 0.58, 0.6],
    [0.58, 0.58, 0.6],
    [0.5, 0.5, 0.5],
    [0.6, 0.59, 0.58],
    [0.58, 0.58, 0.6],
    [0.58, 0.58, 0.6],
    [0.2, 0.2, 0.33],
    [0.58, 0.58, 0.6],
];

impl Marble {
    pub(super) fn eval(&self, at: &TexturePoint) -> Rgb {
        let p = self.space.point(at) * self.scale;
        let octaves = Octaves {
            count: self.octaves,
            gain: self.roughness,
        };
        let disturbed = p.y + self.variation * fbm(octaves, p, self.space.width(at) * self.scale);
        let segments = (VEINS.len() - 3) as f32;
        let along = (0.5 + 0.5 * sin_cos(disturbed).0) * segments;
        let segment = along.floor().clamp(0.0, segments - 1.0);
        let t = along - segment;
        let points = &VEINS[segment as usize..][..4];
        std::array::from_fn(|channel| 1.5 * bezier([0, 1, 2, 3].map(|i| points[i][channel]), t))
    }
}

/// Returns the point at `t` of a cubic Bézier curve, by repeated interpolation.
fn bezier([a, b, c, d]: [f32; 4], t: f32) -> f32 {
    let (ab, bc, cd) = (lerp(a, b, t), lerp(b, c, t), lerp(c, d, t));
    lerp(lerp(ab, bc, t), lerp(bc, cd, t), t)
}

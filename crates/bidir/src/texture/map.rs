//! Image textures: the texel at the point, or the interpolation of the four around it, in linear values; or the mean
//! of the texels that a pixel covers, from a smaller copy.

use super::{Image, Mapping, RequiredInputs, TexturePoint};
use crate::math::{Vec2, Vec3, sqr};
use std::sync::Arc;

/// The values beyond an image's borders.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// The values beyond the borders of s, and of t.
    Axes([Beyond; 2]),
    /// The neighbours on the sphere, for an octahedral map: the other half of the same border, mirrored.
    OctahedralSphere,
}

/// The values beyond the borders of one coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beyond {
    /// The image again.
    Repeat,
    /// The image mirrored, then again.
    Mirror,
    /// The border's texel.
    Clamp,
    /// Zero.
    Black,
}

impl Wrap {
    /// Makes the same choice for all borders.
    pub const fn all(beyond: Beyond) -> Self {
        Self::Axes([beyond; 2])
    }
}

/// The interpolation of texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImageFilter {
    /// The texel that the point lies in.
    Point,
    /// Interpolation between the four nearest texel centres.
    Bilinear,
    /// Bilinear interpolation in the two smaller copies whose texels are about as wide as a pixel, and between them;
    /// in the image itself if it has no copies.
    Trilinear,
}

/// A change of the values of texels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Change {
    /// Texels are multiplied by the scale.
    Scale(f32),
    /// Texels are multiplied by the scale and subtracted from 1, but not below 0.
    ScaleAndInvert(f32),
}

/// An image laid over (s, t); t = 1 is the top row.
#[derive(Clone, Debug)]
pub struct ImageMap<const N: usize> {
    /// The texels, shared between textures.
    pub image: Arc<Image<N>>,
    /// The values beyond the border.
    pub wrap: Wrap,
    /// The interpolation of texels.
    pub filter: ImageFilter,
    /// The change of values.
    pub change: Change,
    /// The mapping from the surface to (s, t).
    pub mapping: Mapping,
}

impl<const N: usize> ImageMap<N> {
    pub(super) fn needs(&self) -> RequiredInputs {
        let own = match self.filter {
            ImageFilter::Point | ImageFilter::Bilinear => RequiredInputs::NOTHING,
            ImageFilter::Trilinear => RequiredInputs {
                surface: false,
                footprint: true,
            },
        };
        own.and(self.mapping.needs())
    }

    /// Returns the value at a point.
    #[inline]
    pub fn eval(&self, at: &TexturePoint) -> [f32; N] {
        let upwards = self.mapping.st(at);
        let st = Vec2::new(upwards.x, 1.0 - upwards.y);
        let value = match self.filter {
            ImageFilter::Point => {
                let texel = countable(st * size(&self.image)).floor();
                self.fetch(&self.image, texel.x as i64, texel.y as i64)
            }
            ImageFilter::Bilinear => self.bilinear(&self.image, st),
            ImageFilter::Trilinear => self.trilinear(st, self.level(at)),
        };
        match self.change {
            Change::Scale(scale) => value.map(|value| value * scale),
            Change::ScaleAndInvert(scale) => value.map(|value| (1.0 - value * scale).max(0.0)),
        }
    }

    /// Returns the level of the copy whose texels are as wide as a pixel, as a real number.
    ///
    /// If texels are not square on the surface, their longer side counts, so that the texture is never coarser than a
    /// pixel. The pixel's samples average the rest.
    fn level(&self, at: &TexturePoint) -> f32 {
        let [s, t] = self.mapping.gradients(at);
        let texels = size(&self.image) * at.footprint.width;
        let least = least_stretch2(s * texels.x, t * texels.y);
        // The image itself is used for one texel or less, or if the gradients are unknown.
        if least > 1.0 {
            0.5 * libm::log2f(least)
        } else {
            0.0
        }
    }

    fn trilinear(&self, st: Vec2, level: f32) -> [f32; N] {
        let coarsest = self.image.copies();
        let level = level.min(coarsest as f32);
        let below = level.floor();
        let (fine, part) = (below as usize, level - below);
        let value = self.bilinear(self.image.copy(fine), st);
        if part == 0.0 {
            return value;
        }
        let coarse = self.bilinear(self.image.copy(fine + 1), st);
        std::array::from_fn(|channel| value[channel] * (1.0 - part) + coarse[channel] * part)
    }

    #[inline]
    fn bilinear(&self, image: &Image<N>, st: Vec2) -> [f32; N] {
        let place = countable(st * size(image)) - 0.5;
        let first = place.floor();
        let f = place - first;
        let (i, j) = (first.x as i64, first.y as i64);
        let [a, b, c, d] =
            [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)].map(|(x, y)| self.fetch(image, x, y));
        std::array::from_fn(|channel| {
            let top = a[channel] * (1.0 - f.x) + b[channel] * f.x;
            let bottom = c[channel] * (1.0 - f.x) + d[channel] * f.x;
            top * (1.0 - f.y) + bottom * f.y
        })
    }

    #[inline]
    fn fetch(&self, image: &Image<N>, x: i64, y: i64) -> [f32; N] {
        let (width, height) = (image.width() as i64, image.height() as i64);
        // Most texels are inside, and divisions are slow.
        if (0..width).contains(&x) && (0..height).contains(&y) {
            return image.texel(x as usize, y as usize);
        }
        let inside = match self.wrap {
            Wrap::Axes([s, t]) => s.index(x, width).zip(t.index(y, height)),
            Wrap::OctahedralSphere => Some(octahedral([x, y], [width, height])),
        };
        inside.map_or([0.0; N], |(x, y)| image.texel(x as usize, y as usize))
    }
}

impl Beyond {
    /// Returns the index, among `count` texels of a row, of the texel at `i`. None: the value is zero.
    #[inline]
    fn index(self, i: i64, count: i64) -> Option<i64> {
        match self {
            Self::Repeat => Some(i.rem_euclid(count)),
            Self::Mirror => {
                let i = i.rem_euclid(2 * count);
                Some(i.min(2 * count - 1 - i))
            }
            Self::Clamp => Some(i.clamp(0, count - 1)),
            Self::Black => (0..count).contains(&i).then_some(i),
        }
    }
}

#[inline]
fn size<const N: usize>(image: &Image<N>) -> Vec2 {
    Vec2::new(image.width() as f32, image.height() as f32)
}

/// Clamps a position among texels, so that whole numbers can count it, with room for sums.
#[inline]
fn countable(place: Vec2) -> Vec2 {
    place.clamp(Vec2::splat(-1e15), Vec2::splat(1e15))
}

/// Returns the texel of an octahedral map at (`x`, `y`). A step over a border mirrors the coordinate along the
/// border, and continues inwards. Two such steps along an axis lead back.
fn octahedral([x, y]: [i64; 2], [width, height]: [i64; 2]) -> (i64, i64) {
    let crossings = x.div_euclid(width) + y.div_euclid(height);
    let (x, y) = (x.rem_euclid(width), y.rem_euclid(height));
    if crossings.rem_euclid(2) == 0 {
        (x, y)
    } else {
        (width - 1 - x, height - 1 - y)
    }
}

/// Returns the square of the smaller singular value of the matrix with rows `s` and `t`: the stretch along the
/// direction that it stretches least.
fn least_stretch2(s: Vec3, t: Vec3) -> f32 {
    let (a, b, c) = (s.length_squared(), s.dot(t), t.length_squared());
    let spread = (sqr(a - c) + 4.0 * sqr(b)).sqrt();
    // The product of both singular values is the area; the larger one loses no digits.
    s.cross(t).length_squared() / ((a + c + spread) / 2.0)
}

//! Bounds of the values of a number texture. Samples at points cannot give them, because the texture may have other
//! values between them.

use super::map::{Change, ImageMap, Wrap};
use super::{Beyond, Bilerp, FloatTexture, Mix, Texture};

/// Numbers between two bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// The lower bound.
    pub least: f32,
    /// The upper bound.
    pub most: f32,
}

impl Range {
    /// Any number.
    pub const ALL: Self = Self {
        least: f32::MIN,
        most: f32::MAX,
    };

    /// Makes the range of one number.
    pub const fn of(value: f32) -> Self {
        Self {
            least: value,
            most: value,
        }
    }

    /// Makes the smallest range around these numbers, of which there is at least one.
    fn around(values: impl IntoIterator<Item = f32>) -> Self {
        let empty = Self {
            least: f32::INFINITY,
            most: f32::NEG_INFINITY,
        };
        values.into_iter().fold(empty, |range, value| Self {
            least: range.least.min(value),
            most: range.most.max(value),
        })
    }

    /// Returns the smallest range around both.
    fn and(self, other: Self) -> Self {
        Self::around([self.least, self.most, other.least, other.most])
    }

    /// Returns the range of the products of numbers in both ranges.
    #[must_use]
    pub fn times(self, other: Self) -> Self {
        let [a, b] = [self.least, self.most];
        let [c, d] = [other.least, other.most];
        Self::around([a * c, a * d, b * c, b * d])
    }

    /// Returns the range of `rising` over it, for a function that never falls.
    #[must_use]
    pub fn map(self, rising: impl Fn(f32) -> f32) -> Self {
        Self {
            least: rising(self.least),
            most: rising(self.most),
        }
    }
}

impl FloatTexture {
    /// Returns bounds of its values at all points, not always the tightest.
    pub fn range(&self) -> Range {
        match self {
            Self::Constant(value) => Range::of(*value),
            Self::Image(map) => map.range(),
            Self::Scale(scale) => scale.texture.range().times(scale.factor.range()),
            Self::Mix(mix) => mix.range(),
            Self::DirectionMix(mix) => either(&mix.textures),
            Self::Bilerp(bilerp) => bilerp.range(),
            Self::Checkerboard(board) => either(&board.textures),
            Self::Dots(dots) => either(&dots.textures),
            Self::Noise(_) | Self::Marble(_) => Range::ALL,
        }
    }
}

fn either([first, second]: &[FloatTexture; 2]) -> Range {
    first.range().and(second.range())
}

impl Mix<f32> {
    fn range(&self) -> Range {
        let amount = self.amount.range();
        if !(amount.least >= 0.0 && amount.most <= 1.0) {
            return Range::ALL;
        }
        let [first, second] = self.textures.each_ref().map(Texture::range);
        // The mixture is linear in the amount: its bounds are at the ends.
        let with = |amount: f32| Range {
            least: first.least * (1.0 - amount) + second.least * amount,
            most: first.most * (1.0 - amount) + second.most * amount,
        };
        with(amount.least).and(with(amount.most))
    }
}

impl Bilerp<f32> {
    /// Returns bounds. Outside the unit square there are none, unless all corners are equal.
    fn range(&self) -> Range {
        let corners = Range::around(self.corners);
        if corners.least < corners.most {
            Range::ALL
        } else {
            corners
        }
    }
}

impl ImageMap<1> {
    /// Returns bounds by the texels: texels of smaller copies are means of these, and interpolated values are between
    /// them.
    fn range(&self) -> Range {
        let [[least], [most]] = self.image.bounds();
        let mut texels = Range { least, most };
        if matches!(self.wrap, Wrap::Axes(axes) if axes.contains(&Beyond::Black)) {
            texels = texels.and(Range::of(0.0));
        }
        match self.change {
            Change::Scale(scale) => texels.times(Range::of(scale)),
            Change::ScaleAndInvert(scale) => {
                let Range { least, most } = texels.times(Range::of(scale));
                Range {
                    least: (1.0 - most).max(0.0),
                    most: (1.0 - least).max(0.0),
                }
            }
        }
    }
}

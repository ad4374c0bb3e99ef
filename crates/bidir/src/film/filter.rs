//! h(x, y) = h_x(x) h_y(y) with ∫∫ h = 1: the pixel filter, 1/pixel².
//!
//! Offsets and pixels are drawn by |h|, and where h is negative their weight is too. The box and
//! the triangle are inverted in closed form, all others through a table of |h|. The cubic is that
//! of \[Mitchell88\].

use crate::math::{Distribution1d, ONE_MINUS_EPSILON, PI, Vec2, safe_sqrt, sqr};

/// The shape of a filter along one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FilterKind {
    /// Constant.
    Box,
    /// Falling linearly to zero at the radius.
    Triangle,
    /// A Gaussian of this standard deviation, lowered to reach zero at the radius.
    Gaussian {
        /// Standard deviation. Unit: pixels.
        sigma: f32,
    },
    /// The cubic of Mitchell and Netravali \[Mitchell88\], stretched to the radius.
    Mitchell {
        /// Blur.
        b: f32,
        /// Ringing.
        c: f32,
    },
    /// sinc windowed by another, wider sinc (Lanczos).
    Sinc {
        /// Cycles before the window ends.
        tau: f32,
    },
}

/// A pixel filter: the product of the same shape along x and y, normalised to ∫∫ h = 1.
#[derive(Clone, Debug)]
pub struct Filter {
    x: Axis,
    y: Axis,
}

impl Default for Filter {
    /// The box of one pixel.
    fn default() -> Self {
        Self::new(FilterKind::Box, Vec2::splat(0.5))
    }
}

impl Filter {
    /// A filter with half widths `radius`, positive. Unit: pixels.
    pub fn new(kind: FilterKind, radius: Vec2) -> Self {
        Self {
            x: Axis::new(kind, radius.x),
            y: Axis::new(kind, radius.y),
        }
    }

    /// The half widths. Unit: pixels.
    pub fn radius(&self) -> Vec2 {
        Vec2::new(self.x.radius, self.y.radius)
    }

    /// h at `offset` from the pixel's centre. Unit: 1/pixel².
    pub fn eval(&self, offset: Vec2) -> f32 {
        self.x.eval(offset.x) * self.y.eval(offset.y)
    }

    /// Draws an offset from the pixel's centre by |h|: the offset, and h divided by its density.
    #[inline]
    pub fn sample(&self, u: Vec2) -> (Vec2, f32) {
        let (x, weight_x) = self.x.sample(u.x);
        let (y, weight_y) = self.y.sample(u.y);
        (Vec2::new(x, y), weight_x * weight_y)
    }

    /// Draws a pixel q by |h(raster - q)| among all pixels whose filter reaches `raster`: its
    /// coordinates, and sign(h) · Σ|h|. None: none reaches it.
    #[inline]
    pub fn pick_pixel(&self, raster: Vec2, u: Vec2) -> Option<(i64, i64, f32)> {
        let (x, weight_x) = self.x.pick(raster.x, u.x)?;
        let (y, weight_y) = self.y.pick(raster.y, u.y)?;
        Some((x, y, weight_x * weight_y))
    }
}

/// A filter along one axis.
#[derive(Clone, Debug)]
struct Axis {
    shape: Shape,
    radius: f32,
    /// 1 / ∫ of the shape.
    normalisation: f32,
    /// |shape| in cells over [-radius, radius]; not used by kinds that are inverted in closed form.
    table: Distribution1d,
}

const TABLE_CELLS: usize = 512;
/// A filter wider than this is refused by readers; pixels are gathered into a buffer of this size.
const MAX_PIXELS: usize = 66;

impl Axis {
    fn new(kind: FilterKind, radius: f32) -> Self {
        let radius = radius.clamp(1e-3, 32.0);
        let shape = Shape::new(kind, radius);
        let position = |i: usize, n: usize| radius * (2.0 * i as f32 / n as f32 - 1.0);
        // Every cell gets the largest of five values, so that no part of h has density zero.
        let cell = |i: usize| {
            (0..=4)
                .map(|k| shape.eval(position(4 * i + k, 4 * TABLE_CELLS)).abs())
                .fold(0.0, f32::max)
        };
        let n = 16_384;
        let sum: f64 = (0..n)
            .map(|i| f64::from(shape.eval(position(2 * i + 1, 2 * n))))
            .sum();
        let integral = match kind {
            FilterKind::Box => 2.0 * radius,
            FilterKind::Triangle => sqr(radius),
            _ => (sum / n as f64) as f32 * 2.0 * radius,
        };
        let table = Distribution1d::new((0..TABLE_CELLS).map(cell));
        Self {
            shape,
            radius,
            normalisation: 1.0 / integral,
            table,
        }
    }

    #[inline]
    fn eval(&self, x: f32) -> f32 {
        self.shape.eval(x) * self.normalisation
    }

    #[inline]
    fn sample(&self, u: f32) -> (f32, f32) {
        match self.shape.kind {
            FilterKind::Box => ((2.0 * u - 1.0) * self.radius, 1.0),
            FilterKind::Triangle => (tent(u) * self.radius, 1.0),
            _ => {
                let (p, pdf, _) = self.table.sample_continuous(u);
                let x = (2.0 * p - 1.0) * self.radius;
                (x, self.eval(x) * 2.0 * self.radius / pdf)
            }
        }
    }

    #[inline]
    fn pick(&self, x: f32, u: f32) -> Option<(i64, f32)> {
        // A pixel's centre lies at q + 1/2. The interval is half open, so that a box of one pixel
        // always reaches exactly one.
        let first = floor(x - 0.5 - self.radius) + 1;
        let last = floor(x - 0.5 + self.radius);
        if first == last {
            let value = self.eval(x - 0.5 - first as f32);
            return (value != 0.0).then_some((first, value));
        }
        let mut values = [0.0f32; MAX_PIXELS];
        let values = &mut values[..usize::try_from(last - first + 1).ok()?.min(MAX_PIXELS)];
        let mut sum = 0.0;
        for (i, value) in values.iter_mut().enumerate() {
            *value = self.eval(x - 0.5 - (first + i as i64) as f32);
            sum += value.abs();
        }
        let mut rest = u.min(ONE_MINUS_EPSILON) * sum;
        let mut picked = None;
        for (i, value) in values
            .iter()
            .enumerate()
            .filter(|(_, value)| **value != 0.0)
        {
            picked = Some((first + i as i64, sum.copysign(*value)));
            rest -= value.abs();
            if rest < 0.0 {
                break;
            }
        }
        picked
    }
}

/// ⌊x⌋ as [`f32::floor`] finds it, which is a call to a library without SSE4.1.
#[inline]
fn floor(x: f32) -> i64 {
    let towards_zero = x as i64;
    towards_zero.saturating_sub(i64::from(x < towards_zero as f32))
}

/// The inverse of the cumulative tent over [-1, 1].
#[inline]
fn tent(u: f32) -> f32 {
    if u < 0.5 {
        safe_sqrt(2.0 * u) - 1.0
    } else {
        1.0 - safe_sqrt(2.0 - 2.0 * u)
    }
}

/// A filter along one axis, not normalised.
#[derive(Clone, Copy, Debug)]
struct Shape {
    kind: FilterKind,
    radius: f32,
    /// The value of a Gaussian at the radius, which it is lowered by.
    rim: f32,
}

impl Shape {
    fn new(kind: FilterKind, radius: f32) -> Self {
        let rim = match kind {
            FilterKind::Gaussian { sigma } => gaussian(radius, sigma),
            _ => 0.0,
        };
        Self { kind, radius, rim }
    }

    /// Never inlined: a loop around it would begin with the arithmetic on parameters of all kinds, and where
    /// a kind has none their bits are anything, often subnormal numbers, which take a hundred cycles each.
    #[inline(never)]
    fn eval(&self, x: f32) -> f32 {
        let x = x.abs();
        // The box includes its rim: which pixel a rim belongs to is decided by the caller.
        if x > self.radius {
            return 0.0;
        }
        match self.kind {
            FilterKind::Box => 1.0,
            FilterKind::Triangle => self.radius - x,
            FilterKind::Gaussian { sigma } => (gaussian(x, sigma) - self.rim).max(0.0),
            FilterKind::Mitchell { b, c } => mitchell(2.0 * x / self.radius, b, c),
            FilterKind::Sinc { tau } => sinc(x) * sinc(x / tau),
        }
    }
}

fn gaussian(x: f32, sigma: f32) -> f32 {
    libm::expf(-sqr(x) / (2.0 * sqr(sigma)))
}

/// [Mitchell88, eq. 8] times 6, for x in [0, 2].
fn mitchell(x: f32, b: f32, c: f32) -> f32 {
    if x <= 1.0 {
        ((12.0 - 9.0 * b - 6.0 * c) * x + (-18.0 + 12.0 * b + 6.0 * c)) * x * x + (6.0 - 2.0 * b)
    } else {
        (((-b - 6.0 * c) * x + (6.0 * b + 30.0 * c)) * x + (-12.0 * b - 48.0 * c)) * x
            + (8.0 * b + 24.0 * c)
    }
}

fn sinc(x: f32) -> f32 {
    let x = PI * x;
    if x < 1e-4 {
        1.0 - x * x / 6.0
    } else {
        libm::sinf(x) / x
    }
}

#[cfg(test)]
mod tests;

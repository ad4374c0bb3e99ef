//! The pixel filter h(x, y) = h_x(x) h_y(y), with ∫∫ h = 1. Unit: 1/pixel².
//!
//! Pixels are drawn by |h|. So are offsets, up to the steps of tables. Where h is negative, the weight is, too. The
//! box and the triangle have closed forms, all others are tables. The cubic is that of \[Mitchell88\].

use crate::math::{Distribution1d, ONE_MINUS_EPSILON, PI, Vec2, safe_sqrt, sqr};

/// The shape of a filter along one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FilterKind {
    /// Constant.
    Box,
    /// Falls linearly to zero at the radius.
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
    /// Returns the box of one pixel.
    fn default() -> Self {
        Self::new(FilterKind::Box, Vec2::splat(0.5))
    }
}

impl Filter {
    /// Makes a filter with half widths `radius`, positive. Unit: pixels.
    pub fn new(kind: FilterKind, radius: Vec2) -> Self {
        Self {
            x: Axis::new(kind, radius.x),
            y: Axis::new(kind, radius.y),
        }
    }

    /// Returns the half widths. Unit: pixels.
    pub fn radius(&self) -> Vec2 {
        Vec2::new(self.x.radius, self.y.radius)
    }

    /// Returns h at `offset` from the pixel's centre. Unit: 1/pixel².
    pub fn eval(&self, offset: Vec2) -> f32 {
        self.x.eval(offset.x) * self.y.eval(offset.y)
    }

    /// Draws an offset from the pixel's centre by |h|, up to the steps of tables. Returns the offset, and h divided
    /// by its density.
    #[inline]
    pub fn sample(&self, u: Vec2) -> (Vec2, f32) {
        let (x, weight_x) = self.x.sample(u.x);
        let (y, weight_y) = self.y.sample(u.y);
        (Vec2::new(x, y), weight_x * weight_y)
    }

    /// Draws a pixel q by |h(raster - q)| among the pixels whose filter reaches `raster`. Returns its coordinates,
    /// and the weight sign(h) · Σ|h|. None: no filter reaches `raster`.
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
    profile: Profile,
    radius: f32,
}

/// h along one axis.
#[derive(Clone, Debug)]
enum Profile {
    Box,
    Triangle,
    Table(Table),
}

/// The most pixels along an axis whose filters may reach a point: readers refuse wider filters.
const MAX_PIXELS: usize = 66;

impl Axis {
    fn new(kind: FilterKind, radius: f32) -> Self {
        let radius = radius.clamp(1e-3, 32.0);
        let table = |shape: &dyn Fn(f32) -> f32| Profile::Table(Table::new(radius, shape));
        let profile = match kind {
            FilterKind::Box => Profile::Box,
            FilterKind::Triangle => Profile::Triangle,
            FilterKind::Gaussian { sigma } => table(&|x| lowered_gaussian(x, sigma, radius)),
            FilterKind::Mitchell { b, c } => table(&|x| mitchell(2.0 * x / radius, b, c)),
            FilterKind::Sinc { tau } => table(&|x| sinc(x) * sinc(x / tau)),
        };
        Self { profile, radius }
    }

    #[inline]
    fn eval(&self, x: f32) -> f32 {
        let x = x.abs();
        // The box includes its rim: the caller decides to which pixel the rim belongs.
        if x > self.radius {
            return 0.0;
        }
        match &self.profile {
            Profile::Box => 0.5 / self.radius,
            Profile::Triangle => (self.radius - x) / sqr(self.radius),
            Profile::Table(table) => table.eval(x / self.radius),
        }
    }

    #[inline]
    fn sample(&self, u: f32) -> (f32, f32) {
        match &self.profile {
            Profile::Box => ((2.0 * u - 1.0) * self.radius, 1.0),
            Profile::Triangle => (tent(u) * self.radius, 1.0),
            Profile::Table(table) => {
                let (p, pdf, _) = table.cells.sample_continuous(u);
                let x = 2.0 * p - 1.0;
                let h = table.eval(x.abs());
                (x * self.radius, h * 2.0 * self.radius / pdf)
            }
        }
    }

    #[inline]
    fn pick(&self, x: f32, u: f32) -> Option<(i64, f32)> {
        // A pixel's centre lies at q + 1/2. The interval is half open, so that a point is always in exactly one box
        // of one pixel.
        let first = floor(x - 0.5 - self.radius) + 1;
        let last = floor(x - 0.5 + self.radius);
        if first == last {
            let value = self.eval(x - 0.5 - first as f32);
            return (value != 0.0).then_some((first, value));
        }
        let mut room = [0.0f32; MAX_PIXELS];
        let values = &mut room[..usize::try_from(last - first + 1).ok()?.min(MAX_PIXELS)];
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

/// Returns ⌊x⌋, like [`f32::floor`], which is a library call on processors without SSE4.1.
#[inline]
fn floor(x: f32) -> i64 {
    let towards_zero = x as i64;
    towards_zero.saturating_sub(i64::from(x < towards_zero as f32))
}

/// Returns the inverse of the cumulative distribution of the tent over [-1, 1].
#[inline]
fn tent(u: f32) -> f32 {
    if u < 0.5 {
        safe_sqrt(2.0 * u) - 1.0
    } else {
        1.0 - safe_sqrt(2.0 - 2.0 * u)
    }
}

/// h along one axis, by its values at evenly spaced offsets from the centre to the radius. It is linear between them.
#[derive(Clone, Debug)]
struct Table {
    values: Vec<f32>,
    /// The distribution of draws: |h| in cells from -radius to radius.
    cells: Distribution1d,
}

impl Table {
    /// The number of intervals in a pixel; there are more if the radius is below `LEAST_RADIUS`.
    const INTERVALS: usize = 256;
    const LEAST_RADIUS: f32 = 4.0;
    const INTERVALS_OF_CELL: usize = 4;

    /// Makes the table of a symmetrical shape, normalised.
    fn new(radius: f32, shape: &dyn Fn(f32) -> f32) -> Self {
        let n = Self::INTERVALS * radius.max(Self::LEAST_RADIUS).ceil() as usize;
        let mut values: Vec<_> = (0..=n)
            .map(|i| shape(i as f32 / n as f32 * radius))
            .collect();
        let ends = (values[0] + values[n]) / 2.0;
        let sum: f64 = values[1..n].iter().copied().map(f64::from).sum();
        let integral = (sum + f64::from(ends)) * f64::from(2.0 * radius) / n as f64;
        for value in &mut values {
            *value = (f64::from(*value) / integral) as f32;
        }
        // A cell has the largest |h| between its ends, which it includes, so that the density is zero nowhere where h
        // is not.
        let largest = |cell: &[f32]| cell.iter().fold(0.0, |most: f32, h| most.max(h.abs()));
        let of_cell = |i: usize| largest(&values[i..=i + Self::INTERVALS_OF_CELL]);
        let half = (0..n).step_by(Self::INTERVALS_OF_CELL).map(of_cell);
        let cells = Distribution1d::new(half.clone().rev().chain(half));
        Self { values, cells }
    }

    /// Returns h at `x` times the radius, for x from 0 to 1.
    #[inline]
    fn eval(&self, x: f32) -> f32 {
        let intervals = self.values.len() - 1;
        let place = x * intervals as f32;
        let i = (place as usize).min(intervals - 1);
        let [from, to] = [self.values[i], self.values[i + 1]];
        from + (to - from) * (place - i as f32)
    }
}

/// Returns exp(-x² / 2σ²) minus its value at the radius, without cancellation: for a large σ both are nearly 1.
fn lowered_gaussian(x: f32, sigma: f32, radius: f32) -> f32 {
    let exponent = |x: f32| {
        let deviations = f64::from(x) / f64::from(sigma);
        -0.5 * deviations * deviations
    };
    let (here, rim) = (exponent(x), exponent(radius));
    (-libm::exp(here) * libm::expm1(rim - here)) as f32
}

/// Returns [Mitchell88, eq. 8] times 6, for x in [0, 2].
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

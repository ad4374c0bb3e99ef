//! Smooth functions of a cosine, as polynomials.

use super::mean;
use glam::Vec4;

/// The least √μ of the fit; below it a curve is constant.
const LEAST: f32 = 0.1;

/// A function of the cosine μ: a polynomial in √μ, as a series of Chebyshev's polynomials
/// Σ_k c_k T_k(s) of s, which goes from -1 to 1 as √μ goes from [`LEAST`] to 1.
///
/// A vertex keeps several, so coefficients have 16 bits each, in steps of `unit`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::bsdf) struct Curve<const N: usize> {
    unit: f32,
    steps: [i16; N],
}

impl<const N: usize> Curve<N> {
    pub(super) const NONE: Self = Self {
        unit: 0.0,
        steps: [0; N],
    };
    pub(super) const ONE: Self = {
        let mut steps = [0; N];
        steps[0] = 1;
        Self { unit: 1.0, steps }
    };

    /// Returns the cosines of the interpolation points: the zeros of T_N.
    pub(super) fn cosines() -> [f32; N] {
        std::array::from_fn(|i| {
            let x = LEAST + (1.0 - LEAST) * (libm::cosf(angle::<N>(i)) + 1.0) / 2.0;
            x * x
        })
    }

    /// Makes the curve with `values` at [`cosines`](Self::cosines).
    pub(super) fn through(values: [f32; N]) -> Self {
        Self::of_series(std::array::from_fn(|k| {
            let term = |(i, value)| value * libm::cosf(k as f32 * angle::<N>(i));
            let sum: f32 = values.into_iter().enumerate().map(term).sum();
            sum * if k == 0 { 1.0 } else { 2.0 } / N as f32
        }))
    }

    fn of_series(series: [f32; N]) -> Self {
        let largest = series.iter().fold(0.0f32, |most, c| most.max(c.abs()));
        if largest == 0.0 {
            return Self::NONE;
        }
        let unit = largest / f32::from(i16::MAX);
        Self {
            unit,
            steps: series.map(|c| (c / unit).round() as i16),
        }
    }

    fn series(self) -> [f32; N] {
        self.steps.map(|steps| f32::from(steps) * self.unit)
    }

    /// Returns the value at `cos`.
    #[inline]
    pub(in crate::bsdf) fn at(self, cos: f32) -> f32 {
        self.at_both([cos; 2])[0]
    }

    /// Returns the values at two cosines, by Clenshaw's recurrence.
    ///
    /// With u = T_2(s), T_2k(s) = T_k(u) and T_2k+1(s) = s V_k(u), Chebyshev's polynomials of the third kind, which have
    /// the same recurrence: even and odd coefficients at both cosines are four sums of half the length, one in each lane.
    #[inline]
    pub(in crate::bsdf) fn at_both(self, cos: [f32; 2]) -> [f32; 2] {
        const { assert!(N.is_multiple_of(2), "each even coefficient has an odd one") };
        let s = cos.map(|cos| (cos.sqrt().clamp(LEAST, 1.0) - LEAST) * (2.0 / (1.0 - LEAST)) - 1.0);
        let u = s.map(|s| 2.0 * s * s - 1.0);
        let twice = Vec4::new(u[0], u[0], u[1], u[1]) * 2.0;
        let (mut last, mut before) = (Vec4::ZERO, Vec4::ZERO);
        for pair in self.steps.as_chunks::<2>().0.iter().rev() {
            let [even, odd] = pair.map(f32::from);
            let coefficients = Vec4::new(even, odd, even, odd);
            (last, before) = (coefficients - before + twice * last, last);
        }
        let sums = last - before * Vec4::new(u[0], 1.0, u[1], 1.0);
        [sums.x + s[0] * sums.y, sums.z + s[1] * sums.w].map(|sum| sum * self.unit)
    }

    /// Returns ∫ 2μ value dμ over `[0, 1]`.
    pub(in crate::bsdf) fn mean(self) -> f32 {
        mean(64, |cos| self.at(cos))
    }

    /// Returns the curve with its values multiplied by `scale`.
    #[must_use]
    pub(super) fn scaled(self, scale: f32) -> Self {
        Self {
            unit: self.unit * scale,
            ..self
        }
    }

    /// Returns the sum of this curve and `factor` times another.
    #[must_use]
    pub(super) fn plus(self, other: Self, factor: f32) -> Self {
        let (a, b) = (self.series(), other.series());
        Self::of_series(std::array::from_fn(|i| a[i] + factor * b[i]))
    }

    /// Interpolates between two curves.
    #[must_use]
    pub(super) fn lerp(self, other: Self, t: f32) -> Self {
        if t > 0.0 {
            self.scaled(1.0 - t).plus(other, t)
        } else {
            self
        }
    }
}

/// Returns θ of the zero number `i` of T_N, which is cosθ.
fn angle<const N: usize>(i: usize) -> f32 {
    std::f32::consts::PI * (i as f32 + 0.5) / N as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::check_near;

    /// Σ c_k cos(k arccos s), term by term.
    #[track_caller]
    fn check<const N: usize>(series: [f32; N], cos: f32) {
        let s = (cos.sqrt().clamp(LEAST, 1.0) - LEAST) / (1.0 - LEAST) * 2.0 - 1.0;
        let angle = libm::acos(f64::from(s.clamp(-1.0, 1.0)));
        let curve = Curve::of_series(series);
        let term = |(k, c): (usize, f32)| f64::from(c) * libm::cos(k as f64 * angle);
        let sum: f64 = curve.series().into_iter().enumerate().map(term).sum();
        for found in [curve.at_both([cos, 0.3])[0], curve.at_both([0.8, cos])[1]] {
            check_near(found, sum, 2e-6, cos);
        }
    }

    #[test]
    fn a_curve_is_the_sum_of_its_series_at_either_cosine() {
        for i in 0..=200 {
            let cos = i as f32 / 200.0;
            let ten = [0.5, -0.3, 0.2, 0.1, -0.05, 0.04, 0.03, -0.02, 0.01, 0.005];
            check(ten, cos);
            check([0.0, 0.0, 0.0, 1.0], cos);
            check([1.0, -1.0], cos);
        }
    }
}

//! p(cosθ) = (1 - g²) / (4π (1 + g² - 2 g cosθ)^{3/2}) \[Henyey41\], θ between the directions in which light
//! travels before and after.

use crate::math::{Frame, PI, Vec2, Vec3, safe_sqrt, sin_cos, sqr};

/// A phase function: the density of scattered directions, 1/sr, the same for light and importance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HenyeyGreenstein {
    g: f32,
}

impl HenyeyGreenstein {
    /// Scatters uniformly in all directions.
    pub const ISOTROPIC: Self = Self { g: 0.0 };
    /// The largest |g|: beyond it, rounding dominates.
    pub const MOST: f32 = 0.999;

    /// Makes the function whose mean cosine is `g`, clamped to ±[`MOST`](Self::MOST). None: `g` is not between -1 and
    /// 1.
    pub fn new(g: f32) -> Option<Self> {
        let is_valid = -1.0 < g && g < 1.0;
        is_valid.then_some(Self {
            g: g.clamp(-Self::MOST, Self::MOST),
        })
    }

    /// Returns g.
    pub const fn mean_cosine(self) -> f32 {
        self.g
    }

    /// Returns p of light that arrives from `wo` and leaves to `wi`, or the other way round; both unit, away from the
    /// vertex. It is the density of [`sample`](Self::sample) too.
    #[inline(never)] // Out of line, so that code for surfaces stays small.
    pub fn eval(self, wo: Vec3, wi: Vec3) -> f32 {
        let g = self.g;
        // (1 - g)² + 2 g (1 - cosθ): no cancellation if both terms are small.
        let base = sqr(1.0 - g.abs()) + 2.0 * g.abs() * (1.0 - self.alignment(wo, wi));
        (1.0 - g * g) / (4.0 * PI * base * base.sqrt())
    }

    /// Returns cosθ for g ≥ 0, else -cosθ.
    #[inline]
    fn alignment(self, wo: Vec3, wi: Vec3) -> f32 {
        (-wo.dot(wi)).clamp(-1.0, 1.0) * 1f32.copysign(self.g)
    }

    /// Draws a direction for a walk that came along -`wo`.
    pub fn sample(self, wo: Vec3, u: Vec2) -> Vec3 {
        let (g, t) = (self.g, 2.0 * u.x - 1.0);
        // The inverse of the distribution of cosθ with the pole at g = 0 divided out.
        let above = t + g * (0.5 * (3.0 + t * t) + g * (t + 0.5 * g * (t * t - 1.0)));
        let cos = (above / sqr(1.0 + g * t)).clamp(-1.0, 1.0);
        let sin = safe_sqrt(1.0 - cos * cos);
        let (sin_phi, cos_phi) = sin_cos(2.0 * PI * u.y);
        Frame::from_z(-wo).to_world(Vec3::new(sin * cos_phi, sin * sin_phi, cos))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampler::{Dimension, Purpose};
    use crate::testing::{Battery, Domain, Grid, samples};

    #[test]
    fn samples_follow_the_density() {
        let grid = Grid::new(Domain::sphere(), [20, 40]);
        let mut battery = Battery::new("phase functions");
        let wo = Vec3::new(0.48, -0.6, 0.64);
        for g in [-0.9, -0.3, 0.0, 1e-4, 0.5, 0.95] {
            let (phase, case) = (HenyeyGreenstein::new(g).unwrap(), g.to_string());
            let at = Dimension::at(1, Purpose::Scatter);
            let draws = samples(&case, 1 << 20).map(|it| Some(phase.sample(wo, it.get_2d(at))));
            battery.chi2(&case, &grid, |wi| phase.eval(wo, wi), draws);
        }
        battery.check();
    }

    #[test]
    fn no_other_numbers_are_taken() {
        for g in [-1.0, 1.0, f32::NAN, f32::INFINITY] {
            assert_eq!(HenyeyGreenstein::new(g), None);
        }
        let narrow = HenyeyGreenstein::new(0.999_999).unwrap();
        assert!(narrow.eval(Vec3::Z, -Vec3::Z).is_finite());
    }
}

//! P(light) = power / Σ power, by luminance, or as learned from the contributions of light subpaths. It does
//! not know the receiver: a dim light nearby is chosen no more often than one far away.

use super::{Light, LightContext};
use crate::math::Distribution1d;

/// A distribution of lights that does not depend on the receiver: by power, or learned, for light subpaths only.
#[derive(Clone, Debug)]
pub struct LightChoice {
    lights: Distribution1d,
    count: usize,
}

impl LightChoice {
    /// Returns the choice among `lights`, by power.
    pub fn new(lights: &[Light], context: &LightContext<'_>) -> Self {
        Self::with_weights(lights.iter().map(|light| light.power(context)))
    }

    /// Returns the choice in proportion to `weights`, one for each light.
    pub fn with_weights(weights: impl ExactSizeIterator<Item = f32>) -> Self {
        let count = weights.len();
        let lights = Distribution1d::new(weights);
        Self { lights, count }
    }

    /// Returns the number of lights.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Draws a light, and returns its index and its probability. Calls `u` only if there are two lights or more.
    /// None: there are no lights.
    #[inline]
    pub fn sample(&self, u: impl FnOnce() -> f32) -> Option<(usize, f32)> {
        match self.count {
            0 => None,
            1 => Some((0, 1.0)),
            _ => {
                let (light, prob, _) = self.lights.sample(u());
                Some((light, prob))
            }
        }
    }

    /// Returns the probability of light `i`. Unitless.
    #[inline]
    pub fn prob(&self, i: usize) -> f32 {
        self.lights.prob(i)
    }
}

//! P(light) = power / Σ power, by luminance. It does not know the receiver: a dim light nearby is
//! chosen no more often than one far away.

use super::{Light, LightContext};
use crate::math::Distribution1d;

/// The choice of one light: by power, the same for light subpaths and for next-event estimation.
#[derive(Clone, Debug)]
pub struct LightChoice {
    by_power: Distribution1d,
    count: usize,
}

impl LightChoice {
    /// The choice among `lights`.
    pub fn new(lights: &[Light], context: &LightContext<'_>) -> Self {
        let by_power = Distribution1d::new(lights.iter().map(|light| light.power(context)));
        Self {
            by_power,
            count: lights.len(),
        }
    }

    /// Draws a light: its index and its probability. None: there are none. The number `u` is asked for
    /// where there is a choice.
    #[inline]
    pub fn sample(&self, u: impl FnOnce() -> f32) -> Option<(usize, f32)> {
        match self.count {
            0 => None,
            1 => Some((0, 1.0)),
            _ => {
                let (light, prob, _) = self.by_power.sample(u());
                Some((light, prob))
            }
        }
    }

    /// The probability of light `i`. Unitless.
    #[inline]
    pub fn prob(&self, i: usize) -> f32 {
        self.by_power.prob(i)
    }
}

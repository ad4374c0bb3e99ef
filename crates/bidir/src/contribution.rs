//! The terms of a sample's estimate ⟨I⟩ = Σ C w v / π. The contribution C, the weight w, the probability π of tracing the
//! shadow ray and the part v of it that arrives stay apart until a film adds them
//! ([`Entry`](crate::integrator::Entry)).

use crate::math::fixed::LARGEST_CONTRIBUTION;
use crate::spectrum::Spectrum;
use crate::strategy::Strategy;

/// The term of a strategy and one path, before selection and visibility.
#[derive(Clone, Copy, Debug, Default)]
pub struct Term {
    /// The strategy.
    pub strategy: Strategy,
    /// The light that the path begins on, by index.
    pub light: u32,
    /// The unweighted contribution C = f / p. For t = 1 that of one light path among many.
    pub contribution: Spectrum,
    /// The MIS weight w of the strategy.
    pub weight: f32,
}

impl Term {
    /// Returns C w.
    #[inline]
    pub fn value(&self) -> Spectrum {
        self.contribution * self.weight
    }
}

/// Returns true where a film can sum `value`.
#[inline]
pub fn is_summable(value: Spectrum) -> bool {
    value.is_within(LARGEST_CONTRIBUTION)
}

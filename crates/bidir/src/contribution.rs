//! The terms of a sample's estimate ⟨I⟩ = Σ C w v / π. The contribution C, the weight w, the probability π of tracing the
//! shadow ray and the part v of it that arrives stay apart until a film adds them.

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

    /// Returns the contribution of the term where its shadow ray is certain to be traced and the part `transmittance` of
    /// it arrives.
    #[inline]
    pub fn certain(self, transmittance: f32) -> Contribution {
        Contribution {
            term: self,
            prob: 1.0,
            transmittance,
        }
    }
}

/// The addend of a term in an image.
#[derive(Clone, Copy, Debug)]
pub struct Contribution {
    /// The term.
    pub term: Term,
    /// The probability π of tracing its shadow ray.
    pub prob: f64,
    /// The part v of it that surfaces let pass, in `[0, 1]`; the media's T is in the term's contribution.
    pub transmittance: f32,
}

impl Contribution {
    /// Returns C w v / π.
    #[inline]
    pub fn value(&self) -> Spectrum {
        self.arriving(self.term.value())
    }

    /// Returns C v / π: the value without the weight. None: no film can sum it, though it can sum the value.
    ///
    /// It is zero if the weight is zero, because such terms are not all traced.
    pub fn unweighted(&self) -> Option<Spectrum> {
        if self.term.weight == 0.0 {
            return Some(Spectrum::ZERO);
        }
        Some(self.arriving(self.term.contribution)).filter(|&value| is_summable(value))
    }

    #[inline]
    fn arriving(&self, value: Spectrum) -> Spectrum {
        // Most terms are traced for certain, and a division is dear.
        let traced = if self.prob < 1.0 {
            value.map(|lane| (f64::from(lane) / self.prob) as f32)
        } else {
            value
        };
        traced * self.transmittance
    }
}

/// Returns true where a film can sum `value`.
#[inline]
pub fn is_summable(value: Spectrum) -> bool {
    value.is_within(LARGEST_CONTRIBUTION)
}

//! The terms of a sample's estimate, one for each strategy and path: C · w, before it is known
//! whether a shadow ray is traced and whether it arrives.
//!
//! A render drops them as it goes; a replayed sample keeps a journal of what became of each.

use super::Contribution;
use crate::film::SplatPlace;
use crate::locus::Locus;
use crate::path::Strategy;
use crate::spectrum::Spectrum;

/// What a strategy gives through one path, before selection and visibility.
#[derive(Clone, Copy, Debug)]
pub struct Term {
    /// The strategy.
    pub strategy: Strategy,
    /// The light that the path begins on, by index.
    pub light: u32,
    /// The unweighted contribution C = f / p. For t = 1 that of one light path among many.
    pub contribution: Spectrum,
    /// The strategy's share of the path.
    pub weight: f32,
}

impl Term {
    /// The weighted contribution.
    #[inline]
    pub fn value(&self) -> Spectrum {
        self.contribution * self.weight
    }
}

/// A term that was counted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Counted {
    pub(super) term: Term,
    /// Its number among the terms of the sample.
    pub(super) number: u32,
}

/// Which term of a sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mark {
    /// Its strategy, for counters.
    pub(super) strategy: Strategy,
    /// Its number, for the journal.
    pub(super) number: u32,
}

impl Counted {
    #[inline]
    pub(super) fn mark(&self) -> Mark {
        Mark {
            strategy: self.term.strategy,
            number: self.number,
        }
    }

    /// What it adds where it is certain to be traced.
    #[inline]
    pub(super) fn whole(&self) -> Contribution {
        Contribution {
            strategy: self.term.strategy,
            light: self.term.light,
            value: self.term.value(),
            weight: self.term.weight,
            term: self.number,
        }
    }
}

/// What links the two subpaths of a term.
#[derive(Clone, Copy, Debug)]
pub enum Link {
    /// The camera walk, which came to the light by itself: s = 0.
    Walk,
    /// A shadow ray for the sample's own pixel: s ≥ 1 and t ≥ 2.
    Connection([Locus; 2]),
    /// A shadow ray for a splat there: t = 1.
    LightImage([Locus; 2], SplatPlace),
}

impl Link {
    /// The ends of the shadow ray, if there is one.
    pub fn ends(&self) -> Option<&[Locus; 2]> {
        match self {
            Self::Walk => None,
            Self::Connection(ends) | Self::LightImage(ends, _) => Some(ends),
        }
    }
}

/// What was done with a term.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fate {
    /// Its shadow ray was not traced.
    NotTraced,
    /// Its shadow ray was blocked.
    Blocked,
    /// It was added.
    Added,
    /// It was not finite, or too large.
    Dropped,
}

/// A term with what became of it.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// The term.
    pub term: Term,
    /// How its subpaths come together.
    pub link: Link,
    /// What was done with it.
    pub fate: Fate,
    /// What was added to the sample's value, or to a splat. Zero unless [`Fate::Added`].
    pub added: Spectrum,
}

/// The terms of one sample that are not zero, in the order in which they were evaluated: by number.
#[derive(Clone, Debug, Default)]
pub struct Journal {
    /// The entries.
    pub entries: Vec<Entry>,
}

impl Journal {
    /// Begins the entry of a term.
    pub(super) fn begin(&mut self, term: Term, link: Link) {
        self.entries.push(Entry {
            term,
            link,
            fate: Fate::NotTraced,
            added: Spectrum::ZERO,
        });
    }

    /// Completes the entry of term number `number`.
    pub(super) fn end(&mut self, number: u32, fate: Fate, added: Spectrum) {
        if let Some(entry) = self.entries.get_mut(number as usize) {
            (entry.fate, entry.added) = (fate, added);
        }
    }
}

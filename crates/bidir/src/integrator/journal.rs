//! The terms of a sample's estimate, one for each strategy and path: C · w, before it is known
//! whether a shadow ray is traced and whether it arrives.
//!
//! A render drops them as it goes; a replayed sample keeps a journal of what became of each.

use crate::contribution::Term;
use crate::film::SplatPlace;
use crate::locus::Locus;
use crate::spectrum::Spectrum;

/// The link between the two subpaths of a term.
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

/// The outcome of a term.
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
    /// Its outcome.
    pub fate: Fate,
    /// The part added to the sample's value, or to a splat. Zero unless [`Fate::Added`].
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

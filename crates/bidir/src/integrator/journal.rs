//! The terms of a batch that take part in its estimate, each with what became of it.

use super::Sample;
use crate::contribution::{Contribution, Term, is_summable};
use crate::film::SplatPlace;
use crate::locus::Locus;
use crate::stats::{Dropped, Stats};
use crate::strategy::Strategy;

/// The link between the two subpaths of a term.
#[derive(Clone, Copy, Debug)]
pub enum Link {
    /// The camera walk, which came to the light by itself: s = 0.
    Walk,
    /// A shadow ray for the sample's own pixel: s ≥ 1 and t ≥ 2.
    Connection([Locus; 2]),
    /// A shadow ray to the lens, and the place on the film that it is splatted to: t = 1.
    LightImage([Locus; 2], SplatPlace),
}

impl Link {
    /// Returns the ends of the shadow ray, if it has one.
    #[inline]
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

/// A term that was chosen, or that is certain to take part.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Its sample, by number in the batch.
    pub sample: u32,
    /// The term, with its probability and what arrives.
    pub contribution: Contribution,
    /// How its subpaths come together.
    pub link: Link,
    /// Its outcome.
    pub fate: Fate,
}

const _: () = assert!(size_of::<Entry>() == 144);

impl Entry {
    /// Makes a term that is certain to take part; its shadow ray is not traced yet.
    #[inline]
    pub(super) fn certain(sample: usize, term: Term, link: Link) -> Self {
        let fate = match link {
            Link::Walk => Fate::Added,
            Link::Connection(_) | Link::LightImage(..) => Fate::NotTraced,
        };
        Self {
            sample: sample as u32,
            contribution: term.certain(1.0),
            link,
            fate,
        }
    }

    /// Returns the ends of its shadow ray, if one is to be traced.
    #[inline]
    pub(super) fn shadow_ray(&self) -> Option<&[Locus; 2]> {
        self.link.ends().filter(|_| self.fate == Fate::NotTraced)
    }

    /// Notes how much its shadow ray lets through.
    #[inline]
    pub(super) fn arrive(&mut self, transmittance: f32, stats: &mut Stats) {
        let strategy = self.contribution.term.strategy;
        stats.count_shadow_ray(strategy);
        self.contribution.transmittance = transmittance;
        self.fate = Fate::Added;
        if transmittance <= 0.0 {
            stats.count_blocked(strategy);
            self.fate = Fate::Blocked;
        }
    }

    /// Returns true where it adds to an image.
    #[inline]
    pub fn is_added(&self) -> bool {
        self.fate == Fate::Added
    }

    /// Returns its place, if it adds to the light image.
    #[inline]
    pub fn splat_place(&self) -> Option<SplatPlace> {
        match self.link {
            Link::LightImage(_, place) => self.is_added().then_some(place),
            Link::Walk | Link::Connection(_) => None,
        }
    }
}

/// Counts a term of sample number `number` that is certain to take part, and adds its entry, untraced, to `entries`.
#[inline]
pub(super) fn enter<'e>(
    entries: &'e mut Vec<Entry>,
    stats: &mut Stats,
    number: usize,
    sample: &Sample,
    term: Term,
    link: Link,
) -> &'e mut Entry {
    stats.count_candidate(term.strategy);
    let last = entries.len();
    entries.push(Entry::certain(number, term, link));
    let entry = &mut entries[last];
    if !is_summable(term.value()) {
        drop_term(stats, sample, term.strategy);
        entry.fate = Fate::Dropped;
    }
    entry
}

/// Counts a term of `sample` that no film can sum.
#[cold]
pub(super) fn drop_term(stats: &mut Stats, sample: &Sample, strategy: Strategy) {
    stats.drop_contribution(Dropped {
        pass: sample.pass,
        pixel: sample.pixel,
        strategy,
    });
}

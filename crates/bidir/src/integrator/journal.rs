//! The terms of a batch that take part in its estimate, each with what became of it.

use super::Sample;
use crate::contribution::{Term, is_summable};
use crate::film::SplatPlace;
use crate::locus::Locus;
use crate::spectrum::Spectrum;
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
    /// The term, before selection and visibility.
    pub term: Term,
    /// The probability π of tracing its shadow ray.
    pub prob: f64,
    /// The part v of it that surfaces let pass, in `[0, 1]`; the media's T is in the term's contribution.
    pub transmittance: f32,
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
            term,
            prob: 1.0,
            transmittance: 1.0,
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
        let strategy = self.term.strategy;
        stats.count_shadow_ray(strategy);
        self.transmittance = transmittance;
        self.fate = Fate::Added;
        if transmittance <= 0.0 {
            stats.count_blocked(strategy);
            self.fate = Fate::Blocked;
        }
    }

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

    /// Returns true where it adds to an image.
    #[inline]
    pub fn is_added(&self) -> bool {
        self.fate == Fate::Added
    }
}

/// Returns the splats that add to the light image, with their places.
pub(crate) fn splats(entries: &[Entry]) -> impl Iterator<Item = (&Entry, SplatPlace)> {
    let added = entries.iter().filter(|entry| entry.is_added());
    added.filter_map(|entry| match entry.link {
        Link::LightImage(_, place) => Some((entry, place)),
        Link::Walk | Link::Connection(_) => None,
    })
}

/// Counts a term of sample number `number` that is certain to take part, and adds its entry, untraced, to `entries`.
#[inline]
pub(super) fn enter<'e>(
    entries: &'e mut Vec<Entry>,
    stats: &mut Stats,
    index: usize,
    sample: &Sample,
    term: Term,
    link: Link,
) -> &'e mut Entry {
    stats.count_candidate(term.strategy);
    let last = entries.len();
    entries.push(Entry::certain(index, term, link));
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

//! The light vertices that camera vertices are connected with.

use super::Lists;
use super::cache::Place;
use crate::contribution::Term;
use crate::select::Candidate;
use crate::spectrum::Spectrum;
use crate::strategy::Strategy;

/// A light vertex that a camera vertex is connected with.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LightEnd {
    /// Its place.
    pub(super) place: Place,
    /// [`Candidate::light_vertex`].
    pub(super) number: u32,
    /// The factor of the connection: 1/π(n) of `Pairs`, or 1 / (M N P) for a vertex of a cache. That of a light point is
    /// in its β.
    pub(super) share: f32,
}

impl LightEnd {
    /// Returns the term of its connection with camera vertex number `t`.
    #[inline(always)]
    pub(super) fn term(&self, t: usize, contribution: Spectrum, weight: f32) -> Term {
        Term {
            strategy: Strategy::new(self.place.s.into(), t),
            light: self.place.light,
            contribution,
            weight,
        }
    }

    /// Returns the candidate that is such a `term`, with number `y` of all camera vertices.
    #[inline(always)]
    pub(super) fn candidate(&self, term: Term, score: f32, y: u32) -> Candidate {
        Candidate {
            term,
            score: Candidate::score(score),
            vertices: [self.place.z, y],
            light_vertex: self.number,
        }
    }
}

/// A light point of next-event estimation.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct NextEvent {
    /// The point as a light vertex.
    pub(super) end: LightEnd,
    /// e, the density that it was drawn with.
    pub(super) pdf: f32,
}

impl NextEvent {
    /// Makes vertex number `z` of all, a point on `light` that was drawn with density `pdf`.
    #[inline]
    pub(super) fn new(z: usize, light: u32, pdf: f32) -> Self {
        let place = Place {
            z: z as u32,
            s: 1,
            is_diffuse: false,
            light,
        };
        let end = LightEnd {
            place,
            number: 0,
            share: 1.0,
        };
        Self { end, pdf }
    }
}

/// The light vertices of each camera vertex from t = 2 on: a list for each, empty or not, in the order of samples and t.
/// Where light points are shared, `next_events` has no lists at all.
#[derive(Debug, Default)]
pub(super) struct Ends {
    /// Its own light points.
    pub(super) next_events: Lists<NextEvent>,
    /// Vertices of light subpaths.
    pub(super) walked: Lists<LightEnd>,
}

impl Ends {
    /// Forgets all, and keeps the memory.
    pub(super) fn clear(&mut self) {
        self.next_events.clear();
        self.walked.clear();
    }
}

//! Shadow rays through media. A weight depends on all of the media that a ray goes through. Where only the ray finds
//! them out, each is traced before its term is weighed.
//!
//! The weight by which a candidate is chosen takes a guess of the media. Its probability so depends on nothing but
//! guesses, and the estimate remains unbiased if the weight is computed again from the media that the ray went through
//! (docs/derivations/media.md). Where the guess was right, it is kept.

use super::super::{Candidates, Entry, Fate, Walks, Worker};
use crate::locus::Locus;
use crate::path::{Job, JoinedPath, PathSums};
use crate::scene::Edge;
use crate::stats::Stats;

/// A shadow ray, traced where it may go through media.
pub(in super::super) enum TracedShadow {
    /// Not traced: no media are there.
    Clear,
    /// The media that it went through. None: something opaque is there.
    Traced(Option<Edge>),
}

impl TracedShadow {
    /// Traces the shadow ray between two ends, if it may go through media.
    #[inline]
    pub(in super::super) fn between(job: &Job<'_>, ends: impl FnOnce() -> [Locus; 2]) -> Self {
        let scene = job.scene;
        if !scene.has_media() {
            return Self::Clear;
        }
        let [a, b] = ends();
        if scene.is_clear(&a, &b) {
            return Self::Clear;
        }
        Self::Traced(scene.edge([&a, &b], job.lanes, job.stop))
    }

    /// Returns the media, where there are any and something arrives.
    #[inline]
    pub(in super::super) fn edge(&self) -> Option<&Edge> {
        match self {
            Self::Traced(edge) => edge.as_ref(),
            Self::Clear => None,
        }
    }

    /// Returns true where it is known that nothing arrives.
    #[inline]
    pub(super) fn is_blocked(&self) -> bool {
        matches!(self, Self::Traced(None))
    }

    /// Notes in `entry`, to which it belongs, that it arrives, and multiplies its contribution by T; or that it does
    /// not.
    #[inline]
    pub(super) fn apply(&self, entry: &mut Entry, stats: &mut Stats) {
        let Self::Traced(edge) = self else { return };
        if entry.fate != Fate::NotTraced {
            return;
        }
        match edge {
            Some(edge) => {
                entry.term.contribution *= edge.transmittance;
                entry.arrive(1.0, stats);
            }
            None => entry.arrive(0.0, stats),
        }
    }
}

/// Traces the shadow rays of the chosen candidates that may go through media, one by one, and weighs their terms again.
pub(super) fn trace_chosen_through_media(
    job: &Job<'_>,
    walks: &Walks,
    candidates: &Candidates,
    entries: &mut [Entry],
    worker: &mut Worker,
) {
    let Worker { weights, stats, .. } = worker;
    let first = entries.len() - candidates.chosen.len();
    for (entry, chosen) in entries[first..].iter_mut().zip(&candidates.chosen) {
        let shadow = match entry.shadow_ray() {
            Some(ends) => TracedShadow::between(job, || *ends),
            None => TracedShadow::Clear,
        };
        shadow.apply(entry, stats);
        let Some(edge) = shadow.edge().filter(|edge| !edge.is_guessed) else {
            continue;
        };
        let candidate = &candidates.offered[chosen.candidate as usize];
        let [z, y] = candidate.vertices.map(|i| i as usize);
        let [light, camera] = walks.subpaths(candidate);
        let mut path = JoinedPath::new(light, camera);
        let sums = PathSums {
            light: walks.light.sums.at(z),
            camera: walks.camera.sums.at(y),
            next_event: None,
        };
        path.segment.pass(edge);
        entry.term.weight = weights.connection(job, &path, &sums);
    }
}

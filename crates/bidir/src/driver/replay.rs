//! A sample repeated with every term of its estimate: the term's value, its probability of being traced, its
//! visibility, and its outcome.
//!
//! Replays add nothing to a film. Connections that the render did not trace are traced here, by rays that are not
//! counted.

use crate::contribution::Term;
use crate::film::{FilmSettings, SplatPlace};
use crate::integrator::{Batch, Entry, Fate, Link, splats};
use crate::locus::Locus;
use crate::path::{Job, Strategy, Subpath};
use crate::select::Selector;
use crate::spectrum::{Lanes, Spectrum};
use serde::Serialize;

/// A repeated sample, with all its terms.
pub struct Replay {
    /// The meaning of the lanes of the sample's spectra.
    pub lanes: Lanes,
    /// The batch of this one sample, as its stages left it.
    pub batch: Batch,
    /// The number of the sample's light subpath in the batch. None: the sample uses that of another, or no light
    /// subpath was walked.
    light: Option<usize>,
    /// The terms that are not zero: hits, connections, splats of the light image.
    pub terms: Vec<ReplayedTerm>,
    /// The connections of the two subpaths that have no term. They are zero: a vertex is a Dirac distribution, a side
    /// faces away, or the strategy is not asked for.
    pub zeros: Vec<Strategy>,
}

/// A term of the estimate, and its outcome.
#[derive(Clone, Copy, Debug)]
pub struct ReplayedTerm {
    /// The term, as its strategy gives it.
    pub term: Term,
    /// Its outcome.
    pub fate: Fate,
    /// The ends of its shadow ray, light and camera. None for s = 0, which needs none.
    pub ends: Option<[Locus; 2]>,
    /// The score and probability of a candidate. None: the term is not subject to selection.
    pub selection: Option<Selection>,
    /// The fraction that arrives, whether the render traced it or not. Range: 0 if something opaque is in the way, 1
    /// if nothing is.
    pub transmittance: f32,
    /// For t = 1, the position on the film.
    pub landing: Option<Landing>,
    /// The value that the term added to a pixel, in an image of one pass.
    pub added: Spectrum,
}

/// The values by which selection treated a candidate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Selection {
    /// The score that candidates are compared by: the mean of the lanes of the weighted contribution, times an
    /// estimate of the mean of T, and times √V̂ if visibility is learned.
    pub score: f32,
    /// The probability π of being traced.
    pub prob: f64,
}

/// The place of a contribution to the light image.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Landing {
    /// The point on the film. Unit: pixels.
    pub raster: [f32; 2],
    /// The pixel that the filter drew. None: it is outside the crop.
    #[serde(rename = "landed")]
    pub pixel: Option<[u32; 2]>,
}

impl Replay {
    /// Makes the replay of `batch`, a sample with light subpath number `light`; `selector` is the rule that chose its
    /// shadow rays.
    pub(super) fn new(
        job: &Job<'_>,
        batch: Batch,
        light: Option<usize>,
        selector: &dyn Selector,
    ) -> Self {
        let certain = batch.entries.len() - batch.candidates.chosen.len();
        let term = |entry: &Entry| ReplayedTerm::new(job, entry, None);
        let mut terms: Vec<_> = batch.entries[..certain].iter().map(term).collect();
        let probs = selector.probabilities(&batch.candidates.offered);
        for ((candidate, entry), prob) in batch.connections().zip(probs) {
            let selection = Selection {
                score: candidate.score,
                prob,
            };
            let entry = entry.copied().unwrap_or_else(|| batch.untraced(candidate));
            terms.push(ReplayedTerm::new(job, &entry, Some(selection)));
        }
        let unoffered = batch
            .candidates
            .unoffered
            .iter()
            .map(|other| batch.untraced(other));
        terms.extend(unoffered.map(|entry| term(&entry)));
        terms.extend(batch.splats.iter().map(term));
        let mut replay = Self {
            lanes: job.lanes,
            zeros: Vec::new(),
            terms,
            batch,
            light,
        };
        replay.zeros = replay.zeros(job);
        replay
    }

    /// Returns the sum of the terms that the sample adds to its own pixel.
    pub fn value(&self) -> Spectrum {
        self.batch.values[0]
    }

    /// Returns the terms that the sample adds to the light image, with their positions.
    pub fn splats(&self) -> impl Iterator<Item = (&Entry, SplatPlace)> {
        splats(&self.batch.splats)
    }

    /// Returns the light subpath of the sample; empty if the sample uses that of another, or none was walked.
    pub fn light(&self) -> Subpath<'_> {
        let light = self.light.map(|number| self.batch.walks.light.get(number));
        light.unwrap_or_default()
    }

    /// Returns the camera subpath of the sample; empty where none was walked.
    pub fn camera(&self) -> Subpath<'_> {
        let is_walked = self.batch.walks.camera.count() > 0;
        let camera = is_walked.then(|| self.batch.walks.camera.get(0));
        camera.unwrap_or_default()
    }

    /// Returns the connections within the limit of length that have no term.
    fn zeros(&self, job: &Job<'_>) -> Vec<Strategy> {
        let [light, camera] = [self.light(), self.camera()].map(|walk| walk.vertices.len());
        let all = (2..=camera).flat_map(|t| (1..=light).map(move |s| Strategy::new(s, t)));
        let is_short = |strategy: &Strategy| {
            usize::from(strategy.s) + usize::from(strategy.t) <= job.settings.max_vertices()
        };
        let has_none = |strategy: &Strategy| {
            self.terms
                .iter()
                .all(|term| term.term.strategy != *strategy)
        };
        all.filter(is_short).filter(has_none).collect()
    }
}

impl ReplayedTerm {
    fn new(job: &Job<'_>, entry: &Entry, selection: Option<Selection>) -> Self {
        let ends = entry.link.ends();
        let mut term = entry.term;
        let transmittance = match ends {
            None => 1.0,
            Some([a, b]) if job.scene.has_media() => {
                let edge = job.scene.edge([a, b], job.lanes, job.stop);
                // Rays that were traced have put T into their terms.
                if let (Fate::NotTraced, Some(edge)) = (entry.fate, &edge) {
                    term.contribution *= edge.transmittance;
                }
                f32::from(edge.is_some())
            }
            Some([a, b]) => job.scene.transmittance(a, b),
        };
        let (landing, scale) = match &entry.link {
            Link::Walk | Link::Connection(_) => (None, 1.0),
            Link::LightImage(_, place) => {
                let (landing, scale) = land(job.view.film(), *place);
                (Some(landing), scale)
            }
        };
        let added = match entry.fate {
            Fate::Added => entry.value(),
            Fate::NotTraced | Fate::Blocked | Fate::Dropped => Spectrum::ZERO,
        };
        Self {
            term,
            fate: entry.fate,
            ends: ends.copied(),
            selection,
            transmittance,
            landing,
            added: added * scale,
        }
    }

    /// Returns true if the transmittance of the term is not 0.
    pub fn is_visible(&self) -> bool {
        self.transmittance > 0.0
    }

    /// Returns true if selection kept the term, or if the term was not subject to selection.
    pub fn is_chosen(&self) -> bool {
        match self.fate {
            Fate::NotTraced => false,
            // A candidate is dropped after it was chosen, a term without selection before.
            Fate::Dropped => self.selection.is_some(),
            Fate::Blocked | Fate::Added => true,
        }
    }
}

/// Returns the landing of a splat, and the factor that turns its value into its part of a pixel in one pass's image.
fn land(film: &FilmSettings, place: SplatPlace) -> (Landing, f32) {
    let picked = film.pick_pixel(place);
    let landing = Landing {
        raster: place.raster.to_array(),
        pixel: picked.map(|(i, _)| film.crop.pixel(i)),
    };
    let weight = picked.map_or(0.0, |(_, weight)| weight);
    (landing, weight / film.pixel_count() as f32)
}

#[cfg(test)]
mod tests;

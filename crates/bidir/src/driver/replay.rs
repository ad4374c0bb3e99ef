//! One sample again, with every term of its estimate: its value, its probability of being traced, its
//! visibility, and its outcome.
//!
//! Nothing here adds to a film. Visibility of what was not traced is found afterwards, by rays that
//! are not counted.

use crate::contribution::Term;
use crate::film::{FilmSettings, SplatPlace};
use crate::integrator::{Entry, Fate, Link, Workspace};
use crate::locus::Locus;
use crate::path::{PathContext, Strategy, Subpath};
use crate::select::Selector;
use crate::spectrum::{Spectrum, Wavelengths};

/// One sample again, with all that it made.
pub struct Replay {
    /// The buffers as the sample left them: subpaths, candidates, chosen rays, contributions.
    pub workspace: Workspace,
    /// The light subpath that the sample brought to those that samples share.
    brought: Option<Subpath>,
    /// The wavelengths of the sample.
    pub wavelengths: Wavelengths,
    /// The terms that are not zero, in the order in which they were evaluated.
    pub terms: Vec<ReplayedTerm>,
    /// The connections of the two subpaths that are zero: for a Dirac distribution, for sides that
    /// face away, or because they take no part.
    pub zeros: Vec<Strategy>,
}

/// A term of the estimate, and what came of it.
#[derive(Clone, Copy, Debug)]
pub struct ReplayedTerm {
    /// The term, as its strategy gives it.
    pub term: Term,
    /// Its outcome.
    pub fate: Fate,
    /// The ends of its shadow ray, light and camera. None for s = 0, which needs none.
    pub ends: Option<[Locus; 2]>,
    /// For what is chosen from: importance and probability.
    pub selection: Option<Selection>,
    /// How much of it arrives, traced or not: 0 where something opaque is in the way, 1 where nothing
    /// is.
    pub transmittance: f32,
    /// For t = 1: where it lands if it is visible.
    pub landing: Option<Landing>,
    /// The value it added to a pixel of an image of one pass.
    pub added: Spectrum,
}

/// How a candidate was chosen from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Selection {
    /// The score that candidates are compared by: the luminance of the weighted contribution, times √V̂ if
    /// visibility is learned.
    pub score: f32,
    /// The probability π of being traced.
    pub prob: f64,
}

/// The place of a contribution to the light image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Landing {
    /// The point on the film. Unit: pixels.
    pub raster: [f32; 2],
    /// The pixel that the filter drew. None: it is outside the crop.
    pub pixel: Option<[u32; 2]>,
}

impl Replay {
    /// Looks into what a sample with a journal left in `workspace`, and the light subpath that it
    /// `brought`; `selector` is the rule that chose its rays.
    pub(super) fn new(
        context: &PathContext<'_>,
        workspace: Workspace,
        brought: Option<Subpath>,
        selector: &dyn Selector,
    ) -> Self {
        let probs = selector.probabilities(&workspace.candidates);
        let entries = workspace.journal.iter().flat_map(|j| &j.entries);
        let term = |(number, entry): (u32, &Entry)| {
            let mut candidates = workspace.candidates.iter().zip(&probs);
            let candidate = candidates.find(|(candidate, _)| candidate.term.number == number);
            let selection = candidate.map(|(candidate, &prob)| Selection {
                score: candidate.score,
                prob,
            });
            ReplayedTerm::new(context, entry, selection)
        };
        let terms: Vec<_> = (0..).zip(entries).map(term).collect();
        Self {
            zeros: zeros(context, &workspace, &terms),
            terms,
            wavelengths: context.wavelengths,
            workspace,
            brought,
        }
    }

    /// The light subpath of the sample; empty where it has that of another.
    pub fn light(&self) -> &Subpath {
        self.brought.as_ref().unwrap_or(&self.workspace.light)
    }
}

/// The connections within the limit of length that no term is about.
fn zeros(
    context: &PathContext<'_>,
    workspace: &Workspace,
    terms: &[ReplayedTerm],
) -> Vec<Strategy> {
    let lengths = [&workspace.light, &workspace.camera].map(|subpath| subpath.vertices.len());
    let all = (2..=lengths[1]).flat_map(|t| (1..=lengths[0]).map(move |s| Strategy::new(s, t)));
    let is_short = |strategy: &Strategy| {
        usize::from(strategy.s) + usize::from(strategy.t) <= context.settings.max_vertices()
    };
    all.filter(is_short)
        .filter(|strategy| terms.iter().all(|term| term.term.strategy != *strategy))
        .collect()
}

impl ReplayedTerm {
    fn new(context: &PathContext<'_>, entry: &Entry, selection: Option<Selection>) -> Self {
        let (scene, ends) = (context.scene, entry.link.ends());
        let transmittance = ends.map_or(1.0, |[a, b]| scene.transmittance(a, b));
        let (landing, scale) = match &entry.link {
            Link::Walk | Link::Connection(_) => (None, 1.0),
            Link::LightImage(_, place) => {
                let (landing, scale) = land(context.view.film(), *place);
                (Some(landing), scale)
            }
        };
        Self {
            term: entry.term,
            fate: entry.fate,
            ends: ends.copied(),
            selection,
            transmittance,
            landing,
            added: entry.added * scale,
        }
    }

    /// True where something of it arrives.
    pub fn is_visible(&self) -> bool {
        self.transmittance > 0.0
    }

    /// True where the term is let through by selection, or where nothing is chosen from.
    pub fn is_chosen(&self) -> bool {
        match self.fate {
            Fate::NotTraced => false,
            // Dropped before selection, or after.
            Fate::Dropped => self.selection.is_some(),
            Fate::Blocked | Fate::Added => true,
        }
    }
}

/// The place of a splat, and the factor that turns its value into its part of a pixel in one pass's image.
fn land(film: &FilmSettings, place: SplatPlace) -> (Landing, f32) {
    let picked = film.pick_pixel(place);
    let landing = Landing {
        raster: place.raster.to_array(),
        pixel: picked.map(|(i, _)| film.crop.pixel(i)),
    };
    let weight = picked.map_or(0.0, |(_, weight)| weight);
    (landing, weight / film.light_paths() as f32)
}

#[cfg(test)]
mod tests;

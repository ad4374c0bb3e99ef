//! The contribution of each strategy.

use super::subpath::Place;
use bidir::driver::{Landing, ReplayedTerm};
use bidir::integrator::Fate;
use bidir::spectrum::{Lanes, Rgb};
use serde::Serialize;

/// The report that all strategies have.
#[derive(Clone, Debug, Serialize)]
pub(super) struct TermReport {
    pub(super) s: u16,
    pub(super) t: u16,
    /// C, unweighted, as if nothing were in the way.
    pub(super) contribution: Rgb,
    /// w.
    pub(super) weight: f32,
    /// w C.
    pub(super) value: Rgb,
    pub(super) is_dropped: bool,
    /// The value that it added to a pixel of an image of one pass.
    pub(super) added: Rgb,
}

#[derive(Clone, Debug, Serialize)]
pub(super) struct CandidateReport {
    #[serde(flatten)]
    pub(super) term: TermReport,
    /// The end of the light subpath: for s = 1 a light point of its own, in `lvc` a vertex of another
    /// sample. The other end is vertex t - 1 of the camera subpath.
    pub(super) light_end: Place,
    /// The selection score; null where none are chosen.
    pub(super) score: Option<f32>,
    /// The probability of being chosen.
    pub(super) prob: f64,
    pub(super) is_chosen: bool,
    /// Traced or not.
    pub(super) is_visible: bool,
    /// The part of it that arrives.
    pub(super) transmittance: f32,
}

#[derive(Clone, Debug, Serialize)]
pub(super) struct SplatReport {
    #[serde(flatten)]
    pub(super) term: TermReport,
    /// The visible point: vertex s - 1 of the light subpath.
    pub(super) light_end: Place,
    pub(super) is_visible: bool,
    /// The part of it that arrives.
    pub(super) transmittance: f32,
    /// The place where it lands, or would.
    pub(super) raster: [f32; 2],
    /// The pixel that the filter drew; null where it is not rendered.
    pub(super) landed: Option<[u32; 2]>,
}

impl TermReport {
    pub(super) fn new(lanes: Lanes, replayed: &ReplayedTerm) -> Self {
        let term = &replayed.term;
        Self {
            s: term.strategy.s,
            t: term.strategy.t,
            contribution: lanes.to_rgb(term.contribution),
            weight: term.weight,
            value: lanes.to_rgb(term.value()),
            is_dropped: replayed.fate == Fate::Dropped,
            added: lanes.to_rgb(replayed.added),
        }
    }
}

impl CandidateReport {
    pub(super) fn new(lanes: Lanes, replayed: &ReplayedTerm, light_end: Place) -> Self {
        Self {
            term: TermReport::new(lanes, replayed),
            light_end,
            score: replayed.selection.map(|selection| selection.score),
            // Without a choice everything is traced.
            prob: replayed.selection.map_or(1.0, |selection| selection.prob),
            is_chosen: replayed.is_chosen(),
            is_visible: replayed.is_visible(),
            transmittance: replayed.transmittance,
        }
    }

    /// Its value times its transmittance.
    pub(super) fn arriving(&self) -> Rgb {
        self.term.value.map(|channel| channel * self.transmittance)
    }
}

impl SplatReport {
    pub(super) fn new(
        lanes: Lanes,
        replayed: &ReplayedTerm,
        landing: &Landing,
        light_end: Place,
    ) -> Self {
        Self {
            term: TermReport::new(lanes, replayed),
            light_end,
            is_visible: replayed.is_visible(),
            transmittance: replayed.transmittance,
            raster: landing.raster,
            landed: landing.pixel,
        }
    }
}

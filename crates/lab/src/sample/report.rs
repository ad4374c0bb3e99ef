//! The report of a sample.

use super::TrainingReport;
use super::subpath::{SubpathReport, View};
use super::term::{CandidateReport, SplatReport, TermReport};
use bidir::driver::{Replay, Session};
use bidir::spectrum::{Lanes, Rgb};
use formats::film::SettingsText;
use serde::Serialize;

/// The report of a sample. Numbers that are not finite are null in JSON.
#[derive(Clone, Debug, Serialize)]
pub struct SampleReport {
    pub(super) pixel: [u32; 2],
    pub(super) pass: u64,
    pub(super) settings: SettingsText,
    pub(super) training: Option<TrainingReport>,
    pub(super) camera: SubpathReport,
    pub(super) light: SubpathReport,
    /// s = 0: lights that the camera subpath came to.
    pub(super) hits: Vec<TermReport>,
    /// s ≥ 1 and t ≥ 2: connections that are not zero before selection and visibility.
    pub(super) candidates: Vec<CandidateReport>,
    /// The connections that are.
    pub(super) zeros: Vec<String>,
    /// t = 1: splats.
    pub(super) light_image: Vec<SplatReport>,
    /// The divisor of splats.
    pub(super) light_paths: u64,
    /// The light subpaths of the pass: fewer, where samples share them.
    pub(super) light_subpaths: u64,
    /// The value that was added to the pixel.
    pub(super) value: Rgb,
    pub(super) value_of_hits: Rgb,
    pub(super) value_of_candidates: Rgb,
    /// The value of candidates if all were traced: the expectation of every selection.
    pub(super) value_of_all_candidates: Rgb,
    pub(super) rays: u64,
    pub(super) dropped: u64,
}

impl SampleReport {
    /// The report of a repeated sample: that of `pixel` in `pass`.
    pub fn new(session: &Session<'_>, pixel: [u32; 2], pass: u64, replay: &Replay) -> Self {
        let (lanes, stats) = (replay.lanes, &replay.batch.worker.stats);
        let view = View::new(session, &replay.camera());
        let Terms {
            hits,
            candidates,
            light_image,
        } = Terms::new(lanes, &view, replay);
        let all = candidates
            .iter()
            .filter(|c| c.is_visible && !c.term.is_dropped);
        Self {
            pixel,
            pass,
            settings: SettingsText::from(session.settings()),
            training: TrainingReport::new(session),
            camera: SubpathReport::new(lanes, &view, &replay.camera()),
            light: SubpathReport::new(lanes, &view, &replay.light()),
            value: lanes.to_rgb(replay.value()),
            value_of_hits: sum(hits.iter().map(|hit| hit.added)),
            value_of_candidates: sum(candidates.iter().map(|c| c.term.added)),
            value_of_all_candidates: sum(all.map(CandidateReport::arriving)),
            hits,
            candidates,
            zeros: replay.zeros.iter().map(ToString::to_string).collect(),
            light_image,
            light_paths: session.view().film().light_paths(),
            light_subpaths: session.light_subpaths(),
            rays: stats.rays.total(),
            dropped: stats.dropped,
        }
    }
}

/// The terms of a sample, by their reports.
#[derive(Default)]
struct Terms {
    hits: Vec<TermReport>,
    candidates: Vec<CandidateReport>,
    light_image: Vec<SplatReport>,
}

impl Terms {
    fn new(lanes: Lanes, view: &View<'_>, replay: &Replay) -> Self {
        let mut terms = Self::default();
        for term in &replay.terms {
            match (&term.landing, &term.ends) {
                (Some(landing), Some([light, _])) => {
                    let splat = SplatReport::new(lanes, term, landing, view.end(light));
                    terms.light_image.push(splat);
                }
                (None, Some([light, _])) => {
                    let candidate = CandidateReport::new(lanes, term, view.end(light));
                    terms.candidates.push(candidate);
                }
                (_, None) => terms.hits.push(TermReport::new(lanes, term)),
            }
        }
        terms
    }
}

fn sum(values: impl Iterator<Item = Rgb>) -> Rgb {
    values.fold([0.0; 3], |sum, value| {
        std::array::from_fn(|channel| sum[channel] + value[channel])
    })
}

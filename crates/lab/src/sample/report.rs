//! The report of a sample.

use super::TrainingReport;
use super::view::{Place, View};
use bidir::driver::{Landing, Replay, Session};
use bidir::spectrum::Rgb;
use formats::film::SettingsText;
use serde::Serialize;

/// The report of a sample. Numbers that are not finite are null in JSON.
#[derive(Clone, Debug, Serialize)]
pub struct SampleReport {
    pub(super) pixel: [u32; 2],
    pub(super) pass: u64,
    pub(super) settings: SettingsText,
    pub(super) training: Option<TrainingReport>,
    /// The lens point of the camera subpath, or without such a subpath, the middle of the lens.
    #[serde(skip)]
    pub(super) eye: Place,
    pub(super) camera: SubpathReport,
    pub(super) light: SubpathReport,
    /// The hits, s = 0: lights that the camera subpath met.
    pub(super) hits: Vec<TermReport>,
    /// The candidates, s ≥ 1 and t ≥ 2: connections that are not zero before selection and visibility.
    pub(super) candidates: Vec<TermReport>,
    /// The strategies of connections without a term, because they are zero.
    pub(super) zeros: Vec<String>,
    /// The splats, t = 1.
    pub(super) light_image: Vec<TermReport>,
    /// The number of light paths by which splats are divided.
    pub(super) light_paths: u64,
    /// The number of light subpaths of the pass. It is smaller if samples share them.
    pub(super) light_subpaths: u64,
    /// The value that was added to the pixel.
    pub(super) value: Rgb,
    pub(super) value_of_hits: Rgb,
    pub(super) value_of_candidates: Rgb,
    /// The value of all candidates, as if all were traced. Every selection has it as its expectation.
    pub(super) value_of_all_candidates: Rgb,
    pub(super) rays: u64,
    pub(super) dropped: u64,
}

#[derive(Clone, Debug, Serialize)]
pub(super) struct SubpathReport {
    pub(super) vertices: Vec<VertexReport>,
    /// The direction in which the walk left the scene.
    pub(super) escape: Option<[f32; 3]>,
}

#[derive(Clone, Debug, Serialize)]
pub(super) struct VertexReport {
    pub(super) kind: &'static str,
    #[serde(flatten)]
    pub(super) place: Place,
    pub(super) normal: [f32; 3],
    pub(super) is_delta: bool,
    pub(super) light: Option<u32>,
    pub(super) beta: Rgb,
    pub(super) pdf_fwd: f32,
    pub(super) pdf_rev: f32,
}

/// The contribution of a strategy.
#[derive(Clone, Debug, Serialize)]
pub(super) struct TermReport {
    pub(super) s: u16,
    pub(super) t: u16,
    /// C, unweighted and unoccluded.
    pub(super) contribution: Rgb,
    /// The MIS weight w.
    pub(super) weight: f32,
    /// w C.
    pub(super) value: Rgb,
    pub(super) is_dropped: bool,
    /// The value that it added to a pixel of an image of one pass.
    pub(super) added: Rgb,
    /// The shadow ray. None: s = 0, which needs none.
    #[serde(flatten)]
    pub(super) ray: Option<RayReport>,
}

/// The shadow ray of a contribution.
#[derive(Clone, Debug, Serialize)]
pub(super) struct RayReport {
    /// The end of the light subpath: for s = 1 a separately sampled light point, in `lvc` a vertex of another
    /// sample. The other end is vertex t - 1 of the camera subpath, or the lens.
    pub(super) light_end: Place,
    /// The selection among candidates. None: the term is a splat.
    #[serde(flatten)]
    pub(super) choice: Option<Choice>,
    /// True if the ends are visible from each other, whether the ray was traced or not.
    pub(super) is_visible: bool,
    /// The part of the value that arrives.
    pub(super) transmittance: f32,
    /// The point of the film on which a splat lands, also if it is not visible. None: the term is a candidate.
    #[serde(flatten)]
    pub(super) landing: Option<Landing>,
}

#[derive(Clone, Debug, Serialize)]
pub(super) struct Choice {
    /// The selection score; null without selection.
    pub(super) score: Option<f32>,
    /// The probability of being chosen.
    pub(super) prob: f64,
    pub(super) is_chosen: bool,
}

impl SampleReport {
    /// Reports a repeated sample of `pixel` in `pass`.
    pub fn new(session: &Session<'_>, pixel: [u32; 2], pass: u64, replay: &Replay) -> Self {
        let stats = &replay.batch.worker.stats;
        let view = View::new(session, replay);
        let terms = replay.terms.iter().map(|term| view.term(term));
        let (hits, connections): (Vec<_>, Vec<_>) = terms.partition(|term| term.ray.is_none());
        let is_candidate = |term: &TermReport| term.choice().is_some();
        let (candidates, light_image): (Vec<_>, Vec<_>) =
            connections.into_iter().partition(is_candidate);
        Self {
            pixel,
            pass,
            settings: SettingsText::from(session.settings()),
            training: TrainingReport::new(session),
            eye: view.eye(),
            camera: view.subpath(&replay.camera()),
            light: view.subpath(&replay.light()),
            value: replay.lanes.to_rgb(replay.value()),
            value_of_hits: sum(hits.iter().map(|hit| hit.added)),
            value_of_candidates: sum(candidates.iter().map(|candidate| candidate.added)),
            value_of_all_candidates: sum(candidates.iter().filter_map(TermReport::arriving)),
            hits,
            candidates,
            zeros: replay.zeros.iter().map(ToString::to_string).collect(),
            light_image,
            light_paths: session.view().film().pixel_count(),
            light_subpaths: session.light_subpaths(),
            rays: stats.rays.total(),
            dropped: stats.dropped,
        }
    }
}

impl TermReport {
    /// Returns the selection of a candidate. None: the term is a hit or a splat.
    pub(super) fn choice(&self) -> Option<&Choice> {
        self.ray.as_ref()?.choice.as_ref()
    }

    /// Returns the value times the transmittance. None: it was dropped, or something opaque is in the way.
    fn arriving(&self) -> Option<Rgb> {
        let ray = self.ray.as_ref()?;
        let arrives = ray.is_visible && !self.is_dropped;
        arrives.then(|| self.value.map(|channel| channel * ray.transmittance))
    }
}

fn sum(values: impl Iterator<Item = Rgb>) -> Rgb {
    values.fold([0.0; 3], |sum, value| {
        std::array::from_fn(|channel| sum[channel] + value[channel])
    })
}

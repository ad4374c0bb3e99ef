//! What of a sample is drawn.

use super::super::report::SampleReport;
use super::super::subpath::{Place, SubpathReport};
use super::super::term::{CandidateReport, SplatReport, TermReport};
use super::view::Extent;
use crate::report::number::number;
use bidir::path::Strategy;
use bidir::scene::Scene;
use bidir::spectrum::{Rgb, luminance};

/// What became of a strategy's contribution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fate {
    /// Its ray was traced, and nothing was in its way.
    Arrives,
    /// Its ray was traced in vain.
    Blocked,
    /// Its ray was not traced.
    Untraced,
    /// The camera walk found the light.
    Found,
    /// It is seen by the light image.
    Splat,
    /// It is hidden from the light image.
    HiddenSplat,
}

impl Fate {
    /// The class of its line, by which the style has its colour.
    pub(super) fn class(self) -> &'static str {
        match self {
            Self::Arrives => "arrives",
            Self::Blocked => "blocked",
            Self::Untraced => "untraced",
            Self::Found => "camera",
            Self::Splat | Self::HiddenSplat => "splat",
        }
    }

    /// Its dashes: what is traced and arrives is solid.
    pub(super) fn dashes(self) -> Option<&'static str> {
        match self {
            Self::Arrives | Self::Found | Self::Splat => None,
            Self::Blocked | Self::HiddenSplat => Some("6 4"),
            Self::Untraced => Some("1 3.5"),
        }
    }
}

/// A strategy's contribution: a line of the table, and unless the walk found the light, a ray.
pub(super) struct Entry {
    pub(super) strategy: Strategy,
    /// The vertices that it joins.
    pub(super) joins: String,
    /// The luminance of w C; for the light image, of its part of a pass.
    pub(super) value: f32,
    /// Of being traced. None: it is sure.
    pub(super) prob: Option<f64>,
    pub(super) fate: Fate,
    /// What became of it, in words.
    pub(super) outcome: String,
    /// What the light and the camera contribute to the ray.
    pub(super) ends: Option<[Place; 2]>,
    /// True where the light's end is no vertex of the light subpath.
    pub(super) is_foreign: bool,
    /// Range: `[0, 1]`, relative to the largest: value times probability.
    pub(super) weight: f32,
}

impl Entry {
    /// All that is known, for those who point at its ray.
    pub(super) fn title(&self) -> String {
        let prob = self.prob.map_or(String::new(), |prob| {
            format!(", probability {}", number(prob))
        });
        let (value, outcome) = (number(f64::from(self.value)), &self.outcome);
        format!(
            "{} ({}): {value}{prob}, {outcome}",
            self.strategy, self.joins
        )
    }
}

/// A sample as it is drawn.
pub(super) struct Figure<'a> {
    pub(super) report: &'a SampleReport,
    /// Where it looks from.
    pub(super) eye: Place,
    /// Connections, the largest first.
    pub(super) candidates: Vec<Entry>,
    /// s = 0.
    pub(super) hits: Vec<Entry>,
    /// t = 1, the largest first.
    pub(super) splats: Vec<Entry>,
}

impl<'a> Figure<'a> {
    pub(super) fn new(report: &'a SampleReport, scene: &Scene) -> Self {
        let eye = report.camera.vertices.first().map(|y0| y0.place);
        let mut figure = Self {
            eye: eye.unwrap_or_else(|| Place::eye(scene.camera())),
            hits: report.hits.iter().map(|hit| found(report, hit)).collect(),
            candidates: Vec::new(),
            splats: Vec::new(),
            report,
        };
        let candidates = report.candidates.iter().map(|c| figure.candidate(c));
        figure.candidates = ranked(candidates.collect());
        let splats = report.light_image.iter().map(|s| figure.splat(s));
        figure.splats = ranked(splats.collect());
        figure
    }

    fn candidate(&self, candidate: &CandidateReport) -> Entry {
        let term = &candidate.term;
        let (s, t) = (usize::from(term.s), usize::from(term.t));
        let camera = self.report.camera.vertices.get(t - 1);
        let is_foreign = is_foreign(&self.report.light, s, &candidate.light_end);
        let (fate, outcome) = fate_of(candidate);
        let value = luminance(term.value);
        Entry {
            strategy: Strategy::new(s, t),
            joins: joins(s, t, is_foreign),
            value,
            prob: Some(candidate.prob),
            fate,
            outcome,
            ends: camera.map(|y| [candidate.light_end, y.place]),
            is_foreign,
            weight: value * candidate.prob as f32,
        }
    }

    fn splat(&self, splat: &SplatReport) -> Entry {
        let s = usize::from(splat.term.s);
        // What it adds to a pixel is one of as many parts.
        let value = luminance(splat.term.value) / self.report.light_paths as f32;
        let is_foreign = is_foreign(&self.report.light, s, &splat.light_end);
        let outcome = match splat.landed {
            _ if splat.term.is_dropped => "dropped".to_owned(),
            _ if !splat.is_visible => "blocked".to_owned(),
            Some([x, y]) => format!("in pixel {x},{y}"),
            None => "off the film".to_owned(),
        };
        Entry {
            strategy: Strategy::new(s, 1),
            joins: joins(s, 1, is_foreign),
            value,
            prob: None,
            fate: if splat.is_visible {
                Fate::Splat
            } else {
                Fate::HiddenSplat
            },
            outcome,
            ends: Some([splat.light_end, self.eye]),
            is_foreign,
            weight: value,
        }
    }

    /// All that have a ray.
    pub(super) fn rays(&self) -> impl DoubleEndedIterator<Item = &Entry> {
        self.candidates.iter().chain(&self.splats)
    }

    /// The box around all points.
    pub(super) fn extent(&self) -> Option<Extent> {
        let subpaths = [&self.report.camera, &self.report.light];
        let vertices = subpaths.into_iter().flat_map(|subpath| &subpath.vertices);
        let vertices = vertices.map(|vertex| vertex.place);
        let ends = self.rays().filter_map(|ray| ray.ends).flatten();
        let places = vertices.chain(ends).chain([self.eye]);
        let finite = places.filter(|place| !place.is_infinite);
        Extent::of(&finite.map(|place| place.point()).collect::<Vec<_>>())
    }
}

/// True where a connection's light vertex is not that of the light subpath.
fn is_foreign(light: &SubpathReport, s: usize, end: &Place) -> bool {
    let own = s.checked_sub(1).and_then(|i| light.vertices.get(i));
    own.is_none_or(|z| z.place != *end)
}

fn joins(s: usize, t: usize, is_foreign: bool) -> String {
    let prime = if is_foreign { "\u{2032}" } else { "" };
    format!("z{}{prime} \u{2013} y{}", s.saturating_sub(1), t - 1)
}

/// What the camera walk found by itself.
fn found(report: &SampleReport, hit: &TermReport) -> Entry {
    let t = usize::from(hit.t);
    let is_escape = t > report.camera.vertices.len();
    Entry {
        strategy: Strategy::new(0, t),
        joins: if is_escape {
            "escape".to_owned()
        } else {
            format!("y{}", t - 1)
        },
        value: luminance(hit.value),
        prob: None,
        fate: Fate::Found,
        outcome: if hit.is_dropped { "dropped" } else { "found" }.to_owned(),
        ends: None,
        is_foreign: false,
        weight: 1.0,
    }
}

fn fate_of(candidate: &CandidateReport) -> (Fate, String) {
    let way = match candidate.transmittance {
        part if part <= 0.0 => "blocked".to_owned(),
        part if part >= 1.0 => "arrives".to_owned(),
        part => format!("arrives, {:.0} %", 100.0 * part),
    };
    match (candidate.is_chosen, candidate.is_visible) {
        _ if candidate.term.is_dropped => (Fate::Untraced, "dropped".to_owned()),
        (true, true) => (Fate::Arrives, way),
        (true, false) => (Fate::Blocked, way),
        (false, true) => (Fate::Untraced, "not traced".to_owned()),
        (false, false) => (Fate::Untraced, "not traced, blocked".to_owned()),
    }
}

/// The largest first, with weights relative to the largest.
fn ranked(mut entries: Vec<Entry>) -> Vec<Entry> {
    let weights = entries.iter().map(|entry| entry.weight);
    let largest = weights.fold(f32::MIN_POSITIVE, f32::max);
    for entry in &mut entries {
        // What is not finite was dropped, and is drawn as thin as can be.
        entry.weight = (entry.weight / largest).clamp(0.0, 1.0);
        if entry.weight.is_nan() {
            entry.weight = 0.0;
        }
    }
    entries.sort_by(|a, b| b.value.total_cmp(&a.value));
    entries
}

/// A number of light, for sums.
pub(super) fn light(value: Rgb) -> String {
    number(f64::from(luminance(value)))
}

//! `bidir render --replay`: one sample again, told step by step.

mod text;

use crate::args::{RenderArgs, ReplayTarget};
use crate::console::{print, print_json};
use crate::exit::{Exit, Failure};
use crate::settings::SettingsText;
use crate::stats::TrainingReport;
use bidir::driver::{Replay, ReplayedTerm, Session};
use bidir::integrator::Fate;
use bidir::path::{Subpath, Vertex, VertexKind};
use bidir::scene::Scene;
use bidir::spectrum::{ColorModel, Rgb, Spectrum, Wavelengths};
use serde::Serialize;

/// A sample, told. Numbers that are not finite are null in JSON.
#[derive(Debug, Serialize)]
struct SampleReport {
    pixel: [u32; 2],
    pass: u64,
    settings: SettingsText,
    training: Option<TrainingReport>,
    camera: SubpathReport,
    light: SubpathReport,
    /// s = 0: lights that the camera subpath came to.
    hits: Vec<TermReport>,
    /// s ≥ 1 and t ≥ 2: connections that are not zero before selection and visibility.
    candidates: Vec<CandidateReport>,
    /// The connections that are.
    zeros: Vec<String>,
    /// t = 1: splats.
    light_image: Vec<SplatReport>,
    /// What splats are divided by.
    light_paths: u64,
    /// What was added to the pixel.
    value: Rgb,
    value_of_hits: Rgb,
    value_of_candidates: Rgb,
    /// What candidates would have added, had all been traced: what a selection is to expect.
    value_of_all_candidates: Rgb,
    rays: u64,
    dropped: u64,
}

#[derive(Debug, Serialize)]
struct SubpathReport {
    vertices: Vec<VertexReport>,
    /// The direction in which the walk left the scene.
    escape: Option<[f32; 3]>,
}

#[derive(Debug, Serialize)]
struct VertexReport {
    kind: &'static str,
    /// The direction towards it where it is at infinity.
    position: [f32; 3],
    is_infinite: bool,
    normal: [f32; 3],
    is_delta: bool,
    light: Option<u32>,
    beta: Rgb,
    pdf_fwd: f32,
    pdf_rev: f32,
}

/// What all strategies have in common.
#[derive(Debug, Serialize)]
struct TermReport {
    s: u16,
    t: u16,
    /// C, unweighted, as if nothing were in the way.
    contribution: Rgb,
    /// w.
    weight: f32,
    /// w C.
    value: Rgb,
    is_dropped: bool,
    /// What it added to a pixel of an image of one pass.
    added: Rgb,
}

#[derive(Debug, Serialize)]
struct CandidateReport {
    #[serde(flatten)]
    term: TermReport,
    /// What candidates are compared by; null where none are chosen.
    score: Option<f32>,
    /// The probability of being chosen.
    prob: f64,
    is_chosen: bool,
    /// Traced or not.
    is_visible: bool,
    /// How much of it arrives.
    transmittance: f32,
}

#[derive(Debug, Serialize)]
struct SplatReport {
    #[serde(flatten)]
    term: TermReport,
    is_visible: bool,
    /// How much of it arrives.
    transmittance: f32,
    /// Where it lands, or would.
    raster: [f32; 2],
    /// The pixel that the filter drew; null where it is not rendered.
    landed: Option<[u32; 2]>,
}

/// Repeats a sample and prints what it did.
pub(crate) fn run(
    args: &RenderArgs,
    scene: &Scene,
    session: &Session<'_>,
    target: ReplayTarget,
) -> Result<Exit, Failure> {
    let replay = session.replay(target.pixel, target.pass).ok_or_else(|| {
        let [x, y] = target.pixel;
        let crop = scene.film().crop;
        let ([x0, y0], [x1, y1]) = (crop.min, crop.max);
        let hint =
            format!("the render has the pixels from {x0},{y0} up to, not including, {x1},{y1}");
        Failure::usage(format!("the pixel {x},{y} is not rendered")).with_hint(hint)
    })?;
    let report = SampleReport::new(session, target, &replay);
    if args.json {
        print_json(&report)
    } else {
        print(&report.to_string())
    }
}

/// How light is told: as linear Rec. 709.
struct Color {
    model: ColorModel,
    wavelengths: Wavelengths,
}

impl Color {
    fn rgb(&self, value: Spectrum) -> Rgb {
        self.model.to_rgb(value, &self.wavelengths)
    }
}

impl SampleReport {
    fn new(session: &Session<'_>, target: ReplayTarget, replay: &Replay) -> Self {
        let (scene, workspace) = (session.scene(), &replay.workspace);
        let color = Color {
            model: scene.color(),
            wavelengths: replay.wavelengths,
        };
        let (mut hits, mut candidates, mut light_image) = (Vec::new(), Vec::new(), Vec::new());
        for term in &replay.terms {
            match (term.landing, term.term.strategy.s) {
                (Some(landing), _) => light_image.push(SplatReport {
                    term: TermReport::new(&color, term),
                    is_visible: term.is_visible(),
                    transmittance: term.transmittance,
                    raster: landing.raster,
                    landed: landing.pixel,
                }),
                (None, 0) => hits.push(TermReport::new(&color, term)),
                (None, _) => candidates.push(CandidateReport::new(&color, term)),
            }
        }
        let all = candidates
            .iter()
            .filter(|c| c.is_visible && !c.term.is_dropped);
        Self {
            pixel: target.pixel,
            pass: target.pass,
            settings: SettingsText::from(session.settings()),
            training: TrainingReport::new(session),
            camera: SubpathReport::new(&color, &workspace.camera),
            light: SubpathReport::new(&color, &workspace.light),
            value: color.rgb(workspace.value),
            value_of_hits: sum(hits.iter().map(|hit| hit.added)),
            value_of_candidates: sum(candidates.iter().map(|c| c.term.added)),
            value_of_all_candidates: sum(all.map(CandidateReport::arriving)),
            hits,
            candidates,
            zeros: replay.zeros.iter().map(ToString::to_string).collect(),
            light_image,
            light_paths: scene.film().light_paths(),
            rays: workspace.stats.rays.total(),
            dropped: workspace.stats.dropped,
        }
    }
}

fn sum(values: impl Iterator<Item = Rgb>) -> Rgb {
    values.fold([0.0; 3], |sum, value| {
        std::array::from_fn(|channel| sum[channel] + value[channel])
    })
}

impl SubpathReport {
    fn new(color: &Color, subpath: &Subpath) -> Self {
        let vertices = subpath
            .vertices
            .iter()
            .map(|vertex| VertexReport::new(color, vertex));
        Self {
            vertices: vertices.collect(),
            escape: subpath.escape.map(|escape| escape.direction.to_array()),
        }
    }
}

impl VertexReport {
    fn new(color: &Color, vertex: &Vertex) -> Self {
        let kind = match vertex.kind {
            VertexKind::Camera => "camera",
            VertexKind::Light => "light",
            VertexKind::Surface => "surface",
        };
        Self {
            kind,
            position: vertex.point.to_array(),
            is_infinite: vertex.is_infinite,
            normal: vertex.n_g.to_array(),
            is_delta: vertex.is_delta() || vertex.went_by_delta,
            light: vertex.light,
            beta: color.rgb(vertex.beta),
            pdf_fwd: vertex.pdf_fwd,
            pdf_rev: vertex.pdf_rev,
        }
    }
}

impl TermReport {
    fn new(color: &Color, replayed: &ReplayedTerm) -> Self {
        let term = &replayed.term;
        Self {
            s: term.strategy.s,
            t: term.strategy.t,
            contribution: color.rgb(term.contribution),
            weight: term.weight,
            value: color.rgb(term.value()),
            is_dropped: replayed.fate == Fate::Dropped,
            added: color.rgb(replayed.added),
        }
    }
}

impl CandidateReport {
    /// What it is worth behind what lies in its way.
    fn arriving(&self) -> Rgb {
        self.term.value.map(|channel| channel * self.transmittance)
    }

    fn new(color: &Color, replayed: &ReplayedTerm) -> Self {
        Self {
            term: TermReport::new(color, replayed),
            score: replayed.selection.map(|selection| selection.score),
            // Where nothing is chosen, everything is traced.
            prob: replayed.selection.map_or(1.0, |selection| selection.prob),
            is_chosen: replayed.is_chosen(),
            is_visible: replayed.is_visible(),
            transmittance: replayed.transmittance,
        }
    }
}

//! `bidir render --replay`: one sample again, told step by step.

use crate::args::{RenderArgs, ReplayTarget};
use crate::console::{print, print_json};
use crate::exit::{Exit, Failure};
use bidir::driver::{Replay, Session};
use bidir::integrator::Workspace;
use bidir::path::{Subpath, Vertex, VertexKind};
use bidir::scene::Scene;
use bidir::select::Candidate;
use bidir::spectrum::{Rgb, Spectrum, Wavelengths};
use serde::Serialize;
use std::fmt;

/// A sample, told.
#[derive(Debug, Serialize)]
struct SampleReport {
    pixel: [u32; 2],
    pass: u64,
    camera: SubpathReport,
    light: SubpathReport,
    candidates: Vec<CandidateReport>,
    /// What was added to the light image.
    splats: Vec<SplatReport>,
    /// What was added to the pixel.
    value: Rgb,
    /// The part of it that came from candidates; the rest are hits of lights, and for integrators
    /// without candidates everything.
    value_of_candidates: Rgb,
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

#[derive(Debug, Serialize)]
struct CandidateReport {
    s: u16,
    t: u16,
    value: Rgb,
    score: f32,
    is_chosen: bool,
    /// The probability of being chosen, where it was.
    prob: Option<f64>,
    is_visible: bool,
    contribution: Rgb,
}

#[derive(Debug, Serialize)]
struct SplatReport {
    raster: [f32; 2],
    value: Rgb,
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
    let report = SampleReport::new(scene, target, &replay);
    if args.json {
        print_json(&report)
    } else {
        print(&report.to_string())
    }
}

impl SampleReport {
    fn new(scene: &Scene, target: ReplayTarget, replay: &Replay) -> Self {
        let workspace = &replay.workspace;
        let rgb = |value| to_rgb(scene, value);
        let candidates = workspace.candidates.iter().enumerate();
        let candidates: Vec<_> = candidates
            .map(|(i, c)| CandidateReport::new(scene, workspace, i, c))
            .collect();
        let sum = |channel: usize| candidates.iter().map(|c| c.contribution[channel]).sum();
        let splats = workspace.splats.iter();
        Self {
            pixel: target.pixel,
            pass: target.pass,
            camera: SubpathReport::new(scene, &workspace.camera),
            light: SubpathReport::new(scene, &workspace.light),
            value_of_candidates: std::array::from_fn(sum),
            candidates,
            splats: splats
                .map(|splat| SplatReport {
                    raster: splat.raster.to_array(),
                    value: rgb(splat.value),
                })
                .collect(),
            value: rgb(workspace.value),
            rays: workspace.stats.rays.total(),
            dropped: workspace.stats.dropped,
        }
    }
}

fn to_rgb(scene: &Scene, value: Spectrum) -> Rgb {
    scene.color().to_rgb(value, &Wavelengths::default())
}

impl SubpathReport {
    fn new(scene: &Scene, subpath: &Subpath) -> Self {
        let vertices = subpath
            .vertices
            .iter()
            .map(|vertex| VertexReport::new(scene, vertex));
        Self {
            vertices: vertices.collect(),
            escape: subpath.escape.map(|escape| escape.direction.to_array()),
        }
    }
}

impl VertexReport {
    fn new(scene: &Scene, vertex: &Vertex) -> Self {
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
            is_delta: vertex.is_delta(),
            light: vertex.light,
            beta: to_rgb(scene, vertex.beta),
            pdf_fwd: vertex.pdf_fwd,
            pdf_rev: vertex.pdf_rev,
        }
    }
}

impl CandidateReport {
    fn new(scene: &Scene, workspace: &Workspace, i: usize, candidate: &Candidate) -> Self {
        let (s, t) = (candidate.strategy.s, candidate.strategy.t);
        let (z, y) = workspace.ends(candidate.strategy);
        let is_visible = !scene.occluded(&z.segment_end(), &y.segment_end());
        let chosen = workspace
            .chosen
            .iter()
            .find(|chosen| chosen.candidate as usize == i);
        let contribution = match chosen {
            Some(chosen) if is_visible => candidate.contribution(chosen.prob),
            _ => Spectrum::ZERO,
        };
        Self {
            s,
            t,
            value: to_rgb(scene, candidate.value),
            score: candidate.score,
            is_chosen: chosen.is_some(),
            prob: chosen.map(|chosen| chosen.prob),
            is_visible,
            contribution: to_rgb(scene, contribution),
        }
    }
}

/// A point or direction, in columns.
struct Point([f32; 3]);

impl fmt::Display for Point {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.0;
        write!(f, "({x:>9.4} {y:>9.4} {z:>9.4})")
    }
}

/// Numbers of any size, in columns.
struct Triple([f32; 3]);

impl fmt::Display for Triple {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [a, b, c] = self.0;
        write!(f, "({a:>10.4e} {b:>10.4e} {c:>10.4e})")
    }
}

impl fmt::Display for SampleReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y] = self.pixel;
        writeln!(f, "pixel {x},{y} pass {}: {} rays", self.pass, self.rays)?;
        write!(f, "\ncamera subpath, {}", self.camera)?;
        write!(f, "\nlight subpath, {}", self.light)?;
        writeln!(f, "\n{} candidates", self.candidates.len())?;
        for (i, candidate) in self.candidates.iter().enumerate() {
            writeln!(f, "  {i:>3}  {candidate}")?;
        }
        writeln!(f, "\n{} splats to the light image", self.splats.len())?;
        for splat in &self.splats {
            let [x, y] = splat.raster;
            writeln!(f, "  at {x:.3},{y:.3}  value {}", Triple(splat.value))?;
        }
        writeln!(f, "\nadded to the pixel  {}", Triple(self.value))?;
        writeln!(
            f,
            "  by candidates     {}",
            Triple(self.value_of_candidates)
        )?;
        if self.dropped > 0 {
            writeln!(f, "dropped             {} contributions", self.dropped)?;
        }
        Ok(())
    }
}

impl fmt::Display for SubpathReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} vertices", self.vertices.len())?;
        for (i, vertex) in self.vertices.iter().enumerate() {
            writeln!(f, "  {i:>3}  {vertex}")?;
        }
        match self.escape {
            Some(direction) => writeln!(f, "       escapes along {}", Point(direction)),
            None => Ok(()),
        }
    }
}

impl fmt::Display for VertexReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let place = if self.is_infinite { "towards" } else { "at" };
        write!(f, "{:<7} {place} {}", self.kind, Point(self.position))?;
        write!(f, "  beta {}", Triple(self.beta))?;
        write!(
            f,
            "  pdf_fwd {:.4e}  pdf_rev {:.4e}",
            self.pdf_fwd, self.pdf_rev
        )?;
        if let Some(light) = self.light {
            write!(f, "  light {light}")?;
        }
        if self.is_delta {
            write!(f, "  delta")
        } else {
            Ok(())
        }
    }
}

impl fmt::Display for CandidateReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "s={} t={}", self.s, self.t)?;
        write!(
            f,
            "  value {}  score {:.4e}",
            Triple(self.value),
            self.score
        )?;
        match self.prob {
            Some(prob) => write!(f, "  chosen with probability {prob:.4}")?,
            None => write!(f, "  not chosen")?,
        }
        write!(
            f,
            "  {}",
            if self.is_visible {
                "visible"
            } else {
                "blocked"
            }
        )?;
        write!(f, "  contribution {}", Triple(self.contribution))
    }
}

//! a_i and b_i: the density of each vertex x_i drawn from the light and from the camera, area
//! measure, 1/m² (solid angle, 1/sr, for x_0 at infinity), with those probabilities of roulette that depend on one vertex (those by albedo).
//!
//! They describe the path, not the strategy that made it, so that every strategy finds the same
//! weight (docs/derivations/mis-weights.md).

use super::{HitPath, Job, JoinedPath, LightPointChoice, Vertex, mis_weight, next_event_pdf};
use crate::guide::Cell;

/// How likely one vertex of a path is to be drawn from either side, roulette included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VertexDensities {
    /// By a walk from the light. Measure: area, 1/m²; see [`crate::path`] for x_0.
    pub from_light: f32,
    /// By a walk from the camera. The same measure.
    pub from_camera: f32,
    /// True where the path scatters by a Dirac distribution here.
    pub is_delta: bool,
    /// The cell that it lies in.
    pub cell: Cell,
}

impl VertexDensities {
    /// Makes the densities of a vertex of a walk.
    #[inline]
    fn new(x: &Vertex, from_light: f32, from_camera: f32) -> Self {
        Self {
            from_light,
            from_camera,
            is_delta: x.went_by_delta,
            cell: x.cell,
        }
    }
}

/// The densities of a whole path x_0 … x_{n-1}: all that weights depend on.
#[derive(Clone, Debug, Default)]
pub struct PathDensities {
    /// One entry per vertex, from the light.
    pub vertices: Vec<VertexDensities>,
    /// The density e of x_0 when strategy s = 1 draws it, by area, by volume in a medium, or by solid angle at infinity.
    pub next_event: f32,
    /// True where no ray can hit the light by chance.
    pub light_is_delta: bool,
}

impl PathDensities {
    /// Collects the densities of a path that connects two subpaths.
    ///
    /// Stored densities hold except next to the connection, where each end has a new neighbour: the two
    /// ends and the vertices before them are evaluated again. The ends scatter by lobes that are not Dirac.
    pub fn gather_connection(&mut self, job: &Job<'_>, path: &JoinedPath<'_>) {
        let (s, n) = (path.light.len(), path.len());
        self.vertices.clear();
        let light = stored_densities(job, path.light, n).zip(path.light);
        let of_light = light.map(|([drawn, back], x)| VertexDensities::new(x, drawn, back));
        self.vertices.extend(of_light);
        self.add_camera(job, path.camera, n);
        let Reversed { z, y, before } = path.reversed(job);
        let x = &mut self.vertices;
        (x[s - 1].from_camera, x[s].from_light) = (z, y);
        (x[s - 1].is_delta, x[s].is_delta) = (false, false);
        if s > 1 {
            x[s - 2].from_camera = before[0];
        }
        if path.camera.len() > 1 {
            x[s + 1].from_light = before[1];
        }
        self.describe_light(job, path.vertex(0), path.vertex(1));
    }

    /// Collects the densities of a path whose camera walk came upon the light: all but the first two are stored.
    pub fn gather_hit(&mut self, job: &Job<'_>, path: &HitPath<'_>) {
        let (x0, camera) = (&path.x0, path.camera);
        self.vertices.clear();
        let of_light = VertexDensities::new(x0, x0.pdf_fwd, path.camera_pdf(job));
        self.vertices.push(of_light);
        self.add_camera(job, camera, camera.len() + 1);
        self.vertices[1].from_light = path.light_pdf(job);
        self.describe_light(job, x0, path.y());
    }

    /// Adds the vertices of a camera subpath of a path of `n`, the last one first.
    fn add_camera(&mut self, job: &Job<'_>, camera: &[Vertex], n: usize) {
        let walk = stored_densities(job, camera, n).zip(camera).rev();
        let of_camera = walk.map(|([drawn, back], x)| VertexDensities::new(x, back, drawn));
        self.vertices.extend(of_camera);
    }

    /// Notes how next-event estimation would draw x_0 for x_1.
    fn describe_light(&mut self, job: &Job<'_>, x0: &Vertex, x1: &Vertex) {
        self.light_is_delta = x0.is_on_delta_light(job);
        self.next_event = next_event_density(job, x0, x1);
    }

    /// Returns the weight of strategy `s`.
    #[inline]
    pub(super) fn weight(&self, job: &Job<'_>, s: usize) -> f32 {
        mis_weight(self, |j| self.count(job, j), job.settings.mis, s) as f32
    }
}

/// The densities next to a connection, where each end has a new neighbour: of the two ends and the
/// vertices before them, each drawn by a walk from the other end of the path.
pub(super) struct Reversed {
    /// b_{s-1}, of the light vertex.
    pub(super) z: f32,
    /// a_s, of the camera vertex.
    pub(super) y: f32,
    /// b_{s-2} and a_{s+1}, of the vertices before them; 0 where there is none.
    pub(super) before: [f32; 2],
}

impl JoinedPath<'_> {
    /// Evaluates the densities next to the connection.
    #[inline]
    pub(super) fn reversed(&self, job: &Job<'_>) -> Reversed {
        let (s, t) = (self.light.len(), self.camera.len());
        let (z, y, segment) = (self.z(), self.y(), &self.segment);
        let [at_z, at_y] = &self.events;
        let a_s = at_z.pdf(job) * segment.to_b * factor(job, s, || z.albedo_fwd);
        let mut before = [0.0; 2];
        if s > 1 {
            let (pdf, albedo) = at_z.reversed();
            before[0] = pdf * z.to_previous * factor(job, t + 1, || albedo);
        }
        if t > 1 {
            let (pdf, albedo) = at_y.reversed();
            before[1] = pdf * y.to_previous * factor(job, s + 1, || albedo);
        }
        let survival = factor(job, t, || y.albedo_fwd);
        Reversed {
            z: at_y.pdf(job) * segment.to_a * survival,
            y: a_s,
            before,
        }
    }
}

impl HitPath<'_> {
    /// Returns a_1, the density with which a light walk draws the last camera vertex; no roulette guards its first step.
    #[inline]
    pub(super) fn light_pdf(&self, job: &Job<'_>) -> f32 {
        let segment = &self.segment;
        self.x0.pdf_leaving(job, segment.w) * segment.to_b
    }

    /// Returns b_0, the density with which the camera walk drew x_0.
    #[inline]
    pub(super) fn camera_pdf(&self, job: &Job<'_>) -> f32 {
        self.drawn_pdf * factor(job, self.camera.len(), || self.y().albedo_fwd)
    }
}

/// Returns e, the density with which strategy s = 1 draws x_0 where `x1` is the next vertex.
#[inline]
pub(super) fn next_event_density(job: &Job<'_>, x0: &Vertex, x1: &Vertex) -> f32 {
    let Some(index) = x0.light else { return 0.0 };
    match (job.settings.light_point, x1.is_camera()) {
        // Of a camera and a light both at infinity no connection makes a path: the camera has to
        // see the light by itself.
        (_, true) if x0.locus.is_infinite() && x1.locus.is_infinite() => 0.0,
        // A path of two vertices has its s = 1 by t = 1, which uses the light subpath's x_0.
        (LightPointChoice::Shared, _) | (_, true) => x0.pdf_fwd,
        _ => next_event_pdf(job, x1, index, &x0.light_point()),
    }
}

/// Returns the roulette's part of the density of vertex number `index` of a walk (0 is its end of the
/// path), with the albedo that the walk meets at the vertex before it.
#[inline]
pub(super) fn factor(job: &Job<'_>, index: usize, albedo: impl FnOnce() -> f32) -> f32 {
    // Vertex 1 is drawn by the end of the path itself, which no roulette guards.
    if index < 2 {
        1.0
    } else {
        job.settings.roulette.density_factor(index - 2, albedo)
    }
}

/// Returns the densities of a subpath's vertices as stored: by its own walk, and by one from the other end
/// of a path of `n` vertices. The latter is not valid for the last two.
pub(super) fn stored_densities(
    job: &Job<'_>,
    subpath: &[Vertex],
    n: usize,
) -> impl DoubleEndedIterator<Item = [f32; 2]> + ExactSizeIterator {
    subpath.iter().enumerate().map(move |(i, vertex)| {
        let before = || subpath[i - 1].albedo_fwd;
        let after = || subpath.get(i + 1).map_or(1.0, |next| next.albedo_rev);
        [
            vertex.pdf_fwd * factor(job, i, before),
            vertex.pdf_rev * factor(job, n - 1 - i, after),
        ]
    })
}

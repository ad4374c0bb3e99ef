//! w = p/(p + q) by the balance heuristic, p²/(p² + q²) by the power heuristic \[Veach95\]: path
//! tracing with next-event estimation. p and q are densities in the same measure, area or solid
//! angle. It walks no light subpaths and chooses no shadow rays: all are traced.

use super::{Integrator, Sample, Workspace};
use crate::light::LightPoint;
use crate::path::{MisHeuristic, PathContext, Strategy, Vertex, connect, next_event_vertex};
use crate::sampler::{Dimension, Purpose};
use crate::spectrum::Spectrum;

/// Path tracing: at every vertex of a camera subpath the light that is hit and the light that
/// next-event estimation finds, combined by multiple importance sampling \[Veach95\].
///
/// It shares walks and scattering with the bidirectional estimator, but not its weights: a path's
/// last vertex x_0 has density p by scattering at x_1 and q by next-event estimation, and nothing
/// else is asked.
#[derive(Clone, Copy, Debug)]
pub struct PathTracer;

impl Integrator for PathTracer {
    fn sample(&self, context: &PathContext<'_>, sample: &Sample, workspace: &mut Workspace) {
        workspace.begin();
        workspace.walk_camera(context, sample);
        for i in 1..workspace.camera.vertices.len() {
            let vertex = workspace.camera.vertices[i];
            if let Some(light) = vertex.light {
                let value = vertex.beta * emitted(context, light, &vertex);
                let weight = hit_weight(context, workspace, i, light, &vertex.light_point());
                workspace.add(sample, Strategy::new(0, i + 1), value * weight);
            }
            if i + 2 <= context.settings.max_vertices() && !vertex.is_delta() {
                next_event(context, sample, workspace, i);
            }
        }
        escape(context, sample, workspace);
    }
}

/// Light that a surface sends back along the walk.
fn emitted(context: &PathContext<'_>, light: u32, vertex: &Vertex) -> Spectrum {
    let rgb = context
        .scene
        .light(light)
        .emitted(&vertex.light_point(), vertex.wo);
    context.scene.color().illuminant(rgb, &context.wavelengths)
}

/// The share of a density `p` against `q`.
fn share(heuristic: MisHeuristic, p: f32, q: f32) -> f32 {
    match heuristic {
        MisHeuristic::Balance => 1.0 / (1.0 + q / p),
        MisHeuristic::Power => 1.0 / (1.0 + (q / p) * (q / p)),
        MisHeuristic::Uniform if q > 0.0 => 0.5,
        MisHeuristic::Uniform => 1.0,
    }
}

/// The weight of hitting `at` after vertex `i - 1`: 1 where next-event estimation cannot do it.
fn hit_weight(
    context: &PathContext<'_>,
    workspace: &Workspace,
    i: usize,
    light: u32,
    at: &LightPoint,
) -> f32 {
    let from = &workspace.camera.vertices[i - 1];
    if i == 1 || from.is_delta() {
        return 1.0;
    }
    let p = match workspace.camera.escape {
        Some(escape) if at.is_infinite => escape.pdf_fwd,
        _ => workspace.camera.vertices[i].pdf_fwd,
    };
    share(
        context.settings.mis,
        p,
        next_event_pdf(context, light, from, at),
    )
}

/// The density with which next-event estimation at `from` draws `at`.
fn next_event_pdf(context: &PathContext<'_>, light: u32, from: &Vertex, at: &LightPoint) -> f32 {
    let scene = context.scene;
    let pdf = scene
        .light(light)
        .pdf_next_event(&scene.light_context(), from.point, at);
    scene.light_choice().prob(light as usize) * pdf
}

/// Connects vertex `i` with a light point.
fn next_event(context: &PathContext<'_>, sample: &Sample, workspace: &mut Workspace, i: usize) {
    let camera = &workspace.camera.vertices[..=i];
    let vertex = camera[i];
    let u_light = sample
        .camera
        .get_1d(Dimension::at(i, Purpose::NextEventLight));
    let u = sample
        .camera
        .get_2d(Dimension::at(i, Purpose::NextEventPosition));
    let Some(x0) = next_event_vertex(context, &vertex, u_light, u) else {
        return;
    };
    let value = connect(context, &[x0], camera);
    if value == Spectrum::ZERO {
        return;
    }
    let Some(light) = x0.light else { return };
    let q = next_event_pdf(context, light, &vertex, &x0.light_point());
    let p = if context.scene.light(light).is_delta() {
        0.0
    } else {
        vertex.pdf_to(context, vertex.wo, &x0)
    };
    let value = value * share(context.settings.mis, q, p);
    workspace.stats.candidates += 1;
    let strategy = Strategy::new(1, i + 1);
    if workspace.accepts(sample, strategy, value)
        && workspace.trace_connection(context.scene, &x0, &vertex)
    {
        workspace.add(sample, strategy, value);
    }
}

/// Adds the lights at infinity that the walk escaped to.
fn escape(context: &PathContext<'_>, sample: &Sample, workspace: &mut Workspace) {
    let Some(escape) = workspace.camera.escape else {
        return;
    };
    let i = workspace.camera.vertices.len();
    let at = LightPoint::at_infinity(escape.direction);
    for &light in context.scene.environment() {
        let rgb = context.scene.light(light).emitted(&at, -escape.direction);
        let radiance = context.scene.color().illuminant(rgb, &context.wavelengths);
        let weight = hit_weight(context, workspace, i, light, &at);
        workspace.add(
            sample,
            Strategy::new(0, i + 1),
            escape.beta * radiance * weight,
        );
    }
}

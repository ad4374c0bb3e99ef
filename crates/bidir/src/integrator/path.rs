//! w = p/(p + q) by the balance heuristic, p²/(p² + q²) by the power heuristic \[Veach95\]: path
//! tracing with next-event estimation. p and q are densities in the same measure, area or solid
//! angle. It walks no light subpaths and chooses no shadow rays: all are traced.

use super::{Integrator, Link, Sample, Workspace};
use crate::bsdf::TransportMode;
use crate::contribution::Term;
use crate::light::LightSample;
use crate::path::{
    Arrival, PathContext, Segment, Strategy, Turn, next_event_pdf, sample_next_event,
};
use crate::sampler::{Dimension, Purpose};
use crate::spectrum::Spectrum;
use crate::stats::Stage;

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
            let vertex = &workspace.camera.vertices[i];
            let connects = i + 2 <= context.settings.max_vertices() && !vertex.is_delta();
            if let Some(arrival) = Arrival::at(vertex) {
                hit(context, sample, workspace, i, &arrival);
            }
            if connects {
                next_event(context, sample, workspace, i);
            }
        }
        if let Some(escape) = workspace.camera.escape {
            let i = workspace.camera.vertices.len();
            for arrival in Arrival::of_escape(context.scene, escape) {
                hit(context, sample, workspace, i, &arrival);
            }
        }
        workspace.stopwatch.end(Stage::Direct);
    }
}

/// Adds the light that the walk came upon after the first `i` vertices.
fn hit(
    context: &PathContext<'_>,
    sample: &Sample,
    workspace: &mut Workspace,
    i: usize,
    arrival: &Arrival,
) {
    let contribution = arrival.contribution(context);
    if contribution != Spectrum::ZERO {
        let from = &workspace.camera.vertices[i - 1];
        // Next-event estimation begins at the first surface, and skips Dirac scattering.
        let weight = if i == 1 || from.went_by_delta {
            1.0
        } else {
            let q = next_event_pdf(context, from, arrival.light, &arrival.at);
            context.settings.mis.weight_of_two(arrival.pdf, q)
        };
        let term = Term::new(Strategy::new(0, i + 1), arrival.light, contribution, weight);
        workspace.add_hit(sample, term);
    }
}

/// Connects vertex `i` with a light point.
fn next_event(context: &PathContext<'_>, sample: &Sample, workspace: &mut Workspace, i: usize) {
    let vertex = &workspace.camera.vertices[i];
    let at = |purpose| Dimension::at(i, purpose);
    let u_light = || sample.camera.get_1d(at(Purpose::NextEventLight));
    let u = sample.camera.get_2d(at(Purpose::NextEventPosition));
    let Some((light, x0)) = sample_next_event(context, vertex, u_light, u) else {
        return;
    };
    let ends = [x0.at.locus, vertex.locus];
    let segment = Segment::between(&ends[0], &ends[1]);
    let turn = vertex.turn(vertex.wo, -segment.w);
    let contribution = arriving(context, &turn, light, &x0, &segment);
    if contribution == Spectrum::ZERO {
        return;
    }
    let p = if context.scene.light(light).is_delta() {
        0.0
    } else {
        turn.pdf(context) * segment.to_a
    };
    let weight = context.settings.mis.weight_of_two(x0.pdf, p);
    let term = Term::new(Strategy::new(1, i + 1), light, contribution, weight);
    let term = workspace.count(term, |_| Link::Connection(ends));
    if workspace.accepts(sample, &term, term.value())
        && let Some(transmittance) = workspace.trace(context.scene, &term, &ends)
    {
        workspace.add(sample, term.certain(transmittance));
    }
}

/// L_e · G · scatter · β / q: the light of the light point x_0, drawn with density q, that arrives by the
/// vertex of `turn`, before weight and visibility.
#[inline]
fn arriving(
    context: &PathContext<'_>,
    turn: &Turn<'_>,
    light: u32,
    x0: &LightSample,
    segment: &Segment,
) -> Spectrum {
    let factor = segment.geometry_term * x0.coverage / x0.pdf;
    if factor == 0.0 {
        return Spectrum::ZERO;
    }
    let emitted = context.emitted(light, &x0.at, segment.w);
    if emitted.is_black() {
        return Spectrum::ZERO;
    }
    emitted * turn.scatter(context, TransportMode::Radiance) * turn.vertex().beta * factor
}

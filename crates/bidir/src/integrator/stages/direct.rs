//! Path tracing with next-event estimation, weighted by w = p/(p + q), the balance heuristic, or p²/(p² + q²), the power
//! heuristic \[Veach95\].
//!
//! It shares walks and scattering with the bidirectional estimator, but not its weights: a path's last vertex x_0 has
//! density p by scattering at x_1 and q by next-event estimation, in the same measure, area or solid angle.

use super::super::journal::enter;
use super::super::{Entry, Link, Sample, Walks, Worker};
use super::media::TracedShadow;
use super::trace::trace;
use crate::bsdf::TransportMode;
use crate::contribution::Term;
use crate::light::LightSample;
use crate::locus::Locus;
use crate::path::{
    Arrival, Job, ScatteringEvent, Segment, Vertex, next_event_pdf, sample_next_event,
};
use crate::sampler::{Dimension, Purpose};
use crate::spectrum::Spectrum;
use crate::stats::Stage;
use crate::strategy::Strategy;

/// Adds at every vertex of the camera subpaths the light that is hit and the light that next-event estimation
/// finds, and traces all shadow rays.
#[inline(never)]
pub(in super::super) fn direct(
    job: &Job<'_>,
    walks: &Walks,
    entries: &mut Vec<Entry>,
    worker: &mut Worker,
) {
    let Worker {
        shadow_rays, stats, ..
    } = worker;
    for (index, sample) in walks.samples.iter().enumerate() {
        let walk = walks.camera.get(index);
        for (i, vertex) in walk.vertices.iter().enumerate().skip(1) {
            if let Some(arrival) = Arrival::at(vertex)
                && let Some(term) = hit(job, &walk.vertices[..i], &arrival)
            {
                enter(entries, stats, index, sample, term, Link::Walk);
            }
            let connects = i + 2 <= job.settings.max_vertices() && !vertex.is_delta();
            if connects && let Some(found) = next_event(job, sample, vertex, i) {
                let (term, ends, shadow) = found;
                let link = Link::Connection(ends);
                let entry = enter(entries, stats, index, sample, term, link);
                shadow.apply(entry, stats);
            }
        }
        let escape = walk.escape.into_iter();
        for arrival in escape.flat_map(|escape| Arrival::of_escape(job.scene, escape)) {
            if let Some(term) = hit(job, walk.vertices, &arrival) {
                enter(entries, stats, index, sample, term, Link::Walk);
            }
        }
    }
    trace(job, entries, shadow_rays, stats);
    worker.stopwatch.end(Stage::Direct);
}

/// Returns the term of the light that the walk came upon after the vertices `before`. None: it is zero.
fn hit(job: &Job<'_>, before: &[Vertex], arrival: &Arrival) -> Option<Term> {
    let contribution = arrival.contribution(job);
    if contribution == Spectrum::ZERO {
        return None;
    }
    let from = &before[before.len() - 1];
    // Next-event estimation begins at the first surface, and skips Dirac scattering.
    let weight = if before.len() == 1 || from.went_by_delta {
        1.0
    } else {
        let q = next_event_pdf(job, from, arrival.light, &arrival.at);
        job.settings.mis.weight_of_two(arrival.pdf, q)
    };
    Some(Term {
        strategy: Strategy::new(0, before.len() + 1),
        light: arrival.light,
        contribution,
        weight,
    })
}

/// Returns the term that connects `vertex`, number `i` of its walk, with a light point, the ends of its shadow ray,
/// and the media between them.
/// None: it is zero.
fn next_event(
    job: &Job<'_>,
    sample: &Sample,
    vertex: &Vertex,
    i: usize,
) -> Option<(Term, [Locus; 2], TracedShadow)> {
    let at = |purpose| Dimension::at(i, purpose);
    let u_light = || sample.points.get_1d(at(Purpose::NextEventLight));
    let u = sample.points.get_2d(at(Purpose::NextEventPosition));
    let u_depth = || sample.points.get_1d(at(Purpose::NextEventDepth));
    let (light, x0) = sample_next_event(job, vertex, u_light, u, u_depth)?;
    let mut ends = [x0.at.locus, vertex.locus];
    if job.scene.has_media() {
        ends[0].media = job.scene.light_media(light);
    }
    let mut segment = Segment::between(&ends[0], &ends[1]);
    let event = vertex.event(vertex.wo, -segment.w, TransportMode::Radiance);
    let contribution = arriving(job, &event, light, &x0, &segment);
    if contribution == Spectrum::ZERO {
        return None;
    }
    let shadow = TracedShadow::between(job, || ends);
    if let Some(edge) = shadow.edge() {
        segment.pass(edge);
    }
    let p = if job.scene.light(light).is_delta() {
        0.0
    } else {
        event.pdf(job) * segment.to_a
    };
    let term = Term {
        strategy: Strategy::new(1, i + 1),
        light,
        contribution,
        weight: job.settings.mis.weight_of_two(x0.pdf, p),
    };
    Some((term, ends, shadow))
}

/// Returns L_e · G · scatter · β / q: the light of the light point x_0, drawn with density q, that arrives by the
/// vertex of `event`, before weight and visibility.
#[inline]
fn arriving(
    job: &Job<'_>,
    event: &ScatteringEvent<'_>,
    light: u32,
    x0: &LightSample,
    segment: &Segment,
) -> Spectrum {
    let factor = segment.geometry_term * x0.alpha / x0.pdf;
    if factor == 0.0 {
        return Spectrum::ZERO;
    }
    let emitted = job.emitted(light, &x0.at, segment.w);
    if emitted.is_black() {
        return Spectrum::ZERO;
    }
    emitted * event.scatter(job) * event.vertex.beta * factor
}

//! Bidirectional path tracing [Veach97, §10], with its shadow rays chosen \[Lafortune95\].

use super::light::{lens_vertex, light_image};
use super::pairs::Pairs;
use super::workspace::own_light_vertices;
use super::{Integrator, Link, Sample, Workspace};
use crate::contribution::{Contribution, Term};
use crate::math::ONE_MINUS_EPSILON;
use crate::path::{
    Arrival, JoinedPath, LightPointChoice, PathContext, PathDensities, Shares, Strategy, Vertex,
    sample_next_event,
};
use crate::sampler::{Dimension, Purpose, kronecker_point};
use crate::select::{Candidate, Draws, LightVertex, Selector};
use crate::spectrum::Spectrum;
use crate::stats::Stage;

/// Bidirectional path tracing: every strategy (s, t), weighted, with the connections that
/// `selector` chooses.
pub struct Bdpt {
    /// Chooses the connections that are traced.
    pub selector: Box<dyn Selector>,
}

impl Integrator for Bdpt {
    fn sample(&self, context: &PathContext<'_>, sample: &Sample, workspace: &mut Workspace) {
        workspace.begin();
        workspace.walk_camera(context, sample);
        workspace.walk_light(context, sample);
        workspace.sum_weights(context);
        hits(context, sample, workspace);
        workspace.stopwatch.end(Stage::Hits);
        light_images(context, sample, workspace);
        workspace.stopwatch.end(Stage::LightImage);
        gather_candidates(context, sample, workspace);
        workspace.stopwatch.end(Stage::Candidates);
        choose_and_trace(&*self.selector, context, sample, workspace);
    }
}

/// s = 0: the camera subpath hits lights, or escapes to those at infinity. No shadow rays.
#[inline(never)] // So that profiles show the stages, each of which is called once.
pub(super) fn hits(context: &PathContext<'_>, sample: &Sample, workspace: &mut Workspace) {
    let count = workspace.camera.vertices.len();
    for i in 1..count {
        if let Some(arrival) = Arrival::at(&workspace.camera.vertices[i]) {
            hit(context, sample, workspace, i, &arrival);
        }
    }
    if let Some(escape) = workspace.camera.escape {
        for arrival in Arrival::of_escape(context.scene, escape) {
            hit(context, sample, workspace, count, &arrival);
        }
    }
}

/// Adds the path whose camera vertices are the first `i`, and whose x_0 is on the light that was hit.
fn hit(
    context: &PathContext<'_>,
    sample: &Sample,
    workspace: &mut Workspace,
    i: usize,
    arrival: &Arrival,
) {
    if !context.takes(0, i + 1) {
        return;
    }
    let contribution = arrival.contribution(context);
    if contribution == Spectrum::ZERO {
        return;
    }
    let Workspace {
        camera, weights, ..
    } = workspace;
    let x0 = arrival.vertex(context);
    let path = JoinedPath::hit(&x0, &camera.vertices[..i]);
    let weight = weights.weight(context, &path);
    let strategy = Strategy::new(0, i + 1);
    let term = Term::new(strategy, arrival.light, contribution, weight);
    workspace.add_hit(sample, term);
}

/// t = 1: every light vertex is connected to a lens point of its own. All of these rays are traced.
#[inline(never)]
pub(super) fn light_images(context: &PathContext<'_>, sample: &Sample, workspace: &mut Workspace) {
    for s in 1..=workspace.light.vertices.len() {
        if !context.takes(s, 1) {
            continue;
        }
        let Workspace { light, weights, .. } = workspace;
        let lens = lens_vertex(context, sample, s);
        let Some(image) = light_image(context, &light.vertices[..s], &lens) else {
            continue;
        };
        let image = image.weighted(weights.weight(context, &image.path));
        workspace.splat(context, sample, &image);
    }
}

/// s ≥ 1 and t ≥ 2: evaluates the connections, before visibility.
#[inline(never)]
fn gather_candidates(context: &PathContext<'_>, sample: &Sample, workspace: &mut Workspace) {
    let mut pairs = Pairs::new(context, &sample.camera);
    for t in 2..=workspace.camera.vertices.len() {
        let y = &workspace.camera.vertices[t - 1];
        if y.is_delta() {
            continue;
        }
        next_events(context, sample, workspace, t, 1);
        let longest = workspace
            .light
            .vertices
            .len()
            .min(context.settings.max_vertices() - t);
        for s in context.settings.light_point.first_walked()..=longest {
            if let Some(share) = pairs.take(s + t) {
                let connected = Connected {
                    strategy: Strategy::new(s, t),
                    light_vertex: LightVertex::Own,
                    share,
                };
                candidate(context, sample, workspace, connected);
            }
        }
    }
}

/// s = 1 with `count` light points for camera vertex number `t`, if it has its own: one of each
/// of as many parts of the lights, at points of a sequence that fills them evenly.
pub(super) fn next_events(
    context: &PathContext<'_>,
    sample: &Sample,
    workspace: &mut Workspace,
    t: usize,
    count: u16,
) {
    let is_fresh = context.settings.light_point == LightPointChoice::Fresh;
    if !is_fresh || t >= context.settings.max_vertices() || !context.takes(1, t) {
        return;
    }
    for k in 0..count {
        let y = &workspace.camera.vertices[t - 1];
        let Some(x0) = light_point(context, sample, y, t, [k, count]) else {
            continue;
        };
        let light_vertex = LightVertex::NextEvent(workspace.next_events.len() as u32);
        workspace.next_events.push(x0);
        let connected = Connected {
            strategy: Strategy::new(1, t),
            light_vertex,
            share: 1.0,
        };
        candidate(context, sample, workspace, connected);
    }
}

/// Light point number `k` of `count` for `y`, camera vertex number `t`. Each counts 1 / `count`.
fn light_point(
    context: &PathContext<'_>,
    sample: &Sample,
    y: &Vertex,
    t: usize,
    [k, count]: [u16; 2],
) -> Option<Vertex> {
    let at = |purpose| Dimension::at(t - 1, purpose);
    let part = |u: f32| ((f32::from(k) + u) / f32::from(count)).min(ONE_MINUS_EPSILON);
    let u_light = || part(sample.camera.get_1d(at(Purpose::NextEventLight)));
    let u = sample.camera.get_2d(at(Purpose::NextEventPosition));
    let (light, drawn) = sample_next_event(context, y, u_light, kronecker_point(u, k))?;
    let mut x0 = Vertex::light(context, light, &drawn.at);
    x0.beta = Spectrum::splat(drawn.coverage / (drawn.pdf * f32::from(count)));
    Some(x0)
}

/// A pair of vertices that is connected.
#[derive(Clone, Copy)]
struct Connected {
    strategy: Strategy,
    light_vertex: LightVertex,
    /// How much it counts.
    share: f32,
}

/// Evaluates a connection, and offers it for selection.
fn candidate(
    context: &PathContext<'_>,
    sample: &Sample,
    workspace: &mut Workspace,
    connected: Connected,
) {
    let Connected {
        strategy,
        light_vertex,
        ..
    } = connected;
    if let Some(term) = connection(context, workspace, connected) {
        let link = |workspace: &Workspace| Link::Connection(workspace.ends(strategy, light_vertex));
        let term = workspace.count(term, link);
        offer(context, sample, workspace, term, light_vertex);
    }
}

/// Offers a term for selection. It is compared by its luminance times the √V̂ of its shadow ray.
#[inline]
pub(super) fn offer(
    context: &PathContext<'_>,
    sample: &Sample,
    workspace: &mut Workspace,
    term: Term,
    light_vertex: LightVertex,
) {
    let value = term.value();
    if workspace.accepts(sample, &term, value) && !value.is_black() {
        let luminance = context.luminance(value.map(f32::abs));
        let [z, y] = workspace.vertices(term.strategy, light_vertex);
        let score = luminance * context.root_visibility(z, y);
        let candidate = Candidate::new(term, score, light_vertex);
        workspace.candidates.push(candidate);
    }
}

/// The term of a connection. None: it is zero.
fn connection(
    context: &PathContext<'_>,
    workspace: &mut Workspace,
    connected: Connected,
) -> Option<Term> {
    let Connected {
        strategy,
        light_vertex,
        share,
    } = connected;
    let (s, t) = (usize::from(strategy.s), usize::from(strategy.t));
    if !context.takes(s, t) {
        return None;
    }
    let Workspace {
        light,
        camera,
        next_events,
        weights,
        ..
    } = workspace;
    let camera = &camera.vertices[..t];
    let light = own_light_vertices(light, next_events, s, light_vertex);
    let start = light[0].light?;
    let path = JoinedPath::connection(light, camera);
    let contribution = path.contribution(context);
    (contribution != Spectrum::ZERO).then(|| {
        let weight = weights.weight(context, &path);
        Term::new(strategy, start, contribution * share, weight)
    })
}

/// Has `selector` choose among the candidates, and traces what it chose.
pub(super) fn choose_and_trace(
    selector: &dyn Selector,
    context: &PathContext<'_>,
    sample: &Sample,
    workspace: &mut Workspace,
) {
    let Workspace {
        candidates, chosen, ..
    } = workspace;
    selector.select(candidates, Draws(&sample.camera), chosen);
    workspace.stopwatch.end(Stage::Select);
    trace_chosen(context, sample, workspace);
    workspace.stopwatch.end(Stage::Shadow);
}

/// Traces the chosen connections and adds what arrives, divided by its probability.
#[inline(never)]
fn trace_chosen(context: &PathContext<'_>, sample: &Sample, workspace: &mut Workspace) {
    for i in 0..workspace.chosen.len() {
        let chosen = workspace.chosen[i];
        let candidate = workspace.candidates[chosen.candidate as usize];
        let Candidate {
            term, light_vertex, ..
        } = candidate;
        let ends = workspace.ends(term.strategy, light_vertex);
        if let Some(transmittance) = workspace.trace(context.scene, &term, &ends) {
            let contribution = Contribution {
                term,
                prob: chosen.prob,
                transmittance,
            };
            workspace.add(sample, contribution);
        }
    }
}

impl Workspace {
    /// The shares of the path of `contribution`, which the last sample, of [`Bdpt`], found by `light_vertex`. None:
    /// it found no such path.
    pub(crate) fn shares(
        &self,
        (context, sample): (&PathContext<'_>, &Sample),
        contribution: &Contribution,
        light_vertex: LightVertex,
        densities: &mut PathDensities,
    ) -> Option<Shares> {
        let Strategy { s, t } = contribution.term.strategy;
        let (s, t) = (usize::from(s), usize::from(t));
        let camera = &self.camera.vertices;
        let mut shares = |path: JoinedPath<'_>| path.shares(context, densities);
        Some(if s == 0 {
            let light = contribution.term.light;
            let arrival = Arrival::of(context.scene, &self.camera, t - 1, light)?;
            shares(JoinedPath::hit(&arrival.vertex(context), &camera[..t - 1]))
        } else if t == 1 {
            let lens = lens_vertex(context, sample, s);
            let lens = std::slice::from_ref(&lens);
            shares(JoinedPath::connection(&self.light.vertices[..s], lens))
        } else {
            let light = own_light_vertices(&self.light, &self.next_events, s, light_vertex);
            shares(JoinedPath::connection(light, &camera[..t]))
        })
    }
}

//! ⟨C⟩ = 1/(N M) Σ_m C(y, z_m) / P(z_m | y): bidirectional path tracing with a light vertex cache
//! [Davidovic14, §4]. A camera vertex y is connected with M of the K vertices z of N light subpaths, in place
//! of those of one; they are drawn by P ([`LightProposals`](crate::path::LightProposals)), or evenly, where
//! P = 1/K.
//!
//! **Weights.** For each vertex of the light subpath of a path, strategy (s, t) takes M N P samples on
//! average. K differs from group to group, and P with it; weights must not, or the estimate is biased. They
//! take M / κ in place of M N / K, with κ the mean of K / N in a training render
//! ([`PathContext::connections`](crate::path::PathContext::connections)), and for a learned P its stand-in
//! likewise.
//!
//! s = 0, s = 1 and t = 1 are those of [`Bdpt`](super::Bdpt), but that a camera vertex may have several
//! light points.

mod cache;
pub(super) mod settings;
#[cfg(test)]
mod tests;

pub(crate) use cache::{LightCache, connectable};

use super::bdpt::{choose_and_trace, hits, light_images, next_events, offer};
use super::{CandidateCount, Integrator, Link, Sample, SharedLight, Workspace};
use crate::contribution::Term;
use crate::locus::Locus;
use crate::path::{Connections, JoinedPath, PathContext, Strategy};
use crate::sampler::{Dimension, Purpose};
use crate::select::{LightVertex, Selector};
use crate::spectrum::Spectrum;
use crate::stats::Stage;
use cache::{Cached, Draw};

/// How many samples share light subpaths where so many pixels are rendered. So few that the subpaths stay
/// in a processor's cache, that there are some groups for every thread, and that pixels near each other
/// are in different groups.
pub(crate) fn group_size(pixels: u64) -> u64 {
    (pixels / 64).next_power_of_two().clamp(64, 2048)
}

/// Bidirectional path tracing with a light vertex cache, and with the connections that `selector`
/// chooses.
pub struct Lvc {
    /// Chooses the connections that are traced.
    pub selector: Box<dyn Selector>,
    /// M: how many vertices of the cache are candidates for a camera vertex.
    pub candidates: CandidateCount,
    /// How many light points are drawn for a camera vertex.
    pub next_events: CandidateCount,
}

impl Integrator for Lvc {
    fn sample(&self, context: &PathContext<'_>, sample: &Sample, workspace: &mut Workspace) {
        workspace.begin();
        workspace.walk_camera(context, sample);
        workspace.sum_weights(context);
        hits(context, sample, workspace);
        workspace.stopwatch.end(Stage::Hits);
        self.gather_candidates(context, sample, workspace);
        workspace.stopwatch.end(Stage::Candidates);
        choose_and_trace(&*self.selector, context, sample, workspace);
    }

    fn shared_light(&self) -> Option<&dyn SharedLight> {
        Some(self)
    }
}

impl SharedLight for Lvc {
    fn begin(&self, workspace: &mut Workspace) {
        workspace.light_cache.clear();
    }

    fn walk(&self, context: &PathContext<'_>, sample: &Sample, workspace: &mut Workspace) {
        workspace.begin();
        workspace.walk_light(context, sample);
        workspace.sum_weights(context);
        light_images(context, sample, workspace);
        workspace.stopwatch.end(Stage::LightImage);
        let Workspace {
            light,
            weights,
            light_cache,
            ..
        } = workspace;
        light_cache.push(context.settings.light_point, light, weights);
    }

    fn end(&self, connections: Connections<'_>, workspace: &mut Workspace) {
        workspace.light_cache.sort(connections.proposals);
    }
}

impl Lvc {
    /// s ≥ 1 and t ≥ 2: evaluates the connections of all camera vertices, before visibility.
    #[inline(never)]
    fn gather_candidates(
        &self,
        context: &PathContext<'_>,
        sample: &Sample,
        workspace: &mut Workspace,
    ) {
        let proposals = context.connections.proposals;
        for t in 2..=workspace.camera.vertices.len() {
            if workspace.camera.vertices[t - 1].is_delta() {
                continue;
            }
            next_events(context, sample, workspace, t, self.next_events.at(t));
            let at = Dimension::at(t - 1, Purpose::CachedVertex);
            let u = f64::from(sample.camera.get_1d(at));
            // One of each of as many parts of the cache.
            let count = self.candidates.at(t);
            for m in 0..count {
                let u = (f64::from(m) + u) / f64::from(count);
                let y = &workspace.camera.vertices[t - 1];
                if let Some(draw) = workspace.light_cache.draw(proposals, y, u) {
                    self.candidate(context, sample, workspace, t, draw);
                }
            }
        }
    }

    /// Evaluates the connection of camera vertex number `t` with a vertex of the cache, and offers it for
    /// selection.
    fn candidate(
        &self,
        context: &PathContext<'_>,
        sample: &Sample,
        workspace: &mut Workspace,
        t: usize,
        draw: Draw,
    ) {
        let Some((term, ends)) = self.connection(context, workspace, t, draw) else {
            return;
        };
        let term = workspace.count(term, |_| Link::Connection(ends));
        let light_vertex = LightVertex::Cached(draw.entry as u32);
        offer(context, sample, workspace, term, light_vertex);
    }

    /// The term of such a connection, with the ends of its shadow ray. None: it is zero.
    fn connection(
        &self,
        context: &PathContext<'_>,
        workspace: &mut Workspace,
        t: usize,
        draw: Draw,
    ) -> Option<(Term, [Locus; 2])> {
        let Workspace {
            camera,
            weights,
            light_cache,
            ..
        } = workspace;
        let Cached { light, shares } = light_cache.get(draw.entry);
        let s = light.len();
        if s + t > context.settings.max_vertices() || !context.takes(s, t) {
            return None;
        }
        let camera = &camera.vertices[..t];
        let path = JoinedPath::connection(light, camera);
        let contribution = path.contribution(context);
        if contribution == Spectrum::ZERO {
            return None;
        }
        let share = draw.share / f64::from(self.candidates.at(t));
        let term = Term::new(
            Strategy::new(s, t),
            light[0].light?,
            contribution * share as f32,
            weights.weight_of_cached(context, &path, shares),
        );
        let ends = [light[s - 1].locus, camera[t - 1].locus];
        Some((term, ends))
    }
}

//! Bidirectional path tracing with a light vertex cache [Davidovic14, §4]: a camera vertex is
//! connected with vertices of all light subpaths of the pass, drawn at random.

mod cache;

use super::bdpt::{hits, light_images, next_event};
use super::{Contribution, Integrator, Link, Sample, Term, Workspace};
use crate::path::{JoinedPath, PathContext, Strategy};
use crate::sampler::{Dimension, Purpose};
use crate::select::{Candidate, Draws, Selector};
use crate::spectrum::Spectrum;
use crate::stats::Stage;
use cache::Cached;
pub(super) use cache::LightCache;

/// Bidirectional path tracing with a light vertex cache.
pub struct Lvc {
    /// Chooses the connections that are traced.
    pub selector: Box<dyn Selector>,
    /// Vertices of the cache that are candidates for each camera vertex.
    pub candidates: u32,
    pub(super) cache: LightCache,
}

impl Integrator for Lvc {
    fn shares_light(&self) -> bool {
        true
    }

    fn begin_light(&mut self, subpaths: u64) {
        self.cache.begin(subpaths);
    }

    fn light_sample(
        &self,
        context: &PathContext<'_>,
        sample: &Sample,
        index: u64,
        workspace: &mut Workspace,
    ) {
        workspace.begin();
        workspace.walk_light(context, sample);
        workspace.sum_weights(context);
        light_images(context, sample, workspace);
        workspace.stopwatch.end(Stage::LightImage);
        self.cache
            .keep(index, &workspace.light, &workspace.weights);
    }

    fn end_light(&mut self, context: &PathContext<'_>) {
        self.cache.end(context);
    }

    fn sample(&self, context: &PathContext<'_>, sample: &Sample, workspace: &mut Workspace) {
        workspace.begin();
        workspace.walk_camera(context, sample);
        workspace.sum_weights(context);
        hits(context, sample, workspace);
        workspace.stopwatch.end(Stage::Hits);
        self.gather(context, sample, workspace);
        workspace.stopwatch.end(Stage::Candidates);
        let Workspace {
            candidates, chosen, ..
        } = workspace;
        self.selector
            .select(candidates, Draws(&sample.camera), chosen);
        workspace.stopwatch.end(Stage::Select);
        self.trace(context, sample, workspace);
        workspace.stopwatch.end(Stage::Shadow);
    }
}

impl Lvc {
    /// Evaluates the connections of all camera vertices, before visibility.
    fn gather(&self, context: &PathContext<'_>, sample: &Sample, workspace: &mut Workspace) {
        workspace
            .next_events
            .resize(workspace.camera.vertices.len(), None);
        for t in 2..=workspace.camera.vertices.len() {
            if workspace.camera.vertices[t - 1].is_delta() {
                continue;
            }
            next_event(context, sample, workspace, t);
            let u = sample
                .camera
                .get_1d(Dimension::at(t - 1, Purpose::CachedVertex));
            let (count, size) = (self.candidates as usize, self.cache.len());
            for m in 0..count {
                // One of each of as many strata.
                let i = (m as f64 + f64::from(u)) / count as f64 * size as f64;
                let i = i as usize;
                if i < size {
                    self.candidate(context, sample, workspace, t, i);
                }
            }
        }
    }

    fn candidate(
        &self,
        context: &PathContext<'_>,
        sample: &Sample,
        workspace: &mut Workspace,
        t: usize,
        i: usize,
    ) {
        let Cached { light, shares } = self.cache.get(i);
        let strategy = Strategy::new(light.len(), t);
        if light.len() + t > context.settings.max_vertices()
            || context.count(light.len(), t) == 0.0
        {
            return;
        }
        let Some(start) = light[0].light else { return };
        let Workspace {
            camera, weights, ..
        } = workspace;
        let path = JoinedPath::connection(light, &camera.vertices[..t]);
        let contribution = path.contribution(context);
        if contribution == Spectrum::ZERO {
            return;
        }
        // Of all subpaths' vertices this was one of so many.
        let scale = self.cache.per_subpath() / f64::from(self.candidates);
        let term = Term {
            strategy,
            light: start,
            contribution: contribution * scale as f32,
            weight: weights.weight_of_cached(context, &path, shares),
        };
        let ends = [
            path.light[light.len() - 1].segment_end(),
            path.camera[t - 1].segment_end(),
        ];
        let value = term.value();
        let weighted = (value, term.weight);
        workspace.count(term, |_| Link::Connection(ends));
        if workspace.accepts(sample, strategy, value) && !value.is_black() {
            let color = context.scene.color();
            let luminance = color.luminance(value.map(f32::abs), &context.wavelengths);
            let candidate = Candidate::new(strategy, term.light, weighted, luminance);
            workspace.candidates.push(candidate.of_cache(i as u32));
        }
    }

    /// Traces the chosen connections and adds what arrives, divided by its probability.
    fn trace(&self, context: &PathContext<'_>, sample: &Sample, workspace: &mut Workspace) {
        for i in 0..workspace.chosen.len() {
            let chosen = workspace.chosen[i];
            let candidate = workspace.candidates[chosen.candidate as usize];
            let contribution = Contribution {
                strategy: candidate.strategy,
                light: candidate.light,
                value: candidate.contribution(chosen.prob),
                weight: candidate.weight,
            };
            let ends = match candidate.cached {
                None => workspace.ends(candidate.strategy),
                Some(i) => {
                    let Cached { light, .. } = self.cache.get(i as usize);
                    let y = &workspace.camera.vertices[usize::from(candidate.strategy.t) - 1];
                    [light[light.len() - 1].segment_end(), y.segment_end()]
                }
            };
            if let Some(arrives) = workspace.trace(context.scene, candidate.strategy, &ends) {
                workspace.add(sample, contribution.behind(arrives));
            }
        }
    }
}

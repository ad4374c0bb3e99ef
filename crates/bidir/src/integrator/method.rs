//! Estimators as lists of stages.
//!
//! **Light vertex cache.** ⟨C⟩ = 1/(N M) Σ_m C(y, z_m) / P(z_m | y) [Davidovic14, §4]: a camera vertex y is
//! connected with M of the K vertices z that N light subpaths have together, in place of those of one subpath. Each is
//! drawn with probability P(z | y) ([`LightProposals`](crate::guide::LightProposals)), or 1/K where nothing is learned,
//! and a connection takes M N P samples. K differs from group to group; weights must not, or the estimate is biased. So
//! they count M / κ in place of M N / K, where κ is the mean of K / N in a training render
//! ([`SampleCounts`](crate::path::SampleCounts)), and a stand-in of the same kind for a learned P.

use super::stages::{
    Weighting, connect, direct, draw_cached, hits, light_image, next_events, own_light, select,
    shadow_rays, sum_camera, sum_light, walk_camera, walk_light,
};
use super::{Batch, CandidateCount, IntegratorKind, LvcSettings};
use crate::path::Job;
use crate::select::Selector;

/// Returns how many samples share light subpaths where this many pixels are rendered: a power of two from 64 to 2048. It
/// is so small that the subpaths stay in a processor's cache, and that a film of at least 1152 pixels has 18 groups:
/// pixels two apart are then in different ones (`driver::spread`).
pub(crate) fn group_size(pixels: u64) -> u64 {
    1 << (pixels / 18).clamp(64, 2048).ilog2()
}

/// An estimator of the image. Its expectation is the sum over all paths within the limit of length
/// that its strategies can make.
pub enum Method {
    /// Path tracing: at every vertex of a camera subpath the light that is hit and the light that
    /// next-event estimation finds, combined by multiple importance sampling \[Veach95\].
    Path,
    /// Light tracing: strategies t = 1 alone, each with weight 1. Unbiased for every path that does not end by a
    /// Dirac scattering at the last surface before the lens.
    Light,
    /// Bidirectional path tracing [Veach97, §10]: every strategy (s, t), weighted.
    Bdpt(Box<dyn Selector>),
    /// Bidirectional path tracing with a light vertex cache.
    Lvc(Box<dyn Selector>, LvcSettings),
}

impl Method {
    /// Returns the estimator; `selector` chooses the shadow rays of those that have candidates, and `lvc` is for
    /// those that share light subpaths.
    pub fn new(kind: IntegratorKind, selector: Box<dyn Selector>, lvc: &LvcSettings) -> Self {
        match kind {
            IntegratorKind::Path => Self::Path,
            IntegratorKind::Light => Self::Light,
            IntegratorKind::Bdpt => Self::Bdpt(selector),
            // `Auto` is decided before this; `Lvc` is its most frequent plan.
            IntegratorKind::Lvc | IntegratorKind::Auto => Self::Lvc(selector, *lvc),
        }
    }

    /// Returns true where the samples of a group share light subpaths.
    pub fn shares_light(&self) -> bool {
        matches!(self, Self::Lvc(..))
    }

    /// Computes the samples of `batch`: its entries, values and splats.
    ///
    /// A method that [shares light](Self::shares_light) uses the subpaths that [`walk_group`] added between
    /// [`Batch::forget_light`] and [`end_group`].
    pub fn run(&self, job: &Job<'_>, batch: &mut Batch) {
        if !self.shares_light() {
            batch.forget_light();
        }
        let Batch {
            walks,
            cache,
            light_ends,
            candidates,
            entries,
            splats,
            worker,
            ..
        } = batch;
        worker.stats.samples += walks.samples.len() as u64;
        worker.weights.set(job.settings);
        match self {
            Self::Path => {
                walk_camera(job, walks, worker);
                direct(job, walks, entries, worker);
            }
            Self::Light => {
                walk_light(job, walks, worker);
                light_image(job, walks, splats, worker, Weighting::Alone);
            }
            Self::Bdpt(selector) => {
                walk_camera(job, walks, worker);
                walk_light(job, walks, worker);
                sum_camera(job, walks, worker);
                sum_light(job, walks, worker);
                hits(job, walks, entries, worker);
                light_image(job, walks, splats, worker, Weighting::Combined);
                next_events(job, walks, light_ends, CandidateCount::of(1));
                own_light(job, walks, light_ends, worker);
                connect(job, walks, light_ends, candidates, worker);
                select(&**selector, walks, candidates, entries, worker);
                shadow_rays(job, walks, candidates, entries, worker);
            }
            Self::Lvc(selector, lvc) => {
                // `walk_group` has walked the light subpaths and made the light image.
                walk_camera(job, walks, worker);
                sum_camera(job, walks, worker);
                hits(job, walks, entries, worker);
                next_events(job, walks, light_ends, lvc.next_events);
                draw_cached(job, walks, cache, light_ends, lvc.candidates, worker);
                connect(job, walks, light_ends, candidates, worker);
                select(&**selector, walks, candidates, entries, worker);
                shadow_rays(job, walks, candidates, entries, worker);
            }
        }
        batch.sum_entries();
    }
}

/// Walks the light subpaths that the samples of `batch` bring to their group, and makes their light images.
pub fn walk_group(job: &Job<'_>, batch: &mut Batch) {
    let Batch {
        walks,
        splats,
        worker,
        ..
    } = batch;
    worker.weights.set(job.settings);
    walk_light(job, walks, worker);
    sum_light(job, walks, worker);
    light_image(job, walks, splats, worker, Weighting::Combined);
}

/// Makes ready what the samples of a group share, when all of it is walked.
pub fn end_group(job: &Job<'_>, batch: &mut Batch) {
    let proposals = job.guide.proposals;
    batch
        .cache
        .index(&batch.walks.light, job.settings.light_point, proposals);
}

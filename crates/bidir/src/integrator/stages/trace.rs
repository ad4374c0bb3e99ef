//! Choosing connections, and the shadow rays of those that were chosen.

use super::super::{Candidates, Entry, Link, Walks, Worker};
use super::media::trace_chosen_through_media;
use crate::path::Job;
use crate::scene::ShadowRayBuffers;
use crate::select::{Chosen, Draws, Selector};
use crate::stats::{Stage, Stats};

/// Has `rule` choose among the candidates of each sample, and adds the entries of those that are chosen.
pub(in super::super) fn select(
    rule: &dyn Selector,
    walks: &Walks,
    candidates: &mut Candidates,
    entries: &mut Vec<Entry>,
    worker: &mut Worker,
) {
    let Candidates {
        offered, chosen, ..
    } = candidates;
    let Walks { light, camera, .. } = walks;
    for (index, sample) in walks.samples.iter().enumerate() {
        let first = chosen.len();
        rule.select(offered.get(index), Draws(&sample.camera), chosen);
        let begin = offered.begin(index);
        for Chosen { candidate, .. } in &mut chosen[first..] {
            *candidate += begin as u32;
            let [z, _] = offered[*candidate as usize].vertices;
            light.load_locus_ahead(z as usize);
        }
    }
    // In a second loop, so that what the first began to load has arrived.
    let mut index = 0;
    for &Chosen { candidate, prob } in &*chosen {
        let candidate = candidate as usize;
        while candidate >= offered.begin(index + 1) {
            index += 1;
        }
        let of = &offered[candidate];
        let link = Link::Connection(of.ends(light, camera));
        entries.push(Entry {
            prob,
            ..Entry::certain(index, of.term, link)
        });
    }
    worker.stopwatch.end(Stage::Select);
}

/// Traces the shadow rays of all entries for the samples' own pixels.
#[inline(never)]
pub(in super::super) fn shadow_rays(
    job: &Job<'_>,
    walks: &Walks,
    candidates: &Candidates,
    entries: &mut [Entry],
    worker: &mut Worker,
) {
    if job.scene.has_media() && !job.scene.foresees_media() {
        trace_chosen_through_media(job, walks, candidates, entries, worker);
    }
    trace(job, entries, &mut worker.shadow_rays, &mut worker.stats);
    worker.stopwatch.end(Stage::Shadow);
}

/// Traces the shadow rays of `entries`, all together, and notes what arrives.
pub(super) fn trace(
    job: &Job<'_>,
    entries: &mut [Entry],
    memory: &mut ShadowRayBuffers,
    stats: &mut Stats,
) {
    let ends = entries.iter().filter_map(Entry::shadow_ray);
    let transmittances = job.scene.transmittances(ends, job.stop, memory);
    let traced = entries.iter_mut();
    let traced = traced.filter(|entry| entry.shadow_ray().is_some());
    for (entry, &transmittance) in traced.zip(transmittances) {
        entry.arrive(transmittance, stats);
    }
}

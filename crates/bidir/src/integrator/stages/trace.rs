//! Choosing connections, and the shadow rays of those that were chosen.

use super::super::{Batch, Entry, Fate, Link};
use super::media::settle_chosen;
use crate::contribution::Contribution;
use crate::path::Job;
use crate::scene::ShadowRays;
use crate::select::{Chosen, Draws, Selector};
use crate::stats::{Stage, Stats};

/// Has `rule` choose among the candidates of each sample.
pub(in super::super) fn select(rule: &dyn Selector, batch: &mut Batch) {
    let Batch {
        samples,
        light,
        camera,
        candidates,
        candidates_end,
        chosen,
        entries,
        ..
    } = batch;
    let mut begin = 0;
    for (sample, &end) in samples.iter().zip(&*candidates_end) {
        let first = chosen.len();
        rule.select(&candidates[begin..end], Draws(&sample.camera), chosen);
        for Chosen { candidate, .. } in &mut chosen[first..] {
            *candidate += begin as u32;
            let [z, _] = candidates[*candidate as usize].vertices;
            light.load_locus_ahead(z as usize);
        }
        begin = end;
    }
    let mut number = 0;
    for &Chosen { candidate, prob } in &*chosen {
        let candidate = candidate as usize;
        while candidate >= candidates_end[number] {
            number += 1;
        }
        let of = &candidates[candidate];
        entries.push(Entry {
            sample: number as u32,
            contribution: Contribution {
                term: of.term,
                prob,
                transmittance: 1.0,
            },
            link: Link::Connection(of.ends(light, camera)),
            fate: Fate::NotTraced,
        });
    }
    batch.stopwatch.end(Stage::Select);
}

/// Traces the shadow rays of all entries for the samples' own pixels.
#[inline(never)]
pub(in super::super) fn shadow_rays(job: &Job<'_>, batch: &mut Batch) {
    if job.scene.has_media() && !job.scene.foresees_media() {
        settle_chosen(job, batch);
    }
    let Batch {
        entries,
        shadow_rays,
        stats,
        ..
    } = batch;
    trace(job, entries, shadow_rays, stats);
    batch.stopwatch.end(Stage::Shadow);
}

/// Traces the shadow rays of `entries`, all together, and notes what arrives.
pub(super) fn trace(
    job: &Job<'_>,
    entries: &mut [Entry],
    memory: &mut ShadowRays,
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

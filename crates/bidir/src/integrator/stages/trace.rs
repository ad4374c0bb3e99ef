//! Choosing connections, and the shadow rays of those that were chosen.

use super::super::{Batch, Entry, Fate, Link};
use crate::contribution::Contribution;
use crate::path::Job;
use crate::scene::Scene;
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
    for (number, (sample, &end)) in samples.iter().zip(&*candidates_end).enumerate() {
        let first = chosen.len();
        let candidates = &candidates[begin..end];
        rule.select(candidates, Draws(&sample.camera), chosen);
        for Chosen { candidate, prob } in &mut chosen[first..] {
            let of = &candidates[*candidate as usize];
            *candidate += begin as u32;
            entries.push(Entry {
                sample: number as u32,
                contribution: Contribution {
                    term: of.term,
                    prob: *prob,
                    transmittance: 1.0,
                },
                link: Link::Connection(of.ends(light, camera)),
                fate: Fate::NotTraced,
            });
        }
        begin = end;
    }
    batch.stopwatch.end(Stage::Select);
}

/// Traces the shadow rays of all entries for the samples' own pixels.
#[inline(never)]
pub(in super::super) fn shadow_rays(job: &Job<'_>, batch: &mut Batch) {
    trace(job.scene, &mut batch.entries, &mut batch.stats);
    batch.stopwatch.end(Stage::Shadow);
}

/// Traces the shadow rays of `entries`, and notes what arrives.
#[inline]
pub(super) fn trace(scene: &Scene, entries: &mut [Entry], stats: &mut Stats) {
    for entry in entries {
        let Some([a, b]) = entry.link.ends() else {
            continue;
        };
        if entry.fate == Fate::Dropped {
            continue;
        }
        entry.fate = Fate::Added;
        let strategy = entry.contribution.term.strategy;
        stats.count_shadow_ray(strategy);
        entry.contribution.transmittance = scene.transmittance(a, b);
        if entry.contribution.transmittance <= 0.0 {
            stats.count_blocked(strategy);
            entry.fate = Fate::Blocked;
        }
    }
}

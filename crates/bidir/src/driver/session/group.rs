//! Groups of samples, each rendered by one thread. The samples of a group may share light subpaths, which are walked
//! first.

use super::Session;
use crate::integrator::{Batch, Entry, end_group, group_size, walk_group};
use crate::path::Job;
use crate::spectrum::Lanes;
use crate::stats::{Stage, Stats};
use std::ops::Range;

/// The size of a group that shares no light subpaths. Unit: samples.
const UNSHARED: u64 = 256;

impl Session<'_> {
    /// Returns the number of samples of a group.
    pub(super) fn group_size(&self) -> u64 {
        if self.method.shares_light() {
            group_size(self.view.film().crop.area())
        } else {
            UNSHARED
        }
    }

    /// Returns the meaning of lanes in the group of `slot`.
    pub(super) fn lanes(&self, slot: u64) -> Lanes {
        let group = slot / self.group_size();
        self.lanes[(group % self.lanes.len() as u64) as usize]
    }

    /// Returns the number of samples for each light subpath.
    pub(super) fn samples_per_subpath(&self) -> u64 {
        if self.method.shares_light() {
            u64::from(self.settings.lvc.samples_per_subpath.get())
        } else {
            1
        }
    }

    /// Returns the range of slots of the group of `slot`.
    pub(super) fn group(&self, slot: u64) -> Range<u64> {
        let size = self.group_size();
        let begin = slot / size * size;
        begin..(begin + size).min(self.view.film().crop.area())
    }

    /// Returns every k-th of `slots`, the range of a group: the slots whose samples own a light subpath.
    fn subpath_owners(&self, slots: Range<u64>) -> impl Iterator<Item = u64> {
        slots.step_by(usize::from(self.settings.lvc.samples_per_subpath.get()))
    }

    /// Walks the light subpaths of the group at `slots`, `size` at a time, and calls `on_batch` after each batch.
    pub(super) fn walk_light(
        &self,
        job: &Job<'_>,
        slots: Range<u64>,
        pass: u64,
        batch: &mut Batch,
        size: usize,
        mut on_batch: impl FnMut(&mut Batch),
    ) {
        batch.forget_light();
        let mut owners = self.subpath_owners(slots).peekable();
        while owners.peek().is_some() {
            batch.worker.stopwatch.begin();
            let slots = owners.by_ref().take(size);
            batch.fill(slots.map(|slot| self.sample(slot, pass)));
            walk_group(job, batch);
            on_batch(batch);
            batch.worker.stopwatch.end(Stage::Film);
        }
        end_group(job, batch);
    }

    /// Returns the number of light subpaths in a pass.
    pub fn light_subpaths(&self) -> u64 {
        let pixels = self.view.film().pixel_count();
        pixels.div_ceil(self.samples_per_subpath())
    }

    /// Walks the light subpaths of the group of `slot` again. Returns the number and the splats of the one that the
    /// sample at `slot` owns; the counters are those of this subpath only. None: another sample owns the subpath
    /// that this one uses.
    pub(super) fn replay_light(
        &self,
        job: &Job<'_>,
        slot: u64,
        pass: u64,
        batch: &mut Batch,
    ) -> Option<(usize, Vec<Entry>)> {
        let group = self.group(slot);
        let pixel = self.sample(slot, pass).pixel;
        let (mut own, mut own_stats) = (None, Stats::default());
        self.walk_light(job, group, pass, batch, 1, |batch| {
            let stats = std::mem::take(&mut batch.worker.stats);
            if batch.walks.samples[0].pixel == pixel {
                own = Some((
                    batch.walks.light.count() - 1,
                    std::mem::take(&mut batch.splats),
                ));
                own_stats = stats;
            }
        });
        batch.worker.stats = own_stats;
        own
    }
}

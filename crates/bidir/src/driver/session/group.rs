//! Groups of samples that share their light subpaths: these are walked before the samples.

use super::Session;
use crate::integrator::{BroughtLight, SharedLight, Workspace, group_size};
use crate::stats::{Stage, Stats};
use std::ops::Range;

impl Session<'_> {
    /// How many samples there are for one light subpath.
    pub(super) fn samples_per_subpath(&self) -> u64 {
        match self.integrator.shared_light() {
            Some(_) => u64::from(self.settings.lvc.samples_per_subpath.get()),
            None => 1,
        }
    }

    /// The members of `places`, the range of a group, that bring a light subpath: as many of each group begin
    /// with one.
    fn bringers(&self, places: Range<u64>) -> impl Iterator<Item = u64> {
        places.step_by(usize::from(self.settings.lvc.samples_per_subpath.get()))
    }

    /// Walks the light subpaths of the samples at `places`, a group, and keeps their images.
    pub(super) fn walk_light(
        &self,
        shared: &dyn SharedLight,
        places: Range<u64>,
        pass: u64,
        workspace: &mut Workspace,
    ) {
        shared.begin(workspace);
        for place in self.bringers(places) {
            workspace.stopwatch.begin_light();
            let sample = self.sample(place, pass);
            let context = self.context(&sample);
            shared.walk(&context, &sample, workspace);
            self.deposit(&context, place).take_light(workspace);
            workspace.stopwatch.end(Stage::Film);
        }
        shared.end(self.connections(), workspace);
    }

    /// How many light subpaths a pass has.
    pub fn light_subpaths(&self) -> u64 {
        let pixels = self.view.film().light_paths();
        pixels.div_ceil(self.samples_per_subpath())
    }

    /// Walks the light subpaths of the group of `place` again; returns that of `place`, of which alone
    /// anything is counted. None: another sample brings it.
    pub(super) fn replay_light(
        &self,
        shared: &dyn SharedLight,
        place: u64,
        pass: u64,
        workspace: &mut Workspace,
    ) -> Option<BroughtLight> {
        let pixels = self.view.film().crop.area();
        let size = group_size(pixels);
        let begin = place / size * size;
        let mut own = None;
        shared.begin(workspace);
        for other in self.bringers(begin..(begin + size).min(pixels)) {
            let sample = self.sample(other, pass);
            workspace.stats = Stats::default();
            shared.walk(&self.context(&sample), &sample, workspace);
            if other == place {
                own = Some((workspace.take_light(), std::mem::take(&mut workspace.stats)));
            }
        }
        shared.end(self.connections(), workspace);
        let (light, stats) = own.unzip();
        workspace.stats = stats.unwrap_or_default();
        light
    }
}

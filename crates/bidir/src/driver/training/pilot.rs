//! What is learnt about connections: uniform candidates, all of them traced, of groups of samples that
//! share light subpaths as those of the image do.

use super::probe::{GROUP, Probe, Witness};
use crate::integrator::{CandidateCount, IntegratorKind, LvcSettings, Sample, Workspace};
use crate::path::{Cells, PairSums, PathContext};
use crate::select::ShadowRays;
use crate::spectrum::luminance;
use crate::stats::RayCounts;
use rayon::prelude::*;

const GROUPS: u64 = 64;
/// For each camera vertex.
const CANDIDATES: CandidateCount = CandidateCount::of(16);
/// The samples of all groups.
pub(super) const SAMPLES: u64 = GROUPS * GROUP;

/// A pair of cells, by number, and the square of what arrived by a connection, if anything.
#[derive(Default)]
struct Found(Vec<(u32, Option<f64>)>);

impl Witness for Found {
    fn light(&mut self, _: &PathContext<'_>, _: &Workspace) {}

    fn sample(&mut self, context: &PathContext<'_>, _: &Sample, workspace: &Workspace) {
        let color = context.scene.color();
        let connections = workspace.cached_connections();
        let square = |value| {
            let y = f64::from(luminance(color.to_rgb(value, &context.wavelengths)));
            y * y
        };
        self.0.extend(connections.map(|(light, camera, arrived)| {
            (Cells::pair(light, camera) as u32, arrived.map(square))
        }));
    }
}

/// Adds to `sums` what connections contribute, and how many arrive. Returns the rays that it took.
pub(super) fn run(probe: &Probe<'_>, sums: &mut PairSums) -> RayCounts {
    let groups = (0..GROUPS).into_par_iter();
    let found: Vec<_> = groups
        .map_init(Workspace::default, |workspace, group| {
            let mut found = Found::default();
            let selector = ShadowRays::All.selector(0.0);
            let lvc = LvcSettings {
                candidates: CANDIDATES,
                ..probe.settings.lvc
            };
            let integrator = IntegratorKind::Lvc.integrator(selector, &lvc);
            probe.group(&*integrator, group, workspace, &mut found);
            (found, std::mem::take(&mut workspace.stats).rays)
        })
        .collect();
    let mut rays = RayCounts::default();
    // In the order of the groups, whichever threads had them.
    for (Found(found), of_group) in found {
        for (pair, square) in found {
            sums.add(pair as usize, square);
        }
        rays += of_group;
    }
    rays
}

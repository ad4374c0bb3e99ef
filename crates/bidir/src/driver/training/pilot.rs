//! What is learnt about connections: uniform candidates, all of them traced, of groups of samples that
//! share light subpaths as those of the image do.

use super::probe::{GROUP, Probe, Witness};
use crate::integrator::{CandidateCount, IntegratorKind, LvcSettings, Sample, Workspace};
use crate::path::{Cell, Cells, PathContext};
use crate::select::ShadowRays;
use crate::spectrum::luminance;
use crate::stats::RayCounts;
use rayon::prelude::*;

const GROUPS: u64 = 64;
/// For each camera vertex.
const CANDIDATES: CandidateCount = CandidateCount::of(16);
/// The samples of all groups, each of which brings a light subpath.
pub(super) const SAMPLES: u64 = GROUPS * GROUP;

/// A connection that was traced.
#[derive(Clone, Copy)]
pub(super) struct Connection {
    /// The light that its path begins on.
    pub(super) light: u32,
    pub(super) is_direct: bool,
    /// The cells of its light vertex and of its camera vertex.
    pub(super) cells: [Cell; 2],
    /// The square of what arrived. None: it was blocked.
    pub(super) square: Option<f64>,
}

impl Connection {
    /// The number of its pair of cells.
    pub(super) fn pair(&self) -> usize {
        Cells::pair(self.cells[0], self.cells[1])
    }
}

#[derive(Default)]
struct Found(Vec<Connection>);

impl Witness for Found {
    fn light(&mut self, _: &PathContext<'_>, _: &Workspace) {}

    fn sample(&mut self, context: &PathContext<'_>, _: &Sample, workspace: &Workspace) {
        let color = context.scene.color();
        let square = |value| {
            let y = f64::from(luminance(color.to_rgb(value, &context.wavelengths)));
            y * y
        };
        let connections = workspace.cached_connections();
        self.0
            .extend(connections.map(|(candidate, cells, arrived)| Connection {
                light: candidate.light,
                is_direct: candidate.strategy.s == 1,
                cells,
                square: arrived.map(square),
            }));
    }
}

/// The connections of all groups in their order, and the rays that it took.
pub(super) fn run(probe: &Probe<'_>) -> (Vec<Connection>, RayCounts) {
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
            (found.0, std::mem::take(&mut workspace.stats).rays)
        })
        .collect();
    let (mut connections, mut rays) = (Vec::new(), RayCounts::default());
    for (found, of_group) in found {
        connections.extend(found);
        rays += of_group;
    }
    (connections, rays)
}

//! What is learnt about connections: uniform candidates, all of them traced, of groups of samples that
//! share light subpaths as those of the image do.

use super::effort::Late;
use super::probe::{Probe, Witness, groups, keep};
use crate::integrator::{CandidateCount, IntegratorKind, LvcSettings, Sample, Workspace};
use crate::path::{Cell, Cells, PathContext};
use crate::select::{LightVertex, ShadowRays};
use crate::stats::RayCounts;

/// For each camera vertex.
pub(super) const CANDIDATES: u16 = 16;

/// A connection with a vertex of the light cache that was traced.
#[derive(Clone, Copy)]
pub(super) struct Connection {
    /// The light that its path begins on.
    pub(super) light: u32,
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

/// A connection with a light point of next-event estimation that was traced.
#[derive(Clone, Copy)]
pub(super) struct NextEvent {
    /// The number of its pair of cells.
    pub(super) pair: usize,
    /// Whether anything arrived.
    pub(super) has_arrived: bool,
}

/// What was traced.
#[derive(Default)]
pub(super) struct Found {
    /// With vertices of the light cache.
    pub(super) connections: Vec<Connection>,
    /// With light points, but for those at infinity.
    pub(super) next_events: Vec<NextEvent>,
}

impl Witness for Found {
    fn light(&mut self, _: &PathContext<'_>, _: &Workspace) {}

    fn sample(&mut self, context: &PathContext<'_>, _: &Sample, workspace: &Workspace) {
        let square = |value| {
            let y = f64::from(context.luminance(value));
            y * y
        };
        for (candidate, arrived) in workspace.connections() {
            let Some(cells) = workspace.cells_of(candidate) else {
                continue;
            };
            if let LightVertex::NextEvent(_) = candidate.light_vertex {
                let next_event = NextEvent {
                    pair: Cells::pair(cells[0], cells[1]),
                    has_arrived: arrived.is_some(),
                };
                keep(&mut self.next_events, next_event);
            } else {
                let connection = Connection {
                    light: candidate.term.light,
                    cells,
                    square: arrived.map(square),
                };
                keep(&mut self.connections, connection);
            }
        }
    }
}

/// What all groups found, in their order, and the rays that it took.
pub(super) fn run(probe: &Probe<'_>) -> Result<(Found, RayCounts), Late> {
    let groups = groups(probe.extent.groups(), probe.is_late, |group, workspace| {
        let mut found = Found::default();
        let selector = ShadowRays::All.selector(0.0);
        let lvc = LvcSettings {
            candidates: CandidateCount::of(CANDIDATES),
            ..probe.settings.lvc
        };
        let integrator = IntegratorKind::Lvc.integrator(selector, &lvc);
        probe.group(&*integrator, group, workspace, &mut found);
        found
    })?;
    let (mut all, mut rays) = (Found::default(), RayCounts::default());
    for (found, stats) in groups {
        all.connections.extend(found.connections);
        all.next_events.extend(found.next_events);
        rays += stats.rays;
    }
    Ok((all, rays))
}

//! What is learnt about chosen rays: how likely connections from cell to cell are to be traced, under the
//! rule and with the candidates of the image.

use super::effort::Late;
use super::probe::{Probe, Witness, groups, keep};
use crate::integrator::{Sample, Workspace};
use crate::path::{Cells, Inclusion, PathContext};
use crate::select::{LightVertex, Selector};
use crate::stats::RayCounts;

/// How much one candidate counts that is chosen as often as all are: where training saw few, they say
/// little.
const PRIOR: f64 = 4.0;

/// Sums of probabilities, with the number of their summands.
#[derive(Clone, Copy, Default)]
struct Mean {
    sum: f64,
    count: f64,
}

impl Mean {
    fn add(&mut self, prob: f64) {
        self.sum += prob;
        self.count += 1.0;
    }

    /// The mean, drawn to `all`.
    fn drawn_to(self, all: f64) -> f64 {
        (self.sum + PRIOR * all) / (self.count + PRIOR)
    }
}

/// The candidates of samples: pair of cells, or cell of a camera vertex for s = 1, by number, with
/// the probability to be chosen.
struct Found<'a> {
    selector: &'a dyn Selector,
    connections: Vec<(u32, f64)>,
    next_events: Vec<(u32, f64)>,
}

impl Witness for Found<'_> {
    fn light(&mut self, _: &PathContext<'_>, _: &Workspace) {}

    fn sample(&mut self, _: &PathContext<'_>, _: &Sample, workspace: &Workspace) {
        let probs = self.selector.probabilities(&workspace.candidates);
        for (candidate, prob) in workspace.candidates.iter().zip(probs) {
            if let LightVertex::NextEvent(_) = candidate.light_vertex {
                let camera = workspace.camera_cell(candidate).index() as u32;
                keep(&mut self.next_events, (camera, prob));
            } else if let Some([light, camera]) = workspace.cells_of(candidate) {
                let pair = Cells::pair(light, camera) as u32;
                keep(&mut self.connections, (pair, prob));
            }
        }
    }
}

/// Finds how likely candidates are to be chosen in an image of the luminance `mean`, and the rays that
/// it took.
pub(super) fn run(probe: &Probe<'_>, mean: f32) -> Result<(Inclusion, RayCounts), Late> {
    let selector = probe.settings.shadow_rays.selector(mean);
    let groups = groups(probe.extent.groups(), probe.is_late, |group, workspace| {
        of_group(probe, &*selector, mean, group, workspace)
    })?;
    let mut connections = vec![Mean::default(); Cells::COUNT * Cells::COUNT];
    let mut next_events = vec![Mean::default(); Cells::COUNT];
    let mut rays = RayCounts::default();
    for (found, stats) in groups {
        for (pair, prob) in found.connections {
            connections[pair as usize].add(prob);
        }
        for (cell, prob) in found.next_events {
            next_events[cell as usize].add(prob);
        }
        rays += stats.rays;
    }
    let inclusion = Inclusion {
        connections: means(&connections),
        next_events: means(&next_events),
    };
    Ok((inclusion, rays))
}

fn of_group<'a>(
    probe: &Probe<'_>,
    selector: &'a dyn Selector,
    mean: f32,
    group: u64,
    workspace: &mut Workspace,
) -> Found<'a> {
    let mut found = Found {
        selector,
        connections: Vec::new(),
        next_events: Vec::new(),
    };
    let settings = probe.settings;
    let rule = settings.shadow_rays.selector(mean);
    let integrator = settings.integrator.integrator(rule, &settings.lvc);
    probe.group(&*integrator, group, workspace, &mut found);
    found
}

/// The means, each drawn to that of all.
fn means(found: &[Mean]) -> Vec<f64> {
    let [sum, count] = found.iter().fold([0.0, 0.0], |[sum, count], mean| {
        [sum + mean.sum, count + mean.count]
    });
    let all = if sum > 0.0 { sum / count } else { 1.0 };
    found.iter().map(|mean| mean.drawn_to(all)).collect()
}

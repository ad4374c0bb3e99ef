//! The counts of the survey that determine the cost of a plan.

use super::counts::{STARTS, longer};
use crate::integrator::Batch;
use crate::path::Job;
use crate::strategy::Strategy;
use std::ops::AddAssign;

/// Sums over the survey's samples. Arrays of [`STARTS`] are for a roulette of camera walks that begins at surface 0,
/// 1 or 2; the elements of pairs are for t = 2 and for t > 2.
#[derive(Clone, Copy, Default)]
pub(super) struct WorkCounts {
    /// Rays of camera walks, by the start of the roulette.
    pub(super) camera_rays: [f64; STARTS],
    /// Connections with light points, by the start of the roulette.
    pub(super) next_events: [[f64; 2]; STARTS],
    /// Connections with light walks.
    pub(super) connections: [f64; 2],
    /// Connections with light walks between two diffuse vertices, by the balance heuristic.
    pub(super) diffuse: [f64; 2],
    /// The number of samples that have a connection.
    pub(super) connected: f64,
}

impl WorkCounts {
    /// Adds the one sample of `batch`.
    pub(super) fn add(&mut self, job: &Job<'_>, batch: &Batch) {
        let walk = batch.walks.camera.get(0);
        let rays = walk.vertices.len() - 1 + usize::from(walk.escape.is_some());
        let albedo = |i: usize| walk.vertices.get(i).map_or(1.0, |vertex| vertex.albedo_fwd);
        let longer = longer([albedo(1), albedo(2)]);
        for (start, camera_rays) in self.camera_rays.iter_mut().enumerate() {
            *camera_rays += (0..rays)
                .map(|before| longer[before.min(start)])
                .sum::<f64>();
        }
        for candidate in &*batch.candidates.offered {
            let Strategy { s, t } = candidate.term.strategy;
            let (s, t) = (usize::from(s), usize::from(t));
            let deeper = usize::from(t > 2);
            if s < job.settings.light_point.min_subpath_s() {
                for (start, next_events) in self.next_events.iter_mut().enumerate() {
                    next_events[deeper] += longer[(t - 2).min(start)];
                }
            } else {
                self.connections[deeper] += 1.0;
                self.diffuse[deeper] += f64::from(batch.is_diffuse(candidate));
            }
        }
        self.connected += f64::from(!batch.candidates.offered.is_empty());
    }
}

impl AddAssign for WorkCounts {
    fn add_assign(&mut self, more: Self) {
        let add = |sums: &mut [f64], more: &[f64]| {
            for (sum, more) in sums.iter_mut().zip(more) {
                *sum += more;
            }
        };
        add(&mut self.camera_rays, &more.camera_rays);
        let next_events = more.next_events.as_flattened();
        add(self.next_events.as_flattened_mut(), next_events);
        add(&mut self.connections, &more.connections);
        add(&mut self.diffuse, &more.diffuse);
        self.connected += more.connected;
    }
}

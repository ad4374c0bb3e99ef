//! D = Σ_j n_j p_j of a path, divided among kinds of strategies. An estimator that takes other numbers n_j of
//! samples has another D of the same path; their ratio turns what one found into the second moment of the
//! other (docs/derivations/choosing-a-plan.md).

use super::mis::for_each_other;
use super::{Job, JoinedPath, MisHeuristic, PathDensities};

/// The number of light vertices of a connection with a vertex of a light walk, and its part of D.
pub(crate) type ConnectionPart = (u16, f32);

/// The parts of D of a path by kinds of strategies, which sum to 1. Pairs are of t = 2 and of t > 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shares {
    /// s = 0.
    pub(crate) hits: f32,
    /// s = 1 where it draws a light point of its own.
    pub(crate) next_events: [f32; 2],
    /// Connections with vertices of light walks.
    pub(crate) connections: [f32; 2],
    /// t = 1.
    pub(crate) light_images: f32,
    /// The albedos with which a camera walk along the path goes on at its first two surfaces; 1 where it ends
    /// before.
    pub(crate) albedos: [f32; 2],
    /// The path's vertices.
    pub(crate) vertices: u16,
}

impl JoinedPath<'_> {
    /// Returns the shares of the path, by the balance heuristic. `parts` gets those of single connections.
    pub(crate) fn shares(
        &self,
        job: &Job<'_>,
        densities: &mut PathDensities,
        parts: &mut Vec<ConnectionPart>,
    ) -> Shares {
        parts.clear();
        densities.gather(job, self);
        let n = self.len();
        let first_walked = job.settings.light_point.first_walked();
        let [mut hits, mut light_images] = [0.0, 0.0];
        let [mut next_events, mut connections] = [[0.0; 2]; 2];
        let mut add = |j: usize, ratio: f64| {
            let deeper = usize::from(n - j > 2);
            let samples = self.count(job, j) * ratio;
            *match (j, n - j) {
                (0, _) => &mut hits,
                (_, 1) => &mut light_images,
                _ if j < first_walked => &mut next_events[deeper],
                _ => {
                    parts.push((j as u16, samples as f32));
                    &mut connections[deeper]
                }
            } += samples;
        };
        add(self.strategy(), 1.0);
        for_each_other(densities, self.strategy(), add);
        if n == 2 {
            light_images = MisHeuristic::Balance.share_of_image(light_images, hits);
        }
        let pairs = next_events.iter().chain(&connections);
        let all = hits + light_images + pairs.sum::<f64>();
        let part = |part: f64| (part / all) as f32;
        for (_, samples) in parts.iter_mut() {
            *samples = part(f64::from(*samples));
        }
        Shares {
            hits: part(hits),
            next_events: next_events.map(part),
            connections: connections.map(part),
            light_images: part(light_images),
            albedos: [0, 1].map(|bounce| self.camera_albedo(bounce)),
            vertices: n as u16,
        }
    }

    /// Returns the albedo with which a camera walk goes on at surface number `bounce`.
    fn camera_albedo(&self, bounce: usize) -> f32 {
        let (t, c) = (self.camera.len(), bounce + 1);
        match c {
            // x_0 scatters nothing.
            _ if c + 1 >= self.len() => 1.0,
            _ if c < t => self.camera[c].albedo_fwd,
            _ if c == t => self.turns()[0].reversed().1,
            _ => self.vertex(self.len() - 1 - c).albedo_rev,
        }
    }
}

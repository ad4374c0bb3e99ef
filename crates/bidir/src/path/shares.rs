//! D = Σ_j n_j p_j of a path, divided among kinds of strategies. An estimator that takes other numbers n_j of
//! samples has another D of the same path; their ratio turns what one found into the second moment of the
//! other (docs/derivations/choosing-a-plan.md).

use super::mis::for_each_other;
use super::strategy_class::StrategyClass;
use super::{HitPath, Job, JoinedPath, MisHeuristic, PathDensities};

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

impl PathDensities {
    /// Returns the shares of the path, by the balance heuristic, which strategy `s` made; `albedos` are those that the
    /// camera walk goes on with. `parts` gets those of single connections.
    pub(crate) fn shares(
        &self,
        job: &Job<'_>,
        s: usize,
        albedos: [f32; 2],
        parts: &mut Vec<ConnectionPart>,
    ) -> Shares {
        parts.clear();
        let n = self.vertices.len();
        let [mut hits, mut light_images] = [0.0, 0.0];
        let [mut next_events, mut connections] = [[0.0; 2]; 2];
        let mut add = |j: usize, ratio: f64| {
            let samples = self.count(job, j) * ratio;
            *match StrategyClass::of(job.settings.light_point, j, n - j) {
                StrategyClass::Hit => &mut hits,
                StrategyClass::LightImage => &mut light_images,
                StrategyClass::NextEvent(bounce) => &mut next_events[bounce as usize],
                StrategyClass::Connection(bounce) => {
                    parts.push((j as u16, samples as f32));
                    &mut connections[bounce as usize]
                }
            } += samples;
        };
        add(s, 1.0);
        for_each_other(self, s, add);
        if n == 2 {
            light_images = MisHeuristic::Balance.cut_off_image(light_images, hits);
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
            albedos,
            vertices: n as u16,
        }
    }
}

impl HitPath<'_> {
    /// Returns [`Shares::albedos`] of the path.
    pub(crate) fn camera_albedos(&self) -> [f32; 2] {
        [1, 2].map(|c| self.camera.get(c).map_or(1.0, |vertex| vertex.albedo_fwd))
    }
}

impl JoinedPath<'_> {
    /// Returns [`Shares::albedos`] of the path.
    pub(crate) fn camera_albedos(&self) -> [f32; 2] {
        [1, 2].map(|c| self.camera_albedo(c))
    }

    /// Returns the albedo with which a camera walk goes on at vertex number `c` from the lens.
    fn camera_albedo(&self, c: usize) -> f32 {
        let t = self.camera.len();
        match c {
            // x_0 scatters nothing.
            _ if c + 1 >= self.len() => 1.0,
            _ if c < t => self.camera[c].albedo_fwd,
            _ if c == t => self.events[0].reversed().1,
            _ => self.vertex(self.len() - 1 - c).albedo_rev,
        }
    }
}

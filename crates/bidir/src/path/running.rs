//! The weight of a strategy from sums that are carried along both subpaths: its cost does not
//! depend on the length of the path. In the spirit of \[Antwerpen11\] and \[Georgiev12\].
//!
//! h, the heuristic, is multiplicative: h(x y) = h(x) h(y). So, with strategies counted by light vertices,
//!
//! L_m = Σ_{j ≤ m} h(n_j p_j / p_m) = h(n_m) + h(p_{m-1} / p_m) · L_{m-1},
//!
//! and likewise E_m by camera vertices. Both depend on vertices well inside of a subpath alone; a weight adds the
//! four densities that change at the junction (docs/derivations/mis-weights.md). It is the number that
//! [`mis_weight`](super::mis_weight) finds, but for rounding.

use super::densities::{Reversed, next_event_density, stored_densities};
use super::strategy_class::{Bounce, PathStart, StrategyClass};
use super::{DiffuseEnd, HitPath, Job, JoinedPath, PathDensities, PathSettings, Subpath, Vertex};
use crate::bsdf::TransportMode;
use std::slice;

/// Sums of shares along the walks of a batch.
#[derive(Debug, Default)]
pub struct RunningSums {
    /// For each vertex of the walks.
    ends: Vec<EndSums>,
    /// The same vertices for connections with diffuse ones.
    diffuse: Vec<DiffuseEnd>,
}

/// One side of a weight's denominator: all that it needs to know of the strategies whose link lies within a subpath,
/// before its last vertex.
///
/// Let a be the density with which the walk drew the last vertex, r its density when drawn from the other end of the
/// path, and r' that of the vertex before it, which are known when the path is joined. Relative to the strategy that
/// links the last vertex, these strategies sum to h(r / a) · (`links` + h(r') · `through_previous`).
///
/// **Example**, two light vertices under the balance heuristic. Beside s = 2, which connects x_1, there are s = 1, which
/// links x_0 with x_1 and takes n_1 samples, and s = 0, which takes one. p_1 / p_2 = e b_1 / (a_0 a_1) and p_0 / p_1 =
/// b_0 / e, so that
///
/// (n_1 p_1 + p_0) / p_2 = e / (a_0 a_1) · b_1 · (n_1 + b_0 · 1 / e).
///
/// At x_1, `inverse_pdf` is e / (a_0 a_1), `links` is n_1, and `through_previous` is 1 / e times the sum at x_0, which is
/// 1; r is b_1, and r' is b_0. With e = 2, a_0 = 0.5, a_1 = 0.1, b_1 = 0.2, b_0 = 0.4 and n_1 = 1, both sides are
/// 40 · 0.2 · (1 + 0.4 / 2) = 9.6.
#[derive(Clone, Copy, Debug)]
pub struct EndSums {
    /// h(1 / a); h(1 / e) at x_0 and h(e / (a_0 a_1)) at x_1.
    inverse_pdf: f64,
    /// The share of the strategy that links the vertex with the one before it, by the [`Bounce`] at which it does.
    links: [f64; 2],
    /// h(1 / a') of the vertex before it, times the sum up to there.
    through_previous: f64,
    /// L_m of a light walk, E_m of a camera walk: the sum over the strategies whose subpath ends with the vertex before
    /// this one or earlier, where the walk goes on past this one.
    total: f64,
}

/// Sums of shares at both ends of a connection.
#[derive(Clone, Copy, Debug)]
pub struct PathSums<'a> {
    /// At its light vertex. Not used where that is x_0: all of its sum belongs to the connection.
    pub light: &'a EndSums,
    /// At its camera vertex.
    pub camera: &'a EndSums,
    /// e of x_0, where it is known: that of a light point that was drawn for the camera vertex.
    pub next_event: Option<f32>,
}

/// Weights of paths, by sums where these hold.
#[derive(Debug, Default)]
pub struct Weights {
    /// How many vertices both subpaths need for the sums to hold.
    shortest: usize,
    /// For the pure form.
    densities: PathDensities,
}

/// Stands for the number of vertices of a path: so many that, counted from the other end, roulette has begun at every
/// vertex of a walk.
const FAR: usize = usize::MAX;

impl EndSums {
    /// No other strategy.
    pub const NONE: Self = Self {
        inverse_pdf: 0.0,
        links: [0.0; 2],
        through_previous: 0.0,
        total: 0.0,
    };

    /// Returns the sums at x_0: s = 0 alone has fewer light vertices.
    #[inline]
    fn at_start(job: &Job<'_>, start: &PathStart) -> Self {
        Self {
            inverse_pdf: finite(job.settings.mis.apply(1.0 / start.e)),
            links: [start.is_hit; 2],
            through_previous: 0.0,
            total: start.is_hit,
        }
    }

    /// Returns the share of these strategies, relative to one that links this vertex with the rest of the path, where
    /// h(r) is `end` and h(r') is `before`. The strategy that links it with the vertex before it does so at `bounce`.
    #[inline]
    fn shares(&self, bounce: Bounce, end: f64, before: f64) -> f64 {
        let links = self.links[bounce as usize];
        let sum = chain(links, before, self.through_previous);
        chain(0.0, self.inverse_pdf * end, sum)
    }

    /// Returns the factor of r in the share of these strategies under the balance heuristic, where r' is `before`.
    #[inline]
    pub(super) fn per_density(&self, bounce: Bounce, before: f64) -> f64 {
        self.shares(bounce, 1.0, before)
    }
}

impl RunningSums {
    /// Forgets all walks, and keeps the memory.
    pub fn clear(&mut self) {
        self.ends.clear();
        self.diffuse.clear();
    }

    /// Adds the sums along a walk, which follows the one before.
    pub fn add(&mut self, job: &Job<'_>, walk: &Subpath<'_>) {
        match walk.vertices {
            [] => {}
            [lens, ..] if lens.is_camera() => self.add_camera(job, walk, lens),
            [_] => self.add_light(job, walk, &PathStart::NONE),
            [x0, x1, ..] => {
                let start = PathStart::new(job, x0, next_event_density(job, x0, x1));
                self.add_light(job, walk, &start);
            }
        }
    }

    fn add_light(&mut self, job: &Job<'_>, walk: &Subpath<'_>, start: &PathStart) {
        let h = |ratio| job.settings.mis.apply(ratio);
        let links = |s: usize, [before, z]: [&Vertex; 2]| {
            let is_there = if s == 1 { start.is_drawn } else { 1.0 };
            // As a camera vertex, z is the first behind the lens if one vertex follows, else a deeper one.
            [2, 3].map(|t| {
                let class = StrategyClass::of(job.settings.light_point, s, t);
                is_there * h(job.count_of(class, [before.cell, z.cell]))
            })
        };
        let inverse_pdf = |i: usize, a: f64| match i {
            1 => h(start.e / start.a0 / a),
            _ => h(1.0 / a),
        };
        let first = EndSums::at_start(job, start);
        let mode = TransportMode::Importance;
        self.add_walk(job, walk, mode, first, links, inverse_pdf);
    }

    fn add_camera(&mut self, job: &Job<'_>, walk: &Subpath<'_>, lens: &Vertex) {
        let h = |ratio| job.settings.mis.apply(ratio);
        let links = |t: usize, [before, y]: [&Vertex; 2]| {
            let class = match t {
                1 => StrategyClass::LightImage,
                _ => StrategyClass::Connection(Bounce::of(t)),
            };
            [h(job.count_of(class, [y.cell, before.cell])); 2]
        };
        let inverse_pdf = |_: usize, b: f64| h(1.0 / b);
        let first = EndSums {
            inverse_pdf: finite(inverse_pdf(0, lens.pdf_fwd.into())),
            ..EndSums::NONE
        };
        let mode = TransportMode::Radiance;
        self.add_walk(job, walk, mode, first, links, inverse_pdf);
    }

    /// Adds the sums along a walk of `mode`, those of its first vertex given; `links` is the share of the strategy that
    /// links a vertex, by number, with the one before it, and `inverse_pdf` the factor for its density.
    #[inline]
    fn add_walk(
        &mut self,
        job: &Job<'_>,
        walk: &Subpath<'_>,
        mode: TransportMode,
        first: EndSums,
        links: impl Fn(usize, [&Vertex; 2]) -> [f64; 2],
        inverse_pdf: impl Fn(usize, f64) -> f64,
    ) {
        let h = |ratio| job.settings.mis.apply(ratio);
        let (mut last, mut back) = (first, 0.0);
        for (i, [drawn, reverse]) in stored_densities(job, walk.vertices, FAR).enumerate() {
            let vertex = &walk.vertices[i];
            if i > 0 {
                let before = &walk.vertices[i - 1];
                let linked = possible(!before.went_by_delta);
                let links = links(i, [before, vertex]).map(|of| of * linked);
                let walked_on = links[1] * possible(!vertex.went_by_delta);
                let through_previous = chain(0.0, last.inverse_pdf, last.total);
                last = EndSums {
                    inverse_pdf: finite(inverse_pdf(i, drawn.into())),
                    links,
                    through_previous,
                    total: chain(walked_on, h(back), through_previous),
                };
            }
            self.ends.push(last);
            self.diffuse.push(DiffuseEnd::new(job, vertex, &last, mode));
            back = f64::from(reverse);
        }
    }

    /// Returns the sums at the vertex of this number; none where none were added.
    #[inline]
    pub fn at(&self, vertex: usize) -> &EndSums {
        self.ends.get(vertex).unwrap_or(&EndSums::NONE)
    }

    /// Returns the vertex of this number for connections with diffuse ones. None: it is no diffuse one of a walk.
    #[inline]
    pub fn diffuse(&self, vertex: usize) -> Option<&DiffuseEnd> {
        self.diffuse.get(vertex).and_then(DiffuseEnd::get)
    }

    /// The same; [`DiffuseEnd::NONE`] in place of any other vertex.
    #[inline]
    pub(crate) fn diffuse_or_none(&self, vertex: usize) -> &DiffuseEnd {
        self.diffuse.get(vertex).unwrap_or(&DiffuseEnd::NONE)
    }

    /// Begins to load what `diffuse` gives.
    #[inline]
    pub(crate) fn load_ahead(&self, vertex: usize) {
        if let Some(end) = self.diffuse.get(vertex) {
            accel::load_ahead(slice::from_ref(end));
        }
    }
}

impl Weights {
    /// Takes other settings, and keeps the memory.
    pub fn set(&mut self, settings: &PathSettings) {
        self.shortest = if settings.strategies.is_all() {
            settings.roulette.density_start().unwrap_or(0)
        } else {
            usize::MAX
        };
    }

    /// Returns true where some weights use sums.
    pub fn uses_sums(&self) -> bool {
        self.shortest < usize::MAX
    }

    /// Returns the number that [`JoinedPath::weight`] finds, but for rounding, by sums along the walks that the path's
    /// subpaths begin.
    ///
    /// It is that number itself, which takes time in proportion to the length of the path, where not all strategies take part, and where a subpath is so short that the
    /// roulette of densities begins behind its end: roulette then depends on the length of the path.
    #[inline]
    pub fn connection(&mut self, job: &Job<'_>, path: &JoinedPath<'_>, sums: &PathSums<'_>) -> f32 {
        let (s, t) = (path.light.len(), path.camera.len());
        if self.shortest <= s.min(t) {
            sums.connection(job, path) as f32
        } else {
            path.weight(job, &mut self.densities)
        }
    }

    /// Returns the number that [`HitPath::weight`] finds in the same way, with the sums at its last camera vertex.
    #[inline]
    pub fn hit(&mut self, job: &Job<'_>, path: &HitPath<'_>, camera: &EndSums) -> f32 {
        if self.shortest == 0 {
            camera.hit(job, path) as f32
        } else {
            path.weight(job, &mut self.densities)
        }
    }
}

impl EndSums {
    /// Returns the weight for s = 0, where these are the sums at its last camera vertex: all others have more light
    /// vertices.
    fn hit(&self, job: &Job<'_>, path: &HitPath<'_>) -> f64 {
        let (x0, y, t) = (&path.x0, path.y(), path.camera.len());
        let h = |ratio| job.settings.mis.apply(ratio);
        let start = PathStart::new(job, x0, next_event_density(job, x0, y));
        let count = h(job.count(1, t, [x0.cell, y.cell]));
        let links = count * start.is_drawn * possible(!y.went_by_delta);
        let a1 = f64::from(path.light_pdf(job));
        let p2_over_p1 = h(start.a0 / start.e * a1) * self.inverse_pdf;
        let from_next_event = chain(links, p2_over_p1, self.total);
        let p1_over_p0 = h(start.e / f64::from(path.camera_pdf(job)));
        let mut others = chain(0.0, p1_over_p0, from_next_event);
        if t == 1 {
            others = job.settings.mis.cut_off_image(others, 1.0);
        }
        1.0 / (1.0 + others)
    }
}

impl PathSums<'_> {
    /// Returns the weight for s ≥ 1, by the strategies with fewer light vertices, and those with fewer camera vertices.
    fn connection(&self, job: &Job<'_>, path: &JoinedPath<'_>) -> f64 {
        let (s, t) = (path.light.len(), path.camera.len());
        let h = |ratio| job.settings.mis.apply(ratio);
        let Reversed { z, y, before } = path.reversed(job);
        let [z, y] = [z, y].map(f64::from);
        let before = before.map(|density| h(density.into()));
        // Strategy s - 1 links z as camera vertex t + 1.
        let bounce = Bounce::of(t + 1);
        let (fewer_light, y) = if s == 1 {
            let next_event = || next_event_density(job, path.z(), path.y());
            let next_event = self.next_event.unwrap_or_else(next_event);
            let start = PathStart::new(job, path.z(), next_event);
            let sums = EndSums::at_start(job, &start);
            let fewer_light = sums.shares(bounce, h(z), 0.0);
            (fewer_light, start.a0 / start.e * y)
        } else {
            (self.light.shares(bounce, h(z), before[0]), y)
        };
        // Links of camera walks are the same at any bounce.
        let fewer_camera = self.camera.shares(bounce, h(y), before[1]);
        let mut own = h(job.count(s, t, [path.z().cell, path.y().cell]));
        if s + t == 2 {
            own = job.settings.mis.cut_off_image(own, fewer_light);
        }
        own / (own + fewer_light + fewer_camera)
    }
}

/// Returns `share` + `ratio` · `sum`, where a sum of nothing is nothing whatever the ratio. Never infinite:
/// a ratio of zero further on must still leave nothing of it.
#[inline]
fn chain(share: f64, ratio: f64, sum: f64) -> f64 {
    if sum > 0.0 {
        finite(share + ratio * sum)
    } else {
        share
    }
}

/// Returns the largest number in place of an infinite one.
#[inline]
fn finite(number: f64) -> f64 {
    number.min(f64::MAX)
}

#[inline]
fn possible(is_possible: bool) -> f64 {
    f64::from(is_possible)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::check_near;

    #[test]
    fn two_light_vertices_sum_to_the_example() {
        let x0 = PathStart {
            a0: 0.5,
            e: 2.0,
            is_drawn: 1.0,
            is_hit: 1.0,
        };
        let (a1, b1, b0) = (0.1, 0.2, 0.4);
        let sums = EndSums {
            inverse_pdf: x0.e / x0.a0 / a1,
            links: [x0.is_drawn; 2],
            through_previous: chain(0.0, 1.0 / x0.e, x0.is_hit),
            total: 0.0,
        };
        check_near(sums.shares(Bounce::First, b1, b0), 9.6, 1e-12, "the sum");
    }
}

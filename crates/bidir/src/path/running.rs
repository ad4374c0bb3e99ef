//! The weight of a strategy from sums that are carried along both subpaths: its cost does not
//! depend on the length of the path. In the spirit of \[Antwerpen11\] and \[Georgiev12\].
//!
//! h = `share` is multiplicative, h(x y) = h(x) h(y). So, with strategies counted by light vertices,
//!
//! L_m = Σ_{j ≤ m} h(n_j p_j / p_m) = h(n_m) + h(p_{m-1} / p_m) · L_{m-1},
//!
//! and likewise C_m by camera vertices. Both depend on vertices well inside of a subpath alone; a weight adds the
//! four densities that change at the junction (docs/derivations/mis-weights.md). It is the number that
//! [`mis_weight`](super::mis_weight) finds, but for rounding.

use super::densities::{Reversed, next_event_density, walked_densities};
use super::{DiffuseEnd, Job, JoinedPath, Junction, PathDensities, PathSettings, Subpath, Vertex};
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

/// The strategies that end a subpath before its last vertex, whose walk drew it with density a: with r the density of
/// drawing it from the other end of the path, and r' that of the vertex before it, their share is
/// h(r / a) (`links` + `slope` h(r')).
#[derive(Clone, Copy, Debug)]
pub struct EndSums {
    /// h(1 / a); h(1 / e) at x_0 and h(e / (a_0 a_1)) at x_1.
    per_drawn: f64,
    /// The share of the strategy that links the vertex with the one before it: where the rest of the path is one
    /// vertex, and where it is longer.
    links: [f64; 2],
    /// h(1 / a') of the vertex before it, times the sum up to there.
    slope: f64,
    /// L_m or C_m of the strategies that end with the vertex before it, or sooner, where the walk went on.
    sum: f64,
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

/// How x_0 is drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct PathStart {
    /// a_0.
    emission: f64,
    /// e. Never zero: where s = 1 is impossible, the ratios across it must still cancel.
    pub(super) next_event: f64,
    /// 1 where s = 1 can draw x_0, else 0.
    is_drawn: f64,
    /// 1 where s = 0 can hit it, else 0.
    pub(super) is_hit: f64,
}

/// The length of a path whose roulette has begun at every bounce of both directions.
const FAR: usize = usize::MAX;

/// s of any strategy that connects with a vertex of a light walk, and t of any behind the first camera vertex:
/// counts are the same for all of them.
const ANY_WALKED: usize = 2;
pub(super) const ANY_DEEPER: usize = 3;

impl EndSums {
    /// No other strategy.
    pub const NONE: Self = Self {
        per_drawn: 0.0,
        links: [0.0; 2],
        slope: 0.0,
        sum: 0.0,
    };

    /// Returns the share of these strategies, relative to one that links this vertex with `others` more, where h(r) is
    /// `end` and h(r') is `before`.
    #[inline]
    fn shares(&self, others: usize, end: f64, before: f64) -> f64 {
        let links = self.links[usize::from(others > 1)];
        chain(0.0, self.per_drawn * end, chain(links, before, self.slope))
    }

    /// Returns the factor of r in the share of these strategies under the balance heuristic, where the rest of the path
    /// is `others` vertices and r' is `before`.
    #[inline]
    pub(super) fn per_density(&self, others: usize, before: f64) -> f64 {
        self.shares(others, 1.0, before)
    }
}

impl RunningSums {
    /// Forgets all walks, and keeps the memory.
    pub fn clear(&mut self) {
        self.ends.clear();
        self.diffuse.clear();
    }

    /// Adds the sums along a light walk, which follows the one before.
    pub fn add_light(&mut self, job: &Job<'_>, walk: &Subpath<'_>) {
        let share = |ratio| job.settings.mis.share(ratio);
        let start = match walk.vertices {
            [] => return,
            [_] => PathStart::NONE,
            [x0, x1, ..] => PathStart::new(job, x0, next_event_density(job, x0, x1)),
        };
        let links = |i: usize, [before, z]: [&Vertex; 2]| {
            let links = if i == 1 { start.is_drawn } else { 1.0 };
            [2, ANY_DEEPER].map(|t| links * share(job.count(i, t, [before.cell, z.cell])))
        };
        let per_drawn = |i: usize, a: f64| match i {
            1 => share(start.next_event / start.emission / a),
            _ => share(1.0 / a),
        };
        self.add(job, walk, start.sums(job), links, per_drawn);
    }

    /// Adds the sums along a camera walk, which follows the one before.
    pub fn add_camera(&mut self, job: &Job<'_>, walk: &Subpath<'_>) {
        let share = |ratio| job.settings.mis.share(ratio);
        let Some(lens) = walk.vertices.first() else {
            return;
        };
        let links = |c: usize, [before, y]: [&Vertex; 2]| {
            [share(job.count(ANY_WALKED, c, [y.cell, before.cell])); 2]
        };
        let per_drawn = |_: usize, b: f64| share(1.0 / b);
        let first = EndSums {
            per_drawn: finite(per_drawn(0, lens.pdf_fwd.into())),
            ..EndSums::NONE
        };
        self.add(job, walk, first, links, per_drawn);
    }

    /// Adds the sums along a walk, those of its first vertex given; `links` is the share of the strategy that links
    /// a vertex, by number, with the one before it, and `per_drawn` the factor for its density.
    #[inline]
    fn add(
        &mut self,
        job: &Job<'_>,
        walk: &Subpath<'_>,
        first: EndSums,
        links: impl Fn(usize, [&Vertex; 2]) -> [f64; 2],
        per_drawn: impl Fn(usize, f64) -> f64,
    ) {
        let share = |ratio| job.settings.mis.share(ratio);
        let mode = if walk.vertices[0].is_camera() {
            TransportMode::Radiance
        } else {
            TransportMode::Importance
        };
        let (mut last, mut back) = (first, 0.0);
        for (i, [drawn, reverse]) in walked_densities(job, walk.vertices, FAR).enumerate() {
            if let Some(before) = i.checked_sub(1) {
                let [before, vertex] = [before, i].map(|i| &walk.vertices[i]);
                let linked = possible(!before.went_by_delta);
                let links = links(i, [before, vertex]).map(|of| of * linked);
                let walked_on = links[1] * possible(!vertex.went_by_delta);
                let slope = chain(0.0, last.per_drawn, last.sum);
                last = EndSums {
                    per_drawn: finite(per_drawn(i, drawn.into())),
                    links,
                    slope,
                    sum: chain(walked_on, share(back), slope),
                };
            }
            self.ends.push(last);
            let vertex = &walk.vertices[i];
            let end = DiffuseEnd::new(job, vertex, &last, mode);
            self.diffuse.push(end);
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
    /// It is the pure form itself where not all strategies take part, and where a subpath is so short that the
    /// roulette of densities begins behind its end: roulette then depends on the length of the path.
    #[inline]
    pub fn weight(&mut self, job: &Job<'_>, path: &JoinedPath<'_>, sums: &PathSums<'_>) -> f32 {
        let (s, t) = (path.light.len(), path.camera.len());
        let weight = match path.junction {
            Junction::Hit if self.shortest == 0 => sums.hit(job, path),
            Junction::Connection if self.shortest <= s.min(t) => sums.connection(job, path),
            _ => return path.weight(job, &mut self.densities),
        };
        weight as f32
    }
}

impl PathSums<'_> {
    /// Returns the weight for s = 0: all others have more light vertices.
    fn hit(&self, job: &Job<'_>, path: &JoinedPath<'_>) -> f64 {
        let (y, t) = (path.y(), path.camera.len());
        let share = |ratio| job.settings.mis.share(ratio);
        let start = self.start(job, path);
        let reversed = path.reversed(job);
        let count = share(job.count(1, t, [path.z().cell, y.cell]));
        let links = count * start.is_drawn * possible(!y.went_by_delta);
        let up = share(start.up() * f64::from(reversed.y)) * self.camera.per_drawn;
        let from_drawn = chain(links, up, self.camera.sum);
        let up = share(start.next_event / f64::from(reversed.z));
        let mut others = chain(0.0, up, from_drawn);
        if t == 1 {
            others = job.settings.mis.share_of_image(others, 1.0);
        }
        1.0 / (1.0 + others)
    }

    /// Returns x_0 of a path of which the rest is one subpath.
    #[inline]
    fn start(&self, job: &Job<'_>, path: &JoinedPath<'_>) -> PathStart {
        let next_event = || next_event_density(job, path.z(), path.y());
        PathStart::new(job, path.z(), self.next_event.unwrap_or_else(next_event))
    }

    /// Returns the weight for s ≥ 1, by the strategies with fewer light vertices, and those with fewer camera vertices.
    fn connection(&self, job: &Job<'_>, path: &JoinedPath<'_>) -> f64 {
        let (s, t) = (path.light.len(), path.camera.len());
        let share = |ratio| job.settings.mis.share(ratio);
        let Reversed { z, y, before } = path.reversed(job);
        let [z, y] = [z, y].map(f64::from);
        let before = before.map(|density| share(density.into()));
        let (fewer_light, y) = if s == 1 {
            let start = self.start(job, path);
            let sums = start.sums(job);
            (sums.shares(t, share(z), 0.0), start.up() * y)
        } else {
            (self.light.shares(t, share(z), before[0]), y)
        };
        let fewer_camera = self.camera.shares(s, share(y), before[1]);
        let mut own = share(job.count(s, t, [path.z().cell, path.y().cell]));
        if s + t == 2 {
            own = job.settings.mis.share_of_image(own, fewer_light);
        }
        own / (own + fewer_light + fewer_camera)
    }
}

impl PathStart {
    /// The start of no path.
    const NONE: Self = Self {
        emission: 0.0,
        next_event: 0.0,
        is_drawn: 0.0,
        is_hit: 0.0,
    };

    #[inline]
    pub(super) fn new(job: &Job<'_>, x0: &Vertex, next_event: f32) -> Self {
        Self {
            emission: f64::from(x0.pdf_fwd),
            next_event: f64::from(next_event.max(f32::MIN_POSITIVE)),
            is_drawn: possible(next_event > 0.0),
            is_hit: possible(!x0.is_on_delta_light(job)),
        }
    }

    /// Returns the sums at x_0: s = 0 alone has fewer light vertices, and p_0 / p_1 = b_0 / e.
    #[inline]
    fn sums(&self, job: &Job<'_>) -> EndSums {
        EndSums {
            per_drawn: finite(job.settings.mis.share(1.0 / self.next_event)),
            links: [self.is_hit; 2],
            slope: 0.0,
            sum: self.is_hit,
        }
    }

    /// Returns the factor of a_1 / b_1 in p_2 / p_1.
    #[inline]
    pub(super) fn up(&self) -> f64 {
        self.emission / self.next_event
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

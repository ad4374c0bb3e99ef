//! The weight of a strategy from sums that are carried along both subpaths: its cost does not
//! depend on the length of the path. In the spirit of \[Antwerpen11\] and \[Georgiev12\].
//!
//! h = `share` is multiplicative, h(x y) = h(x) h(y). So, with strategies counted by light vertices,
//!
//! L_m = Σ_{j ≤ m} h(n_j p_j / p_m) = h(n_m) + h(p_{m-1} / p_m) · L_{m-1},
//!
//! and likewise C_m by camera vertices. Both depend on vertices well inside of a subpath alone; a
//! weight adds what changes at the junction (docs/derivations/mis-weights.md). It is the number that
//! [`mis_weight`](super::mis_weight) finds, but for rounding.

use super::densities::{drawn_density, next_event_density, walked_densities};
use super::{JoinedPath, Junction, PathContext, PathDensities, PathSettings, Subpath, Vertex};

/// Sums of shares along the walks of a batch, each relative to the strategy it ends with.
#[derive(Debug, Default)]
pub struct RunningSums {
    /// A number for each vertex of the walks: L_m of light walks, C_m of camera walks; the last ones of a walk
    /// may be padding.
    sums: Vec<f64>,
    /// For each light walk the start of all paths with two of its vertices or more.
    starts: Vec<PathStart>,
}

/// Sums of shares along the subpaths of a path.
#[derive(Clone, Copy, Debug)]
pub struct PathSums<'a> {
    /// Along its light walk.
    pub light: LightSums<'a>,
    /// Along its camera walk: C_m; C_0 = 0.
    pub camera: &'a [f64],
}

/// Sums of shares along a light walk.
#[derive(Clone, Copy, Debug)]
pub struct LightSums<'a> {
    /// L_m.
    sums: &'a [f64],
    /// The start of its paths.
    start: &'a PathStart,
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
struct PathStart {
    /// a_0.
    emission: f64,
    /// e. Never zero: where s = 1 is impossible, the ratios across it must still cancel.
    next_event: f64,
    /// 1 where s = 1 can draw x_0, else 0.
    is_drawn: f64,
    /// 1 where s = 0 can hit it, else 0.
    is_hit: f64,
}

/// The length of a path whose roulette has begun at every bounce of both directions.
const FAR: usize = usize::MAX;

/// s of any strategy that connects with a vertex of a light walk, and t of any behind the first camera vertex:
/// counts are the same for all of them.
const ANY_WALKED: usize = 2;
const ANY_DEEPER: usize = 3;

impl LightSums<'_> {
    /// No sums: paths with one light vertex need none.
    pub const NONE: LightSums<'static> = LightSums {
        sums: &[],
        start: &PathStart::NONE,
    };
}

impl RunningSums {
    /// Forgets all walks, and keeps the memory.
    pub fn clear(&mut self) {
        self.sums.clear();
        self.starts.clear();
    }

    /// Adds the sums along a light walk, which follows the one before.
    pub fn add_light(&mut self, context: &PathContext<'_>, walk: &Subpath<'_>) {
        let end = self.sums.len() + walk.vertices.len();
        let start = match walk.vertices {
            [x0, x1, ..] => PathStart::new(context, x0, x1),
            _ => PathStart::NONE,
        };
        if walk.vertices.len() > 1 {
            self.sum_light(context, walk.vertices, &start);
        }
        self.starts.push(start);
        self.sums.resize(end, 0.0);
    }

    /// Adds the sums along a camera walk, which follows the one before.
    pub fn add_camera(&mut self, context: &PathContext<'_>, walk: &Subpath<'_>) {
        let end = self.sums.len() + walk.vertices.len();
        self.sum_camera(context, walk.vertices);
        self.sums.resize(end, 0.0);
    }

    /// The sums along light walk number `i`, whose first vertex has the number `first`; empty where none were
    /// added.
    #[inline]
    pub fn light(&self, i: usize, first: usize) -> LightSums<'_> {
        LightSums {
            sums: self.sums.get(first..).unwrap_or_default(),
            start: self.starts.get(i).unwrap_or(&PathStart::NONE),
        }
    }

    /// The sums along the camera walk whose first vertex has the number `first`.
    #[inline]
    pub fn camera(&self, first: usize) -> &[f64] {
        self.sums.get(first..).unwrap_or_default()
    }

    fn sum_light(&mut self, context: &PathContext<'_>, walk: &[Vertex], start: &PathStart) {
        let share = |ratio| context.job.settings.mis.share(ratio);
        let mut sum = start.is_hit;
        self.sums.push(sum);
        let densities = walked_densities(context, walk, FAR);
        for (i, [a, b]) in densities.take(walk.len() - 2).enumerate() {
            let count = share(context.count(i + 1, ANY_DEEPER, [&walk[i], &walk[i + 1]]));
            let links = count * start.links(i + 1) * walk[i].links(&walk[i + 1]);
            sum = chain(links, share(start.down(i, a, b)), sum);
            self.sums.push(sum);
        }
    }

    fn sum_camera(&mut self, context: &PathContext<'_>, walk: &[Vertex]) {
        let share = |ratio| context.job.settings.mis.share(ratio);
        let mut sum = 0.0;
        self.sums.push(sum);
        let densities = walked_densities(context, walk, FAR);
        for (c, [b, a]) in densities.take(walk.len() - 1).enumerate() {
            let [y, z] = [&walk[c], &walk[c + 1]];
            let links = share(context.count(ANY_WALKED, c + 1, [z, y])) * y.links(z);
            sum = chain(links, share(ratio(a, b)), sum);
            self.sums.push(sum);
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

    /// True where some weights use sums.
    pub fn uses_sums(&self) -> bool {
        self.shortest < usize::MAX
    }

    /// The number that [`JoinedPath::weight`] finds, but for rounding, by sums along the walks that the path's
    /// subpaths begin.
    ///
    /// It is the pure form itself where not all strategies take part, and where a subpath is so short that the
    /// roulette of densities begins behind its end: roulette then depends on the length of the path.
    #[inline]
    pub fn weight(
        &mut self,
        context: &PathContext<'_>,
        path: &JoinedPath<'_>,
        sums: &PathSums<'_>,
    ) -> f32 {
        let (s, t) = (path.light.len(), path.camera.len());
        let weight = match path.junction {
            Junction::Hit if self.shortest == 0 => sums.hit(context, path),
            Junction::Connection if self.shortest <= s.min(t) => sums.connection(context, path),
            _ => return path.weight(context, &mut self.densities),
        };
        weight as f32
    }
}

impl PathSums<'_> {
    /// s = 0: all others have more light vertices.
    fn hit(&self, context: &PathContext<'_>, path: &JoinedPath<'_>) -> f64 {
        let (y, t) = (path.y(), path.camera.len());
        let share = |ratio| context.job.settings.mis.share(ratio);
        let end = PathStart::new(context, path.z(), y);
        let reversed = path.reversed(context);
        let count = share(context.count(1, t, [path.z(), y]));
        let links = count * end.is_drawn * possible(!y.went_by_delta);
        let up = end.up(1, reversed.y, drawn_density(context, path.camera));
        let from_drawn = chain(links, share(up), self.camera[t - 1]);
        let mut others = chain(
            0.0,
            share(end.next_event / f64::from(reversed.z)),
            from_drawn,
        );
        if t == 1 {
            others = context.job.settings.mis.share_of_image(others, 1.0);
        }
        1.0 / (1.0 + others)
    }

    /// s ≥ 1: the strategies with fewer light vertices, and those with fewer camera vertices.
    fn connection(&self, context: &PathContext<'_>, path: &JoinedPath<'_>) -> f64 {
        let JoinedPath { light, camera, .. } = *path;
        let (s, t) = (light.len(), camera.len());
        let share = |ratio| context.job.settings.mis.share(ratio);
        let end = match s {
            1 => PathStart::new(context, path.z(), path.y()),
            _ => *self.light.start,
        };
        let reversed = path.reversed(context);
        let fewer_light = {
            let from_before = if let [.., before, z] = light {
                let count = share(context.count(s - 1, t + 1, [before, z]));
                let links = count * end.links(s - 1) * possible(!before.went_by_delta);
                let drawn = drawn_density(context, &light[..s - 1]);
                let down = end.down(s - 2, drawn, reversed.before[0]);
                chain(links, share(down), self.light.sums[s - 2])
            } else {
                end.is_hit
            };
            let down = end.down(s - 1, drawn_density(context, light), reversed.z);
            chain(0.0, share(down), from_before)
        };
        let fewer_camera = if let [.., before, y] = camera {
            let count = share(context.count(s + 1, t - 1, [y, before]));
            let links = count * possible(!before.went_by_delta);
            let drawn = drawn_density(context, &camera[..t - 1]);
            let up = end.up(s + 1, reversed.before[1], drawn);
            let from_before = chain(links, share(up), self.camera[t - 2]);
            let up = end.up(s, reversed.y, drawn_density(context, camera));
            chain(0.0, share(up), from_before)
        } else {
            0.0
        };
        let mut own = share(context.count(s, t, [path.z(), path.y()]));
        if s + t == 2 {
            own = context.job.settings.mis.share_of_image(own, fewer_light);
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
    fn new(context: &PathContext<'_>, x0: &Vertex, x1: &Vertex) -> Self {
        let next_event = next_event_density(context, x0, x1);
        Self {
            emission: f64::from(x0.pdf_fwd),
            next_event: f64::from(next_event.max(f32::MIN_POSITIVE)),
            is_drawn: possible(next_event > 0.0),
            is_hit: possible(!x0.is_on_delta_light(context)),
        }
    }

    /// 1 where the light lets strategy `s` ≥ 1 link x_{s-1} with x_s, else 0.
    #[inline]
    fn links(&self, s: usize) -> f64 {
        if s == 1 { self.is_drawn } else { 1.0 }
    }

    /// p_{i+1} / p_i for i ≥ 1, where walks from the light and from the camera draw x_i with
    /// densities `a` and `b`.
    #[inline]
    fn up(&self, i: usize, a: f32, b: f32) -> f64 {
        if i == 1 {
            self.emission / self.next_event * ratio(a, b)
        } else {
            ratio(a, b)
        }
    }

    /// p_i / p_{i+1}.
    #[inline]
    fn down(&self, i: usize, a: f32, b: f32) -> f64 {
        match i {
            0 => f64::from(b) / self.next_event,
            1 => self.next_event / self.emission * ratio(b, a),
            _ => ratio(b, a),
        }
    }
}

impl Vertex {
    /// 1 where this vertex of a walk could be linked with the next instead, else 0.
    #[inline]
    fn links(&self, next: &Self) -> f64 {
        possible(!self.went_by_delta && !next.went_by_delta)
    }
}

/// `share` + `ratio` · `sum`, where a sum of nothing is nothing whatever the ratio. Never infinite:
/// a ratio of zero further on must still leave nothing of it.
#[inline]
fn chain(share: f64, ratio: f64, sum: f64) -> f64 {
    if sum > 0.0 {
        (share + ratio * sum).min(f64::MAX)
    } else {
        share
    }
}

#[inline]
fn ratio(x: f32, y: f32) -> f64 {
    f64::from(x) / f64::from(y)
}

#[inline]
fn possible(is_possible: bool) -> f64 {
    f64::from(is_possible)
}

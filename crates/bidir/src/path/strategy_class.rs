//! Classes of strategies, by how they come to a path. All that weights ask of one is here: how many samples it takes
//! (n_j), whether it can make a path, its ratio to the next (p_{j+1} / p_j), and how running sums tell it from others
//! ([`Bounce`]).
//!
//! **n_j** is the number of samples that strategy j takes of a path in a pass: the only way in which numbers of samples
//! enter a weight. Estimates are unbiased with any n_j that is a function of the path, whichever strategy made it
//! (docs/derivations/mis-weights.md). This one depends on nothing but the two vertices that strategy j links, so that
//! sums along subpaths can hold it.
//!
//! **Ratios.** With a_i and b_i the densities of x_i drawn from the light and from the camera, p_{j+1} / p_j = a_j / b_j,
//! except that s = 1 draws x_0 by next-event estimation, with density e:
//!
//! p_1 / p_0 = e / b_0 and p_2 / p_1 = (a_0 / e) · (a_1 / b_1).

use super::{Job, LightPointChoice, PathDensities, Vertex};
use crate::film::FilmSettings;
use crate::guide::{Cell, CellGuide};

/// A class of strategies that take the same number of samples of paths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StrategyClass {
    /// s = 0: the camera walk comes upon the light by itself.
    Hit,
    /// t = 1: a light vertex is connected with a lens point.
    LightImage,
    /// s = 1, where camera vertices have light points of their own.
    NextEvent(Bounce),
    /// A vertex of a light walk is connected with one of a camera walk.
    Connection(Bounce),
}

/// The camera vertex that a class links, as far as its number of samples depends on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Bounce {
    /// The first behind the lens, t = 2.
    First,
    /// Any behind that.
    Deeper,
}

impl Bounce {
    /// Returns the bounce of camera vertex number `t` ≥ 2.
    #[inline]
    pub(crate) fn of(t: usize) -> Self {
        if t > 2 { Self::Deeper } else { Self::First }
    }
}

impl StrategyClass {
    /// Returns the class of strategy (s, t).
    #[inline]
    pub(crate) fn of(light_point: LightPointChoice, s: usize, t: usize) -> Self {
        match (s, t) {
            (0, _) => Self::Hit,
            (_, 1) => Self::LightImage,
            _ if s < light_point.min_subpath_s() => Self::NextEvent(Bounce::of(t)),
            _ => Self::Connection(Bounce::of(t)),
        }
    }
}

/// How many samples of a path strategies take in a pass, before the [`Guide`](crate::guide::Guide) shares
/// them out.
#[derive(Clone, Copy, Debug)]
pub struct SampleCounts {
    /// Connections with a light vertex of the path, on average: of the first vertex of a camera subpath (t = 2),
    /// and of those behind it.
    pub connections: [f64; 2],
    /// The same for s = 1.
    pub next_events: [f64; 2],
    /// Light subpaths, each with one light image.
    pub light_subpaths: f64,
}

impl SampleCounts {
    /// Every vertex of one light subpath is connected; each sample of `film` has its own.
    pub fn of_own_subpaths(film: &FilmSettings) -> Self {
        Self {
            connections: [1.0; 2],
            next_events: [1.0; 2],
            light_subpaths: film.pixel_count() as f64,
        }
    }
}

impl Job<'_> {
    /// Returns n_j of strategy (s, t), which links a light vertex in the cell `z` with a camera vertex in the cell `y`;
    /// s = 0 links nothing.
    #[inline]
    pub fn count(&self, s: usize, t: usize, cells: [Cell; 2]) -> f64 {
        if self.takes(s, t) {
            self.count_of(StrategyClass::of(self.settings.light_point, s, t), cells)
        } else {
            0.0
        }
    }

    /// Returns n_j of a class that takes part. Camera densities count per pixel, so that all that begin at the camera
    /// take one sample; the light image takes one per light subpath.
    #[inline]
    pub(crate) fn count_of(&self, class: StrategyClass, [z, y]: [Cell; 2]) -> f64 {
        match class {
            StrategyClass::Hit => 1.0,
            StrategyClass::LightImage => self.counts.light_subpaths,
            StrategyClass::NextEvent(bounce) => self.counts.next_events[bounce as usize],
            StrategyClass::Connection(bounce) => {
                self.count_from(bounce, self.guide.of_camera(y), z)
            }
        }
    }

    /// Returns n_j of connections, where it is known what the guide knows of the camera vertex.
    #[inline(always)]
    pub(crate) fn count_from(&self, bounce: Bounce, of_camera: CellGuide<'_>, z: Cell) -> f64 {
        self.counts.connections[bounce as usize] * of_camera.count_factor(z)
    }
}

impl PathDensities {
    /// Returns n_j of this path.
    #[inline]
    pub(super) fn count(&self, job: &Job<'_>, j: usize) -> f64 {
        let x = &self.vertices;
        job.count(j, x.len() - j, [x[j.saturating_sub(1)].cell, x[j].cell])
    }

    /// Returns p_{j+1} / p_j.
    #[inline]
    pub(super) fn ratio(&self, j: usize) -> f64 {
        let x = &self.vertices[j];
        let [a, b] = [x.from_light, x.from_camera].map(f64::from);
        let next_event = never_zero(self.next_event);
        match j {
            0 => next_event / b,
            1 => f64::from(self.vertices[0].from_light) / next_event * (a / b),
            _ => a / b,
        }
    }

    /// Returns true where strategy `j` can make the path: it links x_{j-1} with x_j, and a Dirac scattering at
    /// either of them forbids that, as does a light that cannot be hit (j = 0), or that next-event
    /// estimation does not find (j = 1). t = 0 is no strategy.
    #[inline]
    pub(super) fn is_possible(&self, j: usize) -> bool {
        let x = &self.vertices;
        match j {
            0 => !self.light_is_delta,
            1 if self.next_event <= 0.0 => false,
            j if j == x.len() => false,
            j => !x[j - 1].is_delta && !x[j].is_delta,
        }
    }
}

/// How x_0 is drawn: what the ratios of s = 0, 1 and 2 take from it.
#[derive(Clone, Copy, Debug)]
pub(super) struct PathStart {
    /// The density a_0 of x_0 as the start of a light walk.
    pub(super) a0: f64,
    /// The density e of x_0 as next-event estimation draws it.
    pub(super) e: f64,
    /// 1 where s = 1 can draw x_0, else 0.
    pub(super) is_drawn: f64,
    /// 1 where s = 0 can hit it, else 0.
    pub(super) is_hit: f64,
}

impl PathStart {
    /// The start of no path.
    pub(super) const NONE: Self = Self {
        a0: 0.0,
        e: 0.0,
        is_drawn: 0.0,
        is_hit: 0.0,
    };

    #[inline]
    pub(super) fn new(job: &Job<'_>, x0: &Vertex, next_event: f32) -> Self {
        Self {
            a0: f64::from(x0.pdf_fwd),
            e: never_zero(next_event),
            is_drawn: f64::from(next_event > 0.0),
            is_hit: f64::from(!x0.is_on_delta_light(job)),
        }
    }
}

/// Returns e in place of zero, so that the ratios across s = 1 cancel where it is impossible.
#[inline]
fn never_zero(next_event: f32) -> f64 {
    f64::from(next_event.max(f32::MIN_POSITIVE))
}

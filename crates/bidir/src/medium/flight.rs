//! The optical depth along a part of a ray, and the point at which a drawn depth is reached.

use super::grid::{Detail, Grid, Piece};
use super::{Field, Medium};
use crate::spectrum::{Rgb, Spectrum};
use accel::Ray;
use std::ops::ControlFlow;

/// A part of a ray in a medium.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stretch<'a> {
    pub(crate) ray: &'a Ray,
    /// Where it begins and ends, in units of the ray.
    pub(crate) range: [f32; 2],
    /// The length of a unit of the ray, in m.
    pub(crate) unit: f32,
}

/// An optical depth that a walk drew.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Drawn {
    pub(crate) lane: usize,
    pub(crate) depth: f32,
}

/// The flight of a walk through a stretch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Flight {
    /// τ up to the point where the drawn depth is reached, or else to the end.
    pub(crate) depth: Spectrum,
    /// The point where the drawn depth is reached, in units of the ray. None: it is not reached.
    pub(crate) reached: Option<f32>,
}

impl Stretch<'_> {
    /// Returns the length of a part, in m.
    #[inline]
    fn length(&self, [begin, end]: [f32; 2]) -> f32 {
        (end - begin) * self.unit
    }
}

impl Medium {
    /// Returns τ of a stretch in this detail. `lanes` converts coefficients to lanes.
    pub(crate) fn depth(
        &self,
        stretch: &Stretch<'_>,
        detail: Detail,
        lanes: impl Fn(Rgb) -> Spectrum,
    ) -> Spectrum {
        match &self.field {
            Field::Homogeneous(at) => depth_of(lanes(at.extinction), stretch.length(stretch.range)),
            Field::Density(at, grid) => {
                let [density] = integral(grid, stretch, detail);
                lanes(at.extinction) * density
            }
            Field::Chromatic { extinction, .. } => lanes(integral(extinction, stretch, detail)),
        }
    }

    /// Returns the flight through a stretch of a walk that drew a depth. It ends within the stretch only if the
    /// medium stops walks.
    pub(crate) fn fly(
        &self,
        stretch: &Stretch<'_>,
        drawn: Drawn,
        lanes: impl Fn(Rgb) -> Spectrum,
    ) -> Flight {
        if !self.stops_walks() {
            return Flight {
                depth: self.depth(stretch, Detail::Full, lanes),
                reached: None,
            };
        }
        match &self.field {
            Field::Homogeneous(at) => fly_straight(lanes(at.extinction), stretch, drawn),
            Field::Density(at, grid) => {
                let extinction = lanes(at.extinction);
                fly_through(grid, stretch, drawn, |[density]| extinction * density)
            }
            Field::Chromatic { extinction, .. } => fly_through(extinction, stretch, drawn, lanes),
        }
    }
}

/// Returns σ_t times a length.
fn depth_of(extinction: Spectrum, length: f32) -> Spectrum {
    if length.is_infinite() {
        return Spectrum::splat(f32::INFINITY);
    }
    // A clear lane keeps depth 0 over any length, and never becomes -0.
    extinction.map(|sigma| if sigma > 0.0 { sigma * length } else { 0.0 })
}

fn fly_straight(extinction: Spectrum, stretch: &Stretch<'_>, drawn: Drawn) -> Flight {
    let [begin, end] = stretch.range;
    let depth = depth_of(extinction, stretch.length([begin, end]));
    let sigma = extinction[drawn.lane];
    if drawn.depth < depth[drawn.lane] && sigma > 0.0 {
        let reached = begin + drawn.depth / (sigma * stretch.unit);
        return Flight {
            depth: depth_of(extinction, stretch.length([begin, reached])),
            reached: Some(reached),
        };
    }
    Flight {
        depth,
        reached: None,
    }
}

/// Returns the integrals of a grid over a stretch.
fn integral<const N: usize>(grid: &Grid<N>, stretch: &Stretch<'_>, detail: Detail) -> [f32; N] {
    let mut sum = [0.0; N];
    let _ = grid.visit(stretch.ray, stretch.range, detail, |piece| {
        let length = stretch.length(piece.range);
        for (sum, mean) in sum.iter_mut().zip(piece.mean(piece.range[1])) {
            *sum += mean * length;
        }
        ControlFlow::<()>::Continue(())
    });
    sum
}

fn fly_through<const N: usize>(
    grid: &Grid<N>,
    stretch: &Stretch<'_>,
    drawn: Drawn,
    extinction: impl Fn([f32; N]) -> Spectrum,
) -> Flight {
    let mut depth = Spectrum::ZERO;
    let reached = grid.visit(stretch.ray, stretch.range, Detail::Full, |piece| {
        let [begin, end] = piece.range;
        let to = |t: f32| extinction(piece.mean(t)) * stretch.length([begin, t]);
        let left = Drawn {
            depth: drawn.depth - depth[drawn.lane],
            ..drawn
        };
        let whole = to(end);
        if left.depth >= whole[drawn.lane] {
            depth += whole;
            return ControlFlow::Continue(());
        }
        let t = reach(piece, stretch.unit, left, &extinction);
        depth += to(t);
        ControlFlow::Break(t)
    });
    Flight {
        depth,
        reached: reached.break_value(),
    }
}

/// Returns the point of a piece, in units of the ray, where the drawn depth, less than that of the whole piece, is
/// reached: by Newton's method, and by bisection where that would leave the bracket \[Press07, §9.4\].
fn reach<const N: usize>(
    piece: &Piece<N>,
    unit: f32,
    drawn: Drawn,
    extinction: impl Fn([f32; N]) -> Spectrum,
) -> f32 {
    const STEPS: usize = 12;
    /// The tolerated relative error of the drawn depth.
    const ERROR: f32 = 1e-6;
    let sigma = |values| extinction(values)[drawn.lane] * unit;
    let [begin, end] = piece.range;
    let [mut low, mut high] = [begin, end];
    let mut t = 0.5 * (begin + end);
    for _ in 0..STEPS {
        let beyond = sigma(piece.mean(t)) * (t - begin) - drawn.depth;
        if beyond.abs() <= ERROR * drawn.depth {
            break;
        }
        if beyond < 0.0 {
            low = t;
        } else {
            high = t;
        }
        let next = t - beyond / sigma(piece.at(t));
        if next.to_bits() == t.to_bits() {
            break;
        }
        t = if (low..=high).contains(&next) {
            next
        } else {
            0.5 * (low + high)
        };
    }
    t
}

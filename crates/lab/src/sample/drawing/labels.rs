//! Names beside points, where they hide nothing.

use super::frame::{Frame, text};
use crate::markup::Element;
use bidir::math::Vec2;

/// The width of a letter and the height of a line.
const LETTER: Vec2 = Vec2::new(7.2, 13.0);
/// Where a name may stand around its point: first above at the right, then the other way round.
const DIRECTIONS: [[f32; 2]; 8] = [
    [0.7, -0.7],
    [-0.7, -0.7],
    [0.7, 0.7],
    [-0.7, 0.7],
    [1.0, 0.0],
    [-1.0, 0.0],
    [0.0, -1.0],
    [0.0, 1.0],
];
/// How far from it.
const DISTANCES: [f32; 3] = [13.0, 22.0, 34.0];

/// A box on the page.
#[derive(Clone, Copy)]
struct Area {
    min: Vec2,
    max: Vec2,
}

impl Area {
    fn around(middle: Vec2, size: Vec2) -> Self {
        Self {
            min: middle - size / 2.0,
            max: middle + size / 2.0,
        }
    }

    fn common(&self, other: &Self) -> f32 {
        let size = self.max.min(other.max) - self.min.max(other.min);
        let size = size.max(Vec2::ZERO);
        size.x * size.y
    }

    fn area(&self) -> f32 {
        self.common(self)
    }
}

/// What stands on a view so far.
pub(super) struct Labels {
    frame: Area,
    taken: Vec<Area>,
}

impl Labels {
    /// With `points` that no name may hide.
    pub(super) fn new(frame: &Frame, points: &[Vec2]) -> Self {
        let corners = [frame.corner, frame.corner + frame.size()];
        let dot = |point: &Vec2| Area::around(*point, Vec2::splat(9.0));
        Self {
            frame: Area {
                min: corners[0],
                max: corners[1],
            },
            taken: points.iter().map(dot).collect(),
        }
    }

    /// How bad a place is: what it would hide, and what of it would be outside.
    fn cost(&self, area: &Area) -> f32 {
        let hidden: f32 = self.taken.iter().map(|other| area.common(other)).sum();
        hidden + 4.0 * (area.area() - area.common(&self.frame))
    }

    /// Writes a name beside a point.
    pub(super) fn write(&mut self, point: Vec2, name: &str) -> Element {
        let size = Vec2::new(name.chars().count() as f32, 1.0) * LETTER;
        let places = DISTANCES.iter().flat_map(|distance| {
            let directions = DIRECTIONS.iter().map(|d| Vec2::from_array(*d));
            directions.map(move |d| Area::around(point + d * distance, size))
        });
        // The first of the best.
        let best = places.reduce(|best, place| {
            if self.cost(&place) < self.cost(&best) - 1e-3 {
                place
            } else {
                best
            }
        });
        let area = best.unwrap_or(Area::around(point, size));
        self.taken.push(area);
        let baseline = Vec2::new((area.min.x + area.max.x) / 2.0, area.max.y - 3.0);
        text(baseline, name).class("name")
    }
}

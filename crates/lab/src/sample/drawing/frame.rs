//! Where things of the world are on the page.

use super::super::subpath::Place;
use super::view::{Extent, View};
use crate::markup::{Element, element};
use bidir::math::{Vec2, Vec3};

/// A view on the page.
pub(super) struct Frame {
    pub(super) view: View,
    /// What is shown, in the units of the view: lower left and upper right corner.
    pub(super) window: [Vec2; 2],
    /// Pixels of the page per unit of the world.
    pub(super) scale: f32,
    /// The upper left corner on the page.
    pub(super) corner: Vec2,
}

impl Frame {
    /// The view of `extent`, in so many pixels per unit, with this corner.
    pub(super) fn new(view: View, extent: &Extent, scale: f32, corner: Vec2) -> Self {
        Self {
            view,
            window: view.window(extent),
            scale,
            corner,
        }
    }

    /// Width and height on the page.
    pub(super) fn size(&self) -> Vec2 {
        (self.window[1] - self.window[0]) * self.scale
    }

    /// The place of what is seen there.
    pub(super) fn page(&self, seen: Vec2) -> Vec2 {
        let [min, max] = self.window;
        self.corner + Vec2::new(seen.x - min.x, max.y - seen.y) * self.scale
    }

    /// The place of a point of the world.
    pub(super) fn at(&self, point: Vec3) -> Vec2 {
        self.page(self.view.project(point))
    }

    /// Where a line from `point` along `direction` leaves the frame; the point itself where it goes
    /// along the view.
    pub(super) fn edge(&self, point: Vec3, direction: Vec3) -> Vec2 {
        let [from, along] = [point, direction].map(|v| self.view.project(v));
        let to_border = |axis: usize| {
            let border = self.window[usize::from(along[axis] > 0.0)][axis];
            (border - from[axis]) / along[axis]
        };
        let axes = (0..2).filter(|&axis| along[axis].abs() > 1e-3);
        let distance = axes.map(to_border).reduce(f32::min).unwrap_or(0.0);
        self.page(from + along * distance)
    }

    /// A line between two places, of which one may be at infinity. None: both are.
    pub(super) fn segment(&self, a: &Place, b: &Place) -> Option<[Vec2; 2]> {
        let [p, q] = [a, b].map(Place::point);
        match (a.is_infinite, b.is_infinite) {
            (false, false) => Some([self.at(p), self.at(q)]),
            (true, false) => Some([self.edge(q, p), self.at(q)]),
            (false, true) => Some([self.at(p), self.edge(p, q)]),
            (true, true) => None,
        }
    }
}

/// A length on the page, to a tenth of a pixel.
pub(super) fn px(length: f32) -> String {
    let text = format!("{length:.1}");
    match text.strip_suffix(".0") {
        Some("-0") => "0".to_owned(),
        Some(whole) => whole.to_owned(),
        None => text,
    }
}

/// A straight line.
pub(super) fn line([a, b]: [Vec2; 2]) -> Element {
    element("line")
        .with("x1", px(a.x))
        .with("y1", px(a.y))
        .with("x2", px(b.x))
        .with("y2", px(b.y))
}

/// A text that begins at `at`.
pub(super) fn text(at: Vec2, content: impl std::fmt::Display) -> Element {
    element("text")
        .with("x", px(at.x))
        .with("y", px(at.y))
        .text(content)
}

/// A rectangle.
pub(super) fn rectangle(corner: Vec2, size: Vec2) -> Element {
    element("rect")
        .with("x", px(corner.x))
        .with("y", px(corner.y))
        .with("width", px(size.x))
        .with("height", px(size.y))
}

/// A path through each of some lines, in tenths of a pixel.
pub(super) fn path<'a>(lines: impl Iterator<Item = &'a [Vec2]>) -> Element {
    let steps: String = lines.map(steps).collect();
    element("path").with("d", steps)
}

/// A line as steps from place to place.
fn steps(line: &[Vec2]) -> String {
    let rounded = |place: &Vec2| (place * 10.0).round() / 10.0;
    let starts = std::iter::once(Vec2::ZERO).chain(line.iter().map(rounded));
    let steps = starts.zip(line).enumerate().map(|(i, (from, to))| {
        let letter = if i == 0 { "M" } else { "l" };
        let step = rounded(to) - from;
        format!("{letter}{} {}", px(step.x), px(step.y))
    });
    steps.collect()
}

//! Elements of SVG at positions on the page.

use crate::markup::{Element, element};
use bidir::math::Vec2;

/// Formats a length on the page, rounded to a tenth of a pixel.
pub(super) fn px(length: f32) -> String {
    // The sum turns -0 into 0.
    ((length * 10.0).round() / 10.0 + 0.0).to_string()
}

/// Returns an element with the attributes `x` and `y`.
fn placed(name: &'static str, at: Vec2) -> Element {
    element(name).with("x", px(at.x)).with("y", px(at.y))
}

/// Returns a text that begins at `at`.
pub(super) fn text(at: Vec2, content: impl std::fmt::Display) -> Element {
    placed("text", at).text(content)
}

pub(super) fn rectangle(corner: Vec2, size: Vec2) -> Element {
    let rectangle = placed("rect", corner).with("width", px(size.x));
    rectangle.with("height", px(size.y))
}

pub(super) fn circle(at: Vec2, radius: f32) -> Element {
    let circle = element("circle").with("cx", px(at.x)).with("cy", px(at.y));
    circle.with("r", px(radius))
}

/// Returns a line through `points`.
pub(super) fn polyline(points: &[Vec2]) -> Element {
    let pairs = points.iter().map(|p| format!("{},{}", px(p.x), px(p.y)));
    element("polyline").with("points", pairs.collect::<Vec<_>>().join(" "))
}

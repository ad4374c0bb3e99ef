//! Elements of SVG at positions on the page, each on a line.

use crate::markup::escaped;
use bidir::math::Vec2;

/// Formats a length on the page, rounded to a tenth of a pixel.
pub(super) fn px(length: f32) -> String {
    // The sum turns -0 into 0.
    ((length * 10.0).round() / 10.0 + 0.0).to_string()
}

/// Returns a text that begins at `at`.
pub(super) fn text(at: Vec2, class: &str, content: &str) -> String {
    let [x, y] = at.to_array().map(px);
    let content = escaped(content);
    format!("<text x=\"{x}\" y=\"{y}\" class=\"{class}\">{content}</text>\n")
}

pub(super) fn rectangle(corner: Vec2, size: Vec2, class: &str) -> String {
    let [x, y, width, height] = [corner.x, corner.y, size.x, size.y].map(px);
    format!("<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" class=\"{class}\"/>\n")
}

pub(super) fn circle(at: Vec2, radius: f32, class: &str) -> String {
    let [x, y, radius] = [at.x, at.y, radius].map(px);
    format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" class=\"{class}\"/>\n")
}

/// Returns a line through `points`.
pub(super) fn polyline(points: &[Vec2], class: &str) -> String {
    let texts = points.iter().map(|p| format!("{},{}", px(p.x), px(p.y)));
    let pairs = texts.collect::<Vec<_>>().join(" ");
    format!("<polyline points=\"{pairs}\" class=\"{class}\"/>\n")
}

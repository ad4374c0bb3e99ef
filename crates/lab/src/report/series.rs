//! Curves and histograms, told apart by colour, by marker and by dashes.

use super::plot::{BOTTOM, Frame, last_edge};
use crate::markup::{Element, element};
use crate::results::Series;
use std::fmt::Write;

/// Colours that also the colour-blind tell apart \[Okabe08\]; its yellow is too pale for lines.
const COLORS: [&str; 7] = [
    "#0072b2",
    "#d55e00",
    "#009e73",
    "#cc79a7",
    "#e69f00",
    "#56b4e9",
    "currentColor",
];

/// Markers around the origin, of about the same area.
const MARKERS: [&str; 8] = [
    "M4 0A4 4 0 1 1 -4 0A4 4 0 1 1 4 0Z",
    "M-3.6 -3.6H3.6V3.6H-3.6Z",
    "M0 -5L4.6 3.4H-4.6Z",
    "M0 -5L5 0L0 5L-5 0Z",
    "M0 5L4.6 -3.4H-4.6Z",
    "M-4 -4L4 4M-4 4L4 -4",
    "M0 -5V5M-5 0H5",
    "M-4.6 -2.2H4.6V2.2H-4.6Z",
];

/// Dashes, of which the first is none.
const DASHES: [&str; 5] = ["none", "7 3", "2 3", "9 3 2 3", "14 4"];

/// Of more points than this, intervals are a band.
const MOST_BARS: usize = 24;

/// How a series looks.
pub(super) struct Look {
    color: &'static str,
    marker: &'static str,
    dash: &'static str,
}

impl Look {
    /// The numbers of colours, markers and dashes have no common divisor, so all 280 differ.
    pub(super) fn of(index: usize) -> Self {
        Self {
            color: COLORS[index % COLORS.len()],
            marker: MARKERS[index % MARKERS.len()],
            dash: DASHES[index % DASHES.len()],
        }
    }

    pub(super) fn line(&self, path: &str) -> Element {
        element("path")
            .with("d", path)
            .with("fill", "none")
            .with("stroke", self.color)
            .with("stroke-width", 2)
            .with("stroke-linejoin", "round")
            .with("stroke-dasharray", self.dash)
    }

    pub(super) fn marker_at(&self, [x, y]: [f64; 2]) -> Element {
        element("path")
            .with("d", self.marker)
            .with("transform", format!("translate({x:.1} {y:.1})"))
            .with("fill", self.color)
            .with("stroke", self.color)
            .with("stroke-width", 1.5)
    }

    fn area(&self, path: &str, opacity: f64) -> Element {
        element("path")
            .with("d", path)
            .with("fill", self.color)
            .with("fill-opacity", opacity)
    }

    fn bar(&self, path: &str) -> Element {
        element("path")
            .with("d", path)
            .with("fill", "none")
            .with("stroke", self.color)
            .with("stroke-width", 1.2)
    }
}

/// Points joined by lines, with the intervals of those that have one.
pub(super) fn curve(series: &Series, index: usize, frame: &Frame) -> Element {
    let look = Look::of(index);
    let shown = |&&point: &&[f64; 2]| frame.has_place(point);
    let points: Vec<_> = series
        .points
        .iter()
        .filter(shown)
        .map(|&point| frame.at(point))
        .collect();
    let intervals = if series.points.len() > MOST_BARS {
        look.area(&band(series, frame), 0.2)
    } else {
        look.bar(&bars(series, frame, |x| x))
    };
    let markers = points.iter().map(|&point| look.marker_at(point));
    let markers = markers.take(if points.len() > 4 * MOST_BARS {
        0
    } else {
        points.len()
    });
    group(series)
        .child(intervals)
        .child(look.line(&polyline(points.iter().copied())))
        .children(markers)
}

/// Steps from the axis to the heights of the bins, with the intervals in the middle of each.
pub(super) fn steps(series: &Series, index: usize, frame: &Frame) -> Element {
    let look = Look::of(index);
    let lefts = series.points.iter().map(|point| point[0]);
    let edges: Vec<_> = lefts.chain(last_edge(series)).collect();
    let mut corners = Vec::new();
    for ([_, height], edge) in series.points.iter().zip(edges.windows(2)) {
        corners.extend([frame.at([edge[0], *height]), frame.at([edge[1], *height])]);
    }
    let ends = corners.first().zip(corners.last());
    let ends = ends.map(|(first, last)| [[first[0], BOTTOM], [last[0], BOTTOM]]);
    let [start, end] = ends.map_or([None, None], |ends| ends.map(Some));
    let outline = polyline(start.into_iter().chain(corners).chain(end));
    let half = edges.windows(2).next().map_or(0.0, |edge| {
        0.5 * (frame.at([edge[1], 0.0])[0] - frame.at([edge[0], 0.0])[0])
    });
    group(series)
        .child(look.area(&outline, 0.1))
        .child(look.line(&outline))
        .child(look.bar(&bars(series, frame, |x| x + half)))
}

/// A group whose name a browser shows where the pointer is.
fn group(series: &Series) -> Element {
    element("g").child(element("title").text(&series.name))
}

/// A line through places.
fn polyline(places: impl Iterator<Item = [f64; 2]>) -> String {
    let mut path = String::new();
    for [x, y] in places {
        let command = if path.is_empty() { 'M' } else { 'L' };
        write!(path, "{command}{x:.1} {y:.1}").expect("strings can be written to");
    }
    path
}

/// The ends of the intervals of all points that have a place.
fn ends<'a>(series: &'a Series, frame: &'a Frame) -> impl Iterator<Item = [[f64; 2]; 2]> + 'a {
    let both = series.points.iter().zip(&series.intervals);
    let shown = both
        .filter(|&(&point, [low, high])| frame.has_place(point) && !low.is_nan() && !high.is_nan());
    shown.map(|([x, _], [low, high])| [frame.at([*x, *low]), frame.at([*x, *high])])
}

/// A bar with caps for each interval, moved to where `place` says.
fn bars(series: &Series, frame: &Frame, place: impl Fn(f64) -> f64) -> String {
    let bar = |[[x, low], [_, high]]: [[f64; 2]; 2]| {
        let [before, x, after] = [-4.0, 0.0, 4.0].map(|step| place(x) + step);
        format!(
            "M{before:.1} {low:.1}H{after:.1}M{before:.1} {high:.1}H{after:.1}M{x:.1} {low:.1}V{high:.1}"
        )
    };
    ends(series, frame).map(bar).collect()
}

/// The area between the lower and the upper ends.
fn band(series: &Series, frame: &Frame) -> String {
    let lows = ends(series, frame).map(|[low, _]| low);
    let highs: Vec<_> = ends(series, frame).map(|[_, high]| high).collect();
    polyline(lows.chain(highs.into_iter().rev()))
}

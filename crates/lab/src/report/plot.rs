//! A plot as an SVG picture with its caption and its numbers.
//!
//! Everything is an attribute of its element and black is `currentColor`: a picture that is copied
//! out of the page looks the same, and one in a dark page can be read.

use super::axis::Ruler;
use super::legend::legend;
use super::number::number;
use super::series::{curve, steps};
use super::table::table;
use crate::markup::{Element, element};
use crate::results::{Cell, Plot, PlotKind, Series, Table};

/// Unit of all lengths: pixels of the picture.
pub(super) const WIDTH: f64 = 680.0;
const PLOT_HEIGHT: f64 = 300.0;
const TOP: f64 = 12.0;
/// The lower end of the plot.
pub(super) const BOTTOM: f64 = TOP + PLOT_HEIGHT;
const RIGHT: f64 = 16.0;
/// Room below the plot for the ticks and the label of the axis.
const BELOW: f64 = 48.0;
/// The width of a letter of the size that is used throughout, on the average.
pub(super) const LETTER: f64 = 6.8;

/// Where the values of a plot are in its picture.
pub(super) struct Frame {
    x: Ruler,
    y: Ruler,
    left: f64,
}

impl Frame {
    /// None: no point has a place on both axes.
    fn new(plot: &Plot) -> Option<Self> {
        let edges = |series: &Series| match plot.kind {
            PlotKind::Lines => None,
            PlotKind::Histogram => Some(last_edge(series)?),
        };
        let xs = plot.series.iter().flat_map(|series| {
            let points = series.points.iter().map(|point| point[0]);
            points.chain(edges(series))
        });
        let ys = plot.series.iter().flat_map(|series| {
            let points = series.points.iter().map(|point| point[1]);
            points.chain(series.intervals.iter().flatten().copied())
        });
        // A histogram stands on the axis.
        let floor = (plot.kind == PlotKind::Histogram).then_some(0.0);
        let x = Ruler::new(plot.x.scale, xs)?;
        let y = Ruler::new(plot.y.scale, ys.chain(floor))?;
        let letters = y.ticks.iter().map(|(_, label)| label.chars().count());
        let left = 34.0 + LETTER * letters.max().unwrap_or(0) as f64;
        Some(Self { x, y, left })
    }

    /// Where a point is; what is beyond an end is at the end.
    pub(super) fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.x_of(x), self.y_of(y)]
    }

    fn x_of(&self, value: f64) -> f64 {
        self.left + (WIDTH - RIGHT - self.left) * self.x.fraction(value)
    }

    fn y_of(&self, value: f64) -> f64 {
        TOP + PLOT_HEIGHT * (1.0 - self.y.fraction(value))
    }

    pub(super) fn has_place(&self, point: [f64; 2]) -> bool {
        self.x.has_place(point[0]) && self.y.has_place(point[1])
    }
}

/// The right edge of a histogram's last bin, which is as wide as the one before it.
pub(super) fn last_edge(series: &Series) -> Option<f64> {
    let [.., [before, _], [last, _]] = series.points[..] else {
        return series.points.last().map(|[last, _]| last + 1.0);
    };
    Some(last + (last - before))
}

/// A plot; `id` is unique in the page.
pub(super) fn figure(plot: &Plot, id: &str) -> Element {
    let caption = element("figcaption").text(&plot.caption);
    let numbers = element("details")
        .child(element("summary").text("Numbers of this plot"))
        .child(table(&numbers(plot)));
    let Some(frame) = Frame::new(plot) else {
        return element("figure")
            .child(element("p").text("No point of this plot can be drawn."))
            .child(caption)
            .child(numbers);
    };
    let mut figure = element("figure")
        .child(picture(plot, &frame, id))
        .child(caption);
    if let Some(note) = left_out(plot, &frame) {
        figure = figure.child(element("p").class("note").text(note));
    }
    figure.child(numbers)
}

fn picture(plot: &Plot, frame: &Frame, id: &str) -> Element {
    let (legend, legend_height) = legend(plot, BOTTOM + BELOW);
    let [title, description] = ["title", "description"].map(|part| format!("{id}-{part}"));
    let series = plot.series.iter().enumerate();
    element("svg")
        .with(
            "viewBox",
            format!("0 0 {WIDTH} {:.0}", BOTTOM + BELOW + legend_height),
        )
        .with("role", "img")
        .with("aria-labelledby", format!("{title} {description}"))
        .with("font-family", "system-ui, sans-serif")
        .with("font-size", 12)
        .with("fill", "currentColor")
        .child(element("title").with("id", title).text(&plot.caption))
        .child(element("desc").with("id", description).text(in_words(plot)))
        .child(grid(plot, frame))
        .children(series.map(|(index, series)| match plot.kind {
            PlotKind::Lines => curve(series, index, frame),
            PlotKind::Histogram => steps(series, index, frame),
        }))
        .child(legend)
}

/// Lines at the ticks, what is written beside them, and the labels of the axes.
fn grid(plot: &Plot, frame: &Frame) -> Element {
    let (left, right) = (frame.left, WIDTH - RIGHT);
    let vertical =
        |value: f64, opacity| rule([frame.x_of(value), TOP, frame.x_of(value), BOTTOM], opacity);
    let horizontal =
        |value: f64, opacity| rule([left, frame.y_of(value), right, frame.y_of(value)], opacity);
    let below = |(value, label): &(f64, String)| {
        label_at([frame.x_of(*value), BOTTOM + 16.0], "middle").text(label)
    };
    let beside = |(value, label): &(f64, String)| {
        label_at([left - 6.0, frame.y_of(*value) + 4.0], "end").text(label)
    };
    let middle = TOP + 0.5 * PLOT_HEIGHT;
    element("g")
        .children(frame.x.minor.iter().map(|&value| vertical(value, 0.07)))
        .children(frame.y.minor.iter().map(|&value| horizontal(value, 0.07)))
        .children(frame.x.ticks.iter().map(|(value, _)| vertical(*value, 0.2)))
        .children(
            frame
                .y
                .ticks
                .iter()
                .map(|(value, _)| horizontal(*value, 0.2)),
        )
        .children([
            rule([left, BOTTOM, right, BOTTOM], 0.8),
            rule([left, TOP, left, BOTTOM], 0.8),
        ])
        .children(frame.x.ticks.iter().map(below))
        .children(frame.y.ticks.iter().map(beside))
        .child(label_at([0.5 * (left + right), BOTTOM + 36.0], "middle").text(&plot.x.label))
        .child(
            label_at([14.0, middle], "middle")
                .with("transform", format!("rotate(-90 14 {middle:.1})"))
                .text(&plot.y.label),
        )
}

fn rule([x1, y1, x2, y2]: [f64; 4], opacity: f64) -> Element {
    element("path")
        .with("d", format!("M{x1:.1} {y1:.1}L{x2:.1} {y2:.1}"))
        .with("stroke", "currentColor")
        .with("stroke-opacity", opacity)
}

pub(super) fn label_at([x, y]: [f64; 2], anchor: &'static str) -> Element {
    element("text")
        .with("x", format!("{x:.1}"))
        .with("y", format!("{y:.1}"))
        .with("text-anchor", anchor)
}

/// What the picture shows, for who does not see it.
fn in_words(plot: &Plot) -> String {
    let ends = |series: &Series| {
        let written = |point: Option<&[f64; 2]>| {
            point.map_or(String::new(), |[x, y]| {
                format!("({}, {})", number(*x), number(*y))
            })
        };
        let [first, last] = [series.points.first(), series.points.last()].map(written);
        format!(
            "{}: {} points from {first} to {last}.",
            series.name,
            series.points.len()
        )
    };
    let series: Vec<_> = plot.series.iter().map(ends).collect();
    format!(
        "{} over {}. {}",
        plot.y.label,
        plot.x.label,
        series.join(" ")
    )
}

/// How many points cannot be drawn, if there are any.
fn left_out(plot: &Plot, frame: &Frame) -> Option<String> {
    let points = plot.series.iter().flat_map(|series| &series.points);
    let missing = points.filter(|&&point| match plot.kind {
        PlotKind::Lines => !frame.has_place(point),
        // Empty bins are drawn, as nothing.
        PlotKind::Histogram => !frame.x.has_place(point[0]) || !point[1].is_finite(),
    });
    let missing = missing.count();
    (missing > 0).then(|| {
        format!(
            "Points without a place on these axes, left out: {missing}. They are among the numbers."
        )
    })
}

/// The points as a table.
fn numbers(plot: &Plot) -> Table {
    let rows = plot.series.iter().flat_map(|series| {
        series.points.iter().enumerate().map(|(index, &[x, y])| {
            let y = match series.intervals.get(index) {
                Some(&[low, high]) => Cell::Interval {
                    value: y,
                    low,
                    high,
                },
                None => Cell::Number(y),
            };
            vec![Cell::Text(series.name.clone()), Cell::Number(x), y]
        })
    });
    Table {
        caption: String::new(),
        columns: vec!["series".into(), plot.x.label.clone(), plot.y.label.clone()],
        rows: rows.collect(),
    }
}

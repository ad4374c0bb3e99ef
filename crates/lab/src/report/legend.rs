//! The legend of a plot, below it.

use super::plot::{LETTER, WIDTH, label_at};
use super::series::Look;
use crate::markup::{Element, element};
use crate::results::{Plot, PlotKind};

const ROW: f64 = 20.0;
/// Room for the piece of line before a name, and for the gap after it.
const SAMPLE: f64 = 44.0;
const LEFT: f64 = 34.0;

/// The legend from `top` downwards, and its height. Unit: pixels of the picture.
pub(super) fn legend(plot: &Plot, top: f64) -> (Element, f64) {
    let mut legend = element("g");
    let (mut x, mut row) = (LEFT, 0.0);
    for (index, series) in plot.series.iter().enumerate() {
        let width = SAMPLE + LETTER * series.name.chars().count() as f64 + 12.0;
        if x > LEFT && x + width > WIDTH {
            (x, row) = (LEFT, row + 1.0);
        }
        let y = top + ROW * (row + 0.5);
        legend = legend
            .child(sample(plot.kind, index, [x, y]))
            .child(label_at([x + SAMPLE - 6.0, y + 4.0], "start").text(&series.name));
        x += width;
    }
    let rows = if plot.series.is_empty() {
        0.0
    } else {
        row + 1.0
    };
    (legend, ROW * rows + 4.0)
}

fn sample(kind: PlotKind, index: usize, [x, y]: [f64; 2]) -> Element {
    let look = Look::of(index);
    let line = look.line(&format!("M{x:.1} {y:.1}H{:.1}", x + 32.0));
    let marker = match kind {
        PlotKind::Lines => Some(look.marker_at([x + 16.0, y])),
        PlotKind::Histogram => None,
    };
    element("g").child(line).children(marker)
}

//! Plots of tables, and histograms of contributions.

use super::{CellSpec, Measure, PlotSpec, TableSpec};
use crate::results::{Axis, Cell, Contributions, Plot, PlotKind, Scale, Series, Table};
use crate::statistics::Interval;

/// Plots columns of a table as curves.
pub(super) fn curves(spec: &PlotSpec, table: &Table) -> Plot {
    let series = spec.curves.iter();
    Plot {
        caption: table.caption.clone(),
        kind: PlotKind::Lines,
        x: Axis::new(&table.columns[spec.x], spec.x_scale),
        y: Axis::new(&spec.label, spec.y_scale),
        series: series.map(|column| curve(table, spec.x, *column)).collect(),
    }
}

/// Makes the curve of column `y` over column `x`, with intervals if all numbers of `y` have them.
fn curve(table: &Table, x: usize, y: usize) -> Series {
    let point = |row: &Vec<Cell>| {
        let (x, _) = number(&row[x])?;
        let (y, interval) = number(&row[y])?;
        Some(([x, y], interval))
    };
    let points: Vec<_> = table.rows.iter().filter_map(point).collect();
    Series::new(&table.columns[y], &points)
}

/// Returns the number of a cell, with its interval. None: it is a text.
fn number(cell: &Cell) -> Option<(f64, Option<[f64; 2]>)> {
    match cell {
        Cell::Text(_) => None,
        Cell::Number(number) => Some((*number, None)),
        Cell::Interval(Interval { value, low, high }) => Some((*value, Some([*low, *high]))),
    }
}

/// Plots the contributions measured in the rows of a table as bars, named by the first column.
pub(super) fn histogram(label: &str, spec: &TableSpec, all: &[Contributions]) -> Plot {
    let bars = spec.rows.iter().filter_map(|row| bars(row, all));
    Plot {
        caption: spec.caption.clone(),
        kind: PlotKind::Histogram,
        x: Axis::new(label, Scale::Linear),
        y: Axis::new("part of all", Scale::Linear),
        series: bars.collect(),
    }
}

/// Makes the bars of a row. None: it has no number of contributions.
fn bars(row: &[CellSpec], all: &[Contributions]) -> Option<Series> {
    let name = row.iter().find_map(|cell| match cell {
        CellSpec::Value(name) => Some(name.clone()),
        CellSpec::Quantity(_) => None,
    });
    let (of, figure) = row.iter().find_map(|cell| match cell {
        CellSpec::Quantity(of) => match of.measure {
            Measure::Contributions(figure) => Some((of, figure)),
            _ => None,
        },
        CellSpec::Value(_) => None,
    })?;
    let mut all = all.iter();
    let found = all.find(|found| found.scene == of.scene && found.method == of.method)?;
    Some(Series {
        name: name.unwrap_or_default(),
        points: found.histogram(figure).to_vec(),
        intervals: Vec::new(),
    })
}

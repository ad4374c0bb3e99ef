//! Tables of a description.

use super::plot::{curves, histogram};
use super::{CellSpec, Findings, Over, Quantity, TableSpec};
use crate::experiment::analysis::CONFIDENCE;
use crate::results::{Cell, Plot, Table};
use crate::statistics::mean_interval;

impl Findings<'_> {
    /// Adds a table and its plots; rows without a measured number are left out.
    pub(super) fn show(&self, spec: &TableSpec, tables: &mut Vec<Table>, plots: &mut Vec<Plot>) {
        let rows = spec.rows.iter().filter_map(|row| self.row(row));
        let table = Table {
            caption: spec.caption.clone(),
            columns: spec.columns.clone(),
            rows: rows.collect(),
        };
        plots.extend(spec.plot.as_ref().map(|plot| curves(plot, &table)));
        let bars = spec.histogram.as_ref();
        plots.extend(bars.map(|label| histogram(label, spec, &self.results.contributions)));
        tables.push(table);
    }

    /// Makes the cells of a row. None: it has numbers, but none was measured.
    fn row(&self, specs: &[CellSpec]) -> Option<Vec<Cell>> {
        let cells: Vec<Cell> = specs.iter().map(|spec| self.cell(spec)).collect();
        let pairs = specs.iter().zip(&cells);
        let mut numbers = pairs.filter(|(spec, _)| matches!(spec, CellSpec::Quantity(_)));
        let has_numbers = numbers.clone().next().is_some();
        let is_measured = numbers.any(|(_, cell)| !matches!(cell, Cell::Text(_)));
        (is_measured || !has_numbers).then_some(cells)
    }

    fn cell(&self, spec: &CellSpec) -> Cell {
        match spec {
            CellSpec::Value(text) => match text.parse() {
                Ok(number) => Cell::Number(number),
                Err(_) => Cell::Text(text.clone()),
            },
            CellSpec::Quantity(of) => self.number(of),
        }
    }

    /// Computes a mean, or a ratio with its interval. The ratio of a measured method to itself is 1; the ratio of a
    /// single seed has no interval.
    pub(in super::super) fn number(&self, of: &Quantity) -> Cell {
        let is_itself = |method: &String| *method == of.method && of.than.is_none();
        let found = match &of.over {
            Over::Method(method) if is_itself(method) => self.mean(of).map(|_| Cell::Number(1.0)),
            Over::Nothing if of.than.is_none() => self.mean(of).map(Cell::Number),
            Over::MeanInterval => mean_interval(&self.numbers(of), CONFIDENCE)
                .map(Cell::Interval)
                .or_else(|| self.mean(of).map(Cell::Number)),
            _ => self
                .interval(of, CONFIDENCE)
                .map(Cell::Interval)
                .or_else(|| self.single_ratio(of).map(Cell::Number)),
        };
        found.unwrap_or_else(|| Cell::Text("–".to_owned()))
    }

    /// Returns the ratio of the only seed. None: there are no seeds or several, or the divisor is 0.
    fn single_ratio(&self, of: &Quantity) -> Option<f64> {
        let mut ratios = self.ratios(of, &of.scene).into_values();
        let ratio = ratios.next().filter(|ratio| ratio.is_finite())?;
        (ratios.len() == 0 && of.than.is_none()).then_some(ratio)
    }
}

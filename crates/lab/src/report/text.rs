//! Tables as text.

use crate::number::number;
use crate::results::{Cell, Table};
use crate::statistics::Interval;
use formats::printable;

/// Formats a table in columns, with its caption. All texts are [`printable`].
pub fn table_text(table: &Table) -> String {
    let shown = |text: &String| printable(text).into_owned();
    let head = table.columns.iter().map(shown).collect();
    let body = table.rows.iter().map(|row| row.iter().map(cell).collect());
    let rows: Vec<Vec<String>> = std::iter::once(head).chain(body).collect();
    let width = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column));
        cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..table.columns.len()).map(width).collect();
    let line = |row: &Vec<String>| {
        let pairs = row.iter().zip(&widths);
        let cells = pairs.map(|(cell, &width)| format!("{cell:width$}"));
        let line = cells.collect::<Vec<_>>().join("  ");
        line.trim_end().to_owned() + "\n"
    };
    let lines: String = rows.iter().map(line).collect();
    format!("{}\n{lines}", printable(&table.caption))
}

fn cell(cell: &Cell) -> String {
    match cell {
        Cell::Text(text) => printable(text).into_owned(),
        Cell::Number(value) => number(*value),
        Cell::Interval(Interval { value, low, high }) => {
            format!("{} [{}, {}]", number(*value), number(*low), number(*high))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_stand_below_each_other() {
        let table = Table {
            caption: "Errors.".into(),
            columns: ["method", "rmse"].map(str::to_owned).into(),
            rows: vec![
                vec![Cell::Text("a longer name".into()), Cell::Number(2.0)],
                vec![
                    Cell::Text("b".into()),
                    Cell::Interval(Interval {
                        value: 1.5,
                        low: 1.25,
                        high: 1.75,
                    }),
                ],
            ],
        };
        let expected = "Errors.\n\
                        method         rmse\n\
                        a longer name  2\n\
                        b              1.50 [1.25, 1.75]\n";
        assert_eq!(table_text(&table), expected);
    }
}

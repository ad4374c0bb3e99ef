//! Tables: numbers to the right, the best of them marked.
//!
//! Which numbers are good is said by the head of their column, as in papers: `↓` at its end means
//! that less is better, `↑` more. Names of metrics mean `↓`, and efficiencies `↑`, without it. Rows
//! that agree in all but the last of the texts at their beginning are compared with each other:
//! the methods of one scene and budget.

use super::number::{interval, number};
use crate::markup::{Element, element};
use crate::metric::Metric;
use crate::results::{Cell, Table};

/// What a number is among those that it is compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Rank {
    Best,
    /// Its interval overlaps that of the best.
    AsGood,
    None,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Better {
    Less,
    More,
}

/// A longer text is divided into lines. Unit: characters.
const LONGEST_NAME: usize = 28;

/// What stands where a number would, if there were one.
pub(super) const NOTHING: &str = "–";

/// A table of the page.
pub(super) fn table(table: &Table) -> Element {
    let ranks: Vec<_> = (0..table.columns.len())
        .map(|column| ranks(table, column))
        .collect();
    let rank = |row: usize, column: usize| ranks.get(column).map_or(Rank::None, |ranks| ranks[row]);
    let head = |column: usize| {
        let head = element("th")
            .with("scope", "col")
            .text(&table.columns[column]);
        if is_numeric(table, column) {
            head.class("number")
        } else {
            head
        }
    };
    let rows = table.rows.iter().enumerate().map(|(row, cells)| {
        let cells = cells.iter().enumerate();
        element("tr").children(cells.map(|(column, content)| cell(content, rank(row, column))))
    });
    let mut element = element("table");
    if !table.caption.is_empty() {
        element = element.child(super::element("caption").text(&table.caption));
    }
    let heads = super::element("tr").children((0..table.columns.len()).map(head));
    element = element
        .child(super::element("thead").child(heads))
        .child(super::element("tbody").children(rows));
    let marked = ranks.iter().flatten().any(|&rank| rank != Rank::None);
    let scroll = super::element("div").class("scroll").child(element);
    if marked {
        scroll.child(legend())
    } else {
        scroll
    }
}

fn legend() -> Element {
    element("p").class("note").text(
        "★ best of the rows that are compared; ≈ not significantly different: the \
             intervals overlap.",
    )
}

fn cell(cell: &Cell, rank: Rank) -> Element {
    let written = match cell {
        Cell::Text(text) if text == NOTHING => {
            return element("td")
                .class("number")
                .text(text)
                .child(element("span").class("mark"));
        }
        // A name stays on its line; a sentence does not.
        Cell::Text(text) if text.chars().count() <= LONGEST_NAME => {
            return element("td").class("name").text(text);
        }
        Cell::Text(text) => return element("td").text(text),
        Cell::Number(value) => number(*value),
        Cell::Interval { value, low, high } => interval(*value, *low, *high),
    };
    let mark = |symbol, words| {
        element("span")
            .class("mark")
            .with("title", words)
            .text(symbol)
    };
    let td = element("td");
    match rank {
        Rank::Best => td
            .class("number best")
            .text(written)
            .child(mark("★", "best")),
        Rank::AsGood => td
            .class("number")
            .text(written)
            .child(mark("≈", "the interval overlaps that of the best")),
        Rank::None => td.class("number").text(written).child(mark("", "")),
    }
}

fn is_numeric(table: &Table, column: usize) -> bool {
    let cell = |row: &Vec<Cell>| !matches!(row.get(column), Some(Cell::Text(_)) | None);
    table.rows.iter().any(cell)
}

fn better(head: &str) -> Option<Better> {
    let name = head.trim_end();
    if name.ends_with('↓') {
        Some(Better::Less)
    } else if name.ends_with('↑') || name.starts_with("efficiency") {
        Some(Better::More)
    } else {
        let is_metric = Metric::NAMES.iter().any(|(metric, _)| *metric == name);
        is_metric.then_some(Better::Less)
    }
}

/// The rank of every row's number in a column.
fn ranks(table: &Table, column: usize) -> Vec<Rank> {
    let mut ranks = vec![Rank::None; table.rows.len()];
    let Some(better) = better(&table.columns[column]) else {
        return ranks;
    };
    let bounds = |row: &Vec<Cell>| row.get(column).and_then(|cell| bounds(cell, better));
    let bounds: Vec<_> = table.rows.iter().map(bounds).collect();
    let keys: Vec<_> = table.rows.iter().map(|row| key(row)).collect();
    for (row, rank) in ranks.iter_mut().enumerate() {
        let Some([value, _, end]) = bounds[row] else {
            continue;
        };
        let rivals = || {
            let others = bounds
                .iter()
                .zip(&keys)
                .filter(|(_, key)| **key == keys[row]);
            others.filter_map(|(bounds, _)| *bounds)
        };
        // A number alone is not the best of anything.
        let best = rivals().reduce(|a, b| if b[0] < a[0] { b } else { a });
        let Some(best) = best.filter(|_| rivals().count() > 1) else {
            continue;
        };
        *rank = if value <= best[0] {
            Rank::Best
        } else if end <= best[1] {
            Rank::AsGood
        } else {
            Rank::None
        };
    }
    ranks
}

/// The value, the worse and the better end of its interval, with the sign by which less is better.
///
/// A number without an interval has ends that overlap nothing. None: not finite.
fn bounds(cell: &Cell, better: Better) -> Option<[f64; 3]> {
    let sign = match better {
        Better::Less => 1.0,
        Better::More => -1.0,
    };
    let bounds = match *cell {
        Cell::Text(_) => return None,
        Cell::Number(value) => [value * sign, f64::NEG_INFINITY, f64::INFINITY],
        Cell::Interval { value, low, high } => {
            let [low, high] = [low * sign, high * sign];
            [value * sign, low.max(high), low.min(high)]
        }
    };
    bounds[0].is_finite().then_some(bounds)
}

/// The texts at the beginning of a row, but for the last of them.
fn key(row: &[Cell]) -> Vec<&str> {
    let texts = row.iter().map_while(|cell| match cell {
        Cell::Text(text) => Some(text.as_str()),
        _ => None,
    });
    let mut texts: Vec<_> = texts.collect();
    texts.pop();
    texts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn interval_cell(value: f64, half: f64) -> Cell {
        let [low, high] = [value - half, value + half];
        Cell::Interval { value, low, high }
    }

    fn ranked(head: &str, rows: &[(&str, Cell)]) -> Vec<Rank> {
        let row = |(index, (scene, cell)): (usize, &(&str, Cell))| {
            let method = format!("m{index}");
            vec![
                Cell::Text((*scene).into()),
                Cell::Text(method),
                cell.clone(),
            ]
        };
        let table = Table {
            caption: String::new(),
            columns: vec!["scene".into(), "method".into(), head.into()],
            rows: rows.iter().enumerate().map(row).collect(),
        };
        ranks(&table, 2)
    }

    #[test]
    fn the_best_of_each_scene_is_marked() {
        use Rank::{AsGood, Best, None};
        let rows = [
            ("a", interval_cell(1.0, 0.1)),
            ("a", interval_cell(1.15, 0.1)),
            ("a", interval_cell(1.3, 0.04)),
            ("b", interval_cell(7.0, 0.1)),
            ("b", Cell::Number(f64::NAN)),
            ("b", interval_cell(6.0, 0.1)),
        ];
        assert_eq!(
            ranked("relmse", &rows),
            [Best, AsGood, None, None, None, Best]
        );
        assert_eq!(
            ranked("gain ↑", &rows),
            [None, None, Best, Best, None, None]
        );
        assert_eq!(ranked("rays", &rows), [None; 6]);
        assert_eq!(ranked("relmse", &rows[..1]), [None]);
    }

    #[test]
    fn numbers_without_intervals_are_as_good_as_no_other() {
        let rows = [("a", Cell::Number(2.0)), ("a", Cell::Number(3.0))];
        assert_eq!(ranked("efficiency_rays", &rows), [Rank::None, Rank::Best]);
    }

    #[test]
    fn a_table_has_all_its_cells() {
        let content = Table {
            caption: "A < B".into(),
            columns: vec!["method".into(), "relmse".into()],
            rows: vec![
                vec![Cell::Text("<x>".into()), interval_cell(0.85, 0.03)],
                vec![Cell::Text("y".into()), Cell::Number(2.0)],
            ],
        };
        let markup = table(&content).to_string();
        for part in ["A &lt; B", "&lt;x&gt;", "0.85 [0.82, 0.88]", "★", ">2<"] {
            assert!(markup.contains(part), "{part}: {markup}");
        }
    }
}

//! Claims as text: verdicts, findings, tables, and histograms as bars.

use formats::printable;
use lab::report::table_text;
use lab::results::{Cell, Claim, Plot, PlotKind, Series, Table};
use std::collections::BTreeSet;

/// Returns a claim with its figures. Tables contain the numbers of curves, so only histograms are drawn.
pub(super) fn text(claim: &Claim) -> String {
    let mut text = format!(
        "{}: {}\n  {}: {}\n  {}\n",
        claim.id,
        claim.verdict.words(),
        claim.source,
        claim.claim,
        printable(&claim.found)
    );
    let figures = claim.tables.iter().map(table_text);
    let plots = claim.plots.iter();
    let histograms = plots.filter(|plot| plot.kind == PlotKind::Histogram);
    for figure in figures.chain(histograms.map(histogram)) {
        text.push('\n');
        text.push_str(&figure);
    }
    text
}

/// Returns the statistical methods of the claims, each text once. None: there are no claims.
pub(super) fn methods(claims: &[Claim]) -> Option<String> {
    let methods: BTreeSet<&str> = claims.iter().map(|claim| claim.method.as_str()).collect();
    let text = methods.into_iter().map(|method| format!("{method}\n"));
    Some(text.collect::<String>()).filter(|text| !text.is_empty())
}

/// Returns a table of all verdicts. None: there are no claims.
pub(super) fn summary(claims: &[Claim]) -> Option<String> {
    let row = |claim: &Claim| {
        let words = [claim.verdict.words(), &claim.id, &claim.claim];
        words.map(|words| Cell::Text(words.to_owned())).into()
    };
    let table = Table {
        caption: "Verdicts.".to_owned(),
        columns: ["verdict", "id", "claim"].map(str::to_owned).into(),
        rows: claims.iter().map(row).collect(),
    };
    (!claims.is_empty()).then(|| table_text(&table))
}

/// The length of the longest bar. Unit: characters.
const BAR: f64 = 20.0;

/// Draws the series of a histogram as bars side by side, with a row for each bin.
fn histogram(plot: &Plot) -> String {
    let points = || plot.series.iter().flat_map(|series| &series.points);
    let mut edges: Vec<f64> = points().map(|point| point[0]).collect();
    edges.sort_unstable_by(f64::total_cmp);
    edges.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    let highest = points().map(|point| point[1]).fold(0.0, f64::max);
    let bar = |series: &Series, edge: f64| {
        let point = series
            .points
            .iter()
            .find(|point| (point[0] - edge).abs() < 1e-9);
        let exact = point.map_or(0.0, |point| BAR * point[1] / highest);
        // A bin that is not empty has at least one character.
        let length = if exact > 0.0 { exact.max(1.0) } else { 0.0 };
        Cell::Text("#".repeat(length.round() as usize))
    };
    let row = |edge: f64| {
        let bars = plot.series.iter().map(|series| bar(series, edge));
        std::iter::once(Cell::Number(edge)).chain(bars).collect()
    };
    let names = plot.series.iter().map(|series| series.name.clone());
    table_text(&Table {
        caption: plot.caption.clone(),
        columns: std::iter::once(plot.x.label.clone()).chain(names).collect(),
        rows: edges.into_iter().map(row).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use lab::results::{Axis, Scale, Verdict};

    fn claim() -> Claim {
        let axis = |label: &str| Axis {
            label: label.to_owned(),
            scale: Scale::Linear,
        };
        let series = |name: &str, points: &[[f64; 2]]| Series {
            name: name.to_owned(),
            points: points.to_vec(),
            intervals: Vec::new(),
        };
        Claim {
            id: "figure".to_owned(),
            claim: "It is so.".to_owned(),
            source: "Figure 2".to_owned(),
            verdict: Verdict::NotReproduced,
            found: "It is not.".to_owned(),
            method: "By looking.".to_owned(),
            tables: Vec::new(),
            plots: vec![Plot {
                caption: "Bars.".to_owned(),
                kind: PlotKind::Histogram,
                x: axis("size"),
                y: axis("part"),
                series: vec![
                    series("one", &[[-1.0, 0.5], [0.0, 0.25]]),
                    series("two", &[[0.0, 0.001]]),
                ],
            }],
        }
    }

    #[test]
    fn the_text_of_a_claim_has_its_histogram() {
        let expected = "figure: not reproduced\n  Figure 2: It is so.\n  It is not.\n\
                        \nBars.\n\
                        size  one                   two\n\
                        -1    ####################\n\
                        0     ##########            #\n";
        assert_eq!(text(&claim()), expected);
    }

    #[test]
    fn the_summary_is_a_table_of_verdicts() {
        let expected = "Verdicts.\n\
                        verdict         id      claim\n\
                        not reproduced  figure  It is so.\n";
        assert_eq!(summary(&[claim()]).unwrap(), expected);
        assert_eq!(summary(&[]), None);
    }

    #[test]
    fn claims_with_the_same_certainty_share_its_text() {
        assert_eq!(methods(&[claim(), claim()]).unwrap(), "By looking.\n");
        assert_eq!(methods(&[]), None);
    }
}

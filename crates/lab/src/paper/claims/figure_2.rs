//! Figure 2: how far contributions range.

use super::super::contributions::{
    Contributions, Values, decades, histogram, part_with, quantile, share_of_largest,
};
use super::{Expected, all, axis, claim, judge, shared, table, text};
use crate::results::{Cell, Claim, Plot, PlotKind, Scale, Series, Verdict};
use crate::statistics::Interval;

/// The least range of "several orders of magnitude", between the quantiles 1 % and 99 %.
const DECADES: f64 = 3.0;
/// The largest contributions overwhelm the others if this part of them ...
const FEW: f64 = 0.1;
/// ... has more than this share of the sum.
const MOST: f64 = 0.5;

/// Contributions under one kind of weights, and what they say.
struct Spread<'a> {
    weights: &'a str,
    values: &'a Values,
    samples: u64,
    /// Orders of magnitude between the quantiles 1 % and 99 %.
    range: Option<Interval>,
    /// What the largest part [`FEW`] has of the sum.
    share: Option<Interval>,
}

impl<'a> Spread<'a> {
    fn new(weights: &'a str, values: &'a Values, samples: u64, confidence: f64) -> Self {
        let range = |pass: &[f64]| decades(pass, 0.01).unwrap_or(f64::NAN);
        let share = |pass: &[f64]| share_of_largest(pass, FEW);
        Self {
            weights,
            values,
            samples,
            range: values.interval(range, confidence),
            share: values.interval(share, confidence),
        }
    }

    fn verdicts(&self) -> [Verdict; 2] {
        [(self.range, DECADES), (self.share, MOST)]
            .map(|(number, least)| judge(number, Expected::Above(least)))
    }

    fn found(&self) -> String {
        let told = |number: Option<Interval>, scale: f64, digits: usize| match number {
            Some(Interval { value, low, high }) => {
                let [value, low, high] = [value, low, high].map(|number| number * scale);
                format!("{value:.digits$} [{low:.digits$}, {high:.digits$}]")
            }
            None => "unknown".to_owned(),
        };
        let (range, share) = (told(self.range, 1.0, 2), told(self.share, 100.0, 1));
        format!("{} weights: {range} orders, {share} %", self.weights)
    }

    fn row(&self) -> Vec<Cell> {
        let all = &self.values.all;
        let log = |part| Cell::Number(quantile(all, part).map_or(f64::NAN, libm::log10));
        vec![
            text(self.weights),
            Cell::Number(all.len() as f64 / self.samples as f64),
            log(0.0),
            log(0.01),
            log(0.5),
            log(0.99),
            log(1.0),
            Cell::Number(100.0 * share_of_largest(all, FEW)),
            Cell::Number(100.0 * part_with(all, 0.9)),
        ]
    }

    fn curve(&self) -> Series {
        Series {
            name: format!("{} weights", self.weights),
            points: histogram(&self.values.all, 2),
            intervals: Vec::new(),
        }
    }
}

const COLUMNS: [&str; 9] = [
    "weights",
    "per sample",
    "least",
    "1 %",
    "50 %",
    "99 %",
    "most",
    "largest tenth: % of sum",
    "90 % of sum: % of contributions",
];

/// How large contributions of a scene are, under each kind of weights.
pub fn figure_2(scene: &str, weights: &[(&str, Contributions)]) -> Claim {
    let confidence = shared(2 * (weights.len() + 1));
    let spread = |name, values, samples| Spread::new(name, values, samples, confidence);
    let plain = weights.iter().take(1);
    let plain = plain.map(|(_, all)| spread("no", &all.unweighted, all.samples));
    let weighted = weights
        .iter()
        .map(|(name, all)| spread(name, &all.weighted, all.samples));
    let spreads: Vec<_> = plain.chain(weighted).collect();
    let found: Vec<_> = spreads.iter().map(Spread::found).collect();
    let mut claim = claim(
        &format!("figure-2-{}", scene.to_lowercase()),
        "Figure 2",
        &format!(
            "Scene {scene}: contributions span several orders of magnitude, and the larger ones \
             overwhelm the smaller."
        ),
        all(spreads.iter().flat_map(Spread::verdicts)),
        format!(
            "Between the quantiles 1 % and 99 %, and the share of the largest tenth: {}.",
            found.join("; ")
        ),
    );
    "Luminances of all connections that are not black, of 16 samples per pixel; several orders are at \
     least 3, and to overwhelm is that the largest tenth has more than half of the sum. Student's \
     intervals over the 16 passes; those of the statement hold together with 95 %."
        .clone_into(&mut claim.method);
    let caption =
        format!("Scene {scene}: contributions C_ij before visibility; log10 of quantiles.");
    let rows = spreads.iter().map(Spread::row).collect();
    claim.tables.push(table(caption, &COLUMNS, rows));
    claim.plots.push(Plot {
        caption: format!("Scene {scene}: distribution of contributions before visibility."),
        kind: PlotKind::Histogram,
        x: axis("log10 of the contribution", Scale::Linear),
        y: axis("part of all contributions", Scale::Linear),
        series: spreads.iter().map(Spread::curve).collect(),
    });
    claim
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::Verdict::{NotReproduced, Reproduced, Undecided};

    /// Checks the verdict on passes whose contributions span these orders.
    #[track_caller]
    fn check(orders: &[f64], expected: Verdict) {
        let value = |orders: f64, i: u32| libm::pow(10.0, orders * f64::from(i) / 1000.0);
        let pass = |&orders: &f64| (0..1000).map(|i| value(orders, i)).collect();
        let values = Values::new(orders.iter().map(pass).collect());
        let contributions = Contributions {
            weighted: values.clone(),
            unweighted: values,
            samples: 100,
        };
        let claim = figure_2("A", &[("uniform", contributions)]);
        assert_eq!(claim.verdict, expected, "{}", claim.found);
        assert_eq!(claim.plots[0].series.len(), 2);
    }

    #[test]
    fn ranges_decide() {
        check(&[8.0, 8.1, 7.9], Reproduced);
        check(&[1.0, 1.1, 0.9], NotReproduced);
        check(&[2.0, 3.1, 4.2], Undecided);
        check(&[8.0], Undecided);
    }
}

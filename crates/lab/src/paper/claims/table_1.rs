//! Table 1: RMS errors at equal total rays, normalised to 1 where all shadow rays are traced.

use super::super::plans::{BEYOND, ROOMS, RULES, WEIGHTS};
use super::records::{Measured, Quantity, error_by_rays, judged, rays, seconds, trimmed_by_rays};
use super::{
    CONFIDENCE, Expected, NONE, all, cell, claim, judge, optimisations, shared, table, text, words,
};
use crate::results::{Cell, Claim, Record, Table};
use crate::statistics::Interval;

/// "The RMS error decreases by 5 to 20 %."
const STATED: Expected = Expected::Within(0.80, 0.95);

/// Three claims for each scene under each kind of weights; the first of a scene has its table.
pub fn table_1(records: &[Record]) -> Vec<Claim> {
    let mut claims = Vec::new();
    for (scene, _) in ROOMS {
        let measured = Measured { records, scene };
        let first = claims.len();
        for weights in WEIGHTS {
            claims.extend(under(&measured, weights));
        }
        claims[first].tables.push(whole(&measured));
    }
    claims
}

/// The error of a rule under these weights, relative to that of another.
fn ratio(measured: &Measured<'_>, weights: &str, rules: [&str; 2]) -> Option<Interval> {
    measured.ratio(weights, rules, judged(weights).by_rays, shared(3))
}

/// What is stated of a scene, under these weights.
fn under(measured: &Measured<'_>, weights: &str) -> [Claim; 3] {
    let scene = measured.scene;
    let to_none = optimisations().map(|(number, rule)| {
        let interval = ratio(measured, weights, [rule, NONE]);
        (format!("optimisation {number}"), interval)
    });
    let to_none: Vec<_> = to_none.collect();
    let steps = RULES[1..].windows(2).enumerate().map(|(i, pair)| {
        let interval = ratio(measured, weights, [pair[1], pair[0]]);
        (format!("{} over {}", i + 2, i + 1), interval)
    });
    let steps: Vec<_> = steps.collect();
    let make = |what: &str, words: &str, ratios: &[(String, Option<Interval>)], expected| {
        let verdict = all(ratios.iter().map(|(_, ratio)| judge(*ratio, expected)));
        claim(
            &format!("table-1-{}-{weights}-{what}", scene.to_lowercase()),
            "Table 1",
            &format!("Scene {scene}, {weights} weights: {words}."),
            verdict,
            found(judged(weights).name, ratios),
        )
    };
    [
        make(
            "lower",
            "at equal total rays each optimisation lowers the RMS error",
            &to_none,
            Expected::Below(1.0),
        ),
        make("5-20", "it is lower by 5 to 20 %", &to_none, STATED),
        make(
            "order",
            "the later optimisations are better",
            &steps,
            Expected::Below(1.0),
        ),
    ]
}

fn found(error: &str, ratios: &[(String, Option<Interval>)]) -> String {
    let parts = ratios
        .iter()
        .map(|(name, ratio)| format!("{name}: {}", words(*ratio)));
    let parts: Vec<_> = parts.collect();
    format!("{error}: {}.", parts.join("; "))
}

/// The whole table of a scene: all weights, the paper's rules and ours.
pub(super) fn whole(measured: &Measured<'_>) -> Table {
    let mut rows = Vec::new();
    for weights in WEIGHTS {
        for (number, rule) in RULES.into_iter().enumerate() {
            let name = match number {
                0 => "none".to_owned(),
                number => number.to_string(),
            };
            rows.push(row(measured, weights, rule, &name));
        }
        rows.extend(BEYOND.map(|rule| row(measured, weights, rule, "beyond")));
    }
    table(
        format!(
            "Scene {}: errors at equal rays, relative to none under the same weights (95 % \
             intervals). Under uniform weights the error without the worst 0.1 % decides, under the \
             others the plain one.",
            measured.scene
        ),
        &[
            "weights",
            "optimisation",
            "--shadow-rays",
            "samples per pixel",
            "rays, 10^6",
            "shadow rays, %",
            "RMS error",
            "RMS error without worst 0.1 %",
            "time",
        ],
        rows,
    )
}

fn row(measured: &Measured<'_>, weights: &str, rule: &str, name: &str) -> Vec<Cell> {
    let relative = |quantity| {
        if rule == NONE {
            return Cell::Number(1.0);
        }
        cell(measured.ratio(weights, [rule, NONE], quantity, CONFIDENCE))
    };
    let mean = |quantity: Quantity| Cell::Number(measured.mean(weights, rule, quantity));
    let shadow = |record: &Record| {
        let traced = record.rays.connection + record.rays.light_image;
        100.0 * traced as f64 / rays(record)
    };
    vec![
        text(weights),
        text(name),
        text(rule),
        mean(|record| record.spp as f64),
        mean(|record| rays(record) / 1e6),
        mean(shadow),
        relative(error_by_rays),
        relative(trimmed_by_rays),
        relative(seconds),
    ]
}

#[cfg(test)]
mod tests {
    use super::super::records::made;
    use super::*;
    use crate::results::Verdict::{self, NotReproduced, Reproduced, Undecided};

    /// The verdicts on `lower`, `5-20` and `order` of scene A under uniform weights.
    #[track_caller]
    fn check(errors: [f64; 3], spread: f64, expected: [Verdict; 3]) {
        let [first, second, third] = errors;
        let rules = [
            (RULES[0], 1.0, 1.0),
            (RULES[1], first, 1.0),
            (RULES[2], second, 1.0),
            (RULES[3], third, 1.0),
        ];
        let claims = table_1(&made::records("A", "uniform", &rules, spread));
        assert_eq!(claims.len(), 18);
        let verdicts: Vec<_> = claims[..3].iter().map(|claim| claim.verdict).collect();
        assert_eq!(verdicts, expected, "{:#?}", &claims[..3]);
        assert!(claims[3..].iter().all(|claim| claim.verdict == Undecided));
        let table = &claims[0].tables[0];
        assert!(
            table
                .rows
                .iter()
                .all(|row| row.len() == table.columns.len())
        );
    }

    #[test]
    fn errors_decide() {
        check([0.94, 0.88, 0.82], 0.004, [Reproduced; 3]);
        check(
            [0.94, 0.88, 0.7],
            0.004,
            [Reproduced, NotReproduced, Reproduced],
        );
        check([1.1, 1.2, 1.3], 0.004, [NotReproduced; 3]);
        check([0.94, 0.88, 0.82], 0.6, [Undecided; 3]);
        check(
            [0.85, 0.9, 0.94],
            0.004,
            [Reproduced, Reproduced, NotReproduced],
        );
    }
}

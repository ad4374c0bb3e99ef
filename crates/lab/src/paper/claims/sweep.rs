//! Section 3, by implication: where more light is reflected there are more shadow rays to save.

use super::super::plans::{ALBEDOS, RULES, WEIGHTS, albedo_name};
use super::records::{Measured, judged, ratio_of, rays};
use super::{
    CONFIDENCE, Expected, NONE, all, axis, cell, claim, judge, lines, optimisations, series,
    shared, table, text, words,
};
use crate::results::{Cell, Claim, Record, Scale, Table};
use crate::statistics::Interval;

/// A claim for each kind of weights; the first has the table.
pub fn albedo(records: &[Record]) -> Vec<Claim> {
    let mut claims: Vec<_> = WEIGHTS
        .iter()
        .map(|weights| under(records, weights))
        .collect();
    claims[0].tables.push(whole(records));
    claims
}

fn under(records: &[Record], weights: &str) -> Claim {
    let growths: Vec<_> = optimisations()
        .map(|(number, rule)| (number, growth(records, weights, rule)))
        .collect();
    let parts: Vec<_> = growths
        .iter()
        .map(|(number, growth)| format!("optimisation {number}: {}", words(*growth)))
        .collect();
    let [least, .., most] = ALBEDOS;
    let mut claim = claim(
        &format!("section-3-albedo-{weights}"),
        "Section 3, by implication",
        &format!(
            "{weights} weights: the higher the albedo, the more each optimisation lowers the error \
             at equal rays."
        ),
        all(growths
            .iter()
            .map(|(_, growth)| judge(*growth, Expected::Below(1.0)))),
        format!(
            "{}, relative to none, at albedo {most} over that at albedo {least}: {}.",
            judged(weights).name,
            parts.join("; ")
        ),
    );
    let curve = |(number, rule): (usize, &str)| {
        let points: Vec<_> = ALBEDOS
            .iter()
            .map(|albedo| {
                let gain = gain(records, weights, rule, *albedo);
                (f64::from(*albedo), gain)
            })
            .collect();
        series(format!("optimisation {number}"), &points)
    };
    claim.plots.push(lines(
        format!("Errors at equal rays, {weights} weights."),
        axis("albedo", Scale::Linear),
        axis("error relative to none", Scale::Linear),
        optimisations().map(curve).collect(),
    ));
    claim
}

/// The error of a rule at equal rays, relative to none.
fn gain(records: &[Record], weights: &str, rule: &str, albedo: f32) -> Option<Interval> {
    let scene = albedo_name(albedo);
    let measured = Measured {
        records,
        scene: &scene,
    };
    measured.ratio(weights, [rule, NONE], judged(weights).by_rays, CONFIDENCE)
}

/// How that changes from the least albedo to the largest. Renders of other albedos are independent;
/// pairing them by seed costs nothing.
fn growth(records: &[Record], weights: &str, rule: &str) -> Option<Interval> {
    let gains = |albedo: f32| {
        let scene = albedo_name(albedo);
        let measured = Measured {
            records,
            scene: &scene,
        };
        measured.ratios(weights, [rule, NONE], judged(weights).by_rays)
    };
    let [least, .., most] = ALBEDOS;
    ratio_of(&gains(most), &gains(least), shared(RULES.len() - 1))
}

/// Rays of a pass.
fn rays_per_pass(record: &Record) -> f64 {
    rays(record) / record.spp as f64
}

/// How many more samples the paper's formulas promise for the same rays, and the errors.
fn whole(records: &[Record]) -> Table {
    let mut rows = Vec::new();
    for weights in WEIGHTS {
        for albedo in ALBEDOS {
            let scene = albedo_name(albedo);
            let measured = Measured {
                records,
                scene: &scene,
            };
            let cost = |rule: &str| measured.mean(weights, rule, rays_per_pass);
            let samples = |rule: &str| Cell::Number(cost(NONE) / cost(rule));
            let mut row = vec![text(weights), Cell::Number(f64::from(albedo))];
            row.extend(promised(f64::from(albedo)).map(Cell::Number));
            row.extend(optimisations().map(|(_, rule)| samples(rule)));
            let errors = optimisations().map(|(_, rule)| gain(records, weights, rule, albedo));
            row.extend(errors.map(cell));
            rows.push(row);
        }
    }
    table(
        "Samples for the rays of one that traces all, by the formulas of section 3 and measured, and \
         errors at equal rays relative to none (95 % intervals); under uniform weights without the \
         worst 0.1 % of pixels.",
        &[
            "weights",
            "albedo",
            "samples, formula: 1",
            "2",
            "3",
            "measured: 1",
            "2",
            "3",
            "error: 1",
            "2",
            "3",
        ],
        rows,
    )
}

/// Rays of a sample that traces all, over those with optimisation 1, 2 and 3: 2/(1-ρ) of walks, and
/// N_l N_e, N_l, N_e or one shadow ray.
fn promised(albedo: f64) -> [f64; 3] {
    let camera = 1.0 / (1.0 - albedo);
    let light = 1.0 + camera;
    let walks = 2.0 * camera;
    [light, camera, 1.0].map(|shadow| (walks + light * camera) / (walks + shadow))
}

#[cfg(test)]
mod tests {
    use super::super::records::made;
    use super::*;
    use crate::results::Verdict::{self, NotReproduced, Reproduced, Undecided};

    /// At ρ = ½ there are 4 rays of walks and 6 shadow rays, or 3, 2 and 1.
    #[test]
    fn formulas_promise_what_they_do_by_hand() {
        let [first, second, third] = promised(0.5);
        assert!((first - 10.0 / 7.0).abs() < 1e-12);
        assert!((second - 10.0 / 6.0).abs() < 1e-12);
        assert!((third - 2.0).abs() < 1e-12);
    }

    #[track_caller]
    fn check(errors: [f64; 2], spread: f64, expected: Verdict) {
        let mut records = Vec::new();
        for (albedo, error) in [ALBEDOS[0], ALBEDOS[3]].into_iter().zip(errors) {
            let rules: Vec<_> = [(NONE, 1.0, 1.0)]
                .into_iter()
                .chain(optimisations().map(|(_, rule)| (rule, error, 1.0)))
                .collect();
            let scene = albedo_name(albedo);
            records.extend(made::records(&scene, "uniform", &rules, spread));
        }
        let claims = albedo(&records);
        assert_eq!(claims[0].verdict, expected, "{}", claims[0].found);
        assert_eq!(claims[1].verdict, Undecided);
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
        check([0.9, 0.7], 0.01, Reproduced);
        check([0.7, 0.9], 0.01, NotReproduced);
    }
}

//! Section 3's formulas, and figure 2.

use super::super::contributions::{
    Contributions, decades, histogram, part_with, quantile, share_of_largest,
};
use super::super::depths::Depths;
use super::{Expected, all, axis, cell, claim, judge, lines, series, table, text};
use crate::results::{Cell, Claim, Plot, PlotKind, Scale, Series};
use crate::statistics::Interval;

/// How close a mean has to be to its formula.
const TOLERANCE: Expected = Expected::Within(0.99, 1.01);

/// What N_e and N_l N_e are in closed rooms.
pub fn section_3(rooms: &[Depths]) -> Vec<Claim> {
    let method = "Independent walks in a closed cube of one albedo; Student's intervals of 95 % from \
                  40 parts; reproduced where each lies within 1 % of its formula.";
    let camera = |room: &Depths| relative(room.camera, room.expected_camera());
    let connections = |room: &Depths| relative(room.connections, room.expected_connections());
    let judged = |id: &str, words: &str, of: &dyn Fn(&Depths) -> Interval| {
        let verdict = all(rooms.iter().map(|room| judge(Some(of(room)), TOLERANCE)));
        let parts: Vec<_> = rooms
            .iter()
            .map(|room| {
                let Interval { value, low, high } = of(room);
                let [value, low, high] = [value, low, high].map(|ratio| 100.0 * (ratio - 1.0));
                format!("{:.1}: {value:+.2} % [{low:+.2}, {high:+.2}]", room.albedo)
            })
            .collect();
        Claim {
            method: method.to_owned(),
            ..claim(
                id,
                "Section 3",
                words,
                verdict,
                format!("Off the formula by, at albedo {}.", parts.join("; ")),
            )
        }
    };
    let mut claims = vec![
        judged(
            "section-3-camera",
            "A camera walk meets E(N_e) = 1 / (1 - rho) surfaces.",
            &camera,
        ),
        judged(
            "section-3-connections",
            "A sample has E(N_l N_e) = (2 - rho) / (1 - rho)^2 connections.",
            &connections,
        ),
    ];
    let row = |room: &Depths| {
        vec![
            Cell::Number((room.albedo * 100.0).round() / 100.0),
            cell(Some(room.camera)),
            Cell::Number(room.expected_camera()),
            cell(Some(room.connections)),
            Cell::Number(room.expected_connections()),
            Cell::Number(room.traced),
        ]
    };
    claims[1].tables.push(table(
        "Walks in a closed cube; black connections, such as those along a wall, need no ray.",
        &[
            "albedo",
            "N_e",
            "formula",
            "N_l N_e",
            "formula",
            "shadow rays traced",
        ],
        rooms.iter().map(row).collect(),
    ));
    claims[1].plots.push(depth_plot(rooms));
    claims
}

fn relative(interval: Interval, expected: f64) -> Interval {
    Interval {
        value: interval.value / expected,
        low: interval.low / expected,
        high: interval.high / expected,
    }
}

fn depth_plot(rooms: &[Depths]) -> Plot {
    let measured = |of: fn(&Depths) -> Interval| -> Vec<_> {
        let point = |room: &Depths| (room.albedo, Some(of(room)));
        rooms.iter().map(point).collect()
    };
    let formula = |name: &str, of: fn(&Depths) -> f64| Series {
        name: name.to_owned(),
        points: rooms.iter().map(|room| [room.albedo, of(room)]).collect(),
        intervals: Vec::new(),
    };
    lines(
        "Lengths of walks, and connections, in closed rooms.",
        axis("albedo", Scale::Linear),
        axis("mean number", Scale::Log),
        vec![
            series("N_e measured", &measured(|room| room.camera)),
            formula("1/(1-rho)", Depths::expected_camera),
            series("N_l N_e measured", &measured(|room| room.connections)),
            formula("(2-rho)/(1-rho)^2", Depths::expected_connections),
        ],
    )
}

/// The least range of "several orders of magnitude", between the quantiles 1 % and 99 %.
const DECADES: f64 = 3.0;
/// The largest contributions overwhelm the others if this part of them ...
const FEW: f64 = 0.1;
/// ... has more than this share of the sum.
const MOST: f64 = 0.5;

/// How large contributions of a scene are, under each kind of weights.
pub fn figure_2(scene: &str, weights: &[(&str, Contributions)]) -> Claim {
    let mut rows = Vec::new();
    let mut curves = Vec::new();
    let mut verdicts = Vec::new();
    let mut found = Vec::new();
    let plain = weights.iter().take(1);
    let plain = plain.map(|(_, all)| ("no", &all.unweighted, all.samples));
    let weighted = weights
        .iter()
        .map(|(name, all)| (*name, &all.weighted, all.samples));
    for (name, values, samples) in plain.chain(weighted) {
        let range = decades(values, 0.01);
        let share = share_of_largest(values, FEW);
        for (number, least) in [(range.unwrap_or(f64::NAN), DECADES), (share, MOST)] {
            verdicts.push(judge(Some(certain(number)), Expected::Above(least)));
        }
        found.push(format!(
            "{name} weights: {:.1} orders, {:.0} %",
            range.unwrap_or(f64::NAN),
            100.0 * share
        ));
        let log = |part| Cell::Number(quantile(values, part).map_or(f64::NAN, libm::log10));
        rows.push(vec![
            text(name),
            Cell::Number(values.len() as f64 / samples as f64),
            log(0.0),
            log(0.01),
            log(0.5),
            log(0.99),
            log(1.0),
            Cell::Number(100.0 * share),
            Cell::Number(100.0 * part_with(values, 0.9)),
        ]);
        curves.push(Series {
            name: format!("{name} weights"),
            points: histogram(values, 2),
            intervals: Vec::new(),
        });
    }
    let mut claim = claim(
        &format!("figure-2-{}", scene.to_lowercase()),
        "Figure 2",
        &format!(
            "Scene {scene}: contributions span several orders of magnitude, and the larger ones \
             overwhelm the smaller."
        ),
        all(verdicts),
        format!(
            "Between the quantiles 1 % and 99 %, and the share of the largest tenth: {}.",
            found.join("; ")
        ),
    );
    "Luminances of all connections that are not black, of 16 samples per pixel; several orders are at \
     least 3, and to overwhelm is that the largest tenth has more than half of the sum. With more than \
     10^5 values the sampling error is far below the margins."
        .clone_into(&mut claim.method);
    claim.tables.push(table(
        format!("Scene {scene}: contributions C_ij before visibility; log10 of quantiles."),
        &[
            "weights",
            "per sample",
            "least",
            "1 %",
            "50 %",
            "99 %",
            "most",
            "largest tenth: % of sum",
            "90 % of sum: % of contributions",
        ],
        rows,
    ));
    claim.plots.push(Plot {
        caption: format!("Scene {scene}: distribution of contributions before visibility."),
        kind: PlotKind::Histogram,
        x: axis("log10 of the contribution", Scale::Linear),
        y: axis("part of all contributions", Scale::Linear),
        series: curves,
    });
    claim
}

/// A number as an interval without width.
fn certain(value: f64) -> Interval {
    Interval {
        value,
        low: value,
        high: value,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::Verdict::{self, NotReproduced, Reproduced, Undecided};

    #[track_caller]
    fn check_depths(off: f64, half: f64, expected: Verdict) {
        let around = |value: f64| Interval {
            value: value * (1.0 + off),
            low: value * (1.0 + off - half),
            high: value * (1.0 + off + half),
        };
        let room = Depths {
            albedo: 0.5,
            camera: around(2.0),
            connections: around(6.0),
            traced: 4.0,
        };
        let claims = section_3(&[room, room]);
        assert_eq!(claims[0].verdict, expected);
        assert_eq!(claims[1].verdict, expected);
        assert_eq!(claims[1].tables[0].rows.len(), 2);
        assert_eq!(claims[1].plots[0].series[0].intervals.len(), 2);
    }

    #[test]
    fn depths_decide() {
        check_depths(0.001, 0.003, Reproduced);
        check_depths(0.009, 0.003, Undecided);
        check_depths(-0.02, 0.003, NotReproduced);
        assert_eq!(section_3(&[])[0].verdict, Undecided);
    }

    #[track_caller]
    fn check_range(decades: i32, expected: Verdict) {
        let value = |i: i32| libm::pow(10.0, f64::from(decades * i) / 1000.0);
        let values: Vec<f64> = (0..1000).map(value).collect();
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
        check_range(8, Reproduced);
        check_range(1, NotReproduced);
    }
}

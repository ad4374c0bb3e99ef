//! Section 3's formulas.

use super::super::depths::Depths;
use super::{Expected, all, axis, cell, claim, judge, lines, series, table};
use crate::results::{Cell, Claim, Plot, Scale, Series, Table};
use crate::statistics::Interval;

/// How close a mean has to be to its formula.
const TOLERANCE: Expected = Expected::Within(0.99, 1.01);

/// How it was measured, in words.
const METHOD: &str = "Independent walks in a closed cube of one albedo; Student's intervals from 40 \
     parts, which hold together with 95 % in all rooms; reproduced where each lies within 1 % of \
     its formula.";

/// What N_e and N_l N_e are in closed rooms.
pub fn section_3(rooms: &[Depths]) -> Vec<Claim> {
    let camera = judged(
        "section-3-camera",
        "A camera walk meets E(N_e) = 1 / (1 - rho) surfaces.",
        rooms,
        |room| relative(room.camera, room.expected_camera()),
    );
    let mut connections = judged(
        "section-3-connections",
        "A sample has E(N_l N_e) = (2 - rho) / (1 - rho)^2 connections.",
        rooms,
        |room| relative(room.connections, room.expected_connections()),
    );
    connections.tables.push(depth_table(rooms));
    connections.plots.push(depth_plot(rooms));
    vec![camera, connections]
}

/// A claim that a number over its formula, `of`, is 1 in all rooms.
fn judged(id: &str, words: &str, rooms: &[Depths], of: fn(&Depths) -> Interval) -> Claim {
    let parts = rooms.iter().map(|room| {
        let Interval { value, low, high } = of(room);
        let [value, low, high] = [value, low, high].map(|ratio| 100.0 * (ratio - 1.0));
        format!("{:.1}: {value:+.2} % [{low:+.2}, {high:+.2}]", room.albedo)
    });
    let parts: Vec<_> = parts.collect();
    let verdicts = rooms.iter().map(|room| judge(Some(of(room)), TOLERANCE));
    let found = format!("Off the formula by, at albedo {}.", parts.join("; "));
    Claim {
        method: METHOD.to_owned(),
        ..claim(id, "Section 3", words, all(verdicts), found)
    }
}

fn depth_table(rooms: &[Depths]) -> Table {
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
    table(
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
    )
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
}

//! "For complex scenes the benefit of the reduction of shadow rays will be more important."

use super::super::plans::{complexity_name, method_name};
use super::super::room::Lamp;
use super::records::{Measured, seconds_per_ray, trimmed_by_rays, trimmed_by_seconds};
use super::{
    CONFIDENCE, Expected, NONE, all, axis, cell, claim, judge, lines, optimisations, series,
    shared, table, text, words,
};
use crate::results::{Cell, Claim, Record, Scale};
use crate::statistics::{Interval, ratio_interval};

/// The weights of the sweep.
const WEIGHTS: &str = "balance";

/// The errors in equal time of the three optimisations in a room.
#[derive(Clone, Debug)]
struct Level {
    triangles: f64,
    gains: Vec<Option<Interval>>,
}

/// A claim for each lamp; `levels` are the numbers of triangles, ascending.
pub fn complexity(records: &[Record], levels: &[usize]) -> Vec<Claim> {
    let claims = Lamp::ALL.iter().map(|lamp| of_lamp(records, *lamp, levels));
    claims.collect()
}

fn of_lamp(records: &[Record], lamp: Lamp, triangles: &[usize]) -> Claim {
    let base = method_name(WEIGHTS, NONE);
    let levels: Vec<_> = triangles
        .iter()
        .map(|&triangles| {
            let scene = complexity_name(lamp.name(), triangles);
            let measured = Measured {
                records,
                scene: &scene,
            };
            let gain = |(_, rule): (usize, &str)| {
                let method = method_name(WEIGHTS, rule);
                measured.ratio([&method, &base], trimmed_by_seconds, CONFIDENCE)
            };
            Level {
                triangles: triangles as f64,
                gains: optimisations().map(gain).collect(),
            }
        })
        .collect();
    let growth: Vec<_> = optimisations()
        .map(|(_, rule)| growth(records, lamp, triangles, rule))
        .collect();
    let parts: Vec<_> = optimisations()
        .zip(&growth)
        .map(|((number, _), growth)| {
            let crossing = crossing(&levels, number - 1);
            format!("optimisation {number}: {}, {crossing}", words(*growth))
        })
        .collect();
    let mut claim = claim(
        &format!("section-4-complexity-{}", lamp.name()),
        "Section 4",
        &format!(
            "Room with {} light: the more triangles, the lower the error of each optimisation in \
             equal time, relative to tracing all.",
            lamp.name()
        ),
        all(growth
            .iter()
            .map(|growth| judge(*growth, Expected::Below(1.0)))),
        format!(
            "Relative error with the most triangles over that with the fewest: {}.",
            parts.join("; ")
        ),
    );
    claim.tables.push(whole(records, lamp, triangles, &levels));
    let curve = |(number, _): (usize, &str)| {
        let points: Vec<_> = levels
            .iter()
            .map(|level| (level.triangles, level.gains[number - 1]))
            .collect();
        series(format!("optimisation {number}"), &points)
    };
    claim.plots.push(lines(
        format!("Room with {} light: errors in equal time.", lamp.name()),
        axis("triangles", Scale::Log),
        axis("error relative to none", Scale::Linear),
        optimisations().map(curve).collect(),
    ));
    claim
}

/// How the relative error of a rule changes from the fewest triangles to the most.
fn growth(records: &[Record], lamp: Lamp, triangles: &[usize], rule: &str) -> Option<Interval> {
    let methods = [rule, NONE].map(|rule| method_name(WEIGHTS, rule));
    let gains = |triangles: usize| {
        let scene = complexity_name(lamp.name(), triangles);
        let measured = Measured {
            records,
            scene: &scene,
        };
        measured.ratios([&methods[0], &methods[1]], trimmed_by_seconds)
    };
    let [first, last] = [triangles.first()?, triangles.last()?];
    ratio_interval(
        &gains(*last),
        &gains(*first),
        shared(optimisations().count()),
    )
}

/// From how many triangles on an optimisation pays, in words.
fn crossing(levels: &[Level], optimisation: usize) -> String {
    let known: Vec<_> = levels
        .iter()
        .filter_map(|level| Some((level.triangles, level.gains[optimisation]?.value)))
        .collect();
    if known.iter().all(|(_, gain)| *gain < 1.0) {
        return "pays everywhere".to_owned();
    }
    if known.iter().all(|(_, gain)| *gain >= 1.0) {
        return "pays nowhere".to_owned();
    }
    let last_loss = known.iter().rposition(|(_, gain)| *gain >= 1.0);
    match last_loss.and_then(|i| Some((known[i], *known.get(i + 1)?))) {
        Some(((few, loss), (many, gain))) => {
            let part = libm::log(loss) / libm::log(loss / gain);
            let at = few * libm::pow(many / few, part);
            format!("pays from about {at:.1e} triangles on")
        }
        None => "pays for few triangles and not for many".to_owned(),
    }
}

fn whole(
    records: &[Record],
    lamp: Lamp,
    triangles: &[usize],
    levels: &[Level],
) -> crate::results::Table {
    let base = method_name(WEIGHTS, NONE);
    let rows = triangles.iter().zip(levels).map(|(&triangles, level)| {
        let scene = complexity_name(lamp.name(), triangles);
        let measured = Measured {
            records,
            scene: &scene,
        };
        let nanoseconds = |rule: &str| {
            let method = method_name(WEIGHTS, rule);
            Cell::Number(1e9 * measured.mean(&method, seconds_per_ray))
        };
        let by_rays = |(_, rule): (usize, &str)| {
            let method = method_name(WEIGHTS, rule);
            cell(measured.ratio([&method, &base], trimmed_by_rays, CONFIDENCE))
        };
        let mut row = vec![text(triangles.to_string()), nanoseconds(NONE)];
        row.extend(optimisations().map(|(_, rule)| nanoseconds(rule)));
        row.extend(level.gains.iter().map(|gain| cell(*gain)));
        row.extend(optimisations().map(by_rays));
        row
    });
    table(
        format!(
            "Room with {} light, {WEIGHTS} weights: time for a ray, all other work included, and \
             errors relative to none (95 % intervals).",
            lamp.name()
        ),
        &[
            "triangles",
            "ns per ray, none",
            "1",
            "2",
            "3",
            "equal time: 1",
            "2",
            "3",
            "equal rays: 1",
            "2",
            "3",
        ],
        rows.collect(),
    )
}

#[cfg(test)]
mod tests {
    use super::super::records::made;
    use super::*;
    use crate::results::Verdict::{self, NotReproduced, Reproduced};

    #[track_caller]
    fn check(times: [f64; 2], expected: Verdict, words: &str) {
        let mut records = Vec::new();
        for (triangles, time) in [100, 10_000].into_iter().zip(times) {
            let rules: Vec<_> = [(NONE, 1.0, 1.0)]
                .into_iter()
                .chain(optimisations().map(|(_, rule)| (rule, 1.0, time)))
                .collect();
            let scene = complexity_name("direct", triangles);
            records.extend(made::records(&scene, WEIGHTS, &rules, 0.01));
        }
        let claims = complexity(&records, &[100, 10_000]);
        assert_eq!(claims[0].verdict, expected, "{}", claims[0].found);
        assert!(claims[0].found.contains(words), "{}", claims[0].found);
        let table = &claims[0].tables[0];
        assert!(
            table
                .rows
                .iter()
                .all(|row| row.len() == table.columns.len())
        );
        assert_eq!(claims[0].plots[0].series.len(), 3);
        assert_eq!(claims[1].verdict, Verdict::Undecided);
    }

    /// √time is the error in equal time: 2 to ½ crosses 1 in the middle of 10² and 10⁴.
    #[test]
    fn times_decide() {
        check([4.0, 0.25], Reproduced, "from about 1.0e3 triangles");
        check([0.5, 0.25], Reproduced, "pays everywhere");
        check([0.25, 4.0], NotReproduced, "and not for many");
        check([2.0, 4.0], NotReproduced, "pays nowhere");
    }
}

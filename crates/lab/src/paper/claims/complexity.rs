//! "For complex scenes the benefit of the reduction of shadow rays will be more important."

use super::super::plans::complexity_name;
use super::super::room::Lamp;
use super::records::{BySeed, Judged, Measured, judged, ratio_of, seconds_per_ray};
use super::{
    CONFIDENCE, Expected, NONE, all, axis, cell, claim, judge, lines, optimisations, series,
    shared, table, text, words,
};
use crate::results::{Cell, Claim, Plot, Record, Scale, Table};
use crate::statistics::Interval;

/// The weights of the sweep.
const WEIGHTS: &str = "balance";

/// A claim for each lamp; `levels` are the numbers of triangles, ascending.
pub fn complexity(records: &[Record], levels: &[usize]) -> Vec<Claim> {
    let claims = Lamp::ALL
        .iter()
        .map(|lamp| Sweep::new(records, *lamp, levels).claim());
    claims.collect()
}

/// A room of ever more triangles.
struct Sweep<'a> {
    records: &'a [Record],
    lamp: &'static str,
    levels: Vec<Level>,
}

/// The errors in equal time of the three optimisations in a room.
#[derive(Clone, Debug)]
struct Level {
    triangles: usize,
    gains: Vec<Option<Interval>>,
}

impl<'a> Sweep<'a> {
    fn new(records: &'a [Record], lamp: Lamp, triangles: &[usize]) -> Self {
        let mut sweep = Self {
            records,
            lamp: lamp.name(),
            levels: Vec::new(),
        };
        let level = |&triangles: &usize| Level {
            triangles,
            gains: sweep.gains(triangles),
        };
        sweep.levels = triangles.iter().map(level).collect();
        sweep
    }

    /// What was measured in the room of so many triangles.
    fn with<T>(&self, triangles: usize, get: impl FnOnce(&Measured<'_>) -> T) -> T {
        let scene = complexity_name(self.lamp, triangles);
        get(&Measured {
            records: self.records,
            scene: &scene,
        })
    }

    /// Errors in equal time, relative to none.
    fn gains(&self, triangles: usize) -> Vec<Option<Interval>> {
        let by_seconds = judged(WEIGHTS).by_seconds;
        let gain = |measured: &Measured<'_>, rule| {
            measured.ratio(WEIGHTS, [rule, NONE], by_seconds, CONFIDENCE)
        };
        let gains = |measured: &Measured<'_>| {
            let gains = optimisations().map(|(_, rule)| gain(measured, rule));
            gains.collect()
        };
        self.with(triangles, gains)
    }

    /// How the relative error of a rule changes from the fewest triangles to the most.
    fn growth(&self, rule: &str) -> Option<Interval> {
        let by_seconds = judged(WEIGHTS).by_seconds;
        let gains = |level: &Level| -> BySeed {
            self.with(level.triangles, |measured| {
                measured.ratios(WEIGHTS, [rule, NONE], by_seconds)
            })
        };
        let [first, last] = [self.levels.first()?, self.levels.last()?];
        ratio_of(&gains(last), &gains(first), shared(optimisations().count()))
    }

    fn claim(&self) -> Claim {
        let growths: Vec<_> = optimisations()
            .map(|(number, rule)| (number, self.growth(rule)))
            .collect();
        let parts: Vec<_> = growths
            .iter()
            .map(|(number, growth)| {
                let crossing = crossing(&self.levels, number - 1);
                format!("optimisation {number}: {}, {crossing}", words(*growth))
            })
            .collect();
        let verdicts = growths
            .iter()
            .map(|(_, growth)| judge(*growth, Expected::Below(1.0)));
        let mut claim = claim(
            &format!("section-4-complexity-{}", self.lamp),
            "Section 4",
            &format!(
                "Room with {} light: the more triangles, the lower the error of each optimisation \
                 in equal time, relative to tracing all.",
                self.lamp
            ),
            all(verdicts),
            format!(
                "{}, relative to none, with the most triangles over that with the fewest: {}.",
                judged(WEIGHTS).name,
                parts.join("; ")
            ),
        );
        claim.tables.push(self.table());
        claim.plots.push(self.plot());
        claim
    }

    fn plot(&self) -> Plot {
        let curve = |(number, _): (usize, &str)| {
            let point = |level: &Level| (level.triangles as f64, level.gains[number - 1]);
            let points: Vec<_> = self.levels.iter().map(point).collect();
            series(format!("optimisation {number}"), &points)
        };
        lines(
            format!("Room with {} light: errors in equal time.", self.lamp),
            axis("triangles", Scale::Log),
            axis("error relative to none", Scale::Linear),
            optimisations().map(curve).collect(),
        )
    }

    fn table(&self) -> Table {
        table(
            format!(
                "Room with {} light, {WEIGHTS} weights: time for a ray, all other work included, and \
                 errors relative to none (95 % intervals).",
                self.lamp
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
            self.levels.iter().map(|level| self.row(level)).collect(),
        )
    }

    fn row(&self, level: &Level) -> Vec<Cell> {
        let Judged { by_rays, .. } = judged(WEIGHTS);
        let nanoseconds = |rule: &str| {
            let mean = |measured: &Measured<'_>| measured.mean(WEIGHTS, rule, seconds_per_ray);
            Cell::Number(1e9 * self.with(level.triangles, mean))
        };
        let relative = |rule: &str| {
            let ratio = |measured: &Measured<'_>| {
                measured.ratio(WEIGHTS, [rule, NONE], by_rays, CONFIDENCE)
            };
            cell(self.with(level.triangles, ratio))
        };
        let mut row = vec![text(level.triangles.to_string()), nanoseconds(NONE)];
        row.extend(optimisations().map(|(_, rule)| nanoseconds(rule)));
        row.extend(level.gains.iter().map(|gain| cell(*gain)));
        row.extend(optimisations().map(|(_, rule)| relative(rule)));
        row
    }
}

/// From how many triangles on an optimisation pays, in words.
fn crossing(levels: &[Level], optimisation: usize) -> String {
    let known: Vec<_> = levels
        .iter()
        .filter_map(|level| Some((level.triangles as f64, level.gains[optimisation]?.value)))
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

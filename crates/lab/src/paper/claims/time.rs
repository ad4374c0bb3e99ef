//! Section 4's remarks about computation times, and about rooms with lights of their own.

use super::super::plans::{APARTMENT, ROOMS, RULES, WEIGHTS};
use super::records::{Measured, judged, ratio_of, seconds, seconds_per_ray};
use super::{
    CONFIDENCE, Expected, NONE, all, cell, claim, judge, optimisations, shared, table, table_1,
    text, words,
};
use crate::results::{Cell, Claim, Record, Table};

/// Computation times at equal rays, for each scene of the paper; the first claim has the table of
/// errors in equal time.
pub fn times(records: &[Record]) -> Vec<Claim> {
    let mut claims: Vec<_> = ROOMS
        .iter()
        .map(|(scene, _)| increase(&Measured { records, scene }))
        .collect();
    claims[0].tables.push(equal_time(records));
    claims
}

/// "In practice the computation times did increase though."
fn increase(measured: &Measured<'_>) -> Claim {
    let ratios: Vec<_> = WEIGHTS
        .iter()
        .flat_map(|weights| {
            optimisations().map(move |(number, rule)| {
                let parts = WEIGHTS.len() * (RULES.len() - 1);
                let rules = [rule, NONE];
                let ratio = measured.ratio(weights, rules, seconds_per_ray, shared(parts));
                (format!("{weights} {number}"), ratio)
            })
        })
        .collect();
    let parts: Vec<_> = ratios
        .iter()
        .map(|(name, ratio)| format!("{name}: {}", words(*ratio)))
        .collect();
    claim(
        &format!("section-4-time-{}", measured.scene.to_lowercase()),
        "Section 4",
        &format!(
            "Scene {}: at equal total rays every optimisation takes more time.",
            measured.scene
        ),
        all(ratios
            .iter()
            .map(|(_, ratio)| judge(*ratio, Expected::Above(1.0)))),
        format!("Time for the same rays: {}.", parts.join("; ")),
    )
}

/// Errors in equal time, of all scenes.
fn equal_time(records: &[Record]) -> Table {
    let mut rows = Vec::new();
    let scenes = ROOMS.iter().map(|(name, _)| *name).chain([APARTMENT]);
    for scene in scenes {
        let measured = Measured { records, scene };
        for weights in WEIGHTS {
            let by_seconds = judged(weights).by_seconds;
            let relative = |(_, rule): (usize, &str)| {
                cell(measured.ratio(weights, [rule, NONE], by_seconds, CONFIDENCE))
            };
            let mut row = vec![
                text(scene),
                text(weights),
                Cell::Number(measured.mean(weights, NONE, seconds)),
            ];
            row.extend(optimisations().map(relative));
            rows.push(row);
        }
    }
    table(
        "RMS errors in equal time, relative to none (95 % intervals); under uniform weights without the \
         worst 0.1 % of pixels.",
        &["scene", "weights", "seconds of none", "1", "2", "3"],
        rows,
    )
}

/// "Even more so if the scene contains different rooms, each with its own lighting, because a single
/// shadow ray may then be very well representative of its whole group." One claim for each kind of
/// weights; the first has the table of the apartment.
pub fn rooms(records: &[Record]) -> Vec<Claim> {
    let mut claims: Vec<_> = WEIGHTS
        .iter()
        .map(|weights| rooms_under(records, weights))
        .collect();
    let measured = Measured {
        records,
        scene: APARTMENT,
    };
    claims[0].tables.push(table_1::whole(&measured));
    claims
}

fn rooms_under(records: &[Record], weights: &str) -> Claim {
    let rules = [RULES[3], NONE];
    let by_rays = judged(weights).by_rays;
    let gains = |scene| Measured { records, scene }.ratios(weights, rules, by_rays);
    let apartment = gains(APARTMENT);
    let ratios: Vec<_> = ROOMS
        .iter()
        .map(|(scene, _)| {
            let ratio = ratio_of(&apartment, &gains(scene), shared(ROOMS.len()));
            (*scene, ratio)
        })
        .collect();
    let own = Measured {
        records,
        scene: APARTMENT,
    };
    let own = own.ratio(weights, rules, by_rays, CONFIDENCE);
    let parts: Vec<_> = ratios
        .iter()
        .map(|(scene, ratio)| format!("over that in scene {scene}: {}", words(*ratio)))
        .collect();
    claim(
        &format!("section-4-rooms-{weights}"),
        "Section 4",
        &format!(
            "{weights} weights: where rooms have lights of their own, one ray for all (optimisation \
             3) gains more than in one room."
        ),
        all(ratios
            .iter()
            .map(|(_, ratio)| judge(*ratio, Expected::Below(1.0)))),
        format!(
            "{} of optimisation 3 in the apartment at equal rays, relative to none: {}; {}.",
            judged(weights).name,
            words(own),
            parts.join("; ")
        ),
    )
}

#[cfg(test)]
mod tests {
    use super::super::records::made;
    use super::*;
    use crate::results::Verdict::{self, NotReproduced, Reproduced, Undecided};

    #[track_caller]
    fn check_time(factor: f64, expected: Verdict) {
        let rules: Vec<_> = RULES
            .iter()
            .map(|rule| (*rule, 1.0, if *rule == NONE { 1.0 } else { factor }))
            .collect();
        let records: Vec<_> = WEIGHTS
            .iter()
            .flat_map(|weights| made::records("A", weights, &rules, 0.1))
            .collect();
        let claims = times(&records);
        assert_eq!(claims[0].verdict, expected, "{:#?}", claims[0].found);
        assert_eq!(claims[1].verdict, Undecided);
        assert_eq!(claims[0].tables[0].rows.len(), 9);
    }

    #[test]
    fn times_decide() {
        check_time(1.2, Reproduced);
        check_time(0.9, NotReproduced);
    }

    #[track_caller]
    fn check_rooms(apartment: f64, spread: f64, expected: Verdict) {
        let rules = |error| [(NONE, 1.0, 1.0), (RULES[3], error, 1.0)];
        let mut records = made::records(APARTMENT, "balance", &rules(apartment), spread);
        for (scene, _) in ROOMS {
            records.extend(made::records(scene, "balance", &rules(0.9), 0.01));
        }
        let claims = rooms(&records);
        assert_eq!(claims[1].verdict, expected, "{:#?}", claims[1].found);
        assert_eq!(claims[0].verdict, Undecided);
    }

    #[test]
    fn gains_decide() {
        check_rooms(0.7, 0.02, Reproduced);
        check_rooms(1.1, 0.02, NotReproduced);
        check_rooms(0.88, 0.5, Undecided);
    }
}

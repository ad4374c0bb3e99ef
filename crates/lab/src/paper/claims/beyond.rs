//! What the paper does not have: more than one well-chosen ray for a pair of subpaths.

use super::super::plans::{APARTMENT, BEYOND, ROOMS, RULES, WEIGHTS};
use super::records::{Judged, Measured, judged};
use super::{CONFIDENCE, Expected, NONE, claim, judge, words};
use crate::results::{Claim, Record};

/// A claim for each scene and each kind of weights.
pub fn beyond(records: &[Record]) -> Vec<Claim> {
    let scenes = ROOMS.iter().map(|(name, _)| *name).chain([APARTMENT]);
    let of_scene = |scene| WEIGHTS.map(|weights| more_rays(&Measured { records, scene }, weights));
    scenes.flat_map(of_scene).collect()
}

/// Two rays against one.
fn more_rays(measured: &Measured<'_>, weights: &str) -> Claim {
    let scene = measured.scene;
    let Judged { by_rays, name, .. } = judged(weights);
    let ratio =
        |rule: &str, other: &str| measured.ratio(weights, [rule, other], by_rays, CONFIDENCE);
    let step = ratio("budget:2", RULES[3]);
    let all: Vec<_> = BEYOND
        .iter()
        .map(|rule| format!("{rule} {}", words(ratio(rule, NONE))))
        .collect();
    claim(
        &format!("beyond-budget-{}-{weights}", scene.to_lowercase()),
        "This project",
        &format!(
            "Scene {scene}, {weights} weights: two rays for each pair of subpaths (budget:2) have a \
             lower error at equal rays than one (optimisation 3)."
        ),
        judge(step, Expected::Below(1.0)),
        format!(
            "{name} over that of optimisation 3: {}; relative to none: {}.",
            words(step),
            all.join("; ")
        ),
    )
}

#[cfg(test)]
mod tests {
    use super::super::records::made;
    use super::*;
    use crate::results::Verdict::{self, NotReproduced, Reproduced, Undecided};

    #[track_caller]
    fn check(error: f64, spread: f64, expected: Verdict) {
        let rules = [
            (NONE, 1.0, 1.0),
            (RULES[3], 0.9, 1.0),
            ("budget:2", error, 1.0),
        ];
        let claims = beyond(&made::records("A", "uniform", &rules, spread));
        assert_eq!(claims.len(), 9);
        assert_eq!(claims[0].verdict, expected, "{}", claims[0].found);
        assert_eq!(claims[1].verdict, Undecided);
    }

    #[test]
    fn errors_decide() {
        check(0.8, 0.01, Reproduced);
        check(0.95, 0.01, NotReproduced);
        check(0.88, 0.5, Undecided);
    }
}

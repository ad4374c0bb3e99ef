//! What intervals say about statements.

use crate::results::Verdict;
use crate::statistics::Interval;

/// Where a number is stated to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Expected {
    /// Below this.
    Below(f64),
    /// Above this.
    Above(f64),
    /// Between these.
    Within(f64, f64),
}

/// Whether a number is where it is stated to be. An interval that is not known, or of NaN, decides
/// nothing.
pub fn judge(interval: Option<Interval>, expected: Expected) -> Verdict {
    let Some(Interval { low, high, .. }) = interval else {
        return Verdict::Undecided;
    };
    let (least, most) = match expected {
        Expected::Below(most) => (f64::NEG_INFINITY, most),
        Expected::Above(least) => (least, f64::INFINITY),
        Expected::Within(least, most) => (least, most),
    };
    if low > least && high < most {
        Verdict::Reproduced
    } else if high < least || low > most {
        Verdict::NotReproduced
    } else {
        Verdict::Undecided
    }
}

/// The verdict on a statement that says all of these; on nothing at all there is none.
pub fn all(verdicts: impl IntoIterator<Item = Verdict>) -> Verdict {
    let verdicts: Vec<_> = verdicts.into_iter().collect();
    if verdicts.contains(&Verdict::NotReproduced) {
        Verdict::NotReproduced
    } else if verdicts.is_empty() || verdicts.contains(&Verdict::Undecided) {
        Verdict::Undecided
    } else {
        Verdict::Reproduced
    }
}

#[cfg(test)]
mod tests {
    use super::Verdict::{NotReproduced, Reproduced, Undecided};
    use super::*;

    #[track_caller]
    fn check(low: f64, high: f64, expected: Expected, verdict: Verdict) {
        let value = (low + high) / 2.0;
        let interval = Interval { value, low, high };
        assert_eq!(judge(Some(interval), expected), verdict);
    }

    #[test]
    fn intervals_inside_outside_and_across() {
        check(0.8, 0.9, Expected::Below(1.0), Reproduced);
        check(0.8, 1.1, Expected::Below(1.0), Undecided);
        check(1.1, 1.2, Expected::Below(1.0), NotReproduced);
        check(1.1, 1.2, Expected::Above(1.0), Reproduced);
        check(0.9, 1.2, Expected::Above(1.0), Undecided);
        check(0.8, 0.9, Expected::Above(1.0), NotReproduced);
        check(0.85, 0.9, Expected::Within(0.8, 0.95), Reproduced);
        check(0.75, 0.9, Expected::Within(0.8, 0.95), Undecided);
        check(0.7, 1.0, Expected::Within(0.8, 0.95), Undecided);
        check(0.6, 0.7, Expected::Within(0.8, 0.95), NotReproduced);
        check(f64::NAN, f64::NAN, Expected::Below(1.0), Undecided);
        assert_eq!(judge(None, Expected::Below(1.0)), Undecided);
    }

    #[test]
    fn one_part_that_fails_decides() {
        assert_eq!(all([Reproduced, Reproduced]), Reproduced);
        assert_eq!(all([Reproduced, Undecided]), Undecided);
        assert_eq!(all([Undecided, NotReproduced]), NotReproduced);
        assert_eq!(all([]), Undecided);
    }
}

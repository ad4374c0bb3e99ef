//! Strategies (s, t): the ways to make a path, and sets of them.

use crate::names::as_text;
use serde::{Serialize, Serializer};
use std::fmt;
use std::str::FromStr;

/// A way to make a path: `s` vertices from the light, `t` from the camera.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Strategy {
    /// Vertices of the light subpath.
    pub s: u16,
    /// Vertices of the camera subpath, the lens included.
    pub t: u16,
}

impl Strategy {
    /// Returns the strategy of `s` light and `t` camera vertices.
    #[inline]
    pub fn new(s: usize, t: usize) -> Self {
        Self {
            s: s as u16,
            t: t as u16,
        }
    }

    /// Returns the strategy of `s` light vertices for paths of the same length.
    pub(crate) fn with_light_vertices(self, s: u16) -> Self {
        Self {
            s,
            t: self.s + self.t - s,
        }
    }
}

impl fmt::Display for Strategy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "s{}t{}", self.s, self.t)
    }
}

impl Serialize for Strategy {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// A rule that adds or removes the strategies that match it; a missing number matches all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Rule {
    enable: bool,
    s: Option<u16>,
    t: Option<u16>,
}

impl Rule {
    const ALL: Self = Self {
        enable: true,
        s: None,
        t: None,
    };
}

/// A set of strategies: a list of rules, of which the last match decides.
///
/// Written as a comma-separated list: `all`, `-s0` (without s = 0), `-t1`, `s2t3` or `+s2t3` (with
/// this one). A list that begins with a removal begins with all, any other with none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Strategies {
    rules: Vec<Rule>,
    /// The answers for short subpaths, for speed: bit t of element s is the answer for (s, t).
    short: [u64; SHORT],
}

/// The number of vertices from which a subpath is not in `short`, which has a bit for each number.
const SHORT: usize = u64::BITS as usize;

impl Default for Strategies {
    fn default() -> Self {
        Self::new(vec![Rule::ALL])
    }
}

impl Strategies {
    fn new(rules: Vec<Rule>) -> Self {
        let row = |s| (0..SHORT).fold(0, |row, t| row | u64::from(decide(&rules, s, t)) << t);
        Self {
            short: std::array::from_fn(row),
            rules,
        }
    }

    /// Returns true if the last rule is `all`: every strategy takes part.
    #[inline]
    pub(crate) fn is_all(&self) -> bool {
        self.rules.last() == Some(&Rule::ALL)
    }

    /// Returns true if the list adds a strategy only for paths of more than `most` vertices.
    pub(crate) fn has_longer_than(&self, most: usize) -> bool {
        self.rules.iter().any(|rule| {
            let (s, t): (usize, usize) = (rule.s.unwrap_or(0).into(), rule.t.unwrap_or(1).into());
            rule.enable && s + t > most && t > 0 && self.contains(s, t)
        })
    }

    /// Returns true if strategy (s, t) takes part.
    #[inline]
    pub fn contains(&self, s: usize, t: usize) -> bool {
        match self.short.get(s) {
            Some(row) if t < SHORT => (row >> t) & 1 == 1,
            _ => decide(&self.rules, s, t),
        }
    }
}

/// Returns the decision of the last rule that matches (s, t); false if none does.
fn decide(rules: &[Rule], s: usize, t: usize) -> bool {
    let matches = |rule: &&Rule| {
        rule.s.is_none_or(|only| usize::from(only) == s)
            && rule.t.is_none_or(|only| usize::from(only) == t)
    };
    rules
        .iter()
        .rev()
        .find(matches)
        .is_some_and(|rule| rule.enable)
}

/// The error of a list of strategies that cannot be read.
#[derive(Clone, Debug, thiserror::Error, PartialEq, Eq)]
#[error("`{0}` is not a strategy: expected `all`, or parts like `-s0`, `-t1`, `s2t3`")]
pub struct StrategiesError(String);

impl FromStr for Strategies {
    type Err = StrategiesError;

    fn from_str(text: &str) -> Result<Self, StrategiesError> {
        let parse = |item: &str| parse_rule(item).ok_or_else(|| StrategiesError(item.to_owned()));
        let items = text.split(',').map(str::trim);
        let mut rules = items.map(parse).collect::<Result<Vec<_>, _>>()?;
        if rules.first().is_some_and(|rule| !rule.enable) {
            rules.insert(0, Rule::ALL);
        }
        Ok(Self::new(rules))
    }
}

fn parse_rule(item: &str) -> Option<Rule> {
    if item == "all" {
        return Some(Rule::ALL);
    }
    let (enable, rest) = match item.strip_prefix('-') {
        Some(rest) => (false, rest),
        None => (true, item.strip_prefix('+').unwrap_or(item)),
    };
    let (s, t) = match (rest.strip_prefix('s'), rest.strip_prefix('t')) {
        (Some(numbers), _) => match numbers.split_once('t') {
            Some((s, t)) => (Some(s.parse().ok()?), Some(t.parse().ok()?)),
            None => (Some(numbers.parse().ok()?), None),
        },
        (None, Some(t)) => (None, Some(t.parse().ok()?)),
        (None, None) => return None,
    };
    Some(Rule { enable, s, t })
}

as_text!(Strategies);

impl fmt::Display for Strategies {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, rule) in self.rules.iter().enumerate() {
            let comma = if i > 0 { "," } else { "" };
            let sign = if rule.enable { "" } else { "-" };
            write!(f, "{comma}{sign}")?;
            match (rule.s, rule.t) {
                (None, None) => write!(f, "all")?,
                (Some(s), None) => write!(f, "s{s}")?,
                (None, Some(t)) => write!(f, "t{t}")?,
                (Some(s), Some(t)) => write!(f, "s{s}t{t}")?,
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(text: &str, inside: &[(usize, usize)], outside: &[(usize, usize)]) {
        let strategies: Strategies = text.parse().unwrap();
        let contains = |&(s, t): &(usize, usize)| strategies.contains(s, t);
        assert!(inside.iter().all(contains), "{text}");
        assert!(!outside.iter().any(contains), "{text}");
        assert_eq!(strategies.to_string().parse(), Ok(strategies));
    }

    #[test]
    fn lists_are_read_from_left_to_right() {
        check("all", &[(0, 2), (1, 1), (7, 9)], &[]);
        check("all,-s0,-t1", &[(1, 2), (3, 3)], &[(0, 2), (2, 1)]);
        check("s2t3", &[(2, 3)], &[(2, 2), (0, 5)]);
        check("all,-s1,+s1t4", &[(1, 4), (2, 2)], &[(1, 3)]);
        check("-s0", &[(1, 2), (2, 1)], &[(0, 2)]);
        check("t1", &[(1, 1), (5, 1)], &[(1, 2)]);
        let inside = [(63, 63), (63, 64), (70, 70)];
        check("s63,s70t70", &inside, &[(62, 63), (64, 63), (70, 6)]);
    }

    #[test]
    fn what_is_no_strategy_is_named() {
        for text in ["", "some", "s", "all,-x3", "s1t", "s-1"] {
            assert!(text.parse::<Strategies>().is_err(), "{text}");
        }
    }
}

//! A setting that may be left to the integrator.

use crate::integrator::IntegratorKind;
use std::fmt::{self, Display};
use std::str::FromStr;

/// A value, or what suits the integrator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice<T> {
    /// The integrator's own choice, written `auto` or `suited`.
    Automatic,
    /// This one.
    Fixed(T),
}

/// A text is neither a value nor `auto`.
#[derive(Clone, Debug, thiserror::Error, PartialEq, Eq)]
#[error("{0}, or `auto`")]
pub struct ChoiceError<E: Display>(E);

impl<T> Choice<T> {
    /// Makes a choice: this value, or none where it is open.
    pub(super) fn new(is_open: bool, value: T) -> Self {
        if is_open {
            Self::Automatic
        } else {
            Self::Fixed(value)
        }
    }

    /// Returns the value, or the `integrator`'s own, and whether that is still to choose.
    pub(super) fn decide(self, own: T, integrator: IntegratorKind) -> (T, bool) {
        match self {
            Self::Automatic => (own, integrator == IntegratorKind::Auto),
            Self::Fixed(value) => (value, false),
        }
    }
}

impl<T: FromStr<Err: Display>> FromStr for Choice<T> {
    type Err = ChoiceError<T::Err>;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "auto" | "suited" => Ok(Self::Automatic),
            text => text.parse().map(Self::Fixed).map_err(ChoiceError),
        }
    }
}

impl<T: Display> Display for Choice<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Automatic => f.write_str("auto"),
            Self::Fixed(value) => value.fmt(f),
        }
    }
}

crate::names::as_text!(Choice<T>);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_and_the_integrators_own_are_read_and_written() {
        for (text, choice) in [("auto", Choice::Automatic), ("3", Choice::Fixed(3))] {
            assert_eq!(text.parse(), Ok(choice));
            assert_eq!(choice.to_string(), text);
        }
        assert_eq!("suited".parse::<Choice<u8>>(), Ok(Choice::Automatic));
        let error = "x".parse::<Choice<u8>>().unwrap_err().to_string();
        assert_eq!(error, "invalid digit found in string, or `auto`");
    }
}

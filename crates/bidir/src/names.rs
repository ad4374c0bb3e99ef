//! Values with names: on the command line, in files and in Python.

use std::fmt::Display;
use std::str::FromStr;

/// The error of a name that no value has.
#[derive(Clone, Debug, thiserror::Error, PartialEq, Eq)]
#[error("unknown name `{given}`: {hint}")]
pub struct UnknownName {
    given: String,
    hint: String,
}

impl UnknownName {
    /// Makes the error of the name `given`; `known` are the names that exist.
    pub fn new(given: &str, known: &[&str]) -> Self {
        let hint = nearest(given, known.iter().copied()).map_or_else(
            || format!("expected {}", known.join(", ")),
            |near| format!("did you mean `{near}`?"),
        );
        Self {
            given: given.escape_debug().to_string(),
            hint,
        }
    }
}

/// The most letters of a name that is compared with others.
const LONGEST_NAME: usize = 100;

/// Returns the name that `name` was probably meant to be. None: nothing is near.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    // At most a third of the letters may be wrong, so that two words of three letters do not match.
    let letters = name.chars().count();
    let allowed = letters.div_ceil(3).min(4);
    // A comparison takes time in proportion to the product of the lengths.
    let is_comparable = |known: &&str| {
        letters <= LONGEST_NAME && known.chars().count().abs_diff(letters) <= allowed
    };
    known
        .into_iter()
        .filter(is_comparable)
        .map(|known| (distance(name, known), known))
        .filter(|&(distance, _)| distance <= allowed)
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, known)| known)
}

fn distance(a: &str, b: &str) -> usize {
    strsim::osa_distance(&a.to_ascii_lowercase(), &b.to_ascii_lowercase())
}

/// Defines a name for every variant of an enum without fields, by which it is read and written.
macro_rules! named {
    ($kind:ident { $($name:literal => $variant:ident),+ $(,)? }) => {
        impl $kind {
            /// Every variant with its name.
            pub const NAMES: [(&'static str, Self); [$($name),+].len()] =
                [$(($name, Self::$variant)),+];

            /// Returns the name.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name),+
                }
            }
        }

        impl std::fmt::Display for $kind {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.pad(self.name())
            }
        }

        impl std::str::FromStr for $kind {
            type Err = $crate::names::UnknownName;

            fn from_str(text: &str) -> Result<Self, Self::Err> {
                let mut names = Self::NAMES.iter();
                let found = names.find(|(name, _)| *name == text);
                let unknown = || $crate::names::UnknownName::new(text, &[$($name),+]);
                found.map(|(_, kind)| *kind).ok_or_else(unknown)
            }
        }

        #[cfg(feature = "clap")]
        impl clap::ValueEnum for $kind {
            fn value_variants<'a>() -> &'a [Self] {
                &[$(Self::$variant),+]
            }

            fn to_possible_value(&self) -> Option<clap::builder::PossibleValue> {
                Some(self.name().into())
            }
        }

        $crate::names::as_text!($kind);
    };
}
pub(crate) use named;

/// Implements serde for values as their text. Whole numbers are read, too.
macro_rules! as_text {
    ($kind:ident $(<$inner:ident>)?) => {
        impl $(<$inner: std::fmt::Display>)? serde::Serialize for $kind $(<$inner>)? {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.collect_str(self)
            }
        }

        impl<'de $(, $inner: std::str::FromStr<Err: std::fmt::Display>)?> serde::Deserialize<'de>
            for $kind $(<$inner>)?
        {
            fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
                from.deserialize_any($crate::names::Parse::default())
            }
        }
    };
}
pub(crate) use as_text;

/// Reads a value from its text, or from a whole number.
#[derive(Debug)]
pub(crate) struct Parse<T>(std::marker::PhantomData<T>);

impl<T> Default for Parse<T> {
    fn default() -> Self {
        Self(std::marker::PhantomData)
    }
}

impl<T: FromStr<Err: Display>> serde::de::Visitor<'_> for Parse<T> {
    type Value = T;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "a text or a whole number")
    }

    fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<T, E> {
        text.parse().map_err(E::custom)
    }

    fn visit_u64<E: serde::de::Error>(self, number: u64) -> Result<T, E> {
        self.visit_str(&number.to_string())
    }

    fn visit_i64<E: serde::de::Error>(self, number: i64) -> Result<T, E> {
        self.visit_str(&number.to_string())
    }
}

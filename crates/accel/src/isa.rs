//! Which vector instructions the traversal uses.

use std::fmt;
use std::str::FromStr;

/// A set of vector instructions.
///
/// The choice changes speed, never an answer.
/// Wider sets (AVX2, AVX-512) are to join; the data is laid out for them already.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Isa {
    /// Portable code without intrinsics.
    Scalar,
    /// 128-bit vectors, which every x86-64 machine has.
    Sse2,
}

impl Isa {
    /// All sets that have a name, slowest first.
    pub const ALL: [Self; 2] = [Self::Scalar, Self::Sse2];

    /// The fastest set of this machine.
    pub fn detect() -> Self {
        if Self::Sse2.is_supported() {
            Self::Sse2
        } else {
            Self::Scalar
        }
    }

    /// Whether this machine has the instructions.
    pub const fn is_supported(self) -> bool {
        match self {
            Self::Scalar => true,
            Self::Sse2 => cfg!(target_arch = "x86_64"),
        }
    }

    /// The name in settings and reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Scalar => "scalar",
            Self::Sse2 => "sse2",
        }
    }
}

impl fmt::Display for Isa {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// The error for a name that no [`Isa`] has.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnknownIsa {
    /// The name as it was given.
    pub name: String,
}

impl fmt::Display for UnknownIsa {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = Isa::ALL.map(Isa::name).join(", ");
        write!(
            f,
            "unknown instruction set `{}`; known are: {names}",
            self.name
        )
    }
}

impl std::error::Error for UnknownIsa {}

impl FromStr for Isa {
    type Err = UnknownIsa;

    fn from_str(name: &str) -> Result<Self, UnknownIsa> {
        let known = Self::ALL.into_iter().find(|isa| isa.name() == name);
        known.ok_or_else(|| UnknownIsa {
            name: name.to_owned(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_round_trip() {
        for isa in Isa::ALL {
            assert_eq!(isa.to_string().parse(), Ok(isa));
        }
    }

    #[test]
    fn unknown_name_lists_the_known_ones() {
        let error = "neon".parse::<Isa>().unwrap_err();
        assert_eq!(
            error.to_string(),
            "unknown instruction set `neon`; known are: scalar, sse2"
        );
    }

    #[test]
    fn detected_is_supported() {
        assert!(Isa::detect().is_supported());
    }
}

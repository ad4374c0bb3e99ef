//! The vector instructions of the traversal.

use std::fmt;
use std::str::FromStr;

use crate::simd::{self, Kernel, Simd};

/// A set of vector instructions.
///
/// The choice affects the speed, never a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Isa {
    /// Portable code without intrinsics.
    Scalar,
    /// 128-bit vectors, which every x86-64 machine has.
    Sse2,
    /// 256-bit vectors, with FMA and bit manipulation: most machines since 2013.
    Avx2,
    /// AVX-512 (F, VL, DQ, BW) on 256-bit vectors, for its masks and compress instructions.
    Avx512,
}

impl Isa {
    /// All sets, from the narrowest to the newest.
    pub const ALL: [Self; 4] = [Self::Scalar, Self::Sse2, Self::Avx2, Self::Avx512];

    /// Returns the sets of this machine, from the narrowest to the newest.
    pub fn supported() -> impl DoubleEndedIterator<Item = Self> {
        Self::ALL.into_iter().filter(|isa| isa.is_supported())
    }

    /// Returns the default set: the fastest, except for AVX-512, which gains nothing over AVX2 in most scenes
    /// (docs/performance.md).
    pub fn detect() -> Self {
        let mut by_speed = [Self::Avx2, Self::Sse2].into_iter();
        by_speed
            .find(|isa| isa.is_supported())
            .unwrap_or(Self::Scalar)
    }

    /// Returns true if this machine has the instructions.
    #[cfg(target_arch = "x86_64")]
    pub fn is_supported(self) -> bool {
        macro_rules! has {
            ($($feature:tt),*) => { $(is_x86_feature_detected!($feature))&&* };
        }
        match self {
            Self::Scalar | Self::Sse2 => true,
            Self::Avx2 => has!("avx2", "fma", "bmi1", "bmi2", "lzcnt", "popcnt"),
            Self::Avx512 => {
                Self::Avx2.is_supported() && has!("avx512f", "avx512vl", "avx512dq", "avx512bw")
            }
        }
    }

    /// Returns true if this machine has the instructions.
    #[cfg(not(target_arch = "x86_64"))]
    pub fn is_supported(self) -> bool {
        self == Self::Scalar
    }

    /// Runs a kernel compiled for this set, which must be [supported](Self::is_supported).
    #[inline(always)]
    pub(crate) fn call<K: Kernel>(self, kernel: K) -> K::Output {
        debug_assert!(self.is_supported(), "{self}");
        // SAFETY: the set is known to be supported: `Bvh` checks it when it is built or changes its set, and tests
        // use only supported sets.
        unsafe {
            match self {
                #[cfg(target_arch = "x86_64")]
                Self::Sse2 => simd::Sse2::call(kernel),
                #[cfg(target_arch = "x86_64")]
                Self::Avx2 => simd::Avx2::call(kernel),
                #[cfg(target_arch = "x86_64")]
                Self::Avx512 => simd::Avx512::call(kernel),
                _ => simd::Portable::call(kernel),
            }
        }
    }

    /// Returns the name in settings and reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Scalar => "scalar",
            Self::Sse2 => "sse2",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
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
            "unknown instruction set `neon`; known are: scalar, sse2, avx2, avx512"
        );
    }

    #[test]
    fn detected_is_supported() {
        assert!(Isa::detect().is_supported());
    }
}

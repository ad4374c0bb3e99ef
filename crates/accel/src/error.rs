//! The errors of building a tree.

use std::fmt;

use crate::isa::Isa;

/// The reasons why a [`Bvh`](crate::Bvh) could not be built.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum BuildError {
    /// A coordinate or parameter of a primitive is NaN or infinite, or so large that its bounds are,
    /// or its map has no inverse.
    NotFinite {
        /// The first such primitive.
        primitive: usize,
    },
    /// There are more primitives and instances than the tree can count.
    TooManyPrimitives {
        /// How many there are.
        count: usize,
        /// How many there may be.
        limit: usize,
    },
    /// An instance has no place: its object does not exist, or has instances itself, or its map has
    /// no inverse (or nearly none), or its bounds are not finite.
    BadInstance {
        /// The first such instance.
        instance: usize,
        /// The error of that instance.
        reason: InstanceError,
    },
    /// This machine lacks the instructions.
    UnsupportedIsa {
        /// The instructions asked for.
        isa: Isa,
    },
}

/// The error of an [`Instance`](crate::Instance).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InstanceError {
    /// There is no object of this number.
    NoObject,
    /// The object has instances itself.
    Nested,
    /// The map has no inverse, or is so close to having none that rounding exceeds the instance.
    NotInvertible,
}

impl fmt::Display for InstanceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NoObject => "refers to an object that does not exist",
            Self::Nested => "is of an object that has instances itself",
            Self::NotInvertible => {
                "has a transformation without inverse, or nearly so, or reaches too far"
            }
        })
    }
}

impl fmt::Display for BuildError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite { primitive } => {
                write!(f, "primitive {primitive} has no finite bounds")
            }
            Self::TooManyPrimitives { count, limit } => {
                write!(f, "{count} primitives are more than the limit of {limit}")
            }
            Self::BadInstance { instance, reason } => write!(f, "instance {instance} {reason}"),
            Self::UnsupportedIsa { isa } => write!(f, "this machine does not support {isa}"),
        }
    }
}

impl std::error::Error for BuildError {}

//! The choices that next-event estimation, s = 1, makes: of the light, and of the point on it.

use crate::names::named;

/// The light point of next-event estimation (s = 1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightPointChoice {
    /// Each camera vertex draws its own.
    #[default]
    Fresh,
    /// All use the start of the light subpath, as in \[Lafortune93\].
    Shared,
}

named!(LightPointChoice {
    "fresh" => Fresh,
    "shared" => Shared,
});

impl LightPointChoice {
    /// Returns the fewest light vertices of connections that use a light subpath.
    #[inline]
    pub fn min_subpath_s(self) -> usize {
        match self {
            Self::Fresh => 2,
            Self::Shared => 1,
        }
    }
}

/// The choice of the light in next-event estimation (s = 1) with a point of its own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightChoiceKind {
    /// By power, as light subpaths do.
    Power,
    /// By a tree that knows the receiver \[Conty18\].
    #[default]
    Tree,
}

named!(LightChoiceKind {
    "power" => Power,
    "tree" => Tree,
});

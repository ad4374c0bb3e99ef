//! Estimators: how samples are computed.
//!
//! A [`Batch`] holds the samples in flight; a [`Method`] is the list of stages that fill its arrays, one
//! after the other. Neither knows a film: the driver takes what a batch holds at the end. The size of a
//! batch changes no bit.
//!
//! **Adding one**: a variant of [`Method`] and of [`IntegratorKind`], and the stages that are missing.

mod batch;
mod cache;
mod curve;
mod inspect;
mod journal;
mod list;
mod lvc;
mod method;
mod stages;

pub use batch::{Batch, Candidates, Sample, Walks, Worker};
pub(crate) use cache::connectable;
pub(crate) use journal::splats;
pub use journal::{Entry, Fate, Link};
pub use list::{List, Lists};
pub use lvc::*;
pub(crate) use method::group_size;
pub use method::{Method, end_group, walk_group};
pub(crate) use stages::camera_ray;

use crate::names::named;

/// The estimators by name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum IntegratorKind {
    /// Path tracing: next-event estimation and hits of lights, combined.
    Path,
    /// Light tracing: every vertex of a light subpath is connected to the lens.
    Light,
    /// Bidirectional path tracing with every strategy.
    #[default]
    Bdpt,
    /// Bidirectional path tracing that connects with light subpaths of many samples.
    Lvc,
    /// [`Path`](Self::Path), [`Bdpt`](Self::Bdpt) or [`Lvc`](Self::Lvc), by what a short render before the
    /// first pass finds.
    Auto,
}

named!(IntegratorKind {
    "path" => Path,
    "light" => Light,
    "bdpt" => Bdpt,
    "lvc" => Lvc,
    "auto" => Auto,
});

impl IntegratorKind {
    /// Returns true where the estimator has connections to choose from.
    pub fn has_candidates(self) -> bool {
        match self {
            Self::Bdpt | Self::Lvc | Self::Auto => true,
            Self::Path | Self::Light => false,
        }
    }
}

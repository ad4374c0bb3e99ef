//! Estimators: how one sample is computed.
//!
//! An [`Integrator`] makes the contributions of one camera sample and of the light subpath that
//! goes with it. It knows no film: contributions go into the [`Workspace`], from where the driver
//! takes them.
//!
//! **Adding one**: a file, and a variant of [`IntegratorKind`] with its name.

mod bdpt;
mod blind;
mod journal;
mod light;
mod lvc;
mod pairs;
mod path;
mod workspace;

pub use bdpt::Bdpt;
pub(crate) use blind::no_path;
pub use blind::{BlindSpot, LostLight, blind_spots, lost_light, missing_light};
pub use journal::{Entry, Fate, Journal, Link};
pub use light::LightTracer;
pub use lvc::Lvc;
pub use lvc::settings::*;
pub(crate) use lvc::{connectable, group_size};
pub use path::PathTracer;
pub(crate) use workspace::{BroughtLight, camera_ray};
pub use workspace::{Sample, Splat, Workspace};

use crate::names::named;
use crate::path::{Connections, PathContext};
use crate::select::Selector;

/// An estimator of the image. Its expectation is the sum over all paths within the limit of length
/// that its strategies can make.
pub trait Integrator: Sync + Send {
    /// Adds the contributions of one sample to the workspace, which is cleared first.
    fn sample(&self, context: &PathContext<'_>, sample: &Sample, workspace: &mut Workspace);

    /// The step before the samples of a group, if they share light subpaths. None: each has its
    /// own.
    fn shared_light(&self) -> Option<&dyn SharedLight> {
        None
    }
}

/// The light subpaths that the samples of a group share, each brought by one of them; they are in the
/// workspace.
pub trait SharedLight {
    /// Forgets those of another group.
    fn begin(&self, workspace: &mut Workspace);

    /// Walks the light subpath that `sample` brings to its group, and adds its light image.
    fn walk(&self, context: &PathContext<'_>, sample: &Sample, workspace: &mut Workspace);

    /// Makes ready what the samples share, when all of it is walked.
    fn end(&self, connections: Connections<'_>, workspace: &mut Workspace);
}

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
    /// True where the estimator has connections to choose from.
    pub fn has_candidates(self) -> bool {
        match self {
            Self::Bdpt | Self::Lvc | Self::Auto => true,
            Self::Path | Self::Light => false,
        }
    }

    /// The estimator; `selector` chooses the shadow rays of those that have candidates, and `lvc` is for
    /// those that share light subpaths.
    pub fn integrator(self, selector: Box<dyn Selector>, lvc: &LvcSettings) -> Box<dyn Integrator> {
        match self {
            Self::Path => Box::new(PathTracer),
            Self::Light => Box::new(LightTracer),
            Self::Bdpt => Box::new(Bdpt { selector }),
            // `Auto` is decided before this; `Lvc` is its most frequent plan.
            Self::Lvc | Self::Auto => Box::new(Lvc {
                selector,
                candidates: lvc.candidates,
                next_events: lvc.next_events,
            }),
        }
    }
}

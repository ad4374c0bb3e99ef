//! Paths: vertices, the walks that make them, their connections, and their weights.
//!
//! A path is x_0 … x_{n-1}, counted from the light; strategy (s, t) makes it from `s` vertices of a
//! light subpath and `t` of a camera subpath, `s + t = n`:
//!
//! ```text
//!     x_0 ── x_1 ── … ── x_{s-1}  ┄┄┄┄  x_s ── … ── x_{n-1}
//!     light subpath, walked →     link     ← walked, camera subpath
//! ```
//!
//! The last vertices of the two subpaths are z = x_{s-1} and y = x_s (in \[Veach97\] the letters are the other way round).
//!
//! - Densities are **area densities**, 1/m², but for vertices in media, 1/m³, and x_0 on a light at infinity: solid
//!   angle, 1/sr.
//! - `beta` of a vertex is the throughput up to it, without the scattering at it, divided by the
//!   density of drawing it.
//! - s = 0: the camera subpath hits a light. s = 1: next-event estimation, with a light point of
//!   its own for each camera vertex. t = 1: the light image, with a lens point of its own for each
//!   light vertex. Everything else is a connection.
//! - Path length is limited by the number of vertices n, the same for all strategies.
//!
//! Nothing here adds to a film, and no ray is traced but those of the walks.

mod connect;
mod densities;
mod diffuse;
mod hit;
mod light_choice;
mod mis;
mod roulette;
mod running;
mod scatter;
mod segment;
mod shares;
mod strategy_class;
mod subpaths;
mod vertex;
mod visible;
mod walk;

pub use crate::strategy::{Strategies, Strategy};
pub use connect::{JoinedPath, next_event_pdf, sample_next_event};
pub use densities::{PathDensities, VertexDensities};
pub use diffuse::{DiffuseConnections, DiffuseEnd};
pub use hit::{Arrival, HitPath};
pub use light_choice::{LightChoiceKind, LightPointChoice};
pub use mis::{MisHeuristic, mis_weight};
pub use roulette::PathRoulette;
pub use running::{EndSums, PathSums, RunningSums, Weights};
pub use scatter::ScatteringEvent;
pub use segment::Segment;
pub(crate) use shares::{ConnectionPart, Shares};
pub(crate) use strategy_class::Bounce;
pub use strategy_class::SampleCounts;
pub use subpaths::{Escape, Subpath, Subpaths};
pub use vertex::{Scattering, Vertex};
pub use walk::{camera_subpath, light_subpath};

use crate::guide::Guide;
use crate::medium::MediumId;
use crate::scene::Scene;
use crate::spectrum::Lanes;
use crate::view::View;
use accel::Stop;

/// The most vertices of any path, whatever the limits: a walk between perfect mirrors would not
/// end.
pub const MAX_VERTICES: usize = 1024;

/// How paths are made and weighted.
#[derive(Clone, Debug)]
pub struct PathSettings {
    /// The most scattering events; None: no limit but [`MAX_VERTICES`].
    pub max_depth: Option<u32>,
    /// How walks end at random.
    pub roulette: PathRoulette,
    /// Which strategies take part.
    pub strategies: Strategies,
    /// The source of the light point of s = 1.
    pub light_point: LightPointChoice,
    /// How s = 1 chooses the light.
    pub light_choice: LightChoiceKind,
    /// How strategies are combined.
    pub mis: MisHeuristic,
}

impl Default for PathSettings {
    fn default() -> Self {
        Self {
            max_depth: Some(5),
            roulette: PathRoulette::default(),
            strategies: Strategies::default(),
            light_point: LightPointChoice::default(),
            light_choice: LightChoiceKind::default(),
            mis: MisHeuristic::default(),
        }
    }
}

impl PathSettings {
    /// Returns the most vertices of a path, both ends included.
    #[inline]
    pub fn max_vertices(&self) -> usize {
        self.max_depth
            .map_or(MAX_VERTICES, |depth| (depth as usize).saturating_add(2))
            .min(MAX_VERTICES)
    }
}

/// The data that all samples of a group share. Only samples of one group are joined.
#[derive(Clone, Copy)]
pub struct Job<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The camera that sees it, and its film.
    pub view: &'a View,
    /// The meaning of the lanes of light.
    pub lanes: Lanes,
    /// How paths are made and weighted.
    pub settings: &'a PathSettings,
    /// How many samples strategies take.
    pub counts: SampleCounts,
    /// The knowledge of training.
    pub guide: Guide<'a>,
    /// The medium around the camera.
    pub medium: MediumId,
    /// Asks to leave the samples: their rays then end anywhere, and what they found is worth nothing.
    pub stop: Stop<'a>,
}

impl<'a> Job<'a> {
    /// An RGB job in which every sample has a light subpath of its own, and nothing is learned.
    pub fn of_own_subpaths(scene: &'a Scene, view: &'a View, settings: &'a PathSettings) -> Self {
        Self {
            scene,
            view,
            lanes: Lanes::Rgb,
            settings,
            counts: SampleCounts::of_own_subpaths(view.film()),
            guide: Guide::default(),
            medium: camera_medium(scene, view),
            stop: Stop::NEVER,
        }
    }
}

/// Returns the medium around the camera. One of parallel rays has that of its middle all over.
pub fn camera_medium(scene: &Scene, view: &View) -> MediumId {
    if scene.has_media() {
        scene.medium_at(view.camera().pose().origin)
    } else {
        MediumId::VACUUM
    }
}

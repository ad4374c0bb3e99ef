//! The status of a render for clients, as JSON.

use bidir::film::FilmSettings;
use bidir::integrator::IntegratorKind;
use bidir::select::ShadowRays;
use formats::film::scene_name;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// One of the renders that are shown side by side.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LaneId {
    /// The first, which is always there.
    #[default]
    A,
    /// The second, beside it.
    B,
}

impl LaneId {
    /// Both lanes.
    pub const ALL: [Self; 2] = [Self::A, Self::B];

    /// Returns the index of the lane: 0 or 1.
    pub fn index(self) -> usize {
        match self {
            Self::A => 0,
            Self::B => 1,
        }
    }
}

/// The activity of a render.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum State {
    /// Training, or building, before the first pass.
    #[default]
    Preparing,
    /// Rendering passes.
    Rendering,
    /// Waiting for a command to resume.
    Paused,
    /// All passes are done, or the render was stopped.
    Done,
    /// The render cannot begin.
    Failed,
}

/// The film's geometry. Unit: pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct FilmStatus {
    /// Width and height of the whole film.
    pub resolution: [u32; 2],
    /// Left, top, right and bottom of the rendered part, the last two exclusive.
    pub crop: [u32; 4],
}

impl From<&FilmSettings> for FilmStatus {
    fn from(film: &FilmSettings) -> Self {
        let ([left, top], [right, bottom]) = (film.crop.min, film.crop.max);
        Self {
            resolution: film.resolution,
            crop: [left, top, right, bottom],
        }
    }
}

impl Status {
    /// Returns the status of a render before it begins: of the scene file `name` on `film`, without commands.
    pub fn preparing(name: &str, film: &FilmSettings) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION"),
            scene: scene_name(name),
            film: film.into(),
            ..Self::default()
        }
    }

    /// Returns the status of an interactive render that has not begun.
    pub fn interactive(name: &str, film: &FilmSettings) -> Self {
        Self {
            controls: true,
            choices: Choices::all(),
            ..Self::preparing(name, film)
        }
    }
}

/// The names that commands accept.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Choices {
    /// Estimators.
    pub integrators: Vec<&'static str>,
    /// Selections of shadow rays. Where a name contains a number, commands accept other numbers, too.
    pub shadow_rays: Vec<String>,
}

impl Choices {
    /// Returns all names.
    fn all() -> Self {
        let names = IntegratorKind::NAMES.iter();
        let rays = [
            ShadowRays::All,
            ShadowRays::PerLightVertex,
            ShadowRays::PerCameraVertex,
            ShadowRays::PerPair,
            ShadowRays::Budget(2),
            IntegratorKind::Lvc.shadow_rays(),
            ShadowRays::RayRoulette(ShadowRays::DEFAULT_ROULETTE),
        ];
        Self {
            integrators: names.map(|(name, _)| *name).collect(),
            shadow_rays: rays.iter().map(ToString::to_string).collect(),
        }
    }
}

/// The position of the camera. Space: world.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CameraStatus {
    /// The kind of camera, in one word.
    pub kind: &'static str,
    /// The position.
    pub origin: [f32; 3],
    /// The point that the camera moves around.
    pub target: [f32; 3],
    /// The upward direction of the picture.
    pub up: [f32; 3],
    /// True if the view is not the scene's own.
    pub moved: bool,
}

/// Rays by kind, per second or per camera sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct RayRates {
    /// Rays of camera walks.
    pub camera: f64,
    /// Rays of light walks.
    pub light: f64,
    /// Shadow rays that join s ≥ 1 with t ≥ 2.
    pub connection: f64,
    /// Shadow rays of the light image, t = 1.
    pub light_image: f64,
}

/// The progress of a lane.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct LaneStatus {
    /// The lane.
    pub lane: LaneId,
    /// A number that grows whenever the lane begins anew.
    pub generation: u32,
    /// All settings, by the names of flags.
    pub settings: BTreeMap<String, String>,
    /// The requested estimator. A preview may use another, which `settings` has.
    pub integrator: String,
    /// The requested selection of shadow rays. A preview may use another, which `settings` has.
    pub shadow_rays: String,
    /// The number of finished passes.
    pub passes: u64,
    /// The number of passes. None: there is no end.
    pub target: Option<u64>,
    /// The time of the passes, without the time of developing frames. Unit: seconds.
    pub seconds: f64,
    /// The expected time of the remaining passes. Unit: seconds. None: it is not known.
    pub eta: Option<f64>,
    /// Camera samples per second.
    pub samples_per_second: f64,
    /// Rays per second.
    pub rays_per_second: RayRates,
    /// Rays per camera sample.
    pub rays_per_sample: RayRates,
    /// The relative error of the last frame. None: it is not known.
    pub relative_error: Option<f64>,
    /// The relative error over time: pairs of seconds and error.
    pub curve: Vec<[f64; 2]>,
    /// Maximum number of vertices of paths whose strategies have images.
    pub strategy_vertices: usize,
    /// True if the lane has the low resolution of a moving camera.
    pub preview: bool,
}

/// The status of a render.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Status {
    /// The version of the program.
    pub version: &'static str,
    /// The name of the scene, without folders.
    pub scene: String,
    /// The activity of the render.
    pub state: State,
    /// The result or refusal of the last command, or the failure of the render.
    pub message: Option<String>,
    /// True if the render accepts commands.
    pub controls: bool,
    /// The film at full resolution.
    pub film: FilmStatus,
    /// The names that commands accept.
    pub choices: Choices,
    /// The camera. None: it cannot be moved.
    pub camera: Option<CameraStatus>,
    /// True if there are two lanes.
    pub split: bool,
    /// The lanes.
    pub lanes: Vec<LaneStatus>,
}

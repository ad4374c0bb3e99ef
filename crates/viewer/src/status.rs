//! The status of a render for clients, as JSON.

use bidir::film::FilmSettings;
use bidir::integrator::IntegratorKind;
use bidir::select::ShadowRays;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// A render among those that are shown side by side.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LaneId {
    /// The first, which is always there.
    #[default]
    A,
    /// The one beside it.
    B,
}

impl LaneId {
    /// Both.
    pub const ALL: [Self; 2] = [Self::A, Self::B];

    /// Returns its number.
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
    /// Passes are rendered.
    Rendering,
    /// It goes on when a command resumes it.
    Paused,
    /// All passes are done, or it was stopped.
    Done,
    /// It cannot begin.
    Failed,
}

/// The film's geometry. Unit: pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct FilmStatus {
    /// Width and height of the whole film.
    pub resolution: [u32; 2],
    /// Left, top, right and bottom (exclusive) of what is rendered.
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
    /// Returns the status of a render that has not begun, of the scene file `name` on `film`, and that takes no
    /// commands.
    pub fn preparing(name: &str, film: &FilmSettings) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION"),
            scene: scene_name(name),
            film: film.into(),
            ..Self::default()
        }
    }

    /// The same of a render that takes commands.
    pub fn interactive(name: &str, film: &FilmSettings) -> Self {
        Self {
            controls: true,
            choices: Choices::all(),
            ..Self::preparing(name, film)
        }
    }
}

/// Returns the name of a scene file without its folders.
pub(crate) fn scene_name(name: &str) -> String {
    let file = Path::new(name).file_name();
    file.map_or_else(
        || name.to_owned(),
        |file| file.to_string_lossy().into_owned(),
    )
}

/// The names that commands accept.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Choices {
    /// Estimators.
    pub integrators: Vec<&'static str>,
    /// Selections of shadow rays; those with a number take others, too.
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

/// The place of the camera. Space: world.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CameraStatus {
    /// Its kind in one word.
    pub kind: &'static str,
    /// Its position.
    pub origin: [f32; 3],
    /// The point it moves around.
    pub target: [f32; 3],
    /// The picture's up.
    pub up: [f32; 3],
    /// True where it is not the scene's own.
    pub moved: bool,
}

/// Numbers of rays by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct RayRates {
    /// Of camera walks.
    pub camera: f64,
    /// Of light walks.
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
    /// Grows whenever the lane begins anew.
    pub generation: u32,
    /// All settings, by the names of flags.
    pub settings: BTreeMap<String, String>,
    /// The requested estimator; a preview may take another, as its settings say.
    pub integrator: String,
    /// The requested selection of shadow rays, likewise.
    pub shadow_rays: String,
    /// The passes that are done.
    pub passes: u64,
    /// The number of passes. None: there is no end.
    pub target: Option<u64>,
    /// The time of the passes, without that of frames.
    pub seconds: f64,
    /// The expected time of the other passes. Unit: seconds.
    pub eta: Option<f64>,
    /// Camera samples per second.
    pub samples_per_second: f64,
    /// Rays per second.
    pub rays_per_second: RayRates,
    /// Rays per camera sample.
    pub rays_per_sample: RayRates,
    /// The noise of the last frame. None: it is not known.
    pub relative_error: Option<f64>,
    /// The same over the seconds.
    pub curve: Vec<[f64; 2]>,
    /// The most vertices of paths whose strategies have images.
    pub strategy_vertices: usize,
    /// True for the low resolution of a moving camera.
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
    /// True where commands are accepted.
    pub controls: bool,
    /// The film in full.
    pub film: FilmStatus,
    /// The names that commands accept.
    pub choices: Choices,
    /// None: it cannot be moved.
    pub camera: Option<CameraStatus>,
    /// True where there are two lanes.
    pub split: bool,
    /// The lanes.
    pub lanes: Vec<LaneStatus>,
}

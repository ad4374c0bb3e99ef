//! A lane as watchers see it: its frames, as often as they cost next to nothing, and its numbers.

use crate::board::{Board, Shown};
use crate::frame::Frame;
use crate::status::{LaneId, LaneStatus, RayRates};
use bidir::driver::{Session, Settings};
use bidir::film::Aov;
use bidir::settings::Request;
use bidir::stats::RayCounts;
use formats::film::SettingsText;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Frames are at least this far apart: nobody sees more.
const SHORTEST_GAP: Duration = Duration::from_millis(125);
/// As long as a lane is younger, nothing else keeps frames apart.
const YOUTH: Duration = Duration::from_secs(3);
/// Later, a frame is developed when this many times as long was rendered as the last one took.
const RENDERING_PER_FRAME: u32 = 40;
/// Points of the error curve; where there would be more, every other one is left out.
const CURVE_POINTS: usize = 256;

/// A lane as it is shown.
#[derive(Debug)]
pub struct Exhibit {
    lane: LaneId,
    course: Course,
    /// The estimator and the selection of shadow rays, as they were asked for.
    method: [String; 2],
    /// The time of all passes.
    rendered: Duration,
    last: Option<Last>,
    curve: Vec<[f64; 2]>,
}

/// The last frame that was developed.
#[derive(Clone, Copy, Debug)]
struct Last {
    at: Instant,
    passes: u64,
    /// The time that developing took.
    cost: Duration,
    /// What was rendered by then.
    rendered: Duration,
    relative_error: f64,
}

/// How much there is to a lane beside its session.
#[derive(Clone, Copy, Debug, Default)]
pub struct Course {
    /// Grows whenever the lane begins anew.
    pub generation: u32,
    /// True for the low resolution of a moving camera.
    pub preview: bool,
    /// The passes that are wanted. None: there is no end.
    pub target: Option<u64>,
}

/// The names of the integrator and of the choice of shadow rays.
pub(crate) fn method_of(settings: &Settings) -> [String; 2] {
    let chosen = Request::of(settings).shadow_rays;
    let rays = chosen.map_or_else(|| settings.shadow_rays.to_string(), |rays| rays.to_string());
    [settings.integrator.to_string(), rays]
}

impl Exhibit {
    /// A lane that nothing was rendered of; `settings` are those that were asked for.
    pub fn new(lane: LaneId, course: Course, settings: &Settings) -> Self {
        Self {
            lane,
            course,
            method: method_of(settings),
            rendered: Duration::ZERO,
            last: None,
            curve: Vec::new(),
        }
    }

    /// Grows whenever the lane begins anew.
    pub fn generation(&self) -> u32 {
        self.course.generation
    }

    /// The time of all passes.
    pub fn rendered(&self) -> Duration {
        self.rendered
    }

    /// True where all passes are done.
    pub fn is_complete(&self, session: &Session<'_>) -> bool {
        let passes = session.film().passes().len();
        self.course.target.is_some_and(|target| passes >= target)
    }

    /// Takes notice of a pass that took so long; shows it where somebody looks and it is time.
    pub fn add_pass(&mut self, session: &Session<'_>, time: Duration, board: &Board) {
        self.rendered += time;
        if board.is_watched() && (self.course.preview || self.is_due()) {
            self.show(session, board);
        }
    }

    fn is_due(&self) -> bool {
        self.last.is_none_or(|last| {
            let rendered = self.rendered.saturating_sub(last.rendered);
            let is_cheap = rendered >= last.cost * RENDERING_PER_FRAME;
            last.at.elapsed() >= SHORTEST_GAP && (self.rendered < YOUTH || is_cheap)
        })
    }

    /// Shows what the film has, where that is not what is shown.
    pub fn show(&mut self, session: &Session<'_>, board: &Board) {
        let passes = session.film().passes().len();
        let is_shown = self.last.is_some_and(|last| last.passes == passes);
        if passes == 0 || is_shown {
            return;
        }
        let start = Instant::now();
        let frame = Frame::new(session.film());
        let relative_error = frame.relative_error;
        let rays = session.film().cost(Aov::Rays);
        let shown = Shown::new(self.lane, self.course.generation, frame, rays);
        board.show(self.lane, Some(Arc::new(shown)));
        self.last = Some(Last {
            at: Instant::now(),
            passes,
            cost: start.elapsed(),
            rendered: self.rendered,
            relative_error,
        });
        self.add_point();
    }

    /// Notes the error that is left; a single pass does not tell it.
    fn add_point(&mut self) {
        if let Some(error) = self.relative_error() {
            self.curve.push([self.rendered.as_secs_f64(), error]);
        }
        if self.curve.len() > CURVE_POINTS {
            let mut is_kept = false;
            self.curve.retain(|_| {
                is_kept = !is_kept;
                is_kept
            });
        }
    }

    fn relative_error(&self) -> Option<f64> {
        let last = self.last.filter(|last| last.passes > 1)?;
        Some(last.relative_error).filter(|error| error.is_finite())
    }

    /// What is told of it.
    pub fn status(&self, session: &Session<'_>) -> LaneStatus {
        let (stats, settings) = (session.stats(), session.settings());
        let [integrator, shadow_rays] = self.method.clone();
        let passes = session.film().passes().len();
        let seconds = self.rendered.as_secs_f64();
        // Passes of an earlier run took none of these seconds.
        let area = session.film().settings().crop.area();
        let eta = self.course.target.filter(|_| stats.samples > 0);
        let eta = eta.map(|target| {
            let left = target.saturating_sub(passes) * area;
            left as f64 * seconds / stats.samples as f64
        });
        LaneStatus {
            lane: self.lane,
            generation: self.course.generation,
            integrator,
            shadow_rays,
            settings: SettingsText::from(settings).by_flag(),
            passes,
            target: self.course.target,
            seconds,
            eta,
            samples_per_second: ratio(stats.samples, seconds),
            rays_per_second: rates(stats.rays, seconds),
            rays_per_sample: rates(stats.rays, stats.samples as f64),
            relative_error: self.relative_error(),
            curve: self.curve.clone(),
            strategy_vertices: settings.layers.strategy_vertices(),
            preview: self.course.preview,
        }
    }
}

/// A count by seconds or samples; nothing of nothing is nothing.
fn ratio(count: u64, whole: f64) -> f64 {
    if whole > 0.0 {
        count as f64 / whole
    } else {
        0.0
    }
}

fn rates(rays: RayCounts, whole: f64) -> RayRates {
    RayRates {
        camera: ratio(rays.camera, whole),
        light: ratio(rays.light, whole),
        connection: ratio(rays.connection, whole),
        light_image: ratio(rays.light_image, whole),
    }
}

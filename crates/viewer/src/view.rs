//! The view that clients have of a lane: its status, and frames as often as developing them is cheap.

use crate::frame::Frame;
use crate::shared::{SentFrame, SharedState};
use crate::status::{LaneId, LaneStatus, RayRates};
use bidir::driver::Settings;
use bidir::film::Aov;
use bidir::settings::Request;
use bidir::stats::RayCounts;
use formats::film::{Render, SettingsText};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The least time between two frames: more frames would not be visible.
const SHORTEST_GAP: Duration = Duration::from_millis(125);
/// The rendering time of a lane up to which only [`SHORTEST_GAP`] limits its frames.
const YOUTH: Duration = Duration::from_secs(3);
/// The least rendering time between two later frames. Unit: the time of developing the last one.
const RENDERING_PER_FRAME: u32 = 40;
/// Maximum number of points of the error curve. Beyond it, every other point is removed.
const CURVE_POINTS: usize = 256;

/// The view of a lane.
#[derive(Debug)]
pub(crate) struct RenderView {
    lane: LaneId,
    course: Course,
    /// The requested estimator and selection of shadow rays.
    method: [String; 2],
    last: Option<Last>,
    curve: Vec<[f64; 2]>,
}

/// The record of the last developed frame.
#[derive(Clone, Copy, Debug)]
struct Last {
    at: Instant,
    passes: u64,
    /// The time of developing.
    cost: Duration,
    /// The rendering time before the frame.
    rendered: Duration,
    relative_error: f64,
}

/// The course of a lane's render.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Course {
    /// Grows whenever the lane begins anew.
    pub(crate) generation: u32,
    /// True if the lane has the low resolution of a moving camera.
    pub(crate) preview: bool,
    /// The number of passes. None: there is no end.
    pub(crate) target: Option<u64>,
}

/// Returns the names of the integrator and of the selection of shadow rays.
pub(crate) fn method_of(settings: &Settings) -> [String; 2] {
    let chosen = Request::of(settings).shadow_rays;
    let rays = chosen.map_or_else(|| settings.shadow_rays.to_string(), |rays| rays.to_string());
    [settings.integrator.to_string(), rays]
}

impl RenderView {
    /// Returns the view of an empty lane, for which `settings` were requested.
    pub(crate) fn new(lane: LaneId, course: Course, settings: &Settings) -> Self {
        Self {
            lane,
            course,
            method: method_of(settings),
            last: None,
            curve: Vec::new(),
        }
    }

    /// Grows whenever the lane begins anew.
    pub(crate) fn generation(&self) -> u32 {
        self.course.generation
    }

    /// Returns true if all passes are done.
    pub(crate) fn is_complete(&self, render: &Render) -> bool {
        let passes = render.session.film().passes().len();
        self.course.target.is_some_and(|target| passes >= target)
    }

    /// Shares a frame after a pass, if a client watches and a frame is due.
    pub(crate) fn add_pass(&mut self, render: &Render, state: &SharedState) {
        if state.is_watched() && (self.course.preview || self.is_due(render.spent.rendering)) {
            self.show(render, state);
        }
    }

    fn is_due(&self, rendered: Duration) -> bool {
        self.last.is_none_or(|last| {
            let since = rendered.saturating_sub(last.rendered);
            let is_cheap = since >= last.cost * RENDERING_PER_FRAME;
            last.at.elapsed() >= SHORTEST_GAP && (rendered < YOUTH || is_cheap)
        })
    }

    /// Shares a frame of the film, unless the last one has the same passes.
    pub(crate) fn show(&mut self, render: &Render, state: &SharedState) {
        let session = &render.session;
        let passes = session.film().passes().len();
        let is_shown = self.last.is_some_and(|last| last.passes == passes);
        if passes == 0 || is_shown {
            return;
        }
        let start = Instant::now();
        let frame = Frame::new(session.film());
        let relative_error = frame.relative_error;
        let rays = session.film().cost(Aov::Rays);
        let shown = SentFrame::new(self.lane, self.course.generation, frame, rays);
        state.show(self.lane, Some(Arc::new(shown)));
        self.last = Some(Last {
            at: Instant::now(),
            passes,
            cost: start.elapsed(),
            rendered: render.spent.rendering,
            relative_error,
        });
        self.add_point();
    }

    /// Adds the error of the last frame to the curve, unless it has only one pass: then the error is unknown.
    fn add_point(&mut self) {
        if let (Some(last), Some(error)) = (self.last, self.relative_error()) {
            self.curve.push([last.rendered.as_secs_f64(), error]);
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

    /// Returns the status of the lane.
    pub(crate) fn status(&self, render: &Render) -> LaneStatus {
        let session = &render.session;
        let (stats, settings) = (session.stats(), session.settings());
        let [integrator, shadow_rays] = self.method.clone();
        let passes = session.film().passes().len();
        let seconds = render.spent.rendering.as_secs_f64();
        // Passes of an earlier run took none of these seconds.
        let area = session.film().settings().crop.area();
        let target = self.course.target.filter(|_| stats.samples > 0);
        let eta = target.map(|target| {
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

/// Returns a count per second or per sample; 0 if `whole` is 0.
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

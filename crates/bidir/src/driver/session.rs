//! Renders one pass after another: threads take groups of pixels, each sample is a pure function of its pixel and
//! pass, and the film gets a pass when all of it is done. A pass that was stopped leaves no trace. The only clock is
//! the host's, if it gives one.

mod group;
mod handle;
mod order;

pub use handle::SceneHandle;

use order::Order;

use super::blank::blank_warning;
use super::deposit::Deposit;
use super::features::{Features, Meter};
use super::threads::{Shortage, Threads, Workers};
use super::training::prepare;
use super::{Effort, Progress, Replay, Resources, SessionError, Settings, Stop, Training};
use crate::analysis::no_path;
use crate::film::{Film, FilmError, MergeError, PassBuffer};
use crate::guide::Guide;
use crate::integrator::{Batch, IntegratorKind, Method, Sample};
use crate::medium::MediumId;
use crate::path::{Job, SampleCounts, camera_medium};
use crate::sampler::{Domain, Sampler};
use crate::scene::Scene;
use crate::select::Selector;
use crate::spectrum::Lanes;
use crate::stats::{Stage, StageTimes, Stats};
use crate::view::View;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

/// The number of samples that go through the stages together. It is large enough that each stage's code serves
/// several samples while it is in the fastest cache, and small enough that their vertices stay in the next one.
const BATCH: usize = 32;

/// A render that goes pass by pass.
///
/// ```
/// use bidir::camera::{Camera, Perspective, PerspectiveSettings};
/// use bidir::driver::{Resources, Session, Settings};
/// use bidir::film::{FilmSettings, Filter};
/// use bidir::integrator::IntegratorKind;
/// use bidir::light::{InfiniteLight, Light};
/// use bidir::math::{Affine3A, Vec2};
/// use bidir::scene::SceneBuilder;
/// use bidir::view::View;
///
/// // Nothing but a sky.
/// let mut builder = SceneBuilder::new();
/// builder.light(Light::Infinite(InfiniteLight::constant([2.0; 3])));
/// let scene = builder.build()?;
///
/// let camera = Perspective::new(&PerspectiveSettings {
///     world_from_camera: Affine3A::IDENTITY,
///     resolution: Vec2::splat(4.0),
///     screen: [Vec2::new(-1.0, 1.0), Vec2::new(1.0, -1.0)],
///     lens_radius: 0.0,
///     focal_distance: 1.0,
/// });
/// let camera = Camera::Perspective(camera.ok_or("no rigid camera")?);
/// let view = View::new(camera, FilmSettings::new([4, 4], Filter::default()))?;
///
/// // Path tracing sees a plain sky without noise.
/// let settings = Settings {
///     integrator: IntegratorKind::Path,
///     ..Settings::default()
/// };
/// let mut session = Session::new(&scene, &view, settings, &Resources::default())?;
/// while session.next_pass() < 2 {
///     // `()` reports to nobody and never stops.
///     session.step(&());
/// }
/// let picture = session.film().develop();
/// assert!(picture.pixels.iter().flatten().all(|channel| (channel - 2.0).abs() < 1e-3));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Session<'a> {
    scene: SceneHandle<'a>,
    view: View,
    settings: Settings,
    method: Method,
    training: Option<Training>,
    film: Film,
    order: Order,
    /// The meaning of lanes in each group: group i has element i modulo the length.
    lanes: Vec<Lanes>,
    /// The medium around the camera.
    medium: MediumId,
    /// The number of the first pass that this session may render.
    first_pass: u64,
    buffer: PassBuffer,
    /// True from the beginning of a pass to its end. If it is true when a pass begins, the last one was given up, or
    /// ended by a panic of the host, and its results are cleared.
    is_in_pass: bool,
    stats: Stats,
    stage_times: StageTimes,
    workers: Workers,
    /// One per thread, kept so that no sample allocates.
    batches: Vec<Mutex<Batch>>,
}

impl<'a> Session<'a> {
    /// Makes a session that has rendered nothing but its training.
    ///
    /// Errors: the film needs more memory than `resources` allow or the system has; `effort` asked to stop.
    pub fn new(
        scene: impl Into<SceneHandle<'a>>,
        view: &View,
        settings: Settings,
        resources: &Resources,
    ) -> Result<Self, SessionError> {
        Self::with_effort(scene, view, settings, resources, Effort::WHOLE)
    }

    /// Makes a session with training of some effort, on which the bits of the image depend.
    ///
    /// Errors: as [`Self::new`].
    pub fn with_effort(
        scene: impl Into<SceneHandle<'a>>,
        view: &View,
        settings: Settings,
        resources: &Resources,
        effort: Effort<'_>,
    ) -> Result<Self, SessionError> {
        let scene = scene.into();
        if let Some(lost) = no_path(settings.integrator, &settings.path) {
            let strategies = settings.path.strategies.to_string();
            return Err(SessionError::NoPath { strategies, lost });
        }
        let layers = settings.layers.clone();
        let film = Film::with_layers(view.film().clone(), layers, resources.film_memory)?;
        let buffer = PassBuffer::new(view.film(), film.layers())?;
        let workers = Workers::start(Threads::new(resources.threads));
        let threads = workers.count();
        let prepared = workers.install(|| prepare(&scene, view, settings, effort));
        let (settings, training) = prepared.ok_or(SessionError::Stopped)?;
        let rule = selector(&settings, training.as_ref());
        let method = Method::new(settings.integrator, rule, &settings.lvc);
        let order = workers.install(|| Order::new(view.film().crop, &method));
        Ok(Self {
            medium: camera_medium(&scene, view),
            scene,
            view: view.clone(),
            settings,
            method,
            order,
            lanes: vec![Lanes::Rgb],
            training,
            film,
            first_pass: 0,
            buffer,
            is_in_pass: false,
            stats: Stats::default(),
            stage_times: StageTimes::default(),
            workers,
            batches: std::iter::repeat_with(|| Batch::timed_by(resources.clock))
                .map(Mutex::new)
                .take(threads)
                .collect(),
        })
    }

    /// Adds a film of the same scene and settings that was rendered before: its passes will not be rendered again,
    /// and the film is the one that a session without a break would have.
    ///
    /// Errors: the film is of another size, has other layers, or holds passes that are here already.
    pub fn add_film(&mut self, film: Film) -> Result<(), MergeError> {
        self.film.adopt(film)
    }

    /// Skips the passes before `first`, for other sessions to render.
    pub fn start_at(&mut self, first: u64) {
        self.first_pass = first;
    }

    /// Returns the pass that [`Self::step`] renders.
    pub fn next_pass(&self) -> u64 {
        self.film.passes().first_missing(self.first_pass)
    }

    /// Renders the next pass. False: `progress` asked to stop, and the pass is forgotten.
    pub fn step(&mut self, progress: &dyn Progress) -> bool {
        if std::mem::replace(&mut self.is_in_pass, true) {
            let buffer = &mut self.buffer;
            self.workers.install(|| buffer.clear());
            self.take_counts();
        }
        let pass = self.next_pass();
        let next = AtomicU64::new(0);
        let given_up = AtomicBool::new(false);
        let this = &*self;
        this.workers.broadcast(|thread| {
            let Some(batch) = this.batches.get(thread) else {
                return;
            };
            // Only this thread locks the batch; a panic elsewhere does not make it wrong.
            let mut batch = batch.lock().unwrap_or_else(PoisonError::into_inner);
            if !this.render_groups(pass, &next, &mut batch, progress) {
                given_up.store(true, Ordering::Relaxed);
            }
        });
        let (stats, stage_times) = self.take_counts();
        if given_up.into_inner() {
            // The next pass clears what this one left: a host that stops does not wait for it.
            return false;
        }
        self.stats += &stats;
        self.stage_times += &stage_times;
        let (film, buffer) = (&mut self.film, &mut self.buffer);
        self.workers.install(|| {
            film.add_pass(pass, buffer);
            buffer.clear();
        });
        self.is_in_pass = false;
        true
    }

    /// Returns the counters and times of all threads since the last call.
    fn take_counts(&mut self) -> (Stats, StageTimes) {
        let (mut stats, mut stage_times) = (Stats::default(), StageTimes::default());
        for batch in &mut self.batches {
            let batch = batch.get_mut().unwrap_or_else(PoisonError::into_inner);
            stats += &std::mem::take(&mut batch.worker.stats);
            stage_times += &batch.worker.stopwatch.take();
        }
        (stats, stage_times)
    }

    /// Renders groups of pixels until none is left. False: one was given up.
    fn render_groups(
        &self,
        pass: u64,
        next: &AtomicU64,
        batch: &mut Batch,
        progress: &dyn Progress,
    ) -> bool {
        let pixels = self.view.film().crop.area();
        loop {
            let begin = next.fetch_add(self.group_size(), Ordering::Relaxed);
            if begin >= pixels {
                return true;
            }
            let slots = self.group(begin);
            let job = self.job(begin, progress.stop());
            if self.method.shares_light() {
                self.walk_light(&job, slots.clone(), pass, batch, BATCH, |batch| {
                    self.deposit(&job).take_splats(batch);
                });
            }
            if !self.render_group(&job, slots.clone(), pass, batch, progress) {
                return false;
            }
            progress.advance(slots.end - slots.start);
        }
    }

    /// Adds contributions to the pass.
    fn deposit<'d>(&'d self, job: &'d Job<'d>) -> Deposit<'d> {
        Deposit {
            job,
            layers: self.film.layers(),
            buffer: &self.buffer,
        }
    }

    /// Returns the job that all samples of the group of `slot` share.
    fn job<'j>(&'j self, slot: u64, stop: Stop<'j>) -> Job<'j> {
        Job {
            scene: &self.scene,
            view: &self.view,
            lanes: self.lanes(slot),
            settings: &self.settings.path,
            counts: self.counts(),
            guide: self.guide(),
            medium: self.medium,
            stop,
        }
    }

    /// Returns the number of samples that each kind of strategy takes in a pass.
    pub(super) fn counts(&self) -> SampleCounts {
        match self.guiding() {
            Some(training) => training.counts(self.settings.lvc, self.light_subpaths()),
            None => SampleCounts::of_own_subpaths(self.view.film()),
        }
    }

    fn guide(&self) -> Guide<'_> {
        self.guiding().map_or(Guide::default(), Training::guide)
    }

    /// Returns the training, if the estimator uses its knowledge.
    fn guiding(&self) -> Option<&Training> {
        let training = self.training.as_ref();
        training.filter(|_| self.settings.integrator == IntegratorKind::Lvc)
    }

    /// Renders the samples at `slots` batch by batch, and adds them to the pass. False: the host asked to stop, and
    /// the pass is to be given up.
    fn render_group(
        &self,
        job: &Job<'_>,
        mut slots: Range<u64>,
        pass: u64,
        batch: &mut Batch,
        progress: &dyn Progress,
    ) -> bool {
        let layers = self.film.layers();
        // The cost of a sample is measured for a batch of one.
        let size = if layers.features() > 0 { 1 } else { BATCH };
        while !slots.is_empty() {
            let samples = slots.by_ref().take(size);
            batch.fill(samples.map(|slot| self.sample(slot, pass)));
            let count = batch.walks.samples.len();
            batch.worker.stopwatch.begin_samples(count);
            let before = Meter::read(layers, batch, progress);
            self.method.run(job, batch);
            self.deposit(job).take(batch);
            if layers.features() > 0 {
                let after = Meter::read(layers, batch, progress);
                let features = Features::new(job, layers, batch, [&before, &after]);
                self.deposit(job).take_features(batch, &features);
            }
            batch.worker.stopwatch.end(Stage::Film);
            // Checked after the last ray: if a thread saw the flag during the batch, it is seen here.
            if job.stop.is_asked() {
                return false;
            }
        }
        true
    }

    /// Returns the sample at `slot` in the order of a pass, with the light path that goes with it.
    fn sample(&self, slot: u64, pass: u64) -> Sample {
        let film = self.view.film();
        let sampler = Sampler::new(self.settings.sampler, self.settings.seed);
        let [x, y] = film.crop.pixel(self.order.pixel(slot));
        let stream = u64::from(y) * u64::from(film.resolution[0]) + u64::from(x);
        let camera = sampler.stream(Domain::Camera, stream, pass);
        let light = sampler.member(Domain::Light, slot / self.samples_per_subpath(), pass);
        Sample::new(pass, [x, y], camera, light)
    }

    /// Repeats the sample of `pixel` in `pass`. None: the pixel is outside the crop.
    pub fn replay(&self, pixel: [u32; 2], pass: u64) -> Option<Replay> {
        let [x, y] = pixel.map(i64::from);
        let slot = self.order.slot(self.view.film().crop.index(x, y)?);
        let (job, mut batch) = (self.job(slot, Stop::NEVER), Batch::default());
        let shared = self.method.shares_light();
        let brought = shared.then(|| self.replay_light(&job, slot, pass, &mut batch));
        batch.fill([self.sample(slot, pass)]);
        self.method.run(&job, &mut batch);
        let mut light = (!shared && batch.walks.light.count() > 0).then_some(0);
        if let Some((number, splats)) = brought.flatten() {
            (light, batch.splats) = (Some(number), splats);
        }
        let selector = selector(&self.settings, self.training.as_ref());
        Some(Replay::new(&job, batch, light, &*selector))
    }

    /// Returns the view that is rendered.
    pub fn view(&self) -> &View {
        &self.view
    }

    /// Returns the scene that is rendered.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Returns the settings, with everything decided that was left open.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Returns the film rendered so far.
    pub fn film(&self) -> &Film {
        &self.film
    }

    /// Returns the noise that is left in the picture
    /// ([`Picture::relative_error`](crate::film::Picture::relative_error)). It is 0 in a scene without lights, whose
    /// picture stays black; with lights, a black picture may have found no light yet.
    pub fn noise(&self) -> f64 {
        if self.scene.lights().is_empty() {
            return 0.0;
        }
        self.film.develop().relative_error()
    }

    /// Returns true for the numbers of passes after which a render that ends by its [`Self::noise`] checks it. They
    /// begin at 16 and grow further apart, because developing a film takes time. They depend only on `passes`, so
    /// that an interrupted render ends after the same pass.
    pub fn looks_at_noise(passes: u64) -> bool {
        passes >= 16 && passes.is_multiple_of(1 << (passes.ilog2() - 3))
    }

    /// Returns a warning, with the reason, that the image is black or the same everywhere. None: pixels differ, or no
    /// pass was rendered. Takes as long as developing the film.
    pub fn blank_warning(&self) -> Option<String> {
        if self.film.passes().is_empty() {
            return None;
        }
        let picture = self.film.develop();
        blank_warning(&self.scene, &self.view, &self.settings, &picture)
    }

    /// Returns the counters so far, without training.
    pub fn stats(&self) -> &Stats {
        &self.stats
    }

    /// Returns the time of stages, measured in some of the samples; zero without [`Resources::clock`].
    pub fn stage_times(&self) -> &StageTimes {
        &self.stage_times
    }

    /// Returns the training before the first pass, if anything had to be learned.
    pub fn training(&self) -> Option<&Training> {
        self.training.as_ref()
    }

    /// Returns the number of threads.
    pub fn threads(&self) -> usize {
        self.batches.len()
    }

    /// Returns the threads that the system did not start, and why. None: it started all.
    pub fn shortage(&self) -> Option<&Shortage> {
        self.workers.shortage()
    }

    /// Takes the film and its counters. The session goes on with an empty film, as if no pass had been rendered.
    ///
    /// Errors: the system has no memory for another film; the session is then unchanged.
    pub fn take_film(&mut self) -> Result<(Film, Stats), FilmError> {
        let empty = self.film.emptied()?;
        let film = std::mem::replace(&mut self.film, empty);
        Ok((film, std::mem::take(&mut self.stats)))
    }

    /// Returns the film, without the session.
    pub fn into_film(self) -> Film {
        self.film
    }
}

/// Returns the rule that chooses shadow rays, with what training found for it.
fn selector(settings: &Settings, training: Option<&Training>) -> Box<dyn Selector> {
    let mean = training.map_or(0.0, |training| training.mean_luminance);
    settings.shadow_rays.selector(mean)
}

#[cfg(test)]
mod tests;

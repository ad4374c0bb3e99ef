//! The render before the first pass: the mean luminance of the image, by which shadow-ray roulette
//! sets its threshold, what is learnt about connections, and what `auto` renders with. Sample i is at
//! pixel i·STRIDE modulo the number of pixels; the first are of the full estimator that traces every
//! connection.

mod pilot;
mod plan;
mod probe;
mod trial;

pub use plan::Plan;

use super::Settings;
use super::session::path_context;
use crate::integrator::{CandidateCount, Integrator, IntegratorKind, Workspace, connectable};
use crate::math::Vec3;
use crate::path::PathRoulette;
use crate::path::{Cells, Connections, LightProposals, PairSums, PathContext};
use crate::scene::Scene;
use crate::select::ShadowRays;
use crate::spectrum::luminance;
use crate::stats::RayCounts;
use probe::Probe;

/// What a short render before the first pass found: a pure function of scene and settings. Its
/// samples have random numbers of their own and never enter the film.
#[derive(Clone, Debug)]
pub struct Training {
    /// The mean luminance of the image.
    pub mean_luminance: f32,
    /// The mean number of vertices of a light subpath that camera vertices can be connected with.
    pub light_vertices: f64,
    /// How light vertices are chosen, where that is learnt.
    pub proposals: Option<LightProposals>,
    /// What is rendered with, where that was to be found out.
    pub plan: Option<Plan>,
    /// The samples it took.
    pub samples: u64,
    /// The rays it cost.
    pub rays: RayCounts,
}

/// Enough for the mean luminance to within a few percent in most scenes.
const SAMPLES: u64 = 1 << 14;

/// The distance between the pixels of successive samples: a prime above any number of pixels, so
/// that they spread evenly.
const STRIDE: u64 = 2_654_435_761;

/// The settings with everything decided that they leave open, and what was learnt, where anything had
/// to be.
pub(super) fn prepare(scene: &Scene, settings: Settings) -> (Settings, Option<Training>) {
    let mut settings = settings;
    if settings.integrator == IntegratorKind::Auto {
        let (plan, training) = Training::plan(scene, &settings);
        return (plan.apply(&settings), Some(training));
    }
    if settings.path.roulette == PathRoulette::Suited {
        settings.path.roulette = settings.integrator.roulette();
    }
    let needs_mean = settings.integrator.has_candidates() && settings.shadow_rays.needs_mean();
    let needs_training = needs_mean || settings.integrator == IntegratorKind::Lvc;
    let training = needs_training.then(|| Training::run(scene, &settings));
    (settings, training)
}

impl Training {
    /// Finds what to render with, and trains for it.
    fn plan(scene: &Scene, settings: &Settings) -> (Plan, Self) {
        let mut training = Self::run(scene, &Plan::default().apply(settings));
        let tried = plan::try_all(scene, settings, &training, training.samples);
        for (_, trial) in &tried {
            training.rays += trial.stats.rays;
            training.samples += trial.stats.samples;
        }
        let plan = plan::best(scene.film().crop.area(), &tried);
        training.plan = Some(plan);
        (plan, training)
    }

    /// Renders a few samples spread over the film, tracing every connection.
    fn run(scene: &Scene, settings: &Settings) -> Self {
        let survey = Survey::run(scene, settings);
        let mut training = Self {
            mean_luminance: (survey.luminance / SAMPLES as f64) as f32,
            light_vertices: survey.light.len() as f64 / SAMPLES as f64,
            proposals: None,
            plan: None,
            samples: SAMPLES,
            rays: survey.rays,
        };
        if settings.learns() && training.light_vertices > 0.0 {
            training.learn(scene, settings, &survey);
        }
        training
    }

    /// How many connections a camera vertex makes, of `candidates`.
    pub(super) fn connections(&self, candidates: CandidateCount) -> Connections<'_> {
        let candidates = f64::from(candidates.get());
        match self.light_vertices {
            0.0 => Connections::ONE_SUBPATH,
            vertices => Connections {
                per_vertex: candidates / vertices,
                proposals: self.proposals.as_ref(),
                samples_per_subpath: 1.0,
            },
        }
    }

    /// Learns which light vertices to propose.
    fn learn(&mut self, scene: &Scene, settings: &Settings, survey: &Survey) {
        let (cells, mut sums) = survey.cells();
        self.proposals = Some(LightProposals::new(cells.clone(), &sums));
        let probe = Probe {
            scene,
            settings,
            connections: self.connections(settings.lvc.candidates),
            first: SAMPLES,
        };
        let rays = pilot::run(&probe, &mut sums);
        self.rays += rays;
        self.samples += pilot::SAMPLES;
        self.proposals = Some(LightProposals::new(cells, &sums));
    }
}

/// What the samples of every connection found.
#[derive(Default)]
struct Survey {
    /// The sum of luminances that samples add to the mean pixel.
    luminance: f64,
    /// The light vertices that can be connected: points and normals.
    light: Vec<[Vec3; 2]>,
    /// The camera vertices that can be, by their points.
    camera: Vec<Vec3>,
    rays: RayCounts,
}

impl Survey {
    fn run(scene: &Scene, settings: &Settings) -> Self {
        let integrator = IntegratorKind::Bdpt
            .integrator(ShadowRays::All.selector(0.0), CandidateCount::default());
        let (mut survey, mut workspace) = (Self::default(), Workspace::default());
        let probe = Probe {
            scene,
            settings,
            connections: Connections::ONE_SUBPATH,
            first: 0,
        };
        for number in 0..SAMPLES {
            survey.sample(&probe, &*integrator, number, &mut workspace);
        }
        survey.rays = workspace.stats.rays;
        survey
    }

    fn sample(
        &mut self,
        probe: &Probe<'_>,
        integrator: &dyn Integrator,
        number: u64,
        workspace: &mut Workspace,
    ) {
        let (scene, sample) = (probe.scene, probe.sample(number));
        let context = probe.context(&sample);
        integrator.sample(&context, &sample, workspace);
        let y = |light| f64::from(luminance(scene.color().to_rgb(light, &context.wavelengths)));
        let splats = workspace.splats.iter();
        let splats: f64 = splats.map(|splat| y(splat.contribution.value)).sum();
        self.luminance += y(workspace.value) + splats / scene.film().crop.area() as f64;
        self.keep_vertices(&context, workspace);
    }

    fn keep_vertices(&mut self, context: &PathContext<'_>, workspace: &Workspace) {
        let light = &workspace.light.vertices;
        let connectable = connectable(context.settings.light_point, light);
        self.light.extend(connectable.map(|i| light[i].place()));
        let camera = workspace.camera.vertices.iter().skip(1);
        let camera = camera.filter(|y| !y.is_delta());
        self.camera.extend(camera.map(|y| y.point));
    }

    /// Cells that suit the vertices, with how many light vertices each has.
    fn cells(&self) -> (Cells, PairSums) {
        let light = self.light.iter().map(|[point, _]| *point);
        let mut points: Vec<_> = light.chain(self.camera.iter().copied()).collect();
        let cells = Cells::new(&mut points);
        let mut light_vertices = vec![0.0; Cells::COUNT];
        for &[point, n] in &self.light {
            light_vertices[cells.of(point, n).index()] += 1.0 / SAMPLES as f64;
        }
        (cells, PairSums::uniform(light_vertices))
    }
}

//! The render before the first pass: the mean luminance of the image, by which shadow-ray roulette
//! sets its threshold, what is learnt about connections, and what `auto` renders with. Samples are spread
//! evenly over the film; the first are of the full estimator that traces every connection.

mod blocks;
mod choice;
mod emission;
mod extent;
mod pilot;
mod plan;
mod probe;
mod rays;
mod survey;
#[cfg(test)]
mod tests;
mod trial;

pub use plan::Plan;

use super::Settings;
use super::session::path_context;
use crate::integrator::{
    EmissionKind, IntegratorKind, LvcSettings, ProposalKind, SamplesPerSubpath, group_size,
};
use crate::light::LightChoice;
use crate::path::{Cells, Connections, LightProposals, MisCount};
use crate::scene::Scene;
use crate::select::ShadowRays;
use crate::stats::RayCounts;
use blocks::Blocks;
use choice::Judge;
use extent::Extent;
use pilot::Found;
use plan::Trials;
use probe::Probe;
use survey::Survey;

/// The vertices of a light cache, of which each thread has one: some 30 MB. Subpaths of 128 vertices on
/// average reach it, of two samples each.
const MOST_CACHED: f64 = 131_072.0;

/// What a short render before the first pass found: a pure function of scene and settings. Its
/// samples have random numbers of their own and never enter the film.
#[derive(Clone, Debug)]
pub struct Training {
    /// The mean luminance of the image, before sensor and exposure. Unit: W/(m² sr) of scene units.
    pub mean_luminance: f32,
    /// The mean number of vertices of a light subpath that camera vertices can be connected with.
    pub light_vertices: f64,
    /// How light vertices are chosen, where that is learnt.
    pub proposals: Option<LightProposals>,
    /// How light subpaths choose their light, where that is learnt.
    pub emission: Option<LightChoice>,
    /// What is rendered with, where that was to be found out.
    pub plan: Option<Plan>,
    /// The samples it took.
    pub samples: u64,
    /// The rays it cost.
    pub rays: RayCounts,
    /// How many samples connections are learnt from.
    learning: Extent,
    /// How many samples compare plans.
    trials: Extent,
    /// The mean number of rays of a light subpath.
    subpath_rays: f64,
}

/// The settings with everything decided that they leave open, and what was learnt, where anything had
/// to be.
pub(super) fn prepare(scene: &Scene, settings: Settings) -> (Settings, Option<Training>) {
    let mut settings = settings;
    if settings.integrator == IntegratorKind::Auto {
        let (plan, training) = Training::plan(scene, &settings);
        return (plan.apply(&settings), Some(training));
    }
    settings.decide();
    let needs_mean = settings.integrator.has_candidates() && settings.shadow_rays.needs_mean();
    let needs_training = needs_mean || settings.integrator == IntegratorKind::Lvc;
    let training = needs_training.then(|| Training::run(scene, &settings));
    if let (IntegratorKind::Lvc, Some(training)) = (settings.integrator, &training) {
        let wanted = settings.lvc.samples_per_subpath;
        settings.lvc.samples_per_subpath = training.samples_per_subpath(scene, wanted);
    }
    (settings, training)
}

impl Training {
    /// Finds what to render with, and trains for it.
    fn plan(scene: &Scene, settings: &Settings) -> (Plan, Self) {
        let default = Plan::default().keeping(settings);
        let mut training = Self::run(scene, &default.apply(settings));
        let mut plan = if scene.lights().is_empty() {
            plan::path(1).keeping(settings)
        } else {
            // What nothing found yet is found by what makes most paths.
            training.choose(scene, settings).unwrap_or(default)
        };
        if plan.is_shared() {
            plan.samples_per_subpath =
                training.samples_per_subpath(scene, plan.samples_per_subpath);
        }
        training.plan = Some(plan);
        (plan, training)
    }

    /// The best plan. None: no trial found any light.
    fn choose(&mut self, scene: &Scene, settings: &Settings) -> Option<Plan> {
        let trials = Trials {
            scene,
            settings,
            training: self,
        };
        let (mut tried, blocks) = (trials.run(), Blocks::new(scene.film().crop));
        let first = Judge::new(&blocks, settings, &tried);
        let (close, shared) = (first.close(), first.best_shared());
        trials.run_more(&close, &mut tried);
        for (_, trial) in &tried {
            self.count(trial.stats.samples, trial.stats.rays);
        }
        Judge::new(&blocks, settings, &tried).best(shared)
    }

    /// Renders a few samples spread over the film, tracing every connection.
    fn run(scene: &Scene, settings: &Settings) -> Self {
        let survey = Survey::run(scene, settings);
        let mut training = Self {
            mean_luminance: (survey.luminance / survey.samples()) as f32,
            light_vertices: survey.light.len() as f64 / survey.samples(),
            proposals: None,
            emission: None,
            plan: None,
            samples: survey.stats.samples,
            rays: survey.stats.rays,
            learning: survey.extent_of_learning(),
            trials: survey.extent_of_trials(),
            subpath_rays: survey.stats.rays.light as f64 / survey.samples(),
        };
        if settings.learns() && training.light_vertices > 0.0 {
            training.learn(scene, settings, &survey);
        }
        training
    }

    /// How many samples there are for a light subpath: as `wanted`, or so many that the cache of a group has
    /// [`MOST_CACHED`] vertices on average.
    fn samples_per_subpath(&self, scene: &Scene, wanted: SamplesPerSubpath) -> SamplesPerSubpath {
        let pixels = scene.film().crop.area();
        let group = group_size(pixels).min(pixels) as f64;
        wanted.or_more(group * self.subpath_rays / MOST_CACHED)
    }

    /// How many connections a camera vertex makes, where each sample has a light subpath.
    pub(super) fn connections(&self, settings: LvcSettings) -> Connections<'_> {
        let next_events = settings.next_events.get().map(f64::from);
        match self.light_vertices {
            0.0 => Connections {
                next_events,
                ..Connections::ONE_SUBPATH
            },
            vertices => Connections {
                next_events,
                per_vertex: settings
                    .candidates
                    .count()
                    .get()
                    .map(|count| f64::from(count) / vertices),
                proposals: self.proposals.as_ref(),
                emission: self.emission.as_ref(),
                samples_per_subpath: 1.0,
                mis_count: settings.mis_count,
            },
        }
    }

    /// Learns where light subpaths shall begin, which of their vertices to propose, which are visible, and
    /// which are chosen.
    fn learn(&mut self, scene: &Scene, settings: &Settings, survey: &Survey) {
        let (lvc, cells) = (&settings.lvc, survey.cells());
        let found = self.explore(scene, settings, survey, &cells);
        if lvc.emission == EmissionKind::Learned {
            let (power, subpaths) = (scene.light_choice(), self.learning.samples());
            self.emission = emission::learnt(power, &found.connections, subpaths);
        }
        let gain = |light| emission::gain(scene.light_choice(), self.emission.as_ref(), light);
        let mut sums = survey.pair_sums(&cells, gain);
        self.light_vertices = sums.light_vertices.iter().sum();
        if lvc.proposal == ProposalKind::Learned {
            for connection in &found.connections {
                // Of a light that begins g times as many subpaths each contributes 1/g.
                let square = connection
                    .square
                    .map(|square| square / gain(connection.light));
                sums.add(connection.pair(), square);
            }
            for next_event in &found.next_events {
                sums.see(next_event.pair, next_event.has_arrived);
            }
        }
        let proposals = match lvc.proposal {
            ProposalKind::Learned => LightProposals::new(cells, &sums),
            ProposalKind::Uniform => LightProposals::uniform(cells, &sums),
        };
        let proposals = self.counting_rays(scene, settings, proposals);
        let is_uniform =
            lvc.proposal == ProposalKind::Uniform && lvc.mis_count != MisCount::Resampled;
        self.proposals = (!is_uniform).then_some(proposals);
    }

    /// Connections with light vertices that are chosen by nothing, where somebody learns from them.
    fn explore(
        &mut self,
        scene: &Scene,
        settings: &Settings,
        survey: &Survey,
        cells: &Cells,
    ) -> Found {
        let LvcSettings {
            proposal, emission, ..
        } = settings.lvc;
        if proposal == ProposalKind::Uniform && emission == EmissionKind::Power {
            return Found::default();
        }
        let uniform = LightProposals::uniform(cells.clone(), &survey.pair_sums(cells, |_| 1.0));
        let (found, rays) = pilot::run(&self.probe(scene, settings, &uniform));
        self.count(self.learning.samples(), rays);
        found
    }

    /// The proposals with counts of traced rays, where weights take these and not all are traced.
    fn counting_rays(
        &mut self,
        scene: &Scene,
        settings: &Settings,
        proposals: LightProposals,
    ) -> LightProposals {
        let all_are_traced = settings.shadow_rays == ShadowRays::All;
        if settings.lvc.mis_count != MisCount::Resampled || all_are_traced {
            return proposals;
        }
        let probe = self.probe(scene, settings, &proposals);
        let (inclusion, rays) = rays::run(&probe, self.mean_luminance);
        self.count(self.learning.samples(), rays);
        proposals.counting_rays(&inclusion)
    }

    /// More samples, where `proposals` are all that is known.
    fn probe<'a>(
        &'a self,
        scene: &'a Scene,
        settings: &'a Settings,
        proposals: &'a LightProposals,
    ) -> Probe<'a> {
        Probe {
            scene,
            settings,
            connections: Connections {
                proposals: Some(proposals),
                ..self.connections(settings.lvc)
            },
            extent: self.learning,
            first: self.samples,
            pixels: u64::MAX,
        }
    }

    fn count(&mut self, samples: u64, rays: RayCounts) {
        self.samples += samples;
        self.rays += rays;
    }
}

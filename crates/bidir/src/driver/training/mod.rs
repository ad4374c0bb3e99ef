//! The render before the first pass: the mean luminance of the image, by which shadow-ray roulette
//! sets its threshold, what is learnt about connections, and what `auto` renders with. Samples are spread
//! evenly over the film; the first are of the full estimator that traces every connection.

mod blocks;
mod choice;
mod effort;
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

pub use effort::Effort;
pub use plan::Plan;

use super::Settings;
use super::session::path_context;
use crate::integrator::{
    IntegratorKind, LightStart, LvcSettings, ProposalKind, SamplesPerSubpath, group_size,
};
use crate::light::LightChoice;
use crate::path::{Cells, Connections, LightProposals, MisCount};
use crate::scene::Scene;
use crate::select::ShadowRays;
use crate::stats::RayCounts;
use crate::view::View;
use blocks::Blocks;
use choice::Judge;
use effort::{IsLate, Late};
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
    /// True where there was no time for more than a few samples ([`Effort::Short`]).
    pub is_short: bool,
    /// How many samples connections are learnt from.
    learning: Extent,
    /// How many samples compare plans.
    trials: Extent,
    /// The mean number of rays of a light subpath.
    subpath_rays: f64,
}

/// The settings with everything decided that they leave open, and what was learnt, where anything had
/// to be.
pub(super) fn prepare(
    scene: &Scene,
    view: &View,
    settings: Settings,
    effort: Effort<'_>,
) -> (Settings, Option<Training>) {
    let is_late: IsLate<'_> = match effort {
        Effort::Whole => &|| false,
        Effort::Until(is_late) => is_late,
        Effort::Short => return effort::short(scene, view, settings),
    };
    let task = Task {
        scene,
        view,
        settings: &settings,
        is_late,
    };
    train(task).unwrap_or_else(|Late| effort::short(scene, view, settings))
}

/// The scene and the settings that training is for.
#[derive(Clone, Copy)]
struct Task<'a> {
    scene: &'a Scene,
    view: &'a View,
    settings: &'a Settings,
    is_late: IsLate<'a>,
}

fn train(task: Task<'_>) -> Result<(Settings, Option<Training>), Late> {
    let mut settings = task.settings.clone();
    if settings.integrator == IntegratorKind::Auto {
        let (plan, training) = Training::plan(task)?;
        return Ok((plan.apply(&settings), Some(training)));
    }
    if !settings.needs_training() {
        return Ok((settings, None));
    }
    let training = Training::run(task.with(&settings))?;
    training.bound_cache(task.view, &mut settings);
    Ok((settings, Some(training)))
}

impl<'a> Task<'a> {
    /// The same with other settings.
    fn with<'b>(self, settings: &'b Settings) -> Task<'b>
    where
        'a: 'b,
    {
        Task { settings, ..self }
    }
}

impl Settings {
    /// True where the estimator needs to know something of the scene.
    fn needs_training(&self) -> bool {
        let needs_mean = self.integrator.has_candidates() && self.shadow_rays.needs_mean();
        needs_mean || self.integrator == IntegratorKind::Lvc
    }
}

impl Training {
    /// Finds what to render with, and trains for it.
    fn plan(task: Task<'_>) -> Result<(Plan, Self), Late> {
        let Task {
            scene, settings, ..
        } = task;
        let default = Plan::default().keeping(settings);
        let mut training = Self::run(task.with(&default.apply(settings)))?;
        let mut plan = if scene.lights().is_empty() {
            plan::path(1).keeping(settings)
        } else {
            // What nothing found yet is found by what makes most paths.
            training.choose(task)?.unwrap_or(default)
        };
        if plan.is_shared() {
            let pixels = task.view.film().crop.area();
            plan.samples_per_subpath =
                training.samples_per_subpath(pixels, plan.samples_per_subpath);
        }
        training.plan = Some(plan);
        Ok((plan, training))
    }

    /// The best plan. None: no trial found any light.
    fn choose(&mut self, task: Task<'_>) -> Result<Option<Plan>, Late> {
        let trials = Trials {
            task,
            training: self,
        };
        let (mut tried, blocks) = (trials.run()?, Blocks::new(task.view.film().crop));
        let first = Judge::new(&blocks, task.settings, &tried);
        let (close, shared) = (first.close(), first.best_shared());
        trials.run_more(&close, &mut tried)?;
        for (_, trial) in &tried {
            self.count(trial.stats.samples, trial.stats.rays);
        }
        Ok(Judge::new(&blocks, task.settings, &tried).best(shared))
    }

    /// Renders a few samples spread over the film, tracing every connection, and learns from them.
    fn run(task: Task<'_>) -> Result<Self, Late> {
        let survey = Survey::run(task)?;
        let mut training = Self::of(&survey);
        if task.settings.learns() && training.light_vertices > 0.0 {
            training.learn(task, &survey)?;
        }
        Ok(training)
    }

    /// Training that has learnt nothing yet.
    fn of(survey: &Survey) -> Self {
        Self {
            mean_luminance: (survey.luminance / survey.samples()) as f32,
            light_vertices: survey.light.len() as f64 / survey.samples(),
            proposals: None,
            emission: None,
            plan: None,
            samples: survey.stats.samples,
            rays: survey.stats.rays,
            is_short: false,
            learning: survey.extent_of_learning(),
            trials: survey.extent_of_trials(),
            subpath_rays: survey.stats.rays.light as f64 / survey.samples(),
        }
    }

    /// Lets so few light subpaths be in a cache that it stays small.
    fn bound_cache(&self, view: &View, settings: &mut Settings) {
        if settings.integrator == IntegratorKind::Lvc {
            let (pixels, wanted) = (view.film().crop.area(), settings.lvc.samples_per_subpath);
            settings.lvc.samples_per_subpath = self.samples_per_subpath(pixels, wanted);
        }
    }

    /// How many samples of an image with so many pixels there are for a light subpath: as `wanted`, or so many
    /// that the cache of a group has [`MOST_CACHED`] vertices on average.
    fn samples_per_subpath(&self, pixels: u64, wanted: SamplesPerSubpath) -> SamplesPerSubpath {
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
    fn learn(&mut self, task: Task<'_>, survey: &Survey) -> Result<(), Late> {
        let (scene, lvc, cells) = (task.scene, &task.settings.lvc, survey.cells());
        let found = self.explore(task, survey, &cells)?;
        if lvc.light_start == LightStart::Learned {
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
        let proposals = self.counting_rays(task, proposals)?;
        let is_uniform =
            lvc.proposal == ProposalKind::Uniform && lvc.mis_count != MisCount::Resampled;
        self.proposals = (!is_uniform).then_some(proposals);
        Ok(())
    }

    /// Connections with light vertices that are chosen by nothing, where somebody learns from them.
    fn explore(&mut self, task: Task<'_>, survey: &Survey, cells: &Cells) -> Result<Found, Late> {
        let LvcSettings {
            proposal,
            light_start,
            ..
        } = task.settings.lvc;
        if proposal == ProposalKind::Uniform && light_start == LightStart::Power {
            return Ok(Found::default());
        }
        let uniform = LightProposals::uniform(cells.clone(), &survey.pair_sums(cells, |_| 1.0));
        let (found, rays) = pilot::run(&self.probe(task, &uniform))?;
        self.count(self.learning.samples(), rays);
        Ok(found)
    }

    /// The proposals with counts of traced rays, where weights take these and not all are traced.
    fn counting_rays(
        &mut self,
        task: Task<'_>,
        proposals: LightProposals,
    ) -> Result<LightProposals, Late> {
        let settings = task.settings;
        let all_are_traced = settings.shadow_rays == ShadowRays::All;
        if settings.lvc.mis_count != MisCount::Resampled || all_are_traced {
            return Ok(proposals);
        }
        let probe = self.probe(task, &proposals);
        let (inclusion, rays) = rays::run(&probe, self.mean_luminance)?;
        self.count(self.learning.samples(), rays);
        Ok(proposals.counting_rays(&inclusion))
    }

    /// More samples, where `proposals` are all that is known.
    fn probe<'a>(&'a self, task: Task<'a>, proposals: &'a LightProposals) -> Probe<'a> {
        Probe {
            scene: task.scene,
            view: task.view,
            settings: task.settings,
            connections: Connections {
                proposals: Some(proposals),
                ..self.connections(task.settings.lvc)
            },
            is_late: task.is_late,
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

//! A short render before the first pass. It estimates the mean luminance of the image, from which shadow-ray roulette
//! sets its threshold; it learns about connections; and it chooses the plan of `auto`. All of it follows from the
//! samples of one [`Survey`].

mod blocks;
mod constants;
mod cost;
mod counts;
mod effort;
mod emission;
mod extent;
mod known;
mod learning;
mod log;
mod moments;
mod plan;
mod quads;
mod selection;
mod survey;
mod terms;
#[cfg(test)]
mod tests;
mod work;

pub use effort::Effort;
pub use plan::Plan;

use super::Settings;
use crate::film::FilmSettings;
use crate::guide::{Cells, Guide, LightProposals};
use crate::integrator::{IntegratorKind, LvcSettings, ProposalKind, group_size};
use crate::light::LightChoice;
use crate::path::SampleCounts;
use crate::scene::Scene;
use crate::stats::RayCounts;
use crate::view::View;
use constants::MOST_CACHED;
use counts::of_connections;
use learning::Lessons;
use survey::Survey;

/// The results of training: a pure function of scene, settings and the number of training samples. These have random
/// numbers of their own and never enter the film.
#[derive(Clone, Debug)]
pub struct Training {
    /// The mean luminance of the image, before sensor and exposure. Unit: W/(m² sr) of scene units.
    pub mean_luminance: f32,
    /// The mean number of vertices of a light subpath that camera vertices can be connected with.
    pub light_vertices: f64,
    /// The proposals of light vertices. None: they are not learned.
    pub proposals: Option<LightProposals>,
    /// The choice of the light that a light subpath begins on. None: it is not learned.
    pub light_start: Option<LightChoice>,
    /// The plan of `auto`. None: the integrator is another.
    pub plan: Option<Plan>,
    /// The number of samples of training.
    pub samples: u64,
    /// The rays of training.
    pub rays: RayCounts,
    /// True if its [`Effort`] allowed fewer samples than training needs.
    pub is_short: bool,
    /// The mean number of rays of a light subpath.
    subpath_rays: f64,
}

/// The scene, the view and the settings that training is for.
#[derive(Clone, Copy)]
struct TrainingInput<'a> {
    scene: &'a Scene,
    view: &'a View,
    settings: &'a Settings,
}

/// Returns the settings with everything decided that they leave open, and the training, if the estimator needs it.
/// None: the host asked to stop.
pub(super) fn prepare(
    scene: &Scene,
    view: &View,
    settings: Settings,
    effort: Effort<'_>,
) -> Option<(Settings, Option<Training>)> {
    let is_open = settings.integrator == IntegratorKind::Auto;
    if !is_open && !settings.needs_training() {
        return Some((settings, None));
    }
    let input = TrainingInput {
        scene,
        view,
        settings: &settings,
    };
    let survey = Survey::run(input, effort)?;
    let cells = survey.log.cells();
    let plan = is_open.then(|| Plan::best(input, &survey, &cells));
    let mut decided = plan.map_or_else(|| settings.clone(), |plan| plan.apply(&settings));
    let mut training = Training::new(&survey);
    training.learn(input, &decided, &survey, &cells);
    training.bound_cache(view.film(), &mut decided);
    training.plan = plan.map(|plan| Plan {
        samples_per_subpath: decided.lvc.samples_per_subpath,
        ..plan
    });
    Some((decided, Some(training)))
}

impl Settings {
    /// Returns true if the estimator needs training.
    fn needs_training(&self) -> bool {
        let needs_mean = self.integrator.has_candidates() && self.shadow_rays.needs_mean();
        needs_mean || self.integrator == IntegratorKind::Lvc
    }
}

impl Training {
    /// Returns training that has learned nothing yet.
    fn new(survey: &Survey) -> Self {
        Self {
            mean_luminance: (survey.luminance / survey.samples()) as f32,
            light_vertices: survey.light_vertices(),
            proposals: None,
            light_start: None,
            plan: None,
            samples: survey.stats.samples,
            rays: survey.stats.rays,
            is_short: survey.is_short,
            subpath_rays: survey.stats.rays.light as f64 / survey.samples(),
        }
    }

    /// Learns for the estimator of `settings`, if it learns and `survey` has enough samples.
    fn learn(
        &mut self,
        input: TrainingInput<'_>,
        settings: &Settings,
        survey: &Survey,
        cells: &Cells,
    ) {
        let Some(lessons) = Lessons::of(input, settings, survey, cells) else {
            return;
        };
        self.light_vertices = lessons.light_vertices;
        if settings.lvc.proposal == ProposalKind::Learned {
            self.proposals = Some(LightProposals::new(lessons.cells, &lessons.sums));
        }
        self.light_start = lessons.light_start;
    }

    /// Raises the number of samples per light subpath until the cache of a group has at most [`MOST_CACHED`] vertices
    /// on average. Each group keeps at least one subpath.
    fn bound_cache(&self, film: &FilmSettings, settings: &mut Settings) {
        if settings.integrator == IntegratorKind::Lvc {
            let pixels = film.crop.area();
            let size = group_size(pixels);
            let rays = size.min(pixels) as f64 * self.subpath_rays;
            let wanted = settings.lvc.samples_per_subpath;
            settings.lvc.samples_per_subpath = wanted.or_more(rays / MOST_CACHED).or_fewer(size);
        }
    }

    /// Returns the sample counts of the strategies of `lvc`, with `light_subpaths` subpaths in a pass.
    pub(super) fn counts(&self, settings: LvcSettings, light_subpaths: u64) -> SampleCounts {
        SampleCounts {
            connections: of_connections(settings.candidates, self.light_vertices),
            next_events: settings.next_events.get().map(f64::from),
            light_subpaths: light_subpaths as f64,
        }
    }

    /// Returns the knowledge that the estimator uses.
    pub(super) fn guide(&self) -> Guide<'_> {
        Guide {
            proposals: self.proposals.as_ref(),
            light_start: self.light_start.as_ref(),
        }
    }
}

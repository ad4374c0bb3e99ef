//! What each strategy of one method does in every scene: rendered apart from the records, once.
//!
//! Images of strategies take kilobytes for each pixel, and a page shows them small: a scene whose images
//! are larger than a tile is rendered at the size of one.

use super::error::ExperimentError;
use super::journal::Journal;
use super::names::file_name;
use super::run::{End, Event, Observer, Setup};
use super::stage::Stage;
use super::{Experiment, MethodSpec, PyramidSpec, SceneSpec};
use crate::pyramid::{self, Figures};
use crate::results::{Pyramid, StrategyInfo};
use bidir::driver::Session;
use bidir::film::Layers;
use bidir::integrator::IntegratorKind;
use formats::scene::Files;

type Result<T> = std::result::Result<T, ExperimentError>;

/// Renders what the journal has not, scene by scene. Nothing to do where none is wanted.
pub(super) fn complete(
    experiment: &Experiment,
    stages: &[Stage<'_>],
    setup: &Setup,
    journal: &mut Journal,
    observer: &mut dyn Observer,
) -> Result<End> {
    for work in works(experiment, stages, setup) {
        if journal.pyramids().iter().any(|found| work.is(found)) {
            continue;
        }
        let Some(found) = work.at_size_of_a_tile(observer)? else {
            return Ok(End::Stopped);
        };
        journal.add_pyramid(found)?;
    }
    Ok(End::Complete)
}

/// What was found of it so far; a journal may also have what was wanted before.
pub(super) fn found(
    experiment: &Experiment,
    stages: &[Stage<'_>],
    setup: &Setup,
    journal: &Journal,
) -> Vec<Pyramid> {
    let works = works(experiment, stages, setup);
    let found = works.filter_map(|work| journal.pyramids().iter().find(|found| work.is(found)));
    found.cloned().collect()
}

/// The names of the files with their images, relative to the folder of the results.
pub(super) fn files(experiment: &Experiment, stages: &[Stage<'_>]) -> Vec<String> {
    let Some((spec, _)) = wanted(experiment) else {
        return Vec::new();
    };
    let shown = stages.iter().filter(|stage| is_shown(spec, stage));
    shown.map(file).collect()
}

/// The name of the file with the images of a scene.
fn file(stage: &Stage<'_>) -> String {
    // No image of a method has this name: those have the budget between two `--`.
    format!("images/{}--strategies.exr", file_name(&stage.spec.name))
}

/// Refuses a method that is not bidirectional in one of the scenes.
pub(super) fn check(experiment: &Experiment, stages: &[Stage<'_>]) -> Result<()> {
    let Some((spec, method)) = wanted(experiment) else {
        return Ok(());
    };
    let is_other = |stage: &&Stage<'_>| {
        method.changes.apply(&stage.settings).integrator != IntegratorKind::Bdpt
    };
    let mut shown = stages.iter().filter(|stage| is_shown(spec, stage));
    match shown.find(is_other) {
        None => Ok(()),
        Some(stage) => Err(ExperimentError::Pyramid {
            scene: stage.spec.name.clone(),
            method: method.name.clone(),
        }),
    }
}

/// What is asked for, with its method.
fn wanted(experiment: &Experiment) -> Option<(&PyramidSpec, &MethodSpec)> {
    let spec = experiment.pyramid.as_ref()?;
    let mut methods = experiment.methods.iter();
    Some((spec, methods.find(|method| method.name == spec.method)?))
}

/// True for a scene whose strategies are shown.
fn is_shown(spec: &PyramidSpec, stage: &Stage<'_>) -> bool {
    spec.scenes.is_empty() || spec.scenes.contains(&stage.spec.name)
}

fn works<'a>(
    experiment: &'a Experiment,
    stages: &'a [Stage<'a>],
    setup: &'a Setup,
) -> impl Iterator<Item = Work<'a>> {
    let wanted = wanted(experiment);
    let works = wanted.map(move |(spec, method)| {
        let stages = stages.iter().filter(move |stage| is_shown(spec, stage));
        stages.map(move |stage| Work {
            experiment,
            setup,
            stage,
            spec,
            method,
        })
    });
    works.into_iter().flatten()
}

/// The strategies of a method in a scene.
#[derive(Clone, Copy)]
struct Work<'a> {
    experiment: &'a Experiment,
    setup: &'a Setup,
    stage: &'a Stage<'a>,
    spec: &'a PyramidSpec,
    method: &'a MethodSpec,
}

impl Work<'_> {
    /// True where this is what was found.
    fn is(&self, found: &Pyramid) -> bool {
        found.scene == self.stage.spec.name
            && found.method == self.method.name
            && found.seed == self.experiment.seeds.first
            && found.spp == self.spec.spp
    }

    /// Renders the scene, smaller where it is large. None: the observer stopped it.
    fn at_size_of_a_tile(&self, observer: &mut dyn Observer) -> Result<Option<Pyramid>> {
        let longest = self.stage.size()[0].max(self.stage.size()[1]);
        if longest <= pyramid::TILE {
            return self.render(observer);
        }
        let resolution = self.stage.scene.film().resolution;
        let small = |side: u32| (u64::from(side) * pyramid::TILE as u64 / longest as u64).max(1);
        let spec = SceneSpec {
            size: Some(resolution.map(|side| small(side) as u32)),
            ..self.stage.spec.clone()
        };
        let stage = Stage::load(self.experiment, &spec, &Files::default())?;
        Work {
            stage: &stage,
            ..*self
        }
        .render(observer)
    }

    fn render(&self, observer: &mut dyn Observer) -> Result<Option<Pyramid>> {
        let mut settings = self.method.changes.apply(&self.stage.settings);
        settings.seed = self.experiment.seeds.first;
        settings.layers = Layers::new(&[], &[], pyramid::VERTICES.into()).with_raw();
        let mut session = self.stage.session(settings, self.experiment.threads)?;
        for passes in 0..self.spec.spp {
            observer.tell(Event::Pyramid {
                scene: &self.stage.spec.name,
                passes,
                of: self.spec.spp,
            });
            if observer.should_stop() {
                return Ok(None);
            }
            session.step(&());
        }
        let images = file(self.stage);
        let film = session.film();
        let developed = pyramid::developed(film);
        developed.write_exr(&self.setup.folder.join(&images), film.settings(), &[])?;
        Ok(Some(self.told(&session, images)))
    }

    fn told(&self, session: &Session<'_>, images: String) -> Pyramid {
        let all = Figures::all(session);
        Pyramid {
            scene: self.stage.spec.name.clone(),
            method: self.method.name.clone(),
            seed: self.experiment.seeds.first,
            spp: self.spec.spp,
            size: self.stage.size(),
            vertices: pyramid::VERTICES,
            mean: pyramid::mean(session.film()),
            longer: pyramid::mean_of_longer(session.film()),
            strategies: all.iter().filter_map(strategy).collect(),
            images,
        }
    }
}

/// A strategy that has images.
fn strategy(figures: &Figures) -> Option<StrategyInfo> {
    let images = figures.images?;
    Some(StrategyInfo {
        s: figures.strategy.s,
        t: figures.strategy.t,
        mean: images.mean,
        raw_mean: images.raw_mean?,
        variance: images.variance.filter(|variance| variance.is_finite()),
        rays: figures.counts.traced,
        blocked: figures.counts.blocked,
        raw_dropped: images.raw_dropped,
    })
}

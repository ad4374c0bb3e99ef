//! Images of each strategy (s, t) of one method, rendered once in every scene, apart from the runs.
//!
//! Images of strategies take kilobytes per pixel, and the report shows them as small tiles. Therefore scenes with
//! larger images are rendered at the size of a tile.

use super::error::ExperimentError;
use super::journal::Journal;
use super::loaded_scene::LoadedScene;
use super::names::file_name;
use super::observer::{Event, Host, Observer};
use super::run_set::{End, Setup};
use super::{Experiment, MethodSpec, PyramidSpec, SceneSpec, is_in};
use crate::pyramid::{self, Figures};
use crate::results::{Pyramid, StrategyInfo};
use bidir::driver::{Budget, Session};
use bidir::film::Layers;
use formats::scene::Files;
use std::path::Path;

type Result<T> = std::result::Result<T, ExperimentError>;

/// Renders the pyramids that the journal lacks, scene by scene.
pub(super) fn complete(
    experiment: &Experiment,
    scenes: &[LoadedScene<'_>],
    setup: &Setup,
    journal: &mut Journal,
    observer: &mut dyn Observer,
) -> Result<End> {
    for run in runs(experiment, scenes) {
        if run.find(journal).is_some() {
            continue;
        }
        let Some(found) = run.render_tile(&setup.folder, observer)? else {
            return Ok(End::Stopped);
        };
        journal.add_pyramid(found)?;
    }
    Ok(End::Complete)
}

/// Returns the pyramids in the journal that the description asks for. The journal may also contain pyramids of
/// earlier versions of the description.
pub(super) fn found(
    experiment: &Experiment,
    scenes: &[LoadedScene<'_>],
    journal: &Journal,
) -> Vec<Pyramid> {
    let found = runs(experiment, scenes).filter_map(|run| run.find(journal));
    found.cloned().collect()
}

/// Returns the names of the files with their images, relative to the folder of the results.
pub(super) fn files(experiment: &Experiment, scenes: &[LoadedScene<'_>]) -> Vec<String> {
    runs(experiment, scenes).map(|run| run.file()).collect()
}

/// Refuses a method that is not bidirectional in one of the scenes.
pub(super) fn check(experiment: &Experiment, scenes: &[LoadedScene<'_>]) -> Result<()> {
    let mut runs = runs(experiment, scenes);
    runs.try_for_each(|run| run.scene.bidirectional(run.method, "strategies").map(drop))
}

/// Iterates over the scenes of the description's pyramid.
fn runs<'a>(
    experiment: &'a Experiment,
    scenes: &'a [LoadedScene<'a>],
) -> impl Iterator<Item = PyramidRun<'a>> {
    experiment.pyramid.iter().flat_map(move |spec| {
        let mut methods = experiment.methods.iter();
        let method = methods.find(|method| method.name == spec.method);
        let is_shown = |loaded: &&LoadedScene<'_>| is_in(&spec.scenes, &loaded.spec.name);
        let shown = scenes.iter().filter(is_shown);
        shown
            .zip(method.into_iter().cycle())
            .map(move |(scene, method)| PyramidRun {
                experiment,
                scene,
                spec,
                method,
            })
    })
}

/// A render of the strategies of a method in a scene.
#[derive(Clone, Copy)]
struct PyramidRun<'a> {
    experiment: &'a Experiment,
    scene: &'a LoadedScene<'a>,
    spec: &'a PyramidSpec,
    method: &'a MethodSpec,
}

impl PyramidRun<'_> {
    /// Returns the result of this render in the journal. None: there is none.
    fn find<'j>(&self, journal: &'j Journal) -> Option<&'j Pyramid> {
        journal.pyramids().iter().find(|found| {
            found.scene == self.scene.spec.name
                && found.method == self.method.name
                && found.seed == self.experiment.seeds.first
                && found.spp == self.spec.spp
        })
    }

    /// Returns the name of the file with the images.
    fn file(&self) -> String {
        // No image of a method has this name: those have the budget between two `--`.
        format!(
            "images/{}--strategies.exr",
            file_name(&self.scene.spec.name)
        )
    }

    /// Renders the scene at most at the size of a tile. None: the observer stopped it.
    fn render_tile(&self, folder: &Path, observer: &mut dyn Observer) -> Result<Option<Pyramid>> {
        let longest = self.scene.size()[0].max(self.scene.size()[1]);
        if longest <= pyramid::TILE {
            return self.render(folder, observer);
        }
        let resolution = self.scene.subject.view.film().resolution;
        let small = |side: u32| (u64::from(side) * pyramid::TILE as u64 / longest as u64).max(1);
        let spec = SceneSpec {
            size: Some(resolution.map(|side| small(side) as u32)),
            ..self.scene.spec.clone()
        };
        let loaded = LoadedScene::load(self.experiment, &spec, &Files::default())?;
        PyramidRun {
            scene: &loaded,
            ..*self
        }
        .render(folder, observer)
    }

    fn render(&self, folder: &Path, observer: &mut dyn Observer) -> Result<Option<Pyramid>> {
        let mut settings = self.method.request.apply(&self.scene.settings);
        settings.seed = self.experiment.seeds.first;
        settings.layers = Layers::new(&[], &[], pyramid::VERTICES.into()).with_raw();
        let (scene, of) = (&*self.scene.spec.name, self.spec.spp);
        let event = |passes| (passes < of).then_some(Event::Pyramid { scene, passes, of });
        let area = self.scene.subject.view.film().crop.area();
        let host = Host::telling(observer, area, &event);
        let begun = self
            .scene
            .begin(&settings, self.experiment.threads, &host)?;
        let Some(mut render) = begun else {
            return Ok(None);
        };
        let budget = Budget {
            passes: Some(of),
            ..Budget::default()
        };
        if render.run(&budget, &host, &mut |_| true).is_none() {
            return Ok(None);
        }
        let images = self.file();
        let film = render.session.film();
        let developed = pyramid::developed(film);
        developed.write_exr(&folder.join(&images), film.settings(), &[])?;
        Ok(Some(self.summary(&render.session, images)))
    }

    fn summary(&self, session: &Session<'_>, images: String) -> Pyramid {
        let all = Figures::all(session);
        Pyramid {
            scene: self.scene.spec.name.clone(),
            method: self.method.name.clone(),
            seed: self.experiment.seeds.first,
            spp: self.spec.spp,
            size: self.scene.size(),
            vertices: pyramid::VERTICES,
            mean: pyramid::mean(session.film()),
            longer: pyramid::mean_of_longer(session.film()),
            strategies: all.iter().filter_map(strategy).collect(),
            images,
        }
    }
}

/// Converts the figures of a strategy to an entry of the results. None: the strategy has no images.
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

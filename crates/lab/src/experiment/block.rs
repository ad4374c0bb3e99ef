//! Parts of an experiment, for several machines.
//!
//! Who has machines calls [`prepare`], which makes references and images of strategies where they are
//! not there yet; has every [`Block`] rendered by [`render_block`] somewhere; gives what comes back, in
//! any order, to [`Prepared::add`]; and calls [`run`](super::run()) at the end, which then finds all
//! records there. All machines have to be alike, as times are compared.

use super::error::ExperimentError;
use super::journal::{Journal, RecordsKey};
use super::loaded_scene::{LoadedScene, Reference};
use super::observer::Observer;
use super::run::{Run, write_image};
use super::run_set::{Begun, End, Ready, RunSet, Setup, begin};
use super::{Experiment, pyramid, reference};
use crate::image::Pixels;
use crate::results::Record;
use formats::scene::Files;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

type Result<T> = std::result::Result<T, ExperimentError>;

/// Some methods under one seed in one scene and with one budget. What is compared is rendered on one
/// machine.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Block {
    /// The name of the scene.
    pub scene: String,
    /// The name of the budget.
    pub budget: String,
    /// The seed.
    pub seed: u64,
    /// The names of the methods that have no record yet.
    pub methods: Vec<String>,
}

/// A scene of an experiment that is ready.
#[derive(Clone, Debug, PartialEq)]
pub struct PreparedScene {
    /// Its name.
    pub name: String,
    /// Its file.
    pub path: PathBuf,
    /// All files that were read for it.
    pub files: Vec<PathBuf>,
    /// What its images are compared with.
    pub reference: Pixels,
}

/// An experiment that has its references.
#[derive(Debug)]
pub struct Prepared {
    /// The scenes.
    pub scenes: Vec<PreparedScene>,
    /// What has no record yet.
    pub blocks: Vec<Block>,
    key: RecordsKey,
    folder: PathBuf,
}

/// A render with its image, if one is kept.
#[derive(Clone, Debug)]
pub struct Done {
    /// The record.
    pub record: Record,
    /// The image of the first seed.
    pub image: Option<Pixels>,
}

/// Makes everything but records. None: the observer stopped it.
pub fn prepare(
    experiment: &Experiment,
    setup: &Setup,
    observer: &mut dyn Observer,
) -> Result<Option<Prepared>> {
    let Begun { scenes, given, key } = begin(experiment, setup, observer)?;
    let mut journal = Journal::start(setup, &key, observer)?;
    let Some(ready) = reference::obtain_all(experiment, scenes, given, setup, observer)? else {
        return Ok(None);
    };
    let Ready {
        scenes, references, ..
    } = ready;
    if pyramid::complete(experiment, &scenes, setup, &mut journal, observer)? == End::Stopped {
        return Ok(None);
    }
    let run_set = RunSet {
        experiment,
        setup,
        scenes: &scenes,
        references: &references,
    };
    let blocks = blocks(&run_set, &journal);
    let scenes = scenes.iter().zip(references);
    let scenes = scenes.map(|(loaded, reference)| PreparedScene {
        name: loaded.spec.name.clone(),
        path: loaded.spec.path.clone(),
        files: loaded.shared_files(),
        reference: reference.pixels,
    });
    Ok(Some(Prepared {
        scenes: scenes.collect(),
        blocks,
        key,
        folder: setup.folder.clone(),
    }))
}

/// What has no record, in order.
fn blocks(run_set: &RunSet<'_>, journal: &Journal) -> Vec<Block> {
    let mut blocks: Vec<Block> = Vec::new();
    for (run, _) in run_set.runs().filter(|(run, _)| !journal.has(run)) {
        let block = Block {
            scene: run.scene.spec.name.clone(),
            budget: run.budget.name.clone(),
            seed: run.seed,
            methods: vec![run.method.name.clone()],
        };
        match blocks.last_mut() {
            Some(last) if last.is_beside(&block) => last.methods.extend(block.methods),
            _ => blocks.push(block),
        }
    }
    blocks
}

impl Block {
    /// Whether both differ in their methods alone.
    fn is_beside(&self, other: &Self) -> bool {
        let of = |block: &Self| (block.scene.clone(), block.budget.clone(), block.seed);
        of(self) == of(other)
    }
}

impl Prepared {
    /// Adds what was rendered; a record that is there already stays.
    ///
    /// Errors: the folder has records of another experiment by now, or cannot be written.
    pub fn add(&self, done: Vec<Done>) -> Result<()> {
        let mut journal = Journal::open(&self.folder, &self.key)?;
        for Done { record, image } in done {
            if let (Some(name), Some(pixels)) = (&record.image, &image) {
                write_image(&self.folder.join(name), pixels)?;
            }
            if !journal.has_like(&record) {
                journal.add(record)?;
            }
        }
        Ok(())
    }
}

/// Renders a block, whose scene has its files in `files`. None: the observer stopped it.
///
/// Errors: the experiment has no such scene, budget or method; those of its renders.
pub fn render_block(
    experiment: &Experiment,
    block: &Block,
    files: &Files,
    reference: &Pixels,
    observer: &mut dyn Observer,
) -> Result<Option<Vec<Done>>> {
    let missing = || ExperimentError::Mismatch(PathBuf::from(&block.scene));
    let mut scenes = experiment.scenes.iter();
    let spec = scenes
        .find(|spec| spec.name == block.scene)
        .ok_or_else(missing)?;
    let mut budgets = experiment.budgets.iter();
    let budget = budgets
        .find(|budget| budget.name == block.budget)
        .ok_or_else(missing)?;
    let loaded = LoadedScene::load(experiment, spec, files)?;
    let reference = Reference {
        pixels: reference.clone(),
        words: String::new(),
        image: None,
        mse: None,
        warning: None,
    };
    let mut all = Vec::new();
    for name in &block.methods {
        let mut methods = experiment.methods.iter();
        let run = Run {
            scene: &loaded,
            method: methods
                .find(|method| method.name == *name)
                .ok_or_else(missing)?,
            budget,
            seed: block.seed,
        };
        let Some(rendered) = run.render(experiment.threads, observer)? else {
            return Ok(None);
        };
        let mut record = run.record(&rendered, &reference, &experiment.metrics);
        let is_first = block.seed == experiment.seeds.first;
        record.image = is_first.then(|| run.image());
        let image = is_first.then(|| rendered.pixels());
        all.push(Done { record, image });
    }
    Ok(Some(all))
}

#[cfg(test)]
mod tests;

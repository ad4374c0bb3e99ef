//! Parts of an experiment, for several machines.
//!
//! The host calls [`prepare`], which renders missing references and images of strategies; has every
//! [`Block`] rendered by [`render_block`] on some machine; passes the results, in any order, to
//! [`Prepared::add`]; and at the end calls [`run`](super::run()), which then finds all records. All machines
//! have to be alike, since times are compared.

use super::Experiment;
use super::error::ExperimentError;
use super::journal::{Journal, RecordsKey};
use super::loaded_scene::LoadedScene;
use super::observer::Observer;
use super::run::{Done, Run};
use super::run_set::{End, RunSet, Setup, Started, start};
use crate::image::Pixels;
use formats::scene::Files;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

type Result<T> = std::result::Result<T, ExperimentError>;

/// Runs of several methods in one scene with the same budget and seed. They are compared with each other, so
/// one machine renders all of them.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Block {
    /// The name of the scene.
    pub scene: String,
    /// The name of the budget.
    pub budget: String,
    /// The seed.
    pub seed: u64,
    /// The names of the methods without a record.
    pub methods: Vec<String>,
}

/// A scene of an experiment with its reference.
#[derive(Clone, Debug, PartialEq)]
pub struct PreparedScene {
    /// The name of the scene.
    pub name: String,
    /// The scene file.
    pub path: PathBuf,
    /// All files read for the scene.
    pub files: Vec<PathBuf>,
    /// The reference of its images.
    pub reference: Pixels,
}

/// An experiment with complete references.
#[derive(Debug)]
pub struct Prepared {
    /// The scenes.
    pub scenes: Vec<PreparedScene>,
    /// The runs without a record.
    pub blocks: Vec<Block>,
    key: RecordsKey,
    folder: PathBuf,
}

/// Renders everything except the runs. None: the observer stopped it.
pub fn prepare(
    experiment: &Experiment,
    setup: &Setup,
    observer: &mut dyn Observer,
) -> Result<Option<Prepared>> {
    let started = start(experiment, setup, observer)?;
    let is_complete = |started: &Started<'_>| started.end == End::Complete;
    let Some(started) = started.filter(is_complete) else {
        return Ok(None);
    };
    let run_set = started.run_set;
    let blocks = blocks(&run_set, &started.journal);
    let pairs = run_set.scenes.iter().zip(run_set.references);
    let scenes = pairs.map(|(loaded, reference)| PreparedScene {
        name: loaded.spec.name.clone(),
        path: loaded.spec.path.clone(),
        files: loaded.shared_files(),
        reference: reference.pixels,
    });
    Ok(Some(Prepared {
        scenes: scenes.collect(),
        blocks,
        key: started.key,
        folder: setup.folder.clone(),
    }))
}

/// Groups the runs without a record into blocks, in order.
fn blocks(run_set: &RunSet<'_>, journal: &Journal) -> Vec<Block> {
    let mut blocks: Vec<Block> = Vec::new();
    for (run, _) in run_set.runs().filter(|(run, _)| !journal.has(run.id())) {
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
    /// Returns true if both differ only in their methods.
    fn is_beside(&self, other: &Self) -> bool {
        let of = |block: &Self| (block.scene.clone(), block.budget.clone(), block.seed);
        of(self) == of(other)
    }
}

impl Prepared {
    /// Adds finished runs; existing records stay.
    ///
    /// Errors: the folder meanwhile has records of another experiment, or cannot be written.
    pub fn add(&self, done: Vec<Done>) -> Result<()> {
        let mut journal = Journal::open(&self.folder, &self.key)?;
        done.into_iter().try_for_each(|done| journal.add(done))
    }
}

/// Renders a block, whose scene files come from `files`. None: the observer stopped it.
///
/// Errors: the experiment has no such scene, budget or method; a render fails.
pub fn render_block(
    experiment: &Experiment,
    block: &Block,
    files: &Files,
    reference: &Pixels,
    observer: &mut dyn Observer,
) -> Result<Option<Vec<Done>>> {
    let missing = || ExperimentError::Mismatch(PathBuf::from(&block.scene));
    let mut scenes = experiment.scenes.iter();
    let spec = scenes.find(|spec| spec.name == block.scene);
    let mut budgets = experiment.budgets.iter();
    let budget = budgets.find(|budget| budget.name == block.budget);
    let (spec, budget) = spec.zip(budget).ok_or_else(missing)?;
    let loaded = LoadedScene::load(experiment, spec, files)?;
    let mut all = Vec::new();
    for name in &block.methods {
        let mut methods = experiment.methods.iter();
        let method = methods.find(|method| method.name == *name);
        let run = Run {
            experiment,
            scene: &loaded,
            method: method.ok_or_else(missing)?,
            budget,
            seed: block.seed,
        };
        let Some(done) = run.render(reference, observer)? else {
            return Ok(None);
        };
        all.push(done);
    }
    Ok(Some(all))
}

#[cfg(test)]
mod tests;

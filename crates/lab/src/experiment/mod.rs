//! An experiment: scenes × methods × budgets × seeds, each rendered and compared with a reference.
//!
//! - [`Experiment`]: the description, from TOML by [`Experiment::read`] or made by hand.
//! - [`run()`]: renders what no record has yet, and gives [`Results`](crate::results::Results).
//! - [`claims`]: statements about the records with their verdicts, and tables.
//! - [`analysis`]: the usual tables and plots of records.
//! - [`BUILTIN`]: descriptions that the program contains.
//!
//! # The folder of the results
//!
//! | file | is |
//! |---|---|
//! | `records.ndjson` | whose records these are and of which machine, and a record per line; replaced after each render |
//! | `results.json` | [`Results`](crate::results::Results), written at the end and when stopped |
//! | `images/` | the pictures of the first seed, EXR; contact sheets of strategies, PNG |
//! | `references/` | references that were made here |
//!
//! # Budgets
//!
//! With c the cost so far, that of training included, and r̄ the mean cost of a pass, without it, a render
//! goes on
//!
//! - to equal *samples* n: while there are fewer than n passes;
//! - to equal *rays* R: while c + r̄ is nearer to R than c is. Rays are functions of scene, settings and
//!   seed, so that the number of passes is;
//! - for equal *time* T: while c + r̄ ≤ T. Only training and passes are timed.
//!
//! There is always a first pass. As a number of passes that depends on the passes is slightly
//! correlated with them, rays and time have a bias of the order 1 / passes.
//!
//! # Strategies
//!
//! Where [`Experiment::pyramid`] names a method, its strategies are rendered once in each scene, after
//! the references and before all records, and are kept with these. No time of a record has any part
//! of it. Records do not depend on it: it can be asked for later, and is then rendered alone.
//!
//! # Order
//!
//! Seeds are outermost, then scenes, budgets, methods: where a shared machine gets slower with the
//! hours, all methods do. A seed is the same for all methods, whose records are paired by it.

pub mod analysis;
mod block;
mod builtin;

pub mod claims;
pub mod contributions;
mod description;
mod error;
mod expand;
mod extent;
mod identity;
mod journal;
#[cfg(test)]
mod keys;
mod loaded_scene;
mod names;
mod observer;
mod outputs;
mod page;
mod pyramid;
mod reader;
mod reference;
mod room;
mod run;
mod run_set;
mod settings;

pub use block::{Block, Done, Prepared, PreparedScene, prepare, render_block};
pub use builtin::{BUILTIN, Builtin};
pub use error::{ExperimentError, Fault, Place};
pub use extent::{Extent, Quick};
pub use observer::{Event, Observer};
pub use outputs::check_description;
pub use page::{PAGE, write_page};
pub use room::{Lamp, Room};
pub use run_set::{End, Outcome, Setup, Start, run};
pub use settings::{names, texts};

use crate::metric::Metric;
use crate::results::BudgetKind;
use bidir::integrator::IntegratorKind;
use bidir::settings::Request;
use claims::{ClaimSpec, TableSpec};
use contributions::ContributionsSpec;
use formats::scene::Files;
use std::path::PathBuf;

/// What is compared.
#[derive(Clone, Debug, PartialEq)]
pub struct Experiment {
    /// What it is about.
    pub title: String,
    /// A few sentences on what is compared and why.
    pub description: String,
    /// Width and height of all images, instead of the scenes'. Unit: pixels.
    pub size: Option<[u32; 2]>,
    /// Seeds; there is at least one.
    pub seeds: Seeds,
    /// Threads of each render; 0 is one per processor.
    pub threads: usize,
    /// Metrics of each image beside the root mean square error.
    pub metrics: Vec<Metric>,
    /// The scenes.
    pub scenes: Vec<SceneSpec>,
    /// Optional scenes that are not there.
    pub absent: Vec<Absent>,
    /// The methods, of which ratios are relative to the first; there is at least one.
    pub methods: Vec<MethodSpec>,
    /// The budgets; there is at least one.
    pub budgets: Vec<BudgetSpec>,
    /// The method whose strategies are shown. None: none.
    pub pyramid: Option<PyramidSpec>,
    /// The methods whose contributions are measured. None: none.
    pub contributions: Option<ContributionsSpec>,
    /// Statements about the records; records do not depend on them.
    pub claims: Vec<ClaimSpec>,
    /// Tables of the records, instead of the usual ones if there are any.
    pub tables: Vec<TableSpec>,
    /// The extent of a quick run.
    pub quick: Quick,
}

/// An optional scene that is left out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Absent {
    /// Its name.
    pub name: String,
    /// The reason, in words.
    pub reason: String,
}

/// The method each of whose strategies is shown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PyramidSpec {
    /// The name of the method, which is bidirectional.
    pub method: String,
    /// Samples per pixel, under the first seed. Range: from 2 on, so that there is a variance.
    pub spp: u64,
    /// The names of the scenes; empty: all.
    pub scenes: Vec<String>,
}

/// Successive seeds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seeds {
    /// The first.
    pub first: u64,
    /// How many.
    pub count: u64,
}

/// A scene of an experiment.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneSpec {
    /// Its name, unlike all others also as part of a file's name.
    pub name: String,
    /// The file, as messages and results call it.
    pub file: String,
    /// Where the file is.
    pub path: PathBuf,
    /// Where files are looked for: on the disk, or in memory.
    pub files: Files,
    /// Width and height of its images, instead of those of the experiment or of the scene.
    pub size: Option<[u32; 2]>,
    /// What its images are compared with.
    pub reference: ReferenceSpec,
    /// Whether it may be left out.
    pub presence: Presence,
    /// The place in the description that names the file. None: no description names it.
    pub file_place: Option<Place>,
    /// The place in the description that names an existing reference. None: it names none.
    pub reference_place: Option<Place>,
}

/// Whether a scene may be left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Presence {
    /// Without it there is an error.
    Required,
    /// It is left out, with a warning, where its file is not there or its reference is contradicted.
    Optional,
}

/// What images are compared with.
#[derive(Clone, Debug, PartialEq)]
pub enum ReferenceSpec {
    /// The folder of a [reference](mod@crate::reference) that is there, or an image; its pixels are finite.
    /// It is what its pixels are: another folder with the same ones makes no other experiment.
    There(PathBuf),
    /// The reference of the scene of this name, which has the same light.
    Of(String),
    /// A reference that is made first, and kept in the folder of the results: by `bdpt` that traces
    /// every connection, with a witness; where they disagree, nothing is compared with it.
    Make {
        /// Samples per pixel.
        spp: u64,
        /// Settings on which the expectation depends, such as the strategies that take part.
        request: Box<Request>,
        /// The estimator of the witness. None: path tracing, which shares least with the other, but for
        /// references without some strategies.
        cross_check: Option<IntegratorKind>,
    },
}

/// A method: how scenes are rendered.
#[derive(Clone, Debug, PartialEq)]
pub struct MethodSpec {
    /// Its name, unlike all others.
    pub name: String,
    /// Its settings, over those of the scene.
    pub request: Request,
    /// The names of the scenes in which it is rendered; empty: all.
    pub scenes: Vec<String>,
}

/// The amounts that are equal for all methods.
#[derive(Clone, Debug, PartialEq)]
pub struct BudgetSpec {
    /// Its name, unlike all others.
    pub name: String,
    /// What is counted.
    pub kind: BudgetKind,
    /// How much of it: samples per pixel, rays per pixel, or seconds. Range: above 0.
    pub amount: f64,
    /// The amount that training is weighed by: that of a run which is not quick.
    pub full: f64,
    /// The names of the methods that are rendered under it; empty: all.
    pub methods: Vec<String>,
    /// The names of the scenes that are rendered under it; empty: all.
    pub scenes: Vec<String>,
}

impl BudgetSpec {
    /// A budget of all methods and scenes, whose name is its amount, such as `64 spp`.
    pub fn new(kind: BudgetKind, amount: f64) -> Self {
        let unit = match kind {
            BudgetKind::Samples => "spp",
            BudgetKind::Rays => "rays per pixel",
            BudgetKind::Seconds => "s",
        };
        Self {
            name: format!("{amount} {unit}"),
            kind,
            amount,
            full: amount,
            methods: Vec::new(),
            scenes: Vec::new(),
        }
    }
}

/// True where a list of names has this one, or is empty.
fn is_in(names: &[String], name: &str) -> bool {
    names.is_empty() || names.iter().any(|known| known == name)
}

impl Experiment {
    /// What is rendered in a scene: each budget with its methods.
    pub fn renders<'a>(
        &'a self,
        scene: &'a str,
    ) -> impl Iterator<Item = (&'a BudgetSpec, &'a MethodSpec)> {
        let budgets = self.budgets.iter();
        let budgets = budgets.filter(move |budget| is_in(&budget.scenes, scene));
        budgets.flat_map(move |budget| {
            let methods = self.methods.iter().filter(move |method| {
                is_in(&method.scenes, scene) && is_in(&budget.methods, &method.name)
            });
            methods.map(move |method| (budget, method))
        })
    }

    /// The methods that are rendered in a scene.
    pub(crate) fn methods_in<'a>(&'a self, scene: &'a str) -> impl Iterator<Item = &'a MethodSpec> {
        let is_used = move |method: &&MethodSpec| {
            let mut renders = self.renders(scene);
            renders.any(|(_, other)| other.name == method.name)
        };
        self.methods.iter().filter(is_used)
    }

    /// The number of renders, without those of references.
    pub fn run_count(&self) -> usize {
        let scenes = self.scenes.iter();
        let renders: usize = scenes.map(|scene| self.renders(&scene.name).count()).sum();
        self.seeds.count as usize * renders
    }
}

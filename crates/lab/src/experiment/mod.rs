//! An experiment: scenes × methods × budgets × seeds, each rendered and compared with a reference.
//!
//! - [`Experiment`]: the description, from TOML by [`Experiment::read`] or made by hand.
//! - [`run()`]: renders what no record has yet, and gives [`Results`](crate::results::Results).
//! - [`analysis`]: what the records say, as tables and plots.
//!
//! # The folder of the results
//!
//! | file | is |
//! |---|---|
//! | `records.ndjson` | whose records these are and of which machine, and a record per line; replaced after each render |
//! | `results.json` | [`Results`](crate::results::Results), written at the end and when stopped |
//! | `images/` | the pictures of the first seed, and of strategies, EXR |
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
mod cell;
mod description;
mod error;
mod identity;
mod journal;
#[cfg(test)]
mod keys;
mod names;
mod outputs;
mod page;
mod pyramid;
mod reader;
mod reference;
mod run;
mod settings;
mod stage;

pub use block::{Block, Done, Prepared, PreparedScene, prepare, render_block};
pub use error::{ExperimentError, Fault, Place};
pub(crate) use journal::claim;
pub use outputs::check_description;
pub use page::{PAGE, write_page};
pub use run::{End, Event, Observer, Outcome, Setup, Start, run, write_results};
pub use settings::{names, texts};

use crate::metric::Metric;
use crate::results::BudgetKind;
use bidir::integrator::IntegratorKind;
use bidir::settings::Request;
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
    /// What is computed of each image beside the root mean square error.
    pub metrics: Vec<Metric>,
    /// The scenes; there is at least one.
    pub scenes: Vec<SceneSpec>,
    /// The methods, of which ratios are relative to the first; there is at least one.
    pub methods: Vec<MethodSpec>,
    /// The budgets; there is at least one.
    pub budgets: Vec<BudgetSpec>,
    /// What is shown of strategies. None: nothing.
    pub pyramid: Option<PyramidSpec>,
}

/// Of which method each strategy is shown, in every scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PyramidSpec {
    /// The name of the method, which is bidirectional.
    pub method: String,
    /// Samples per pixel, under the first seed. Range: from 2 on, so that there is a variance.
    pub spp: u64,
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
    /// Width and height of its images, instead of those of the experiment or of the scene.
    pub size: Option<[u32; 2]>,
    /// What its images are compared with.
    pub reference: ReferenceSpec,
    /// Where a description names the file, and the reference that is there. None: it does not.
    pub places: [Option<Place>; 2],
}

/// What images are compared with.
#[derive(Clone, Debug, PartialEq)]
pub enum ReferenceSpec {
    /// The folder of a [reference](mod@crate::reference) that is there, or an image; its pixels are finite.
    /// It is what its pixels are: another folder with the same ones makes no other experiment.
    There(PathBuf),
    /// A reference that is made first, and kept in the folder of the results: by `bdpt` that traces
    /// every connection, with a witness; where they disagree, nothing is compared with it.
    Make {
        /// Samples per pixel.
        spp: u64,
        /// Settings on which the expectation depends, such as the strategies that take part.
        changes: Box<Request>,
        /// The estimator of the witness. None: path tracing, which shares least with the other, but for
        /// references without some strategies.
        witness: Option<IntegratorKind>,
    },
}

/// A method: how scenes are rendered.
#[derive(Clone, Debug, PartialEq)]
pub struct MethodSpec {
    /// Its name, unlike all others.
    pub name: String,
    /// What it wants otherwise than the scene.
    pub changes: Request,
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
    /// The names of the methods that are rendered under it; empty: of all.
    pub methods: Vec<String>,
}

impl BudgetSpec {
    /// A budget of all methods, with the name that tells it, such as `64 spp`.
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
            methods: Vec::new(),
        }
    }

    /// True where the method is rendered under it.
    pub fn is_of(&self, method: &MethodSpec) -> bool {
        self.methods.is_empty() || self.methods.contains(&method.name)
    }
}

impl Experiment {
    /// How many renders there are, but those of references.
    pub fn cells(&self) -> usize {
        let methods = |budget: &BudgetSpec| {
            let methods = self.methods.iter();
            methods.filter(|method| budget.is_of(method)).count()
        };
        let pairs: usize = self.budgets.iter().map(methods).sum();
        self.seeds.count as usize * self.scenes.len() * pairs
    }

    /// The same in little time, to see whether it works: at most three seeds, sizes of at most 64
    /// pixels, an eighth of the samples of budgets, references and pyramids.
    #[must_use]
    pub fn quick(mut self) -> Self {
        self.seeds.count = self.seeds.count.min(3);
        for scene in &mut self.scenes {
            let size = scene.size.or(self.size);
            match &mut scene.reference {
                // An image that is there has the size that it has.
                ReferenceSpec::There(_) => scene.size = size,
                ReferenceSpec::Make { spp, .. } => {
                    scene.size = Some(small(size.unwrap_or([64, 48])));
                    *spp = spp.div_ceil(8);
                }
            }
        }
        self.size = None;
        let budgets = self.budgets.iter().map(|budget| {
            let amount = budget.amount / 8.0;
            let is_whole = budget.kind == BudgetKind::Samples;
            let amount = if is_whole { amount.ceil() } else { amount };
            BudgetSpec {
                methods: budget.methods.clone(),
                ..BudgetSpec::new(budget.kind, amount)
            }
        });
        let mut all: Vec<BudgetSpec> = Vec::new();
        for budget in budgets {
            if !all.contains(&budget) {
                all.push(budget);
            }
        }
        self.budgets = all;
        if let Some(pyramid) = &mut self.pyramid {
            pyramid.spp = pyramid.spp.div_ceil(8).max(2);
        }
        self
    }
}

/// A size of the same shape, of at most 64 pixels.
fn small(size: [u32; 2]) -> [u32; 2] {
    let shrink = size[0].max(size[1]).div_ceil(64).max(1);
    size.map(|side| (side / shrink).max(1))
}

//! An experiment: scenes × methods × budgets × seeds, each rendered and compared with a reference.
//!
//! - [`Experiment`]: the description, from TOML by [`Experiment::read`] or made by hand.
//! - [`run()`]: renders every run without a record, and returns [`Results`](crate::results::Results).
//! - [`claims`]: statements about the records with their verdicts, and tables.
//! - [`analysis`]: the default tables and plots of records.
//! - [`BUILTIN`]: descriptions built into the program.
//!
//! # The folder of the results
//!
//! | file | content |
//! |---|---|
//! | `records.ndjson` | experiment, program and machine in the first line, then a record per line; replaced after each run |
//! | `results.json` | [`Results`](crate::results::Results), written at the end and when stopped |
//! | `images/` | the images of the first seed and those of strategies, EXR |
//! | `references/` | references made for this experiment |
//!
//! # Budgets
//!
//! Let c be the cost so far, including training, and r̄ the mean cost of a pass, without training. A run
//! continues
//!
//! - with equal *samples* n: while it has fewer than n passes;
//! - with equal *rays* R: while c + r̄ is nearer to R than c is. The number of passes is a function of scene,
//!   settings and seed, as the rays are;
//! - with equal *time* T: while c + r̄ ≤ T. Only training and passes are timed.
//!
//! Every run has at least one pass. With rays and time, the number of passes is slightly correlated with
//! their values, which causes a bias of the order 1 / passes.
//!
//! # Strategies
//!
//! If [`Experiment::pyramid`] names a method, its strategies are rendered once in each scene, after the
//! references and before all runs, and are stored with the records. Records and their times do not depend on
//! it: if it is added to a description later, only the strategies are rendered.
//!
//! # Order
//!
//! Seeds are the outermost loop, then scenes, budgets, methods: if a shared machine becomes slower over the
//! hours, this affects all methods alike. All methods use the same seeds, which pair their records.

pub mod analysis;
mod block;
mod builtin;
mod check;
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
mod machine;
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

pub use block::{Block, Prepared, PreparedScene, prepare, render_block};
pub use builtin::{BUILTIN, Builtin};
pub use error::{ExperimentError, Fault, Place};
pub use extent::{Extent, Quick};
pub use observer::{Event, Observer};
pub use outputs::check_description;
pub use page::{PAGE, write_page};
pub use room::{Lamp, Room};
pub use run::Done;
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

/// The description of an experiment.
#[derive(Clone, Debug, PartialEq)]
pub struct Experiment {
    /// The title.
    pub title: String,
    /// A few sentences on the comparison and its purpose.
    pub description: String,
    /// Width and height of all images, instead of the scenes'. Unit: pixels.
    pub size: Option<[u32; 2]>,
    /// The seeds, at least one.
    pub seeds: Seeds,
    /// Threads of each render; 0 means one per processor.
    pub threads: usize,
    /// Metrics of each image in addition to the root mean square error.
    pub metrics: Vec<Metric>,
    /// The scenes.
    pub scenes: Vec<SceneSpec>,
    /// Missing optional scenes.
    pub absent: Vec<Absent>,
    /// The methods, at least one; ratios are relative to the first.
    pub methods: Vec<MethodSpec>,
    /// The budgets, at least one.
    pub budgets: Vec<BudgetSpec>,
    /// The method whose strategies are rendered. None: no method.
    pub pyramid: Option<PyramidSpec>,
    /// The methods whose contributions are measured. None: no method.
    pub contributions: Option<ContributionsSpec>,
    /// Statements about the records; records do not depend on them.
    pub claims: Vec<ClaimSpec>,
    /// Tables of the records; if empty, the default tables are shown.
    pub tables: Vec<TableSpec>,
    /// The extent of a quick run.
    pub quick: Quick,
}

/// An omitted optional scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Absent {
    /// Its name.
    pub name: String,
    /// The reason, in words.
    pub reason: String,
}

/// The method whose strategies are rendered one by one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PyramidSpec {
    /// The name of the method; its integrator is `bdpt`.
    pub method: String,
    /// Samples per pixel, under the first seed. Range: at least 2, for the variance.
    pub spp: u64,
    /// The names of the scenes; empty: all.
    pub scenes: Vec<String>,
}

/// Successive seeds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seeds {
    /// The first seed.
    pub first: u64,
    /// The number of seeds.
    pub count: u64,
}

/// A scene of an experiment.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneSpec {
    /// The name, unique also as part of a file name.
    pub name: String,
    /// The file, as messages and results name it.
    pub file: String,
    /// The path of the file.
    pub path: PathBuf,
    /// The source of the scene's files.
    pub source: SceneSource,
    /// Width and height of the scene's images. None: the experiment or the scene file gives them.
    pub size: Option<[u32; 2]>,
    /// The reference of the scene's images.
    pub reference: ReferenceSpec,
    /// True: the scene is left out, with a warning, if its file is missing or its reference is contradicted. False:
    /// that is an error.
    pub optional: bool,
    /// The place in the description that names the file. None: no description names it.
    pub file_place: Option<Place>,
    /// The place in the description that names an existing reference. None: it names none.
    pub reference_place: Option<Place>,
}

/// The source of a scene's files.
#[derive(Clone, Debug, PartialEq)]
pub enum SceneSource {
    /// The disk.
    Disk,
    /// Memory.
    Memory(Files),
    /// A generated room, which is made when the scene is loaded.
    Room(Room),
}

/// The reference of a scene.
#[derive(Clone, Debug, PartialEq)]
pub enum ReferenceSpec {
    /// An existing [reference](mod@crate::reference) folder, or an image with finite pixels. Only its pixels
    /// identify it: another folder with the same pixels gives the same experiment.
    Existing(PathBuf),
    /// The reference of the scene with this name, which has the same light.
    Of(String),
    /// A reference that is rendered first and kept in the folder of the results: by `bdpt`, which traces
    /// every connection, and a cross-check by another estimator. If they disagree, it is not used.
    Make(ReferenceRecipe),
}

/// The settings of a reference that is rendered.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceRecipe {
    /// Samples per pixel.
    pub spp: u64,
    /// Settings on which the expectation depends, such as the strategies that take part.
    pub request: Box<Request>,
    /// The integrator of the cross-check. None: `path`, which has the least in common with `bdpt`, or `bdpt`
    /// with other weights if some strategies are excluded.
    pub cross_check: Option<IntegratorKind>,
}

/// A method: the settings of a render.
#[derive(Clone, Debug, PartialEq)]
pub struct MethodSpec {
    /// Its unique name.
    pub name: String,
    /// The settings, which replace the scene's.
    pub request: Request,
    /// The names of the scenes in which it is rendered; empty: all.
    pub scenes: Vec<String>,
}

/// A budget that is equal for all methods.
#[derive(Clone, Debug, PartialEq)]
pub struct BudgetSpec {
    /// Its unique name.
    pub name: String,
    /// The quantity.
    pub kind: BudgetKind,
    /// Samples per pixel, rays per pixel, or seconds. Range: above 0.
    pub amount: f64,
    /// The amount without `--quick`, over which claims distribute the cost of training.
    pub full: f64,
    /// The names of the methods that are rendered under it; empty: all.
    pub methods: Vec<String>,
    /// The names of the scenes that are rendered under it; empty: all.
    pub scenes: Vec<String>,
}

impl BudgetSpec {
    /// Creates a budget for all methods and scenes, named by its amount, such as `64 spp`.
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

/// Returns true if the list is empty or contains the name.
fn is_in(names: &[String], name: &str) -> bool {
    names.is_empty() || names.iter().any(|known| known == name)
}

impl Experiment {
    /// Iterates over the renders in a scene: each budget with its methods.
    pub fn renders<'a>(
        &'a self,
        scene: &'a str,
    ) -> impl Iterator<Item = (&'a BudgetSpec, &'a MethodSpec)> {
        let all = self.budgets.iter();
        let budgets = all.filter(move |budget| is_in(&budget.scenes, scene));
        budgets.flat_map(move |budget| {
            let methods = self.methods.iter().filter(move |method| {
                is_in(&method.scenes, scene) && is_in(&budget.methods, &method.name)
            });
            methods.map(move |method| (budget, method))
        })
    }

    /// Iterates over the methods that are rendered in a scene.
    pub(crate) fn methods_in<'a>(&'a self, scene: &'a str) -> impl Iterator<Item = &'a MethodSpec> {
        let is_used = move |method: &&MethodSpec| {
            let mut renders = self.renders(scene);
            renders.any(|(_, other)| other.name == method.name)
        };
        self.methods.iter().filter(is_used)
    }

    /// Returns the number of runs; references do not count.
    pub fn run_count(&self) -> usize {
        let scenes = self.scenes.iter();
        let renders: usize = scenes.map(|scene| self.renders(&scene.name).count()).sum();
        self.seeds.count as usize * renders
    }
}

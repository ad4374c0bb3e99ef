//! What an experiment found: everything that a report shows and that somebody else may want to
//! compute with, as it stands in `results.json`.
//!
//! A [`Record`] is one render. What is concluded from records is a [`Claim`], with its tables and
//! plots. Names are unique within their list, and records refer to them.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The version of the format of `results.json`.
pub const FORMAT: u32 = 1;

/// All that an experiment found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Results {
    /// [`FORMAT`].
    pub format: u32,
    /// What the experiment is about.
    pub title: String,
    /// A few sentences on what is compared and why.
    pub description: String,
    /// The program with its version.
    pub program: String,
    /// What it ran on.
    pub machine: Machine,
    /// The scenes.
    pub scenes: Vec<SceneInfo>,
    /// The methods; ratios are relative to the first.
    pub methods: Vec<MethodInfo>,
    /// The budgets.
    pub budgets: Vec<BudgetInfo>,
    /// One for each render.
    pub records: Vec<Record>,
    /// What strategies do, one for each scene where it was asked for.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pyramids: Vec<Pyramid>,
    /// Contributions before visibility, of the methods and scenes that the description names.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub contributions: Vec<Contributions>,
    /// What was concluded.
    pub claims: Vec<Claim>,
}

/// What an experiment ran on.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Machine {
    /// The processor.
    pub processor: String,
    /// Threads of each render.
    pub threads: usize,
    /// The instruction set of the intersector.
    pub isa: String,
    /// Operating system and architecture.
    pub system: String,
}

/// A scene of an experiment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SceneInfo {
    /// Its name in this experiment.
    pub name: String,
    /// The file, as it was named.
    pub file: String,
    /// Hash of everything that was read for it.
    pub digest: String,
    /// Width and height. Unit: pixels.
    pub size: [usize; 2],
    /// How the reference was made, in words: estimators, samples per pixel, their agreement.
    pub reference: String,
    /// The reference image, relative to the folder of the results.
    pub reference_image: Option<String>,
    /// The mean square error that the reference's own noise makes, and that is in every error: the mean
    /// variance of its pixels and channels. None: nobody knows, as of an image without variances.
    #[serde(default)]
    pub reference_mse: Option<f64>,
}

/// A method: how scenes are rendered.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MethodInfo {
    /// Its name in this experiment.
    pub name: String,
    /// All settings, as flags are called and write them.
    pub settings: BTreeMap<String, String>,
}

/// The amounts that are equal for all methods.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum BudgetKind {
    /// Samples per pixel.
    Samples,
    /// Rays of all kinds per pixel, those of training included.
    Rays,
    /// Time of rendering and training, without reading and writing. Unit: seconds.
    Seconds,
}

/// A budget, that a render uses up.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BudgetInfo {
    /// Its name in this experiment, such as `64 spp`.
    pub name: String,
    /// What is counted.
    pub kind: BudgetKind,
    /// How much of it.
    pub amount: f64,
}

/// Rays by kind, over all pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Rays {
    /// Of camera walks.
    pub camera: u64,
    /// Of light walks.
    pub light: u64,
    /// Shadow rays that join s ≥ 1 with t ≥ 2.
    pub connection: u64,
    /// Shadow rays of the light image, t = 1.
    pub light_image: u64,
    /// Of training, of all kinds.
    pub training: u64,
}

impl Rays {
    /// All rays.
    pub fn total(&self) -> u64 {
        self.camera + self.light + self.connection + self.light_image + self.training
    }
}

/// One render.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// The name of the scene.
    pub scene: String,
    /// The name of the method.
    pub method: String,
    /// The name of the budget.
    pub budget: String,
    /// The seed.
    pub seed: u64,
    /// Samples per pixel.
    pub spp: u64,
    /// Time of rendering and training. Unit: seconds.
    pub seconds: f64,
    /// What all threads of the process took of the processors for it, as user and as system, which does
    /// not grow with what else the machine does. Unit: seconds. None: the host cannot tell.
    #[serde(default)]
    pub processor_seconds: Option<f64>,
    /// The part of `seconds` before the first pass: training. Unit: seconds. None: nobody measured it.
    #[serde(default)]
    pub training_seconds: Option<f64>,
    /// The part of `processor_seconds` before the first pass. Unit: seconds. None: the host cannot tell.
    #[serde(default)]
    pub training_processor_seconds: Option<f64>,
    /// Rays by kind.
    pub rays: Rays,
    /// Connection rays that something blocked.
    pub connections_blocked: u64,
    /// Distances from the reference, by the names of [`Metric::NAMES`](crate::metric::Metric::NAMES).
    pub metrics: BTreeMap<String, f64>,
    /// 1 / (MSE · rays), training included.
    pub efficiency_rays: f64,
    /// 1 / (MSE · seconds), training included.
    pub efficiency_seconds: f64,
    /// The image, relative to the folder of the results, where it was kept.
    pub image: Option<String>,
}

/// How large the contributions of a method's connections are in a scene, before visibility.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Contributions {
    /// The name of the scene.
    pub scene: String,
    /// The name of the method.
    pub method: String,
    /// For each pass its numbers, by the names of
    /// [`FIGURES`](crate::experiment::contributions::FIGURES).
    pub passes: Vec<BTreeMap<String, f64>>,
    /// The distribution of weighted contributions: the left edge of each bin of log10, and the part of
    /// all contributions in it.
    pub weighted: Vec<[f64; 2]>,
    /// The distribution of contributions without weights.
    pub unweighted: Vec<[f64; 2]>,
}

/// What each strategy (s, t) of a method does in a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pyramid {
    /// The name of the scene.
    pub scene: String,
    /// The name of the method.
    pub method: String,
    /// The seed.
    pub seed: u64,
    /// Samples per pixel.
    pub spp: u64,
    /// Width and height, smaller than those of the renders where these are large. Unit: pixels.
    pub size: [usize; 2],
    /// The most vertices of paths whose strategies have images.
    pub vertices: u16,
    /// The mean luminance of the picture.
    pub mean: f64,
    /// The part of it that longer paths make.
    pub longer: f64,
    /// The strategies that something was counted of, shorter paths first.
    pub strategies: Vec<StrategyInfo>,
    /// The EXR with their images as layers, relative to the folder of the results.
    pub images: String,
}

/// What a strategy does.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StrategyInfo {
    /// Vertices from the light.
    pub s: u16,
    /// Vertices from the camera.
    pub t: u16,
    /// The mean luminance of the weighted image: these and that of longer paths add up to the picture's.
    pub mean: f64,
    /// The mean luminance of the raw image, without the weight.
    pub raw_mean: f64,
    /// The variance of what a pass adds to a pixel of the weighted image, in the mean pixel.
    pub variance: Option<f64>,
    /// Shadow rays traced; s = 0 needs none.
    pub rays: u64,
    /// Those that something blocked.
    pub blocked: u64,
    /// Values that are in the weighted image, but too large for the raw one.
    pub raw_dropped: u64,
}

/// Whether what others said is what was found, or what was aimed at is reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// It is, and the intervals leave no doubt.
    Reproduced,
    /// It is not, and the intervals leave no doubt.
    NotReproduced,
    /// Intervals overlap.
    Undecided,
    /// What was aimed at is reached, and the interval leaves no doubt.
    Met,
    /// It is not reached, and the interval leaves no doubt.
    NotMet,
    /// Nothing was measured that could tell.
    NotMeasured,
}

/// A statement, and what was found about it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Claim {
    /// A short name, such as `table-1-b-uniform`.
    pub id: String,
    /// What is claimed, in a sentence.
    pub claim: String,
    /// Where it is claimed.
    pub source: String,
    /// Whether it holds.
    pub verdict: Verdict,
    /// What was found, in a sentence with figures.
    pub found: String,
    /// How sure that is: test, level, seeds.
    pub method: String,
    /// The figures.
    pub tables: Vec<Table>,
    /// The curves.
    pub plots: Vec<Plot>,
}

/// A table of texts and numbers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Table {
    /// What it shows.
    pub caption: String,
    /// The heads of the columns.
    pub columns: Vec<String>,
    /// Rows of as many cells.
    pub rows: Vec<Vec<Cell>>,
}

/// A cell of a table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Cell {
    /// Words.
    Text(String),
    /// A number.
    Number(f64),
    /// A number with its interval of confidence.
    Interval {
        /// The best guess.
        value: f64,
        /// The lower end.
        low: f64,
        /// The upper end.
        high: f64,
    },
}

/// How an axis is divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Scale {
    /// Evenly.
    Linear,
    /// By factors.
    Log,
}

/// An axis of a plot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Axis {
    /// What it shows, with its unit.
    pub label: String,
    /// How it is divided.
    pub scale: Scale,
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PlotKind {
    /// Points joined by lines.
    Lines,
    /// Steps: each point is the left edge of a bin and its height.
    Histogram,
}

/// A plot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plot {
    /// What it shows.
    pub caption: String,
    /// How its series are drawn.
    pub kind: PlotKind,
    /// To the right.
    pub x: Axis,
    /// Upwards.
    pub y: Axis,
    /// What is drawn.
    pub series: Vec<Series>,
}

/// A curve, with its intervals of confidence where they are known.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Series {
    /// Its name.
    pub name: String,
    /// x and y.
    pub points: Vec<[f64; 2]>,
    /// Lower and upper end of y for each point; empty where they are not known.
    pub intervals: Vec<[f64; 2]>,
}

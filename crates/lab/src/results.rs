//! The results of an experiment, as `results.json` stores them for reports and other programs.
//!
//! A [`Record`] describes one render; a [`Claim`] states a conclusion from records, with its tables and
//! plots. Names are unique within their list, and records refer to them.

use crate::statistics::Interval;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The version of the format of `results.json`.
pub const FORMAT: u32 = 1;

/// The results of an experiment.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Results {
    /// [`FORMAT`].
    pub format: u32,
    /// The title of the experiment.
    pub title: String,
    /// A few sentences on the comparison and its purpose.
    pub description: String,
    /// The program with its version.
    pub program: String,
    /// The machine that the experiment ran on.
    pub machine: Machine,
    /// The scenes.
    pub scenes: Vec<SceneInfo>,
    /// The methods; ratios are relative to the first.
    pub methods: Vec<MethodInfo>,
    /// The budgets.
    pub budgets: Vec<BudgetInfo>,
    /// The records, one for each render.
    pub records: Vec<Record>,
    /// Figures of the strategies (s, t), one entry for each scene of the description's pyramid.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pyramids: Vec<Pyramid>,
    /// Contributions before visibility, of the methods and scenes that the description names.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub contributions: Vec<Contributions>,
    /// The conclusions.
    pub claims: Vec<Claim>,
}

/// The machine of an experiment.
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
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SceneInfo {
    /// Its name in this experiment.
    pub name: String,
    /// The file, as it was named.
    pub file: String,
    /// Hash of everything read for the scene.
    pub digest: String,
    /// Width and height. Unit: pixels.
    pub size: [usize; 2],
    /// A description of the reference: estimators, samples per pixel, their agreement.
    pub reference: String,
    /// The reference image, relative to the folder of the results.
    pub reference_image: Option<String>,
    /// The mean square error due to the reference's own noise, which every error contains: the mean variance
    /// of its pixels and channels. None: unknown, as for an image without variances.
    #[serde(default)]
    pub reference_mse: Option<f64>,
}

/// A method: the settings of a render.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MethodInfo {
    /// Its name in this experiment.
    pub name: String,
    /// All settings, by the names of flags and in their notation.
    pub settings: BTreeMap<String, String>,
}

/// The quantity that a budget makes equal for all methods.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum BudgetKind {
    /// Samples per pixel.
    Samples,
    /// Rays of all kinds per pixel, including training.
    Rays,
    /// Time of rendering and training, without reading and writing. Unit: seconds.
    Seconds,
}

impl BudgetKind {
    /// Every kind with its name in descriptions.
    pub const NAMES: [(&'static str, Self); 3] = [
        ("samples", Self::Samples),
        ("rays", Self::Rays),
        ("seconds", Self::Seconds),
    ];

    /// Returns the name of the cost that the budget limits, with the unit.
    pub fn cost(self) -> &'static str {
        match self {
            Self::Samples => "samples per pixel",
            Self::Rays => "rays per pixel",
            Self::Seconds => "seconds",
        }
    }
}

/// A budget of renders.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BudgetInfo {
    /// Its name in this experiment, such as `64 spp`.
    pub name: String,
    /// The quantity.
    pub kind: BudgetKind,
    /// The amount, in the unit of `kind`.
    pub amount: f64,
}

/// Rays by kind, over all pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Rays {
    /// Rays of camera subpaths.
    pub camera: u64,
    /// Rays of light subpaths.
    pub light: u64,
    /// Shadow rays that join s ≥ 1 with t ≥ 2.
    pub connection: u64,
    /// Shadow rays of the light image, t = 1.
    pub light_image: u64,
    /// Rays of training, of all kinds.
    pub training: u64,
}

impl Rays {
    /// Returns the number of all rays.
    pub fn total(&self) -> u64 {
        self.camera + self.light + self.connection + self.light_image + self.training
    }
}

/// One render.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
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
    /// The processor time of all threads, user and system, which hardly depends on other work of the
    /// machine. Unit: seconds. None: the host does not measure it.
    #[serde(default)]
    pub processor_seconds: Option<f64>,
    /// The part of `seconds` before the first pass: training. Unit: seconds. None: not measured.
    #[serde(default)]
    pub training_seconds: Option<f64>,
    /// The part of `processor_seconds` before the first pass. Unit: seconds. None: not measured.
    #[serde(default)]
    pub training_processor_seconds: Option<f64>,
    /// Rays by kind.
    pub rays: Rays,
    /// Blocked connection rays.
    pub connections_blocked: u64,
    /// Errors against the reference, by the names of [`Metric::NAMES`](crate::metric::Metric::NAMES).
    pub metrics: BTreeMap<String, f64>,
    /// 1 / (MSE · rays), training included.
    pub efficiency_rays: f64,
    /// 1 / (MSE · seconds), training included.
    pub efficiency_seconds: f64,
    /// The image, relative to the folder of the results. None: not kept.
    pub image: Option<String>,
}

/// The names and the seed of a render, which no other render of the experiment has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct RunId<'a> {
    pub(crate) scene: &'a str,
    pub(crate) method: &'a str,
    pub(crate) budget: &'a str,
    pub(crate) seed: u64,
}

impl Record {
    /// Returns the names and the seed of the render.
    pub(crate) fn run(&self) -> RunId<'_> {
        RunId {
            scene: &self.scene,
            method: &self.method,
            budget: &self.budget,
            seed: self.seed,
        }
    }
}

/// The distribution of a method's connection contributions in a scene, before visibility.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Contributions {
    /// The name of the scene.
    pub scene: String,
    /// The name of the method.
    pub method: String,
    /// The numbers of each pass, by the names of
    /// [`FIGURES`](crate::experiment::contributions::FIGURES).
    pub passes: Vec<BTreeMap<String, f64>>,
    /// The histogram of weighted contributions: the left edge of each bin of log10, and the fraction of
    /// all contributions in it.
    pub weighted: Vec<[f64; 2]>,
    /// The histogram of contributions without weights.
    pub unweighted: Vec<[f64; 2]>,
}

/// Figures of each strategy (s, t) of a method in a scene.
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
    /// Width and height; smaller than the renders if these are large. Unit: pixels.
    pub size: [usize; 2],
    /// The largest number of vertices of paths whose strategies have images.
    pub vertices: u16,
    /// The mean luminance of the image.
    pub mean: f64,
    /// The part of `mean` due to longer paths.
    pub longer: f64,
    /// The strategies with samples, shorter paths first.
    pub strategies: Vec<StrategyInfo>,
    /// The EXR with their images as layers, relative to the folder of the results.
    pub images: String,
}

/// Figures of one strategy (s, t).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StrategyInfo {
    /// Vertices from the light.
    pub s: u16,
    /// Vertices from the camera.
    pub t: u16,
    /// The mean luminance of the weighted image. These means and `longer` add up to the mean of the image.
    pub mean: f64,
    /// The mean luminance of the raw image, without the weight.
    pub raw_mean: f64,
    /// The variance of a pixel of the weighted image in one pass, averaged over pixels.
    pub variance: Option<f64>,
    /// Shadow rays traced; s = 0 needs none.
    pub rays: u64,
    /// Blocked shadow rays.
    pub blocked: u64,
    /// Values in the weighted image that are too large for the raw one.
    pub raw_dropped: u64,
}

/// The verdict on a claim: a reproduction of a published statement, or a goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The statement holds; all intervals lie within the stated range.
    Reproduced,
    /// The statement fails; an interval lies outside the stated range.
    NotReproduced,
    /// An interval overlaps the border of the range.
    Undecided,
    /// The goal is reached; all intervals lie within its range.
    Met,
    /// The goal is missed; an interval lies outside its range.
    NotMet,
    /// A number of the claim was not measured.
    NotMeasured,
}

impl Verdict {
    /// Returns the verdict in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Reproduced => "reproduced",
            Self::NotReproduced => "not reproduced",
            Self::Undecided => "undecided",
            Self::Met => "met",
            Self::NotMet => "not met",
            Self::NotMeasured => "not measured",
        }
    }
}

/// A statement, with its verdict and the evidence.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Claim {
    /// A short name, such as `table-1-b-uniform`.
    pub id: String,
    /// The statement, in a sentence.
    pub claim: String,
    /// The origin of the statement.
    pub source: String,
    /// The verdict.
    pub verdict: Verdict,
    /// The finding, in a sentence with figures.
    pub found: String,
    /// The statistical method: test, level, seeds.
    pub method: String,
    /// The figures.
    pub tables: Vec<Table>,
    /// The curves.
    pub plots: Vec<Plot>,
}

/// A table of texts and numbers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Table {
    /// The caption.
    pub caption: String,
    /// The heads of the columns.
    pub columns: Vec<String>,
    /// Rows, each with one cell per column.
    pub rows: Vec<Vec<Cell>>,
}

/// A cell of a table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Cell {
    /// A text.
    Text(String),
    /// A number.
    Number(f64),
    /// A number with its confidence interval.
    Interval(Interval),
}

/// The scale of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Scale {
    /// Linear.
    Linear,
    /// Logarithmic.
    Log,
}

/// An axis of a plot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Axis {
    /// The quantity with its unit.
    pub label: String,
    /// The scale.
    pub scale: Scale,
}

impl Axis {
    pub(crate) fn new(label: impl Into<String>, scale: Scale) -> Self {
        let label = label.into();
        Self { label, scale }
    }
}

/// The style of a plot's series.
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
    /// The caption.
    pub caption: String,
    /// The style of its series.
    pub kind: PlotKind,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// The series.
    pub series: Vec<Series>,
}

/// A curve, with its confidence intervals if known.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Series {
    /// Its name.
    pub name: String,
    /// x and y.
    pub points: Vec<[f64; 2]>,
    /// Lower and upper end of y for each point; empty if unknown.
    pub intervals: Vec<[f64; 2]>,
}

/// A point of a curve, with the interval of y if it is known.
pub(crate) type Point = ([f64; 2], Option<[f64; 2]>);

impl Series {
    /// Makes a curve, with intervals if all points have them.
    pub(crate) fn new(name: &str, points: &[Point]) -> Self {
        let intervals: Option<Vec<_>> = points.iter().map(|(_, interval)| *interval).collect();
        Self {
            name: name.to_owned(),
            points: points.iter().map(|(point, _)| *point).collect(),
            intervals: intervals.unwrap_or_default(),
        }
    }
}

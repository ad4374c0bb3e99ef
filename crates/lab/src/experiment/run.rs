//! From a description to results.

use super::analysis::{ReferenceNoise, overruns, reference_noise};
use super::cell::Cell;
use super::error::ExperimentError;
use super::identity::identity;
use super::journal::{Journal, Owner};
use super::outputs;
use super::pyramid;
use super::reference;
use super::settings::{no_effect, texts};
use super::stage::{Reference, Stage};
use super::{Absent, Experiment, MethodSpec, contributions};
use crate::results::{BudgetInfo, FORMAT, Machine, MethodInfo, Record, Results};
use bidir::integrator::{LostLight, lost_light};
use bidir::scene::Isa;
use formats::scene::Files;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

type Result<T> = std::result::Result<T, ExperimentError>;

/// Where an experiment runs, and as what.
#[derive(Clone, Debug)]
pub struct Setup {
    /// The folder of the results.
    pub folder: PathBuf,
    /// What becomes of records that are there.
    pub start: Start,
    /// The program with its version.
    pub program: String,
    /// What it runs on; the number of threads is filled in.
    pub machine: Machine,
}

/// What becomes of records that are there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// They stay, and what is missing is rendered. Those of another experiment, machine or program are
    /// refused.
    Resume,
    /// They go; references of the same scene and settings stay.
    Anew,
}

/// Who runs an experiment: is told how far it is, has the clock, and can stop it.
///
/// References ask it from one of their threads at a time.
pub trait Observer: Send {
    /// Tells what happens.
    fn tell(&mut self, event: Event<'_>);

    /// The host's clock. Unit: seconds since any moment.
    fn seconds(&self) -> f64;

    /// What all threads of the process have taken of the processors so far, as user and as system. Unit:
    /// seconds. None: the host cannot tell.
    fn processor_seconds(&self) -> Option<f64> {
        None
    }

    /// True to stop: asked before each pass. The running render is then forgotten.
    fn should_stop(&mut self) -> bool {
        false
    }
}

/// What happens.
#[derive(Clone, Copy, Debug)]
pub enum Event<'a> {
    /// Something is odd with a scene or its reference, such as much noise.
    Warning(&'a str),
    /// A pass of a reference begins, of one of its two estimators.
    Reference {
        /// The scene.
        scene: &'a str,
        /// Passes that are done.
        passes: u64,
        /// Passes in all.
        of: u64,
    },
    /// A pass begins of the images of strategies.
    Pyramid {
        /// The scene.
        scene: &'a str,
        /// Passes that are done.
        passes: u64,
        /// Passes in all.
        of: u64,
    },
    /// References and images of strategies are there, and so are `done` of all renders.
    Begin {
        /// Renders that are done.
        done: usize,
        /// Renders in all.
        of: usize,
    },
    /// A render is done.
    Record(&'a Record),
}

/// How an experiment ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// Every render has a record.
    Complete,
    /// The observer stopped it; the same again goes on.
    Stopped,
}

/// What an experiment found, all or so far.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// How it ended.
    pub end: End,
    /// What was found. None: it was stopped before the references were there.
    pub results: Option<Results>,
}

/// Runs what no record has yet, and writes `results.json`.
pub fn run(experiment: &Experiment, setup: &Setup, observer: &mut dyn Observer) -> Result<Outcome> {
    let (stages, given, owner) = begin(experiment, setup, observer)?;
    let mut journal = Journal::start(setup, &owner, observer)?;
    let Some(scenes) = reference::obtain_all(experiment, stages, given, setup, observer)? else {
        return Ok(Outcome {
            end: End::Stopped,
            results: None,
        });
    };
    let Ready {
        stages,
        references,
        absent,
    } = scenes;
    let work = Work {
        experiment,
        setup,
        stages: &stages,
        references: &references,
    };
    let shown = pyramid::complete(experiment, &stages, setup, &mut journal, observer)?;
    let end = match shown {
        End::Complete => work.render(&mut journal, observer)?,
        End::Stopped => shown,
    };
    let mut results = work.results(journal.records());
    results.pyramids = pyramid::found(experiment, &stages, setup, &journal);
    results.contributions = contributions::measure(experiment, &stages)?;
    for Absent { name, reason } in absent {
        let _ = write!(
            results.description,
            "\n\nThe scene {name} is left out: {reason}."
        );
    }
    results.claims = experiment.judge(&results);
    for noise in reference_noise(&results).filter(ReferenceNoise::is_large) {
        observer.tell(Event::Warning(&noise.words()));
    }
    for warning in overruns(&results) {
        observer.tell(Event::Warning(&warning));
    }
    write_results(&setup.folder, &results)?;
    Ok(Outcome {
        end,
        results: Some(results),
    })
}

/// What there is of an experiment before anything is rendered: its scenes, the references that are
/// there, and whose records are made.
pub(super) type Begun<'a> = (Vec<Stage<'a>>, Vec<Option<Reference>>, Owner);

/// The scenes that have their references, and those that are left out.
pub(super) struct Ready<'a> {
    pub(super) stages: Vec<Stage<'a>>,
    /// One for each stage.
    pub(super) references: Vec<Reference>,
    pub(super) absent: Vec<Absent>,
}

/// Makes the folders, reads the scenes and the references that are there.
pub(super) fn begin<'a>(
    experiment: &'a Experiment,
    setup: &Setup,
    observer: &mut dyn Observer,
) -> Result<Begun<'a>> {
    for folder in ["", "images", "references"] {
        let path = setup.folder.join(folder);
        std::fs::create_dir_all(&path).map_err(|error| ExperimentError::Folder { path, error })?;
    }
    for scene in &experiment.absent {
        scene.warn(observer);
    }
    if let ([], Some(absent)) = (&experiment.scenes[..], experiment.absent.last()) {
        return Err(ExperimentError::NoScenes(absent.reason.clone()));
    }
    let stages = experiment
        .scenes
        .iter()
        .map(|spec| Stage::load(experiment, spec, &Files::default()));
    let stages = stages.collect::<Result<Vec<_>>>()?;
    for warning in stages.iter().flat_map(|stage| &stage.warnings) {
        observer.tell(Event::Warning(warning));
    }
    check_strategies(experiment, &stages, observer)?;
    pyramid::check(experiment, &stages)?;
    let given = stages.iter().map(reference::given);
    let given = given.collect::<Result<Vec<_>>>()?;
    outputs::check(experiment, &stages, setup)?;
    let found = given.iter().flatten();
    found.for_each(|reference| reference.warn(observer));
    let owner = Owner {
        experiment: identity(experiment, &stages, &given),
        program: setup.program.clone(),
        machine: machine(experiment, setup),
    };
    Ok((stages, given, owner))
}

/// Refuses methods whose strategies make no path in a scene, and warns of light that others lose, once
/// for each method.
fn check_strategies(
    experiment: &Experiment,
    stages: &[Stage<'_>],
    observer: &mut dyn Observer,
) -> Result<()> {
    for method in &experiment.methods {
        let mut warned = Vec::new();
        for stage in stages.iter().filter(|stage| stage.has(experiment, method)) {
            let settings = method.changes.apply(&stage.settings);
            check_effect(method, stage)?;
            let path = &settings.path;
            let Some(lost) = lost_light(&stage.scene, settings.integrator, path) else {
                continue;
            };
            let text = format!("strategies {} {lost}", path.strategies);
            if matches!(lost, LostLight::All { .. }) {
                return Err(ExperimentError::Strategies {
                    scene: stage.spec.name.clone(),
                    method: method.name.clone(),
                    text,
                });
            }
            if !warned.contains(&text) {
                let warning = format!("method `{}`: {text}", method.name);
                observer.tell(Event::Warning(&warning));
                warned.push(text);
            }
        }
    }
    Ok(())
}

/// Refuses a setting without effect on the integrator that the scene brings.
fn check_effect(method: &MethodSpec, stage: &Stage<'_>) -> Result<()> {
    let changes = &method.changes;
    let integrator = stage.settings.integrator;
    match changes.ignored(&stage.settings).first() {
        Some(name) if changes.integrator.is_none() => Err(ExperimentError::NoEffect {
            scene: stage.spec.name.clone(),
            method: method.name.clone(),
            text: no_effect(name, integrator),
        }),
        _ => Ok(()),
    }
}

impl Absent {
    /// Says that it is left out.
    pub(super) fn warn(&self, observer: &mut dyn Observer) {
        let Self { name, reason } = self;
        observer.tell(Event::Warning(&format!(
            "scene `{name}` is left out: {reason}"
        )));
    }
}

impl Machine {
    /// The name of a processor that the system does not name.
    pub const UNKNOWN: &'static str = "unknown";

    /// This one; the number of threads is filled in by [`run`].
    pub fn here() -> Self {
        let processor = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let model = processor.lines().find_map(|line| {
            let (name, value) = line.split_once(':')?;
            (name.trim() == "model name").then(|| value.trim().to_owned())
        });
        Self {
            processor: model.unwrap_or_else(|| Self::UNKNOWN.to_owned()),
            isa: Isa::detect().name().to_owned(),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            threads: 0,
        }
    }
}

/// What an experiment runs on.
fn machine(experiment: &Experiment, setup: &Setup) -> Machine {
    Machine {
        threads: experiment.threads,
        ..setup.machine.clone()
    }
}

/// Writes `results.json` into the folder of the results.
fn write_results(folder: &Path, results: &Results) -> Result<()> {
    formats::file::replace(&folder.join(outputs::RESULTS), json(results).as_bytes())?;
    Ok(())
}

fn json(results: &Results) -> String {
    let text = serde_json::to_string_pretty(results);
    text.expect("texts and numbers have a JSON") + "\n"
}

/// What is rendered and compared.
pub(super) struct Work<'a> {
    pub(super) experiment: &'a Experiment,
    pub(super) setup: &'a Setup,
    pub(super) stages: &'a [Stage<'a>],
    /// One for each stage.
    pub(super) references: &'a [Reference],
}

impl Work<'_> {
    /// All renders in their order, each with its reference.
    pub(super) fn cells(&self) -> impl Iterator<Item = (Cell<'_>, &Reference)> {
        let Self {
            experiment,
            stages,
            references,
            ..
        } = *self;
        let seeds = experiment.seeds;
        let seeds = seeds.first..seeds.first + seeds.count;
        let scenes = move |seed| {
            stages
                .iter()
                .zip(references)
                .map(move |scene| (seed, scene))
        };
        seeds
            .flat_map(scenes)
            .flat_map(move |(seed, (stage, reference))| {
                let renders = experiment.renders(&stage.spec.name);
                renders.map(move |(budget, method)| {
                    let cell = Cell {
                        stage,
                        method,
                        budget,
                        seed,
                    };
                    (cell, reference)
                })
            })
    }

    /// Renders what has no record yet.
    fn render(&self, journal: &mut Journal, observer: &mut dyn Observer) -> Result<End> {
        observer.tell(Event::Begin {
            done: journal.records().len(),
            of: self.cells().count(),
        });
        for (cell, reference) in self.cells() {
            if journal.has(&cell) {
                continue;
            }
            let Some(rendered) = cell.render(self.experiment.threads, observer)? else {
                return Ok(End::Stopped);
            };
            let mut record = cell.record(&rendered, reference, &self.experiment.metrics);
            if cell.seed == self.experiment.seeds.first {
                let image = cell.image();
                rendered.write(&self.setup.folder.join(&image))?;
                record.image = Some(image);
            }
            observer.tell(Event::Record(&record));
            journal.add(record)?;
        }
        Ok(End::Complete)
    }

    fn results(&self, records: &[Record]) -> Results {
        let Self {
            experiment,
            setup,
            stages,
            references,
        } = *self;
        let scenes = stages.iter().zip(references);
        let budgets = experiment.budgets.iter().map(|budget| BudgetInfo {
            name: budget.name.clone(),
            kind: budget.kind,
            amount: budget.amount,
        });
        Results {
            format: FORMAT,
            title: experiment.title.clone(),
            description: experiment.description.clone(),
            program: setup.program.clone(),
            machine: machine(experiment, setup),
            scenes: scenes
                .map(|(stage, reference)| stage.info(reference))
                .collect(),
            methods: self.methods(),
            budgets: budgets.collect(),
            records: self.ordered(records),
            pyramids: Vec::new(),
            contributions: Vec::new(),
            claims: Vec::new(),
        }
    }

    /// The records in the order of the renders, in which other machines may not have made them.
    fn ordered(&self, records: &[Record]) -> Vec<Record> {
        let record = |(cell, _): (Cell<'_>, _)| {
            let mut records = records.iter();
            records.find(|record| cell.is_of(record)).cloned()
        };
        self.cells().filter_map(record).collect()
    }

    /// The methods with their settings; where those are the scenes', which differ, they say so.
    fn methods(&self) -> Vec<MethodInfo> {
        let methods = self.experiment.methods.iter().map(|method| {
            let mut settings: BTreeMap<String, String> = BTreeMap::new();
            let stages = self.stages.iter();
            let stages = stages.filter(|stage| stage.has(self.experiment, method));
            for (number, stage) in stages.enumerate() {
                for (name, value) in texts(&method.changes.apply(&stage.settings)) {
                    let known = settings.entry(name).or_insert_with(|| value.clone());
                    if number > 0 && *known != value {
                        "the scene's".clone_into(known);
                    }
                }
            }
            MethodInfo {
                name: method.name.clone(),
                settings,
            }
        });
        methods.collect()
    }
}

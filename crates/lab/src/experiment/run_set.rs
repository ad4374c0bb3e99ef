//! Running a whole experiment: from the description to the results.

use super::analysis::{ReferenceNoise, overruns, reference_noise};
use super::error::ExperimentError;
use super::identity::identity;
use super::journal::{Journal, RecordsKey};
use super::loaded_scene::{LoadedScene, Reference};
use super::observer::{Event, Observer};
use super::outputs;
use super::pyramid;
use super::reference;
use super::run::Run;
use super::settings::texts;
use super::{Absent, Experiment, Seeds, check, contributions};
use crate::results::{BudgetInfo, FORMAT, Machine, MethodInfo, Record, Results};
use formats::scene::Files;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::PathBuf;

type Result<T> = std::result::Result<T, ExperimentError>;

/// The folder, program and machine of an experiment.
#[derive(Clone, Debug)]
pub struct Setup {
    /// The folder of the results.
    pub folder: PathBuf,
    /// The treatment of existing records.
    pub start: Start,
    /// The program with its version.
    pub program: String,
    /// The machine; [`run`] fills in the number of threads.
    pub machine: Machine,
}

/// The treatment of existing records.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// Keeps the records and renders the missing ones. Refuses records of another experiment, machine or program.
    Resume,
    /// Removes the records. References of the same scene and settings stay.
    Anew,
}

/// The end of an experiment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// Every render has a record.
    Complete,
    /// The observer stopped the experiment. Running it again continues.
    Stopped,
}

/// The results of an experiment, complete or so far.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The end.
    pub end: End,
    /// The results. None: it stopped before the references were complete.
    pub results: Option<Results>,
}

/// Renders every run without a record, and writes `results.json`.
pub fn run(experiment: &Experiment, setup: &Setup, observer: &mut dyn Observer) -> Result<Outcome> {
    let Some(mut started) = start(experiment, setup, observer)? else {
        return Ok(Outcome {
            end: End::Stopped,
            results: None,
        });
    };
    let (run_set, journal) = (&started.run_set, &mut started.journal);
    let end = match started.end {
        End::Complete => run_set.render(journal, observer)?,
        End::Stopped => End::Stopped,
    };
    let mut results = run_set.results(journal.records());
    results.pyramids = pyramid::found(experiment, &run_set.scenes, journal);
    results.contributions = contributions::measure(experiment, &run_set.scenes)?;
    for Absent { name, reason } in &run_set.absent {
        let _ = write!(
            results.description,
            "\n\nThe scene {name} is left out: {reason}."
        );
    }
    results.claims = experiment.judge(&results);
    for noise in reference_noise(&results).filter(ReferenceNoise::is_large) {
        observer.notify(Event::Warning(&noise.warning()));
    }
    for warning in overruns(&results) {
        observer.notify(Event::Warning(&warning));
    }
    let file = setup.folder.join(outputs::RESULTS);
    formats::file::replace(&file, json(&results).as_bytes())?;
    Ok(Outcome {
        end,
        results: Some(results),
    })
}

/// Returns the content of `results.json`.
fn json(results: &Results) -> String {
    let text = serde_json::to_string_pretty(results);
    text.expect("texts and numbers have a JSON") + "\n"
}

/// An experiment before its first run.
pub(super) struct Started<'a> {
    pub(super) run_set: RunSet<'a>,
    pub(super) key: RecordsKey,
    pub(super) journal: Journal,
    /// [`End::Complete`] if the images of strategies are complete.
    pub(super) end: End,
}

/// Creates the folders, reads the scenes, and renders references and images of strategies. None: the observer
/// stopped it before the references were complete.
pub(super) fn start<'a>(
    experiment: &'a Experiment,
    setup: &'a Setup,
    observer: &mut dyn Observer,
) -> Result<Option<Started<'a>>> {
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
    let load = |spec| LoadedScene::load(experiment, spec, &Files::default());
    let loaded = experiment.scenes.iter().map(load);
    let scenes = loaded.collect::<Result<Vec<_>>>()?;
    for warning in scenes.iter().flat_map(|loaded| &loaded.read.warnings) {
        observer.notify(Event::Warning(warning));
    }
    check::methods(experiment, &scenes, observer)?;
    pyramid::check(experiment, &scenes)?;
    let references = scenes.iter().map(reference::given);
    let given = references.collect::<Result<Vec<_>>>()?;
    outputs::check(experiment, &scenes, setup)?;
    let key = RecordsKey {
        experiment: identity(experiment, &scenes, &given),
        program: setup.program.clone(),
        machine: setup.machine(experiment),
    };
    let mut journal = Journal::start(setup, &key)?;
    let obtained = reference::obtain_all(experiment, scenes, given, setup, observer)?;
    let Some(run_set) = obtained else {
        return Ok(None);
    };
    let end = pyramid::complete(experiment, &run_set.scenes, setup, &mut journal, observer)?;
    Ok(Some(Started {
        run_set,
        key,
        journal,
        end,
    }))
}

impl Absent {
    /// Warns that the scene is left out.
    pub(super) fn warn(&self, observer: &mut dyn Observer) {
        let Self { name, reason } = self;
        observer.notify(Event::Warning(&format!(
            "scene `{name}` is left out: {reason}"
        )));
    }
}

impl Setup {
    /// Returns the machine with the experiment's number of threads.
    fn machine(&self, experiment: &Experiment) -> Machine {
        Machine {
            threads: experiment.threads,
            ..self.machine.clone()
        }
    }
}

/// All runs of an experiment.
pub(super) struct RunSet<'a> {
    pub(super) experiment: &'a Experiment,
    pub(super) setup: &'a Setup,
    pub(super) scenes: Vec<LoadedScene<'a>>,
    /// The references, one for each scene.
    pub(super) references: Vec<Reference>,
    /// The omitted scenes.
    pub(super) absent: Vec<Absent>,
}

impl RunSet<'_> {
    /// Iterates over all runs in order, each with its reference.
    pub(super) fn runs(&self) -> impl Iterator<Item = (Run<'_>, &Reference)> {
        let experiment = self.experiment;
        let Seeds { first, count } = experiment.seeds;
        (first..first + count).flat_map(move |seed| {
            let scenes = self.scenes.iter().zip(&self.references);
            scenes.flat_map(move |(scene, reference)| {
                let renders = experiment.renders(&scene.spec.name);
                renders.map(move |(budget, method)| {
                    let run = Run {
                        experiment,
                        scene,
                        method,
                        budget,
                        seed,
                    };
                    (run, reference)
                })
            })
        })
    }

    /// Renders every run without a record.
    fn render(&self, journal: &mut Journal, observer: &mut dyn Observer) -> Result<End> {
        observer.notify(Event::Begin {
            done: journal.records().len(),
            of: self.runs().count(),
        });
        for (run, reference) in self.runs() {
            if journal.has(run.id()) {
                continue;
            }
            let Some(done) = run.render(&reference.pixels, observer)? else {
                return Ok(End::Stopped);
            };
            observer.notify(Event::Record(&done.record));
            journal.add(done)?;
        }
        Ok(End::Complete)
    }

    fn results(&self, records: &[Record]) -> Results {
        let (experiment, setup) = (self.experiment, self.setup);
        let scenes = self.scenes.iter().zip(&self.references);
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
            machine: setup.machine(experiment),
            scenes: scenes
                .map(|(loaded, reference)| loaded.info(reference))
                .collect(),
            methods: self.methods(),
            budgets: budgets.collect(),
            records: self.ordered(records),
            pyramids: Vec::new(),
            contributions: Vec::new(),
            claims: Vec::new(),
        }
    }

    /// Sorts the records into the order of the runs, as other machines may have added them in any order.
    fn ordered(&self, records: &[Record]) -> Vec<Record> {
        let record = |(run, _): (Run<'_>, _)| {
            let mut records = records.iter();
            records.find(|record| record.run() == run.id()).cloned()
        };
        self.runs().filter_map(record).collect()
    }

    /// Returns the methods with their settings. The value of a setting that differs between scenes is "the scene's".
    fn methods(&self) -> Vec<MethodInfo> {
        let methods = self.experiment.methods.iter().map(|method| {
            let mut settings: BTreeMap<String, String> = BTreeMap::new();
            let scenes = self.scenes.iter();
            for loaded in scenes.filter(|loaded| loaded.has(self.experiment, method)) {
                for (name, value) in texts(&method.request.apply(&loaded.settings)) {
                    let known = settings.entry(name).or_insert_with(|| value.clone());
                    if *known != value {
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

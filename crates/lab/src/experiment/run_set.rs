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
use super::settings::{no_effect, texts};
use super::{Absent, Experiment, MethodSpec, contributions};
use crate::results::{BudgetInfo, FORMAT, Machine, MethodInfo, Record, Results};
use bidir::analysis::{LostLight, lost_light};
use bidir::scene::Isa;
use formats::scene::Files;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

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
    results.pyramids = pyramid::found(experiment, &run_set.scenes, setup, journal);
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
    write_results(&setup.folder, &results)?;
    Ok(Outcome {
        end,
        results: Some(results),
    })
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
    let scenes = experiment.scenes.iter().map(load);
    let scenes = scenes.collect::<Result<Vec<_>>>()?;
    for warning in scenes.iter().flat_map(|loaded| &loaded.read.warnings) {
        observer.notify(Event::Warning(warning));
    }
    check_strategies(experiment, &scenes, observer)?;
    pyramid::check(experiment, &scenes)?;
    let given = scenes.iter().map(reference::given);
    let given = given.collect::<Result<Vec<_>>>()?;
    outputs::check(experiment, &scenes, setup)?;
    let key = RecordsKey {
        experiment: identity(experiment, &scenes, &given),
        program: setup.program.clone(),
        machine: machine(experiment, setup),
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

/// Refuses methods whose strategies make no path in a scene. Warns of methods that lose light, once for all
/// methods that lose the same light.
fn check_strategies(
    experiment: &Experiment,
    scenes: &[LoadedScene<'_>],
    observer: &mut dyn Observer,
) -> Result<()> {
    let mut losses: Vec<(String, Vec<&str>)> = Vec::new();
    for method in &experiment.methods {
        let scenes = scenes.iter();
        for loaded in scenes.filter(|loaded| loaded.has(experiment, method)) {
            check_effect(method, loaded)?;
            let Some(text) = loss(method, loaded)? else {
                continue;
            };
            match losses.iter_mut().find(|(known, _)| *known == text) {
                Some((_, methods)) => methods.push(&method.name),
                None => losses.push((text, vec![&method.name])),
            }
        }
    }
    for (text, mut methods) in losses {
        methods.dedup();
        let others = match methods.len() - 1 {
            0 => String::new(),
            1 => " and another".to_owned(),
            others => format!(" and {others} others"),
        };
        let warning = format!("method `{}`{others}: {text}", methods[0]);
        observer.notify(Event::Warning(&warning));
    }
    Ok(())
}

/// Describes the light that a method loses in a scene. None: it loses none.
///
/// Errors: its strategies make no path.
fn loss(method: &MethodSpec, loaded: &LoadedScene<'_>) -> Result<Option<String>> {
    let settings = method.request.apply(&loaded.settings);
    let path = &settings.path;
    let Some(lost) = lost_light(
        &loaded.subject.scene,
        &loaded.subject.view,
        settings.integrator,
        path,
    ) else {
        return Ok(None);
    };
    let text = format!("strategies {} {lost}", path.strategies);
    if matches!(lost, LostLight::All { .. }) {
        return Err(loaded.refusal(method, text, None));
    }
    Ok(Some(text))
}

/// Refuses a setting of the method that has no effect on the scene file's integrator.
fn check_effect(method: &MethodSpec, loaded: &LoadedScene<'_>) -> Result<()> {
    let request = &method.request;
    let integrator = loaded.settings.integrator;
    match request.ignored(&loaded.settings).first() {
        Some(name) if request.integrator.is_none() => {
            let text = format!("{}, which the scene sets", no_effect(name, integrator));
            let hint = "set `integrator` in [settings] or in the method";
            Err(loaded.refusal(method, text, Some(hint)))
        }
        _ => Ok(()),
    }
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

impl Machine {
    /// The processor's name if the system gives none.
    pub const UNKNOWN: &'static str = "unknown";

    /// Describes this machine; [`run`] fills in the number of threads.
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

/// Returns the machine with the experiment's number of threads.
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
        let seeds = self.experiment.seeds;
        let seeds = seeds.first..seeds.first + seeds.count;
        seeds.flat_map(move |seed| {
            let scenes = self.scenes.iter().zip(&self.references);
            scenes.flat_map(move |(scene, reference)| {
                let renders = self.experiment.renders(&scene.spec.name);
                renders.map(move |(budget, method)| {
                    let run = Run {
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
            if journal.has(&run) {
                continue;
            }
            let Some(rendered) = run.render(self.experiment.threads, observer)? else {
                return Ok(End::Stopped);
            };
            let mut record = run.record(&rendered, reference, &self.experiment.metrics);
            if run.seed == self.experiment.seeds.first {
                let image = run.image();
                rendered.write(&self.setup.folder.join(&image))?;
                record.image = Some(image);
            }
            observer.notify(Event::Record(&record));
            journal.add(record)?;
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
            machine: machine(experiment, setup),
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
            records.find(|record| run.is_of(record)).cloned()
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

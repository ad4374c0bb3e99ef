//! Experiments.

use crate::cluster::Prepared;
use crate::error::{of_experiment, raise};
use crate::settings::threads_of;
use crate::wait::{Stop, wait};
use lab::experiment::{self, Event, Observer, Outcome, Setup, Start};
use lab::results::{Machine, Results};
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::Sender;
use std::time::Instant;

/// An experiment read from a description.
#[pyclass(frozen, module = "bidir._bidir")]
pub(crate) struct Experiment {
    pub(crate) experiment: experiment::Experiment,
    file: PathBuf,
}

/// An event for Python: kind, text, finished parts, all parts.
pub(crate) type Message = (&'static str, String, u64, u64);

/// Converts events of an experiment to messages, and sends them.
pub(crate) struct Reporter<'a> {
    stop: &'a Stop,
    sender: Sender<Message>,
    begin: Instant,
    /// Finished renders, and all renders.
    renders: (u64, u64),
}

impl<'a> Reporter<'a> {
    pub(crate) fn new(stop: &'a Stop, sender: &Sender<Message>) -> Self {
        Self {
            stop,
            sender: sender.clone(),
            begin: Instant::now(),
            renders: (0, 0),
        }
    }
}

impl Observer for Reporter<'_> {
    fn notify(&mut self, event: Event<'_>) {
        let message = match event {
            Event::Warning(text) => ("warning", text.to_owned(), 0, 0),
            Event::Reference { scene, passes, of } => ("reference", scene.to_owned(), passes, of),
            Event::Pyramid { scene, passes, of } => ("pyramid", scene.to_owned(), passes, of),
            Event::Begin { done, of } => {
                self.renders = (done as u64, of as u64);
                ("render", String::new(), done as u64, of as u64)
            }
            Event::Record(record) => {
                self.renders.0 += 1;
                let text = format!("{} {} {}", record.scene, record.budget, record.method);
                ("render", text, self.renders.0, self.renders.1)
            }
        };
        // A closed channel means that the receiver has asked to stop.
        let _ = self.sender.send(message);
    }

    fn seconds(&self) -> f64 {
        self.begin.elapsed().as_secs_f64()
    }

    fn stop_flag(&self) -> Arc<AtomicBool> {
        Arc::clone(self.stop.flag())
    }
}

/// Converts the results to JSON. None: there are none yet.
fn json(results: Option<&Results>) -> Option<String> {
    results.and_then(|results| serde_json::to_string(results).ok())
}

#[pymethods]
impl Experiment {
    /// Reads a description. `file` is its name in errors; paths of scenes are relative to its folder.
    #[new]
    #[pyo3(signature = (text, file, *, quick, threads))]
    fn new(
        py: Python<'_>,
        text: &str,
        file: PathBuf,
        quick: bool,
        threads: Option<usize>,
    ) -> PyResult<Self> {
        let read = experiment::Experiment::read(text, &file);
        let mut experiment = read.map_err(|error| of_experiment(py, &error))?;
        if quick {
            experiment = experiment.quick();
        }
        // Records contain the resolved number.
        let threads = threads.unwrap_or(experiment.threads);
        experiment.threads = threads_of(py, threads)?.count();
        Ok(Self { experiment, file })
    }

    /// Returns the title.
    #[getter]
    fn title(&self) -> &str {
        &self.experiment.title
    }

    /// Returns the number of renders; references do not count.
    #[getter]
    fn cells(&self) -> usize {
        self.experiment.run_count()
    }

    /// Renders every run without a record, and calls `hear` with events. Returns the results as JSON, and
    /// their tables as text.
    fn run(
        &self,
        py: Python<'_>,
        folder: PathBuf,
        restart: bool,
        machine: Option<&str>,
        hear: Option<Py<PyAny>>,
    ) -> PyResult<(Option<String>, String)> {
        let setup = self.setup(py, folder, restart, machine)?;
        let pass_on = |py: Python<'_>, message: Message| pass_on(py, hear.as_ref(), message);
        let outcome = wait(py, None, pass_on, |stop, sender| {
            let mut reporter = Reporter::new(stop, sender);
            experiment::run(&self.experiment, &setup, &mut reporter)
        })?;
        let Outcome { results, .. } = outcome.map_err(|error| of_experiment(py, &error))?;
        let tables_of = |results: &Results| self.experiment.sections(results);
        let sections = results.as_ref().map(tables_of).unwrap_or_default();
        if let Some(results) = &results {
            let command = format!("bidir experiment {} -o FOLDER", self.file.display());
            let written = experiment::write_page(&setup.folder, results, &sections, &command);
            written.map_err(|error| of_experiment(py, &error))?;
        }
        let tables = sections.iter().flat_map(|section| &section.tables);
        let texts: Vec<_> = tables.map(lab::report::table_text).collect();
        Ok((json(results.as_ref()), texts.join("\n")))
    }

    /// Renders everything except the runs. None: it was stopped.
    fn prepare(
        &self,
        py: Python<'_>,
        folder: PathBuf,
        restart: bool,
        machine: &str,
        hear: Option<Py<PyAny>>,
    ) -> PyResult<Option<Prepared>> {
        let setup = self.setup(py, folder, restart, Some(machine))?;
        let pass_on = |py: Python<'_>, message: Message| pass_on(py, hear.as_ref(), message);
        let outcome = wait(py, None, pass_on, |stop, sender| {
            let mut reporter = Reporter::new(stop, sender);
            experiment::prepare(&self.experiment, &setup, &mut reporter)
        })?;
        let prepared = outcome.map_err(|error| of_experiment(py, &error))?;
        Ok(prepared.map(Prepared))
    }
}

impl Experiment {
    /// Returns the setup of a run. Errors: the results would replace the description.
    fn setup(
        &self,
        py: Python<'_>,
        folder: PathBuf,
        restart: bool,
        machine: Option<&str>,
    ) -> PyResult<Setup> {
        let checked = experiment::check_description(&self.file, &folder);
        checked.map_err(|error| of_experiment(py, &error))?;
        setup(py, folder, restart, machine)
    }
}

fn pass_on(py: Python<'_>, hear: Option<&Py<PyAny>>, message: Message) -> PyResult<()> {
    hear.map_or(Ok(()), |hear| hear.call1(py, message).map(drop))
}

/// Returns the setup of a run; `machine` is the result of `machine()` on the machine that renders. None: this
/// machine.
fn setup(py: Python<'_>, folder: PathBuf, restart: bool, machine: Option<&str>) -> PyResult<Setup> {
    let machine = match machine {
        Some(json) => serde_json::from_str(json)
            .map_err(|error| raise(py, "ExperimentError", &format!("not a machine: {error}")))?,
        None => Machine::here(),
    };
    Ok(Setup {
        folder,
        start: if restart { Start::Anew } else { Start::Resume },
        program: formats::film::program(),
        machine,
    })
}

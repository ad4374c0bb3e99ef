//! Experiments.

use crate::cluster::Prepared;
use crate::error::{of_experiment, raise};
use crate::settings::threads_of;
use crate::wait::{Stop, wait};
use lab::experiment::{self, Event, Observer, Outcome, Setup, Start};
use lab::results::{Machine, Results};
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::mpsc::Sender;
use std::time::Instant;

/// A description that was read.
#[pyclass(frozen, module = "bidir._bidir")]
pub(crate) struct Experiment {
    pub(crate) experiment: experiment::Experiment,
    file: PathBuf,
}

/// What happens, for Python: a kind, a text, how much is done, and of how much.
pub(crate) type Heard = (&'static str, String, u64, u64);

/// Passes on what happens.
pub(crate) struct Reporter<'a> {
    stop: &'a Stop,
    sender: Sender<Heard>,
    begin: Instant,
    /// Renders that are done, and all.
    renders: (u64, u64),
}

impl<'a> Reporter<'a> {
    pub(crate) fn new(stop: &'a Stop, sender: &Sender<Heard>) -> Self {
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
        let told = match event {
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
        // Who no longer listens has asked to stop.
        let _ = self.sender.send(told);
    }

    fn seconds(&self) -> f64 {
        self.begin.elapsed().as_secs_f64()
    }

    fn should_stop(&mut self) -> bool {
        self.stop.is_set()
    }
}

/// The results as JSON. None: there are none yet.
fn json(results: Option<&Results>) -> Option<String> {
    results.and_then(|results| serde_json::to_string(results).ok())
}

#[pymethods]
impl Experiment {
    /// Reads a description; `file` is what errors call it, and its folder is where files are.
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
        let mut read = read.map_err(|error| of_experiment(py, &error))?;
        if quick {
            read = read.quick();
        }
        // Records have the number.
        read.threads = threads_of(py, threads.unwrap_or(read.threads))?.count();
        Ok(Self {
            experiment: read,
            file,
        })
    }

    /// The title.
    #[getter]
    fn title(&self) -> &str {
        &self.experiment.title
    }

    /// How many renders there are, but those of references.
    #[getter]
    fn cells(&self) -> usize {
        self.experiment.run_count()
    }

    /// Runs what has no record yet, and tells `hear` what happens. Returns the results as JSON, and
    /// tables of them as text.
    fn run(
        &self,
        py: Python<'_>,
        folder: PathBuf,
        restart: bool,
        machine: Option<&str>,
        hear: Option<Py<PyAny>>,
    ) -> PyResult<(Option<String>, String)> {
        let setup = self.setup(py, folder, restart, machine)?;
        let tell = |py: Python<'_>, told: Heard| tell(py, hear.as_ref(), told);
        let outcome = wait(py, tell, |stop, sender| {
            let mut reporter = Reporter::new(stop, sender);
            experiment::run(&self.experiment, &setup, &mut reporter)
        })?;
        let Outcome { results, .. } = outcome.map_err(|error| of_experiment(py, &error))?;
        let sections = results.as_ref();
        let sections = sections.map(|results| self.experiment.sections(results));
        let sections = sections.unwrap_or_default();
        if let Some(results) = &results {
            let command = format!("bidir experiment {} -o FOLDER", self.file.display());
            let written = experiment::write_page(&setup.folder, results, &sections, &command);
            written.map_err(|error| of_experiment(py, &error))?;
        }
        let tables = sections.iter().flat_map(|section| &section.tables);
        let tables: Vec<_> = tables.map(lab::report::table_text).collect();
        Ok((json(results.as_ref()), tables.join("\n")))
    }

    /// Makes everything but records. None: it was stopped.
    fn prepare(
        &self,
        py: Python<'_>,
        folder: PathBuf,
        restart: bool,
        machine: &str,
        hear: Option<Py<PyAny>>,
    ) -> PyResult<Option<Prepared>> {
        let setup = self.setup(py, folder, restart, Some(machine))?;
        let tell = |py: Python<'_>, told: Heard| tell(py, hear.as_ref(), told);
        let prepared = wait(py, tell, |stop, sender| {
            let mut reporter = Reporter::new(stop, sender);
            experiment::prepare(&self.experiment, &setup, &mut reporter)
        })?;
        let prepared = prepared.map_err(|error| of_experiment(py, &error))?;
        Ok(prepared.map(Prepared))
    }
}

impl Experiment {
    /// Where it runs; the results do not replace the description.
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

fn tell(py: Python<'_>, hear: Option<&Py<PyAny>>, told: Heard) -> PyResult<()> {
    hear.map_or(Ok(()), |hear| hear.call1(py, told).map(drop))
}

/// Where an experiment runs; `machine` is what `machine()` said there. None: it is this one.
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

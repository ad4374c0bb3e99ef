//! Renders, pass by pass.

use crate::error::raise;
use crate::film::{Film, Inputs};
use crate::scene::Scene;
use crate::settings::{Requested, resolve, threads_of, warn};
use crate::wait::{Stop, wait_silently};
use bidir::driver::{self, Budget, Resources};
use bidir::film::FilmError;
use formats::film::{OpenError, Render, TrainingLimits, Watch};
use pyo3::prelude::*;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// A render, pass by pass.
#[pyclass(frozen, module = "bidir._bidir")]
pub(crate) struct Session {
    /// The state, shared by Python threads.
    state: Mutex<State>,
    threads: usize,
}

/// The limits of a render.
#[derive(Clone, Copy, FromPyObject)]
struct Limits {
    #[pyo3(item)]
    spp: Option<u64>,
    /// The time. Unit: seconds.
    #[pyo3(item)]
    time: Option<f64>,
    #[pyo3(item)]
    noise: Option<f64>,
}

/// Returns the duration nearest to `seconds`.
fn duration(seconds: f64) -> Duration {
    let nearest = if seconds > 0.0 {
        Duration::MAX
    } else {
        Duration::ZERO
    };
    Duration::try_from_secs_f64(seconds).unwrap_or(nearest)
}

/// Returns the moment after `left` seconds. None: there is no limit.
fn deadline(left: Option<f64>) -> Option<Instant> {
    Instant::now().checked_add(duration(left?))
}

struct State {
    render: Render,
    /// The files read for the scene and for added films.
    inputs: Inputs,
}

/// Returns a host that stops on request.
fn watch(stop: &Stop) -> Watch<'_> {
    Watch {
        stop: driver::Stop::when(stop.flag()),
        start: Instant::now(),
    }
}

impl Session {
    /// Calls `f` with the state; other Python threads run while this one waits for it.
    fn with<T: Send>(&self, py: Python<'_>, f: impl FnOnce(&mut State) -> T + Send) -> T {
        py.detach(|| f(&mut self.lock()))
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        // A pass that panicked left the state unchanged.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Returns the error for a film that has no memory.
fn no_memory(py: Python<'_>, error: &FilmError) -> PyErr {
    raise(py, "RenderError", &format!("another film: {error}"))
}

#[pymethods]
impl Session {
    /// Starts a session without passes; `bidir.Session` makes `requested`. `time` is that of the render, of which training
    /// takes a part, `left` the time that is left for training. Unit: seconds.
    #[new]
    fn new(
        py: Python<'_>,
        scene: &Scene,
        requested: Requested,
        threads: usize,
        training: Option<u64>,
        time: Option<f64>,
        left: Option<f64>,
    ) -> PyResult<Self> {
        let settings = resolve(py, &requested, &scene.settings)?;
        let resources = Resources {
            threads: threads_of(py, threads)?.count(),
            ..Resources::default()
        };
        let limits = TrainingLimits {
            samples: training.unwrap_or(u64::MAX),
            time: time.map(duration),
        };
        let subject = scene.loaded.subject();
        let begun = wait_silently(py, deadline(left), |stop| {
            subject.begin(&settings, &resources, limits, &watch(stop))
        })?;
        let render = begun.map_err(|error| match &error {
            driver::SessionError::NoPath { .. } => raise(py, "SettingsError", &error.to_string()),
            driver::SessionError::Film(error) => scene.too_large(py, error),
            driver::SessionError::Stopped => {
                let text =
                    "the time ended in training: give it more time, or make the image smaller";
                raise(py, "RenderError", text)
            }
        })?;
        if let Some(shortage) = render.session.shortage() {
            warn(py, &shortage.to_string())?;
        }
        Ok(Self {
            threads: render.session.threads(),
            state: Mutex::new(State {
                render,
                inputs: scene.inputs.clone(),
            }),
        })
    }

    /// Renders the next pass, and returns true. If a signal or the end of the time `left` interrupts it, drops the pass
    /// and returns false. Unit: seconds.
    #[pyo3(signature = (left = None))]
    fn step(&self, py: Python<'_>, left: Option<f64>) -> PyResult<bool> {
        wait_silently(py, deadline(left), |stop| {
            self.lock().render.step(&watch(stop))
        })
    }

    /// Skips the passes before `first`.
    fn start_at(&self, py: Python<'_>, first: u64) {
        self.with(py, |state| state.render.session.start_at(first));
    }

    /// Adds a film of the same render; its passes are not rendered again.
    fn add_film(&self, py: Python<'_>, film: &Film) -> PyResult<()> {
        let added = self.with(py, |state| {
            let inputs = film.inputs();
            state.render.add(film.file().clone())?;
            state.inputs.extend(inputs.iter().cloned());
            Ok(())
        });
        added.map_err(|error: OpenError| raise(py, "FilmError", &error.to_string()))
    }

    /// Copies the film.
    fn film(&self, py: Python<'_>) -> PyResult<Film> {
        if let Some(blank) = self.with(py, |state| state.render.session.blank_warning()) {
            warn(py, &blank)?;
        }
        let film = self.with(py, |state| {
            Ok(Film::new(state.render.file()?, state.inputs.clone()))
        });
        film.map_err(|error| no_memory(py, &error))
    }

    /// Takes the film; the session continues with an empty one.
    fn take_film(&self, py: Python<'_>) -> PyResult<Film> {
        let film = self.with(py, |state| {
            Ok(Film::new(state.render.take()?, state.inputs.clone()))
        });
        film.map_err(|error| no_memory(py, &error))
    }

    /// Returns the pass that `step` renders next.
    #[getter]
    fn next_pass(&self, py: Python<'_>) -> u64 {
        self.with(py, |state| state.render.session.next_pass())
    }

    /// Returns the finished passes, each range with its exclusive end.
    #[getter]
    fn passes(&self, py: Python<'_>) -> Vec<(u64, u64)> {
        self.with(py, |state| {
            crate::film::ranges(state.render.session.film().passes())
        })
    }

    /// Returns the estimated relative error of the image.
    #[getter]
    fn noise(&self, py: Python<'_>) -> f64 {
        self.with(py, |state| state.render.session.noise())
    }

    /// Returns true if one of these limits ends the render before its next pass.
    fn reached(&self, py: Python<'_>, limits: Limits) -> bool {
        let budget = Budget {
            first: 0,
            passes: limits.spp,
            time: limits.time.map(duration),
            noise: limits.noise,
        };
        self.with(py, |state| state.render.reached(&budget).is_some())
    }

    /// Returns the number of threads.
    #[getter]
    fn threads(&self) -> usize {
        self.threads
    }

    /// Returns every setting of the estimator by name, including automatic choices.
    #[getter]
    fn settings(&self, py: Python<'_>) -> crate::settings::Texts {
        self.with(py, |state| {
            lab::experiment::texts(state.render.session.settings())
        })
    }

    /// Returns the hash of everything that the bits depend on, except the passes.
    #[getter]
    fn identity(&self, py: Python<'_>) -> String {
        self.with(py, |state| state.render.identity().to_owned())
    }
}

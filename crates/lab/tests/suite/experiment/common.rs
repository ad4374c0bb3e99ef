use bidir_lab::experiment::{self, End, Event, Experiment, ExperimentError, Observer, Outcome};
use bidir_lab::experiment::{Setup, Start};
use bidir_lab::results::{Machine, Record, Results};
use std::fs;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use tempfile::TempDir;

/// A floor and a wall with a small light above them.
pub(crate) const SCENE: &str = r#"
LookAt 0 1 -4  0 1 0  0 1 0
Camera "perspective" "float fov" 40
Film "rgb" "integer xresolution" 16 "integer yresolution" 12
PixelFilter "box"
Sampler "independent"
Integrator "bdpt" "integer maxdepth" 4
WorldBegin
Material "diffuse" "rgb reflectance" [0.7 0.6 0.5]
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point3 P" [-2 0 -2 -2 0 2 2 0 2 2 0 -2]
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point3 P" [-2 0 2 -2 3 2 2 3 2 2 0 2]
Shape "sphere" "float radius" 0.4
AttributeBegin
AreaLightSource "diffuse" "rgb L" [9 8 7]
Shape "trianglemesh" "integer indices" [0 2 1 0 3 2]
  "point3 P" [-0.3 2.5 0 -0.3 2.5 0.6 0.3 2.5 0.6 0.3 2.5 0]
AttributeEnd
"#;

/// Two methods under two seeds.
pub(crate) const DESCRIPTION: &str = r#"
seeds = 2
threads = 1
[[scene]]
file = "room.pbrt"
reference-spp = 16
[[method]]
name = "all"
[[method]]
name = "one"
shadow-rays = "per-pair"
"#;

/// A temporary folder with a scene.
pub(crate) struct Workplace(TempDir);

impl Workplace {
    pub(crate) fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("room.pbrt"), SCENE).unwrap();
        Self(folder)
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn read(&self, text: &str) -> Result<Experiment, ExperimentError> {
        Experiment::read(text, &self.path("test.toml"))
    }

    /// Runs a description until `observer` stops it.
    pub(crate) fn run(
        &self,
        text: &str,
        out: &str,
        observer: &mut Watch,
    ) -> Result<Outcome, ExperimentError> {
        self.run_on(&Machine::default(), text, out, observer)
    }

    /// Runs a description on a machine.
    pub(crate) fn run_on(
        &self,
        machine: &Machine,
        text: &str,
        out: &str,
        observer: &mut Watch,
    ) -> Result<Outcome, ExperimentError> {
        let setup = Setup {
            folder: self.path(out),
            start: Start::Resume,
            program: "test".to_owned(),
            machine: machine.clone(),
        };
        experiment::run(&self.read(text)?, &setup, observer)
    }

    /// Runs a description to its end.
    pub(crate) fn complete(&self, text: &str, out: &str) -> Results {
        let outcome = self.run(text, out, &mut Watch::default()).unwrap();
        assert_eq!(outcome.end, End::Complete);
        outcome.results.unwrap()
    }

    /// Returns the error of running a description; its text and its hint have all `parts`.
    #[track_caller]
    pub(crate) fn refusal(&self, text: &str, out: &str, parts: &[&str]) -> ExperimentError {
        let error = self.run(text, out, &mut Watch::default()).unwrap_err();
        let said = format!("{error}; {}", error.hint().unwrap_or_default());
        assert!(parts.iter().all(|part| said.contains(part)), "{said}");
        error
    }
}

/// Counts events, and can stop after some of them. Each reading advances the clock by one second, and the
/// processor time by two.
#[derive(Default)]
pub(crate) struct Watch {
    pub(crate) renders: usize,
    most: Option<usize>,
    pub(crate) resumed: usize,
    pub(crate) warnings: Vec<String>,
    /// Passes of images of strategies.
    pub(crate) strategy_passes: usize,
    strategy_most: Option<usize>,
    flag: Arc<AtomicBool>,
    looks: std::cell::Cell<u32>,
    looks_at_processors: std::cell::Cell<u32>,
}

impl Watch {
    /// Stops after `passes` passes of images of strategies.
    pub(crate) fn at_strategy_pass(passes: usize) -> Self {
        Self {
            strategy_most: Some(passes),
            ..Self::default()
        }
    }

    /// Stops after `renders` renders.
    pub(crate) fn until(renders: usize) -> Self {
        Self {
            most: Some(renders),
            ..Self::default()
        }
    }
}

impl Observer for Watch {
    fn notify(&mut self, event: Event<'_>) {
        match event {
            Event::Record(_) => self.renders += 1,
            Event::Pyramid { .. } => self.strategy_passes += 1,
            Event::Begin { done, .. } => self.resumed = done,
            Event::Warning(text) => self.warnings.push(text.to_owned()),
            Event::Reference { .. } => {}
        }
        let is_beyond = |most: Option<usize>, done: usize| most.is_some_and(|most| done >= most);
        // The event of a pass precedes it.
        let strategies = self.strategy_most.map(|most| most + 1);
        let is_last =
            is_beyond(self.most, self.renders) || is_beyond(strategies, self.strategy_passes);
        self.flag.fetch_or(is_last, Ordering::Relaxed);
    }

    fn seconds(&self) -> f64 {
        self.looks.set(self.looks.get() + 1);
        f64::from(self.looks.get())
    }

    fn processor_seconds(&self) -> Option<f64> {
        let looks = &self.looks_at_processors;
        looks.set(looks.get() + 1);
        Some(2.0 * f64::from(looks.get()))
    }

    fn stop_flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.flag)
    }
}

/// Clears the times of records.
pub(crate) fn without_times(records: &[Record]) -> Vec<Record> {
    let mut records = records.to_vec();
    for record in &mut records {
        (record.seconds, record.efficiency_seconds) = (0.0, 0.0);
        (record.processor_seconds, record.training_seconds) = (None, None);
        record.training_processor_seconds = None;
    }
    records
}

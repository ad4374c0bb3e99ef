//! `bidir render`: a scene becomes an image.

use crate::args::RenderArgs;
use crate::console::{Console, Display, json, say};
use crate::exit::{Exit, Failure};
use crate::output::{Outputs, write_text};
use crate::progress::{Clock, Reporter};
use crate::replay;
use crate::scene_io::{self, LoadedScene};
use crate::settings::{self, Budget};
use crate::signals::Signals;
use crate::stats::{Report, Times};
use bidir::driver::{Resources, Session, SessionError, Settings};
use std::path::Path;
use std::time::{Duration, Instant};

/// Renders a scene, or repeats one sample.
pub(crate) fn run(args: &RenderArgs, console: Console) -> Result<Exit, Failure> {
    set_threads(args.budget.threads)?;
    let start = Instant::now();
    let loaded = scene_io::load(&args.scene, Some(&args.film))?;
    let load = start.elapsed();
    let settings = settings::resolve(&args.estimator, loaded.settings.clone());
    let unused = settings::warn_unused(&args.estimator, &settings, console);
    loaded.tell_warnings(&args.scene, unused, console)?;
    if let Some(target) = args.replay {
        let session = new_session(args, &loaded, &settings)?;
        return replay::run(args, &loaded.scene, &session, target);
    }
    let outputs = Outputs::new(&args.output, &args.scene.scene, loaded.output.as_deref())?;
    outputs.check()?;
    Job {
        args,
        console,
        loaded: &loaded,
        settings: &settings,
        outputs: &outputs,
    }
    .run(load)
}

/// The threads that build the scene; the session has its own.
fn set_threads(threads: u16) -> Result<(), Failure> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads.into())
        .build_global()
        .map_err(|error| {
            let message = format!("{threads} threads cannot be started: {error}");
            Failure::new(Exit::RenderFailed, message)
        })
}

fn new_session<'a>(
    args: &RenderArgs,
    loaded: &'a LoadedScene,
    settings: &Settings,
) -> Result<Session<'a>, Failure> {
    let resources = Resources {
        threads: args.budget.threads.into(),
        ..Resources::default()
    };
    Session::new(&loaded.scene, settings.clone(), &resources).map_err(|error| {
        if matches!(error, SessionError::Threads(_)) {
            return Failure::new(Exit::RenderFailed, error.to_string());
        }
        let [width, height] = loaded.scene.film().resolution;
        let scene = args.scene.scene.display();
        let message = format!("{scene}: a film of {width} x {height} pixels is too large: {error}");
        let hint = "make it smaller with --size, or render a part of it with --crop";
        Failure::new(Exit::Scene, message).with_hint(hint)
    })
}

/// A render that nothing but a signal, a full disk or a bug can keep from an image.
struct Job<'a> {
    args: &'a RenderArgs,
    console: Console,
    loaded: &'a LoadedScene,
    settings: &'a Settings,
    outputs: &'a Outputs,
}

impl Job<'_> {
    fn run(&self, load: Duration) -> Result<Exit, Failure> {
        let budget = Budget::new(&self.args.budget, self.loaded.spp);
        let signals = Signals::watch()?;
        let start = Instant::now();
        let mut session = new_session(self.args, self.loaded, self.settings)?;
        self.render(&mut session, budget, start, &signals);
        let times = Times {
            load,
            render: start.elapsed(),
        };
        let passes = session.film().passes();
        // A signal that came too late stopped nothing.
        let stopped = signals.exit().filter(|_| budget.passes != Some(passes));
        if passes == 0 {
            self.console
                .warning("stopped before the first pass: nothing is written");
            return Ok(stopped.unwrap_or(Exit::RenderFailed));
        }
        let scene = self.args.scene.scene.display().to_string();
        let bvh = self.loaded.scene.bvh();
        let report = Report::new(scene, &session, self.settings, budget, times, bvh);
        self.write(&session, &report)?;
        self.tell(&report);
        Ok(stopped.unwrap_or(Exit::Done))
    }

    /// Renders pass by pass until the budget is used up or a signal comes.
    fn render(&self, session: &mut Session<'_>, budget: Budget, start: Instant, signals: &Signals) {
        let quiet = self.args.output.quiet;
        let display = if quiet {
            Display::Silent
        } else {
            self.console.display()
        };
        let samples_per_pass = self.loaded.scene.film().crop.area();
        let reporter = Reporter::new(
            display,
            signals,
            Clock {
                budget,
                samples_per_pass,
                start,
            },
        );
        let first = Instant::now();
        loop {
            let passes = session.film().passes();
            // A pass is expected to take as long as those before took on average.
            let expected = first.elapsed().div_f64(passes.max(1) as f64);
            if signals.exit().is_some() || !budget.allows(passes, start.elapsed(), expected) {
                break;
            }
            session.step(&reporter);
        }
        reporter.finish();
    }

    fn write(&self, session: &Session<'_>, report: &Report) -> Result<(), Failure> {
        let film = session.film();
        self.outputs
            .write_image(film.settings(), &film.develop(), &report.metadata())?;
        let Some(path) = &self.outputs.stats else {
            return Ok(());
        };
        write_text(Path::new(path), &(json(report)? + "\n"))
    }

    /// Tells what was done.
    fn tell(&self, report: &Report) {
        if let Some(warning) = report.warning() {
            self.console.warning(warning);
        }
        if !self.args.output.quiet {
            let files = self.outputs.names();
            say(format_args!("{}; wrote {files}", report.summary()));
        }
    }
}

//! Starts a render: trains its session, which may take longer than the passes.

use crate::args::RenderArgs;
use crate::checkpoint;
use crate::console::{Console, Display};
use crate::exit::Failure;
use crate::render::Job;
use crate::scene_io::{self, FilmFile};
use bidir::driver::{Budget, Resources, SessionError, Stop};
use formats::film::{OpenError, Render, Watch};
use std::time::{Duration, Instant};

/// The time after which a message says that training is running.
const LONG: Duration = Duration::from_secs(2);

/// Begins and trains a render with this budget, which continues the film `earlier`. None: a signal or the end of the
/// time came first.
///
/// Errors: the film to continue belongs to another render; the session cannot begin.
pub(crate) fn render(
    job: &Job<'_>,
    budget: Budget,
    earlier: Option<FilmFile>,
    start: Instant,
) -> Result<Option<Box<Render>>, Failure> {
    let (subject, settings) = (job.loaded.subject(), job.settings.clone());
    let (resources, stop) = (resources(job.args), job.signals.stop_flag());
    let train = move || {
        let stop = Stop::when(&stop);
        let host = Watch { stop, start };
        let opened = subject.open(&settings, &resources, &budget, earlier, &host);
        opened.map(Box::new)
    };
    let mut is_said = false;
    let tick = || {
        if !is_said && start.elapsed() >= LONG {
            is_said = true;
            display(job.args, job.console).say("training before the first sample");
        }
    };
    let render = match job.signals.wait_for(train, tick) {
        Some(Err(OpenError::Session(SessionError::Stopped))) | None => return Ok(None),
        Some(render) => render.map_err(|error| failure(job, &error))?,
    };
    if let Some(shortage) = render.session.shortage() {
        job.console.warning(shortage);
    }
    Ok(Some(render))
}

/// Returns the form of progress. With --json, only the replay is on stdout.
fn display(args: &RenderArgs, console: Console) -> Display {
    match console.display(args.output.talk) {
        Display::OpenJd if args.json => Display::Silent,
        display => display,
    }
}

fn resources(args: &RenderArgs) -> Resources {
    Resources {
        threads: args.threads.count.into(),
        clock: args.output.stats.is_some().then_some(Instant::now),
        ..Resources::default()
    }
}

/// Returns the failure of the command for a render that cannot begin.
fn failure(job: &Job<'_>, error: &OpenError) -> Failure {
    match error {
        OpenError::Session(SessionError::Film(error)) => scene_io::too_large(job.loaded, error),
        OpenError::Session(error) => Failure::usage(error.to_string()),
        error => checkpoint::mismatch(&job.args.long, error),
    }
}

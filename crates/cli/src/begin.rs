//! The beginning of a render: the session, whose training may take longer than its passes.

use crate::args::RenderArgs;
use crate::console::{Console, Display, LineFormat, say};
use crate::exit::{Exit, Failure};
use crate::film_header;
use crate::progress::write_openjd;
use crate::scene_io::{FilmHeader, LoadedScene};
use crate::signals::Signals;
use bidir::driver::{Effort, Resources, Session, SessionError, Settings};
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

/// Signals are looked at this often.
const GAP: Duration = Duration::from_millis(100);
/// The gaps without a session after which a message says why.
const LONG: u32 = 20;
/// So long after the end of the time budget training may still end.
const GRACE: Duration = Duration::from_secs(1);

/// The training of a render.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Training {
    /// As long as it takes.
    Whole,
    /// The same, but cut short where it does not end by then.
    By(Instant),
    /// Cut short from the first, as it was when the render began that is gone on with.
    Short,
}

impl Training {
    /// That of a render that begins now with so much time, and goes on with the film of `earlier`: training
    /// is then what it was.
    pub(crate) fn new(time: Option<Duration>, earlier: Option<&FilmHeader>) -> Self {
        let end = time.and_then(|time| Instant::now().checked_add(time.saturating_add(GRACE)));
        match (earlier, end) {
            (Some(earlier), _) if film_header::is_short(earlier) => Self::Short,
            (None, Some(end)) => Self::By(end),
            (Some(_), _) | (None, None) => Self::Whole,
        }
    }
}

/// The beginning of a render.
pub(crate) enum Began {
    /// A session that is trained.
    Session(Box<Session<'static>>),
    /// Nothing: a signal came before, and asks to end so.
    Stopped(Exit),
}

/// The session of a render, trained. A signal ends that at once: no pass would be lost with it, and there
/// may be minutes to wait for, which `display` is told of.
pub(crate) fn session(
    args: &RenderArgs,
    loaded: &LoadedScene,
    settings: &Settings,
    signals: &Signals,
    (training, display): (Training, Display),
    console: Console,
) -> Result<Began, Failure> {
    let (scene, settings) = (Arc::clone(&loaded.scene), settings.clone());
    let resources = resources(args);
    let train = move || {
        let is_late = || matches!(training, Training::By(end) if Instant::now() >= end);
        let effort = match training {
            Training::Whole => Effort::Whole,
            Training::By(_) => Effort::Until(&is_late),
            Training::Short => Effort::Short,
        };
        Session::with_effort(scene, settings, &resources, effort).map(Box::new)
    };
    let (sender, receiver) = mpsc::channel();
    let in_thread = train.clone();
    // A training that nobody waits for ends with the process.
    let thread = thread::Builder::new().name("training".to_owned());
    let session = match thread.spawn(move || sender.send(in_thread())) {
        Ok(_) => match wait(&receiver, signals, display)? {
            Waited::Session(session) => session,
            Waited::Stopped(exit) => return Ok(Began::Stopped(exit)),
        },
        // Without a thread, signals are looked at afterwards.
        Err(_) => train(),
    };
    let session = session.map_err(|error| failure(args, loaded, &error))?;
    if let Some(shortage) = session.shortage() {
        console.warning(shortage);
    }
    Ok(Began::Session(session))
}

/// Whichever came first: a session, or a signal.
enum Waited {
    Session(Result<Box<Session<'static>>, SessionError>),
    Stopped(Exit),
}

/// Waits for a session that another thread trains.
fn wait(
    receiver: &Receiver<Result<Box<Session<'static>>, SessionError>>,
    signals: &Signals,
    display: Display,
) -> Result<Waited, Failure> {
    let mut waited = 0;
    loop {
        match (receiver.recv_timeout(GAP), signals.exit()) {
            (Ok(session), _) => return Ok(Waited::Session(session)),
            (Err(RecvTimeoutError::Timeout), None) => waited += 1,
            (Err(RecvTimeoutError::Timeout), Some(exit)) => return Ok(Waited::Stopped(exit)),
            (Err(RecvTimeoutError::Disconnected), _) => {
                return Err(Failure::new(Exit::RenderFailed, "the training failed"));
            }
        }
        if waited == LONG {
            tell_training(display);
        }
    }
}

/// Says why there is no progress yet.
fn tell_training(display: Display) {
    let text = "training before the first sample";
    match display {
        // Nothing but objects is expected there.
        Display::Silent | Display::Lines(LineFormat::Ndjson) => {}
        Display::Lines(LineFormat::OpenJd) => write_openjd("status", text),
        Display::Bar | Display::Lines(LineFormat::Plain) => say(text),
    }
}

fn resources(args: &RenderArgs) -> Resources {
    Resources {
        threads: args.threads.count.into(),
        clock: args.output.stats.is_some().then_some(Instant::now),
        ..Resources::default()
    }
}

/// Why there is no session.
fn failure(args: &RenderArgs, loaded: &LoadedScene, error: &SessionError) -> Failure {
    if matches!(error, SessionError::NoPath { .. }) {
        return Failure::usage(error.to_string());
    }
    let [width, height] = loaded.scene.film().resolution;
    let scene = args.scene.scene.display();
    let message = format!("{scene}: a film of {width} x {height} pixels is too large: {error}");
    let hint =
        "make it smaller with --size, render a part of it with --crop, or ask for fewer layers";
    Failure::new(Exit::Scene, message).with_hint(hint)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_goes_on_trains_as_before() {
        let header = |settings: &[(&str, &str)]| {
            let settings = settings.iter();
            let settings = settings.map(|&(name, value)| (name.to_owned(), value.to_owned()));
            FilmHeader::new("bidir", "room.pbrt".to_owned(), settings.collect())
        };
        let (whole, short) = (
            header(&[("trained-mean", "1e0")]),
            header(&[("trained-mean", "1e0"), ("training", "short")]),
        );
        for time in [None, Some(Duration::from_secs(2)), Some(Duration::MAX)] {
            assert!(matches!(Training::new(time, Some(&whole)), Training::Whole));
            assert!(matches!(Training::new(time, Some(&short)), Training::Short));
        }
        assert!(matches!(Training::new(None, None), Training::Whole));
        assert!(matches!(
            Training::new(Some(Duration::MAX), None),
            Training::Whole
        ));
        let by = Training::new(Some(Duration::from_secs(2)), None);
        assert!(matches!(by, Training::By(end) if end > Instant::now() + Duration::from_secs(2)));
    }
}

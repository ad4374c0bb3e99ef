//! How a render begins: with the session, whose training may take longer than its passes.

use crate::args::RenderArgs;
use crate::console::{Console, Display, LineFormat, say};
use crate::exit::{Exit, Failure};
use crate::progress::tell_openjd;
use crate::scene_io::LoadedScene;
use crate::signals::Signals;
use bidir::driver::{Resources, Session, SessionError, Settings};
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

/// Signals are looked at this often.
const GAP: Duration = Duration::from_millis(100);
/// After so many gaps without a session it is told why.
const LONG: u32 = 20;

/// What a render begins with.
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
    display: Display,
    console: Console,
) -> Result<Began, Failure> {
    let (scene, settings) = (Arc::clone(&loaded.scene), settings.clone());
    let resources = resources(args);
    let train = move || Session::new(scene, settings, &resources).map(Box::new);
    let (sender, receiver) = mpsc::channel();
    let in_thread = train.clone();
    // What nobody waits for any more ends with the process.
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

/// What came first of a session and a signal.
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
        Display::Lines(LineFormat::OpenJd) => tell_openjd("status", text),
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

//! How a render begins: with the session, whose training may take longer than its passes.

use crate::args::RenderArgs;
use crate::console::{Display, LineFormat, say};
use crate::exit::{Exit, Failure};
use crate::progress::tell_openjd;
use crate::scene_io::LoadedScene;
use crate::signals::Signals;
use bidir::driver::{Resources, Session, SessionError, Settings};
use std::sync::Arc;
use std::sync::mpsc::{self, RecvTimeoutError};
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
) -> Result<Began, Failure> {
    let (scene, settings) = (Arc::clone(&loaded.scene), settings.clone());
    let resources = resources(args);
    let (sender, receiver) = mpsc::channel();
    // What nobody waits for any more ends with the process.
    thread::spawn(move || sender.send(Session::new(scene, settings, &resources).map(Box::new)));
    let mut waited = 0;
    loop {
        match (receiver.recv_timeout(GAP), signals.exit()) {
            (Ok(session), _) => {
                let session = session.map_err(|error| failure(args, loaded, &error))?;
                return Ok(Began::Session(session));
            }
            (Err(RecvTimeoutError::Timeout), None) => waited += 1,
            (Err(RecvTimeoutError::Timeout), Some(exit)) => return Ok(Began::Stopped(exit)),
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
    if matches!(error, SessionError::Threads(_)) {
        return Failure::new(Exit::RenderFailed, error.to_string());
    }
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

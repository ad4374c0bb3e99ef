//! `bidir view`: a scene rendered in the browser.

use crate::args::ViewArgs;
use crate::console::{Console, print, say};
use crate::exit::{Exit, Failure};
use crate::render::set_threads;
use crate::scene_io::{self, LoadedScene};
use crate::settings;
use crate::signals::Signals;
use bidir::driver::Settings;
use std::io;
use std::net::{SocketAddr, TcpListener};
use std::path::PathBuf;
use std::time::Duration;
use viewer::desk;
use viewer::studio::{Studio, StudioSettings};
use viewer::web::{self, Server};

/// The port where none is asked for,
const PORT: u16 = 8080;
/// and how many after it are tried.
const MORE_PORTS: u16 = 10;
/// How often it is looked for signals.
const GAP: Duration = Duration::from_millis(50);

/// Renders and serves until a signal comes.
pub(crate) fn run(args: &ViewArgs, console: Console) -> Result<Exit, Failure> {
    let signals = Signals::watch()?;
    set_threads(args.threads)?;
    // What is wrong without a scene is told before one is read.
    let listener = listen(args)?;
    let loaded = scene_io::load(&args.scene, Some(&args.film))?;
    let settings = settings::resolve(&args.estimator, loaded.settings.clone());
    // Every flag may have influence: estimators are switched.
    loaded.tell_warnings(&args.scene, 0, console)?;
    let (desk, link) = desk();
    for warning in &loaded.warnings {
        desk.board().log(&format!("warning: {warning}"));
    }
    let server = Server::start(listener, link.clone()).map_err(|error| no_thread(&error))?;
    let studio = studio_settings(args, loaded, settings);
    let studio = Studio::open(studio, desk, link).map_err(|error| no_thread(&error))?;
    print(&format!("{}\n", server.url()))?;
    if !args.quiet {
        say("open it in a browser; Ctrl-C ends");
    }
    let exit = wait(&signals, &studio);
    drop(server);
    tell_saved(args, studio.close())?;
    Ok(exit)
}

/// Waits for a signal.
fn wait(signals: &Signals, studio: &Studio) -> Exit {
    loop {
        if let Some(exit) = signals.exit() {
            return exit;
        }
        if studio.is_finished() {
            return Exit::RenderFailed;
        }
        std::thread::sleep(GAP);
    }
}

/// Tells what clients had written.
fn tell_saved(args: &ViewArgs, saved: Option<Vec<String>>) -> Result<(), Failure> {
    let Some(saved) = saved else {
        return Err(Failure::new(Exit::RenderFailed, "the render failed"));
    };
    if !args.quiet {
        let names = saved.join(", ");
        say(if saved.is_empty() {
            "stopped; nothing was saved".to_owned()
        } else {
            format!("stopped; saved {names}")
        });
    }
    Ok(())
}

fn studio_settings(args: &ViewArgs, loaded: LoadedScene, settings: Settings) -> StudioSettings {
    StudioSettings {
        name: args.scene.scene.display().to_string(),
        digest: loaded.digest,
        scene: loaded.scene,
        settings,
        roulette: args.estimator.path_roulette,
        threads: args.threads.count.into(),
        target: args.spp,
        folder: PathBuf::from("."),
    }
}

fn listen(args: &ViewArgs) -> Result<TcpListener, Failure> {
    let (port, more) = match args.port {
        Some(port) => (port, 0),
        None => (PORT, MORE_PORTS),
    };
    let address = SocketAddr::new(args.bind, port);
    web::listen(address, more).map_err(|error| unbound(address, &error))
}

/// A port cannot be served on.
pub(crate) fn unbound(address: SocketAddr, error: &io::Error) -> Failure {
    let hint = match error.kind() {
        io::ErrorKind::AddrInUse => "another program has it: take another port, or 0 for any",
        io::ErrorKind::PermissionDenied => "ports below 1024 are the system's: take another",
        _ => "take an address of this machine: 127.0.0.1, or 0.0.0.0 for all",
    };
    let message = format!("cannot serve on {address}: {error}");
    Failure::new(Exit::InputOutput, message).with_hint(hint)
}

/// The system gives no thread.
pub(crate) fn no_thread(error: &io::Error) -> Failure {
    Failure::new(
        Exit::RenderFailed,
        format!("the server cannot start: {error}"),
    )
}

//! `bidir view`: a scene rendered in the browser.

use crate::args::ViewArgs;
use crate::console::{Console, say};
use crate::exit::{Exit, Failure};
use crate::scene_io::{self, LoadedScene};
use crate::serve;
use crate::settings;
use crate::signals::Signals;
use crate::threads;
use bidir::driver::Settings;
use std::net::{SocketAddr, TcpListener};
use std::path::PathBuf;
use std::time::Duration;
use viewer::studio::{Studio, StudioSettings};
use viewer::{Choices, Status};

/// The port where no scene was chosen,
const PORT: u16 = 8080;
/// and how many after it are tried.
const MORE_PORTS: u16 = 10;
/// How often it is looked for signals.
const GAP: Duration = Duration::from_millis(50);

/// Renders and serves until a signal comes.
pub(crate) fn run(args: &ViewArgs, console: Console) -> Result<Exit, Failure> {
    let signals = Signals::watch()?;
    threads::start(args.threads.count, console);
    // What is wrong without a scene is told before one is read.
    let listener = listen(args)?;
    let loaded = scene_io::load(&args.scene, Some(&args.film))?;
    let settings = args.estimator.apply(&loaded.settings);
    // Every flag may have influence: estimators are switched.
    let lost = settings::check_strategies("--strategies", &loaded.scene, &settings, console)?;
    let missing = settings::warn_missing(&loaded, &settings, console);
    loaded.tell_warnings(&args.scene, lost + missing, console)?;
    let (server, desk) = serve::start(listener, first_status(args, &loaded), &loaded.warnings)?;
    let studio = studio_settings(args, loaded, settings);
    let studio = Studio::open(studio, desk).map_err(|error| serve::failed(&error))?;
    if !args.quiet {
        say("open it in a browser; Ctrl-C ends");
    }
    let exit = wait(&signals, &studio);
    drop(server);
    tell_saved(args, studio.close())?;
    Ok(exit)
}

/// What is told before the first lane begins.
fn first_status(args: &ViewArgs, loaded: &LoadedScene) -> Status {
    let name = args.scene.scene.display().to_string();
    Status {
        controls: true,
        choices: Choices::all(),
        ..Status::preparing(&name, loaded.scene.film())
    }
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
    serve::bind(address, more)
}

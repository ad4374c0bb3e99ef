//! `bidir view`: a scene rendered in the browser.

use crate::args::ViewArgs;
use crate::console::{Console, say};
use crate::exit::{Exit, Failure};
use crate::scene_io;
use crate::serve;
use crate::settings;
use crate::signals::Signals;
use crate::threads;
use bidir::driver::Resources;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Duration;
use viewer::Status;
use viewer::interactive::{InteractiveRender, InteractiveSettings};

/// The default port.
const PORT: u16 = 8080;
/// Number of ports after the default one that are tried.
const MORE_PORTS: u16 = 10;
/// The time between two checks for signals.
const GAP: Duration = Duration::from_millis(50);

/// Renders and serves until a signal comes.
pub(crate) fn run(args: &ViewArgs, console: Console) -> Result<Exit, Failure> {
    let signals = Signals::watch()?;
    threads::start(args.threads.count, console);
    // Errors that need no scene come before one is read.
    let (port, more) = args.port.map_or((PORT, MORE_PORTS), |port| (port, 0));
    let listener = serve::bind(SocketAddr::new(args.bind, port), more)?;
    let Some(loaded) = scene_io::load_until(&signals, &args.scene, Some(&args.film))? else {
        return Ok(signals.ended());
    };
    let settings = args.estimator.apply(&loaded.settings.render_settings());
    // Every flag may have influence: estimators are switched.
    let lost = settings::check_light("--strategies", &loaded, &settings, console)?;
    scene_io::print_warnings(&loaded, &args.scene, lost, console)?;
    let first = Status::interactive(&loaded.name, loaded.view.film());
    let (server, queue) = serve::start(listener, first, &loaded.warnings)?;
    let wanted = InteractiveSettings {
        subject: loaded.subject(),
        settings,
        roulette: args.estimator.path_roulette,
        resources: Resources {
            threads: args.threads.count.into(),
            ..Resources::default()
        },
        target: args.spp,
        folder: PathBuf::from("."),
    };
    let render = InteractiveRender::open(wanted, queue).map_err(|error| serve::failed(&error))?;
    if !args.quiet {
        say("open it in a browser; Ctrl-C ends");
    }
    let exit = wait(&signals, &render);
    drop(server);
    say_saved(args, render.close())?;
    Ok(exit)
}

/// Waits for a signal, or for the failure of the render.
fn wait(signals: &Signals, render: &InteractiveRender) -> Exit {
    loop {
        if let Some(exit) = signals.exit() {
            return exit;
        }
        if render.is_finished() {
            return Exit::RenderFailed;
        }
        std::thread::sleep(GAP);
    }
}

/// Prints the names of the files that clients saved.
fn say_saved(args: &ViewArgs, saved: Option<Vec<String>>) -> Result<(), Failure> {
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

//! `bidir experiment`: compares methods as a description says, and writes a report.

mod claims;
mod cluster;
mod watch;

use crate::args::{ExperimentArgs, TalkArgs};
use crate::checkpoint;
use crate::console::{Console, print, say};
use crate::exit::{Exit, Failure};
use crate::lock::FilmLock;
use crate::scene_io;
use crate::signals::Signals;
use crate::threads;
use bidir::driver::Threads;
use lab::experiment::{
    self, BUILTIN, Builtin, End, Experiment, ExperimentError, Outcome, PAGE, Setup, Start,
    write_page,
};
use lab::report::table_text;
use lab::results::Machine;
use std::path::Path;
use watch::Watch;

/// Runs an experiment, and prints its results.
pub(crate) fn run(args: &ExperimentArgs, console: Console) -> Result<Exit, Failure> {
    let signals = Signals::watch()?;
    if let Some(address) = &args.ray {
        return cluster::run(args, address, &signals);
    }
    threads::start(args.threads.count, console);
    let mut experiment = read(args)?;
    experiment.threads = threads(args, experiment.threads, console);
    let outcome = execute(&experiment, args, console, &signals)?;
    let Some(results) = &outcome.results else {
        return Ok(stopped(args, &signals));
    };
    let sections = experiment.sections(results);
    write_page(&args.folder(), results, &sections, &command(args)).map_err(failure)?;
    let mut parts: Vec<_> = results.claims.iter().map(claims::text).collect();
    let of_sections = sections.iter().flat_map(|section| &section.tables);
    parts.extend(of_sections.map(table_text));
    parts.extend(claims::methods(&results.claims));
    parts.extend(claims::summary(&results.claims));
    print(&parts.join("\n"))?;
    if outcome.end == End::Stopped {
        return Ok(stopped(args, &signals));
    }
    if !args.quiet {
        say(format_args!("wrote {}", args.folder().join(PAGE).display()));
    }
    Ok(Exit::Done)
}

/// Returns the command that repeats the experiment.
fn command(args: &ExperimentArgs) -> String {
    let begin = format!("bidir experiment {} -o FOLDER", args.description.display());
    let quick = args.quick.then(|| "--quick".to_owned());
    let words = std::iter::once(begin)
        .chain(quick)
        .chain(args.extent.words());
    words.collect::<Vec<_>>().join(" ")
}

/// Prints how to continue if a render finished, and returns the exit.
fn stopped(args: &ExperimentArgs, signals: &Signals) -> Exit {
    let restart = args.restart.then_some("--restart");
    let (text, exit) = checkpoint::stopped(&args.folder(), restart, signals);
    if !args.quiet {
        say(text);
    }
    exit
}

/// Returns the experiment of a file or a built-in one, with the extent that the flags give.
fn read(args: &ExperimentArgs) -> Result<Experiment, Failure> {
    let file = &args.description;
    let builtin = Builtin::named(file).map(Builtin::experiment);
    let mut experiment = match builtin {
        Some(experiment) => experiment.map_err(failure)?,
        None => described(file, &args.folder())?,
    };
    if args.quick {
        experiment = experiment.quick();
    }
    let extent = args.extent.extent();
    let within = experiment.within(&extent);
    within.map_err(|error| Failure::usage(format!("--scenes: {error}")))
}

/// Reads a description from a file. Errors: results in `folder` would replace it.
fn described(file: &Path, folder: &Path) -> Result<Experiment, Failure> {
    let read = std::fs::read_to_string(file);
    let text = read.map_err(|error| unreadable(file, &error))?;
    let experiment = Experiment::read(&text, file).map_err(failure)?;
    experiment::check_description(file, folder).map_err(failure)?;
    Ok(experiment)
}

/// Returns the failure to read a description. The hint suggests a built-in experiment of a similar name.
fn unreadable(file: &Path, error: &std::io::Error) -> Failure {
    let action = match error.kind() {
        std::io::ErrorKind::NotFound => "open",
        _ => "read",
    };
    let failure = Failure::io(file, action, error);
    let name = file.to_str().filter(|_| action == "open");
    let near =
        name.and_then(|name| bidir::names::nearest(name, BUILTIN.map(|builtin| builtin.name)));
    match (near, action) {
        (Some(near), _) => {
            failure.with_hint(format!("did you mean the built-in experiment `{near}`?"))
        }
        (None, "open") => failure.with_hint(other_file(file)),
        (None, _) => failure,
    }
}

/// Suggests an existing file for a missing description.
fn other_file(file: &Path) -> String {
    let standard = Path::new("experiments").join(file).with_extension("toml");
    let listed = Some(standard).filter(|listed| listed.is_file());
    match listed.or_else(|| scene_io::nearest_file(file)) {
        Some(near) => format!("did you mean `{}`?", near.display()),
        None => "name `paper`, `beyond` or a .toml file".to_owned(),
    }
}

/// Returns the number of threads of each render, for the records: the flag's, or else the description's.
fn threads(args: &ExperimentArgs, own: usize, console: Console) -> usize {
    match args.threads.count {
        0 => threads::limited(own, console).count(),
        // `threads::start` has warned already.
        requested => Threads::new(requested.into()).count(),
    }
}

/// Runs the missing renders, with a lock on the folder.
fn execute(
    experiment: &Experiment,
    args: &ExperimentArgs,
    console: Console,
    signals: &Signals,
) -> Result<Outcome, Failure> {
    let folder = args.folder();
    std::fs::create_dir_all(&folder).map_err(|error| Failure::io(&folder, "make", &error))?;
    let _lock = FilmLock::take(&folder.join("records.ndjson"))?;
    let setup = Setup {
        folder,
        start: if args.restart {
            Start::Anew
        } else {
            Start::Resume
        },
        program: formats::film::program(),
        machine: Machine::here(),
    };
    let talk = TalkArgs {
        quiet: args.quiet,
        progress: None,
    };
    let mut watch = Watch::new(console, console.display(talk), signals);
    let outcome = experiment::run(experiment, &setup, &mut watch);
    watch.finish();
    outcome.map_err(failure)
}

/// Returns the failure of the command for an error of the experiment.
fn failure(error: ExperimentError) -> Failure {
    let exit = match &error {
        ExperimentError::Description(_)
        | ExperimentError::Method { .. }
        | ExperimentError::NoReference(_) => Exit::Scene,
        ExperimentError::Mismatch(_) | ExperimentError::Elsewhere { .. } => Exit::FilmMismatch,
        ExperimentError::Render { .. } => Exit::RenderFailed,
        _ => Exit::InputOutput,
    };
    let text = error.to_string();
    match (error.hint().map(str::to_owned), error) {
        (hint, ExperimentError::Reference { error, .. }) => {
            let exit = Failure::from(error).exit();
            let anew = "make it again with `bidir reference`, or start over with --restart";
            Failure::new(exit, text).with_hint(hint.unwrap_or_else(|| anew.to_owned()))
        }
        // Errors of files show their lines.
        (_, ExperimentError::File(error)) => {
            Failure::diagnostic(scene_io::exit_of_scene(&error), error)
        }
        (Some(hint), _) => Failure::new(exit, text).with_hint(hint),
        (None, _) => Failure::new(exit, text),
    }
}

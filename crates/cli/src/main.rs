//! The `bidir` command: reads scenes, renders them, and compares images.
//!
//! The command collects settings, reads clocks and names files; the `bidir` library computes the light.
//! The documentation of the command is its help text.

mod args;
mod begin;
mod checkpoint;
mod compare;
mod console;
mod denoise;
mod exit;
mod experiment;
mod farm;
mod film;
mod info;
mod lock;
mod markdown;
mod output;
mod progress;
mod pyramid;
mod reference;
mod render;
mod replay;
mod scene_io;
mod serve;
mod settings;
mod shell;
mod signals;
mod stats;
mod threads;
mod tonemap;
mod view;

use args::{Cli, ColorArgs, Command};
use console::Console;
use exit::{Exit, Failure};
use std::process::ExitCode;

fn main() -> ExitCode {
    signals::end_without_memory();
    signals::survive_size_limits();
    let cli = match Cli::read() {
        Ok(cli) => cli,
        Err(printed) => return ended(printed, Console::new(ColorArgs::of_words())),
    };
    let console = Console::new(cli.color);
    for warning in &cli.renamed {
        console.warning(warning);
    }
    ended(run(&cli.command, console), console)
}

/// Reports a failure, and returns the exit code.
fn ended(result: Result<Exit, Failure>, console: Console) -> ExitCode {
    let own = match result {
        Ok(exit) => exit,
        Err(failure) => {
            console.failure(&failure);
            failure.exit()
        }
    };
    let lost = console::lost().filter(|_| own == Exit::Done);
    let exit = lost.map_or(own, |failure| {
        console.failure(&failure);
        failure.exit()
    });
    ExitCode::from(exit.code())
}

fn run(command: &Command, console: Console) -> Result<Exit, Failure> {
    match command {
        Command::Denoise(args) => threads::start(args.threads.count, console),
        Command::Info(_)
        | Command::Compare(_)
        | Command::Film(_)
        | Command::Merge(_)
        | Command::Missing(_)
        | Command::Tonemap(_) => threads::start(0_usize, console),
        // These watch signals first, or compute nothing.
        _ => {}
    }
    match command {
        Command::Render(args) => render::run(args, console)
            .inspect_err(|failure| progress::report_failure(args.output.talk, failure)),
        Command::View(args) => view::run(args, console),
        Command::Reference(args) => reference::run(args, console)
            .inspect_err(|failure| progress::report_failure(args.talk, failure)),
        Command::Info(args) => info::run(args, console),
        Command::Compare(args) => compare::run(args, console),
        Command::Experiment(args) => experiment::run(args, console),
        Command::Film(command) => film::run(command, console),
        Command::Merge(args) => film::merge(args),
        Command::Missing(args) => film::missing(args, console),
        Command::Tonemap(args) => tonemap::run(args),
        Command::Denoise(args) => denoise::run(args),
        Command::Farm(command) => farm::run(command),
        Command::Completions(args) => shell::completions(args),
        Command::Man(args) => shell::man(args),
    }
}

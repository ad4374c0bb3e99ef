//! The `bidir` command: it reads scenes, renders them, and compares images.
//!
//! The command is glue: settings are gathered here, clocks are read here, files are named here; the
//! light is computed in the `bidir` library. The documentation of the command is its help text.

mod args;
mod compare;
mod console;
mod exit;
mod info;
mod metrics;
mod output;
mod progress;
mod render;
mod replay;
mod resample;
mod scene_io;
mod settings;
mod shell;
mod signals;
mod stats;

use args::{Cli, Command};
use clap::Parser;
use console::Console;
use exit::{Exit, Failure};
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            // Help and version are such errors too. Where they cannot be printed, nothing can.
            let _ = error.print();
            return ExitCode::from(error.exit_code() as u8);
        }
    };
    let console = Console::new(cli.color);
    let exit = match run(&cli.command, console) {
        Ok(exit) => exit,
        Err(failure) => {
            console.failure(&failure);
            failure.exit()
        }
    };
    ExitCode::from(exit.code())
}

fn run(command: &Command, console: Console) -> Result<Exit, Failure> {
    match command {
        Command::Render(args) => render::run(args, console),
        Command::Info(args) => info::run(args, console),
        Command::Compare(args) => compare::run(args),
        Command::Completions(args) => shell::completions(args),
        Command::Man(args) => shell::man(args),
    }
}

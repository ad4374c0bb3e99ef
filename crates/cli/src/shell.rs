//! Completions and manual pages, made from the same tables as the help text.

use crate::args::{Cli, CompletionsArgs, ManArgs};
use crate::console::print;
use crate::exit::{Exit, Failure};
use clap::CommandFactory;

/// Prints a completion script.
pub(crate) fn completions(args: &CompletionsArgs) -> Result<Exit, Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "bidir", &mut script);
    print(&String::from_utf8_lossy(&script))
}

/// Prints the manual page of the whole, or of one command.
pub(crate) fn man(args: &ManArgs) -> Result<Exit, Failure> {
    let mut cli = Cli::command();
    cli.build();
    let command = match &args.command {
        None => cli,
        Some(name) => cli.find_subcommand(name).cloned().ok_or_else(|| {
            Failure::usage(format!("there is no command `{name}`")).with_hint("see `bidir --help`")
        })?,
    };
    let mut page = Vec::new();
    clap_mangen::Man::new(command)
        .render(&mut page)
        .map_err(|error| Failure::new(Exit::RenderFailed, format!("no manual page: {error}")))?;
    print(&String::from_utf8_lossy(&page))
}

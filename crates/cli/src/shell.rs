//! Completions and manual pages, generated from the same definitions as the help text.

use crate::args::{CompletionsArgs, ManArgs, command};
use crate::console::print;
use crate::exit::{Exit, Failure};
use crate::markdown;

/// Prints a completion script.
pub(crate) fn completions(args: &CompletionsArgs) -> Result<Exit, Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut command(), "bidir", &mut script);
    print(&String::from_utf8_lossy(&script))
}

/// Prints the manual page of `bidir` or of one command, such as `film info`; or the Markdown reference.
pub(crate) fn man(args: &ManArgs) -> Result<Exit, Failure> {
    if args.markdown {
        return print(&markdown::page());
    }
    let mut cli = command();
    cli.build();
    let mut command = &cli;
    for name in &args.command {
        command = command.find_subcommand(name).ok_or_else(|| {
            Failure::usage(format!("there is no command `{}`", args.command.join(" ")))
                .with_hint("see `bidir --help`")
        })?;
    }
    let mut page = Vec::new();
    clap_mangen::Man::new(command.clone())
        .source(concat!("bidir ", env!("CARGO_PKG_VERSION")))
        .render(&mut page)
        .map_err(|error| Failure::new(Exit::RenderFailed, format!("no manual page: {error}")))?;
    // `.nf` keeps the lines of examples and tables.
    print(&String::from_utf8_lossy(&page).replacen(".SH EXTRA\n", ".SH NOTES\n.nf\n", 1))
}

//! The two views of the help text: common flags under `-h`, all flags by topic under `--help`.

use super::Cli;
use clap::builder::Resettable;
use clap::{Arg, Command, CommandFactory};
use std::ffi::OsString;

/// The flags that `-h` shows for a command, in order; it shows all flags of commands without an entry.
const COMMON: [(&str, &[&str]); 4] = [
    (
        "render",
        &[
            "output",
            "integrator",
            "spp",
            "time",
            "noise",
            "size",
            "seed",
            "denoise",
            "aov",
            "checkpoint",
            "resume",
            "serve",
            "threads",
            "lenient",
        ],
    ),
    (
        "view",
        &[
            "port",
            "bind",
            "integrator",
            "spp",
            "size",
            "seed",
            "threads",
            "lenient",
        ],
    ),
    (
        "reference",
        &[
            "output",
            "spp",
            "extend",
            "estimator",
            "against",
            "size",
            "threads",
            "quiet",
        ],
    ),
    (
        "experiment",
        &["output", "quick", "restart", "ray", "threads", "quiet"],
    ),
];

/// The help text that a command prints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum View {
    /// The help text of `-h`.
    Short,
    /// The help text of `--help`, of manual pages and of the reference.
    Long,
}

impl View {
    /// Returns the view that a command line requests, if it requests help.
    pub(super) fn requested(arguments: &[OsString]) -> Self {
        let has_flag = arguments.iter().any(|argument| argument == "--help");
        if has_flag || arguments.get(1).is_some_and(|name| name == "help") {
            Self::Long
        } else {
            Self::Short
        }
    }
}

/// Returns the command line with the help text of `view`.
pub(crate) fn command(view: View) -> Command {
    shown(Cli::command(), view)
}

/// Returns `command` and its subcommands with the help text of `view`.
fn shown(command: Command, view: View) -> Command {
    let names = command.get_subcommands().map(Command::get_name);
    let names: Vec<_> = names.map(str::to_owned).collect();
    let name = command.get_name();
    let common = COMMON.iter().find(|(known, _)| *known == name);
    let common = common.map(|(_, flags)| *flags);
    let command = command.mut_args(|arg| match view {
        View::Short => short(arg, common),
        // The values of variables on this machine do not belong into documentation.
        View::Long => arg.hide_env_values(true),
    });
    names.into_iter().fold(command, |all, name| {
        all.mut_subcommand(name, |c| shown(c, view))
    })
}

/// Returns an argument for `-h`: hides flags that are not `common`, and lists the others without headings.
fn short(arg: Arg, common: Option<&[&str]>) -> Arg {
    let arg = arg.hide_env(true);
    let is_global = arg.is_global_set();
    let (Some(common), Some(flag)) = (common, arg.get_long()) else {
        return arg.hide_short_help(is_global);
    };
    match common.iter().position(|known| *known == flag) {
        Some(place) => {
            // In debug builds, clap asserts that only flags with values hide them.
            let has_value = arg.get_action().takes_values();
            arg.help_heading(Resettable::Reset)
                .hide_possible_values(has_value)
                .display_order(place)
        }
        None => arg.hide_short_help(true),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn common_flags_exist() {
        let command = Cli::command();
        for (name, flags) in COMMON {
            let command = command.find_subcommand(name).unwrap();
            for flag in flags {
                let mut all = command.get_arguments();
                let is_there = all.any(|arg| arg.get_long() == Some(flag));
                assert!(is_there, "{name} --{flag}");
            }
        }
    }

    #[test]
    fn a_view_is_chosen_by_the_command_line() {
        let view = |line: &str| {
            let words: Vec<_> = line.split(' ').map(OsString::from).collect();
            View::requested(&words)
        };
        assert_eq!(view("bidir render --help"), View::Long);
        assert_eq!(view("bidir help render"), View::Long);
        assert_eq!(view("bidir render -h"), View::Short);
        assert_eq!(view("bidir"), View::Short);
    }

    #[test]
    fn both_views_are_consistent() {
        command(View::Short).debug_assert();
        command(View::Long).debug_assert();
    }
}

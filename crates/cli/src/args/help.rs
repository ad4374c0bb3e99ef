//! The two views of the help text: common flags under `-h`, all flags by topic under `--help`.

use super::Cli;
use clap::builder::Resettable;
use clap::{Arg, Command, CommandFactory};
use std::ffi::OsString;

/// The flags of a command under `-h`, in their order. All flags, for a command that is not here.
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

/// Which help text a command prints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum View {
    /// That of `-h`.
    Short,
    /// That of `--help`, of manual pages and of the reference.
    Long,
}

impl View {
    /// The view that a command line prints, if it prints one at all.
    pub(super) fn asked(arguments: &[OsString]) -> Self {
        let has_flag = arguments.iter().any(|argument| argument == "--help");
        if has_flag || arguments.get(1).is_some_and(|name| name == "help") {
            Self::Long
        } else {
            Self::Short
        }
    }
}

/// The command line, with the help text of `view`.
pub(crate) fn command(view: View) -> Command {
    shown(Cli::command(), view)
}

/// `command` and all below it in a view.
fn shown(command: Command, view: View) -> Command {
    let names = command.get_subcommands().map(Command::get_name);
    let names: Vec<_> = names.map(str::to_owned).collect();
    let name = command.get_name();
    let common = COMMON.iter().find(|(known, _)| *known == name);
    let common = common.map(|(_, flags)| *flags);
    let command = command.mut_args(|arg| match view {
        View::Short => short(arg, common),
        // The values of this machine's environment are no documentation.
        View::Long => arg.hide_env_values(true),
    });
    names.into_iter().fold(command, |all, name| {
        all.mut_subcommand(name, |c| shown(c, view))
    })
}

/// An argument under `-h`: flags that are not `common` are hidden, and the others stand in one list.
fn short(arg: Arg, common: Option<&[&str]>) -> Arg {
    let arg = arg.hide_env(true);
    let is_global = arg.is_global_set();
    let (Some(common), Some(flag)) = (common, arg.get_long()) else {
        return arg.hide_short_help(is_global);
    };
    let has_values = arg.get_action().takes_values();
    match common.iter().position(|known| *known == flag) {
        Some(place) => arg
            .help_heading(Resettable::Reset)
            .hide_possible_values(has_values)
            .display_order(place),
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
        let asked = |line: &str| {
            let words: Vec<_> = line.split(' ').map(OsString::from).collect();
            View::asked(&words)
        };
        assert_eq!(asked("bidir render --help"), View::Long);
        assert_eq!(asked("bidir help render"), View::Long);
        assert_eq!(asked("bidir render -h"), View::Short);
        assert_eq!(asked("bidir"), View::Short);
    }

    #[test]
    fn both_views_are_consistent() {
        command(View::Short).debug_assert();
        command(View::Long).debug_assert();
    }
}

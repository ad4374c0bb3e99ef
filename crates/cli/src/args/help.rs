//! The views of the help text, common flags under `-h` and all under `--help`, and other spellings of flags.

use super::Cli;
use clap::{Command, CommandFactory, ValueHint};

/// Commands, each with the flags that `-h` shows for it. For all other commands, `-h` shows all flags.
const COMMON: [&str; 4] = [
    "render output integrator spp time noise size seed denoise aov checkpoint resume serve threads lenient",
    "view port bind integrator spp size seed threads lenient",
    "reference output spp extend estimator against size threads quiet",
    "experiment output quick restart ray threads quiet",
];

/// Flags, each with its accepted names from other renderers.
const ALIASES: [&str; 6] = [
    "integrator method algorithm renderer",
    "max-depth bounces max-bounces maxdepth",
    "output out outfile",
    "size resolution res film-size",
    "spp samples samples-per-pixel sample-count pixelsamples nsamples",
    "threads nthreads jobs cores",
];

/// Returns the command line.
pub(crate) fn command() -> Command {
    shown(Cli::command())
}

/// Returns `command` and its subcommands with both views and with other spellings.
fn shown(command: Command) -> Command {
    let common = words_of(&COMMON, command.get_name());
    let command = command.mut_args(|arg| {
        let flag = arg.get_long().unwrap_or_default().to_owned();
        let names = words_of(&ALIASES, &flag).unwrap_or_default();
        let is_hidden = match &common {
            Some(common) => !flag.is_empty() && !common.contains(&&*flag),
            None => arg.is_global_set(),
        };
        // A negative number is a value, so that its error names what is expected. A file begins with no hyphen.
        let has_value = arg.get_action().takes_values() && !arg.is_positional();
        let takes_hyphens = arg.is_allow_hyphen_values_set()
            || has_value && arg.get_value_hint() == ValueHint::Unknown;
        // The values of variables on this machine do not belong into documentation.
        arg.aliases(names)
            .allow_hyphen_values(takes_hyphens)
            .hide_env_values(true)
            .hide_short_help(is_hidden)
    });
    command.mut_subcommands(shown)
}

/// Returns the words after `first` in the line that begins with `first`. None: there is no such line.
fn words_of(lines: &[&'static str], first: &str) -> Option<Vec<&'static str>> {
    let mut lines = lines.iter().filter_map(|line| line.split_once(' '));
    let (_, words) = lines.find(|(word, _)| *word == first)?;
    Some(words.split(' ').collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn common_flags_and_those_with_other_spellings_exist() {
        let command = command();
        let has = |name: &str, flag: &str| {
            let command = command.find_subcommand(name).unwrap();
            command
                .get_arguments()
                .any(|arg| arg.get_long() == Some(flag))
        };
        for line in COMMON {
            let (name, flags) = line.split_once(' ').unwrap();
            for flag in flags.split(' ') {
                assert!(has(name, flag), "{name} --{flag}");
            }
        }
        for line in ALIASES {
            let (flag, _) = line.split_once(' ').unwrap();
            assert!(has("render", flag), "--{flag}");
        }
        command.debug_assert();
    }
}

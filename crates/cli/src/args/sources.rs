//! The sources of settings, so that messages name the flag or the variable to change.

use clap::parser::ValueSource;
use clap::{Arg, ArgMatches, Command};
use std::collections::BTreeMap;

/// The flags whose values come from environment variables, each with its variable.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sources(BTreeMap<String, String>);

impl Sources {
    /// Finds the flags of `command` whose values in `matches` come from variables.
    pub(super) fn new(command: &Command, matches: &ArgMatches) -> Self {
        let variable = |argument: &Arg| {
            let (flag, variable) = (argument.get_long()?, argument.get_env()?);
            let source = matches.value_source(argument.get_id().as_str())?;
            let variable = variable.to_string_lossy().into_owned();
            (source == ValueSource::EnvVariable).then(|| (format!("--{flag}"), variable))
        };
        Self(command.get_arguments().filter_map(variable).collect())
    }

    /// Returns the variable that a flag's value comes from, else the flag itself.
    pub(crate) fn name<'s>(&'s self, flag: &'s str) -> &'s str {
        self.0.get(flag).map_or(flag, String::as_str)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the source of `--path`, whose variable PATH is always set.
    fn name(arguments: &[&str]) -> String {
        let flag = Arg::new("folders").long("path").env("PATH");
        let mut command = Command::new("bidir").arg(flag);
        let arguments = ["bidir"].iter().chain(arguments);
        let matches = command.try_get_matches_from_mut(arguments).unwrap();
        Sources::new(&command, &matches).name("--path").to_owned()
    }

    #[test]
    fn a_variable_is_named_unless_its_flag_is_given() {
        assert_eq!(name(&[]), "PATH");
        assert_eq!(name(&["--path", "here"]), "--path");
        assert_eq!(Sources::default().name("--path"), "--path");
    }
}

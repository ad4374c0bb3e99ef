//! Where settings come from, so that messages name what a user can change.

use clap::parser::ValueSource;
use clap::{Arg, ArgMatches, Command};
use std::collections::BTreeMap;

/// The flags whose values are those of environment variables, each with its variable.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sources(BTreeMap<String, String>);

impl Sources {
    /// The sources of what `command` found in `matches`.
    pub(super) fn new(command: &Command, matches: &ArgMatches) -> Self {
        let variable = |argument: &Arg| {
            let (flag, variable) = (argument.get_long()?, argument.get_env()?);
            let source = matches.value_source(argument.get_id().as_str())?;
            let variable = variable.to_string_lossy().into_owned();
            (source == ValueSource::EnvVariable).then(|| (format!("--{flag}"), variable))
        };
        Self(command.get_arguments().filter_map(variable).collect())
    }

    /// The variable that a flag's value comes from, else the flag itself.
    pub(crate) fn name<'s>(&'s self, flag: &'s str) -> &'s str {
        self.0.get(flag).map_or(flag, String::as_str)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The name of `--path`, which may come from a variable that is always set.
    fn name(arguments: &[&str]) -> String {
        let flag = Arg::new("folders").long("path").env("PATH");
        let mut command = Command::new("bidir").arg(flag);
        let arguments = ["bidir"].iter().chain(arguments);
        let matches = command.try_get_matches_from_mut(arguments).unwrap();
        Sources::new(&command, &matches).name("--path").to_owned()
    }

    #[test]
    fn a_variable_is_named_where_there_is_no_flag() {
        assert_eq!(name(&[]), "PATH");
        assert_eq!(name(&["--path", "here"]), "--path");
        assert_eq!(Sources::default().name("--path"), "--path");
    }
}

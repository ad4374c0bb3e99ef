//! Messages for errors of the command line, in the form of all other errors.

use crate::exit::Failure;
use bidir::names::nearest;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Arg, Command, Error};
use std::ffi::{OsStr, OsString};
use std::num::ParseIntError;
use std::path::Path;

/// Hints for flags of other renderers that have no equal here.
const ELSEWHERE: [&str; 4] = [
    "--width --height: the size of the image is --size WIDTHxHEIGHT, such as --size 640x480",
    "--exposure --tonemap --gamma: `bidir tonemap IMAGE.exr --exposure STOPS` makes a brighter or darker PNG",
    "--camera --cam: the view is that of the first camera of the scene; `bidir view` moves it",
    "--gpu --device --cuda: bidir renders on processors only; the number of threads is --threads N",
];

/// Returns the failure for an error of the command line `root` with these arguments.
pub(crate) fn explained(error: &Error, root: &Command, arguments: &[OsString]) -> Failure {
    let command = called(root, arguments);
    let given = first(error, ContextKind::InvalidArg);
    let (message, hint) = match error.kind() {
        ErrorKind::UnknownArgument if given.starts_with('-') => {
            let flag = flag_of(&given);
            let hint = hint_at_flag(flag, command, root).or_else(|| near(error, command));
            (format!("there is no flag `{flag}`"), hint)
        }
        ErrorKind::UnknownArgument => (format!("unexpected argument `{given}`"), None),
        ErrorKind::InvalidSubcommand => {
            let name = first(error, ContextKind::InvalidSubcommand);
            let hint = hint_at_file(&name).or_else(|| near(error, command));
            (format!("there is no command `{name}`"), hint)
        }
        ErrorKind::MissingRequiredArgument => (missing(error, command), None),
        ErrorKind::ValueValidation | ErrorKind::InvalidValue => return value(error, command),
        ErrorKind::ArgumentConflict if !given.is_empty() => return conflict(error),
        _ => (own_words(error), None),
    };
    let see_help = || format!("see `{} --help`", command.get_bin_name().unwrap_or("bidir"));
    Failure::usage(message).with_hint(hint.unwrap_or_else(see_help))
}

/// Returns the command that the arguments call.
fn called<'c>(root: &'c Command, arguments: &[OsString]) -> &'c Command {
    let mut called = root;
    let mut names = arguments.iter().skip(1);
    while let Some(command) = names.next().and_then(|name| called.find_subcommand(name)) {
        called = command;
    }
    called
}

/// Returns the first line of clap's own words.
fn own_words(error: &Error) -> String {
    let text = error.to_string();
    let line = text.lines().next().unwrap_or_default();
    line.trim_start_matches("error: ").to_owned()
}

/// Returns the texts of a part of an error.
fn texts(error: &Error, kind: ContextKind) -> Vec<String> {
    match error.get(kind) {
        Some(ContextValue::String(text)) => vec![text.clone()],
        Some(ContextValue::Strings(texts)) => texts.clone(),
        _ => Vec::new(),
    }
}

fn first(error: &Error, kind: ContextKind) -> String {
    texts(error, kind).into_iter().next().unwrap_or_default()
}

/// Returns the name of a flag without its values.
fn flag_of(argument: &str) -> &str {
    argument.split([' ', '=']).next().unwrap_or_default()
}

/// Returns a hint at the flag or command nearest to the given one. If the nearest name is an alias, names the flag
/// itself.
fn near(error: &Error, command: &Command) -> Option<String> {
    let mut kinds = [ContextKind::SuggestedArg, ContextKind::SuggestedSubcommand].into_iter();
    let suggested = kinds.find_map(|kind| texts(error, kind).into_iter().next())?;
    let name = suggested.strip_prefix("--").unwrap_or_default();
    let has_alias = |arg: &&Arg| {
        arg.get_all_aliases()
            .is_some_and(|names| names.contains(&name))
    };
    let flag = command
        .get_arguments()
        .find(has_alias)
        .and_then(Arg::get_long);
    let near = flag.map_or(suggested.clone(), |flag| format!("--{flag}"));
    Some(format!("did you mean `{near}`?"))
}

/// Returns a hint for a flag of other renderers, of another command, or with one hyphen.
fn hint_at_flag(flag: &str, command: &Command, root: &Command) -> Option<String> {
    let has = |command: &Command, flag: &str| {
        let mut arguments = command.get_arguments();
        arguments.any(|arg| arg.get_long().is_some() && arg.get_long() == flag.strip_prefix("--"))
    };
    let known = ELSEWHERE
        .into_iter()
        .filter_map(|line| line.split_once(": "));
    let mut elsewhere = known.filter(|_| has(command, "--size"));
    let of_flag = |(flags, _): &(&str, &str)| flags.split(' ').any(|name| name == flag);
    if let Some((_, hint)) = elsewhere.find(of_flag) {
        return Some(hint.to_owned());
    }
    if !flag.starts_with("--") {
        return Some("flags of several letters have two hyphens, such as --spp".to_owned());
    }
    let other = root.get_subcommands().find(|other| has(other, flag))?;
    Some(format!("it is a flag of `bidir {}`", other.get_name()))
}

/// Returns a hint at the command for a file, if a file is given instead of a command.
fn hint_at_file(name: &str) -> Option<String> {
    let ending = Path::new(name).extension()?.to_ascii_lowercase();
    let command = match ending.to_str()? {
        "pbrt" | "gltf" | "glb" => "render",
        "toml" => "experiment",
        "film" => "film info",
        _ => return None,
    };
    Some(format!("bidir {command} {name}"))
}

/// Names the arguments that are missing.
fn missing(error: &Error, command: &Command) -> String {
    let missing = texts(error, ContextKind::InvalidArg);
    let is_required = |name: &String| {
        let mut required = command.get_arguments().filter(|arg| arg.is_required_set());
        required.any(|arg| arg.to_string() == *name)
    };
    // Some flags need another one.
    let is_due = missing.iter().all(is_required);
    let with = if is_due { "" } else { " with these flags" };
    let name = command.get_bin_name().unwrap_or("bidir");
    let names = missing.join(", ").replace(['<', '>'], "");
    format!("`{name}`{with} needs {names}")
}

/// Returns the failure for two flags that exclude each other, or for a flag that is given twice.
fn conflict(error: &Error) -> Failure {
    let kinds = [ContextKind::InvalidArg, ContextKind::PriorArg];
    let [given, other] = kinds.map(|kind| flag_of(&first(error, kind)).to_owned());
    Failure::usage(if given == other {
        format!("{given} is given more than once")
    } else {
        format!("{given} cannot be used with {other}")
    })
}

/// Returns the failure for an invalid value. It says what is expected, and which variable gave the value.
fn value(error: &Error, command: &Command) -> Failure {
    let named = first(error, ContextKind::InvalidArg);
    let given = first(error, ContextKind::InvalidValue);
    let names = texts(error, ContextKind::ValidValue);
    let mut arguments = command.get_arguments();
    let argument = arguments.find(|arg| arg.to_string() == named);
    let variable = argument.and_then(|arg| arg.get_env());
    let is_its_value = |name: &&OsStr| std::env::var_os(name).is_some_and(|value| value == *given);
    let at = match variable.filter(is_its_value) {
        Some(variable) => variable.to_string_lossy().into_owned(),
        None => flag_of(&named).replace(['<', '>'], ""),
    };
    let quoted = format!("`{given}`");
    let reason = std::error::Error::source(error).map(|reason| {
        if reason.is::<ParseIntError>() {
            "expected a whole number, 0 or more".to_owned()
        } else {
            reason.to_string()
        }
    });
    let failure = Failure::usage(match reason {
        // Some reasons have the value.
        Some(reason) if reason.contains(&quoted) || reason.starts_with(&given) => {
            format!("{at}: {reason}")
        }
        Some(reason) => format!("{at}: {quoted}: {reason}"),
        None if given.is_empty() && names.is_empty() => format!("{at} needs a value"),
        None if given.is_empty() => format!("{at} needs one of {}", names.join(", ")),
        None => format!("{at}: {quoted} is not one of {}", names.join(", ")),
    });
    match nearest(&given, names.iter().map(String::as_str)) {
        Some(near) => failure.with_hint(format!("did you mean `{near}`?")),
        None => failure,
    }
}

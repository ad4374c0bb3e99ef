//! Better messages for errors of the command line: numbers out of range, values of variables, and flags
//! under the names of other programs.

use bidir::names::nearest;
use clap::builder::PossibleValue;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Arg, Command, Error};
use formats::printable;

use std::ffi::{OsStr, OsString};
use std::fmt::Display;
use std::path::Path;

/// Flags of other programs, the flag of this program, and a hint.
const ELSEWHERE: [(&[&str], &str, &str); 9] = [
    (
        &[
            "--width",
            "--height",
            "--resolution",
            "--res",
            "--film-size",
        ],
        "--size",
        "the size of the image is --size WIDTHxHEIGHT, such as --size 640x480",
    ),
    (
        &[
            "--samples",
            "--samples-per-pixel",
            "--sample-count",
            "--pixelsamples",
            "--nsamples",
            "--quality",
        ],
        "--spp",
        "the number of samples per pixel is --spp N",
    ),
    (
        &["--depth", "--bounces", "--max-bounces", "--maxdepth"],
        "--max-depth",
        "the maximum number of bounces is --max-depth N",
    ),
    (
        &["--outfile", "--out"],
        "--output",
        "the image is written to --output FILE.exr",
    ),
    (
        &["--nthreads", "--jobs", "--cores"],
        "--threads",
        "the number of threads is --threads N",
    ),
    (
        &["--exposure", "--tonemap", "--gamma"],
        "--spp",
        "`bidir tonemap IMAGE.exr --exposure STOPS` makes a brighter or darker PNG",
    ),
    (
        &["--camera", "--cam"],
        "--spp",
        "the view is that of the first camera of the scene; `bidir view` moves it",
    ),
    (
        &["--gpu", "--device", "--cuda"],
        "--threads",
        "bidir renders on processors only; the number of threads is --threads N",
    ),
    (
        &["--method", "--algorithm", "--renderer"],
        "--integrator",
        "the method is --integrator NAME",
    ),
];

/// A flag, and the flags that need it.
const NEEDS: [(&str, &[&str]); 3] = [
    ("--replay", &["--svg", "--json"]),
    (
        "--checkpoint",
        &["--resume", "--restart", "--checkpoint-every"],
    ),
    ("--error-map", &["--metric", "--error-max"]),
];

/// Lets every flag with a value accept a negative number, so that its error names the range.
pub(super) fn accept_negative(command: Command) -> Command {
    let command = command.mut_args(|arg| {
        let has_value = arg.get_action().takes_values() && !arg.is_positional();
        if has_value {
            arg.allow_negative_numbers(true)
        } else {
            arg
        }
    });
    command.mut_subcommands(accept_negative)
}

/// Returns the same error with a better message where there is one.
pub(super) fn reworded(error: Error, command: &Command, arguments: &[OsString]) -> Error {
    let root = command;
    let command = called(root, arguments);
    let better = match error.kind() {
        ErrorKind::UnknownArgument => elsewhere(&error, command)
            .or_else(|| negative(&error, arguments))
            .or_else(|| one_hyphen(&error, command, arguments))
            .or_else(|| of_another(&error, command, root)),
        ErrorKind::ValueValidation | ErrorKind::InvalidValue => value(&error, command, arguments),
        ErrorKind::InvalidSubcommand => file(&error),
        ErrorKind::MissingRequiredArgument => needed(&error, arguments),
        _ => None,
    };
    better.unwrap_or(error)
}

/// Returns the subcommand that the arguments call.
fn called<'c>(command: &'c Command, arguments: &[OsString]) -> &'c Command {
    let mut called = command;
    for argument in arguments.iter().skip(1) {
        let named = argument.to_str();
        match named.and_then(|name| called.find_subcommand(name)) {
            Some(subcommand) => called = subcommand,
            None => break,
        }
    }
    called
}

fn text(error: &Error, kind: ContextKind) -> Option<&str> {
    match error.get(kind)? {
        ContextValue::String(text) => Some(text),
        _ => None,
    }
}

/// Suggests the flag of this program for a flag of another program.
fn elsewhere(error: &Error, command: &Command) -> Option<Error> {
    let given = text(error, ContextKind::InvalidArg)?;
    let (_, flag, hint) = ELSEWHERE
        .iter()
        .find(|(names, ..)| names.contains(&given))?;
    let message = format!("there is no flag `{given}`");
    has_flag(command, flag).then(|| raw(error.kind(), message, Some(hint)))
}

fn has_flag(command: &Command, flag: &str) -> bool {
    let long = flag.strip_prefix("--");
    long.is_some() && command.get_arguments().any(|arg| arg.get_long() == long)
}

/// Suggests two hyphens for a long flag with one, which clap reads as short flags.
fn one_hyphen(error: &Error, command: &Command, arguments: &[OsString]) -> Option<Error> {
    let given = text(error, ContextKind::InvalidArg)?;
    let words = arguments.iter().filter_map(|argument| argument.to_str());
    let flags = words.map(|word| word.split('=').next().unwrap_or_default());
    let mut flags = flags.filter(|flag| flag.starts_with(given));
    let flag = flags.find(|flag| has_flag(command, &format!("-{flag}")))?;
    let message = format!("there is no flag `{flag}`");
    Some(raw(
        error.kind(),
        message,
        Some(&format!("did you mean `-{flag}`?")),
    ))
}

/// Names the command that has a flag which `command` lacks.
fn of_another(error: &Error, command: &Command, root: &Command) -> Option<Error> {
    let given = text(error, ContextKind::InvalidArg)?;
    let mut others = root.get_subcommands();
    let other = others.find(|other| has_flag(other, given))?;
    let message = format!("`{}` has no flag `{given}`", command.get_name());
    let hint = format!("it is a flag of `bidir {}`", other.get_name());
    Some(raw(error.kind(), message, Some(&hint)))
}

/// Explains that a value such as `-1s` or `-1,0,4,4`, which clap reads as a flag, is negative.
fn negative(error: &Error, arguments: &[OsString]) -> Option<Error> {
    let given = text(error, ContextKind::InvalidArg)?;
    let digits = given.strip_prefix('-')?;
    if !digits.starts_with(|digit: char| digit.is_ascii_digit()) {
        return None;
    }
    let texts: Vec<_> = arguments
        .iter()
        .map(|text| text.to_string_lossy())
        .collect();
    let pair = texts.windows(2).find(|pair| pair[1].starts_with(given))?;
    let [flag, value] = pair else { return None };
    let message = format!("{flag}: `{value}` is negative");
    flag.starts_with("--")
        .then(|| raw(error.kind(), message, None))
}

/// Explains an invalid value with the expected range or names, and with the variable that it comes from.
fn value(error: &Error, command: &Command, arguments: &[OsString]) -> Option<Error> {
    let named = text(error, ContextKind::InvalidArg)?;
    let given = text(error, ContextKind::InvalidValue)?;
    let flag = named.split([' ', '=']).next()?.strip_prefix("--")?;
    let arg = command
        .get_arguments()
        .find(|arg| arg.get_long() == Some(flag))?;
    let variable = variable(arg, given, arguments);
    let reason = std::error::Error::source(error).map(ToString::to_string);
    if given.is_empty() && reason.is_none() {
        return None;
    }
    let at = variable.unwrap_or_else(|| format!("--{flag}"));
    let values = arg.get_possible_values();
    let names: Vec<_> = values.iter().map(PossibleValue::get_name).collect();
    let quoted = format!("`{given}`");
    let message = match reason {
        Some(reason) if is_of_a_number(&reason) => {
            format!("{at}: {quoted} is not {}", expected(arg))
        }
        // Some reasons already quote the value.
        Some(reason) if reason.contains(&quoted) => format!("{at}: {reason}"),
        Some(reason) => format!("{at}: {quoted}: {reason}"),
        None => format!("{at}: {quoted} is not one of {}", names.join(", ")),
    };
    let near = nearest(given, names).map(|near| format!("did you mean `{near}`?"));
    Some(raw(error.kind(), message, near.as_deref()))
}

/// Suggests the command for a file that stands in the place of a command.
fn file(error: &Error) -> Option<Error> {
    let given = text(error, ContextKind::InvalidSubcommand)?;
    let ending = Path::new(given).extension()?.to_str()?;
    let hint = match ending.to_ascii_lowercase().as_str() {
        "pbrt" | "gltf" | "glb" => format!("bidir render {given}"),
        "toml" => format!("bidir experiment {given} -o FOLDER"),
        "film" => format!("bidir film info {given}"),
        _ => return None,
    };
    let message = format!("there is no command `{given}`");
    Some(raw(error.kind(), message, Some(&hint)))
}

/// Explains that a flag needs another one.
fn needed(error: &Error, arguments: &[OsString]) -> Option<Error> {
    let ContextValue::Strings(missing) = error.get(ContextKind::InvalidArg)? else {
        return None;
    };
    let (flag, needed) = missing.iter().find_map(|missing| {
        let needed = missing.split(' ').next()?;
        let (_, flags) = NEEDS.iter().find(|(name, _)| *name == needed)?;
        let flag = flags.iter().find(|flag| is_given(arguments, flag))?;
        Some((flag, missing.replace(['<', '>'], "")))
    })?;
    Some(raw(error.kind(), format!("{flag} needs {needed}"), None))
}

/// Returns true if a flag is among the arguments, alone or as `--flag=value`.
fn is_given(arguments: &[OsString], flag: &str) -> bool {
    arguments.iter().any(|argument| {
        let argument = argument.to_string_lossy();
        let rest = argument.strip_prefix(flag);
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('='))
    })
}

/// Returns the variable that a value comes from. None: it comes from the command line.
fn variable(arg: &Arg, given: &str, arguments: &[OsString]) -> Option<String> {
    let long = format!("--{}", arg.get_long()?);
    let short = arg.get_short().map(|short| format!("-{short}"));
    let is_short = |argument: &OsString| {
        let argument = argument.to_string_lossy();
        short
            .as_ref()
            .is_some_and(|short| argument.starts_with(short))
    };
    if is_given(arguments, &long) || arguments.iter().any(is_short) {
        return None;
    }
    let name = arg.get_env()?;
    (std::env::var_os(name)? == OsStr::new(given)).then(|| name.to_string_lossy().into_owned())
}

/// Returns true for the messages of the standard library and of clap about whole numbers.
fn is_of_a_number(reason: &str) -> bool {
    let starts = ["invalid digit", "number too", "cannot parse integer"];
    starts.iter().any(|start| reason.starts_with(start)) || reason.contains(" is not in ")
}

/// Describes the whole numbers that a flag accepts.
///
/// Clap does not expose the range of a parser, so it is read from clap's message about a number outside.
fn expected(arg: &Arg) -> String {
    let range = |probe: &str| {
        let flag = Arg::new("probe").long("probe");
        let flag = flag.value_parser(arg.get_value_parser().clone());
        let command = Command::new("probe").arg(flag);
        let matches = command.try_get_matches_from(["probe", "--probe", probe]);
        let reason = std::error::Error::source(&matches.err()?)?.to_string();
        let (least, most) = reason.split_once(" is not in ")?.1.split_once("..")?;
        let most = match most.strip_prefix('=') {
            Some(most) => most.parse::<u64>().ok(),
            None => most.parse::<u64>().ok().map(|end| end.saturating_sub(1)),
        };
        Some((
            least.parse::<u64>().ok()?,
            most.filter(|most| *most < u32::MAX.into()),
        ))
    };
    let all = [range("0"), range(&i64::MAX.to_string())];
    match all.into_iter().flatten().next() {
        Some((1, None)) => "a whole number above 0".to_owned(),
        Some((least, Some(most))) => format!("a whole number from {least} to {most}"),
        Some((least, None)) => format!("a whole number, {least} or more"),
        None => "a whole number, 0 or more".to_owned(),
    }
}

/// Returns an error in the format of [`crate::console::Console`].
fn raw(kind: ErrorKind, message: impl Display, hint: Option<&str>) -> Error {
    let message = message.to_string();
    let hint = hint.map(|hint| format!("\nhint: {}", printable(hint)));
    let hint = hint.unwrap_or_default();
    Error::raw(kind, format!("{}{hint}\n", printable(&message)))
}

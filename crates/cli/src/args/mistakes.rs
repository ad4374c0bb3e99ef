//! Messages for errors of the command line, in the form of all other errors: numbers out of range, values of
//! variables, and flags under the names of other programs.

use crate::exit::Failure;
use bidir::names::nearest;
use clap::builder::PossibleValue;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Arg, Command, Error};
use std::ffi::{OsStr, OsString};
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

/// Returns true for the errors that are help texts.
pub(super) fn is_help(kind: ErrorKind) -> bool {
    matches!(
        kind,
        ErrorKind::DisplayHelp | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand
    )
}

/// Returns the failure for an error of `command`, which read these arguments.
pub(crate) fn explained(error: &Error, command: &Command, arguments: &[OsString]) -> Failure {
    let root = command;
    let command = called(root, arguments);
    let better = match error.kind() {
        ErrorKind::UnknownArgument => elsewhere(error, command)
            .or_else(|| negative(error, arguments))
            .or_else(|| one_hyphen(error, command, arguments))
            .or_else(|| of_another(error, command, root))
            .or_else(|| unknown(error, command)),
        ErrorKind::ValueValidation | ErrorKind::InvalidValue => value(error, command, arguments),
        ErrorKind::InvalidSubcommand => file(error).or_else(|| no_command(error, command)),
        ErrorKind::MissingRequiredArgument => {
            needed(error, arguments).or_else(|| missing(error, command))
        }
        ErrorKind::ArgumentConflict => conflict(error),
        _ => None,
    };
    better.unwrap_or_else(|| in_one_line(error, command))
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
        ContextValue::Strings(texts) => texts.first().map(String::as_str),
        _ => None,
    }
}

/// Returns the name of a flag without its values.
fn flag_of(argument: &str) -> &str {
    argument.split([' ', '=']).next().unwrap_or_default()
}

/// Returns a failure with a hint at the command's help.
fn see_help(message: String, command: &Command) -> Failure {
    let name = command.get_bin_name().unwrap_or("bidir");
    Failure::usage(message).with_hint(format!("see `{name} --help`"))
}

/// Returns the failure with clap's own words, without its usage.
fn in_one_line(error: &Error, command: &Command) -> Failure {
    let text = error.render().to_string();
    let is_usage = |line: &&str| line.starts_with("Usage:") || line.starts_with("For more");
    let lines = text.lines().map(str::trim);
    let lines = lines.take_while(|line| !is_usage(line));
    let (tips, lines): (Vec<_>, Vec<_>) = lines
        .filter(|line| !line.is_empty())
        .partition(|line| line.starts_with("tip:"));
    let message = lines.join(" ");
    let message = message.trim_start_matches("error: ").to_owned();
    match tips.first().and_then(|tip| tip.strip_prefix("tip: ")) {
        Some(tip) => Failure::usage(message).with_hint(tip),
        None => see_help(message, command),
    }
}

/// Suggests the nearest flag, or says that an argument is one too many.
fn unknown(error: &Error, command: &Command) -> Option<Failure> {
    let given = text(error, ContextKind::InvalidArg)?;
    if !given.starts_with('-') {
        return Some(see_help(format!("unexpected argument `{given}`"), command));
    }
    let message = format!("there is no flag `{}`", flag_of(given));
    Some(match text(error, ContextKind::SuggestedArg) {
        Some(near) => Failure::usage(message).with_hint(format!("did you mean `{near}`?")),
        None => see_help(message, command),
    })
}

/// Suggests the nearest command.
fn no_command(error: &Error, command: &Command) -> Option<Failure> {
    let given = text(error, ContextKind::InvalidSubcommand)?;
    let message = format!("there is no command `{given}`");
    Some(match text(error, ContextKind::SuggestedSubcommand) {
        Some(near) => Failure::usage(message).with_hint(format!("did you mean `{near}`?")),
        None => see_help(message, command),
    })
}

/// Names the arguments that are missing.
fn missing(error: &Error, command: &Command) -> Option<Failure> {
    let ContextValue::Strings(missing) = error.get(ContextKind::InvalidArg)? else {
        return None;
    };
    let names = missing.join(", ").replace(['<', '>'], "");
    let name = command.get_bin_name().unwrap_or("bidir");
    Some(see_help(format!("`{name}` needs {names}"), command))
}

/// Names two flags that exclude each other, or one that is given twice.
fn conflict(error: &Error) -> Option<Failure> {
    let given = flag_of(text(error, ContextKind::InvalidArg)?);
    let other = flag_of(text(error, ContextKind::PriorArg)?);
    Some(Failure::usage(if given == other {
        format!("{given} is given more than once")
    } else {
        format!("{given} cannot be used with {other}")
    }))
}

/// Suggests the flag of this program for a flag of another program.
fn elsewhere(error: &Error, command: &Command) -> Option<Failure> {
    let given = text(error, ContextKind::InvalidArg)?;
    let (_, flag, hint) = ELSEWHERE
        .iter()
        .find(|(names, ..)| names.contains(&given))?;
    let message = format!("there is no flag `{given}`");
    has_flag(command, flag).then(|| Failure::usage(message).with_hint(*hint))
}

fn has_flag(command: &Command, flag: &str) -> bool {
    let long = flag.strip_prefix("--");
    long.is_some() && command.get_arguments().any(|arg| arg.get_long() == long)
}

/// Suggests two hyphens for a long flag with one, which clap reads as short flags.
fn one_hyphen(error: &Error, command: &Command, arguments: &[OsString]) -> Option<Failure> {
    let given = text(error, ContextKind::InvalidArg)?;
    let words = arguments.iter().filter_map(|argument| argument.to_str());
    let flags = words.map(|word| word.split('=').next().unwrap_or_default());
    let mut flags = flags.filter(|flag| flag.starts_with(given));
    let flag = flags.find(|flag| has_flag(command, &format!("-{flag}")))?;
    let message = format!("there is no flag `{flag}`");
    Some(Failure::usage(message).with_hint(format!("did you mean `-{flag}`?")))
}

/// Names the command that has a flag which `command` lacks.
fn of_another(error: &Error, command: &Command, root: &Command) -> Option<Failure> {
    let given = text(error, ContextKind::InvalidArg)?;
    let mut others = root.get_subcommands();
    let other = others.find(|other| has_flag(other, given))?;
    let message = format!("`{}` has no flag `{given}`", command.get_name());
    let hint = format!("it is a flag of `bidir {}`", other.get_name());
    Some(Failure::usage(message).with_hint(hint))
}

/// Explains that a value such as `-1s` or `-1,0,4,4`, which clap reads as a flag, is negative.
fn negative(error: &Error, arguments: &[OsString]) -> Option<Failure> {
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
    flag.starts_with("--").then(|| Failure::usage(message))
}

/// Explains an invalid value with the expected range or names, and with the variable that it comes from.
fn value(error: &Error, command: &Command, arguments: &[OsString]) -> Option<Failure> {
    let named = text(error, ContextKind::InvalidArg)?;
    let given = text(error, ContextKind::InvalidValue)?;
    let mut args = command.get_arguments();
    let arg = args.find(|arg| arg.to_string() == named)?;
    let variable = variable(arg, given, arguments);
    let reason = std::error::Error::source(error).map(ToString::to_string);
    let at = variable.unwrap_or_else(|| flag_of(named).replace(['<', '>'], ""));
    let values = arg.get_possible_values();
    let names: Vec<_> = values.iter().map(PossibleValue::get_name).collect();
    if given.is_empty() && reason.is_none() {
        return Some(Failure::usage(match &names[..] {
            [] => named
                .replace(['<', '>'], "")
                .replacen([' ', '='], " needs a value: ", 1),
            names => format!("{at} needs one of {}", names.join(", ")),
        }));
    }
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
    let failure = Failure::usage(message);
    Some(match nearest(given, names) {
        Some(near) => failure.with_hint(format!("did you mean `{near}`?")),
        None => failure,
    })
}

/// Suggests the command for a file that stands in the place of a command.
fn file(error: &Error) -> Option<Failure> {
    let given = text(error, ContextKind::InvalidSubcommand)?;
    let ending = Path::new(given).extension()?.to_str()?;
    let hint = match ending.to_ascii_lowercase().as_str() {
        "pbrt" | "gltf" | "glb" => format!("bidir render {given}"),
        "toml" => format!("bidir experiment {given}"),
        "film" => format!("bidir film info {given}"),
        _ => return None,
    };
    let message = format!("there is no command `{given}`");
    Some(Failure::usage(message).with_hint(hint))
}

/// Explains that a flag needs another one.
fn needed(error: &Error, arguments: &[OsString]) -> Option<Failure> {
    let ContextValue::Strings(missing) = error.get(ContextKind::InvalidArg)? else {
        return None;
    };
    let (flag, needed) = missing.iter().find_map(|missing| {
        let needed = missing.split(' ').next()?;
        let (_, flags) = NEEDS.iter().find(|(name, _)| *name == needed)?;
        let flag = flags.iter().find(|flag| is_given(arguments, flag))?;
        Some((flag, missing.replace(['<', '>'], "")))
    })?;
    Some(Failure::usage(format!("{flag} needs {needed}")))
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

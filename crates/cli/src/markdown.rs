//! The reference of the command line, docs/reference/cli.md, from the same tables as the help text.

use crate::args::{View, command};
use crate::exit::Exit;
use clap::{Arg, Command};
use std::collections::BTreeMap;
use std::fmt::Write;

const HEAD: &str = "\
<!-- Written by `bidir man --markdown`; `just docs` writes it again. -->

# Command line

`bidir COMMAND -h` prints the common flags of a command, `bidir COMMAND --help` all of them.
Results go to stdout, messages and progress to stderr; control characters in names and texts of files are printed as escapes, such as `\\u{1b}`.
A setting comes from the first of these that has it: the flag, the environment variable, the scene file, the default.
";

/// Variables without a flag, and their effects.
const VARIABLES: [(&str, &str); 6] = [
    (
        "BIDIR_EMBREE",
        "The libraries of Embree that `just bench-rays` compares with, divided as in `PATH`.",
    ),
    (
        "BIDIR_OIDN",
        "The library of Open Image Denoise 2 or its folder, for `render --denoise` and `denoise`; by default the system's.",
    ),
    (
        "BIDIR_PYTHON",
        "The interpreter that `experiment --ray` starts; by default `python3`.",
    ),
    (
        "BIDIR_SCENES",
        "The folder with `pbrt-v4/`, the scenes made by others, for `experiment beyond` and for tests.",
    ),
    (
        "FORCE_COLOR",
        "Turns the colour of messages on where stderr is no terminal.",
    ),
    (
        "NO_COLOR",
        "Turns the colour of messages off, as `--no-color` and `TERM=dumb` do.",
    ),
];

/// Returns the whole page.
pub(crate) fn page() -> String {
    let mut root = command(View::Long);
    root.build();
    let mut page = HEAD.to_owned();
    page.push_str("\n| Command | |\n|---|---|\n");
    for (path, command) in all(&root) {
        let about = command.get_about().map(ToString::to_string);
        row(
            &mut page,
            &[&link(&path), &cell(&about.unwrap_or_default())],
        );
    }
    page.push_str("\n## Flags of every command\n\n| Flag | Meaning |\n|---|---|\n");
    let shared = root.get_arguments().filter(|arg| arg.get_long().is_some());
    for arg in shared {
        row(&mut page, &[&name(arg), &meaning(arg).0]);
    }
    let mut tables = Tables::new();
    for (path, command) in all(&root) {
        section(&mut page, &path, command, &mut tables);
    }
    environment(&mut page, &root);
    page.push_str("\n## Exit codes\n\n| Code | Meaning |\n|---:|---|\n");
    for (code, meaning) in Exit::codes() {
        row(&mut page, &[&code.to_string(), meaning]);
    }
    page
}

/// Returns every command below `command` with its name relative to it, such as `film info`.
fn all(command: &Command) -> Vec<(String, &Command)> {
    let visible = command
        .get_subcommands()
        .filter(|command| command.get_name() != "help" && !command.is_hide_set());
    let with_its_own = visible.flat_map(|command| {
        let name = command.get_name();
        let below = all(command).into_iter();
        let below = below.map(move |(path, command)| (format!("{name} {path}"), command));
        std::iter::once((name.to_owned(), command)).chain(below)
    });
    with_its_own.collect()
}

/// The written tables by heading and rows, with the command that has them.
type Tables = BTreeMap<(String, String), String>;

/// Writes the section of a command. A table that another command has becomes a link to it.
fn section(page: &mut String, path: &str, command: &Command, tables: &mut Tables) {
    let long = command.get_long_about().or(command.get_about());
    let long = long.map(ToString::to_string).unwrap_or_default();
    let usage = command.clone().render_usage().to_string();
    // Writing to a string cannot fail.
    let _ = write!(page, "\n## bidir {path}\n");
    for paragraph in long.split("\n\n") {
        let text = match paragraph.strip_prefix("For example: ") {
            Some(example) => format!("For example: {}", code(example.trim_end_matches('.'))),
            None => ended(&paragraph.replace('\n', " ")),
        };
        let _ = write!(page, "\n{text}\n");
    }
    let lines = usage.lines().map(|line| line.trim_start_matches("Usage:"));
    let usages: Vec<_> = lines.map(|line| code(line.trim())).collect();
    let _ = write!(page, "\nUsage: {}\n", usages.join(" or "));
    for (heading, args) in by_heading(command) {
        let mut rows = String::new();
        for arg in &args {
            let (meaning, default) = meaning(arg);
            let variable = arg.get_env().map(|name| code(&name.to_string_lossy()));
            let variable = variable.unwrap_or_default();
            row(&mut rows, &[&name(arg), &default, &variable, &meaning]);
        }
        let key = (heading.to_owned(), rows);
        match tables.get(&key) {
            Some(other) if args.len() > 1 => {
                let link = link(other);
                let _ = write!(page, "\n{heading}: as for {link}\n");
            }
            _ => {
                let head = "Default | Environment | Meaning |\n|---|---|---|---|";
                let _ = write!(page, "\n| {heading} | {head}\n{}", key.1);
                tables.insert(key, path.to_owned());
            }
        }
    }
    let examples = command.get_after_long_help().or(command.get_after_help());
    if let Some(examples) = examples {
        let examples = examples.to_string();
        let _ = write!(page, "\n```text\n{}\n```\n", examples.trim_end());
    }
}

/// Returns the arguments of a command under their headings, those without a heading first.
fn by_heading(command: &Command) -> Vec<(&str, Vec<&Arg>)> {
    let own = || command.get_arguments().filter(|arg| is_own(arg));
    let is_plain = |arg: &&Arg| !arg.is_positional() && arg.get_help_heading().is_none();
    let without_topic = match (
        own().any(Arg::is_positional),
        own().any(|arg| is_plain(&arg)),
    ) {
        (true, true) => "Arguments and options",
        (true, false) => "Arguments",
        (false, _) => "Options",
    };
    let mut headings: Vec<(&str, Vec<&Arg>)> = Vec::new();
    for arg in own() {
        let heading = arg.get_help_heading().unwrap_or(without_topic);
        match headings.iter_mut().find(|(known, _)| *known == heading) {
            Some((_, args)) => args.push(arg),
            None => headings.push((heading, vec![arg])),
        }
    }
    headings.sort_by_key(|(heading, _)| *heading != without_topic);
    headings
}

/// Returns a link to the section of a command.
fn link(path: &str) -> String {
    let anchor = format!("bidir {path}").replace(' ', "-");
    format!("[`{path}`](#{anchor})")
}

/// Returns false for the flags of every command, and for hidden flags.
fn is_own(arg: &Arg) -> bool {
    let is_shared = ["help", "version"].contains(&arg.get_id().as_str());
    !is_shared && !arg.is_global_set() && !arg.is_hide_set()
}

/// Writes the section of environment variables: those of flags, and the others.
fn environment(page: &mut String, root: &Command) {
    let mut variables: BTreeMap<String, String> = VARIABLES
        .map(|(name, effect)| (name.to_owned(), effect.to_owned()))
        .into();
    for (path, command) in all(root) {
        for arg in command.get_arguments() {
            let (Some(variable), Some(flag)) = (arg.get_env(), arg.get_long()) else {
                continue;
            };
            let text = variables
                .entry(variable.to_string_lossy().into_owned())
                .or_insert_with(|| format!("`--{flag}` of"));
            let comma = if text.ends_with(" of") { "" } else { "," };
            let _ = write!(text, "{comma} `{path}`");
        }
    }
    page.push_str("\n## Environment variables\n\n| Variable | Meaning |\n|---|---|\n");
    for (name, meaning) in variables {
        row(page, &[&code(&name), &ended(&meaning)]);
    }
}

/// Returns the name of an argument in a table: `-o`, `--output <FILE>`.
fn name(arg: &Arg) -> String {
    let names = arg.get_value_names().unwrap_or_default();
    let takes_value = arg.get_action().takes_values();
    let value = names.iter().map(|name| format!(" <{name}>"));
    let value: String = value.filter(|_| takes_value).collect();
    let Some(long) = arg.get_long() else {
        return code(value.trim());
    };
    let short = arg.get_short().map(|short| format!("`-{short}`, "));
    let short = short.unwrap_or_default();
    format!("{short}{}", code(&format!("--{long}{value}")))
}

/// Returns the meaning of an argument, and its default, which the help text has in brackets.
fn meaning(arg: &Arg) -> (String, String) {
    const BRACKET: &str = "[default: ";
    let text = arg.get_long_help().or(arg.get_help());
    let text = text.map(ToString::to_string).unwrap_or_default();
    let paragraphs = text
        .split("\n\n")
        .map(|part| ended(&part.replace('\n', " ")));
    let text = paragraphs.collect::<Vec<_>>().join(" ");
    let bracket = text.split_once(BRACKET);
    let bracket = bracket.and_then(|(before, rest)| {
        let (default, after) = rest.split_once(']')?;
        Some((format!("{}{after}", before.trim_end()), default.to_owned()))
    });
    let (mut text, mut default) = bracket.unwrap_or((text, String::new()));
    text = ended(&text);
    if default.is_empty() && !arg.is_hide_default_value_set() && arg.get_action().takes_values() {
        let values = arg.get_default_values().iter();
        let values: Vec<_> = values.map(|value| code(&value.to_string_lossy())).collect();
        default = values.join(", ");
    }
    let values = arg.get_possible_values();
    if !values.is_empty() && arg.get_action().takes_values() {
        let values: Vec<_> = values.iter().map(|value| code(value.get_name())).collect();
        // Writing to a string cannot fail.
        let _ = write!(text, " Values: {}.", values.join(", "));
    }
    (cell(&text), cell(&default))
}

/// Returns a text with a full stop.
fn ended(text: &str) -> String {
    let text = text.trim_end();
    let stop = if text.is_empty() || text.ends_with(['.', ':', '!', '?']) {
        ""
    } else {
        "."
    };
    format!("{text}{stop}")
}

fn code(text: &str) -> String {
    format!("`{text}`")
}

/// Escapes the character that ends a cell.
fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

fn row(page: &mut String, cells: &[&str]) {
    // Writing to a string cannot fail.
    let _ = writeln!(page, "| {} |", cells.join(" | "));
}

//! The reference of the command line, docs/reference/cli.md, from the same tables as the help text.

use crate::args::command;
use crate::exit::Exit;
use clap::builder::StyledStr;
use clap::{Arg, Command};
use std::collections::BTreeMap;

const HEAD: &str = "\
<!-- Written by `bidir man --markdown`; `just docs` writes it again. -->

# Command line

`bidir COMMAND -h` prints the common flags of a command, `bidir COMMAND --help` all of them.
Results go to stdout, messages and progress to stderr; control characters in names and texts of files are printed as escapes, such as `\\u{1b}`.
A setting comes from the first of these that has it: the flag, the environment variable, the scene file, the default.

| Command | |
|---|---|
";

/// Variables without a flag, and their effects.
const VARIABLES: &str = "\
BIDIR_EMBREE The libraries of Embree that `just bench-rays` compares with, divided as in `PATH`.
BIDIR_OIDN The library of Open Image Denoise 2 or its folder, for `render --denoise` and `denoise`; by default the system's.
BIDIR_PYTHON The interpreter that `experiment --ray` starts; by default `python3`.
BIDIR_SCENES The folder with `pbrt-v4/`, the scenes made by others, for `experiment beyond` and for tests.
FORCE_COLOR Turns the colour of messages on where stderr is no terminal.
NO_COLOR Turns the colour of messages off, as `--no-color` and `TERM=dumb` do.";

/// Returns the whole page.
pub(crate) fn page() -> String {
    let mut root = command();
    root.build();
    let commands = all(&root);
    let mut page = HEAD.to_owned();
    for (path, command) in &commands {
        let about = command.get_about().map(ToString::to_string);
        page += &row(&[&link(path), &about.unwrap_or_default()]);
    }
    page += "\n## Flags of every command\n\n| Flag | Meaning |\n|---|---|\n";
    for arg in root.get_arguments().filter(|arg| arg.get_long().is_some()) {
        page += &row(&[&name(arg), &meaning(arg).0]);
    }
    let mut tables = BTreeMap::new();
    for (path, command) in &commands {
        page += &section(path, command, &mut tables);
    }
    page += "\n## Environment variables\n\n| Variable | Meaning |\n|---|---|\n";
    for (name, meaning) in variables(&commands) {
        page += &row(&[&code(&name), &ended(&meaning)]);
    }
    page += "\n## Exit codes\n\n| Code | Meaning |\n|---:|---|\n";
    for (code, meaning) in Exit::codes() {
        page += &row(&[&code.to_string(), meaning]);
    }
    page
}

/// Returns every command below `command` with its name relative to it, such as `film info`.
fn all(command: &Command) -> Vec<(String, &Command)> {
    let visible = command
        .get_subcommands()
        .filter(|command| command.get_name() != "help");
    let with_its_own = visible.flat_map(|command| {
        let name = command.get_name();
        let below = all(command).into_iter();
        let below = below.map(move |(path, command)| (format!("{name} {path}"), command));
        std::iter::once((name.to_owned(), command)).chain(below)
    });
    with_its_own.collect()
}

/// Returns the section of a command. A table that another command has becomes a link to it; `tables` has the
/// written ones by heading and rows.
fn section<'a>(
    path: &'a str,
    command: &Command,
    tables: &mut BTreeMap<(String, String), &'a str>,
) -> String {
    let mut text = format!("\n## bidir {path}\n");
    let long = command.get_long_about().or(command.get_about());
    let long = long.map(ToString::to_string).unwrap_or_default();
    for paragraph in long.split("\n\n") {
        let paragraph = match paragraph.strip_prefix("For example: ") {
            Some(example) => format!("For example: {}", code(example)),
            None => ended(paragraph),
        };
        text += &format!("\n{paragraph}\n");
    }
    let usage = command.clone().render_usage().to_string();
    let usages = usage
        .lines()
        .map(|line| code(line.trim_start_matches("Usage:").trim()));
    text += &format!("\nUsage: {}\n", usages.collect::<Vec<_>>().join(" or "));
    for (heading, args) in by_heading(command) {
        let rows = args.iter().map(|arg| {
            let (meaning, default) = meaning(arg);
            let variable = arg.get_env().map(|name| code(&name.to_string_lossy()));
            row(&[
                &name(arg),
                &default,
                &variable.unwrap_or_default(),
                &meaning,
            ])
        });
        let rows: String = rows.collect();
        let head = "Default | Environment | Meaning |\n|---|---|---|---|";
        let table = format!("\n| {heading} | {head}\n{rows}");
        text += &match tables.get(&(heading.to_owned(), rows.clone())) {
            Some(other) if args.len() > 1 => format!("\n{heading}: as for {}\n", link(other)),
            _ => table,
        };
        tables.entry((heading.to_owned(), rows)).or_insert(path);
    }
    if let Some(examples) = command.get_after_long_help().or(command.get_after_help()) {
        text += &format!("\n```text\n{}\n```\n", examples.to_string().trim_end());
    }
    text
}

/// Returns the arguments of a command under their headings, those without a heading first. Flags of every command
/// and hidden ones are left out.
fn by_heading(command: &Command) -> Vec<(&str, Vec<&Arg>)> {
    let is_shared = |arg: &Arg| ["help", "version"].contains(&arg.get_id().as_str());
    let is_own = |arg: &&Arg| !(is_shared(arg) || arg.is_global_set() || arg.is_hide_set());
    let mut headings: Vec<(&str, Vec<&Arg>)> = vec![("Arguments", Vec::new())];
    for arg in command.get_arguments().filter(is_own) {
        let heading = arg.get_help_heading().unwrap_or(headings[0].0);
        match headings.iter_mut().find(|(known, _)| *known == heading) {
            Some((_, args)) => args.push(arg),
            None => headings.push((heading, vec![arg])),
        }
    }
    headings.retain(|(_, args)| !args.is_empty());
    headings
}

/// Returns a link to the section of a command.
fn link(path: &str) -> String {
    format!("[`{path}`](#bidir-{})", path.replace(' ', "-"))
}

/// Returns all environment variables with their meanings.
fn variables(commands: &[(String, &Command)]) -> BTreeMap<String, String> {
    let alone = VARIABLES.lines().filter_map(|line| line.split_once(' '));
    let alone = alone.map(|(name, effect)| (name.to_owned(), effect.to_owned()));
    let mut variables: BTreeMap<String, String> = alone.collect();
    for (path, command) in commands {
        for arg in command.get_arguments() {
            if let (Some(variable), Some(flag)) = (arg.get_env(), arg.get_long()) {
                variables
                    .entry(variable.to_string_lossy().into_owned())
                    .and_modify(|text| *text += &format!(", `{path}`"))
                    .or_insert_with(|| format!("`--{flag}` of `{path}`"));
            }
        }
    }
    variables
}

/// Returns the name of an argument in a table: `-o`, `--output <FILE>`.
fn name(arg: &Arg) -> String {
    let names = arg.get_value_names().unwrap_or_default();
    let names = names.iter().filter(|_| arg.get_action().takes_values());
    let value: String = names.map(|name| format!(" <{name}>")).collect();
    let long = arg.get_long().map(|long| format!("--{long}"));
    let name = code((long.unwrap_or_default() + &value).trim());
    let short = arg.get_short().map(|short| format!("`-{short}`, "));
    short.unwrap_or_default() + &name
}

/// Returns the meaning of an argument, and its default, which the help text has in brackets.
fn meaning(arg: &Arg) -> (String, String) {
    let text = one_line(arg.get_long_help().or(arg.get_help()));
    let bracket = text.split_once(" [default: ").and_then(|(before, rest)| {
        let (default, after) = rest.split_once(']')?;
        Some((format!("{before}{after}"), default.to_owned()))
    });
    let takes_values = arg.get_action().takes_values();
    let (meaning, default) = bracket.unwrap_or_else(|| {
        let is_shown = takes_values && !arg.is_hide_default_value_set();
        let values = arg.get_default_values().iter().filter(|_| is_shown);
        let values: Vec<_> = values.map(|value| code(&value.to_string_lossy())).collect();
        (text, values.join(", "))
    });
    let values = arg.get_possible_values();
    let values = values.iter().filter(|_| takes_values);
    let values: Vec<_> = values.map(|value| code(value.get_name())).collect();
    let meaning = ended(&meaning);
    if values.is_empty() {
        return (meaning, default);
    }
    (format!("{meaning} Values: {}.", values.join(", ")), default)
}

/// Returns paragraphs in one line.
fn one_line(text: Option<&StyledStr>) -> String {
    let text = text.map(ToString::to_string).unwrap_or_default();
    let paragraphs = text.split("\n\n").map(ended);
    paragraphs.collect::<Vec<_>>().join(" ")
}

/// Returns a paragraph in one line, with a full stop.
fn ended(paragraph: &str) -> String {
    let text = paragraph.trim_end().replace('\n', " ");
    let stop = if text.ends_with(['.', ':', '!', '?']) {
        ""
    } else {
        "."
    };
    format!("{text}{stop}")
}

fn code(text: &str) -> String {
    format!("`{text}`")
}

/// Returns a row of a table, whose character between cells is escaped in them.
fn row(cells: &[&str]) -> String {
    let cells = cells.iter().map(|cell| cell.replace('|', "\\|"));
    format!("| {} |\n", cells.collect::<Vec<_>>().join(" | "))
}

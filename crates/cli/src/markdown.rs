//! The reference of the command line, docs/reference/cli.md, from the same tables as the help text.

use crate::args::command;
use crate::exit::Exit;
use clap::builder::{PossibleValue, StyledStr};
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
        let commands = all(command).into_iter();
        let below = commands.map(move |(path, command)| (format!("{name} {path}"), command));
        std::iter::once((name.to_owned(), command)).chain(below)
    });
    with_its_own.collect()
}

/// The command of each table on the page, by the table's heading and rows.
type Tables<'a> = BTreeMap<(String, String), &'a str>;

/// Returns the section of a command.
fn section<'a>(path: &'a str, command: &Command, tables: &mut Tables<'a>) -> String {
    let about = command.get_long_about().or(command.get_about());
    let long = about.map(ToString::to_string).unwrap_or_default();
    let paragraphs = long.split("\n\n").map(|paragraph| {
        let example = paragraph.strip_prefix("For example: ").map(code);
        let text = example.map_or_else(|| ended(paragraph), |code| format!("For example: {code}"));
        format!("\n{text}\n")
    });
    let usage = command.clone().render_usage().to_string();
    let lines = usage
        .lines()
        .map(|line| code(line.trim_start_matches("Usage:").trim()));
    let usages = lines.collect::<Vec<_>>().join(" or ");
    let mut parts = vec![format!("\n## bidir {path}\n")];
    parts.extend(paragraphs);
    parts.push(format!("\nUsage: {usages}\n"));
    for (heading, args) in by_heading(command) {
        parts.push(table(path, heading, &args, tables));
    }
    let help = command.get_after_long_help().or(command.get_after_help());
    let examples = help.map(ToString::to_string);
    parts.extend(examples.map(|text| format!("\n```text\n{}\n```\n", text.trim_end())));
    parts.concat()
}

/// Returns the table of arguments of the command `path`, or a link to an earlier command with the same table.
fn table<'a>(path: &'a str, heading: &str, args: &[&Arg], tables: &mut Tables<'a>) -> String {
    let lines = args.iter().map(|arg| {
        let (meaning, default) = meaning(arg);
        let variable = arg.get_env().map(|name| code(&name.to_string_lossy()));
        row(&[
            &name(arg),
            &default,
            &variable.unwrap_or_default(),
            &meaning,
        ])
    });
    let rows: String = lines.collect();
    let first = *tables
        .entry((heading.to_owned(), rows.clone()))
        .or_insert(path);
    if first != path && args.len() > 1 {
        return format!("\n{heading}: as for {}\n", link(first));
    }
    format!("\n| {heading} | Default | Environment | Meaning |\n|---|---|---|---|\n{rows}")
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
    let pairs = VARIABLES.lines().filter_map(|line| line.split_once(' '));
    let alone = pairs.map(|(name, effect)| (name.to_owned(), effect.to_owned()));
    let mut variables: BTreeMap<String, String> = alone.collect();
    for (path, command) in commands {
        for arg in command.get_arguments() {
            if let (Some(variable), Some(flag)) = (arg.get_env(), arg.get_long()) {
                variables
                    .entry(variable.to_string_lossy().into_owned())
                    .and_modify(|text| text.extend([", `", path, "`"]))
                    .or_insert_with(|| format!("`--{flag}` of `{path}`"));
            }
        }
    }
    variables
}

/// Returns the name of an argument in a table: `-o`, `--output <FILE>`.
fn name(arg: &Arg) -> String {
    let given = arg.get_value_names().unwrap_or_default();
    let names = given.iter().filter(|_| arg.get_action().takes_values());
    let values: Vec<_> = names.map(|name| format!(" <{name}>")).collect();
    let long = arg.get_long().map(|long| format!("--{long}"));
    let name = code((long.unwrap_or_default() + &values.concat()).trim());
    let short = arg.get_short().map(|short| format!("`-{short}`, "));
    short.unwrap_or_default() + &name
}

/// Returns the meaning of an argument, and its default, which the help text has in brackets.
fn meaning(arg: &Arg) -> (String, String) {
    let text = one_line(arg.get_long_help().or(arg.get_help()));
    let parts = text.split_once(" [default: ");
    let bracket = parts.and_then(|(before, rest)| {
        let (default, after) = rest.split_once(']')?;
        Some((format!("{before}{after}"), default.to_owned()))
    });
    let is_shown = !arg.is_hide_default_value_set();
    let given = arg.get_default_values().iter().filter(|_| is_shown);
    let defaults = in_code(arg, given.map(|value| value.to_string_lossy()));
    let (meaning, default) = bracket.unwrap_or((text, defaults));
    let named = in_code(
        arg,
        arg.get_possible_values()
            .iter()
            .map(PossibleValue::get_name),
    );
    let meaning = ended(&meaning);
    let some = Some(named).filter(|values| !values.is_empty());
    let values = some.map(|values| format!(" Values: {values}."));
    (meaning + &values.unwrap_or_default(), default)
}

/// Returns the values of an argument, if it takes any.
fn in_code<T: AsRef<str>>(arg: &Arg, values: impl Iterator<Item = T>) -> String {
    let values = values.filter(|_| arg.get_action().takes_values());
    values
        .map(|value| code(value.as_ref()))
        .collect::<Vec<_>>()
        .join(", ")
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

/// Returns a row of a table. Escapes `|` in the cells.
fn row(cells: &[&str]) -> String {
    let cells = cells.iter().map(|cell| cell.replace('|', "\\|"));
    format!("| {} |\n", cells.collect::<Vec<_>>().join(" | "))
}

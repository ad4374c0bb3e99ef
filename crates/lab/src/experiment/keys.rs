//! Every key of a description: the reader refuses others, and docs/reference/experiments.md lists them.

use super::settings::Changes;

/// A key of a description.
#[derive(Clone, Copy, Debug)]
pub(super) struct Key {
    /// The table that it belongs to; empty: the top of the file.
    pub(super) table: &'static str,
    /// Its name.
    pub(super) name: &'static str,
    /// The kind of its value.
    pub(super) value: &'static str,
    /// Its default, or that it is required.
    pub(super) default: &'static str,
    /// Its meaning in one sentence.
    pub(super) meaning: &'static str,
}

const fn key(
    table: &'static str,
    name: &'static str,
    value: &'static str,
    default: &'static str,
    meaning: &'static str,
) -> Key {
    Key {
        table,
        name,
        value,
        default,
        meaning,
    }
}

/// All keys but settings, in the order of the page.
#[rustfmt::skip]
pub(super) const KEYS: &[Key] = &[
    key("", "title", "text", "`Experiment`", "Title of the report."),
    key("", "description", "text", "none", "A sentence below the title."),
    key("", "size", "`\"WIDTHxHEIGHT\"`", "each scene's", "Size of all images. Unit: pixels."),
    key("", "seeds", "whole number from 1", "10", "Number of seeds."),
    key("", "first-seed", "whole number", "0", "The first seed; the others follow it."),
    key("", "threads", "whole number from 1", "one per processor", "Threads of each render."),
    key("", "metrics", "list of [metrics](metrics.md)", "`relmse`, `relmse_trim`", "Metrics in addition to `rmse`."),
    key("", "pyramid", "name of a method", "none", "Renders each strategy (s, t) of this method for the report."),
    key("", "pyramid-spp", "whole number from 2", "64", "Samples per pixel of these images."),
    key("settings", "", "", "", "Settings of all methods."),
    key("scene", "file", "path", "required", "The scene file, relative to the description."),
    key("scene", "name", "text", "the file's name", "Name in results; unique."),
    key("scene", "size", "`\"WIDTHxHEIGHT\"`", "`size` above", "Size of its images. Unit: pixels."),
    key("scene", "reference", "path", "none", "An existing reference folder, or an image with finite pixels."),
    key("scene", "reference-spp", "whole number from 1", "none", "Renders a reference with this many samples per pixel; each scene needs this key or `reference`."),
    key("scene", "reference-strategies", "as `strategies`", "those of `[settings]`", "Strategies of the rendered reference."),
    key("scene", "reference-cross-check", "`path`, `light` or `lvc`", "`path`", "Integrator that checks the rendered reference."),
    key("method", "name", "text", "required", "Name in results; unique. Ratios are relative to the first method."),
    key("method", "", "", "", "Settings of this method; they replace those of `[settings]`."),
    key("budget", "samples", "whole number from 1", "none", "Samples per pixel."),
    key("budget", "rays", "number above 0", "none", "Rays per pixel. Each budget has exactly one of `samples`, `rays` and `seconds`."),
    key("budget", "seconds", "number above 0", "none", "Render time. Unit: seconds."),
    key("budget", "name", "text", "amount and unit", "Name in results, such as the default `64 spp`; unique."),
];

/// Old names that are still read.
const OLD_NAMES: [&str; 2] = ["emission", "reference-witness"];

/// The names of the keys of a table, settings included; empty: the tables and keys of the file.
pub(super) fn names(table: &str) -> Vec<&'static str> {
    let mut names = Vec::new();
    for key in KEYS.iter().filter(|key| key.table == table) {
        match key.name {
            "" => names.extend(Changes::NAMES),
            name => names.push(name),
        }
    }
    if table.is_empty() {
        names.extend(TABLES);
    }
    names
}

/// The tables of a description.
const TABLES: [&str; 4] = ["settings", "scene", "method", "budget"];

/// True where a table may have a key.
pub(super) fn is_known(table: &str, name: &str) -> bool {
    names(table).contains(&name) || (!table.is_empty() && OLD_NAMES.contains(&name))
}

#[cfg(test)]
mod tests {
    use super::super::description::{PYRAMID_SPP, SEEDS};
    use super::*;
    use crate::metric::Metric;
    use std::fmt::Write;
    use std::{env, fs};

    const BEGIN: &str = "<!-- generated: experiment keys -->\n";
    const END: &str = "<!-- end -->\n";

    /// The list of keys, as the page has it.
    fn list() -> String {
        let mut text = String::new();
        for table in [""].into_iter().chain(TABLES) {
            match table {
                "" => text += "\nAt the top of the file:\n\n",
                "settings" => text += "\n`[settings]`:\n\n",
                _ => write!(text, "\n`[[{table}]]`, at least one:\n\n").unwrap(),
            }
            text += "| Key | Value | Default | Meaning |\n|---|---|---|---|\n";
            for key in KEYS.iter().filter(|key| key.table == table) {
                let Key {
                    name,
                    value,
                    default,
                    meaning,
                    ..
                } = key;
                let name = if name.is_empty() {
                    Changes::NAMES.map(|name| format!("`{name}`")).join(", ")
                } else {
                    format!("`{name}`")
                };
                let (value, default) = match (*value, *default) {
                    ("", _) => ("as the [flag](cli.md)", "the scene's"),
                    other => other,
                };
                writeln!(text, "| {name} | {value} | {default} | {meaning} |").unwrap();
            }
        }
        text + "\n"
    }

    /// `BIDIR_WRITE_PAGES=1` writes the list into the page.
    #[test]
    fn the_page_lists_every_key() {
        let page = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../docs/reference/experiments.md"
        );
        let text = fs::read_to_string(page).unwrap();
        let (before, rest) = text.split_once(BEGIN).unwrap();
        let (found, after) = rest.split_once(END).unwrap();
        let expected = list();
        if env::var_os("BIDIR_WRITE_PAGES").is_some() {
            fs::write(page, [before, BEGIN, &expected, END, after].concat()).unwrap();
        } else {
            let how = "BIDIR_WRITE_PAGES=1 cargo test --release -p bidir-lab --lib keys";
            assert!(
                found == expected,
                "{page} is out of date; to write it: {how}"
            );
        }
    }

    #[test]
    fn defaults_are_those_of_the_reader() {
        let default = |name| {
            let key = KEYS.iter().find(|key| key.name == name).unwrap();
            key.default
        };
        assert_eq!(default("seeds"), SEEDS.to_string());
        assert_eq!(default("pyramid-spp"), PYRAMID_SPP.to_string());
        let metrics = [Metric::Relmse, Metric::RelmseTrimmed].map(|metric| {
            let names = Metric::NAMES.iter();
            let name = names.clone().find(|(_, other)| *other == metric);
            format!("`{}`", name.unwrap().0)
        });
        assert_eq!(default("metrics"), metrics.join(", "));
    }
}

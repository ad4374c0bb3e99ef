//! The texts that the command prints about itself, and the commands in the pages.

use crate::common::{Ran, Workplace};
use expect_test::expect_file;
use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

#[test]
fn the_page_of_all_flags_is_current() {
    let page = Workplace::new().run("man --markdown").expect(0).stdout;
    expect_file![root().join("docs/reference/cli.md")].assert_eq(&page);
}

#[test]
fn version_completions_and_manual_are_printed() {
    let place = Workplace::new();
    let version = format!(
        "bidir {} (estimator version {}",
        env!("CARGO_PKG_VERSION"),
        bidir::ESTIMATOR_VERSION
    );
    for command in ["", "render", "film info"] {
        let ran = place.run(&format!("{command} --version")).expect(0);
        assert!(ran.stdout.starts_with(&version), "{}", ran.stdout);
    }
    for (command, part) in [
        ("completions bash", "shadow-rays"),
        ("completions zsh", "shadow-rays"),
        ("completions fish", "shadow-rays"),
        ("man", ".TH bidir"),
        ("man render", "shadow\\-rays"),
        ("man render", ".SH NOTES\n.nf"),
        ("man film info", "bidir\\-film\\-info"),
        ("--help", "75  stopped early"),
        ("render --help", "Shared light subpaths:"),
    ] {
        place.run(command).expect(0).prints(part);
    }
}

/// Returns the commands in the code of a page, without what stands before `bidir`.
fn commands(page: &str) -> Vec<String> {
    let page = page.replace("\\\n", " ");
    let mut fenced = false;
    let mut found = Vec::new();
    for line in page.lines() {
        fenced ^= line.trim_start().starts_with("```");
        if fenced || line.starts_with("    ") {
            let code = line.split(" #").next().unwrap_or_default();
            let parts = code.replace("&&", ";").replace('|', ";");
            let commands = parts.split(';').filter_map(|part| {
                let (start, command) = part.split_once("bidir ")?;
                let is_set = |word: &str| word.starts_with("BIDIR_");
                start
                    .split_whitespace()
                    .all(is_set)
                    .then(|| command.to_owned())
            });
            found.extend(commands);
        }
    }
    found
}

/// Asks a command for its help, which it prints only if it knows the flags and values before it.
fn ask(command: &str) -> Ran {
    let command = command.split(" > ").next().unwrap_or_default();
    let (flags, others) = command.split_once(" -- ").unwrap_or((command, ""));
    let flags = flags.replace('\'', "\"");
    let words = flags
        .split('"')
        .enumerate()
        .flat_map(|(i, part)| match i % 2 {
            0 => part.split_whitespace().collect(),
            _ => vec![part],
        });
    let place = Workplace::new();
    let mut asked = place.command("");
    Ran::of(
        asked
            .args(words)
            .args(["--help", "--"])
            .args(others.split_whitespace()),
    )
}

#[test]
fn pages_name_existing_commands_and_flags() {
    let mut pages = vec![root().join("README.md")];
    for folder in ["docs", "docs/guide", "docs/reference"] {
        let entries = fs::read_dir(root().join(folder)).unwrap();
        pages.extend(entries.map(|entry| entry.unwrap().path()));
    }
    pages.retain(|page| page.extension().is_some_and(|ending| ending == "md"));
    let mut count = 0;
    for page in pages {
        for command in commands(&fs::read_to_string(&page).unwrap()) {
            count += 1;
            let ran = ask(&command);
            assert_eq!(
                ran.code,
                Some(0),
                "{}: {command}: {}",
                page.display(),
                ran.stderr
            );
        }
    }
    assert!(count > 50, "only {count} commands: the search is broken");
    for wrong in [
        "rendr a.pbrt",
        "render a.pbrt --sppp 4",
        "merge a --stats 4",
    ] {
        ask(wrong).expect(2);
    }
}

//! Pages say what `auto` chooses, and it does. With `BIDIR_WRITE_PAGES=1` the test writes that into them.

use crate::common::{Workplace, scenes};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// The beginning of a line of the summary that pages show.
const SUMMARY: &str = "auto chose --integrator ";
/// The beginning of a sentence that ends with the integrator in backquotes.
const SENTENCE: &str = "`auto` chooses `";

/// Returns the page of the front and those of the documentation and its guide.
fn pages() -> Vec<PathBuf> {
    let root = scenes().parent().unwrap();
    let folders = ["docs", "docs/guide"].map(|folder| root.join(folder));
    let entries = folders
        .iter()
        .flat_map(|folder| fs::read_dir(folder).unwrap());
    let paths = entries.map(|entry| entry.unwrap().path());
    let mut pages: Vec<_> = paths
        .filter(|path| path.extension().is_some_and(|ending| ending == "md"))
        .collect();
    pages.push(root.join("README.md"));
    pages.sort();
    pages
}

/// The choices of `auto` by command.
#[derive(Default)]
struct Choices(BTreeMap<String, String>);

impl Choices {
    /// Returns the line that `bidir render` prints about its choice, for the flags of a command. One sample is
    /// enough, as training comes before the first.
    fn line(&mut self, command: &str) -> &str {
        let render = || {
            let place = Workplace::new();
            let root = scenes().parent().unwrap();
            let mut words = command.split_whitespace();
            let mut short = Vec::new();
            while let Some(word) = words.next() {
                match word {
                    "-o" | "--spp" => drop(words.next()),
                    scene if scene.starts_with("scenes/") => {
                        short.push(root.join(scene).display().to_string());
                    }
                    flag => short.push(flag.to_owned()),
                }
            }
            let ran = place.run(&format!("{} --spp 1 -o a.exr", short.join(" ")));
            let ran = ran.expect(0).says(SUMMARY);
            let mut lines = ran.stderr.lines();
            lines
                .find(|line| line.starts_with(SUMMARY))
                .unwrap()
                .to_owned()
        };
        self.0.entry(command.to_owned()).or_insert_with(render)
    }

    /// Returns the integrator that `auto` chooses for the flags of a command.
    fn integrator(&mut self, command: &str) -> &str {
        let line = self.line(command);
        line[SUMMARY.len()..].split(' ').next().unwrap()
    }
}

/// Returns a page with what `auto` chooses for the last command before each statement, and the number of
/// statements.
fn stated(page: &str, choices: &mut Choices) -> (String, usize) {
    let mut command = None;
    let mut count = 0;
    let mut lines = Vec::new();
    for line in page.lines() {
        if line.starts_with('#') {
            command = None;
        } else if let Some(render) = line.strip_prefix("    bidir ") {
            let render = render.split(" #").next().unwrap().trim_end();
            command = Some(render).filter(|render| render.contains("--integrator auto"));
        }
        let is_summary = line.trim_start().starts_with(SUMMARY);
        let sentence = line.split_once(SENTENCE);
        count += usize::from(is_summary || sentence.is_some());
        lines.push(match (command, sentence) {
            (Some(command), _) if is_summary => format!("    {}", choices.line(command)),
            (Some(command), Some((before, after))) => {
                let (_, after) = after.split_once('`').unwrap();
                format!("{before}{SENTENCE}{}`{after}", choices.integrator(command))
            }
            (None, Some(_)) => panic!("no command chooses: {line}"),
            _ => line.to_owned(),
        });
    }
    (lines.join("\n") + "\n", count)
}

#[test]
fn pages_say_what_auto_chooses() {
    let mut choices = Choices::default();
    let mut count = 0;
    for path in pages() {
        let old = fs::read_to_string(&path).unwrap();
        let (new, statements) = stated(&old, &mut choices);
        count += statements;
        if new == old {
            continue;
        }
        if std::env::var_os("BIDIR_WRITE_PAGES").is_some() {
            fs::write(&path, new).unwrap();
            continue;
        }
        let mut lines = old.lines().zip(new.lines());
        let (old, new) = lines.find(|(old, new)| old != new).unwrap();
        let page = path.display();
        panic!("{page}: run the test with BIDIR_WRITE_PAGES=1\n  it says: {old}\n  it is:   {new}");
    }
    assert!(count >= 5, "{count}");
}

#[test]
fn a_wrong_statement_is_found() {
    let mut choices = Choices::default();
    let command = "render scenes/room.pbrt --integrator auto";
    choices
        .0
        .insert(command.into(), format!("{SUMMARY}lvc --candidates 24,1"));
    let page = |name: &str, line: &str| {
        format!("# A\n\n    bidir {command}\n\n{line}\n\nHere `auto` chooses `{name}` at once.\n")
    };
    let right = page("lvc", "    auto chose --integrator lvc --candidates 24,1");
    for wrong in [
        page("path", "    auto chose --integrator lvc --candidates 24,1"),
        page("lvc", "    auto chose --integrator lvc --candidates 24,2"),
        page("bdpt", "    auto chose --integrator path"),
        right.clone(),
    ] {
        assert_eq!(stated(&wrong, &mut choices), (right.clone(), 2));
    }
}

/// Returns the scenes of the project in the table of a page, with the integrators in its last column.
fn table(page: &Path) -> Vec<(String, String)> {
    let text = fs::read_to_string(page).unwrap();
    let below = text.split("| It takes |\n").nth(1).unwrap();
    let rows = below
        .lines()
        .skip(1)
        .take_while(|line| line.starts_with('|'));
    let name = |cell: &str| cell.split('`').nth(1).unwrap().to_owned();
    let rows = rows.map(|row| {
        let cells: Vec<_> = row.trim_matches('|').split('|').collect();
        (name(cells[0]), name(cells[cells.len() - 1]))
    });
    rows.filter(|(scene, _)| scenes().join(format!("{scene}.pbrt")).exists())
        .collect()
}

#[test]
fn the_table_of_measurements_has_what_auto_chooses() {
    let mut choices = Choices::default();
    let root = scenes().parent().unwrap();
    for page in ["README.md", "docs/performance.md"] {
        let rows = table(&root.join(page));
        assert!(rows.len() >= 4, "{page}: {rows:?}");
        for (scene, integrator) in rows {
            let command = format!("render scenes/{scene}.pbrt --integrator auto --size 160x120");
            let chosen = choices.integrator(&command);
            assert_eq!(
                chosen, integrator,
                "{page}, {scene}: measure again, or correct the column `plan` of docs/data/auto.csv"
            );
        }
    }
}

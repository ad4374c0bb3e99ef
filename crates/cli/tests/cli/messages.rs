//! The messages of command lines, as the files of the folder `messages` have them.
//!
//! `$ FLAGS` runs `bidir FLAGS`, where words with `=` before the first command are variables; below it
//! stand, indented, the exit code and the output. Of the messages of a command that succeeds, only warnings and notes
//! are kept, as others have times. `# TEXT` begins a group with an empty folder and a scene, room.pbrt, and
//! `+ FILE TEXT` adds a file to it. A command that fails changes no file. `UPDATE_EXPECT=1` rewrites the outputs.

use crate::common::{Ran, Workplace};
use expect_test::{ExpectFile, expect_file};
use std::fs;
use std::path::Path;

/// Runs the command line of a case.
fn run(place: &Workplace, line: &str) -> Ran {
    let mut words = line.split_whitespace().peekable();
    let mut command = place.command("");
    command.env_remove("FORCE_COLOR");
    while let Some((name, value)) = words.peek().and_then(|word| word.split_once('=')) {
        command.env(name, value);
        words.next();
    }
    Ran::of(command.args(words))
}

/// Returns the exit code and the output, without what differs from run to run.
fn report(ran: &Ran, folder: &str) -> String {
    let is_kept = |line: &&str| {
        let mut labels = ["warning: ", "note: "].into_iter();
        ran.code != Some(0) || labels.any(|label| line.starts_with(label))
    };
    let kept = ran.stderr.lines().filter(is_kept);
    let lines: String = ran
        .stdout
        .lines()
        .chain(kept)
        .map(|line| format!("  {line}").trim_end().to_owned() + "\n")
        .collect();
    let lines = lines.replace(folder, "");
    format!("  exit {}\n{lines}\n", ran.code.unwrap())
}

/// Runs the cases of a file, and compares their outputs.
fn check(file: &ExpectFile) {
    let mut place = Workplace::new();
    let (mut actual, mut count) = (String::new(), 0);
    let text = file.data();
    for line in text.lines() {
        let Some((kind @ ("#" | "+" | "$"), rest)) = line.split_once(' ') else {
            continue;
        };
        actual.extend([line, "\n"]);
        match (kind, rest.split_once(' ')) {
            ("#", _) => place = Workplace::new(),
            ("+", Some((name, text))) => {
                fs::create_dir_all(place.path(name).parent().unwrap()).unwrap();
                place.write(name, &text.replace("\\n", "\n"));
            }
            ("+", None) => fs::create_dir_all(place.path(rest)).unwrap(),
            _ => {
                let before = place.contents();
                let ran = run(&place, rest.trim());
                assert!(ran.code == Some(0) || place.contents() == before, "{line}");
                actual += &report(&ran, &place.path("").display().to_string());
                count += 1;
            }
        }
    }
    assert!(count > 0, "{} has no cases", file.path.display());
    file.assert_eq(&actual);
}

#[test]
fn messages_are_those_of_the_files() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cli/messages");
    let files: Vec<_> = fs::read_dir(folder).unwrap().collect();
    assert!(!files.is_empty());
    std::thread::scope(|scope| {
        for file in files {
            scope.spawn(|| check(&expect_file![file.unwrap().path()]));
        }
    });
}

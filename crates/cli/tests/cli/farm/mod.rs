//! Job files for farms, and their jobs.

mod job_files;
#[cfg(unix)]
mod started;

use crate::common::{Ran, Workplace};

/// A scene whose name has special characters of shells and YAML.
const SCENE: &str = "it's \"my\" $(HOME) room.pbrt";
/// The prefix of its film files.
const NAME: &str = "it's \"my\" $(HOME) room";

/// Prints a job file for that scene, and writes it to `job`.
fn job(place: &Workplace, farm: &str, arguments: &str) -> String {
    place.write(SCENE, crate::common::SCENE);
    let mut command = place.command(&format!("farm {farm}"));
    command.arg(SCENE).args(arguments.split_whitespace());
    let text = Ran::of(&mut command).expect(0).stdout;
    place.write("job", &text);
    text
}

#[track_caller]
fn check_lines(text: &str, lines: &[&str]) {
    for line in lines {
        assert!(
            text.lines().any(|other| other == *line),
            "{line:?} is missing in: {text}"
        );
    }
}

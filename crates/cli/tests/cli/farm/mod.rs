//! Job files for farms, and the jobs that they start.

mod job_files;
#[cfg(unix)]
mod started;

use crate::common::{Ran, Workplace};

/// A scene whose name has what shells and YAML take for something else.
const SCENE: &str = "it's \"my\" $(HOME) room.pbrt";
/// The beginning of its film files.
const NAME: &str = "it's \"my\" $(HOME) room";

/// Prints a job file for that scene, and keeps it in `job`.
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
            text.lines().any(|found| found == *line),
            "{line:?} is missing in: {text}"
        );
    }
}

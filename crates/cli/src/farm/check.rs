//! Checks of a job that would otherwise fail on every machine of a farm.

use super::Job;
use crate::args::Cli;
use crate::exit::Failure;
use crate::scene_io::{self, ImageFormat};
use clap::parser::ValueSource;
use clap::{CommandFactory, Parser};
use formats::is_obeyed;
use std::iter;
use std::path::Path;

/// The flags of `bidir render` that are refused after `--`, and the reasons.
const REFUSED: [(&[&str], &str); 4] = [
    (
        &["output", "stats", "replay", "serve", "display_server"],
        "all parts would use it",
    ),
    (&["time", "noise"], "parts would end with passes missing"),
    (
        &["spp"],
        "give it before `--`, where it is checked against --parts",
    ),
    (
        &["passes", "part", "checkpoint", "resume", "restart"],
        "the job sets the passes and files of each part",
    ),
];

/// Checks that a job file can be made of the arguments, and that its parts can be rendered.
pub(super) fn check(job: &Job<'_>) -> Result<(), Failure> {
    check_words(job)?;
    check_image(&job.image)?;
    if let Some(spp) = job.args.spp.filter(|spp| *spp < job.args.parts) {
        let message = format!(
            "{} parts of {spp} passes: some would have none",
            job.args.parts
        );
        return refuse(message, "use fewer parts, or more passes");
    }
    check_owner(&job.args.flags)?;
    check_flags(job)
}

fn refuse(message: impl Into<String>, hint: &str) -> Result<(), Failure> {
    Err(Failure::usage(message).with_hint(hint))
}

/// Refuses a scene without a name, and arguments with control characters, as people read the job file.
fn check_words(job: &Job<'_>) -> Result<(), Failure> {
    let args = job.args;
    if args.scene == "-" {
        let message = "a scene from standard input cannot be shared";
        return refuse(message, "name a file that every machine can read");
    }
    let words = iter::once(&args.scene)
        .chain(&args.output)
        .chain(&args.flags);
    let mut hidden = words.filter(|word| word.contains(is_obeyed));
    hidden.next().map_or(Ok(()), |word| {
        let message = format!("`{word}` has control characters, which a job file cannot show");
        refuse(message, "rename the file")
    })
}

/// Refuses an image that is no .exr file, and a name that the last step of another job would match as a
/// part.
fn check_image(image: &str) -> Result<(), Failure> {
    scene_io::image_format(Path::new(image), &[ImageFormat::Exr])?;
    let file = Path::new(image).file_name().unwrap_or_default();
    let file = file.to_string_lossy();
    let mut ends = file.split(".part-").skip(1);
    if ends.any(|end| end.starts_with(|c: char| c.is_ascii_digit())) {
        let message = format!("{image} is named like a part of another job");
        let hint = "give it a name without `.part-` and a digit with --output";
        return refuse(message, hint);
    }
    Ok(())
}

/// Refuses flags that conflict with the division into parts. Variables of this machine do not count, as
/// the job runs on others.
fn check_owner(flags: &[String]) -> Result<(), Failure> {
    let words = ["bidir", "render", "scene"].into_iter();
    let words = words.chain(flags.iter().map(String::as_str));
    // `check_flags` reports other errors.
    let parsed = Cli::command().ignore_errors(true);
    let parsed = parsed.try_get_matches_from(words).unwrap_or_default();
    let Some((_, given)) = parsed.subcommand() else {
        return Ok(());
    };
    let is_given = |flag: &&&str| given.value_source(flag) == Some(ValueSource::CommandLine);
    for (flags, reason) in REFUSED {
        if let Some(flag) = flags.iter().find(is_given) {
            let flag = flag.replace('_', "-");
            let message = format!("--{flag} cannot be given after `--`: {reason}");
            return Err(Failure::usage(message));
        }
    }
    Ok(())
}

/// Refuses flags that `bidir render` does not accept together with those of a job.
fn check_flags(job: &Job<'_>) -> Result<(), Failure> {
    let scene = job.args.scene.as_str();
    let words = [
        "bidir",
        "render",
        scene,
        "--part",
        "0/1",
        "--checkpoint",
        "part.film",
        "--resume",
    ];
    let spp = job.spp();
    let more = spp.iter().chain(&job.args.flags).map(String::as_str);
    let Err(error) = Cli::try_parse_from(words.into_iter().chain(more)) else {
        return Ok(());
    };
    let text = error.render().to_string();
    let is_usage = |line: &&str| line.starts_with("Usage:") || line.starts_with("For more");
    let lines = text
        .lines()
        .map(str::trim)
        .take_while(|line| !is_usage(line));
    let lines: Vec<_> = lines.filter(|line| !line.is_empty()).collect();
    let message = lines.join("; ");
    let hint = "see `bidir render --help` for the flags that can follow `--`";
    refuse(message.trim_start_matches("error: "), hint)
}

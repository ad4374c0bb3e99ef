//! Checks of a job that would otherwise fail on every machine of a farm.

use super::Job;
use crate::args::{Cli, explained};
use crate::exit::Failure;
use crate::scene_io::{self, ImageFormat};
use clap::error::ErrorKind;
use clap::parser::ValueSource;
use clap::{CommandFactory, Parser};
use formats::is_obeyed;
use std::iter;
use std::path::Path;

/// The flags of `bidir render` that are refused after `--`, and the reasons.
const REFUSED: [(&[&str], &str); 6] = [
    (
        &["output", "stats", "pyramid", "svg", "json", "replay"],
        "all parts would write it",
    ),
    (&["serve", "display_server"], "all parts would use it"),
    (
        &["denoise"],
        "parts write film files, which are not denoised; give `--aov albedo,shading-normal` and use `bidir \
         denoise` on the image",
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
    let message = match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => {
            "parts cannot print texts instead of rendering".to_owned()
        }
        _ => {
            let mut command = Cli::command();
            command.build();
            let failure = explained(&error, &command, &["bidir", "render"].map(Into::into));
            let message = failure.message().map(|(message, _)| message.to_owned());
            message.unwrap_or_default()
        }
    };
    let hint = "see `bidir render --help` for the flags that can follow `--`";
    refuse(message, hint)
}

#[cfg(test)]
mod tests {
    use super::*;
    use bidir::settings::Request;
    use clap::{Args, Command};
    use std::any::TypeId;
    use std::path::PathBuf;

    /// The flags of `bidir render`, beside the settings of estimators, that are right for every part.
    const OF_EVERY_PART: [&str; 14] = [
        "quiet",
        "progress",
        "size",
        "crop",
        "pixelbounds",
        "cropwindow",
        "aov",
        "light_groups",
        "strategy_layers",
        "checkpoint_every",
        "lenient",
        "strict",
        "isa",
        "threads",
    ];

    #[test]
    fn every_flag_is_refused_or_right_for_every_part() {
        let settings = Request::augment_args(Command::new("settings"));
        let settings = settings.get_arguments().map(|flag| flag.get_id().as_str());
        let of_every_part: Vec<_> = settings.chain(OF_EVERY_PART).collect();
        let refused: Vec<_> = REFUSED.iter().flat_map(|(flags, _)| *flags).collect();
        let cli = Cli::command();
        let render = cli.find_subcommand("render").unwrap();
        let flags: Vec<_> = render
            .get_arguments()
            .filter(|flag| !flag.is_positional())
            .collect();
        for flag in &flags {
            let id = flag.get_id().as_str();
            let is_refused = refused.contains(&&id);
            assert!(is_refused != of_every_part.contains(&id), "--{id}");
            // Every file or folder that a flag names would be that of all parts.
            let names_file = flag.get_value_parser().type_id() == TypeId::of::<PathBuf>();
            assert!(is_refused || !names_file, "--{id}");
        }
        for id in refused {
            assert!(flags.iter().any(|flag| flag.get_id() == *id), "{id}");
        }
    }
}

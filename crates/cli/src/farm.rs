//! `bidir farm`: a job file for a scheduler, from which shares of a render are started.
//!
//! Share I of N renders its part of the passes and keeps a film file NAME.part-I-of-N.film, from which
//! it goes on where it is started again; the last step merges them and develops the image. There is
//! no protocol and no server of our own: the job file is text, made to be read and changed.
//!
//! The last step finds the shares by a pattern. No other job's files fit it, as no job has a name with
//! `.part-` and a digit in it.

mod hyperqueue;
mod kubernetes;
mod local;
mod quote;
mod slurm;

use crate::args::{Cli, Command, FarmArgs, FarmCommand};
use crate::console::print;
use crate::exit::{Exit, Failure};
use crate::scene_io::{self, ImageFormat};
use clap::parser::ValueSource;
use clap::{CommandFactory, Parser};
use formats::is_obeyed;
use quote::quote;
use std::ffi::OsStr;
use std::path::Path;

/// Prints a job file.
pub(crate) fn run(command: &FarmCommand) -> Result<Exit, Failure> {
    let (args, write): (_, fn(&Plan<'_>) -> String) = match command {
        FarmCommand::Slurm(args) => (args, slurm::script),
        FarmCommand::Hyperqueue(args) => (args, hyperqueue::script),
        FarmCommand::K8s(args) => (args, kubernetes::manifest),
        FarmCommand::Shell(args) => (args, local::script),
    };
    let plan = Plan::new(args)?;
    plan.check()?;
    print(&write(&plan))
}

/// What a job file is made of.
struct Plan<'a> {
    scene: String,
    /// The image without .exr; film files begin with it.
    name: String,
    image: String,
    parts: u64,
    spp: Option<u64>,
    flags: &'a [String],
}

/// A word of a command.
enum Word {
    /// Always the same.
    Fixed(String),
    /// With the number of the share between these.
    Share(String, String),
}

impl<'a> Plan<'a> {
    fn new(args: &'a FarmArgs) -> Result<Self, Failure> {
        if args.scene == "-" {
            let message = "a scene from standard input cannot be shared";
            return Err(
                Failure::usage(message).with_hint("name a file that every machine can read")
            );
        }
        check_words(args)?;
        let image = match &args.output {
            Some(image) => image.clone(),
            None => format!("{}.exr", stem(&args.scene)),
        };
        scene_io::image_format(Path::new(&image), &[ImageFormat::Exr])?;
        let name = &image[..image.len() - ".exr".len()];
        if Path::new(name).file_name().is_some_and(is_share) {
            let message = format!("{image} is named like a part of another job");
            let hint = "give it a name without `.part-` and a digit with --output";
            return Err(Failure::usage(message).with_hint(hint));
        }
        if let Some(spp) = args.spp.filter(|spp| *spp < args.parts) {
            let message = format!("{} parts of {spp} passes: some would have none", args.parts);
            return Err(Failure::usage(message).with_hint("use fewer parts, or more passes"));
        }
        Ok(Self {
            scene: not_a_flag(&args.scene),
            name: not_a_flag(name),
            image: not_a_flag(&image),
            parts: args.parts,
            spp: args.spp,
            flags: &args.flags,
        })
    }

    /// The command that renders a share; `part` is what --part gets.
    fn render(&self, part: Word) -> Vec<Word> {
        let mut words = fixed(&["bidir", "render", &self.scene, "--part"]);
        words.push(part);
        if let Some(spp) = self.spp {
            words.extend(fixed(&["--spp", &spp.to_string()]));
        }
        words.extend(fixed(&["--checkpoint"]));
        let [before, after] = self.share();
        words.push(Word::Share(before, after));
        words.extend(fixed(&["--resume"]));
        words.extend(self.flags.iter().cloned().map(Word::Fixed));
        words
    }

    /// The same where a scheduler's variable says which share it is.
    fn render_env(&self) -> Vec<Word> {
        self.render(Word::Fixed(format!("env/{}", self.parts)))
    }

    /// The name of a share's film file, before and after its number.
    fn share(&self) -> [String; 2] {
        let Self { name, parts, .. } = self;
        [format!("{name}.part-"), format!("-of-{parts}.film")]
    }

    /// The last step: the commands that make the image, for a shell.
    fn last_step(&self) -> [String; 2] {
        let [before, after] = self.share();
        let shares = quote(&before);
        let [all, image] = [&format!("{}.film", self.name), &self.image].map(|file| quote(file));
        [
            format!("bidir merge {shares}[0-9]*{after} -o {all}"),
            format!("bidir film develop {all} -o {image}"),
        ]
    }

    /// A name for the job: letters, digits, dashes, dots.
    fn job(&self) -> String {
        let file = Path::new(&self.name).file_name().unwrap_or_default();
        let is_plain = |c: char| c.is_ascii_alphanumeric() || ".-_".contains(c);
        let file = file.to_string_lossy();
        let name: String = file
            .chars()
            .map(|c| if is_plain(c) { c } else { '-' })
            .collect();
        let name = name.trim_start_matches(['-', '.']);
        if name.is_empty() {
            "bidir".into()
        } else {
            name.into()
        }
    }

    /// What the job file is, in a comment's first line.
    fn title(&self) -> String {
        let Self { scene, parts, .. } = self;
        format!("{scene} in {parts} parts of its passes")
    }

    /// Fails here, rather than on every machine, where `bidir render` would not take the flags.
    fn check(&self) -> Result<(), Failure> {
        self.check_flags()?;
        let words = self.render(Word::Fixed(format!("0/{}", self.parts)));
        let words = words.into_iter().map(|word| match word {
            Word::Fixed(text) => text,
            Word::Share(before, after) => format!("{before}0{after}"),
        });
        let cli = Cli::try_parse_from(words).map_err(|error| {
            let text = error.render().to_string();
            let ends = ["\n\nUsage:", "\n\nFor more"].map(|end| text.find(end));
            let end = ends.into_iter().flatten().min().unwrap_or(text.len());
            let lines = text[..end].lines().map(str::trim);
            let lines: Vec<_> = lines.filter(|line| !line.is_empty()).collect();
            Failure::usage(lines.join("; ").trim_start_matches("error: "))
                .with_hint("see `bidir render --help` for the flags that can follow `--`")
        })?;
        match cli.command {
            Command::Render(_) => Ok(()),
            _ => Err(Failure::usage(
                "the flags after `--` are not those of `bidir render`",
            )),
        }
    }

    /// Fails where a flag after `--` would take the shares apart. What variables of this machine say
    /// does not count: the job is for others.
    fn check_flags(&self) -> Result<(), Failure> {
        let words = ["bidir", "render", &self.scene];
        let words = words
            .into_iter()
            .chain(self.flags.iter().map(String::as_str));
        // What else is wrong with them is told of the whole command.
        let parsed = Cli::command()
            .ignore_errors(true)
            .try_get_matches_from(words);
        let Some(("render", given)) = parsed.as_ref().ok().and_then(|all| all.subcommand()) else {
            return Ok(());
        };
        let is_given = |flag: &str| given.value_source(flag) == Some(ValueSource::CommandLine);
        match REFUSED.iter().find(|(flag, _)| is_given(flag)) {
            None => Ok(()),
            Some((flag, reason)) => {
                let message = format!("--{flag} cannot be given after `--`: {reason}");
                Err(Failure::usage(message))
            }
        }
    }
}

/// Refuses words that a job file could not show: it is made to be read.
fn check_words(args: &FarmArgs) -> Result<(), Failure> {
    let words = [Some(&args.scene), args.output.as_ref()];
    let words = words.into_iter().flatten().chain(&args.flags);
    let mut hidden = words.filter(|word| word.contains(is_obeyed));
    hidden.next().map_or(Ok(()), |word| {
        let message = format!("`{word}` has control characters, which a job file cannot show");
        Err(Failure::usage(message).with_hint("rename the file"))
    })
}

/// Why flags that name one file are refused.
const SHARED: &str = "all parts would use it";
/// Why flags that end a share early are refused.
const INCOMPLETE: &str = "parts would end with passes missing";
/// Why flags that say what a share is are refused.
const OWN: &str = "the job sets the passes and files of each part";
/// The flags that are refused after `--`, and why.
const REFUSED: [(&str, &str); 13] = [
    ("output", SHARED),
    ("stats", SHARED),
    ("replay", SHARED),
    ("serve", SHARED),
    ("display-server", SHARED),
    ("time", INCOMPLETE),
    ("noise", INCOMPLETE),
    (
        "spp",
        "give it before `--`, where it is checked against --parts",
    ),
    ("passes", OWN),
    ("part", OWN),
    ("checkpoint", OWN),
    ("resume", OWN),
    ("restart", OWN),
];

/// Does a name without .exr have what makes a film file a share?
fn is_share(name: &OsStr) -> bool {
    let name = name.to_string_lossy();
    let after = name.split(".part-").skip(1);
    let mut first = after.filter_map(|after| after.chars().next());
    first.any(|letter| letter.is_ascii_digit())
}

fn fixed(words: &[&str]) -> Vec<Word> {
    words
        .iter()
        .map(|&word| Word::Fixed(word.to_owned()))
        .collect()
}

/// A command for a shell, where `variable` is the number of the share.
fn shell_command(words: &[Word], variable: &str) -> String {
    let words = words.iter().map(|word| match word {
        Word::Fixed(text) => quote(text),
        Word::Share(before, after) => {
            let before = if before.is_empty() {
                String::new()
            } else {
                quote(before)
            };
            format!("{before}\"${variable}\"{after}")
        }
    });
    words.collect::<Vec<_>>().join(" ")
}

/// The scene's name without folder and endings.
fn stem(scene: &str) -> String {
    let name = Path::new(scene)
        .file_name()
        .map_or(scene.into(), |name| name.to_string_lossy());
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    name.strip_suffix(".pbrt").unwrap_or(name).to_owned()
}

/// The same file under a name that no command takes for a flag.
fn not_a_flag(file: &str) -> String {
    if file.starts_with('-') {
        format!("./{file}")
    } else {
        file.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn args(scene: &str, output: Option<&str>) -> FarmArgs {
        let output = output.map(Into::into);
        FarmArgs {
            scene: scene.into(),
            parts: 4,
            spp: None,
            output,
            flags: Vec::new(),
        }
    }

    #[track_caller]
    fn check_names(scene: &str, output: Option<&str>, expected: [&str; 3]) {
        let args = args(scene, output);
        let plan = Plan::new(&args).unwrap();
        assert_eq!([&plan.name, &plan.image, &plan.job()], expected);
    }

    #[test]
    fn names_come_from_the_image_then_the_scene() {
        check_names("a/room.pbrt", None, ["room", "room.exr", "room"]);
        check_names("a/room.pbrt.gz", None, ["room", "room.exr", "room"]);
        check_names("a/room", None, ["room", "room.exr", "room"]);
        check_names(
            "r.pbrt",
            Some("out/my room.exr"),
            ["out/my room", "out/my room.exr", "my-room"],
        );
        check_names("r.pbrt", Some("-x.exr"), ["./-x", "./-x.exr", "x"]);
        check_names("r.pbrt", Some("é.exr"), ["é", "é.exr", "bidir"]);
        for image in [
            "room.png",
            ".exr",
            "room.part-2.exr",
            "a.part-x.part-0-of-8.exr",
        ] {
            assert!(Plan::new(&args("r.pbrt", Some(image))).is_err(), "{image}");
        }
        for image in [
            "room-2.exr",
            "room.part.exr",
            "room.part-.exr",
            "a.part-b.exr",
        ] {
            assert!(Plan::new(&args("r.pbrt", Some(image))).is_ok(), "{image}");
        }
        assert!(Plan::new(&args("-", None)).is_err());
    }

    #[test]
    fn the_number_of_the_share_is_a_variable_outside_quotes() {
        let args = args("my scene.pbrt", None);
        let plan = Plan::new(&args).unwrap();
        let command = shell_command(
            &plan.render(Word::Share(String::new(), "/4".into())),
            "part",
        );
        let expected = "bidir render 'my scene.pbrt' --part \"$part\"/4 \
                        --checkpoint 'my scene.part-'\"$part\"-of-4.film --resume";
        assert_eq!(command, expected);
    }
}

//! `bidir farm`: prints a job file with which a scheduler starts the parts of a render.
//!
//! Part I of N renders its passes into a film file NAME.part-I-of-N.film, and continues from it when it
//! is started again; the last step merges the film files and develops the image. There is no protocol and
//! no server of our own: the job file is a text that users read and change.
//!
//! The templates are job files with placeholders `{{…}}`, which [`filled`] replaces:
//!
//! * `slurm.sh` has three roles: directives for `sbatch`, a part, and a script that submits both steps. Two
//!   minutes before its time is over, Slurm sends USR1 to the shell alone, which stops the render with
//!   TERM and then requeues the part. Slurm's own TERM, at the end of the time, before preemption and by
//!   scancel, reaches every process: the shell only has to wait, and must not requeue a cancelled part.
//! * `hyperqueue.sh` is a part, and a script that submits all parts and runs the last step. HyperQueue
//!   itself repeats tasks whose worker was lost, but not those that failed.
//! * `k8s.yaml` replaces its shell by the program, so that TERM reaches the render itself.
//! * `shell.sh` is for one machine, or several that share a folder.

use crate::args::{Cli, FarmArgs, FarmCommand};
use crate::console::print;
use crate::exit::{Exit, Failure};
use crate::output::default_image;
use crate::scene_io::{self, Format};
use formats::is_obeyed;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// Prints a job file.
pub(crate) fn run(command: &FarmCommand) -> Result<Exit, Failure> {
    let (args, template) = match command {
        FarmCommand::Slurm(args) => (args, include_str!("farm/slurm.sh")),
        FarmCommand::Hyperqueue(args) => (args, include_str!("farm/hyperqueue.sh")),
        FarmCommand::K8s(args) => (args, include_str!("farm/k8s.yaml")),
        FarmCommand::Shell(args) => (args, include_str!("farm/shell.sh")),
    };
    let mut words = [&args.scene]
        .into_iter()
        .chain(&args.output)
        .chain(&args.flags);
    if let Some(word) = words.find(|word| word.contains(is_obeyed)) {
        let message = format!("`{word}` has control characters, which a job file cannot show");
        return Err(Failure::usage(message).with_hint("rename the file"));
    }
    check_part(args)?;
    let default = || default_image(Path::new(&args.scene), None);
    let image = args.output.as_ref().map_or_else(default, PathBuf::from);
    scene_io::image_format(&image, &[Format::Exr])?;
    print(&filled(
        template,
        args,
        &image.with_extension("").to_string_lossy(),
    ))
}

/// Checks the command line of a part, in which no flag may select other passes or another film.
fn check_part(args: &FarmArgs) -> Result<(), Failure> {
    let own = ["--part=1/2", "--checkpoint=a.film", "--resume"];
    let before = ["bidir", "render", &args.scene].into_iter().chain(own);
    let flags = args.flags.iter().map(String::as_str);
    let words: Vec<_> = before.chain(flags).map(OsString::from).collect();
    Cli::check(&words)
}

/// Fills in the placeholders of a template in one pass, so that braces in `name`, the image's without ending, are
/// not replaced.
fn filled(template: &str, args: &FarmArgs, name: &str) -> String {
    let spp = args.spp.map(|spp| ["--spp".to_owned(), spp.to_string()]);
    let given = spp.iter().flatten().chain(&args.flags);
    let flags: Vec<_> = given.map(|flag| " ".to_owned() + &quote(flag)).collect();
    let pieces = template.split("{{").map(|piece| {
        let Some((placeholder, after)) = piece.split_once("}}") else {
            return piece.to_owned();
        };
        let value = match placeholder {
            "scene" => quote(&args.scene),
            "name" => quote(name),
            "label" => label(name),
            "parts" => args.parts.to_string(),
            "last" => (args.parts - 1).to_string(),
            "flags" => flags.concat(),
            _ => unreachable!("no template has the placeholder {placeholder}"),
        };
        value + after
    });
    pieces.collect()
}

/// Returns a name for the job, as Kubernetes demands: small letters, digits and dashes.
fn label(name: &str) -> String {
    let name = Path::new(name)
        .file_name()
        .unwrap_or_default()
        .to_string_lossy();
    let small = name.chars().take(40).map(|c| match c.to_ascii_lowercase() {
        c if c.is_ascii_alphanumeric() => c,
        _ => '-',
    });
    format!("bidir-{}", small.collect::<String>())
        .trim_end_matches('-')
        .to_owned()
}

/// Quotes a word for POSIX shells.
fn quote(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_@%+=:,./-".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

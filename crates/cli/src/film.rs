//! `bidir film`, `bidir merge` and `bidir missing`: the commands for film files.

use crate::args::{FilmCommand, MergeArgs, MissingArgs, Part};
use crate::console::{Console, print, print_json, say};
use crate::exit::{Exit, Failure};
use crate::lock::FilmLock;
use crate::output;
use crate::scene_io::{self, Developed, FilmFile, FilmHeader, IMAGES};
use bidir::film::PassSet;
use formats::film::OpenError;
use formats::printable;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Describes, develops or verifies film files.
pub(crate) fn run(command: &FilmCommand, console: Console) -> Result<Exit, Failure> {
    match command {
        FilmCommand::Info { file, json } => {
            let header = scene_io::read_film(file)?.header;
            if *json {
                print_json(&header)
            } else {
                print_header(&header)
            }
        }
        FilmCommand::Develop { file, output } => develop(file, output),
        FilmCommand::Verify { files } => Ok(verify(files, console)),
    }
}

/// Prints a header, one value per line.
fn print_header(header: &FilmHeader) -> Result<Exit, Failure> {
    let [left, top, right, bottom] = header.crop;
    let [width, height] = header.resolution;
    let passes = format!("{} ({})", header.passes, header.passes.len());
    let film = format!("{width} x {height} pixels, {left},{top} to {right},{bottom}");
    let values = [
        ("passes", passes),
        ("film", film),
        ("scene", header.scene.clone()),
        ("program", header.program.clone()),
        ("identity", header.identity.clone()),
        ("stopped", header.stopping.name().to_owned()),
        ("time", format!("{:.1} s", header.seconds)),
    ];
    let lines = values.map(|(name, value)| format!("{name:10}{}\n", printable(&value)));
    let settings = header.settings.clone().into_iter();
    let counted = settings.chain(formats::film::counts_by_name(header));
    let texts = counted.map(|(name, value)| {
        let [name, value] = [&name, &value].map(|text| printable(text));
        format!("  {name:21}{value}\n")
    });
    print(&lines.into_iter().chain(texts).collect::<String>())
}

fn develop(file: &PathBuf, output: &Path) -> Result<Exit, Failure> {
    output::check_image("--output", output, IMAGES, [file])?;
    let FilmFile { header, film } = scene_io::read_film(file)?;
    if film.passes().is_empty() {
        let message = format!("{}: the film has no passes", file.display());
        return Err(Failure::new(Exit::Validation, message));
    }
    write_image(output, &header, &film)?;
    say(format_args!(
        "{} passes; wrote {}",
        film.passes().len(),
        output.display()
    ));
    Ok(Exit::Done)
}

fn write_image(
    output: &Path,
    header: &FilmHeader,
    film: &bidir::film::Film,
) -> Result<(), Failure> {
    let (developed, metadata) = (Developed::new(film), formats::film::metadata(header));
    Ok(developed.write(output, film.settings(), &metadata)?)
}

/// Reads every file to its end, which verifies all checksums. Reports damaged ones.
fn verify(files: &[PathBuf], console: Console) -> Exit {
    let mut last = None;
    for file in files {
        match scene_io::read_film(file) {
            Ok(film) => say(format_args!(
                "{}: whole, passes {}",
                file.display(),
                film.header.passes
            )),
            Err(failure) => {
                console.failure(&failure);
                last = Some(failure.exit());
            }
        }
    }
    last.unwrap_or(Exit::Done)
}

/// Returns the failure to replace `path`, which `flag` names, because it is not a film file.
pub(crate) fn not_a_film(path: &Path, flag: &str) -> Failure {
    let name = path.display();
    let message = format!("{name} is not a film file, and is not replaced by one");
    Failure::usage(message).with_hint(format!("name another file with {flag}"))
}

/// Merges film files of one render with different passes.
pub(crate) fn merge(args: &MergeArgs) -> Result<Exit, Failure> {
    check_outputs(args)?;
    output::check_film_name(&args.output)?;
    let _lock = FilmLock::take(&args.output)?;
    let Merged { all, known } = merged(args)?;
    check_kept(&args.output, &all.header)?;
    formats::film::write(&args.output, &all.header, &all.film)?;
    if let Some(image) = &args.image {
        write_image(image, &all.header, &all.film)?;
    }
    let paths = [Some(&args.output), args.image.as_ref()];
    let existing = paths.into_iter().flatten();
    let written: Vec<_> = existing.map(|path| path.display().to_string()).collect();
    let known = match known {
        0 => String::new(),
        known => format!(", {known} of them merged before"),
    };
    say(format_args!(
        "passes {} of {} files{known}; wrote {}",
        all.film.passes(),
        args.files.len(),
        written.join(", ")
    ));
    Ok(Exit::Done)
}

/// The sum of film files.
struct Merged {
    all: FilmFile,
    /// The number of films whose passes the output already had.
    known: usize,
}

/// Adds the films. If the output is one of them, adds it first, and skips films whose passes it has. These were
/// merged into it before: passes of one render have the same bits on any machine.
fn merged(args: &MergeArgs) -> Result<Merged, Failure> {
    let is_output = |file: &&PathBuf| scene_io::is_same(file, &args.output);
    let (own, others): (Vec<_>, Vec<_>) = args.files.iter().partition(is_output);
    let mut files = own.iter().chain(&others);
    let first = files.next().expect("clap asks for a file");
    let mut all = scene_io::read_film(first)?;
    let held = own.first().map(|_| all.header.passes.clone());
    let mut known = 0;
    for file in files {
        let film = scene_io::read_film(file)?;
        if film.header.difference(&all.header).is_none() && is_held(held.as_ref(), &film) {
            known += 1;
            continue;
        }
        all.merge(&film).map_err(|error| {
            let reason = match error {
                OpenError::OtherRender(difference) => difference,
                error => error.to_string(),
            };
            let [file, first] = [file, first].map(|file| file.display());
            let message = format!("{file}: cannot be merged with {first}: {reason}");
            Failure::new(Exit::FilmMismatch, message)
                .with_hint("film files of one render with different passes can be merged")
        })?;
    }
    Ok(Merged { all, known })
}

/// Returns true if `film` has passes, and all of them are in `held`.
fn is_held(held: Option<&PassSet>, film: &FilmFile) -> bool {
    let passes = &film.header.passes;
    held.is_some_and(|held| !passes.is_empty() && passes.difference(held).is_empty())
}

/// Checks, before films are read, that the outputs can be written and replace no file of another kind. The
/// output may be one of the films.
fn check_outputs(args: &MergeArgs) -> Result<(), Failure> {
    let (output, image) = (&args.output, &args.image);
    if let Some(image) = image {
        scene_io::image_format(image, IMAGES)?;
    }
    let image = image.as_deref().map(|image| ("--image", image));
    let written: Vec<_> = [("--output", &**output)].into_iter().chain(image).collect();
    let files = args.files.iter();
    let others = files.filter(|file| !scene_io::is_same(file, output));
    scene_io::check_apart(others, &written)?;
    for (flag, file) in written {
        output::check_file(flag, file)?;
    }
    if output.is_file() && !scene_io::is_film(output) {
        return Err(not_a_film(output, "--output"));
    }
    let film = image.filter(|(_, image)| scene_io::is_film(image));
    film.map_or(Ok(()), |(flag, image)| {
        let name = image.display();
        let message = format!("{name} is a film file, and is not replaced by an image");
        Err(Failure::usage(message).with_hint(format!("name another file with {flag}")))
    })
}

/// Refuses to replace the film file `output` if it has passes that `all`, the header of the result, lacks.
fn check_kept(output: &Path, all: &FilmHeader) -> Result<(), Failure> {
    if !output.is_file() {
        return Ok(());
    }
    let another = "name another file with --output";
    let existing = scene_io::read_film(output).map_err(|failure| failure.with_hint(another))?;
    let (existing, name) = (existing.header, output.display());
    let refuse = |message: String, hint: &str| {
        Err(Failure::new(Exit::FilmMismatch, message).with_hint(hint))
    };
    if let Some(difference) = existing.difference(all) {
        let message =
            format!("{name} is the film of another render, and is not replaced: {difference}");
        return refuse(message, another);
    }
    let lost = existing.passes.difference(&all.passes);
    if lost.is_empty() {
        return Ok(());
    }
    let message = format!("{name} has the passes {lost}, which would be lost");
    let hint = "name another file with --output, or list this one among the files";
    refuse(message, hint)
}

/// Returns the passes of all files. Reports files that cannot be read, which count as empty.
fn held(files: &[PathBuf], console: Console) -> Result<PassSet, Failure> {
    let mut first: Option<FilmHeader> = None;
    let mut held = PassSet::default();
    for file in files {
        let header = match scene_io::read_film(file) {
            Ok(film) => film.header,
            Err(failure) => {
                console.failure(&failure);
                continue;
            }
        };
        let expected = first.get_or_insert_with(|| header.clone());
        if let Some(difference) = header.difference(expected) {
            let message = format!(
                "{} is the film of another render: {difference}",
                file.display()
            );
            return Err(Failure::new(Exit::FilmMismatch, message));
        }
        held = held.union(&header.passes);
    }
    Ok(held)
}

/// Prints the passes that no file has.
pub(crate) fn missing(args: &MissingArgs, console: Console) -> Result<Exit, Failure> {
    let held = held(&args.files, console)?;
    let lacking = PassSet::from(0..args.spp).difference(&held);
    let lacking_parts = (0..args.parts.unwrap_or(0)).filter_map(|index| {
        let of = args.parts?;
        let part = PassSet::from(Part { index, of }.range(args.spp));
        let is_missing = !part.intersection(&lacking).is_empty();
        is_missing.then(|| format!("{index}/{of}"))
    });
    let parts: Vec<_> = lacking_parts.collect();
    let ranges = lacking.ranges().iter();
    let passes: Vec<_> = ranges
        .map(|range| format!("{}..{}", range.start, range.end))
        .collect();
    let lines = args.parts.map_or(&passes, |_| &parts);
    if args.json {
        print_json(&json!({"passes": passes, "parts": parts}))?;
    } else if !lines.is_empty() {
        print(&(lines.join("\n") + "\n"))?;
    }
    let exit = if lacking.is_empty() {
        Exit::Done
    } else {
        Exit::Validation
    };
    Ok(exit)
}

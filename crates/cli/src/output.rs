//! The files that a render writes, and checks that they can be written.

use crate::args::RenderArgs;
use crate::exit::{Exit, Failure};
use crate::lock;
use crate::pyramid;
use crate::scene_io::{self, Developed, Format, IMAGES, MetadataValue};
use bidir::film::FilmSettings;
use std::path::{Path, PathBuf};

/// The files that a render writes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Outputs {
    exr: Option<PathBuf>,
    png: Option<PathBuf>,
    /// The statistics as JSON.
    pub(crate) stats: Option<PathBuf>,
    /// Images of each strategy.
    pub(crate) pyramid: Option<PathBuf>,
}

impl Outputs {
    /// Returns the files that flags name. They are known before the scene is read.
    pub(crate) fn named(args: &RenderArgs) -> Result<Self, Failure> {
        let image = args.output.output.clone();
        let [exr, png] = image.map_or(Ok([None, None]), images)?;
        let stats = args.output.stats.clone();
        let folder = args.layers.pyramid.as_deref();
        let pyramid = folder.map(pyramid::file);
        Ok(Self {
            exr,
            png,
            stats,
            pyramid,
        })
    }

    /// Returns the files of a render; `film` is the name that the scene gives its image.
    ///
    /// A part of a render has an image only if a flag names it, as by default all parts would write the same file.
    pub(crate) fn new(args: &RenderArgs, film: Option<&str>) -> Result<Self, Failure> {
        let named = Self::named(args)?;
        if is_part(args) || args.output.output.is_some() {
            return Ok(named);
        }
        let [exr, png] = images(default_image(&args.scene.scene, film))?;
        Ok(Self { exr, png, ..named })
    }

    /// Returns all files, each with the flag that names it.
    fn files(&self) -> impl Iterator<Item = (&'static str, &Path)> {
        let files = self.exr.iter().chain(&self.png);
        let images = files.map(|file| ("--output", file));
        let stats = self.stats.iter().map(|file| ("--stats", file));
        let pyramid = self.pyramid.iter().map(|file| ("--pyramid", file));
        let all = images.chain(stats).chain(pyramid);
        all.map(|(flag, file)| (flag, file.as_path()))
    }

    /// Checks, before rendering, that the files can be written and replace none of `inputs`.
    pub(crate) fn check(&self, args: &RenderArgs, inputs: &[PathBuf]) -> Result<(), Failure> {
        let is_kept = self.exr.is_some() || args.long.checkpoint.is_some();
        if args.layers.need_exr() && self.png.is_some() && !is_kept {
            let message = "a PNG cannot hold layers";
            let hint = "write NAME.exr with --output, or keep a film file with --checkpoint";
            return Err(Failure::usage(message).with_hint(hint));
        }
        self.check_part(args)?;
        if let Some(folder) = &args.layers.pyramid {
            pyramid::make_folder(folder)?;
        }
        let film = args.long.checkpoint.as_deref();
        let kept = film.map(lock::files).unwrap_or_default();
        let films = kept.iter().map(|file| ("--checkpoint", file.as_path()));
        let all: Vec<_> = self.files().chain(films).collect();
        scene_io::check_apart(inputs, &all)?;
        film.map_or(Ok(()), check_film_name)?;
        let flagged = film.map(|film| ("--checkpoint", film));
        let mut named = self.files().chain(flagged);
        named.try_for_each(|(flag, file)| check_file(flag, file))
    }

    /// Refuses a part of a render that would write nothing.
    fn check_part(&self, args: &RenderArgs) -> Result<(), Failure> {
        let is_watched = args.serve.is_some() || args.display_server.is_some();
        let is_kept = args.long.checkpoint.is_some() || self.files().next().is_some();
        if !is_part(args) || is_watched || is_kept {
            return Ok(());
        }
        let message = "a part of a render writes no image by default: nothing would be written";
        let hint = "keep it with --checkpoint FILE.film, or name an image with --output";
        Err(Failure::usage(message).with_hint(hint))
    }

    /// Writes the image.
    pub(crate) fn write_image(
        &self,
        film: &FilmSettings,
        developed: &Developed,
        metadata: &[(String, MetadataValue)],
    ) -> Result<(), Failure> {
        if let Some(exr) = &self.exr {
            developed.write_exr(exr, film, metadata)?;
        }
        if let Some(png) = &self.png {
            developed.write_png(png)?;
        }
        Ok(())
    }

    /// Returns the names of the files.
    pub(crate) fn names(&self) -> impl Iterator<Item = String> {
        self.files().map(|(_, file)| file.display().to_string())
    }
}

/// Returns true if the command renders a part of the passes.
pub(crate) fn is_part(args: &RenderArgs) -> bool {
    args.long.passes.is_some() || args.long.part.is_some()
}

/// Checks that the file named by `flag` can be written.
pub(crate) fn check_file(flag: &str, file: &Path) -> Result<(), Failure> {
    if file.is_dir() {
        let message = format!("cannot write `{}`: it is a folder", file.display());
        return Err(Failure::new(Exit::InputOutput, message));
    }
    formats::file::check_replaceable(file)
        .map_err(|error| Failure::from(error).with_hint(hint(flag, scene_io::folder_of(file))))
}

/// Checks that the image named by `flag` has one of these formats, can be written, and replaces no input. Returns
/// its format.
pub(crate) fn check_image<'a>(
    flag: &'static str,
    image: &Path,
    formats: &[Format],
    inputs: impl IntoIterator<Item = &'a PathBuf>,
) -> Result<Format, Failure> {
    let format = scene_io::image_format(image, formats)?;
    scene_io::check_apart(inputs, &[(flag, image)])?;
    check_file(flag, image)?;
    Ok(format)
}

/// Returns the EXR, if there is one, and the PNG for the name of an image.
fn images(image: PathBuf) -> Result<[Option<PathBuf>; 2], Failure> {
    if scene_io::image_format(&image, IMAGES)? == Format::Png {
        return Ok([None, Some(image)]);
    }
    let png = image.with_extension("png");
    Ok([Some(image), Some(png)])
}

/// Returns the name of the EXR: the scene's name for its image with the ending .exr, or else that of the scene file.
pub(crate) fn default_image(scene: &Path, film: Option<&str>) -> PathBuf {
    let name = film
        .map(Path::new)
        .filter(|film| film.file_stem().is_some())
        .or_else(|| Some(Path::new(scene.file_stem()?)).filter(|stem| *stem != Path::new("-")));
    name.unwrap_or(Path::new("bidir")).with_extension("exr")
}

/// Returns the default name of an output, in the current folder: the input's name with another ending.
pub(crate) fn named_after(input: &Path, ending: &str) -> PathBuf {
    let stem = input.file_stem().filter(|stem| *stem != "-");
    let mut name = stem.unwrap_or("bidir".as_ref()).to_owned();
    name.push(ending);
    name.into()
}

/// Refuses a new film file whose name has the ending of another kind of file.
pub(crate) fn check_film_name(file: &Path) -> Result<(), Failure> {
    let ending = file.extension().unwrap_or_default();
    if ending.eq_ignore_ascii_case("film") || file.exists() {
        return Ok(());
    }
    let message = format!("cannot write `{}`: film files are .film", file.display());
    let named = file.with_extension("film");
    Err(Failure::usage(message).with_hint(format!("name it {}", named.display())))
}

fn hint(flag: &str, folder: &Path) -> String {
    let folder_name = folder.display();
    if folder.is_dir() {
        format!("cannot create files in `{folder_name}`: check its permissions and free space")
    } else {
        format!("make the folder `{folder_name}`, or write elsewhere with {flag}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::args::{Cli, Command};
    use clap::Parser;

    /// Returns the outputs of `bidir render scenes/room.pbrt` with more flags.
    fn outputs(flags: &str, film: Option<&str>) -> Result<Outputs, Failure> {
        let words = "bidir render scenes/room.pbrt".split(' ');
        let cli = Cli::try_parse_from(words.chain(flags.split_whitespace())).unwrap();
        let Command::Render(args) = cli.command else {
            panic!("another command")
        };
        Outputs::new(&args, film)
    }

    #[track_caller]
    fn check(flags: &str, film: Option<&str>, expected: &str) {
        let names: Vec<_> = outputs(flags, film).unwrap().names().collect();
        assert_eq!(names.join(", "), expected);
    }

    #[test]
    fn names_come_from_the_flag_then_the_film_then_the_scene() {
        check("-o a/b.exr", Some("film.exr"), "a/b.exr, a/b.png");
        check("-o b.PNG", None, "b.PNG");
        check("", Some("film.png"), "film.exr, film.png");
        check("", Some(""), "room.exr, room.png");
        check("", None, "room.exr, room.png");
    }

    #[test]
    fn other_endings_are_errors_of_the_command_line() {
        assert_eq!(outputs("-o a.jpg", None).unwrap_err().exit(), Exit::Usage);
        assert_eq!(outputs("-o a", None).unwrap_err().exit(), Exit::Usage);
    }

    #[test]
    fn a_part_has_an_image_only_if_a_flag_names_it() {
        check("--passes 0..4", Some("film.exr"), "");
        check("--part 0/4 -o a.png", Some("film.exr"), "a.png");
    }
}

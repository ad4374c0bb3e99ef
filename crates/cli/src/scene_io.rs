//! Reads and writes files by the `formats` library, with the flags and failures of the command.

use crate::args::{FilmArgs, SceneArgs};
use crate::console::Console;
use crate::exit::{Exit, Failure};
use crate::signals::Signals;
use bidir::film::{FilmError, PixelRect};
use bidir::scene::Scene;
use bidir::view::View;
use formats::ErrorKind;
use formats::image::{ExrImage, ExrLayer};
use formats::outputs::Output;
use formats::scene::{Crop, LoadOptions};
use lab::image::Pixels;
use lab::metric::ErrorMap;
use std::path::{Path, PathBuf};

pub(crate) use formats::file::{folder_of, nearest_file, remove_leftovers, target_of};
pub(crate) use formats::film::{Developed, FilmFile, FilmHeader, is_film};
pub(crate) use formats::image::{Format, Layers, MetadataValue};
pub(crate) use formats::outputs::is_same;
pub(crate) use formats::scene::Loaded;

/// The hint for a film that is too large.
const SMALLER: &str =
    "make it smaller with --size, render a part of it with --crop, or ask for fewer layers";

/// Reads a scene. The size and crop in `film` replace the file's.
pub(crate) fn load(args: &SceneArgs, film: Option<&FilmArgs>) -> Result<Loaded, Failure> {
    let options = LoadOptions {
        lenient: args.lenient,
        resolution: film.and_then(|film| film.size),
        crop: film.and_then(crop),
        isa: args.isa,
        ..LoadOptions::default()
    };
    let mut loaded = formats::scene::load(&args.scene, &options).map_err(refused)?;
    let beyond = film.and_then(|film| crop_warning(film, &loaded.view));
    let more = beyond.into_iter().chain(light_warning(&loaded.scene));
    loaded.warnings.extend(more);
    Ok(loaded)
}

/// Reads a scene as [`load`] does. None: a signal came first.
pub(crate) fn load_until(
    signals: &Signals,
    args: &SceneArgs,
    film: Option<&FilmArgs>,
) -> Result<Option<Loaded>, Failure> {
    let (args, film) = (args.clone(), film.cloned());
    let loaded = signals.wait_for(move || load(&args, film.as_ref()), || ());
    loaded.transpose()
}

/// Returns the failure of a film that is too large, at the place that gives its size.
pub(crate) fn too_large(loaded: &Loaded, error: &FilmError) -> Failure {
    let error = loaded.too_large(error);
    if error.has_place() {
        return Failure::diagnostic(Exit::Scene, error.with_hint(SMALLER));
    }
    let message = format!("--size: {}", error.message());
    Failure::new(Exit::Scene, message).with_hint(SMALLER)
}

/// Prints the warnings of a scene. With `--strict`, fails if there are any, or if `others`, the number of other
/// warnings, is not 0.
pub(crate) fn print_warnings(
    loaded: &Loaded,
    args: &SceneArgs,
    others: usize,
    console: Console,
) -> Result<(), Failure> {
    for warning in &loaded.warnings {
        console.warning(warning);
    }
    check_strict(args, loaded.warnings.len() + others)
}

/// Refuses any warnings under `--strict`.
pub(crate) fn check_strict(args: &SceneArgs, count: usize) -> Result<(), Failure> {
    if args.strict && count > 0 {
        let message = if count == 1 {
            "1 warning, an error under --strict".to_owned()
        } else {
            format!("{count} warnings, errors under --strict")
        };
        return Err(Failure::new(Exit::Validation, message));
    }
    Ok(())
}

/// Returns the crop of the flags. clap accepts only one of the three flags.
fn crop(film: &FilmArgs) -> Option<Crop> {
    let pixels = film.crop.or(film.pixelbounds);
    let of_pixels = |PixelRect { min, max }| Crop::Pixels([min[0], max[0], min[1], max[1]]);
    let fractions = || film.cropwindow.map(Crop::Fractions);
    pixels.map(of_pixels).or_else(fractions)
}

/// Returns the warning of a crop that reaches beyond the film. None: it does not.
fn crop_warning(args: &FilmArgs, view: &View) -> Option<String> {
    let asked = args.crop.or(args.pixelbounds)?;
    let film = view.film();
    let [width, height] = film.resolution;
    let message = format!("the crop reaches beyond the film, which has {width} x {height} pixels");
    (film.crop != asked).then_some(message)
}

/// Returns the warning of a scene without light. None: there is a light, though it may be dark.
fn light_warning(scene: &Scene) -> Option<String> {
    let is_dark = scene.lights().is_empty();
    is_dark.then(|| "the scene has no light: the image will be black".to_owned())
}

/// Returns the exit for an error of reading a scene. A crop that does not fit is an error of the command
/// line. A scene file that cannot be opened is an error of files; a missing file that the scene names is an
/// error of the scene.
pub(crate) fn exit_of_scene(error: &formats::Error) -> Exit {
    match error.kind() {
        ErrorKind::Options => Exit::Usage,
        ErrorKind::MissingFile | ErrorKind::Io if !error.has_place() => Exit::InputOutput,
        _ => Exit::Scene,
    }
}

/// Returns the failure of a scene that cannot be read. A missing scene file has no lines to show, and a separate
/// hint.
fn refused(error: formats::Error) -> Failure {
    let exit = exit_of_scene(&error);
    match error.hint() {
        Some(hint) if error.kind() == ErrorKind::MissingFile && !error.has_place() => {
            Failure::new(exit, error.message()).with_hint(hint)
        }
        _ => Failure::diagnostic(exit, error),
    }
}

/// Reads an image.
pub(crate) fn read_image(path: &Path) -> Result<Pixels, Failure> {
    Ok(Pixels::from(&formats::image::read(path, None)?))
}

/// Writes errors to an EXR as the channel Y, or to a PNG as colours from 0 to `full`.
pub(crate) fn write_error_map(
    path: &Path,
    errors: &ErrorMap,
    full: f64,
    metadata: &[(String, MetadataValue)],
) -> Result<(), Failure> {
    if Format::of(path) != Some(Format::Exr) {
        let colors = errors.false_color(full);
        return Ok(formats::image::write_png(path, colors.size, &colors.data)?);
    }
    let data: Vec<f32> = errors.data.iter().map(|&error| error as f32).collect();
    let layers = [ExrLayer {
        name: "",
        channels: &["Y"],
        data: &data,
    }];
    let image = ExrImage {
        metadata,
        ..ExrImage::whole(errors.size, &layers)
    };
    Ok(formats::image::write_exr(path, &image)?)
}

/// The formats in which images can be written.
pub(crate) const IMAGES: &[Format] = &[Format::Exr, Format::Png];

/// Returns the format of an image by its name.
///
/// Errors: the format is not in `written`.
pub(crate) fn image_format(path: &Path, written: &[Format]) -> Result<Format, Failure> {
    let named = Format::of(path).filter(|named| written.contains(named));
    named.ok_or_else(|| {
        if path.is_dir() {
            return is_folder(path, written);
        }
        let endings: Vec<_> = written.iter().map(|format| ending(*format)).collect();
        let (path, endings) = (path.display(), endings.join(" or "));
        Failure::usage(format!(
            "cannot write `{path}`: output images are {endings}"
        ))
    })
}

/// Returns the ending of the names of images in a format.
fn ending(format: Format) -> &'static str {
    match format {
        Format::Png => ".png",
        _ => ".exr",
    }
}

/// Returns the failure for an output whose name is the name of a folder.
fn is_folder(path: &Path, written: &[Format]) -> Failure {
    let message = format!("cannot write `{}`: it is a folder", path.display());
    let file = path.join(format!("NAME{}", ending(written[0])));
    let hint = format!("name a file, such as {}", file.display());
    Failure::new(Exit::InputOutput, message).with_hint(hint)
}

/// Reads a film file.
pub(crate) fn read_film(path: &Path) -> Result<FilmFile, Failure> {
    Ok(formats::film::read(path)?)
}

/// Fails if an output would replace an input or another output. Each output comes with the flag that names it.
pub(crate) fn check_apart<'a>(
    inputs: impl IntoIterator<Item = &'a PathBuf>,
    outputs: &[(&str, &Path)],
) -> Result<(), Failure> {
    let outputs = outputs.iter().map(|&(flag, path)| Output {
        path,
        flag: Some(flag),
    });
    let inputs = inputs.into_iter().map(PathBuf::as_path);
    formats::outputs::check(inputs, &outputs.collect::<Vec<_>>()).map_err(|error| {
        let failure = Failure::new(Exit::InputOutput, error.message());
        failure.with_hint(error.hint().unwrap_or_default())
    })
}

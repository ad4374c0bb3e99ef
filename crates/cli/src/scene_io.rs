//! Reading and writing by the `formats` library, in terms of the command.

use crate::args::{FilmArgs, SceneArgs};
use crate::console::Console;
use crate::exit::{Exit, Failure};
use crate::signals::Signals;
use bidir::driver::Settings;
use bidir::film::{FilmError, FilmSettings};
use bidir::scene::Scene;
use bidir::view::View;
use formats::film::Subject;
use formats::image::{ExrImage, ExrLayer, Format};
use formats::outputs::Output;
use formats::scene::{Crop, Lamp, LoadOptions, Summary};
use formats::{ErrorKind, FilePlace};
use lab::image::Pixels;
use lab::metric::ErrorMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

pub(crate) use formats::file::{folder_of, nearest_file, remove_leftovers, target_of};
pub(crate) use formats::film::{Developed, FilmFile, FilmHeader, Stopping, is_film};
pub(crate) use formats::image::{Layers, MetadataValue};
pub(crate) use formats::outputs::is_same;

/// The hint for a film that is too large.
const SMALLER: &str =
    "make it smaller with --size, render a part of it with --crop, or ask for fewer layers";

/// A scene that was read, with the settings of its file.
pub(crate) struct LoadedScene {
    /// The scene, with the view of the file or the one that flags ask for.
    pub(crate) subject: Subject,
    /// The file's settings, over the defaults.
    pub(crate) settings: Settings,
    /// The file's number of samples per pixel.
    pub(crate) spp: u64,
    /// The name that the file gives its image.
    pub(crate) output: Option<PathBuf>,
    /// The warnings, each with its place.
    pub(crate) warnings: Vec<String>,
    /// The warnings that name the substitute of an unsupported feature.
    pub(crate) refused: Vec<String>,
    /// The first lamps that no ray can hit.
    pub(crate) lamps: Vec<Lamp>,
    /// The place of the film's size in the file. None: --size gives it.
    film_place: Option<FilePlace>,
    /// The parts of the scene.
    pub(crate) summary: Summary,
    /// The files that the scene reads or names, which no output may replace.
    pub(crate) inputs: Vec<PathBuf>,
}

/// Reads a scene, with the film that `film` asks for instead of the file's.
pub(crate) fn load(args: &SceneArgs, film: Option<&FilmArgs>) -> Result<LoadedScene, Failure> {
    let options = LoadOptions {
        lenient: args.lenient,
        resolution: film.and_then(|film| film.size).map(|size| size.0),
        crop: film.and_then(crop),
        isa: args.isa,
        ..LoadOptions::default()
    };
    let loaded = formats::scene::load(&args.scene, &options).map_err(refused)?;
    let mut warnings = loaded.warnings;
    warnings.extend(film.and_then(|film| crop_warning(film, &loaded.view)));
    warnings.extend(light_warning(&loaded.scene));
    Ok(LoadedScene {
        subject: Subject {
            name: args.scene.display().to_string(),
            digest: loaded.digest.to_string(),
            scene: Arc::new(loaded.scene),
            view: loaded.view,
        },
        settings: loaded.settings.render_settings(),
        spp: loaded.settings.samples_per_pixel.into(),
        output: loaded.settings.output.map(PathBuf::from),
        warnings,
        refused: loaded.refused,
        lamps: loaded.lamps,
        film_place: loaded.film_place,
        summary: loaded.summary,
        inputs: loaded.inputs,
    })
}

/// Does the same unless a signal comes first. None: it came.
pub(crate) fn load_until(
    signals: &Signals,
    args: &SceneArgs,
    film: Option<&FilmArgs>,
) -> Result<Option<LoadedScene>, Failure> {
    let (args, film) = (args.clone(), film.cloned());
    let loaded = signals.wait_for(move || load(&args, film.as_ref()), || ());
    loaded.transpose()
}

impl LoadedScene {
    /// Returns the failure of a film that is too large, at the place that gives its size.
    pub(crate) fn too_large(&self, error: &FilmError) -> Failure {
        let [width, height] = self.subject.view.film().resolution;
        let message = format!("a film of {width} x {height} pixels is too large: {error}");
        match &self.film_place {
            Some(place) => {
                let error = place.error(ErrorKind::Memory, message);
                Failure::diagnostic(Exit::Scene, error.with_hint(SMALLER))
            }
            None => Failure::new(Exit::Scene, format!("--size: {message}")).with_hint(SMALLER),
        }
    }

    /// Prints the warnings, of which there are `others` more; with `--strict` they are errors.
    pub(crate) fn print_warnings(
        &self,
        args: &SceneArgs,
        others: usize,
        console: Console,
    ) -> Result<(), Failure> {
        for warning in &self.warnings {
            console.warning(warning);
        }
        self.check_strict(args, others)
    }

    /// Refuses the warnings, of which there are `others` more, under `--strict`.
    pub(crate) fn check_strict(&self, args: &SceneArgs, others: usize) -> Result<(), Failure> {
        let count = self.warnings.len() + others;
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
}

/// The crop that flags ask for; clap lets only one of them be given.
fn crop(film: &FilmArgs) -> Option<Crop> {
    let pixels = film.crop.or(film.pixelbounds).map(|bounds| {
        let rect = bounds.0;
        Crop::Pixels([rect.min[0], rect.max[0], rect.min[1], rect.max[1]])
    });
    pixels.or_else(|| {
        film.cropwindow
            .map(|fractions| Crop::Fractions(fractions.0))
    })
}

/// The warning of a crop that reaches beyond the film. None: it does not.
fn crop_warning(args: &FilmArgs, view: &View) -> Option<String> {
    let asked = args.crop.or(args.pixelbounds)?.0;
    let film = view.film();
    let [width, height] = film.resolution;
    let message = format!("the crop reaches beyond the film, which has {width} x {height} pixels");
    (film.crop != asked).then_some(message)
}

/// The warning of a scene without light. None: there is a light, though it may be a dark one.
fn light_warning(scene: &Scene) -> Option<String> {
    let is_dark = scene.lights().is_empty();
    is_dark.then(|| "the scene has no light: the image will be black".to_owned())
}

/// The exit of an error with a scene. A crop that does not fit is a fault of the command line; a scene
/// file that cannot be opened is no fault of the scene, but a missing file that it names is.
pub(crate) fn exit_of_scene(error: &formats::Error) -> Exit {
    match error.kind() {
        ErrorKind::Options => Exit::Usage,
        ErrorKind::MissingFile | ErrorKind::Io if !error.has_place() => Exit::InputOutput,
        _ => Exit::Scene,
    }
}

/// The failure of a scene that cannot be read. That of a missing file has no lines to show, and its hint is one of
/// its own.
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

/// A setting, by name, of the render that wrote an image. None: the image does not say.
pub(crate) fn setting_of(path: &Path, name: &str) -> Option<String> {
    let layers = formats::image::read_layers(path).ok()?;
    layers.text(&format!("bidir/{name}"))
}

/// The estimated variance of an image. None: it has no such layers.
pub(crate) fn read_variance(path: &Path) -> Option<Variance> {
    let layers = formats::image::read_layers(path).ok()?;
    let pixels = Pixels {
        size: layers.size(),
        data: layers.triples(["Variance.R", "Variance.G", "Variance.B"])?,
    };
    let samples = layers.channel("Samples")?.into_iter();
    let fewest = samples.fold(f32::INFINITY, f32::min);
    Some(Variance {
        pixels,
        freedom: f64::from(fewest) - 1.0,
    })
}

/// The estimated variance of an image.
#[derive(Clone, Debug)]
pub(crate) struct Variance {
    /// The variance of every pixel's mean.
    pub(crate) pixels: Pixels,
    /// The degrees of freedom of the variances.
    pub(crate) freedom: f64,
}

/// Writes errors as they are to an EXR with the channel Y, or as colours up to `full` to a PNG.
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

/// Writes a developed film to an image of the kind that its name says; layers to EXR alone.
pub(crate) fn write_picture(
    path: &Path,
    film: &FilmSettings,
    developed: &Developed,
    metadata: &[(String, MetadataValue)],
) -> Result<(), Failure> {
    match image_format(path, IMAGES)? {
        ImageFormat::Exr => Ok(developed.write_exr(path, film, metadata)?),
        ImageFormat::Png => Ok(developed.write_png(path)?),
    }
}

/// A format that images are written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ImageFormat {
    /// Linear light.
    Exr,
    /// The colours of a screen.
    Png,
}

/// All that are written.
pub(crate) const IMAGES: &[ImageFormat] = &[ImageFormat::Exr, ImageFormat::Png];

/// The format that the name of an image stands for.
///
/// Errors: it is none of those in `written`.
pub(crate) fn image_format(path: &Path, written: &[ImageFormat]) -> Result<ImageFormat, Failure> {
    let named = match Format::of(path) {
        Some(Format::Exr) => Some(ImageFormat::Exr),
        Some(Format::Png) => Some(ImageFormat::Png),
        _ => None,
    };
    named
        .filter(|named| written.contains(named))
        .ok_or_else(|| {
            if path.is_dir() {
                return is_folder(path, written);
            }
            let endings = written.iter().map(|format| match format {
                ImageFormat::Exr => ".exr",
                ImageFormat::Png => ".png",
            });
            let endings = endings.collect::<Vec<_>>().join(" or ");
            let path = path.display();
            Failure::usage(format!(
                "cannot write `{path}`: output images are {endings}"
            ))
        })
}

/// The error of an output whose name is that of a folder.
fn is_folder(path: &Path, written: &[ImageFormat]) -> Failure {
    let message = format!("cannot write `{}`: it is a folder", path.display());
    let file = if written.contains(&ImageFormat::Exr) {
        "NAME.exr"
    } else {
        "NAME.png"
    };
    let hint = format!("name a file, such as {}", path.join(file).display());
    Failure::new(Exit::InputOutput, message).with_hint(hint)
}

/// Reads a film file.
pub(crate) fn read_film(path: &Path) -> Result<FilmFile, Failure> {
    Ok(formats::film::read(path)?)
}

/// Fails where an output, each with the flag that names it, would replace an input or another output.
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

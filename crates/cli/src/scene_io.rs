//! Everything that is read and written by the `formats` library passes here.

use crate::args::{FilmArgs, SceneArgs};
use crate::console::Console;
use crate::exit::{Exit, Failure};
use bidir::driver::Settings;
use bidir::film::{self, Film, FilmSettings, Picture};
use bidir::scene::Scene;
use formats::ErrorKind;
use formats::image::{ExrImage, ExrLayer, Format};
use formats::outputs::Output;
use formats::scene::{Crop, Lamp, LoadOptions, Summary};
use lab::image::Pixels;
use lab::metric::ErrorMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

pub(crate) use formats::file::{folder_of, remove_leftovers, target_of};
pub(crate) use formats::film::{Developed, FilmFile, FilmHeader, Stopping, is_film};
pub(crate) use formats::image::{Layers, MetadataValue};
pub(crate) use formats::outputs::is_same;

/// A scene that was read, with what else its file says.
pub(crate) struct LoadedScene {
    /// The scene.
    pub(crate) scene: Arc<Scene>,
    /// The file's settings, over the defaults.
    pub(crate) settings: Settings,
    /// The file's number of samples per pixel.
    pub(crate) spp: u64,
    /// The name that the file gives its image.
    pub(crate) output: Option<PathBuf>,
    /// What is odd but no error, each with its place.
    pub(crate) warnings: Vec<String>,
    /// Those of them that tell what stands in for what is not supported.
    pub(crate) refused: Vec<String>,
    /// The first lamps that no ray can hit.
    pub(crate) lamps: Vec<Lamp>,
    /// What the scene is made of.
    pub(crate) summary: Summary,
    /// A hash of all that was read.
    pub(crate) digest: String,
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
    let loaded =
        formats::scene::load(&args.scene, &options).map_err(|error| refused(&args.scene, error))?;
    let mut settings = Settings {
        integrator: loaded.settings.integrator,
        sampler: loaded.settings.sampler,
        seed: loaded.settings.seed.unwrap_or_default(),
        ..Settings::default()
    };
    settings.path.max_depth = Some(loaded.settings.max_depth);
    settings.layers = film::Layers::new(&loaded.settings.aovs, &[], 0);
    let mut warnings = loaded.warnings;
    warnings.extend(film.and_then(|film| crop_warning(film, &loaded.scene)));
    warnings.extend(light_warning(&loaded.scene));
    Ok(LoadedScene {
        scene: Arc::new(loaded.scene),
        settings,
        spp: loaded.settings.samples_per_pixel.into(),
        output: loaded.settings.output.map(PathBuf::from),
        warnings,
        refused: loaded.refused,
        lamps: loaded.lamps,
        summary: loaded.summary,
        digest: loaded.digest.to_string(),
        inputs: loaded.inputs,
    })
}

impl LoadedScene {
    /// Tells the warnings, of which there are `others` more; with `--strict` they are errors.
    pub(crate) fn tell_warnings(
        &self,
        args: &SceneArgs,
        others: usize,
        console: Console,
    ) -> Result<(), Failure> {
        for warning in &self.warnings {
            console.warning(warning);
        }
        let count = self.warnings.len() + others;
        if args.strict && count > 0 {
            let plural = if count == 1 { "" } else { "s" };
            let message = format!("{count} warning{plural}, which --strict makes an error");
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

/// Tells that a crop reaches beyond the film. None: it does not.
fn crop_warning(args: &FilmArgs, scene: &Scene) -> Option<String> {
    let asked = args.crop.or(args.pixelbounds)?.0;
    let film = scene.film();
    let [width, height] = film.resolution;
    let message = format!("the crop reaches beyond the film, which has {width} x {height} pixels");
    (film.crop != asked).then_some(message)
}

/// Tells that there is nothing to be seen. None: there is a light, though it may be a dark one.
fn light_warning(scene: &Scene) -> Option<String> {
    let is_dark = scene.lights().is_empty();
    is_dark.then(|| "the scene has no light: the image will be black".to_owned())
}

/// A crop that does not fit is a fault of the command line; a scene file that cannot be opened is no
/// fault of the scene, but what it names and is not there is.
pub(crate) fn exit_of_scene(error: &formats::Error) -> Exit {
    match error.kind() {
        ErrorKind::Options => Exit::Usage,
        ErrorKind::MissingFile | ErrorKind::Io if !error.has_place() => Exit::InputOutput,
        _ => Exit::Scene,
    }
}

/// Why a scene cannot be read; for one that is not there, a file with a name near its own.
fn refused(scene: &Path, error: formats::Error) -> Failure {
    let exit = exit_of_scene(&error);
    let is_missing = error.kind() == ErrorKind::MissingFile && !error.has_place();
    match nearest_file(scene).filter(|_| is_missing) {
        Some(near) => Failure::new(exit, error.to_string())
            .with_hint(format!("did you mean `{}`?", near.display())),
        None => Failure::diagnostic(exit, error),
    }
}

/// The file of the same folder and ending whose name is nearest. None: no name is near.
pub(crate) fn nearest_file(path: &Path) -> Option<PathBuf> {
    let name = path.file_name()?.to_str()?;
    let entries = std::fs::read_dir(folder_of(path)).ok()?;
    let names = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    let mut names: Vec<_> = names
        .filter(|name| Path::new(name).extension() == path.extension())
        .collect();
    names.sort();
    let near = bidir::names::nearest(name, names.iter().map(String::as_str))?;
    Some(path.with_file_name(near))
}

/// Reads an image.
pub(crate) fn read_image(path: &Path) -> Result<Pixels, Failure> {
    let image = formats::image::read(path, None)
        .map_err(|error| Failure::diagnostic(Exit::InputOutput, error))?;
    Ok(Pixels::from(&image))
}

/// A setting, by name, of the render that wrote an image. None: the image does not say.
pub(crate) fn setting_of(path: &Path, name: &str) -> Option<String> {
    let layers = formats::image::read_layers(path).ok()?;
    layers.text(&format!("bidir/{name}"))
}

/// The layers of an image that tell how sure it is. None: it has no such.
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

/// How sure an image is.
#[derive(Clone, Debug)]
pub(crate) struct Variance {
    /// The variance of every pixel's mean.
    pub(crate) pixels: Pixels,
    /// The degrees of freedom of the variances.
    pub(crate) freedom: f64,
}

/// Writes a picture with its layers as EXR with attributes.
pub(crate) fn write_exr(
    path: &Path,
    film: &FilmSettings,
    developed: &Developed,
    metadata: &[(String, MetadataValue)],
) -> Result<(), Failure> {
    developed
        .write_exr(path, film, metadata)
        .map_err(|error| Failure::diagnostic(Exit::InputOutput, error))
}

/// Writes a picture as PNG.
pub(crate) fn write_png(path: &Path, picture: &Picture) -> Result<(), Failure> {
    let size = [picture.width as u32, picture.height as u32];
    formats::image::write_png(path, size, &picture.pixels)
        .map_err(|error| Failure::diagnostic(Exit::InputOutput, error))
}

/// Writes what the screen shows as PNG. Range: `[0, 1]`, linear.
pub(crate) fn write_screen(path: &Path, pixels: &Pixels) -> Result<(), Failure> {
    let size = pixels.size.map(|side| side as u32);
    formats::image::write_png(path, size, &pixels.data)
        .map_err(|error| Failure::diagnostic(Exit::InputOutput, error))
}

/// Writes errors as they are to an EXR with the channel Y, or as colours up to `full` to a PNG.
pub(crate) fn write_error_map(
    path: &Path,
    errors: &ErrorMap,
    full: f64,
    metadata: &[(String, MetadataValue)],
) -> Result<(), Failure> {
    if Format::of(path) != Some(Format::Exr) {
        return write_screen(path, &errors.false_color(full));
    }
    let [width, height] = errors.size;
    let data: Vec<f32> = errors.data.iter().map(|&error| error as f32).collect();
    let layer = ExrLayer {
        name: "",
        channels: &["Y"],
        data: &data,
    };
    let image = ExrImage {
        resolution: errors.size,
        crop: [0, 0, width, height],
        layers: &[layer],
        metadata,
    };
    formats::image::write_exr(path, &image)
        .map_err(|error| Failure::diagnostic(Exit::InputOutput, error))
}

/// Writes a developed film to an image of the kind that its name says; layers to EXR alone.
pub(crate) fn write_picture(
    path: &Path,
    film: &FilmSettings,
    developed: &Developed,
    metadata: &[(String, MetadataValue)],
) -> Result<(), Failure> {
    match image_format(path, IMAGES)? {
        ImageFormat::Exr => write_exr(path, film, developed, metadata),
        ImageFormat::Png => write_png(path, &developed.picture),
    }
}

/// Reads all channels of an EXR.
pub(crate) fn read_layers(path: &Path) -> Result<Layers, Failure> {
    formats::image::read_layers(path).map_err(|error| Failure::diagnostic(Exit::InputOutput, error))
}

/// Writes all channels of an EXR, with these and this text among them.
pub(crate) fn write_layers(
    path: &Path,
    layers: &mut Layers,
    triples: &[([&str; 3], &[[f32; 3]])],
    (attribute, value): (&str, &str),
) -> Result<(), Failure> {
    let mut write = || {
        for (names, data) in triples {
            layers.set_triples(*names, data)?;
        }
        layers.set_text(attribute, value);
        formats::image::write_layers(path, layers)
    };
    write().map_err(|error| Failure::diagnostic(Exit::InputOutput, error))
}

/// A format that images are written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ImageFormat {
    /// Linear light.
    Exr,
    /// What the screen shows.
    Png,
}

/// All that are written.
pub(crate) const IMAGES: &[ImageFormat] = &[ImageFormat::Exr, ImageFormat::Png];

/// The format that the name of an image says.
///
/// Errors: it says none of those in `written`.
pub(crate) fn image_format(path: &Path, written: &[ImageFormat]) -> Result<ImageFormat, Failure> {
    let said = match Format::of(path) {
        Some(Format::Exr) => Some(ImageFormat::Exr),
        Some(Format::Png) => Some(ImageFormat::Png),
        _ => None,
    };
    said.filter(|said| written.contains(said)).ok_or_else(|| {
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
    formats::film::read(path).map_err(film_failure)
}

/// Writes a film file, and calls the one before `previous`.
pub(crate) fn write_film_keeping(
    path: &Path,
    previous: &Path,
    header: &FilmHeader,
    film: &Film,
) -> Result<(), Failure> {
    formats::film::write_keeping(path, previous, header, film).map_err(film_failure)
}

/// Writes a film file.
pub(crate) fn write_film(path: &Path, header: &FilmHeader, film: &Film) -> Result<(), Failure> {
    formats::film::write(path, header, film).map_err(film_failure)
}

/// How the command ends where a film file cannot be read or written.
#[expect(clippy::needless_pass_by_value, reason = "`map_err` gives the value")]
fn film_failure(error: formats::Error) -> Failure {
    let exit = match error.kind() {
        ErrorKind::Memory => Exit::Scene,
        _ => Exit::InputOutput,
    };
    Failure::new(exit, error.to_string())
}

/// Replaces a file by a text.
pub(crate) fn write_text(path: &Path, text: &str) -> Result<(), Failure> {
    formats::file::replace(path, text.as_bytes())
        .map_err(|error| Failure::diagnostic(Exit::InputOutput, error))
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

/// Fails where a file could not be written.
pub(crate) fn check_writable(path: &Path) -> Result<(), Failure> {
    formats::file::check_replaceable(path)
        .map_err(|error| Failure::new(Exit::InputOutput, error.to_string()))
}

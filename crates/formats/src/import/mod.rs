//! The part of reading a scene that all formats share.
//!
//! A reader has its own [`Document`]: the contents of the file, with a type for places in it. It
//! hands a function to [`load`] that puts all of the document into an [`Assembly`], by means of a
//! [`Context`]: the options, the [`Layout`] and the [`Log`] of warnings and files.
//!
//! All formats share these parts: [`Images`] decodes an image once for each use, `placing` transforms vertices in
//! `f64`, and the instances of a [`Group`] share its shapes, except those that emit.
//!
//! A feature that the format has and the renderer lacks is refused where it stands. With
//! [`LoadOptions::lenient`] a substitute takes its place, and a warning names it.

mod assembly;
mod digest;
mod enclosure;
mod images;
mod lamp;
mod log;
mod options;
mod placing;
mod precision;
mod reading;
mod space;
mod volumes;

pub(crate) use assembly::{Assembly, Destination, Group, Size, Skin};
pub(crate) use digest::Content;
pub use digest::SceneDigest;
pub(crate) use images::{Images, image, replace_invalid};
pub use lamp::Lamp;
pub use log::Warning;
pub(crate) use log::{Log, warn};
pub use options::{Crop, LoadOptions};
pub(crate) use placing::{check_point, mirrored, opposite, place_vertices, unit, vector};
pub(crate) use precision::VertexError;
pub(crate) use space::{Layout, Survey, box_corners};
pub(crate) use volumes::Content as VolumeContent;

use crate::error::{Error, ErrorKind, FilePlace, Result};
use crate::files::Files;
use crate::film::Subject;
use crate::limits;
use crate::source::Fault;
use bidir::camera::Camera;
use bidir::driver::Settings;
use bidir::film::{Aov, FilmError, FilmSettings, Layers};
use bidir::integrator::IntegratorKind;
use bidir::sampler::SamplerKind;
use bidir::scene::Scene;
use bidir::view::View;
use serde::Serialize;
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;

/// The contents of a scene file.
pub(crate) trait Document {
    /// A place in the file.
    type Place: Clone;

    /// The place of an error that concerns the whole scene.
    const TOP: Self::Place;

    /// Returns the source of the scene's files.
    fn files(&self) -> &Files;

    /// Returns every file that the document may name, whether it is read or not.
    fn named_files(&self) -> Vec<PathBuf>;

    /// Returns the text of a place, which begins with the name of the file.
    fn text(&self, place: &Self::Place) -> String;

    /// Returns the error of a fault.
    fn error(&self, fault: Fault<Self::Place>) -> Error;
}

/// A scene that was read, with its warnings and files.
#[derive(Debug)]
pub struct Loaded {
    /// The name of the scene file as it was given.
    pub name: String,
    /// The scene.
    pub scene: Arc<Scene>,
    /// The camera of the file, and its film.
    pub view: View,
    /// The settings of a render that the file gives.
    pub settings: SceneSettings,
    /// The warnings, each as `place: message`. Places are `file:line:column` in pbrt,
    /// and `file: meshes[0]` in glTF.
    pub warnings: Vec<String>,
    /// The warnings that name the substitute of an unsupported feature.
    pub refused: Vec<String>,
    /// The parts of the scene.
    pub summary: Summary,
    /// The first lamps that no ray can hit.
    pub lamps: Vec<Lamp>,
    /// The place in the file that gives the film's size. None: the caller's options give the size.
    pub film_place: Option<FilePlace>,
    /// The identity of the scene.
    pub digest: SceneDigest,
    /// Every file that was read, under each name by which it was read; the scene file is the first.
    pub files: Vec<PathBuf>,
    /// Every file on the disk that the scene reads or names: no output may replace it
    /// ([`outputs`](crate::outputs)).
    pub inputs: Vec<PathBuf>,
}

impl Loaded {
    /// Returns the scene and its view, to render them.
    pub fn subject(&self) -> Subject {
        Subject {
            name: self.name.clone(),
            digest: self.digest.to_string(),
            scene: Arc::clone(&self.scene),
            view: self.view.clone(),
        }
    }

    /// Returns the error of a film that is too large, at the place in the file that gives its size. If the caller's
    /// options give the size, the error has no place.
    pub fn too_large(&self, error: &FilmError) -> Error {
        let [width, height] = self.view.film().resolution;
        let message = format!("a film of {width} x {height} pixels is too large: {error}");
        match &self.film_place {
            Some(place) => place.error(ErrorKind::Memory, message),
            None => Error::new(ErrorKind::Memory, message),
        }
    }
}

/// The settings of a render in a scene file.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneSettings {
    /// The estimator.
    pub integrator: IntegratorKind,
    /// The largest number of scattering events: 0 shows lights only, 1 adds direct light.
    pub max_depth: u32,
    /// The random numbers.
    pub sampler: SamplerKind,
    /// Samples per pixel.
    pub samples_per_pixel: u32,
    /// The seed. None: the file gives none.
    pub seed: Option<u64>,
    /// The name of the image, as the file has it. None: the file gives none.
    pub output: Option<String>,
    /// The layers that the film has besides the picture.
    pub aovs: Vec<Aov>,
}

impl SceneSettings {
    /// Returns the settings of a render: those of the scene, and else the defaults of its integrator.
    pub fn render_settings(&self) -> Settings {
        let mut settings = Settings {
            sampler: self.sampler,
            seed: self.seed.unwrap_or_default(),
            layers: Layers::new(&self.aovs, &[], 0),
            ..Settings::new(self.integrator)
        };
        settings.path.max_depth = Some(self.max_depth);
        settings
    }
}

/// The parts of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Summary {
    /// The shapes in memory: those of an object count once, however often it is placed.
    pub shapes: usize,
    /// The triangles, spheres and disks in memory, counted like the shapes.
    pub primitives: u64,
    /// Instances of objects.
    pub instances: usize,
    /// Materials.
    pub materials: usize,
    /// Textures.
    pub textures: usize,
    /// Shapes that emit.
    pub area_lights: usize,
    /// Lights that are not shapes.
    pub other_lights: usize,
}

/// The state of a reader while it fills an [`Assembly`].
pub(crate) struct Context<'a, D: Document> {
    pub(crate) document: &'a D,
    pub(crate) options: &'a LoadOptions,
    /// The space that everything is placed in.
    pub(crate) layout: Layout,
    pub(crate) log: Log<D::Place>,
}

impl<D: Document> Context<'_, D> {
    /// Adds a warning, or counts it if there is one with the same message.
    pub(crate) fn warn(&mut self, place: D::Place, message: impl Into<String>) {
        self.log.warn(place, message);
    }

    /// Refuses a feature that the renderer lacks, or accepts `substitute` with a warning.
    pub(crate) fn unsupported(
        &mut self,
        place: D::Place,
        feature: &str,
        substitute: &str,
    ) -> Result<(), Fault<D::Place>> {
        if self.log.lenient {
            let message = format!("{feature} is not supported: {substitute}");
            self.log.substitutes.insert(message.clone());
            self.warn(place, message);
            return Ok(());
        }
        let message = format!("{feature} is not supported");
        let fault = Fault::new(ErrorKind::Unsupported, place, message);
        Err(fault.with_hint(format!("with --lenient, {substitute}")))
    }

    /// Builds something that the scene does not use, to check it. Errors in it are reported, but an unsupported
    /// feature is neither refused nor replaced: then returns None.
    pub(crate) fn unused<T>(
        &mut self,
        build: impl FnOnce(&mut Self) -> Result<T, Fault<D::Place>>,
    ) -> Result<Option<T>, Fault<D::Place>> {
        let lenient = std::mem::replace(&mut self.log.lenient, false);
        let built = build(self);
        self.log.lenient = lenient;
        match built {
            Err(fault) if fault.kind == ErrorKind::Unsupported => Ok(None),
            built => built.map(Some),
        }
    }

    /// Returns the view of the scene by this camera.
    pub(crate) fn view(camera: Camera, film: FilmSettings) -> Result<View, Fault<D::Place>> {
        View::new(camera, film).map_err(|error| Fault::scene(D::TOP, error.to_string()))
    }

    /// Refuses more primitives, or vertices of meshes, than the caller allows, or than the size of the
    /// files allows.
    pub(crate) fn check_size(&self, count: u64, place: &D::Place) -> Result<(), Fault<D::Place>> {
        let most = self.options.most_primitives(self.log.reading.stored);
        check(count, most, "primitives or vertices", place)
    }

    /// Refuses more shapes than the size of the files allows: a shape that emits is copied for each instance.
    fn check_shapes(&self, count: u64, place: &D::Place) -> Result<(), Fault<D::Place>> {
        let most = limits::SHAPES.of(self.log.reading.stored);
        check(count, most, "shapes, counted at each place", place)
    }
}

/// Refuses a scene that has more than `most` of something.
fn check<P: Clone>(count: u64, most: u64, things: &str, place: &P) -> Result<(), Fault<P>> {
    if count <= most {
        return Ok(());
    }
    let message = format!("the scene has more than {most} {things}");
    let fault = Fault::new(ErrorKind::Limit, place.clone(), message);
    Err(fault.with_hint("instances share the memory of their object, unless it emits"))
}

/// The scene of a file under construction, and the view of it.
pub(crate) type Gathered<P> = Result<(Assembly<P>, View), Fault<P>>;

/// Builds the scene whose parts `gather` collects.
pub(crate) fn load<'a, D: Document>(
    document: &'a D,
    options: &'a LoadOptions,
    log: Log<D::Place>,
    gather: impl Fn(&mut Context<'a, D>) -> Gathered<D::Place>,
) -> Result<Loaded> {
    let mut context = Context {
        document,
        options,
        layout: Layout::default(),
        log,
    };
    let built = build(&mut context, gather);
    let (assembly, scene, view) = built.map_err(|fault| document.error(fault))?;
    let text = |place: &D::Place| document.text(place);
    let log = context.log;
    let names: BTreeSet<_> = document
        .named_files()
        .into_iter()
        .chain(log.files.clone())
        .collect();
    let is_from_disk = |name: &PathBuf| document.files().is_from_disk(name);
    let film_place = assembly.film_place.map(|place| {
        let fault = Fault::new(ErrorKind::Limit, place, String::new());
        document.error(fault).into_place()
    });
    let name = log.files.first().map(|name| name.display().to_string());
    Ok(Loaded {
        name: name.unwrap_or_default(),
        film_place,
        lamps: lamp::unhittable(&scene, &assembly.lamps, text),
        scene: scene.into(),
        view,
        settings: assembly.settings,
        warnings: log.texts(text, |_| true),
        refused: log.texts(text, |message| log.substitutes.contains(message)),
        summary: assembly.summary,
        digest: log.digest.finish(),
        inputs: names.into_iter().filter(is_from_disk).collect(),
        files: log.files,
    })
}

/// A finished assembly, its scene, and the view of it.
type Built<P> = (Assembly<P>, Scene, View);

/// Gathers everything in world space and builds the scene. If the scene needs another layout, gathers it again in that.
fn build<'a, D: Document>(
    context: &mut Context<'a, D>,
    gather: impl Fn(&mut Context<'a, D>) -> Gathered<D::Place>,
) -> Result<Built<D::Place>, Fault<D::Place>> {
    let log = context.log.clone();
    let (mut assembly, mut view) = gather(context)?;
    assembly.check_vertices()?;
    let layout = Layout::of(&assembly.survey, &assembly.objects);
    if layout != context.layout {
        drop(assembly);
        context.layout = layout;
        context.log = log;
        (assembly, view) = gather(context)?;
    }
    let scene = assembly.finish(context)?;
    Ok((assembly, scene, view))
}

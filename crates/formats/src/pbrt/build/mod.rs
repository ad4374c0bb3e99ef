//! From a [`SceneDescription`] to a scene that can be rendered.
//!
//! What the format has and the renderer has not is refused where it stands. With
//! [`LoadOptions::lenient`] something simpler stands in for it, and a warning says what.
//!
//! Colours are linear Rec. 709 throughout: a spectrum becomes one here. Objects are shared by their instances (`object`). Quadrics keep their outside in front under mirroring
//! transformations, where the reference program contradicts itself.

mod camera;
mod color;
mod context;
mod count;
mod emission;
mod film;
mod filter;
mod group;
mod imagemap;
mod light;
mod mapping;
mod material;
mod mesh;
mod object;
mod patches;
mod reader;
mod sensor;
mod settings;
mod shape;
mod spectral;
mod subdivision;
mod texture;
mod texture_class;

pub use film::Crop;
pub use settings::SceneSettings;

use super::digest::SceneDigest;
use super::scene::{Entity, SceneDescription, ShapeDescription, Warning};
use crate::error::{ErrorKind, Result};
use crate::files::Files;
use crate::lamp::{self, Lamp, Placed};
use crate::limits;
use crate::precision::{self, VertexErrors};
use crate::source::{Fault, SourceMap, Span};
use crate::space::{Layout, Survey};
use bidir::scene::{MaterialId, ObjectId, Scene, SceneBuilder, SceneError};
use bidir::shape::Shape;
use bidir::texture::FloatTexture;
use context::Context;
use emission::AreaEmission;
use glam::{DAffine3, DVec3};
use material::Materials;
use shape::Geometry;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use texture::Textures;

/// What a caller may want otherwise than the file.
#[derive(Clone, Copy, Debug, Default)]
pub struct LoadOptions {
    /// True to let something simpler stand in for what is not supported yet.
    pub lenient: bool,
    /// Width and height of the film, instead of the file's. Unit: pixels.
    pub resolution: Option<[u32; 2]>,
    /// The part of the film that is rendered, instead of the file's. Errors: where there are no
    /// such pixels, the error's kind is [`ErrorKind::Options`].
    pub crop: Option<Crop>,
    /// The instruction set of the intersector. None: the fastest that the machine has.
    pub isa: Option<bidir::scene::Isa>,
    /// The most primitives of the scene, and the most vertices of its meshes, those of shared objects
    /// counted once. None: 2²², and 16 more for every byte of the scene's files; at most 2²⁸.
    pub most_primitives: Option<u64>,
}

impl LoadOptions {
    /// The most primitives, and the most vertices, of a scene whose files take `stored` bytes.
    pub(crate) fn most_primitives(&self, stored: u64) -> u64 {
        let allowed = limits::PRIMITIVES.of(stored).min(limits::MOST_PRIMITIVES);
        self.most_primitives.unwrap_or(allowed)
    }
}

/// A scene that was read, with what else its file says.
#[derive(Debug)]
pub struct Loaded {
    /// The scene.
    pub scene: Scene,
    /// How the file wants it rendered.
    pub settings: SceneSettings,
    /// What is odd but no error, each as `file:line:column: message`.
    pub warnings: Vec<String>,
    /// Those of the warnings that tell what stands in for what is not supported.
    pub refused: Vec<String>,
    /// What the scene is made of.
    pub summary: Summary,
    /// The first lamps that no ray can hit.
    pub lamps: Vec<Lamp>,
    /// Which scene it is.
    pub digest: SceneDigest,
    /// Every file that was read, by each name that it was asked for; the scene file is the first.
    pub files: Vec<PathBuf>,
    /// Every file on the disk that the scene reads or names: no output may replace it
    /// ([`outputs`](crate::outputs)).
    pub inputs: Vec<PathBuf>,
}

/// What a scene is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Summary {
    /// Shapes as they are kept: those of shared objects count once.
    pub shapes: usize,
    /// Triangles, spheres and disks as they are kept: those of shared objects count once.
    pub primitives: u64,
    /// Places of objects.
    pub instances: usize,
    /// Materials.
    pub materials: usize,
    /// Textures.
    pub textures: usize,
    /// Shapes that emit.
    pub area_lights: usize,
    /// Lights that are no shapes.
    pub other_lights: usize,
}

/// Reads a scene file with all that it refers to; `-` is standard input.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Loaded> {
    load_from(path, options, &Files::default())
}

/// The same as [`load`], with files from where `files` says.
pub fn load_from(path: &Path, options: &LoadOptions, files: &Files) -> Result<Loaded> {
    build(&super::parse_file_from(path, files)?, options)
}

/// Builds a described scene: reads its meshes and images, and checks everything.
pub fn build(description: &SceneDescription, options: &LoadOptions) -> Result<Loaded> {
    let (mut context, assembly) =
        gather(description, options).map_err(|fault| description.sources.error(fault))?;
    let built = assembly.finish(&mut context);
    let Built {
        scene,
        settings,
        lamps,
        summary,
    } = built.map_err(|fault| description.sources.error(fault))?;
    let place = |span: Span| {
        let (line, column) = description.sources.line_and_column(span);
        let file = description.sources.name(span.file).display();
        format!("{file}:{line}:{column}")
    };
    let text = |warning: &Warning| {
        let times = match warning.count {
            1 => String::new(),
            count => format!(" ({count} times)"),
        };
        format!("{}: {}{times}", place(warning.span), warning.message)
    };
    let is_refusal = |warning: &&Warning| context.refused.contains(&warning.message);
    let refused = context.warnings.iter().filter(is_refusal);
    Ok(Loaded {
        lamps: lamp::unhittable(&scene, &lamps, |span| place(*span)),
        scene,
        settings,
        warnings: context.warnings.iter().map(text).collect(),
        refused: refused.map(text).collect(),
        summary,
        digest: context.digest.finish(),
        inputs: description.inputs(&context.files),
        files: context.files,
    })
}

/// A scene that was built, with where its lamps are in the text.
struct Built {
    scene: Scene,
    settings: SceneSettings,
    lamps: Vec<Placed<Span>>,
    summary: Summary,
}

/// Places everything: in the world, or where its layout puts it.
fn gather<'a>(
    description: &'a SceneDescription,
    options: &'a LoadOptions,
) -> Result<(Context<'a>, Assembly<'a>), Fault> {
    let mut context = Context::new(description, options, Layout::default());
    let mut assembly = Assembly::gather(&mut context)?;
    assembly.check_vertices()?;
    let layout = Layout::of(&assembly.survey, &assembly.objects);
    if layout != Layout::default() {
        drop(assembly);
        context = Context::new(description, options, layout);
        assembly = Assembly::gather(&mut context)?;
    }
    if let Some((span, message)) = assembly.vertex_errors.warning() {
        context.warn(span, message);
    }
    Ok((context, assembly))
}

/// A scene in the making.
struct Assembly<'a> {
    builder: SceneBuilder,
    settings: SceneSettings,
    world_from_render: DAffine3,
    /// Of everything but shared objects, and of each of these.
    survey: Survey,
    objects: Vec<Survey>,
    vertex_errors: VertexErrors<Span>,
    textures: Textures<'a>,
    /// By index; None where there is no surface.
    materials: Vec<Option<MaterialId>>,
    /// The places of the shapes in the text, in the order of addition.
    shape_spans: Vec<Span>,
    /// The same of instances.
    instance_spans: Vec<Span>,
    /// The same of lamps, with the numbers of their lights.
    lamps: Vec<Placed<Span>>,
    /// Of all meshes as they are kept.
    vertices: u64,
    /// The emission of the last shape.
    last_emission: Option<(Arc<Entity>, Arc<AreaEmission>)>,
    summary: Summary,
}

/// Where a shape goes.
#[derive(Clone, Copy)]
enum Destination<'a> {
    /// Into the space that is rendered in, once for each of these places of its space.
    World(&'a [DAffine3]),
    /// Into an object that is shared, with this origin.
    Object(ObjectId, DVec3),
}

impl<'a> Assembly<'a> {
    /// Reads everything and puts it in its place.
    fn gather(context: &mut Context<'a>) -> Result<Self, Fault> {
        let description = context.description;
        let lens = camera::read(context)?;
        let film = film::build(context, &lens)?;
        let settings = settings::build(context, &film)?;
        let camera = lens.camera(film.settings.resolution, film.own_resolution)?;
        let mut builder = SceneBuilder::new(film.settings);
        builder.space(context.layout.space).camera(camera);
        builder.texture_filtering(settings::texture_filtering(description)?);
        if let Some(isa) = context.options.isa {
            builder.isa(isa);
        }
        let mut assembly = Self {
            builder,
            settings,
            world_from_render: context.layout.render_from_world().inverse(),
            survey: Survey::new(Some(lens.eye)),
            objects: Vec::new(),
            vertex_errors: VertexErrors::default(),
            textures: Textures::new(description),
            materials: Vec::new(),
            shape_spans: Vec::new(),
            instance_spans: Vec::new(),
            lamps: Vec::new(),
            vertices: 0,
            last_emission: None,
            summary: Summary::default(),
        };
        assembly.add_materials(context)?;
        let from_world = [context.layout.render_from_world()];
        for shape in &description.shapes {
            assembly.add_shape(context, shape, Destination::World(&from_world))?;
        }
        assembly.add_objects(context)?;
        assembly.textures.check_unused(context)?;
        assembly.add_lights(context)?;
        Ok(assembly)
    }

    /// Builds the scene.
    fn finish(self, context: &mut Context<'a>) -> Result<Built, Fault> {
        let scene = self.builder.build();
        let scene =
            scene.map_err(|error| scene_fault(&error, &self.shape_spans, &self.instance_spans))?;
        for (span, lights) in &self.lamps {
            if let Some(message) = lamp::dark_warning(&scene, lights.clone()) {
                context.warn(*span, message);
            }
        }
        Ok(Built {
            scene,
            settings: self.settings,
            lamps: self.lamps,
            summary: self.summary,
        })
    }

    /// Refuses a scene of which the vertices leave nothing.
    fn check_vertices(&self) -> Result<(), Fault> {
        match self.vertex_errors.refusal(self.survey.reach()) {
            None => Ok(()),
            Some((span, message)) => {
                Err(Fault::new(ErrorKind::Limit, span, message).with_hint(precision::HINT))
            }
        }
    }

    fn add_materials(&mut self, context: &mut Context<'_>) -> Result<(), Fault> {
        let description = context.description;
        let mut materials = Materials::new(&description.materials);
        self.summary.textures = description.textures.len();
        let used = used_materials(description);
        let textures = &mut self.textures;
        for index in 0..description.materials.len() {
            let mut build = |context: &mut _| materials.build(context, textures, index);
            let built = if used.contains(&index) {
                build(context)?
            } else {
                context.unused(build)?.flatten()
            };
            self.summary.materials += usize::from(built.is_some());
            let id = built.map(|material| self.builder.material(material));
            self.materials.push(id);
        }
        Ok(())
    }

    /// Adds a shape where it goes.
    fn add_shape(
        &mut self,
        context: &mut Context<'_>,
        shape: &ShapeDescription,
        destination: Destination<'_>,
    ) -> Result<(), Fault> {
        let span = shape.entity.span;
        refuse_motion_and_media(context, shape)?;
        let Some((geometry, alpha)) = Geometry::read(context, &mut self.textures, shape)? else {
            return Ok(());
        };
        let Some(&Some(material)) = self.materials.get(shape.material) else {
            return Ok(());
        };
        let emission = match &shape.area_light {
            Some(entity) => Some(self.emission(context, entity)?),
            None => None,
        };
        let copies = match destination {
            Destination::World(places) => places.len() as u64,
            Destination::Object(..) => 1,
        };
        let emission = emission.as_deref();
        self.count(context, (&geometry, emission), copies, span)?;
        let error = geometry.vertex_error(&shape.transforms.start.matrix3);
        self.vertex_errors.add(&span, error);
        match destination {
            Destination::World(places) => {
                for place in places {
                    let placed = place_shape(&geometry, shape, place, &mut self.survey)?;
                    let first = self.shape_spans.len();
                    self.add_placed(placed, material, emission, span)?;
                    self.cover(first, alpha.as_ref());
                }
            }
            Destination::Object(object, origin) => {
                let Some(survey) = self.objects.last_mut() else {
                    return Ok(());
                };
                let place = DAffine3::from_translation(-origin);
                let shape = place_shape(&geometry, shape, &place, survey)?;
                self.add_to_object(object, shape, material, alpha.as_ref(), span);
            }
        }
        Ok(())
    }

    fn add_to_object(
        &mut self,
        object: ObjectId,
        shape: Shape,
        material: MaterialId,
        alpha: Option<&FloatTexture>,
        span: Span,
    ) {
        self.summary.shapes += 1;
        let number = self.builder.object_shape(object, shape, material);
        self.shape_spans.push(span);
        self.cover(number, alpha);
    }

    /// Lets only a part of the shapes from number `first` on be there.
    fn cover(&mut self, first: usize, alpha: Option<&FloatTexture>) {
        let Some(alpha) = alpha else { return };
        for number in first..self.shape_spans.len() {
            self.builder.coverage(number, alpha.clone());
        }
    }

    /// Adds a shape in the world, in parts where they emit each for itself.
    fn add_placed(
        &mut self,
        shape: Shape,
        material: MaterialId,
        emission: Option<&AreaEmission>,
        span: Span,
    ) -> Result<(), Fault> {
        let parts = match emission {
            Some(emission) => emission.parts(shape),
            None => vec![shape],
        };
        let group = emission.and_then(|emission| emission.group.as_deref());
        self.builder.light_group(group);
        let first_light = self.builder.next_light();
        for part in parts {
            let emitted = emission.map(|emission| emission.of(&part)).transpose()?;
            self.summary.shapes += 1;
            self.summary.area_lights += usize::from(emitted.is_some());
            self.builder.shape(part, material, emitted);
            self.shape_spans.push(span);
        }
        if emission.is_some() {
            let lights = first_light..self.builder.next_light();
            self.lamps.push((span, lights));
        }
        Ok(())
    }

    fn add_lights(&mut self, context: &mut Context<'_>) -> Result<(), Fault> {
        for light in &context.description.lights {
            let span = light.entity.span;
            if let Some((light, group)) = light::build(context, light)? {
                self.summary.other_lights += 1;
                let number = self.builder.light_group(group.as_deref()).light(light);
                self.lamps.push((span, number..number + 1));
            }
        }
        Ok(())
    }
}

/// The materials of shapes, by index.
fn used_materials(description: &SceneDescription) -> BTreeSet<usize> {
    let of_objects = description.objects.iter().flat_map(|object| &object.shapes);
    description
        .shapes
        .iter()
        .chain(of_objects)
        .map(|shape| shape.material)
        .collect()
}

/// Refuses what a shape has and the renderer has not.
fn refuse_motion_and_media(
    context: &mut Context<'_>,
    shape: &ShapeDescription,
) -> Result<(), Fault> {
    if shape.transforms.is_animated() {
        let span = shape.entity.span;
        context.unsupported(span, "a moving shape", "its first position is used")?;
    }
    let medium = &shape.medium;
    if let Some(medium) = medium.inside.as_ref().or(medium.outside.as_ref()) {
        context.unsupported(
            medium.span,
            "a participating medium",
            "vacuum is used instead",
        )?;
    }
    Ok(())
}

/// The shape in the space of `place`.
fn place_shape(
    geometry: &Geometry,
    shape: &ShapeDescription,
    place: &DAffine3,
    survey: &mut Survey,
) -> Result<Shape, Fault> {
    let placed_from_local = *place * shape.transforms.start;
    let placed = geometry.place(&placed_from_local, shape::orientation(shape), survey);
    shape::check_extent(shape.entity.span, &placed)?;
    Ok(placed)
}

/// Says where in the text the builder's error is.
fn scene_fault(error: &SceneError, shape_spans: &[Span], instance_spans: &[Span]) -> Fault {
    let span = match error {
        SceneError::Instance { instance } => instance_spans.get(*instance),
        error => error.shape().and_then(|shape| shape_spans.get(shape)),
    };
    let kind = match error {
        SceneError::Intersector(_) => ErrorKind::Limit,
        _ => ErrorKind::Scene,
    };
    let span = span.copied().unwrap_or(SourceMap::BEGINNING);
    Fault::new(kind, span, error.to_string())
}

#[cfg(test)]
mod tests;

//! From a [`SceneDescription`] to a scene that can be rendered.
//!
//! What the format has and the renderer has not is refused where it stands. With
//! [`LoadOptions::lenient`] something simpler stands in for it, and a warning says what.
//!
//! Colours are linear Rec. 709 throughout: spectra are known by their names only, and by three
//! values each. Instances are copies. Quadrics keep their outside in front under mirroring
//! transformations, where the reference program contradicts itself.

mod camera;
mod color;
mod context;
mod emission;
mod film;
mod filter;
mod group;
mod imagemap;
mod light;
mod material;
mod reader;
mod settings;
mod shape;
mod texture;

pub use film::Crop;
pub use settings::SceneSettings;

use super::digest::SceneDigest;
use super::scene::{SceneDescription, ShapeDescription};
use crate::error::{ErrorKind, Result};
use crate::source::{Fault, SourceMap, Span};
use bidir::scene::{MaterialId, Scene, SceneBuilder, SceneError};
use bidir::shape::Shape;
use context::Context;
use emission::AreaEmission;
use glam::DAffine3;
use shape::Geometry;
use std::collections::BTreeSet;
use std::path::Path;
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
    /// What the scene is made of.
    pub summary: Summary,
    /// Which scene it is.
    pub digest: SceneDigest,
}

/// What a scene is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Summary {
    /// Shapes, those of instances counted every time.
    pub shapes: usize,
    /// Triangles, spheres and disks.
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

/// The most primitives of a scene with all its instances.
const MOST_PRIMITIVES: u64 = 1 << 28;

/// Reads a scene file with all that it refers to; `-` is standard input.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Loaded> {
    build(&super::parse_file(path)?, options)
}

/// Builds a described scene: reads its meshes and images, and checks everything.
pub fn build(description: &SceneDescription, options: &LoadOptions) -> Result<Loaded> {
    let mut context = Context::new(description, options);
    let built = Assembly::build(&mut context);
    let (scene, settings, summary) = built.map_err(|fault| description.sources.error(fault))?;
    let warnings = context.warnings.iter().map(|warning| {
        let (line, column) = description.sources.line_and_column(warning.span);
        let file = description.sources.name(warning.span.file).display();
        let times = match warning.count {
            1 => String::new(),
            count => format!(" ({count} times)"),
        };
        format!("{file}:{line}:{column}: {}{times}", warning.message)
    });
    Ok(Loaded {
        scene,
        settings,
        warnings: warnings.collect(),
        summary,
        digest: context.digest.finish(),
    })
}

/// A scene in the making.
struct Assembly {
    builder: SceneBuilder,
    /// By index; None where there is no surface.
    materials: Vec<Option<MaterialId>>,
    /// The places of the shapes in the text, in the order of addition.
    shape_spans: Vec<Span>,
    summary: Summary,
}

impl Assembly {
    fn build(context: &mut Context<'_>) -> Result<(Scene, SceneSettings, Summary), Fault> {
        let description = context.description;
        let lens = camera::read(context)?;
        let film = film::build(context, &lens)?;
        let settings = settings::build(context, film.output)?;
        let camera = lens.camera(film.settings.resolution, film.own_resolution)?;
        let mut builder = SceneBuilder::new(film.settings);
        builder.camera(camera);
        if let Some(isa) = context.options.isa {
            builder.isa(isa);
        }
        let mut assembly = Self {
            builder,
            materials: Vec::new(),
            shape_spans: Vec::new(),
            summary: Summary::default(),
        };
        assembly.add_materials(context)?;
        for shape in &description.shapes {
            assembly.add_shape(context, shape, &[DAffine3::IDENTITY])?;
        }
        assembly.add_objects(context)?;
        assembly.add_lights(context)?;
        let Self {
            builder,
            shape_spans,
            summary,
            ..
        } = assembly;
        let beginning = SourceMap::BEGINNING;
        let scene = builder
            .build()
            .map_err(|error| scene_fault(&error, &shape_spans, beginning))?;
        Ok((scene, settings, summary))
    }

    fn add_materials(&mut self, context: &mut Context<'_>) -> Result<(), Fault> {
        let description = context.description;
        let mut textures = Textures::new(description);
        self.summary.textures = description.textures.len();
        let used = used_materials(description);
        for (index, material) in description.materials.iter().enumerate() {
            let entity = material.entity.as_ref();
            let mut build = |context: &mut _| material::build(context, &mut textures, entity);
            let built = if used.contains(&index) {
                build(context)?
            } else {
                context.unused(build)?.flatten()
            };
            self.summary.materials += usize::from(built.is_some());
            let id = built.map(|material| self.builder.material(material));
            self.materials.push(id);
        }
        textures.check_unused(context)
    }

    /// Adds a shape once for each of `places`.
    fn add_shape(
        &mut self,
        context: &mut Context<'_>,
        shape: &ShapeDescription,
        places: &[DAffine3],
    ) -> Result<(), Fault> {
        let span = shape.entity.span;
        if shape.transforms.is_animated() {
            context.unsupported(span, "a moving shape", "its first place stands in")?;
        }
        if let Some(medium) = shape
            .medium
            .inside
            .as_ref()
            .or(shape.medium.outside.as_ref())
        {
            context.unsupported(medium.span, "a participating medium", "vacuum stands in")?;
        }
        let Some(geometry) = Geometry::read(context, shape)? else {
            return Ok(());
        };
        let Some(&Some(material)) = self.materials.get(shape.material) else {
            return Ok(());
        };
        let emission = match &shape.area_light {
            Some(entity) => Some(AreaEmission::read(context, entity)?),
            None => None,
        };
        self.summary.primitives += geometry.primitives() * places.len() as u64;
        if self.summary.primitives > MOST_PRIMITIVES {
            let message = format!("the scene has more than {MOST_PRIMITIVES} primitives");
            let fault = Fault::new(ErrorKind::Limit, span, message);
            return Err(fault.with_hint("every instance of an object is a copy of its shapes"));
        }
        for place in places {
            let world_from_local = *place * shape.transforms.start;
            let placed = geometry.place(&world_from_local, shape::orientation(shape));
            shape::check_extent(span, &placed)?;
            self.add_placed(placed, material, emission.as_ref(), span)?;
        }
        Ok(())
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
        for part in parts {
            let emitted = emission.map(|emission| emission.of(&part)).transpose()?;
            self.summary.shapes += 1;
            self.summary.area_lights += usize::from(emitted.is_some());
            self.builder.shape(part, material, emitted);
            self.shape_spans.push(span);
        }
        Ok(())
    }

    fn add_objects(&mut self, context: &mut Context<'_>) -> Result<(), Fault> {
        let description = context.description;
        self.summary.instances = description.instances.len();
        for instance in &description.instances {
            if instance.transforms.is_animated() {
                context.unsupported(
                    instance.span,
                    "a moving object",
                    "its first place stands in",
                )?;
            }
        }
        for (index, object) in description.objects.iter().enumerate() {
            let instances = description
                .instances
                .iter()
                .filter(|instance| instance.object == index);
            let places: Vec<_> = instances
                .map(|instance| instance.transforms.start)
                .collect();
            for shape in &object.shapes {
                if let Some(light) = &shape.area_light {
                    context.unsupported(
                        light.span,
                        "an emitting object",
                        "it emits as any shape",
                    )?;
                }
                if !places.is_empty() {
                    self.add_shape(context, shape, &places)?;
                }
            }
        }
        Ok(())
    }

    fn add_lights(&mut self, context: &mut Context<'_>) -> Result<(), Fault> {
        for light in &context.description.lights {
            if let Some((light, group)) = light::build(context, light)? {
                self.summary.other_lights += 1;
                self.builder.light_group(group.as_deref()).light(light);
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

/// Says where in the text the builder's error is.
fn scene_fault(error: &SceneError, shape_spans: &[Span], beginning: Span) -> Fault {
    let span = error
        .shape()
        .and_then(|shape| shape_spans.get(shape).copied());
    let kind = match error {
        SceneError::Intersector(_) => ErrorKind::Limit,
        _ => ErrorKind::Scene,
    };
    Fault::new(kind, span.unwrap_or(beginning), error.to_string())
}

#[cfg(test)]
mod tests;

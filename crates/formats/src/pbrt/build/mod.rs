//! Builds a scene to render from a [`SceneDescription`].
//!
//! All colours are linear Rec. 709: spectra are converted here. Instances share their object (`object`). The front of
//! a quadric is its outside, also under mirroring transformations, where the reference program contradicts itself.

mod camera;
mod color;
mod context;
mod emission;
mod film;
mod filter;
mod group;
mod imagemap;
mod light;
mod mapping;
mod material;
mod media;
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

use super::scene::{Entity, SceneDescription, ShapeDescription};
use crate::error::Result;
use crate::files::Files;
use crate::import::{self, Destination, Gathered, LoadOptions, Loaded, Size, Skin, VolumeContent};
use crate::source::{Fault, Span};
use bidir::medium::MediumId;
use bidir::scene::{Emission, MaterialId, Volume};
use bidir::shape::Shape;
use bidir::texture::FloatTexture;
use context::Context;
use emission::AreaEmission;
use glam::DVec3;
use material::{Built, Materials, all_of};
use media::Media;
use shape::Geometry;
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;
use texture::Textures;

type Assembly = import::Assembly<Span>;

/// Reads a scene file with all files that it refers to; `-` is standard input.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Loaded> {
    load_from(path, options, &Files::default())
}

/// Reads a scene as [`load`] does, from `files`.
pub fn load_from(path: &Path, options: &LoadOptions, files: &Files) -> Result<Loaded> {
    build(&super::parse_file_from(path, files)?, options)
}

/// Builds a described scene: reads its meshes and images, and checks everything.
pub fn build(description: &SceneDescription, options: &LoadOptions) -> Result<Loaded> {
    let log = context::log(description, options);
    import::load(description, options, log, Builder::gather)
}

/// The warning for a shape's inside medium that the medium of its material replaces.
const REPLACED: &str =
    "the medium within the shape has no effect: the material `subsurface` has one of its own";

/// The warning for shapes that do not enclose a volume.
const ENCLOSES_NOTHING: &str =
    "the shapes of a material with `priority` enclose nothing: it has no effect";

/// Puts the parts of a description into an assembly.
struct Builder<'a> {
    assembly: Assembly,
    textures: Textures<'a>,
    media: Media,
    /// The materials by index. None: the surface is not visible.
    materials: Vec<Option<Surface>>,
    /// The emission of the last shape.
    last_emission: Option<(Arc<Entity>, Arc<AreaEmission>)>,
}

/// A material in the scene.
struct Surface {
    id: MaterialId,
    /// The part of a surface that has the material. None: all of it.
    coverage: Option<FloatTexture>,
    /// The medium inside, of `subsurface`.
    content: Option<MediumId>,
    /// The priority and the index of refraction of the volume inside. None: the file gives no priority.
    filling: Option<(i32, f32)>,
}

impl<'a> Builder<'a> {
    /// Builds all parts of the description and places them.
    fn gather(context: &mut Context<'a>) -> Gathered<Span> {
        let description = context.document;
        let lens = camera::read(context)?;
        let film = film::build(context, &lens)?;
        let settings = settings::build(context, &film)?;
        let camera = lens.camera(film.settings.resolution, film.own_resolution)?;
        let filtering = settings::texture_filtering(description)?;
        let view = Context::view(camera, film.settings)?.with_filtering(filtering);
        let mut builder = Self {
            assembly: Assembly::new(context, settings, Some(lens.eye)),
            textures: Textures::new(description),
            media: Media::default(),
            materials: Vec::new(),
            last_emission: None,
        };
        builder.assembly.film_place = film.place;
        builder.add_camera_medium(context, lens.eye)?;
        builder.add_materials(context)?;
        let from_world = [context.layout.render_from_world()];
        for shape in &description.shapes {
            builder.add_shape(context, shape, Destination::World(&from_world))?;
        }
        builder.add_objects(context)?;
        builder.textures.check_unused(context)?;
        builder.media.check_unused(context)?;
        builder.add_lights(context)?;
        Ok((builder.assembly, view))
    }

    /// Sets the medium at the position of the camera.
    fn add_camera_medium(&mut self, context: &mut Context<'_>, eye: DVec3) -> Result<(), Fault> {
        let camera = &context.document.camera;
        let named = camera.as_ref().and_then(|it| it.medium.outside.as_ref());
        let builder = &mut self.assembly.builder;
        let medium = self.media.find(context, builder, named)?;
        let eye = context.layout.render_from_world().transform_point3(eye);
        builder.medium_at(eye.as_vec3(), medium);
        self.assembly.camera = named.map(|named| (eye.as_vec3(), medium, named.span));
        Ok(())
    }

    fn add_materials(&mut self, context: &mut Context<'_>) -> Result<(), Fault> {
        let description = context.document;
        let mut materials = Materials::new(&description.materials);
        self.assembly.summary.textures = description.textures.len();
        let used = used_materials(description);
        let textures = &mut self.textures;
        for index in 0..description.materials.len() {
            let mut build = |context: &mut _| materials.build(context, textures, index);
            let is_used = used.contains(&index);
            let built = if is_used {
                build(context)?
            } else {
                context.unused(build)?.flatten()
            };
            let builder = &mut self.assembly.builder;
            let add = |built: Built| {
                let recipe = built.content.filter(|_| is_used);
                let content = recipe.map(|recipe| Ok(builder.medium(recipe()?)));
                Ok(Surface {
                    id: builder.material(built.material),
                    coverage: built.coverage,
                    content: content.transpose()?,
                    filling: built.filling,
                })
            };
            self.materials.push(built.map(add).transpose()?);
        }
        self.assembly.summary.materials = self.materials.iter().flatten().count();
        Ok(())
    }

    /// Adds a shape to its destination.
    fn add_shape(
        &mut self,
        context: &mut Context<'_>,
        shape: &ShapeDescription,
        destination: Destination<'_>,
    ) -> Result<(), Fault> {
        let span = shape.entity.span;
        if shape.transforms.is_animated() {
            context.unsupported(span, "a moving shape", "its first position is used")?;
        }
        let Some((geometry, alpha)) = Geometry::read(context, &mut self.textures, shape)? else {
            return Ok(());
        };
        let builder = &mut self.assembly.builder;
        let mut media = self.media.sides(context, builder, &shape.medium)?;
        let surface = self.materials[shape.material].as_ref();
        if let Some(content) = surface.and_then(|surface| surface.content) {
            if let Some(replaced) = shape.medium.inside.as_ref()
                && media.is_boundary()
            {
                context.warn(replaced.span, REPLACED);
            }
            media.inside = content;
        }
        if surface.is_none() && !media.is_boundary() {
            return Ok(());
        }
        let part = surface.and_then(|surface| surface.coverage.clone());
        let coverage = all_of(alpha, part);
        let filling = surface.and_then(|surface| surface.filling);
        let content = filling.map(|(priority, index)| {
            let content = content(priority, index, media.inside);
            (content, shape.material)
        });
        let skin = Skin {
            material: surface.map(|surface| surface.id),
            coverage: coverage.as_ref(),
            media,
            content,
        };
        let light = shape.area_light.as_ref().filter(|_| surface.is_some());
        let shared = light
            .map(|light| self.emission(context, light))
            .transpose()?;
        let emission = shared.as_deref();
        if let Some(emission) = emission {
            emission.warn_of_parts(context, &geometry);
        }
        let parts = emission.map_or(1, |emission| emission.part_count(&geometry));
        let copies = destination.copies();
        let size = Size {
            primitives: geometry.primitives() * copies,
            vertices: geometry.vertices() * copies,
            shapes: parts * copies,
        };
        self.assembly.count(context, size, &span)?;
        let error = geometry.vertex_error(&shape.transforms.start.matrix3);
        self.assembly.vertex_errors.add(&span, error);
        match destination {
            Destination::World(places) => {
                for place in places {
                    let survey = &mut self.assembly.survey;
                    let map = *place * shape.transforms.start;
                    let placed = geometry.place(&map, shape, survey)?;
                    let parts = self.emitting_parts(&geometry, placed, emission)?;
                    self.assembly.add_shape(parts, &skin, &span);
                }
            }
            Destination::Object(object) => {
                let map = object.kept_from_own() * shape.transforms.start;
                let survey = self.assembly.object_survey();
                let shape = geometry.place(&map, shape, survey)?;
                self.assembly.add_to_object(object, shape, &skin, &span);
            }
        }
        Ok(())
    }

    /// Returns the parts of a shape that are separate lights, each with its emission, and sets their light group.
    fn emitting_parts(
        &mut self,
        geometry: &Geometry,
        shape: Shape,
        emission: Option<&AreaEmission>,
    ) -> Result<Vec<(Shape, Option<Emission>)>, Fault> {
        let Some(emission) = emission else {
            return Ok(vec![(shape, None)]);
        };
        self.assembly.builder.light_group(emission.group.as_deref());
        let with_emission = |part| {
            let emission = emission.of(&part)?;
            Ok((part, Some(emission)))
        };
        emission
            .parts(geometry, shape)
            .into_iter()
            .map(with_emission)
            .collect()
    }

    /// Reads the emission of a shape. The shapes after an `AreaLightSource` share its emission and image.
    fn emission(
        &mut self,
        context: &mut Context<'_>,
        entity: &Arc<Entity>,
    ) -> Result<Arc<AreaEmission>, Fault> {
        match &self.last_emission {
            Some((known, emission)) if Arc::ptr_eq(known, entity) => Ok(Arc::clone(emission)),
            _ => {
                let emission = Arc::new(AreaEmission::read(context, entity)?);
                self.last_emission = Some((Arc::clone(entity), Arc::clone(&emission)));
                Ok(emission)
            }
        }
    }

    fn add_lights(&mut self, context: &mut Context<'_>) -> Result<(), Fault> {
        for light in &context.document.lights {
            let span = light.entity.span;
            if let Some((light, group)) = light::build(context, light)? {
                self.assembly.builder.light_group(group.as_deref());
                self.assembly.add_light(light, span);
            }
        }
        Ok(())
    }
}

/// Returns the contents of volumes with this priority, index of refraction and medium.
fn content(priority: i32, index: f32, medium: MediumId) -> VolumeContent {
    VolumeContent {
        volume: Volume {
            index,
            medium,
            priority,
        },
        thin: None,
        warning: ENCLOSES_NOTHING,
    }
}

/// Returns the indices of the materials that shapes have.
fn used_materials(description: &SceneDescription) -> BTreeSet<usize> {
    let of_objects = description.objects.iter().flat_map(|object| &object.shapes);
    let shapes = description.shapes.iter().chain(of_objects);
    shapes.map(|shape| shape.material).collect()
}

#[cfg(test)]
mod tests;

//! Builds a [`Scene`] from its parts: checks them, builds the acceleration structure, and finds the sphere around
//! everything that lights at infinity shine through. All errors of a scene are found here.

use super::check::check_shape;
use super::error::SceneError;
use super::nesting::{self, Enclosed, Volume};
use super::object::{Geometry, ObjectId, Objects};
use super::{Opacity, RenderSpace, Scene, Surface, glow};
use crate::light::{
    AreaLight, EmissionSides, Light, LightChoice, LightContext, LightTree, VolumeLight,
};
use crate::material::Material;
use crate::math::{DAffine3, Vec3};
use crate::medium::{Medium, MediumId, MediumSides};
use crate::shape::{Shape, WorldFromObject};
use crate::spectrum::Illuminant;
use crate::texture::{ColorTexture, FloatTexture, clamped_alpha};

/// A material added to a [`SceneBuilder`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MaterialId(u32);

/// The light that a shape emits.
#[derive(Clone, Debug)]
pub struct Emission {
    /// Emitted radiance.
    pub radiance: Illuminant,
    /// The factor of the radiance at each point. None: it is 1.
    pub pattern: Option<ColorTexture>,
    /// The sides that emit.
    pub sides: EmissionSides,
}

/// The name of the group of lights at infinity that are in no other group.
pub const ENVIRONMENT_GROUP: &str = "environment";
/// The name of the group of all other lights that are in no other group.
pub const DEFAULT_GROUP: &str = "default";

/// Collects the parts of a scene and checks them.
#[derive(Debug, Default)]
pub struct SceneBuilder {
    space: RenderSpace,
    shapes: Vec<Shape>,
    surfaces: Vec<Surface>,
    objects: Objects,
    alphas: Vec<FloatTexture>,
    media: Vec<Medium>,
    volumes: Vec<Volume>,
    /// A point, usually a camera's, and the medium there.
    around: Option<(Vec3, MediumId)>,
    materials: Vec<Material>,
    lights: Vec<Light>,
    /// The group of each light, as an index into `group_names`.
    light_groups: Vec<u32>,
    group_names: Vec<String>,
    /// The name of the group that lights are added to. None: the default group of their kind.
    group: Option<String>,
    /// The instruction set of the intersector. None: the best that the machine has.
    isa: Option<accel::Isa>,
}

impl SceneBuilder {
    /// Makes an empty scene.
    pub fn new() -> Self {
        Self::default()
    }

    /// Sets the space of the shapes, the lights and the camera of every view; by default the world.
    pub fn space(&mut self, space: RenderSpace) -> &mut Self {
        self.space = space;
        self
    }

    /// Sets the instruction set of the intersector; by default the best that the machine has.
    pub fn isa(&mut self, isa: accel::Isa) -> &mut Self {
        self.isa = Some(isa);
        self
    }

    /// Adds a material.
    pub fn material(&mut self, material: Material) -> MaterialId {
        self.materials.push(material);
        MaterialId(self.materials.len() as u32 - 1)
    }

    /// Adds a shape of `material`, which emits light if `emission` is given. Returns its number.
    pub fn shape(
        &mut self,
        shape: Shape,
        material: MaterialId,
        emission: Option<Emission>,
    ) -> usize {
        let index = self.shapes.len();
        // The light of a broken mesh is not made, because its area cannot be computed; the error is found when the
        // scene is built. A mesh without triangles has no point that could emit.
        let emits = shape.primitive_count() > 0 && check_shape(index, &shape).is_ok();
        let light = emission.filter(|_| emits).map(|emission| {
            let mut light = AreaLight::new(index, &shape, emission.radiance, emission.sides);
            if let Some(pattern) = emission.pattern {
                light.set_pattern(&shape, pattern);
            }
            self.light(Light::Area(light))
        });
        self.push(shape, material, light);
        index
    }

    fn push(&mut self, shape: Shape, material: MaterialId, light: Option<u32>) {
        self.surfaces.push(Surface {
            material: material.0,
            light,
            opacity: Opacity::Opaque,
            sides: None,
            volume: None,
            is_detailed: self.materials[material.0 as usize].needs().footprint,
        });
        self.shapes.push(shape);
    }

    /// Adds a medium, and a light of the [`DEFAULT_GROUP`] if it emits. Equal media share a number. The medium fills
    /// the space that the [sides](Self::sides) of shapes give it, or surrounds [a point](Self::medium_at).
    pub fn medium(&mut self, medium: Medium) -> MediumId {
        let known = self.media.iter().position(|known| *known == medium);
        let index = known.unwrap_or_else(|| {
            // An excess of media is found when the scene is built.
            self.media.truncate(MediumId::MOST);
            self.media.push(medium);
            self.media.len() - 1
        });
        let id = MediumId::new(index).unwrap_or_default();
        if known.is_none() && self.media[index].glows() {
            // Media are shared by shapes of any group.
            let group = self.group.take();
            self.light(Light::Volume(VolumeLight::of(id)));
            self.group = group;
        }
        id
    }

    /// Sets the medium at a point, usually a camera's. A ray that leaves the point and crosses all boundaries reaches
    /// the medium around everything; without this call, that is the vacuum. Light from infinity does not arrive
    /// through an endless medium.
    pub fn medium_at(&mut self, point: Vec3, medium: MediumId) -> &mut Self {
        self.around = Some((point, medium));
        self
    }

    /// Sets the media on both sides of shape number `shape`. Without them, or if they are equal, both sides have the
    /// medium around the shape.
    pub fn sides(&mut self, shape: usize, media: MediumSides) -> &mut Self {
        self.surfaces[shape].sides = media.is_boundary().then_some(media);
        self
    }

    /// Returns shape number `shape`.
    pub fn shape_of(&self, shape: usize) -> &Shape {
        &self.shapes[shape]
    }

    /// Returns shape number `shape` for changes.
    pub fn shape_mut(&mut self, shape: usize) -> &mut Shape {
        &mut self.shapes[shape]
    }

    /// Sets the material of shape number `shape`.
    pub fn dress(&mut self, shape: usize, material: MaterialId) -> &mut Self {
        let needs = self.materials[material.0 as usize].needs();
        let surface = &mut self.surfaces[shape];
        (surface.material, surface.is_detailed) = (material.0, needs.footprint);
        self
    }

    /// Makes some shapes, all in the world or all in one object, the closed surface of a volume.
    pub fn enclose(&mut self, shapes: &[usize], volume: Volume) -> &mut Self {
        let number = self.volumes.len() as u32;
        self.volumes.push(volume);
        for &shape in shapes {
            self.surfaces[shape].volume = Some(number);
        }
        self
    }

    /// Adds a boundary between media without a surface: rays pass it. Returns the number of the shape.
    pub fn boundary(&mut self, shape: Shape, media: MediumSides) -> usize {
        let index = self.shapes.len();
        self.surfaces.push(Surface::boundary(media));
        self.shapes.push(shape);
        index
    }

    /// Adds a [boundary](Self::boundary) to an object, in the object's space.
    pub fn object_boundary(&mut self, object: ObjectId, shape: Shape, media: MediumSides) -> usize {
        let index = self.boundary(shape, media);
        self.objects.shapes[object.0 as usize].push(index);
        index
    }

    /// Sets the coverage `alpha` of shape number `shape` over its parameters. Rays pass the shape with probability 1
    /// - `alpha`, and its emission is multiplied by `alpha`. Range: `[0, 1]`.
    ///
    /// If `alpha` is the constant 0, no ray hits the shape, but it still emits: an invisible light, as in pbrt-v4.
    pub fn alpha(&mut self, shape: usize, alpha: FloatTexture) -> &mut Self {
        let surface = &mut self.surfaces[shape];
        let light = (surface.light).and_then(|light| match &mut self.lights[light as usize] {
            Light::Area(light) => Some(light),
            _ => None,
        });
        surface.opacity = match alpha {
            FloatTexture::Constant(alpha) if clamped_alpha(alpha) >= 1.0 => return self,
            FloatTexture::Constant(alpha) if alpha <= 0.0 => {
                if let Some(light) = light {
                    light.hide();
                }
                Opacity::Invisible
            }
            texture => {
                if let Some(light) = light {
                    light.set_alpha(texture.clone());
                }
                self.alphas.push(texture);
                Opacity::Texture(self.alphas.len() as u32 - 1)
            }
        };
        self
    }

    /// Adds an object without shapes. It is in the scene wherever it has [instances](Self::instance).
    pub fn object(&mut self) -> ObjectId {
        self.objects.shapes.push(Vec::new());
        ObjectId(self.objects.shapes.len() as u32 - 1)
    }

    /// Adds a shape of `material` to an object, in the object's space. Returns its number.
    ///
    /// Shapes of objects do not emit: add an emitting shape to the world, once for each position.
    pub fn object_shape(&mut self, object: ObjectId, shape: Shape, material: MaterialId) -> usize {
        let index = self.shapes.len();
        self.objects.shapes[object.0 as usize].push(index);
        self.push(shape, material, None);
        index
    }

    /// Places an object, under any invertible affine map. Returns the instance's number.
    pub fn instance(&mut self, object: ObjectId, world_from_object: DAffine3) -> usize {
        self.objects
            .instances
            .push((object, WorldFromObject(world_from_object)));
        self.objects.instances.len() - 1
    }

    /// Sets the group of the lights that are added from now on, including emitting shapes. None, the initial value:
    /// lights at infinity are in [`ENVIRONMENT_GROUP`], all others in [`DEFAULT_GROUP`].
    pub fn light_group(&mut self, name: Option<&str>) -> &mut Self {
        self.group = name.map(str::to_owned);
        self
    }

    /// Returns the index of the group that a light is added to.
    fn group_of(&mut self, light: &Light) -> u32 {
        let name = match &self.group {
            Some(name) => name,
            None if light.is_infinite() => ENVIRONMENT_GROUP,
            None => DEFAULT_GROUP,
        };
        let known = self.group_names.iter().position(|known| known == name);
        let index = known.unwrap_or(self.group_names.len());
        if known.is_none() {
            self.group_names.push(name.to_owned());
        }
        index as u32
    }

    /// Adds a light that is not a shape. Returns its number.
    pub fn light(&mut self, light: Light) -> u32 {
        let group = self.group_of(&light);
        self.light_groups.push(group);
        self.lights.push(light);
        self.lights.len() as u32 - 1
    }

    /// Returns the number of the next light.
    pub fn next_light(&self) -> u32 {
        self.lights.len() as u32
    }

    /// Checks everything and builds the acceleration structure.
    pub fn build(mut self) -> Result<Scene, SceneError> {
        if self.media.len() > MediumId::MOST {
            let count = self.media.len();
            return Err(SceneError::TooManyMedia { count });
        }
        let isa = self.isa.unwrap_or_else(accel::Isa::detect);
        let Geometry {
            bvh,
            primitives,
            instances,
        } = self.objects.build(&self.shapes, &self.surfaces, isa)?;
        let surroundings = glow::Surroundings {
            shapes: &self.shapes,
            surfaces: &self.surfaces,
            objects: &self.objects.shapes,
            bounds: bvh.bounds(),
        };
        surroundings.place_glows(&mut self.lights, &self.media);
        let (centre, radius) = bounding_sphere(&bvh, &self.lights, &self.media);
        let context = LightContext {
            shapes: &self.shapes,
            media: &self.media,
            centre,
            radius,
        };
        let light_choice = LightChoice::new(&self.lights, &context);
        let light_tree = LightTree::new(&self.lights, &context);
        let volumes = self.nested_volumes();
        let is_environment = |light: &Light| light.is_infinite() && !light.is_delta();
        let environment = (0..self.lights.len())
            .filter(|&i| is_environment(&self.lights[i]))
            .map(|i| i as u32);
        let is_boundary = |surface: &Surface| surface.opacity == Opacity::Boundary;
        let is_opaque =
            self.alphas.is_empty() && volumes.is_empty() && !self.surfaces.iter().any(is_boundary);
        let mut scene = Scene {
            is_opaque,
            foresees_media: is_opaque && self.media.iter().all(Medium::is_even),
            volumes,
            glows: glow::lights_of(&self.media, &self.lights),
            media: self.media,
            around: MediumId::VACUUM,
            light_media: Vec::new(),
            space: self.space,
            environment: environment.collect(),
            light_groups: self.light_groups,
            group_names: self.group_names,
            shapes: self.shapes,
            surfaces: self.surfaces,
            primitives,
            instances,
            alphas: self.alphas,
            materials: self.materials,
            lights: self.lights,
            light_choice,
            light_tree,
            bvh,
            centre,
            radius,
        };
        if scene.has_media() {
            if let Some((point, medium)) = self.around {
                scene.around = scene.medium_beyond(point, medium);
                scene.note_endless_glow();
            }
            let lights = scene.lights.iter();
            scene.light_media = lights.map(|light| media_of(&scene, light)).collect();
        }
        Ok(scene)
    }
}

impl SceneBuilder {
    /// Returns the volumes and what they enclose, if any touches another. If none does, volumes have no effect and
    /// are removed.
    fn nested_volumes(&mut self) -> Vec<Enclosed> {
        let boxes = nesting::boxes(&self.shapes, &self.surfaces, &self.objects);
        if !nesting::keep_touching(&mut self.surfaces, boxes.clone()) {
            return Vec::new();
        }
        let enclosed = |volume| Enclosed {
            volume,
            size: 0.0,
            reach: 0.0,
        };
        let mut volumes: Vec<_> = self.volumes.drain(..).map(enclosed).collect();
        for (volume, bounds) in &boxes {
            let reach = &mut volumes[*volume as usize].reach;
            *reach = reach.max(nesting::reach(bounds));
        }
        for (surface, shape) in self.surfaces.iter().zip(&self.shapes) {
            if let Some(volume) = surface.volume {
                volumes[volume as usize].size += shape.enclosed();
            }
        }
        volumes
    }
}

/// Returns the media on the sides of a light: the sides of its shape, or the medium at a point of the light.
fn media_of(scene: &Scene, light: &Light) -> MediumSides {
    match light {
        Light::Area(light) => {
            let surface = scene.surfaces[light.shape_index()];
            let point = scene.point_on(light.shape_index());
            match surface.sides {
                Some(sides) if surface.opacity != Opacity::Invisible => scene
                    .sides_of_nested(surface.volume, point)
                    .unwrap_or(sides),
                _ => MediumSides::all(scene.medium_at(point)),
            }
        }
        Light::Volume(light) => MediumSides::all(light.medium()),
        other => MediumSides::all(
            other
                .position()
                .map_or(scene.around, |point| scene.medium_at(point)),
        ),
    }
}

/// Returns a sphere around all surfaces, bounded media, and lights in space, with a little room.
fn bounding_sphere(bvh: &accel::Bvh, lights: &[Light], media: &[Medium]) -> (Vec3, f32) {
    let boxes = media.iter().filter_map(Medium::bounds);
    let bounds = boxes.fold(bvh.bounds(), accel::Aabb::union);
    let (mut min, mut max) = (bounds.min, bounds.max);
    for position in lights.iter().filter_map(Light::position) {
        (min, max) = (min.min(position), max.max(position));
    }
    if !min.cmple(max).all() {
        return (Vec3::ZERO, 1.0);
    }
    let centre = (min + max) / 2.0;
    let radius = centre.distance(max) * 1.001;
    (centre, if radius > 0.0 { radius } else { 1.0 })
}

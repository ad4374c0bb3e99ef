//! The scene: all that can be seen, checked and immutable. A [`View`](crate::view::View) is a camera's view of it.
//!
//! A [`Scene`] comes from a [`SceneBuilder`], the only place where errors are possible. All indices
//! in a built scene are valid.

mod advance;
mod alpha;
mod builder;
mod check;
mod edge;
mod error;
mod glow;
mod nesting;
mod object;
mod passage;
mod space;
mod visibility;

pub use accel::Isa;
pub use advance::{Advance, Interaction};
pub use alpha::RayDraws;
pub use builder::{DEFAULT_GROUP, ENVIRONMENT_GROUP, Emission, MaterialId, SceneBuilder};
pub use edge::{Edge, Transmittance};
pub use error::SceneError;
pub use nesting::Volume;
pub use object::ObjectId;

pub use space::RenderSpace;
pub(crate) use visibility::ShadowRayBuffers;

use nesting::Enclosed;
use object::Placed;

use crate::light::{Light, LightChoice, LightContext, LightPoint, LightTree};
use crate::material::Material;
use crate::math::{Vec2, Vec3};
use crate::medium::{Medium, MediumId, MediumSides};
use crate::shape::{Differentials, Shape, SurfacePoint};
use crate::texture::FloatTexture;

/// A primitive of the intersector as a part of a shape.
#[derive(Clone, Copy, Debug)]
struct PrimitiveRef {
    shape: u32,
    /// Its number within the shape.
    index: u32,
}

/// A shape with its material, light and media.
#[derive(Clone, Copy, Debug)]
struct Surface {
    material: u32,
    light: Option<u32>,
    opacity: Opacity,
    /// The media on its sides. None: both sides have the same.
    sides: Option<MediumSides>,
    /// The index of the volume that it bounds. None: it bounds none, or one that touches no other.
    volume: Option<u32>,
    /// True if the material needs differentials of the surface.
    is_detailed: bool,
}

impl Surface {
    /// Makes a boundary between `media`, if they differ.
    fn boundary(media: MediumSides) -> Self {
        let sides = media.is_boundary().then_some(media);
        Self {
            material: 0,
            light: None,
            opacity: sides.map_or(Opacity::Invisible, |_| Opacity::Boundary),
            sides,
            volume: None,
            is_detailed: false,
        }
    }
}

/// The coverage of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Opacity {
    /// It is 1.
    Opaque,
    /// A texture, by index in the scene.
    Texture(u32),
    /// It is 0, but the surface is a boundary of media.
    Boundary,
    /// It is 0: no ray hits the surface.
    Invisible,
}

/// The point where a ray meets a surface.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceHit {
    /// Local geometry.
    pub surface: SurfacePoint,
    /// The differentials of the surface. None: the material does not need them.
    pub differentials: Option<Differentials>,
    /// The material, by index.
    pub material: u32,
    /// The index of the surface's light, and the light point that was hit. None: it emits nothing.
    pub light: Option<(u32, LightPoint)>,
    /// The index of refraction around the volume that it bounds; 1 for air.
    pub around: f32,
}

/// A built scene.
#[derive(Debug)]
pub struct Scene {
    space: RenderSpace,
    shapes: Vec<Shape>,
    surfaces: Vec<Surface>,
    /// The primitives of the world first, then those of the objects.
    primitives: Vec<PrimitiveRef>,
    instances: Vec<Placed>,
    /// The textures of alpha.
    alphas: Vec<FloatTexture>,
    /// True if no ray passes a surface, so that α need not be looked up.
    is_opaque: bool,
    media: Vec<Medium>,
    /// True if the media along an unblocked shadow ray are known before it is traced.
    foresees_media: bool,
    /// The volumes, if any touch each other.
    volumes: Vec<Enclosed>,
    /// The medium around everything.
    around: MediumId,
    /// The media on the sides of each light.
    light_media: Vec<MediumSides>,
    /// The index of the light of each medium. None: it emits nothing.
    glows: Vec<Option<u32>>,
    materials: Vec<Material>,
    lights: Vec<Light>,
    light_choice: LightChoice,
    light_tree: LightTree,
    /// The group of each light, as an index into `group_names`.
    light_groups: Vec<u32>,
    group_names: Vec<String>,
    /// The lights that escaping rays hit, by index.
    environment: Vec<u32>,
    bvh: accel::Bvh,
    centre: Vec3,
    radius: f32,
}

impl Scene {
    /// Returns the space of its shapes and lights, and of the camera that sees them.
    #[inline]
    pub fn space(&self) -> &RenderSpace {
        &self.space
    }

    /// Returns all lights.
    #[inline]
    pub fn lights(&self) -> &[Light] {
        &self.lights
    }

    /// Returns light number `i`.
    #[inline]
    pub fn light(&self, i: u32) -> &Light {
        &self.lights[i as usize]
    }

    /// Returns the names of the groups of lights, in the order in which lights were added. Every light is in a group.
    pub fn group_names(&self) -> &[String] {
        &self.group_names
    }

    /// Returns the group of light number `i`, by index into [`Self::group_names`].
    #[inline]
    pub fn light_group(&self, i: u32) -> u32 {
        self.light_groups[i as usize]
    }

    /// Returns the choice of a light by power.
    #[inline]
    pub fn light_choice(&self) -> &LightChoice {
        &self.light_choice
    }

    /// Returns the choice of an emitter for a receiver.
    #[inline]
    pub fn light_tree(&self) -> &LightTree {
        &self.light_tree
    }

    /// Returns the lights that escaping rays hit, by index.
    #[inline]
    pub fn environment(&self) -> &[u32] {
        &self.environment
    }

    /// Returns the parts of the scene that lights need.
    #[inline]
    pub fn light_context(&self) -> LightContext<'_> {
        LightContext {
            shapes: &self.shapes,
            media: &self.media,
            centre: self.centre,
            radius: self.radius,
        }
    }

    /// Returns all materials.
    #[inline]
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// Returns the materials of surfaces that rays can hit, once for each surface.
    pub fn materials_of_surfaces(&self) -> impl Iterator<Item = &Material> {
        let met =
            |surface: &&Surface| !matches!(surface.opacity, Opacity::Invisible | Opacity::Boundary);
        let surfaces = self.surfaces.iter().filter(met);
        surfaces.map(|surface| self.material(surface.material))
    }

    /// Returns material number `i`.
    #[inline]
    pub fn material(&self, i: u32) -> &Material {
        &self.materials[i as usize]
    }

    /// Returns all shapes. Shapes of objects occur once, in the object's space.
    pub fn shapes(&self) -> &[Shape] {
        &self.shapes
    }

    /// Returns the number of instances.
    pub fn instance_count(&self) -> usize {
        self.instances.len()
    }

    /// Returns the number of primitives in memory: those of an object count once.
    pub fn unique_primitives(&self) -> u64 {
        self.primitives.len() as u64
    }

    /// Returns the number of primitives that rays can hit: those of an object count for every instance.
    pub fn placed_primitives(&self) -> u64 {
        let of_instance = |i| {
            let (object, _) = self.bvh.instance(i);
            self.bvh.objects()[object as usize].primitive_count() as u64
        };
        let of_instances: u64 = (0..self.instances.len()).map(of_instance).sum();
        self.bvh.primitive_count() as u64 + of_instances
    }

    /// Returns the acceleration structure.
    pub fn bvh(&self) -> &accel::Bvh {
        &self.bvh
    }

    /// Returns the nearest surface along a ray of a walk; `draws` decide which surfaces it passes. None: it escapes.
    #[inline]
    pub fn intersect(
        &self,
        origin: Vec3,
        direction: Vec3,
        draws: RayDraws<'_>,
    ) -> Option<SurfaceHit> {
        let ray = accel::Ray::new(origin, direction);
        let hit = self.closest(&ray, draws, |_| ())?;
        Some(self.surface_hit(&ray, &hit))
    }

    /// Returns the surface that a ray hits.
    #[inline]
    fn surface_hit(&self, ray: &accel::Ray, hit: &accel::Hit) -> SurfaceHit {
        let (placed, primitive) = self.resolve(hit);
        let surface = self.surface_of(ray, hit, placed, primitive);
        let (number, index) = (primitive.shape as usize, primitive.index as usize);
        let of_shape = self.surfaces[number];
        let light = of_shape
            .light
            .map(|light| (light, LightPoint::on_surface(&surface, primitive.index)));
        let uv = Vec2::new(hit.u, hit.v);
        let world_from_object = placed.map(|placed| &placed.world_from_object);
        let differentials = of_shape
            .is_detailed
            .then(|| self.shapes[number].differentials(world_from_object, index, uv, &surface));
        SurfaceHit {
            surface,
            differentials,
            material: of_shape.material,
            light,
            around: 1.0,
        }
    }

    /// Returns the point of a surface where a ray meets it.
    #[inline]
    fn surface_at(&self, ray: &accel::Ray, hit: &accel::Hit) -> SurfacePoint {
        let (placed, primitive) = self.resolve(hit);
        self.surface_of(ray, hit, placed, primitive)
    }

    /// Returns the point of a surface where a ray hits it, given the target of the hit.
    #[inline]
    fn surface_of(
        &self,
        ray: &accel::Ray,
        hit: &accel::Hit,
        placed: Option<&Placed>,
        primitive: PrimitiveRef,
    ) -> SurfacePoint {
        let (number, index) = (primitive.shape as usize, primitive.index as usize);
        let (shape, uv) = (&self.shapes[number], Vec2::new(hit.u, hit.v));
        let point = ray.origin + ray.direction * hit.t;
        match placed {
            None => shape.surface_point(index, uv, point),
            Some(placed) => shape.surface_point_at(&placed.world_from_object, index, uv, point),
        }
    }

    /// Returns the media on the sides of light number `i`.
    #[inline]
    pub(crate) fn light_media(&self, i: u32) -> MediumSides {
        let media = self.light_media.get(i as usize);
        media.copied().unwrap_or_default()
    }

    /// Returns the target of a hit: the instance, if it is in one, and the primitive of a shape.
    #[inline]
    fn resolve(&self, hit: &accel::Hit) -> (Option<&Placed>, PrimitiveRef) {
        let instance = hit.instance.checked_sub(1);
        let placed = instance.map(|instance| &self.instances[instance as usize]);
        let first = placed.map_or(0, |placed| placed.first_primitive);
        (placed, self.primitives[(first + hit.primitive) as usize])
    }
}

//! A scene under construction: shapes and lights, each with its place in the file.

use super::lamp::{self, Placed};
use super::placing::check_point;
use super::precision::{self, VertexErrors};
use super::space::box_corners;
use super::volumes::{Content, Space, Volumes};
use super::{Context, Document, SceneSettings, Summary, Survey};
use crate::error::ErrorKind;
use crate::source::Fault;
use bidir::light::Light;
use bidir::math::Vec3;
use bidir::medium::{MediumId, MediumSides};
use bidir::scene::{Emission, MaterialId, ObjectId, Scene, SceneBuilder, SceneError};
use bidir::shape::Shape;
use bidir::texture::FloatTexture;
use glam::{DAffine3, DVec3};

/// The warning for lights at infinity beyond a medium.
const UNREACHABLE: &str =
    "light from infinity does not arrive: the medium around the camera has no end";

/// The warning for a camera in a medium that boundaries contradict.
const ELSEWHERE: &str =
    "the shapes around the camera put it in another medium: it is taken to be there";

/// A scene under construction, with the places `P` of its parts in the file.
pub(crate) struct Assembly<P> {
    pub(crate) builder: SceneBuilder,
    pub(crate) summary: Summary,
    pub(super) settings: SceneSettings,
    /// The survey of everything but shared objects.
    pub(crate) survey: Survey,
    /// The survey of each shared object, in its own space.
    pub(super) objects: Vec<Survey>,
    pub(crate) vertex_errors: VertexErrors<P>,
    /// Number of vertices of all meshes in memory.
    vertices: u64,
    /// The place of each shape in the file, by the shape's number.
    shapes: Vec<P>,
    /// The place of each instance in the file, by the instance's number.
    instances: Vec<P>,
    pub(super) lamps: Vec<Placed<P>>,
    volumes: Volumes,
    /// The place in the file that gives the film's size. None: the caller's options give the size.
    pub(crate) film_place: Option<P>,
    /// The position of the camera, the medium that the file names for it, and its place in the file.
    pub(crate) camera: Option<(Vec3, MediumId, P)>,
}

/// The counts of a shape that limits apply to, summed over its copies.
#[derive(Clone, Copy)]
pub(crate) struct Size {
    pub(crate) primitives: u64,
    pub(crate) vertices: u64,
    pub(crate) shapes: u64,
}

/// An object that several instances share.
#[derive(Clone, Copy)]
pub(crate) struct SharedObject {
    id: ObjectId,
    /// The origin of the space in which its shapes are kept, in the object's own space.
    origin: DVec3,
}

impl SharedObject {
    /// Returns the map from the object's own space to the space in which its shapes are kept.
    pub(crate) fn kept_from_own(&self) -> DAffine3 {
        DAffine3::from_translation(-self.origin)
    }

    /// Returns the map of the kept shapes for an instance, where `map` maps the object's own space.
    pub(crate) fn place_kept(&self, map: &DAffine3) -> DAffine3 {
        *map * DAffine3::from_translation(self.origin)
    }
}

/// The destination of a shape.
#[derive(Clone, Copy)]
pub(crate) enum Destination<'a> {
    /// The render space, with one copy of the shape for each of these maps from its own space.
    World(&'a [DAffine3]),
    /// An object that is shared.
    Object(SharedObject),
}

impl Destination<'_> {
    /// Returns the number of shapes that are kept.
    pub(crate) fn copies(&self) -> u64 {
        match self {
            Self::World(places) => places.len() as u64,
            Self::Object(_) => 1,
        }
    }
}

/// The instances of several shapes, by their maps to the render space. If there are at least two, shapes are kept once,
/// in a shared object. Shapes that emit are copied, as each copy is a light.
pub(crate) struct Group<'a> {
    places: &'a [DAffine3],
    shared: Option<SharedObject>,
}

impl<'a> Group<'a> {
    pub(crate) fn new(places: &'a [DAffine3]) -> Self {
        let shared = None;
        Self { places, shared }
    }

    /// Returns the destination of a shape that emits.
    pub(crate) fn copied(&self) -> Destination<'a> {
        Destination::World(self.places)
    }
}

/// The properties of a shape's surface.
#[derive(Clone, Copy)]
pub(crate) struct Skin<'a> {
    /// The material. None: the surface is only a boundary of media.
    pub(crate) material: Option<MaterialId>,
    /// The coverage of the surface. None: it is opaque.
    pub(crate) coverage: Option<&'a FloatTexture>,
    /// The media on its sides.
    pub(crate) media: MediumSides,
    /// The contents of the volume that the shape bounds together with its family, and the family's number. None: it
    /// bounds no volume.
    pub(crate) content: Option<(Content, usize)>,
}

impl<P: Clone> Assembly<P> {
    /// Returns an empty scene, seen from `eye`. None: the position of the camera depends on the scene.
    pub(crate) fn new<D: Document>(
        context: &Context<'_, D>,
        settings: SceneSettings,
        eye: Option<DVec3>,
    ) -> Self {
        let mut builder = SceneBuilder::new();
        builder.space(context.layout.space);
        if let Some(isa) = context.options.isa {
            builder.isa(isa);
        }
        Self {
            builder,
            summary: Summary::default(),
            settings,
            survey: Survey::new(eye),
            objects: Vec::new(),
            vertex_errors: VertexErrors::NONE,
            vertices: 0,
            shapes: Vec::new(),
            instances: Vec::new(),
            lamps: Vec::new(),
            volumes: Volumes::default(),
            film_place: None,
            camera: None,
        }
    }

    /// Counts a shape against the limits, before it is added.
    pub(crate) fn count<D: Document<Place = P>>(
        &mut self,
        context: &Context<'_, D>,
        size: Size,
        place: &P,
    ) -> Result<(), Fault<P>> {
        self.summary.primitives += size.primitives;
        self.vertices += size.vertices;
        context.check_size(self.summary.primitives.max(self.vertices), place)?;
        context.check_shapes(self.summary.shapes as u64 + size.shapes, place)
    }

    /// Adds the parts of a shape. Each part that emits is a light of its own; all of them are one lamp of the file.
    pub(crate) fn add_shape(
        &mut self,
        parts: Vec<(Shape, Option<Emission>)>,
        skin: &Skin<'_>,
        place: &P,
    ) {
        let first_light = self.builder.next_light();
        let emits = parts.iter().any(|(_, emission)| emission.is_some());
        for (part, emission) in parts {
            let number = match skin.material {
                Some(material) => {
                    self.summary.area_lights += usize::from(emission.is_some());
                    self.builder.shape(part, material, emission)
                }
                None => self.builder.boundary(part, skin.media),
            };
            self.note_shape(number, skin, None, place);
        }
        if emits {
            let lights = first_light..self.builder.next_light();
            self.lamps.push((place.clone(), lights));
        }
    }

    fn note_shape(&mut self, number: usize, skin: &Skin<'_>, space: Space, place: &P) {
        self.summary.shapes += 1;
        self.shapes.push(place.clone());
        if let Some(material) = skin.material {
            self.builder.sides(number, skin.media);
            if let Some((content, family)) = skin.content {
                self.volumes.add(number, material, content, family, space);
            }
            if let Some(coverage) = skin.coverage {
                self.builder.alpha(number, coverage.clone());
            }
        }
    }

    /// Begins an object that instances share.
    fn begin_object<D: Document>(&mut self, context: &Context<'_, D>) -> SharedObject {
        let origin = context.layout.object_origin(self.objects.len());
        self.objects.push(Survey::new(None));
        let id = self.builder.object();
        SharedObject { id, origin }
    }

    /// Returns the destination of the next shape of `group` that does not emit. The group has to be the last one begun.
    pub(crate) fn shared<'a, D: Document>(
        &mut self,
        context: &Context<'_, D>,
        group: &mut Group<'a>,
    ) -> Destination<'a> {
        if group.places.len() < 2 {
            return group.copied();
        }
        let begin = || self.begin_object(context);
        Destination::Object(*group.shared.get_or_insert_with(begin))
    }

    /// Returns the survey of the last object.
    pub(crate) fn object_survey(&mut self) -> &mut Survey {
        self.objects.last_mut().expect("an object was begun")
    }

    /// Adds a shape to an object.
    pub(crate) fn add_to_object(
        &mut self,
        object: SharedObject,
        shape: Shape,
        skin: &Skin<'_>,
        place: &P,
    ) {
        let number = match skin.material {
            Some(material) => self.builder.object_shape(object.id, shape, material),
            None => self.builder.object_boundary(object.id, shape, skin.media),
        };
        let object = self.objects.len();
        self.note_shape(number, skin, Some(object), place);
    }

    /// Adds the instances of the last group, and returns their number; `name` returns the place in the file of each.
    /// Errors: an instance extends too far.
    pub(crate) fn add_instances<D: Document>(
        &mut self,
        context: &Context<'_, D>,
        group: &Group<'_>,
        name: impl Fn(usize) -> P,
    ) -> Result<usize, Fault<P>> {
        let Some(object) = group.shared else {
            return Ok(0);
        };
        let world_from_render = context.layout.render_from_world().inverse();
        for (i, map) in group.places.iter().enumerate() {
            let (place, map) = (name(i), object.place_kept(map));
            if let Some(corners) = self.object_survey().corners() {
                let world_from_kept = world_from_render * map;
                for corner in box_corners(corners) {
                    check_point(world_from_kept.transform_point3(corner), &place)?;
                }
                self.survey.include_box(corners, &map);
            }
            self.builder.instance(object.id, map);
            self.instances.push(place);
        }
        Ok(group.places.len())
    }

    /// Adds a light that is not a shape.
    pub(crate) fn add_light(&mut self, light: Light, place: P) {
        self.summary.other_lights += 1;
        let number = self.builder.light(light);
        self.lamps.push((place, number..number + 1));
    }

    /// Refuses a scene whose vertices have rounding errors that are large for its size.
    pub(super) fn check_vertices(&self) -> Result<(), Fault<P>> {
        match self.vertex_errors.refusal(self.survey.reach()) {
            None => Ok(()),
            Some((place, message)) => {
                Err(Fault::new(ErrorKind::Limit, place, message).with_hint(precision::HINT))
            }
        }
    }

    /// Builds the scene, with warnings about lights, media and vertices.
    pub(super) fn finish<D: Document<Place = P>>(
        &mut self,
        context: &mut Context<'_, D>,
    ) -> Result<Scene, Fault<P>> {
        if let Some((place, message)) = self.vertex_errors.warning() {
            context.warn(place, message);
        }
        let mut builder = std::mem::take(&mut self.builder);
        let volumes = std::mem::take(&mut self.volumes);
        volumes.settle(&mut builder, context, &self.shapes);
        let built = builder.build();
        let scene = built.map_err(|error| {
            let place = match error {
                SceneError::Instance { instance } => self.instances.get(instance),
                ref error => error.shape().and_then(|shape| self.shapes.get(shape)),
            };
            let kind = match error {
                SceneError::Intersector(_) => ErrorKind::Limit,
                _ => ErrorKind::Scene,
            };
            Fault::new(kind, place.cloned().unwrap_or(D::TOP), error.to_string())
        })?;
        for (place, lights) in &self.lamps {
            if let Some(message) = lamp::dark_warning(&scene, lights.clone()) {
                context.warn(place.clone(), message);
            }
        }
        if let Some((eye, medium, place)) = &self.camera
            && scene.medium_at(*eye) != *medium
        {
            context.warn(place.clone(), ELSEWHERE);
        }
        let is_swallowed = |light: &Light| light.is_infinite() && !scene.is_open();
        for (place, lights) in &self.lamps {
            if lights.clone().any(|light| is_swallowed(scene.light(light))) {
                context.warn(place.clone(), UNREACHABLE);
            }
        }
        Ok(scene)
    }
}

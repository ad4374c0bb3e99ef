//! From the structures of a file to a scene.

use super::document::{Context, Document};
use super::material::{Built as BuiltMaterial, Materials};
use super::mesh::Surface;
use super::node::Nodes;
use super::outside::{self, Extent};
use super::place::{GltfFault, Place};
use super::{light, mesh, view};
use crate::error::ErrorKind;
use crate::lamp::{self, Placed};
use crate::limits;
use crate::pbrt::Summary;
use crate::precision::{self, VertexError, VertexErrors};
use crate::space::{Layout, Survey};
use bidir::light::Light;
use bidir::math::Affine3A;
use bidir::scene::{ObjectId, Scene, SceneBuilder, SceneError};
use bidir::shape::{Mesh, Shape};
use glam::DAffine3;
use std::collections::BTreeMap;

/// A scene that was built, with where its lamps are in the file.
pub(super) struct Built {
    pub(super) scene: Scene,
    pub(super) lamps: Vec<Placed<Place>>,
    pub(super) summary: Summary,
}

/// A scene in the making.
pub(super) struct Assembly<'a> {
    document: &'a Document,
    nodes: Nodes,
    builder: SceneBuilder,
    materials: Materials,
    /// The places of the shapes in the file, in the order of addition; of instances likewise.
    shape_places: Vec<Place>,
    instance_places: Vec<Place>,
    /// The same of lamps, with the numbers of their lights.
    lamps: Vec<Placed<Place>>,
    /// Of everything in its place, and of each shared object in its own space.
    survey: Survey,
    objects: Vec<Survey>,
    vertex_errors: VertexErrors<Place>,
    /// Of all shapes.
    extent: Extent,
    most: Most,
    /// Of all meshes as they are kept.
    vertices: u64,
    /// Of all meshes.
    places: u64,
    summary: Summary,
}

/// The most that a scene may have.
struct Most {
    /// Primitives, and vertices.
    primitives: u64,
    shapes: u64,
    places: u64,
}

/// A mesh of the file where a scene has it.
struct MeshUse<'a> {
    /// The places in the world.
    places: Vec<DAffine3>,
    /// Its node, and where that is named.
    node: (usize, Place),
    weights: &'a [f32],
}

/// What makes two uses of a mesh the same: the mesh, and weights of morph targets.
type MeshKey = (usize, Vec<u32>);

impl<'a> Assembly<'a> {
    /// Builds the scene that a document shows, in the world or where its layout puts it.
    pub(super) fn build(
        context: &mut Context<'_>,
        document: &'a Document,
    ) -> Result<Built, GltfFault> {
        let mut again = context.clone();
        let mut assembly = Self::gather(context, document)?;
        assembly.check_vertices()?;
        let layout = Layout::of(&assembly.survey, &assembly.objects);
        if layout != Layout::default() {
            drop(assembly);
            again.layout = layout;
            document.start_counting(&again);
            *context = again;
            assembly = Self::gather(context, document)?;
        }
        if let Some((place, message)) = assembly.vertex_errors.warning() {
            context.warn(&place, message);
        }
        assembly.finish(context)
    }

    /// Refuses a scene of which the vertices leave nothing.
    fn check_vertices(&self) -> Result<(), GltfFault> {
        match self.vertex_errors.refusal(self.survey.reach()) {
            None => Ok(()),
            Some((place, message)) => {
                let fault = place.fault(ErrorKind::Limit, message);
                Err(fault.with_hint(precision::HINT))
            }
        }
    }

    /// Reads everything and puts it in its place.
    fn gather(context: &mut Context<'_>, document: &'a Document) -> Result<Self, GltfFault> {
        let nodes = Nodes::of(document, context.layout.render_from_world())?;
        let view = view::find(context, document, &nodes)?;
        let film = view.film(context)?;
        let resolution = film.resolution;
        let mut builder = SceneBuilder::new(film);
        builder.space(context.layout.space);
        if let Some(isa) = context.options.isa {
            builder.isa(isa);
        }
        let mut assembly = Self {
            document,
            nodes,
            builder,
            materials: Materials::default(),
            shape_places: Vec::new(),
            instance_places: Vec::new(),
            lamps: Vec::new(),
            survey: Survey::new(view.eye()),
            objects: Vec::new(),
            vertex_errors: VertexErrors::default(),
            extent: Extent::NONE,
            most: Most {
                primitives: context.options.most_primitives(context.reading.stored()),
                shapes: limits::SHAPES.of(context.reading.stored()),
                places: limits::INSTANCES.of(context.reading.stored()),
            },
            vertices: 0,
            places: 0,
            summary: Summary::default(),
        };
        if !document.root.animations.is_empty() {
            let place = Place::TOP.key("animations");
            context.warn(
                &place,
                "animations have no effect: nodes keep their own transformations",
            );
        }
        assembly.add_meshes(context)?;
        let world_from_camera = view.placed(context, resolution, &assembly.extent);
        assembly.add_lights(context, &world_from_camera)?;
        assembly.summary.materials = assembly.materials.count();
        assembly.summary.textures = document.root.textures.len();
        let camera = view.camera(resolution, world_from_camera)?;
        assembly.builder.camera(camera);
        Ok(assembly)
    }

    /// Builds the scene.
    fn finish(self, context: &mut Context<'_>) -> Result<Built, GltfFault> {
        let scene = self.builder.build();
        let scene = scene
            .map_err(|error| scene_fault(&error, &self.shape_places, &self.instance_places))?;
        for (place, lights) in &self.lamps {
            if let Some(message) = lamp::dark_warning(&scene, lights.clone()) {
                context.warn(place, message);
            }
        }
        Ok(Built {
            scene,
            lamps: self.lamps,
            summary: self.summary,
        })
    }

    /// Adds all meshes: those with joints where these put them, all others by their uses.
    fn add_meshes(&mut self, context: &mut Context<'_>) -> Result<(), GltfFault> {
        let document = self.document;
        let mut uses: BTreeMap<MeshKey, MeshUse<'a>> = BTreeMap::new();
        let mut order = Vec::new();
        for index in self.nodes.order.clone() {
            let node = &document.root.nodes[index];
            let Some(mesh) = node.mesh else { continue };
            let place = Place::of("nodes", index);
            let Some(described) = document.root.meshes.get(mesh) else {
                let count = document.root.meshes.len();
                return Err(place
                    .key("mesh")
                    .scene(format!("there is no mesh {mesh}: the file has {count}")));
            };
            let weights = node.weights.as_ref().unwrap_or(&described.weights);
            if let Some(skin) = node.skin {
                self.add_skinned(context, (mesh, skin, &place), weights)?;
                continue;
            }
            let key = (
                mesh,
                weights.iter().map(|weight| weight.to_bits()).collect(),
            );
            let places = self.world_places(context, index, &place)?;
            self.count_places(places.len(), &place)?;
            let of_mesh = uses.entry(key.clone()).or_insert_with(|| {
                order.push(key);
                MeshUse {
                    places: Vec::new(),
                    node: (index, place),
                    weights,
                }
            });
            of_mesh.places.extend(places);
        }
        for key in order {
            self.add_mesh(context, key.0, &uses[&key])?;
        }
        Ok(())
    }

    /// Where a node has its mesh, but for places that leave nothing of it.
    fn world_places(
        &self,
        context: &mut Context<'_>,
        index: usize,
        place: &Place,
    ) -> Result<Vec<DAffine3>, GltfFault> {
        let whole = context.layout.render_from_world();
        let render_from_node = self.nodes.render_from_node[index].unwrap_or(whole);
        let local = mesh::places(self.document, &self.document.root.nodes[index], place)?;
        let mut places: Vec<_> = local
            .into_iter()
            .map(|map| render_from_node * map)
            .collect();
        let count = places.len();
        places.retain(|map| map.matrix3.determinant() != 0.0);
        if places.len() < count {
            context.warn(place, "a mesh that is scaled to zero is left out");
        }
        Ok(places)
    }

    /// Adds a mesh at all its places: as an object where there are several.
    fn add_mesh(
        &mut self,
        context: &mut Context<'_>,
        mesh: usize,
        of_mesh: &MeshUse<'_>,
    ) -> Result<(), GltfFault> {
        let is_shared = of_mesh.places.len() > 1;
        let mut object = None;
        let mut survey = Survey::new(None);
        let origin = context.layout.object_origin(self.objects.len());
        let at_origin = DAffine3::from_translation(-origin);
        let places = of_mesh.places.iter();
        let places: Vec<_> = places.map(|map| *map * at_origin.inverse()).collect();
        for (surface, material, place) in self.surfaces(context, mesh, of_mesh.weights)? {
            if let Some(first) = of_mesh.places.first() {
                self.measure(context, &surface, first, &place);
            }
            if is_shared && material.emission.is_none() {
                let object = *object.get_or_insert_with(|| self.builder.object());
                let shape = surface.place(&at_origin, (&material.uv, &mut survey), &place)?;
                self.add_to_object((object, &places), shape, &material, &place)?;
                continue;
            }
            for map in &of_mesh.places {
                let shape = surface.place(map, (&material.uv, &mut self.survey), &place)?;
                self.add_to_world(shape, &material, &place)?;
            }
        }
        let Some(object) = object else {
            return Ok(());
        };
        self.summary.instances += of_mesh.places.len();
        for map in places {
            if let Some(corners) = survey.corners() {
                self.survey.include_box(corners, &map);
            }
            self.builder.instance(object, map);
            self.instance_places.push(of_mesh.node.1.clone());
        }
        self.objects.push(survey);
        Ok(())
    }

    /// The primitives of a mesh that have triangles, each with its material.
    fn surfaces(
        &mut self,
        context: &mut Context<'_>,
        mesh: usize,
        weights: &[f32],
    ) -> Result<Vec<(Surface, BuiltMaterial, Place)>, GltfFault> {
        let mut surfaces = Vec::new();
        let primitives = &self.document.root.meshes[mesh].primitives;
        for (i, primitive) in primitives.iter().enumerate() {
            let place = Place::of("meshes", mesh).key("primitives").index(i);
            let read = Surface::read(context, self.document, (primitive, &place), weights)?;
            let Some(surface) = read else { continue };
            let user = (primitive.material, &place);
            let tools = (&mut *context, &mut self.builder);
            let material = self
                .materials
                .get(tools, self.document, user, surface.color)?;
            surfaces.push((surface, material, place));
        }
        Ok(surfaces)
    }

    fn add_skinned(
        &mut self,
        context: &mut Context<'_>,
        (mesh, skin, place): (usize, usize, &Place),
        weights: &[f32],
    ) -> Result<(), GltfFault> {
        let place = place.key("skin");
        let render_from_node = &self.nodes.render_from_node;
        let joints = mesh::joints(self.document, render_from_node, skin, &place)?;
        let whole = context.layout.render_from_world();
        for (surface, material, place) in self.surfaces(context, mesh, weights)? {
            let user = (&material.uv, &mut self.survey);
            let shape = if surface.joints.is_empty() {
                surface.place(&whole, user, &place)?
            } else {
                surface.skinned(&joints, user, &place)?
            };
            self.add_to_world(shape, &material, &place)?;
        }
        Ok(())
    }

    fn count_places(&mut self, count: usize, place: &Place) -> Result<(), GltfFault> {
        self.places += count as u64;
        let most = self.most.places;
        if self.places <= most {
            return Ok(());
        }
        let message = format!("the scene has more than {most} mesh instances");
        Err(place.fault(ErrorKind::Limit, message))
    }

    fn count(&mut self, shape: &Mesh, place: &Place) -> Result<(), GltfFault> {
        self.summary.shapes += 1;
        self.summary.primitives += shape.triangles.len() as u64;
        self.vertices += shape.positions.len() as u64;
        let limit = |message| Err(place.fault(ErrorKind::Limit, message));
        let most = self.most.primitives;
        if self.summary.primitives.max(self.vertices) > most {
            return limit(format!(
                "the scene has more than {most} triangles or vertices"
            ));
        }
        let most = self.most.shapes;
        if self.summary.shapes as u64 > most {
            return limit(format!(
                "the scene has more than {most} shapes, counted at each place"
            ));
        }
        Ok(())
    }

    fn add_to_world(
        &mut self,
        shape: Mesh,
        material: &BuiltMaterial,
        place: &Place,
    ) -> Result<(), GltfFault> {
        self.count(&shape, place)?;
        self.extent.include(&extent_of(&shape), &DAffine3::IDENTITY);
        self.summary.area_lights += usize::from(material.emission.is_some());
        let shape = Shape::Mesh(shape);
        let first_light = self.builder.next_light();
        let number = self
            .builder
            .shape(shape, material.id, material.emission.clone());
        self.shape_places.push(place.clone());
        if material.emission.is_some() {
            let lights = first_light..self.builder.next_light();
            self.lamps.push((place.clone(), lights));
        }
        if let Some(coverage) = &material.coverage {
            self.builder.coverage(number, coverage.clone());
        }
        Ok(())
    }

    fn add_to_object(
        &mut self,
        (object, places): (ObjectId, &[DAffine3]),
        shape: Mesh,
        material: &BuiltMaterial,
        place: &Place,
    ) -> Result<(), GltfFault> {
        self.count(&shape, place)?;
        let own = extent_of(&shape);
        for map in places {
            self.extent.include(&own, map);
        }
        let number = self
            .builder
            .object_shape(object, Shape::Mesh(shape), material.id);
        self.shape_places.push(place.clone());
        if let Some(coverage) = &material.coverage {
            self.builder.coverage(number, coverage.clone());
        }
        Ok(())
    }

    /// Takes note of what the vertices of a primitive lose, which `render_from_mesh` puts in place.
    fn measure(
        &mut self,
        context: &Context<'_>,
        surface: &Surface,
        render_from_mesh: &DAffine3,
        place: &Place,
    ) {
        let linear = render_from_mesh.matrix3 * context.layout.space.unit;
        let error = VertexError::of(&surface.positions, &linear);
        self.vertex_errors.add(place, error);
    }

    /// Adds the lights that are no shapes; a soft one from behind the viewer where there is no light.
    fn add_lights(
        &mut self,
        context: &mut Context<'_>,
        world_from_camera: &Affine3A,
    ) -> Result<(), GltfFault> {
        let mut lights = light::all(context, self.document, &self.nodes)?;
        if lights.is_empty() && self.summary.area_lights == 0 {
            let message = "the scene has no light; using a soft one from behind the viewer";
            context.warn(&Place::TOP, message);
            let sky = Light::Infinite(outside::surroundings(world_from_camera));
            lights.push((Place::TOP, sky));
        }
        self.summary.other_lights = lights.len();
        for (place, light) in lights {
            let number = self.builder.light(light);
            self.lamps.push((place, number..number + 1));
        }
        Ok(())
    }
}

fn extent_of(shape: &Mesh) -> Extent {
    let triangles = (0..shape.triangles.len()).map(|i| shape.triangle(i));
    Extent::of(&shape.positions, triangles)
}

/// Says where in the file the builder's error is.
fn scene_fault(error: &SceneError, shapes: &[Place], instances: &[Place]) -> GltfFault {
    let place = match error {
        SceneError::Instance { instance } => instances.get(*instance),
        error => error.shape().and_then(|shape| shapes.get(shape)),
    };
    let kind = match error {
        SceneError::Intersector(_) => ErrorKind::Limit,
        _ => ErrorKind::Scene,
    };
    place.unwrap_or(&Place::TOP).fault(kind, error.to_string())
}

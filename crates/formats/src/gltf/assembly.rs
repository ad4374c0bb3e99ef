//! Builds a scene from the structures of a file.

use super::document::{Context, Document};
use super::material::{Built as BuiltMaterial, Materials};
use super::mesh::Surface;
use super::node::Nodes;
use super::outlook::{Needs, Outlook};
use super::outside::{self, Extent};
use super::place::{GltfFault, Place};
use super::{SETTINGS, light, mesh, view};
use crate::error::ErrorKind;
use crate::import::{self, Destination, Gathered, Group, Size, Skin, VertexError};
use crate::limits;
use bidir::light::Light;
use bidir::math::Affine3A;
use bidir::scene::Emission;
use bidir::shape::{Mesh, Shape};
use glam::DAffine3;
use std::cell::Cell;
use std::collections::BTreeMap;

type Assembly = import::Assembly<Place>;

/// Puts the parts of a document into an assembly.
pub(super) struct Builder<'a> {
    document: &'a Document,
    nodes: Nodes,
    assembly: Assembly,
    materials: Materials,
    /// The extent of all shapes.
    extent: Extent,
    /// Number of instances of meshes so far.
    places: u64,
    /// Number of lights of KHR_lights_punctual.
    punctual: usize,
    /// Number of families so far. A family is the shapes of one instance of a mesh, which may enclose a volume only
    /// together.
    families: usize,
}

/// A mesh of the file with one set of morph weights, and all instances of it.
struct MeshUse<'a> {
    /// The transforms of the instances, from the mesh to the render space.
    places: Vec<DAffine3>,
    /// The place in the file of the first node that has the mesh.
    node: Place,
    weights: &'a [f32],
}

/// The key of a [`MeshUse`]: the index of the mesh, and the bits of the morph weights.
type MeshKey = (usize, Vec<u32>);

impl<'a> Builder<'a> {
    /// Reads and places everything, with the defaults of `outlook`. Sets `needs` to the defaults that the file needs.
    pub(super) fn gather(
        context: &mut Context<'a>,
        outlook: &Outlook,
        needs: &Cell<Needs>,
    ) -> Gathered<Place> {
        let document = context.document;
        document.start_counting(context.log.reading.stored);
        let nodes = Nodes::of(document, context.layout.render_from_world())?;
        let described = view::find(context, &nodes)?;
        let film = described.film(context)?;
        let film_place = described.film_place(context);
        let resolution = film.resolution;
        let mut builder = Self {
            document,
            nodes,
            assembly: Assembly::new(context, SETTINGS, described.eye()),
            materials: Materials::default(),
            extent: Extent::NONE,
            places: 0,
            punctual: 0,
            families: 0,
        };
        if !document.root.animations.is_empty() {
            let message = "animations have no effect: nodes keep their own transformations";
            context.warn(Place::TOP.key("animations"), message);
        }
        builder.add_meshes(context)?;
        let inside = outlook.inside.as_ref();
        let world_from_camera = described.placed(context, resolution, &builder.extent, inside);
        builder.add_lights(context, &world_from_camera, outlook)?;
        needs.set(builder.needs(described.eye().is_none()));
        let mut assembly = builder.assembly;
        assembly.film_place = film_place;
        assembly.summary.materials = builder.materials.count();
        assembly.summary.textures = document.root.textures.len();
        let camera = described.camera(resolution, world_from_camera)?;
        let view = Context::view(camera, film)?;
        Ok((assembly, view))
    }

    /// Adds all meshes: each skinned node by its joints, each other mesh once with all of its instances.
    fn add_meshes(&mut self, context: &mut Context<'_>) -> Result<(), GltfFault> {
        let document = self.document;
        let mut uses: BTreeMap<MeshKey, MeshUse<'a>> = BTreeMap::new();
        let mut order = Vec::new();
        for index in self.nodes.order.clone() {
            let node = &document.root.nodes[index];
            let Some(mesh) = node.mesh else { continue };
            let place = Place::of("nodes", index);
            let described = place
                .key("mesh")
                .find(&document.root.meshes, mesh, "mesh")?;
            let weights = node.weights.as_ref().unwrap_or(&described.weights);
            if let Some(skin) = node.skin {
                self.add_skinned(context, mesh, skin, &place, weights)?;
                continue;
            }
            let key = (
                mesh,
                weights.iter().map(|weight| weight.to_bits()).collect(),
            );
            let places = self.world_places(context, index, &place)?;
            self.count_places(context, places.len(), &place)?;
            let of_mesh = uses.entry(key.clone()).or_insert_with(|| {
                order.push(key);
                MeshUse {
                    places: Vec::new(),
                    node: place,
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

    /// Returns the transforms of a node's mesh to the render space. Leaves out singular ones, with a warning.
    fn world_places(
        &self,
        context: &mut Context<'_>,
        index: usize,
        place: &Place,
    ) -> Result<Vec<DAffine3>, GltfFault> {
        let whole = context.layout.render_from_world();
        let render_from_node = self.nodes.render_from_node[index].unwrap_or(whole);
        let node = &self.document.root.nodes[index];
        let mut places = mesh::places(self.document, node, place)?;
        let count = places.len();
        for map in &mut places {
            *map = render_from_node * *map;
        }
        places.retain(|map| map.matrix3.determinant() != 0.0);
        if places.len() < count {
            context.warn(place.clone(), "a mesh that is scaled to zero is left out");
        }
        Ok(places)
    }

    /// Adds a mesh with all its instances: copies of primitives that emit; of all others an object, if there are
    /// several.
    fn add_mesh(
        &mut self,
        context: &mut Context<'_>,
        mesh: usize,
        of_mesh: &MeshUse<'_>,
    ) -> Result<(), GltfFault> {
        let places = &of_mesh.places;
        let mut group = Group::new(places);
        for (surface, material, place) in self.surfaces(context, mesh, of_mesh.weights)? {
            if let Some(first) = places.first() {
                self.measure(context, &surface, first, &place);
            }
            let destination = match material.emission {
                Some(_) => group.copied(),
                None => self.assembly.shared(context, &mut group),
            };
            match destination {
                Destination::World(copies) => {
                    for (i, map) in copies.iter().enumerate() {
                        let survey = &mut self.assembly.survey;
                        let shape = surface.place(map, &material.uv, survey, &place)?;
                        let skin = material.skin(self.families + i);
                        let emission = material.emission.clone();
                        self.add_to_world(context, shape, emission, &skin, &place)?;
                    }
                }
                Destination::Object(object) => {
                    let (map, survey) = (object.kept_from_own(), self.assembly.object_survey());
                    let mesh = surface.place(&map, &material.uv, survey, &place)?;
                    self.count(context, &mesh, &place)?;
                    self.include(&mesh, places.iter().map(|map| object.place_kept(map)));
                    let (shape, skin) = (Shape::Mesh(mesh), material.skin(self.families));
                    self.assembly.add_to_object(object, shape, &skin, &place);
                }
            }
        }
        self.families += places.len();
        let name = |_| of_mesh.node.clone();
        self.assembly.summary.instances += self.assembly.add_instances(context, &group, name)?;
        Ok(())
    }

    /// Reads the primitives of a mesh that have triangles. Returns each with its material and its place in the file.
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
            let read = Surface::read(context, primitive, &place, weights)?;
            let Some(surface) = read else { continue };
            let (materials, builder) = (&mut self.materials, &mut self.assembly.builder);
            let index = primitive.material;
            let material = materials.get(context, builder, index, &place, surface.color)?;
            surfaces.push((surface, material, place));
        }
        Ok(surfaces)
    }

    fn add_skinned(
        &mut self,
        context: &mut Context<'_>,
        mesh: usize,
        skin: usize,
        place: &Place,
        weights: &[f32],
    ) -> Result<(), GltfFault> {
        let place = place.key("skin");
        let render_from_node = &self.nodes.render_from_node;
        let joints = mesh::joints(self.document, render_from_node, skin, &place)?;
        let whole = context.layout.render_from_world();
        for (mut surface, material, place) in self.surfaces(context, mesh, weights)? {
            for warning in surface.repair_weights(joints.len()).warnings() {
                context.warn(place.clone(), warning);
            }
            let (uv, survey) = (&material.uv, &mut self.assembly.survey);
            let shape = if surface.joints.is_empty() {
                surface.place(&whole, uv, survey, &place)?
            } else {
                surface.skinned(&joints, uv, survey, &place)?
            };
            let (skin, emission) = (material.skin(self.families), material.emission.clone());
            self.add_to_world(context, shape, emission, &skin, &place)?;
        }
        self.families += 1;
        Ok(())
    }

    fn count_places(
        &mut self,
        context: &Context<'_>,
        count: usize,
        place: &Place,
    ) -> Result<(), GltfFault> {
        self.places += count as u64;
        let most = limits::INSTANCES.of(context.log.reading.stored);
        if self.places <= most {
            return Ok(());
        }
        let message = format!("the scene has more than {most} mesh instances");
        Err(place.fault(ErrorKind::Limit, message))
    }

    fn count(
        &mut self,
        context: &Context<'_>,
        shape: &Mesh,
        place: &Place,
    ) -> Result<(), GltfFault> {
        let size = Size {
            primitives: shape.triangles.len() as u64,
            vertices: shape.positions.len() as u64,
            shapes: 1,
        };
        self.assembly.count(context, size, place)
    }

    /// Adds a shape to the extent, at each of `places`.
    fn include(&mut self, shape: &Mesh, places: impl IntoIterator<Item = DAffine3>) {
        let triangles = (0..shape.triangles.len()).map(|i| shape.triangle(i));
        let own = Extent::of(&shape.positions, triangles);
        for map in places {
            self.extent.include(&own, &map);
        }
    }

    fn add_to_world(
        &mut self,
        context: &Context<'_>,
        shape: Mesh,
        emission: Option<Emission>,
        skin: &Skin<'_>,
        place: &Place,
    ) -> Result<(), GltfFault> {
        self.count(context, &shape, place)?;
        self.include(&shape, [DAffine3::IDENTITY]);
        let parts = vec![(Shape::Mesh(shape), emission)];
        self.assembly.add_shape(parts, skin, place);
        Ok(())
    }

    /// Records the rounding error of a primitive's vertices, which `render_from_mesh` transforms.
    fn measure(
        &mut self,
        context: &Context<'_>,
        surface: &Surface,
        render_from_mesh: &DAffine3,
        place: &Place,
    ) {
        let linear = render_from_mesh.matrix3 * context.layout.space.unit;
        let error = VertexError::of(&surface.positions, &linear);
        self.assembly.vertex_errors.add(place, error);
    }

    /// Adds the lights that are not shapes, and a soft one from behind the viewer if the scene would be dark.
    fn add_lights(
        &mut self,
        context: &mut Context<'_>,
        world_from_camera: &Affine3A,
        outlook: &Outlook,
    ) -> Result<(), GltfFault> {
        let mut lights = light::all(context, &self.nodes)?;
        self.punctual = lights.len();
        let emits = self.assembly.summary.area_lights > 0;
        if lights.is_empty() && (!emits || outlook.is_dark) {
            let message = if emits {
                "the surfaces that emit leave the scene dark; adding a soft light from behind the viewer"
            } else {
                "the scene has no light; using a soft one from behind the viewer"
            };
            context.warn(Place::TOP, message);
            let sky = Light::Infinite(outside::surroundings(world_from_camera));
            lights.push((Place::TOP, sky));
        }
        for (place, light) in lights {
            self.assembly.add_light(light, place);
        }
        Ok(())
    }

    /// Returns the defaults that the file needs; `camera` is true if it has no camera.
    fn needs(&self, camera: bool) -> Needs {
        let emits = self.assembly.summary.area_lights > 0;
        Needs {
            camera,
            light: self.punctual == 0 && emits,
            has_own_light: self.punctual > 0 || emits,
        }
    }
}

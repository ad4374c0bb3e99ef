//! Objects: shapes that stand in several places without being copied. The intersector keeps one tree
//! for each object; a hit is mapped to the world where it is found.
//!
//! Shapes of objects do not emit: a light is one shape in the world.

use super::check::gather_primitives;
use super::{PrimitiveRef, SceneError, Surface};
use crate::shape::{Place, Shape};
use std::sync::Arc;

/// An object of a [`SceneBuilder`](super::SceneBuilder).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ObjectId(pub(super) u32);

/// An object in its place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed {
    pub(super) place: Place,
    /// The index of the object's first primitive among those of the scene.
    pub(super) first_primitive: u32,
}

/// The objects and instances of a scene in the making.
#[derive(Debug, Default)]
pub(super) struct Objects {
    /// The numbers of the shapes of each object.
    pub(super) shapes: Vec<Vec<usize>>,
    /// Every instance: which object, and where.
    pub(super) instances: Vec<(ObjectId, Place)>,
}

/// The tree that the intersector asks, and the primitives and instances that its answers refer to.
pub(super) struct Geometry {
    pub(super) bvh: accel::Bvh,
    /// The primitives of the world first, then those of the objects.
    pub(super) primitives: Vec<PrimitiveRef>,
    pub(super) instances: Vec<Placed>,
}

impl Objects {
    /// Checks all shapes and builds the trees. Shapes that are in no object are in the world.
    pub(super) fn build(
        &self,
        shapes: &[Shape],
        surfaces: &[Surface],
        isa: accel::Isa,
    ) -> Result<Geometry, SceneError> {
        let options = accel::BuildOptions { isa };
        let error = |error: accel::BuildError| match error {
            accel::BuildError::BadInstance { instance, .. } => SceneError::Instance { instance },
            error => SceneError::Intersector(error.to_string()),
        };
        let mut in_world = vec![true; shapes.len()];
        self.shapes
            .iter()
            .flatten()
            .for_each(|&shape| in_world[shape] = false);
        let world: Vec<usize> = (0..shapes.len()).filter(|&shape| in_world[shape]).collect();
        let mut primitives = Vec::new();
        let own = gather_primitives(shapes, surfaces, &world, &mut primitives)?;
        let (mut trees, mut firsts) = (Vec::new(), Vec::new());
        for object in &self.shapes {
            firsts.push(primitives.len() as u32);
            let geometry = gather_primitives(shapes, surfaces, object, &mut primitives)?;
            let tree = accel::Bvh::build(&geometry, &options).map_err(error)?;
            trees.push(Arc::new(tree));
        }
        let instances = self
            .instances
            .iter()
            .map(|(object, place)| accel::Instance {
                object: object.0,
                world_from_object: place.0,
            });
        let instances: Vec<_> = instances.collect();
        let bvh = accel::Bvh::with_instances(&own, trees, &instances, &options).map_err(error)?;
        let placed = |&(object, place): &(ObjectId, Place)| Placed {
            place,
            first_primitive: firsts[object.0 as usize],
        };
        Ok(Geometry {
            bvh,
            primitives,
            instances: self.instances.iter().map(placed).collect(),
        })
    }
}

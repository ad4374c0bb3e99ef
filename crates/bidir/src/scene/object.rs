//! Objects: shapes that are placed several times without copies. The intersector has one tree for each object; a hit
//! is mapped to the world when it is found.
//!
//! Shapes of objects do not emit: a light is one shape in the world.

use super::check::gather_primitives;
use super::{PrimitiveRef, SceneError, Surface};
use crate::shape::{Shape, WorldFromObject};
use std::sync::Arc;

/// An object of a [`SceneBuilder`](super::SceneBuilder).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ObjectId(pub(super) u32);

impl ObjectId {
    pub(super) fn index(self) -> usize {
        self.0 as usize
    }
}

/// An instance: an object with its map to the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed {
    pub(super) world_from_object: WorldFromObject,
    /// The index of the object's first primitive among those of the scene.
    pub(super) first_primitive: u32,
}

/// The objects and instances of an unfinished scene.
#[derive(Debug, Default)]
pub(super) struct Objects {
    /// The numbers of the shapes of each object.
    pub(super) shapes: Vec<Vec<usize>>,
    /// The object and the transform of each instance.
    pub(super) instances: Vec<(ObjectId, WorldFromObject)>,
}

/// The intersector's tree, and the primitives and instances that its hits refer to.
pub(super) struct Geometry {
    pub(super) bvh: accel::Bvh,
    /// The primitives of the world first, then those of the objects.
    pub(super) primitives: Vec<PrimitiveRef>,
    pub(super) instances: Vec<Placed>,
}

/// The shapes' primitives, for the intersector.
struct Gathered<'a> {
    shapes: &'a [Shape],
    primitives: &'a [PrimitiveRef],
}

impl accel::Primitives for Gathered<'_> {
    fn count(&self) -> usize {
        self.primitives.len()
    }

    fn primitive(&self, index: usize) -> accel::Primitive {
        let PrimitiveRef { shape, index } = self.primitives[index];
        self.shapes[shape as usize].primitive(index as usize)
    }
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
        let mut is_free = vec![true; shapes.len()];
        self.shapes
            .iter()
            .flatten()
            .for_each(|&shape| is_free[shape] = false);
        let world: Vec<usize> = (0..shapes.len()).filter(|&shape| is_free[shape]).collect();
        let mut primitives = Vec::new();
        gather_primitives(shapes, surfaces, &world, &mut primitives)?;
        let in_world = primitives.len();
        let (mut trees, mut firsts) = (Vec::new(), Vec::new());
        for object in &self.shapes {
            let first = primitives.len();
            firsts.push(first as u32);
            gather_primitives(shapes, surfaces, object, &mut primitives)?;
            let own = Gathered {
                shapes,
                primitives: &primitives[first..],
            };
            let tree = accel::Bvh::with_instances(&own, Vec::new(), &[], &options);
            trees.push(Arc::new(tree.map_err(error)?));
        }
        let instances: Vec<_> = (self.instances.iter())
            .map(|(object, map)| accel::Instance {
                object: object.0,
                world_from_object: map.0,
            })
            .collect();
        let own = Gathered {
            shapes,
            primitives: &primitives[..in_world],
        };
        let bvh = accel::Bvh::with_instances(&own, trees, &instances, &options).map_err(error)?;
        let placed = |&(object, world_from_object): &(ObjectId, WorldFromObject)| Placed {
            world_from_object,
            first_primitive: firsts[object.0 as usize],
        };
        Ok(Geometry {
            bvh,
            primitives,
            instances: self.instances.iter().map(placed).collect(),
        })
    }
}

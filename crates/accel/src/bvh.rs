//! [`Bvh`]: construction and queries.

use std::ops::ControlFlow;
use std::sync::Arc;

use glam::{DAffine3, Vec3};
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};

use crate::aabb::Aabb;
use crate::builder::{MAX_PRIMITIVES, Tree};
use crate::error::{BuildError, InstanceError};
use crate::instance::{Instance, Placement};
use crate::isa::Isa;
use crate::node::Node;
use crate::primitive::{Primitive, Primitives};
use crate::ray::{Hit, Ray};
use crate::stop::Stop;
use crate::triangle::TriangleBlock;

/// The options of building a [`Bvh`].
#[derive(Debug, Clone)]
pub struct BuildOptions {
    /// The instructions that rays are traced with. The default is the best of this machine.
    pub isa: Isa,
}

impl Default for BuildOptions {
    fn default() -> Self {
        Self { isa: Isa::detect() }
    }
}

/// A bounding volume hierarchy: finds the primitives that a ray hits.
///
/// ```
/// use bidir_accel::{Bvh, BuildOptions, Primitive, Ray, accept_all};
/// use glam::Vec3;
///
/// let triangle = Primitive::Triangle([Vec3::ZERO, Vec3::X, Vec3::Y]);
/// let bvh = Bvh::build(&[triangle], &BuildOptions::default())?;
/// let ray = Ray { t_max: 3.0, ..Ray::new(Vec3::new(0.2, 0.3, 2.0), -Vec3::Z) };
/// let hit = bvh.closest(&ray, accept_all).expect("it points at the triangle");
/// assert_eq!((hit.t, hit.u, hit.v), (2.0, 0.2, 0.3));
/// assert!(bvh.is_blocked(&ray));
/// # Ok::<(), bidir_accel::BuildError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Bvh {
    pub(crate) tree: Tree,
    pub(crate) primitive_count: usize,
    pub(crate) objects: Vec<Arc<Bvh>>,
    pub(crate) placements: Vec<Placement>,
    isa: Isa,
}

impl Bvh {
    /// Builds the tree, on all threads of the current `rayon` pool. Without primitives no ray hits.
    pub fn build(primitives: &[Primitive], options: &BuildOptions) -> Result<Self, BuildError> {
        Self::with_instances(primitives, Vec::new(), &[], options)
    }

    /// Builds the tree over primitives and over instances of `objects`, which must not have instances themselves.
    ///
    /// An instance of an empty object is never hit. The instruction sets of the objects' own trees are ignored.
    ///
    /// ```
    /// use std::sync::Arc;
    /// use bidir_accel::{Bvh, BuildOptions, Instance, Primitive, Ray, accept_all};
    /// use glam::{DAffine3, DVec3, Vec3};
    ///
    /// let options = BuildOptions::default();
    /// let leaf = Bvh::build(&[Primitive::Triangle([Vec3::ZERO, Vec3::X, Vec3::Y])], &options)?;
    /// let at = |z| Instance {
    ///     object: 0,
    ///     world_from_object: DAffine3::from_translation(DVec3::Z * z),
    /// };
    /// let bvh = Bvh::with_instances(&[][..], vec![Arc::new(leaf)], &[at(0.0), at(1.0)], &options)?;
    /// let ray = Ray::new(Vec3::new(0.2, 0.3, 3.0), -Vec3::Z);
    /// let hit = bvh.closest(&ray, accept_all).expect("the upper leaf is in the way");
    /// assert_eq!((hit.t, hit.instance, hit.primitive), (2.0, 2, 0));
    /// # Ok::<(), bidir_accel::BuildError>(())
    /// ```
    pub fn with_instances<P: Primitives + ?Sized>(
        primitives: &P,
        objects: Vec<Arc<Self>>,
        instances: &[Instance],
        options: &BuildOptions,
    ) -> Result<Self, BuildError> {
        let isa = supported(options.isa)?;
        let primitive_count = primitives.count();
        let count = primitive_count + instances.len();
        if count > MAX_PRIMITIVES {
            return Err(BuildError::TooManyPrimitives {
                count,
                limit: MAX_PRIMITIVES,
            });
        }
        let (placements, places) = place(&objects, instances)?;
        Ok(Self {
            tree: Tree::build(primitives, primitive_count, &places)?,
            primitive_count,
            objects,
            placements,
            isa,
        })
    }

    /// Sets the instruction set. Those of its objects are not used.
    pub fn with_isa(self, isa: Isa) -> Result<Self, BuildError> {
        let isa = supported(isa)?;
        Ok(Self { isa, ..self })
    }

    /// Returns the hit of smallest `t` among those for which `accept` holds.
    ///
    /// At equal `t`, the hit with the lowest `(instance, primitive)` wins. `accept` must be a pure function of the
    /// hit: it is called in any order, for any hits.
    #[inline]
    pub fn closest<F: Fn(&Hit) -> bool>(&self, ray: &Ray, accept: F) -> Option<Hit> {
        self.until(Stop::NEVER).closest(ray, accept)
    }

    /// Returns true if there is any hit: the same as `closest(ray, accept_all).is_some()`, but faster.
    #[inline]
    pub fn is_blocked(&self, ray: &Ray) -> bool {
        self.until(Stop::NEVER).is_blocked(ray)
    }

    /// Sets `blocked` to the results of [`is_blocked`](Self::is_blocked) for `rays`. For dozens of rays in a large
    /// tree this is faster.
    pub fn are_blocked(&self, rays: &[Ray], blocked: &mut Vec<bool>) {
        self.until(Stop::NEVER).are_blocked(rays, blocked);
    }

    /// Calls `found` with every hit of the ray, each once and in any order, until it breaks. Returns the last result
    /// of `found`.
    #[inline]
    pub fn each_hit<F: FnMut(&Hit) -> ControlFlow<()>>(
        &self,
        ray: &Ray,
        found: F,
    ) -> ControlFlow<()> {
        self.until(Stop::NEVER).each_hit(ray, found)
    }

    /// Returns a box around all primitives and instances; [`Aabb::EMPTY`] if there are none.
    pub fn bounds(&self) -> Aabb {
        self.tree.bounds
    }

    /// Returns the number of primitives of the tree, without those of objects.
    pub fn primitive_count(&self) -> usize {
        self.primitive_count
    }

    /// Returns the objects that instances refer to.
    pub fn objects(&self) -> &[Arc<Self>] {
        &self.objects
    }

    /// Returns the number of instances.
    pub fn instance_count(&self) -> usize {
        self.placements.len()
    }

    /// Returns the index of the object of instance `i`, and the map that takes rays to the object's space.
    pub fn instance(&self, i: usize) -> (u32, &DAffine3) {
        let placement = &self.placements[i];
        (placement.object, placement.object_from_world())
    }

    /// Returns the instructions that rays are traced with.
    #[inline]
    pub fn isa(&self) -> Isa {
        self.isa
    }

    /// Returns the memory of the tree and its copy of the primitives, with instances, and with every object once.
    /// Unit: bytes.
    pub fn memory_bytes(&self) -> usize {
        let of_objects: usize = self
            .objects
            .iter()
            .map(|object| object.memory_bytes())
            .sum();
        of_objects + size_of_val(self.placements.as_slice()) + self.own_memory_bytes()
    }

    fn own_memory_bytes(&self) -> usize {
        size_of_val(self.tree.nodes.as_slice())
            + size_of_val(self.tree.blocks.as_slice())
            + size_of_val(self.tree.quadrics.as_slice())
    }
}

fn supported(isa: Isa) -> Result<Isa, BuildError> {
    let supported = isa.is_supported().then_some(isa);
    supported.ok_or(BuildError::UnsupportedIsa { isa })
}

/// Places every instance; the bounds of those of empty objects are [`Aabb::EMPTY`].
fn place(
    objects: &[Arc<Bvh>],
    instances: &[Instance],
) -> Result<(Vec<Placement>, Vec<Aabb>), BuildError> {
    let outlines: Vec<_> = objects.iter().map(|object| object.tree.outline()).collect();
    let place = |instance: &Instance| {
        let index = instance.object as usize;
        let object = objects.get(index).ok_or(InstanceError::NoObject)?;
        if !object.placements.is_empty() {
            return Err(InstanceError::Nested);
        }
        let is_empty = object.tree.nodes.is_empty();
        let point = Aabb::around(&[Vec3::ZERO]);
        let placed = if is_empty {
            Placement::new(instance, &point, &[point])
        } else {
            Placement::new(instance, &object.tree.bounds, &outlines[index])
        };
        let (placement, bounds) = placed.ok_or(InstanceError::NotInvertible)?;
        Ok((placement, if is_empty { Aabb::EMPTY } else { bounds }))
    };
    let numbered = |(index, placed): (usize, Result<_, _>)| {
        placed.map_err(|reason| BuildError::BadInstance {
            instance: index,
            reason,
        })
    };
    let tried: Vec<_> = instances.par_iter().map(place).collect();
    let placed: Result<Vec<_>, _> = tried.into_iter().enumerate().map(numbered).collect();
    Ok(placed?.into_iter().unzip())
}

// Memory estimates and vector loads rely on this layout.
const _: () = assert!(size_of::<Node>() == 256 && align_of::<Node>() == 64);
const _: () = assert!(size_of::<TriangleBlock>() == 160);

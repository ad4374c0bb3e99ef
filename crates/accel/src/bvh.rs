//! [`Bvh`]: building and asking.

use std::fmt;

use crate::aabb::Aabb;
use crate::builder::{MAX_PRIMITIVES, Tree};
use crate::isa::Isa;
use crate::node::Node;
use crate::primitive::Primitive;
use crate::ray::{Hit, Ray};
use crate::simd::Scalar4;
#[cfg(target_arch = "x86_64")]
use crate::simd::Sse4;
use crate::traverse::{AnyHit, ClosestHit, Query, traverse};
use crate::triangle::TriangleBlock;

/// How to build a [`Bvh`].
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

/// Why a [`Bvh`] could not be built.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum BuildError {
    /// A coordinate or parameter of a primitive is NaN or infinite, or so large that its bounds are,
    /// or its map has no inverse.
    NotFinite {
        /// The first such primitive.
        primitive: usize,
    },
    /// There are more primitives than the tree can count.
    TooManyPrimitives {
        /// How many there are.
        count: usize,
        /// How many there may be.
        limit: usize,
    },
    /// This machine lacks the instructions.
    UnsupportedIsa {
        /// The instructions asked for.
        isa: Isa,
    },
}

impl fmt::Display for BuildError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite { primitive } => {
                write!(f, "primitive {primitive} has no finite bounds")
            }
            Self::TooManyPrimitives { count, limit } => {
                write!(f, "{count} primitives are more than the limit of {limit}")
            }
            Self::UnsupportedIsa { isa } => write!(f, "this machine does not support {isa}"),
        }
    }
}

impl std::error::Error for BuildError {}

/// A bounding volume hierarchy: finds which of many primitives a ray hits.
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
/// assert!(bvh.occluded(&ray, accept_all));
/// # Ok::<(), bidir_accel::BuildError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Bvh {
    pub(crate) tree: Tree,
    pub(crate) bounds: Aabb,
    pub(crate) primitive_count: usize,
    isa: Isa,
}

impl Bvh {
    /// Builds the tree, on all threads of the current `rayon` pool. Without primitives no ray hits.
    pub fn build(primitives: &[Primitive], options: &BuildOptions) -> Result<Self, BuildError> {
        if !options.isa.is_supported() {
            return Err(BuildError::UnsupportedIsa { isa: options.isa });
        }
        let count = primitives.len();
        if count > MAX_PRIMITIVES {
            return Err(BuildError::TooManyPrimitives {
                count,
                limit: MAX_PRIMITIVES,
            });
        }
        let all_bounds: Vec<Aabb> = primitives.iter().map(Primitive::bounds).collect();
        if let Some(primitive) = all_bounds.iter().position(|bounds| !bounds.is_valid()) {
            return Err(BuildError::NotFinite { primitive });
        }
        Ok(Self {
            tree: Tree::build(primitives, &all_bounds),
            bounds: all_bounds
                .iter()
                .fold(Aabb::EMPTY, |sum, bounds| sum.union(*bounds)),
            primitive_count: count,
            isa: options.isa,
        })
    }

    /// The hit of smallest `t` among those for which `accept` holds.
    ///
    /// At equal `t` the lowest `(instance, primitive)` wins.
    /// `accept` must be a pure function of the hit: it is asked in any order, about any hits.
    #[inline]
    pub fn closest<F: Fn(&Hit) -> bool>(&self, ray: &Ray, accept: F) -> Option<Hit> {
        let mut query = ClosestHit::new(accept);
        self.ask(ray, &mut query);
        query.best
    }

    /// Whether there is any hit for which `accept` holds: the same as `closest(..).is_some()`,
    /// but faster.
    #[inline]
    pub fn occluded<F: Fn(&Hit) -> bool>(&self, ray: &Ray, accept: F) -> bool {
        let mut query = AnyHit::new(accept);
        self.ask(ray, &mut query);
        query.found
    }

    #[inline]
    fn ask(&self, ray: &Ray, query: &mut impl Query) {
        match self.isa {
            #[cfg(target_arch = "x86_64")]
            Isa::Sse2 => traverse::<Sse4, _>(&self.tree, ray, query),
            _ => traverse::<Scalar4, _>(&self.tree, ray, query),
        }
    }

    /// A box around all primitives; [`Aabb::EMPTY`] if there are none.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// The number of primitives it was built from.
    pub fn primitive_count(&self) -> usize {
        self.primitive_count
    }

    /// The instructions that rays are traced with.
    pub fn isa(&self) -> Isa {
        self.isa
    }

    /// Bytes of memory that the tree and its copy of the primitives take.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(self.tree.nodes.as_slice())
            + size_of_val(self.tree.blocks.as_slice())
            + size_of_val(self.tree.quadrics.as_slice())
    }
}

// The layout that memory estimates and wider vectors count on.
const _: () = assert!(size_of::<Node>() == 256 && align_of::<Node>() == 64);
const _: () = assert!(size_of::<TriangleBlock>() == 160);

//! Watertight ray intersection: an 8-wide BVH over triangles, spheres, disks, cylinders and instances.
//!
//! A [`Bvh`] is built once from a slice of [`Primitive`]s, and then answers queries from any number of threads.
//! [`Bvh::closest`] takes a filter that decides which hits exist, so that cut-outs (alpha) cost one call per hit, and
//! nothing if they are not used ([`accept_all`]). [`Bvh::each_hit`] reports all hits, and [`Bvh::are_blocked`] finds
//! which of many rays hit anything.
//!
//! ```
//! use bidir_accel::{Bvh, BuildOptions, Primitive, Ray, accept_all};
//! use glam::Vec3;
//!
//! let floor = |z| Primitive::Triangle([
//!     Vec3::new(-1.0, -1.0, z),
//!     Vec3::new(3.0, -1.0, z),
//!     Vec3::new(-1.0, 3.0, z),
//! ]);
//! let bvh = Bvh::build(&[floor(0.0), floor(1.0)], &BuildOptions::default())?;
//!
//! let down = Ray::new(Vec3::new(0.0, 0.0, 5.0), -Vec3::Z);
//! let hit = bvh.closest(&down, accept_all).expect("the upper floor is in the way");
//! assert_eq!((hit.primitive, hit.t), (1, 4.0));
//!
//! // A filter makes hits vanish: here the upper floor is glass.
//! let hit = bvh.closest(&down, |hit| hit.primitive != 1).expect("the lower floor remains");
//! assert_eq!((hit.primitive, hit.t), (0, 5.0));
//! # Ok::<(), bidir_accel::BuildError>(())
//! ```
//!
//! # What is promised
//!
//! - **Watertight.** A ray cannot pass between triangles that share an edge or a vertex: whether it
//!   passes a triangle is decided *exactly* for the vertices as seen from the ray's origin
//!   (the `exact` module), and boxes are tested conservatively (the `node` module).
//! - **The same bits everywhere.** `t`, `u` and `v` are computed by one scalar function in `f64`.
//!   SIMD code only discards hits that this function would certainly refuse, and reports a hit without
//!   it only where it would certainly find one; the instruction set has no influence on an answer.
//! - **One answer.** Of hits at equal `t` the lowest `(instance, primitive)` wins, whatever the order
//!   of traversal. The tree does not depend on the number of threads that build it.
//! - **No allocation per ray**, and a stack whose bound is proved by the builder, for both levels.
//!
//! # Instances
//!
//! [`Bvh::with_instances`] takes other trees ([`Instance`]: which one, under which affine map).
//! All of the above holds through instances: every triangle of an instance sees one and the same local
//! ray, so that no ray passes between those that share an edge; the world box of an instance is
//! widened by what rounding can move that ray (the `instance` module); `t` is the world's, since
//! directions are mapped without normalising. Between triangles of *different* instances nothing is
//! promised but rounding. One level only: an object has no instances itself. An instance takes
//! 128 bytes, whatever its object.
//!
//! Not here: motion, curves, and anything about surfaces (normals, materials).

mod aabb;
mod builder;
mod bvh;
mod child;
mod cylinder;
mod disk;
mod error;
mod exact;
mod instance;
mod isa;
mod lockstep;
mod memory;
mod node;
mod primitive;
mod quadric;
mod query;
mod ray;
mod simd;
mod sphere;
mod stack;
mod stop;
mod traverse;
mod triangle;
mod validate;

pub use aabb::Aabb;
pub use bvh::{BuildOptions, Bvh};
pub use cylinder::Cylinder;
pub use disk::Disk;
pub use error::{BuildError, InstanceError};
pub use instance::Instance;
pub use isa::{Isa, UnknownIsa};
pub use memory::load_ahead;
pub use primitive::{Primitive, Primitives};
pub use ray::{Hit, Ray, accept_all};
pub use sphere::Sphere;
pub use stop::{Queries, Stop};

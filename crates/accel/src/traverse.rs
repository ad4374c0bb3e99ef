//! The traversal of the tree by a ray: one function for all instruction sets and all queries.

use std::ops::ControlFlow;

use glam::Vec3;

use crate::builder::Tree;
use crate::bvh::Bvh;
use crate::child::{Child, Target};
use crate::instance::{Approach, Space, World};
use crate::node::{BoxRay, widen};
use crate::quadric::Quadric;
use crate::query::Query;
use crate::ray::{Hit, Ray};
use crate::simd::{F32x4, Kernel, Simd};
use crate::stack::{Stack, bits};
use crate::stop::Stop;
use crate::triangle::{TriangleBlock, TriangleLanes, TriangleRay};

/// Offers every hit of `ray` that may matter to `query`.
pub(crate) struct Ask<'a, Q> {
    pub(crate) bvh: &'a Bvh,
    pub(crate) ray: &'a Ray,
    pub(crate) query: &'a mut Q,
    pub(crate) stop: Stop<'a>,
}

impl<Q: Query> Kernel for Ask<'_, Q> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self) {
        let Self {
            bvh,
            ray,
            query,
            stop,
        } = self;
        let Some(ray) = clean(ray) else { return };
        if !bvh.tree.nodes.is_empty() {
            let mut walk = Walk {
                tree: &bvh.tree,
                space: World,
                ray,
            };
            let mut approach = None;
            // A query that breaks needs no more hits.
            let _ = walk.run::<S, Q>(query, |_, index, ray, query| {
                let visit = VisitInstance {
                    bvh,
                    index,
                    approach: approach.get_or_insert_with(|| Approach::new(&ray)),
                    ray,
                    query,
                    stop,
                };
                // SAFETY: this is a kernel of the same set, so the machine has it.
                unsafe { S::call(visit) }
            });
        }
    }
}

/// Follows the ray through the object of instance number `index`, and returns its new `t_max`, or breaks if it is
/// asked to stop. It is a kernel of its own, so that the loop of trees without instances does not contain it.
pub(crate) struct VisitInstance<'a, Q> {
    pub(crate) bvh: &'a Bvh,
    pub(crate) index: usize,
    pub(crate) ray: Ray,
    pub(crate) approach: &'a Approach,
    pub(crate) query: &'a mut Q,
    pub(crate) stop: Stop<'a>,
}

impl<Q: Query> Kernel for VisitInstance<'_, Q> {
    type Output = ControlFlow<(), f32>;

    #[inline(always)]
    fn run<S: Simd>(self) -> Self::Output {
        if self.stop.is_asked() {
            return ControlFlow::Break(());
        }
        let placement = &self.bvh.placements[self.index];
        let (local, space) = placement.view(&self.ray, self.approach, self.index as u32 + 1);
        let Some(local) = clean(&local) else {
            return ControlFlow::Continue(self.ray.t_max);
        };
        let mut walk = Walk {
            tree: &self.bvh.objects[placement.object as usize].tree,
            space,
            ray: local,
        };
        // Objects have no instances.
        walk.run::<S, Q>(self.query, |_, _, ray, _| ControlFlow::Continue(ray.t_max))?;
        ControlFlow::Continue(walk.space.t_max)
    }
}

/// The traversal of one tree, in its own space.
struct Walk<'a, P> {
    tree: &'a Tree,
    space: P,
    ray: Ray,
}

impl<P: Space> Walk<'_, P> {
    /// Visits the tree, which has a root. Calls `instance` for the instances on the way; it returns the `t_max` after
    /// them.
    ///
    /// Rare leaves get a copy of the ray: the original stays in registers if no other function has its address.
    #[inline(always)]
    fn run<S: Simd, Q: Query>(
        &mut self,
        query: &mut Q,
        mut instance: impl FnMut(&mut P, usize, Ray, &mut Q) -> ControlFlow<(), f32>,
    ) -> ControlFlow<()> {
        let Self { tree, space, ray } = self;
        let (tree, mut ray) = (*tree, *ray);
        let box_ray = BoxRay::new(&ray, tree.reach).lanes::<S::Eight>();
        let triangle_ray = TriangleRay::new(&ray).lanes::<S::Four>();
        let mut limit = widen(ray.t_max);
        let mut stack = Stack::new();
        let mut child = Child::node(0);
        loop {
            if let Some(index) = child.as_node() {
                if let Some(next) = stack.open::<S>(tree, tree.node(index), &box_ray, limit) {
                    child = next;
                    continue;
                }
            } else {
                if let Some((first, count)) = child.as_triangles() {
                    for block in tree.blocks(first, count) {
                        space.visit_block(block, &triangle_ray, &mut ray, query)?;
                    }
                } else {
                    ray.t_max = match child.target() {
                        Target::Quadrics(leaf) => {
                            space.visit_quadrics(&tree.quadrics[leaf], ray, query)?
                        }
                        Target::Instance(index) => instance(space, index, ray, query)?,
                        _ => ray.t_max,
                    };
                }
                limit = widen(ray.t_max);
            }
            match stack.pop(limit) {
                Some(next) => child = next,
                None => return ControlFlow::Continue(()),
            }
        }
    }
}

/// Returns the ray in the form that the kernels assume: finite, not empty, without negative or infinite `t`, and with
/// zero in place of components whose reciprocal would overflow. None: the ray hits nothing.
#[inline(always)]
pub(crate) fn clean(ray: &Ray) -> Option<Ray> {
    let normal = |x: f32| if x.abs() < f32::MIN_POSITIVE { 0.0 } else { x };
    let [x, y, z] = ray.direction.to_array();
    let direction = Vec3::new(normal(x), normal(y), normal(z));
    // Negative zeros are removed, too: the stack compares distances as integers.
    let t_min = ray.t_min.max(0.0) + 0.0;
    let t_max = ray.t_max.min(f32::MAX);
    // Infinities and NaN become NaN.
    let finite = ray.origin * 0.0 + ray.direction * 0.0 == Vec3::ZERO;
    // Also false if a limit is NaN.
    let some = finite && t_min <= t_max && ray.t_min <= ray.t_max;
    some.then_some(Ray {
        origin: ray.origin,
        direction,
        t_min,
        t_max,
    })
}

/// A placeholder for a hit whose values nobody reads.
const ANY_HIT: Hit = Hit {
    t: 0.0,
    instance: 0,
    primitive: 0,
    u: 0.0,
    v: 0.0,
};

/// Visits of leaves, in the space of a tree.
pub(crate) trait Leaves: Space {
    /// Offers the hits of a block of triangles.
    #[inline(always)]
    fn visit_block<V: F32x4, Q: Query>(
        &mut self,
        block: &TriangleBlock,
        triangle_ray: &TriangleLanes<V>,
        ray: &mut Ray,
        query: &mut Q,
    ) -> ControlFlow<()> {
        let sure = self.sure_limits(ray);
        let found = block.candidates(triangle_ray, ray, sure);
        if found.possible == 0 {
            return ControlFlow::Continue(());
        }
        if Q::ANYTHING && found.certain & found.within != 0 {
            return query.offer(ANY_HIT, &mut ray.t_max);
        }
        for lane in bits(found.possible) {
            if let Some(passage) = block.pass(lane, triangle_ray, found.certain)
                && passage.t >= ray.t_min
                && passage.t <= ray.t_max
            {
                let hit = Hit {
                    t: passage.t,
                    instance: 0,
                    primitive: block.primitive(lane),
                    u: passage.u,
                    v: passage.v,
                };
                self.offer(hit, ray, query)?;
            }
        }
        ControlFlow::Continue(())
    }

    /// Offers the hits of quadrics, and returns the `t_max` after them.
    #[inline(never)]
    fn visit_quadrics<Q: Query>(
        &mut self,
        quadrics: &[Quadric],
        mut ray: Ray,
        query: &mut Q,
    ) -> ControlFlow<(), f32> {
        for quadric in quadrics {
            let mut flow = ControlFlow::Continue(());
            let (primitive, whole) = (quadric.primitive, ray);
            quadric.intersect(&whole, |t, [u, v]| {
                if flow.is_continue() && t <= ray.t_max {
                    let hit = Hit {
                        t,
                        instance: 0,
                        primitive,
                        u: u as f32,
                        v: v as f32,
                    };
                    flow = self.offer(hit, &mut ray, query);
                }
            });
            flow?;
        }
        ControlFlow::Continue(ray.t_max)
    }

    /// Offers a local hit, converted to the world.
    #[inline(always)]
    fn offer<Q: Query>(&mut self, local: Hit, ray: &mut Ray, query: &mut Q) -> ControlFlow<()> {
        match self.world_hit(local) {
            Some(hit) => self.limit(ray, |t_max| query.offer(hit, t_max)),
            None => ControlFlow::Continue(()),
        }
    }
}

impl<S: Space> Leaves for S {}

//! Follows a ray through the tree, once for all instruction sets and all questions.

use std::mem::MaybeUninit;
use std::ops::ControlFlow;

use crate::builder::{MAX_DEPTH, Tree};
use crate::bvh::Bvh;
use crate::instance::{Space, World};
use crate::node::{BoxRay, Child, Node, Target, WIDTH, widen};
use crate::quadric::Quadric;
use crate::ray::{Hit, Ray};
use crate::simd::F32x4;
use crate::triangle::{TriangleBlock, TriangleRay};

/// What is asked about the hits of a ray.
pub(crate) trait Query {
    /// Whether children are visited from near to far.
    const NEAR_FIRST: bool;

    /// Takes a hit at most as far as the ray's `t_max`, which it may shorten.
    fn offer(&mut self, hit: Hit, t_max: &mut f32) -> ControlFlow<()>;
}

/// Finds the first of the accepted hits in the order of [`Hit::is_before`].
pub(crate) struct ClosestHit<F> {
    accept: F,
    pub(crate) best: Option<Hit>,
}

impl<F> ClosestHit<F> {
    pub(crate) fn new(accept: F) -> Self {
        Self { accept, best: None }
    }
}

impl<F: Fn(&Hit) -> bool> Query for ClosestHit<F> {
    const NEAR_FIRST: bool = true;

    #[inline(always)]
    fn offer(&mut self, hit: Hit, t_max: &mut f32) -> ControlFlow<()> {
        if self.best.is_none_or(|best| hit.is_before(&best)) && (self.accept)(&hit) {
            *t_max = hit.t;
            self.best = Some(hit);
        }
        ControlFlow::Continue(())
    }
}

/// Finds whether there is an accepted hit.
pub(crate) struct AnyHit<F> {
    accept: F,
    pub(crate) found: bool,
}

impl<F> AnyHit<F> {
    pub(crate) fn new(accept: F) -> Self {
        Self {
            accept,
            found: false,
        }
    }
}

impl<F: Fn(&Hit) -> bool> Query for AnyHit<F> {
    const NEAR_FIRST: bool = false;

    #[inline(always)]
    fn offer(&mut self, hit: Hit, _: &mut f32) -> ControlFlow<()> {
        self.found = (self.accept)(&hit);
        if self.found {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}

/// Finds all hits, as long as it is wanted.
pub(crate) struct EachHit<F> {
    found: F,
    pub(crate) flow: ControlFlow<()>,
}

impl<F> EachHit<F> {
    pub(crate) fn new(found: F) -> Self {
        Self {
            found,
            flow: ControlFlow::Continue(()),
        }
    }
}

impl<F: FnMut(&Hit) -> ControlFlow<()>> Query for EachHit<F> {
    const NEAR_FIRST: bool = false;

    #[inline(always)]
    fn offer(&mut self, hit: Hit, _: &mut f32) -> ControlFlow<()> {
        self.flow = (self.found)(&hit);
        self.flow
    }
}

/// Offers `query` every hit of `ray` that it could care for.
pub(crate) fn traverse<V: F32x4, Q: Query>(bvh: &Bvh, ray: &Ray, query: &mut Q) {
    let Some(ray) = clean(ray) else { return };
    if !bvh.tree.nodes.is_empty() {
        let mut walk = Walk {
            tree: &bvh.tree,
            space: World,
            ray,
        };
        // What breaks off has nothing more to ask.
        let _ = walk.run::<V, Q>(query, |index, ray, query| {
            visit_instance::<V, Q>(bvh, index, ray, query)
        });
    }
}

/// Follows the ray through the object of instance number `index`, and tells its new `t_max`. Out of
/// line, so that trees without instances do not carry it in their loop.
#[inline(never)]
fn visit_instance<V: F32x4, Q: Query>(
    bvh: &Bvh,
    index: usize,
    ray: Ray,
    query: &mut Q,
) -> ControlFlow<(), f32> {
    let placement = &bvh.placements[index];
    let (local, space) = placement.view(&ray, index as u32 + 1);
    let Some(local) = clean(&local) else {
        return ControlFlow::Continue(ray.t_max);
    };
    let mut walk = Walk {
        tree: &bvh.objects[placement.object as usize].tree,
        space,
        ray: local,
    };
    // Objects have no instances.
    walk.run::<V, Q>(query, |_, ray, _| ControlFlow::Continue(ray.t_max))?;
    ControlFlow::Continue(walk.space.t_max)
}

/// A way through one tree, in its own space.
struct Walk<'a, S> {
    tree: &'a Tree,
    space: S,
    ray: Ray,
}

impl<S: Space> Walk<'_, S> {
    /// Visits the tree, which has a root; `instance` is called for the instances on the way, and tells
    /// the `t_max` after them.
    ///
    /// Instances get a copy of the ray and a stack of their own: what no other function has the
    /// address of stays in registers.
    #[inline(always)]
    fn run<V: F32x4, Q: Query>(
        &mut self,
        query: &mut Q,
        mut instance: impl FnMut(usize, Ray, &mut Q) -> ControlFlow<(), f32>,
    ) -> ControlFlow<()> {
        let Self { tree, space, ray } = self;
        let box_ray = BoxRay::<V>::new(ray);
        let triangle_ray = TriangleRay::<V>::new(ray);
        let mut stack = Stack::new();
        let mut next = Some(Child::node(0));
        while let Some(child) = next {
            match child.target() {
                Target::Node(index) => stack.open::<V, Q>(&tree.nodes[index], &box_ray, ray.t_max),
                Target::Triangles(blocks) => {
                    for block in &tree.blocks[blocks] {
                        space.visit_block(block, &triangle_ray, ray, query)?;
                    }
                }
                Target::Quadrics(quadrics) => {
                    for quadric in &tree.quadrics[quadrics] {
                        space.visit_quadric(quadric, ray, query)?;
                    }
                }
                Target::Instance(index) => ray.t_max = instance(index, *ray, query)?,
                Target::Nothing => {}
            }
            next = stack.pop_nearer(widen(ray.t_max));
        }
        ControlFlow::Continue(())
    }
}

/// The ray in the form that the kernels assume: finite, not empty, without negative or infinite
/// `t`, and with zero for components whose reciprocal would overflow. None: it hits nothing.
fn clean(ray: &Ray) -> Option<Ray> {
    let normal = |x: f32| if x.is_normal() { x } else { 0.0 };
    let direction = ray.direction.map(normal);
    let t_min = ray.t_min.max(0.0);
    let t_max = ray.t_max.min(f32::MAX);
    let finite = ray.origin.is_finite() && ray.direction.is_finite();
    // Also false if a limit is NaN.
    let some = finite && t_min <= t_max && ray.t_min <= ray.t_max;
    some.then_some(Ray {
        origin: ray.origin,
        direction,
        t_min,
        t_max,
    })
}

/// Leaves, in the space of a tree.
trait Leaves: Space {
    /// Offers the hits of a block of triangles.
    #[inline(always)]
    fn visit_block<V: F32x4, Q: Query>(
        &mut self,
        block: &TriangleBlock,
        triangle_ray: &TriangleRay<V>,
        ray: &mut Ray,
        query: &mut Q,
    ) -> ControlFlow<()> {
        for lane in bits(block.candidates(triangle_ray)) {
            if let Some(passage) = block.pass(lane, triangle_ray)
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

    /// Offers the hits of a quadric.
    fn visit_quadric<Q: Query>(
        &mut self,
        quadric: &Quadric,
        ray: &mut Ray,
        query: &mut Q,
    ) -> ControlFlow<()> {
        let mut flow = ControlFlow::Continue(());
        let primitive = quadric.primitive;
        let whole = *ray;
        quadric.intersect(&whole, |t, [u, v]| {
            if flow.is_continue() && t <= ray.t_max {
                let hit = Hit {
                    t,
                    instance: 0,
                    primitive,
                    u: u as f32,
                    v: v as f32,
                };
                flow = self.offer(hit, ray, query);
            }
        });
        flow
    }

    /// Offers a local hit as what it is in the world.
    #[inline(always)]
    fn offer<Q: Query>(&mut self, local: Hit, ray: &mut Ray, query: &mut Q) -> ControlFlow<()> {
        match self.world_hit(local) {
            Some(hit) => self.limit(ray, |t_max| query.offer(hit, t_max)),
            None => ControlFlow::Continue(()),
        }
    }
}

impl<S: Space> Leaves for S {}

/// The numbers of the set bits, ascending.
#[inline(always)]
fn bits(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bit = (mask != 0).then_some(mask.trailing_zeros() as usize);
        mask &= mask.wrapping_sub(1);
        bit
    })
}

/// A child still to visit, and where the ray enters its box.
#[derive(Clone, Copy)]
struct Entry {
    distance: f32,
    child: Child,
}

/// Entries on the stack of a tree at most: of every node on the way all children but the one visited,
/// and at the last node that one too.
const STACK_SIZE: usize = MAX_DEPTH * (WIDTH - 1) + 1;

/// A stack without initialisation, which would cost as much as a short ray.
struct Stack {
    entries: [MaybeUninit<Entry>; STACK_SIZE],
    len: usize,
}

impl Stack {
    #[inline(always)]
    fn new() -> Self {
        Self {
            entries: [const { MaybeUninit::uninit() }; STACK_SIZE],
            len: 0,
        }
    }

    #[inline(always)]
    fn push(&mut self, entry: Entry) {
        self.entries[self.len].write(entry);
        self.len += 1;
    }

    #[inline(always)]
    fn get(&self, index: usize) -> Entry {
        debug_assert!(index < self.len, "{index} of {}", self.len);
        // SAFETY: all callers pass an index below `len`, and `push` wrote all entries below `len`.
        unsafe { self.entries[index].assume_init() }
    }

    /// Pushes the children of `node` that the ray meets.
    #[inline(always)]
    fn open<V: F32x4, Q: Query>(&mut self, node: &Node, ray: &BoxRay<V>, t_max: f32) {
        let (mask, entries) = node.intersect(ray, widen(t_max));
        let bottom = self.len;
        for slot in bits(mask) {
            self.push(Entry {
                distance: entries[slot],
                child: node.child(slot),
            });
            if Q::NEAR_FIRST {
                self.sink(bottom);
            }
        }
    }

    /// Moves the last entry down to its place in the order of falling distance, not below `bottom`.
    #[inline(always)]
    fn sink(&mut self, bottom: usize) {
        let last = self.get(self.len - 1);
        let mut place = self.len - 1;
        while place > bottom && self.get(place - 1).distance < last.distance {
            self.entries[place] = self.entries[place - 1];
            place -= 1;
        }
        self.entries[place].write(last);
    }

    /// The last child that is entered at `t_max` or before; drops those after it.
    #[inline(always)]
    fn pop_nearer(&mut self, t_max: f32) -> Option<Child> {
        while self.len > 0 {
            let entry = self.get(self.len - 1);
            self.len -= 1;
            if entry.distance <= t_max {
                return Some(entry.child);
            }
        }
        None
    }
}

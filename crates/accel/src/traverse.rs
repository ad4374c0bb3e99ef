//! Follows a ray through the tree, once for all instruction sets and all questions.

use std::mem::MaybeUninit;
use std::ops::ControlFlow;

use crate::builder::{MAX_DEPTH, Tree};
use crate::node::{BoxRay, Child, Target, WIDTH, widen};
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

/// Offers `query` every hit of `ray` that it could care for.
pub(crate) fn traverse<V: F32x4, Q: Query>(tree: &Tree, ray: &Ray, query: &mut Q) {
    let Some(mut ray) = clean(ray) else { return };
    if tree.nodes.is_empty() {
        return;
    }
    let box_ray = BoxRay::<V>::new(&ray);
    let triangle_ray = TriangleRay::<V>::new(&ray);
    let mut stack = Stack::new();
    let mut next = Some(Child::node(0));
    while let Some(child) = next {
        let flow = match child.target() {
            Target::Node(index) => {
                let node = &tree.nodes[index];
                let (mask, entries) = node.intersect(&box_ray, widen(ray.t_max));
                let bottom = stack.len;
                for slot in bits(mask) {
                    stack.push(Entry {
                        distance: entries[slot],
                        child: node.child(slot),
                    });
                    if Q::NEAR_FIRST {
                        stack.sink(bottom);
                    }
                }
                ControlFlow::Continue(())
            }
            Target::Triangles(blocks) => tree.blocks[blocks]
                .iter()
                .try_for_each(|block| visit_block(block, &triangle_ray, &mut ray, query)),
            Target::Quadrics(quadrics) => tree.quadrics[quadrics]
                .iter()
                .try_for_each(|quadric| visit_quadric(quadric, &mut ray, query)),
            Target::Nothing => ControlFlow::Continue(()),
        };
        if flow.is_break() {
            return;
        }
        next = stack.pop_nearer(widen(ray.t_max));
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

#[inline(always)]
fn visit_block<V: F32x4, Q: Query>(
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
            query.offer(hit, &mut ray.t_max)?;
        }
    }
    ControlFlow::Continue(())
}

fn visit_quadric<Q: Query>(quadric: &Quadric, ray: &mut Ray, query: &mut Q) -> ControlFlow<()> {
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
            flow = query.offer(hit, &mut ray.t_max);
        }
    });
    flow
}

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

/// Entries on the stack at most: of every node on the way all children but the one visited, and
/// at the last node that one too.
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

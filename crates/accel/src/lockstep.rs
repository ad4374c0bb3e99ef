//! Any-hit queries for many rays, eight in lockstep.
//!
//! A single ray spends most of its time waiting: for mispredicted branches after tests, and for the next node. In
//! lockstep, every ray opens one node at a time from a stack of its own. The children that it hits are packed without
//! a branch: nodes onto that stack, leaves into a queue for all rays, which is emptied every other round. A ray that
//! is done is replaced by the next.
//!
//! Boxes and leaves are visited in another order than by single rays; the results do not depend on it.

use std::array::from_fn;
use std::mem::MaybeUninit;
use std::ops::ControlFlow;

use crate::builder::{MAX_DEPTH, Tree};
use crate::bvh::Bvh;
use crate::child::{Child, Target};
use crate::instance::{Approach, World};
use crate::node::{BoxRay, WIDTH, widen};
use crate::query::Anything;
use crate::ray::Ray;
use crate::simd::{F32x8, Kernel, Simd};
use crate::stop::Stop;
use crate::traverse::{Ask, Leaves, VisitInstance, clean};
use crate::triangle::TriangleRay;

/// The number of rays in lockstep.
const RAYS: usize = 8;

/// The number of nodes that a ray opens before the queue of leaves is emptied.
const ROUNDS: usize = 2;

/// The number of triangle blocks, 640 KiB, below which caches are likely to hold all of them.
const CACHED_BLOCKS: usize = 4096;

/// Finds which of `rays` hit anything. `blocked` has as many elements, which are false.
pub(crate) struct AreBlocked<'a> {
    pub(crate) bvh: &'a Bvh,
    pub(crate) rays: &'a [Ray],
    pub(crate) blocked: &'a mut [bool],
    pub(crate) stop: Stop<'a>,
}

impl Kernel for AreBlocked<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self) {
        let Self {
            bvh,
            rays,
            blocked,
            stop,
        } = self;
        let tree = &bvh.tree;
        if tree.nodes.is_empty() {
            return;
        }
        if !S::Eight::PACKS_FAST {
            for (ray, blocked) in rays.iter().zip(blocked) {
                if stop.is_asked() {
                    return;
                }
                let query = &mut Anything { found: false };
                let ask = Ask {
                    bvh,
                    ray,
                    query,
                    stop,
                };
                ask.run::<S>();
                *blocked = query.found;
            }
            return;
        }
        let mut waiting = Waiting {
            rays,
            next: 0,
            stop,
        };
        let mut active = [const { None }; RAYS];
        let mut stacks: [_; RAYS] = from_fn(|_| NodeStack::new());
        for (ray, stack) in active.iter_mut().zip(&mut stacks) {
            *ray = waiting.start(tree, stack);
        }
        let mut leaves = LeafQueue::new();
        while active.iter().any(Option::is_some) {
            for _ in 0..ROUNDS {
                for (number, (ray, stack)) in active.iter().zip(&mut stacks).enumerate() {
                    if let Some(ray) = ray {
                        ray.open_next::<S>(tree, stack, number, &mut leaves);
                    }
                }
            }
            let found = leaves.visit_all::<S>(bvh, stop, &active);
            for (number, (ray, stack)) in active.iter_mut().zip(&mut stacks).enumerate() {
                let is_blocked = found >> number & 1 == 1;
                if let Some(done) = ray
                    && (is_blocked || stack.is_empty())
                {
                    blocked[done.number] = is_blocked;
                    *ray = waiting.start(tree, stack);
                }
            }
        }
    }
}

/// The rays that have not started yet.
struct Waiting<'a> {
    rays: &'a [Ray],
    next: usize,
    stop: Stop<'a>,
}

impl Waiting<'_> {
    /// Returns the next ray that may hit something, and pushes the root onto its stack. None: no ray is left, or the
    /// host asked to stop.
    #[inline(always)]
    fn start(&mut self, tree: &Tree, stack: &mut NodeStack) -> Option<ActiveRay> {
        stack.clear();
        if self.stop.is_asked() {
            return None;
        }
        while let Some(ray) = self.rays.get(self.next) {
            let number = self.next;
            self.next += 1;
            if let Some(ray) = clean(ray) {
                stack.push_root();
                return Some(ActiveRay {
                    ray,
                    limit: widen(ray.t_max),
                    box_ray: BoxRay::new(&ray, tree.reach),
                    triangle_ray: TriangleRay::new(&ray),
                    number,
                });
            }
        }
        None
    }
}

/// A ray in lockstep.
struct ActiveRay {
    ray: Ray,
    /// The largest distance at which a box must be entered.
    limit: f32,
    box_ray: BoxRay,
    triangle_ray: TriangleRay,
    /// The number of the ray.
    number: usize,
}

impl ActiveRay {
    /// Opens a node from `stack`, if there is one, and packs the children that the ray hits. `place` is the index of
    /// the ray among those in lockstep.
    #[inline(always)]
    fn open_next<S: Simd>(
        &self,
        tree: &Tree,
        stack: &mut NodeStack,
        place: usize,
        leaves: &mut LeafQueue,
    ) {
        let Some(index) = stack.pop() else { return };
        let node = tree.node(index);
        let (met, _) = node.intersect(&self.box_ray.lanes::<S::Eight>(), self.limit);
        let children = Child::all_bits(node.children());
        let are_leaves = S::Eight::upper_two(children);
        stack.push_all::<S>(met & !are_leaves, children);
        tree.prefetch(Child::node(stack.top()));
        leaves.push_all::<S>(met & are_leaves, children, place);
    }

    /// Returns true if the ray hits something in the leaf `child`.
    #[inline(always)]
    fn is_blocked_in<S: Simd>(&self, bvh: &Bvh, stop: Stop<'_>, child: Child) -> bool {
        let (mut ray, mut query) = (self.ray, Anything { found: false });
        if let Some((first, count)) = child.as_triangles() {
            let triangle_ray = self.triangle_ray.lanes::<S::Four>();
            for block in bvh.tree.blocks(first, count) {
                let flow = World.visit_block(block, &triangle_ray, &mut ray, &mut query);
                if flow.is_break() {
                    return true;
                }
            }
            return false;
        }
        let flow = match child.target() {
            Target::Quadrics(leaf) => {
                World.visit_quadrics(&bvh.tree.quadrics[leaf], ray, &mut query)
            }
            Target::Instance(index) => {
                let visit = VisitInstance {
                    bvh,
                    index,
                    approach: &Approach::new(&ray),
                    ray,
                    query: &mut query,
                    stop,
                };
                // SAFETY: this is a kernel of the same set, so the machine has it.
                unsafe { S::call(visit) }
            }
            _ => ControlFlow::Continue(ray.t_max),
        };
        flow.is_break()
    }
}

/// The nodes that a ray has still to open, the next one last.
struct NodeStack {
    /// The first is the root. It stays, so that there is always a top to prefetch.
    nodes: [MaybeUninit<u32>; Self::SIZE],
    len: usize,
}

impl NodeStack {
    /// The size: the first entry; for each node on the path all children but the opened one, and at the last node
    /// that one, too; and the words that are written after the valid ones.
    const SIZE: usize = 1 + MAX_DEPTH * (WIDTH - 1) + 1 + WIDTH;

    // This is a function, because every use of a constant would copy all words, even uninitialised ones.
    #[inline(always)]
    fn new() -> Self {
        Self {
            nodes: [const { MaybeUninit::uninit() }; Self::SIZE],
            len: 0,
        }
    }

    #[inline(always)]
    fn clear(&mut self) {
        self.nodes[0].write(0);
        self.len = 1;
    }

    #[inline(always)]
    fn push_root(&mut self) {
        self.nodes[1].write(0);
        self.len = 2;
    }

    #[inline(always)]
    fn is_empty(&self) -> bool {
        self.len <= 1
    }

    #[inline(always)]
    fn top(&self) -> usize {
        debug_assert!((1..=Self::SIZE).contains(&self.len), "{}", self.len);
        // SAFETY: `clear` is called first, so that there is an entry, and all entries below `len` were written.
        unsafe { self.nodes.get_unchecked(self.len - 1).assume_init() as usize }
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<usize> {
        if self.is_empty() {
            return None;
        }
        let top = self.top();
        self.len -= 1;
        Some(top)
    }

    /// Pushes the `nodes` whose bit in `mask` is set.
    #[inline(always)]
    fn push_all<S: Simd>(&mut self, mask: u32, nodes: &[u32; WIDTH]) {
        // SAFETY: the builder makes no tree deeper than `MAX_DEPTH`, for which `SIZE` suffices.
        S::Eight::pack(mask, nodes, unsafe {
            eight_from(&mut self.nodes, self.len)
        });
        self.len += mask.count_ones() as usize;
    }
}

/// The leaves that rays have still to visit.
struct LeafQueue {
    leaves: [MaybeUninit<u32>; Self::SIZE],
    /// For each leaf, the index of its ray among those in lockstep.
    places: [MaybeUninit<u8>; Self::SIZE],
    len: usize,
}

impl LeafQueue {
    /// The size: all children of the nodes that are opened before the queue is emptied, and the words that are
    /// written after them.
    const SIZE: usize = RAYS * ROUNDS * WIDTH + WIDTH;

    #[inline(always)]
    fn new() -> Self {
        Self {
            leaves: [const { MaybeUninit::uninit() }; Self::SIZE],
            places: [const { MaybeUninit::uninit() }; Self::SIZE],
            len: 0,
        }
    }

    /// Adds the `leaves` whose bit in `mask` is set.
    #[inline(always)]
    fn push_all<S: Simd>(&mut self, mask: u32, leaves: &[u32; WIDTH], place: usize) {
        // SAFETY: the queue is emptied before more is pushed than `SIZE` has room for.
        unsafe {
            S::Eight::pack(mask, leaves, eight_from(&mut self.leaves, self.len));
            *eight_from(&mut self.places, self.len) = [MaybeUninit::new(place as u8); WIDTH];
        }
        self.len += mask.count_ones() as usize;
    }

    /// Begins to load all leaves, unless the caches are likely to hold them.
    #[inline(always)]
    fn load_ahead(&self, tree: &Tree) {
        if tree.blocks.len() < CACHED_BLOCKS {
            return;
        }
        for leaf in &self.leaves[..self.len] {
            // SAFETY: all entries below `len` were written.
            tree.prefetch(Child::from_bits(unsafe { leaf.assume_init() }));
        }
    }

    /// Visits all leaves, and empties the queue. Returns a bit for each ray in lockstep: 1 if it is blocked.
    #[inline(always)]
    fn visit_all<S: Simd>(
        &mut self,
        bvh: &Bvh,
        stop: Stop<'_>,
        active: &[Option<ActiveRay>; RAYS],
    ) -> u32 {
        self.load_ahead(&bvh.tree);
        let mut blocked = 0_u32;
        for index in 0..self.len {
            // SAFETY: all entries below `len` were written.
            let (leaf, place) = unsafe {
                let leaf = self.leaves.get_unchecked(index).assume_init();
                (leaf, self.places.get_unchecked(index).assume_init())
            };
            let place = usize::from(place) % RAYS;
            if blocked >> place & 1 == 0
                && let Some(ray) = &active[place]
                && ray.is_blocked_in::<S>(bvh, stop, Child::from_bits(leaf))
            {
                blocked |= 1 << place;
            }
        }
        self.len = 0;
        blocked
    }
}

/// Returns the eight elements from `first` on.
///
/// # Safety
///
/// `first + WIDTH` is at most `N`.
#[inline(always)]
unsafe fn eight_from<T, const N: usize>(array: &mut [T; N], first: usize) -> &mut [T; WIDTH] {
    debug_assert!(first + WIDTH <= N, "{first} of {N}");
    // SAFETY: see above.
    unsafe { &mut *array.as_mut_ptr().add(first).cast() }
}

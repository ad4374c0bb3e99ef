//! The stack of children that a ray still has to visit.

use std::mem::MaybeUninit;

use crate::builder::{MAX_DEPTH, Tree};
use crate::child::Child;
use crate::node::{BoxLanes, Node, WIDTH};
use crate::simd::Simd;

/// The largest number of entries on the stack of a tree: of each node on the path all children but the visited one,
/// and at the last node that one, too.
const STACK_SIZE: usize = MAX_DEPTH * (WIDTH - 1) + 1;

/// The children still to visit, the next one last.
///
/// An entry is a word: the bits of the distance at which the ray enters the child's box, above the bits of the child.
/// Distances are not negative, so that words compare as distances do. Entries are not initialised: that would cost as
/// much as a short ray.
pub(crate) struct Stack {
    entries: [MaybeUninit<u64>; STACK_SIZE],
    len: usize,
}

impl Stack {
    #[inline(always)]
    pub(crate) fn new() -> Self {
        Self {
            entries: [const { MaybeUninit::uninit() }; STACK_SIZE],
            len: 0,
        }
    }

    #[inline(always)]
    fn push(&mut self, entry: u64) {
        debug_assert!(self.len < STACK_SIZE, "the tree is too deep");
        // SAFETY: the builder makes no tree deeper than `MAX_DEPTH`, which `STACK_SIZE` suffices for.
        unsafe { self.entries.get_unchecked_mut(self.len) }.write(entry);
        self.len += 1;
    }

    /// Pushes an entry that will be visited soon, and begins to load its child.
    #[inline(always)]
    fn push_ahead(&mut self, tree: &Tree, entry: u64) {
        tree.prefetch(child(entry));
        self.push(entry);
    }

    #[inline(always)]
    fn get(&self, index: usize) -> u64 {
        debug_assert!(index < self.len, "{index} of {}", self.len);
        // SAFETY: all callers pass an index below `len`, and `push` wrote all entries below `len`.
        unsafe { self.entries.get_unchecked(index).assume_init() }
    }

    /// Finds the children of `node` that the ray hits up to `limit`. Returns the one to visit next, and pushes the
    /// others.
    #[inline(always)]
    pub(crate) fn open<S: Simd>(
        &mut self,
        tree: &Tree,
        node: &Node,
        ray: &BoxLanes<S::Eight>,
        limit: f32,
    ) -> Option<Child> {
        let (mask, distances) = node.intersect(ray, limit);
        let mut slots = bits(mask);
        let first = slots.next()?;
        // Of most nodes a ray hits one child, or none.
        let Some(second) = slots.next() else {
            return Some(node.child(first));
        };
        let entries = node.entries(distances);
        let (first, second) = (entries[first % WIDTH], entries[second % WIDTH]);
        let bottom = self.len;
        self.push_ahead(tree, first.max(second));
        let mut last = first.min(second);
        for slot in slots {
            let entry = entries[slot % WIDTH];
            self.push_ahead(tree, last.max(entry));
            last = last.min(entry);
            self.sink(bottom);
        }
        Some(child(last))
    }

    /// Moves the last entry down to its place in the order of falling distance, but not below `bottom`.
    #[inline(always)]
    fn sink(&mut self, bottom: usize) {
        let last = self.get(self.len - 1);
        let mut place = self.len - 1;
        while place > bottom && self.get(place - 1) < last {
            self.put(place, self.get(place - 1));
            place -= 1;
        }
        self.put(place, last);
    }

    #[inline(always)]
    fn put(&mut self, index: usize, entry: u64) {
        debug_assert!(index < self.len, "{index} of {}", self.len);
        // SAFETY: as in `get`.
        unsafe { self.entries.get_unchecked_mut(index) }.write(entry);
    }

    /// Pops the last child that the ray enters at `limit` or before, and the entries after it.
    #[inline(always)]
    pub(crate) fn pop(&mut self, limit: f32) -> Option<Child> {
        let limit = u64::from(limit.to_bits()) << 32 | u64::from(u32::MAX);
        while self.len > 0 {
            let entry = self.get(self.len - 1);
            self.len -= 1;
            if entry <= limit {
                return Some(child(entry));
            }
        }
        None
    }
}

/// Returns the child of an entry.
#[inline(always)]
fn child(entry: u64) -> Child {
    Child::from_bits(entry as u32)
}

/// Returns the positions of the set bits, ascending.
#[inline(always)]
pub(crate) fn bits(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bit = (mask != 0).then_some(mask.trailing_zeros() as usize);
        mask &= mask.wrapping_sub(1);
        bit
    })
}

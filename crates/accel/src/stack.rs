//! What a ray still has to visit.

use std::mem::MaybeUninit;

use crate::builder::MAX_DEPTH;
use crate::node::{BoxRay, Child, Node, WIDTH};
use crate::query::Query;
use crate::simd::Simd;

/// Entries on the stack of a tree at most: of every node on the way all children but the one visited,
/// and at the last node that one too.
const STACK_SIZE: usize = MAX_DEPTH * (WIDTH - 1) + 1;

/// Children still to visit, the next one last.
///
/// An entry is a word: the bits of the distance at which the ray enters the child's box, above those
/// of the child. Distances are not negative, so that words compare as distances do.
/// Without initialisation, which would cost as much as a short ray.
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
        self.entries[self.len].write(entry);
        self.len += 1;
    }

    #[inline(always)]
    fn get(&self, index: usize) -> u64 {
        debug_assert!(index < self.len, "{index} of {}", self.len);
        // SAFETY: all callers pass an index below `len`, and `push` wrote all entries below `len`.
        unsafe { self.entries[index].assume_init() }
    }

    /// Finds the children of `node` that the ray meets up to `t_max`; returns the one to visit next
    /// and pushes the others.
    #[inline(always)]
    pub(crate) fn open<S: Simd, Q: Query>(
        &mut self,
        node: &Node,
        ray: &BoxRay<S::Eight>,
        t_max: f32,
    ) -> Option<Child> {
        let (mask, entries) = node.intersect(ray, t_max);
        let mut slots = bits(mask);
        let first = entries[slots.next()? % WIDTH];
        let Some(second) = slots.next() else {
            return Some(child(first));
        };
        let second = entries[second % WIDTH];
        if !Q::NEAR_FIRST {
            self.push(first);
            let mut last = second;
            for slot in slots {
                self.push(last);
                last = entries[slot % WIDTH];
            }
            return Some(child(last));
        }
        let bottom = self.len;
        self.push(first.max(second));
        let mut last = first.min(second);
        for slot in slots {
            let entry = entries[slot % WIDTH];
            self.push(last.max(entry));
            last = last.min(entry);
            self.sink(bottom);
        }
        Some(child(last))
    }

    /// Moves the last entry down to its place in the order of falling distance, not below `bottom`.
    #[inline(always)]
    fn sink(&mut self, bottom: usize) {
        let last = self.get(self.len - 1);
        let mut place = self.len - 1;
        while place > bottom && self.get(place - 1) < last {
            self.entries[place] = self.entries[place - 1];
            place -= 1;
        }
        self.entries[place].write(last);
    }

    /// The last child that is entered at `t_max` or before; drops those after it.
    #[inline(always)]
    pub(crate) fn pop<Q: Query>(&mut self, t_max: f32) -> Option<Child> {
        let limit = u64::from(t_max.to_bits()) << 32 | u64::from(u32::MAX);
        while self.len > 0 {
            let entry = self.get(self.len - 1);
            self.len -= 1;
            if !Q::NEAR_FIRST || entry <= limit {
                return Some(child(entry));
            }
        }
        None
    }
}

/// The child of an entry.
#[inline(always)]
fn child(entry: u64) -> Child {
    Child::from_bits(entry as u32)
}

/// The numbers of the set bits, ascending.
#[inline(always)]
pub(crate) fn bits(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bit = (mask != 0).then_some(mask.trailing_zeros() as usize);
        mask &= mask.wrapping_sub(1);
        bit
    })
}

//! The children in the slots of a node.

use std::ops::Range;

use crate::node::WIDTH;

/// The child in a node's slot, in 32 bits.
///
/// From the top: two bits of kind, then either 30 bits of a node's index, or three bits of a leaf's
/// length less one and 27 bits of its first element. An instance is a leaf of length one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(transparent)]
pub(crate) struct Child(u32);

/// A [`Child`], unpacked.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Target {
    /// The node of this index.
    Node(usize),
    /// A leaf: these triangle blocks.
    Triangles(Range<usize>),
    /// A leaf: these quadrics.
    Quadrics(Range<usize>),
    /// A leaf: the instance of this number.
    Instance(usize),
    /// An unused slot.
    Nothing,
}

impl Child {
    pub(crate) const NOTHING: Self = Self(u32::MAX);
    /// The number of elements (triangle blocks or quadrics) of the largest leaf.
    pub(crate) const MAX_LEAF: usize = 8;
    /// One more than the largest first element of a leaf.
    pub(crate) const MAX_ELEMENTS: usize = 1 << Self::LENGTH_SHIFT;

    const KIND_SHIFT: u32 = 30;
    const LENGTH_SHIFT: u32 = 27;

    pub(crate) const fn node(index: usize) -> Self {
        Self(index as u32)
    }

    pub(crate) fn triangles(blocks: &Range<usize>) -> Self {
        Self::leaf(1, blocks)
    }

    pub(crate) fn quadrics(quadrics: &Range<usize>) -> Self {
        Self::leaf(2, quadrics)
    }

    pub(crate) const fn instance(index: usize) -> Self {
        Self(3 << Self::KIND_SHIFT | index as u32)
    }

    fn leaf(kind: u32, elements: &Range<usize>) -> Self {
        debug_assert!(
            (1..=Self::MAX_LEAF).contains(&elements.len()),
            "leaf of {elements:?}"
        );
        let length = (elements.len() - 1) as u32;
        Self(kind << Self::KIND_SHIFT | length << Self::LENGTH_SHIFT | elements.start as u32)
    }

    /// Makes a child from the word that holds it.
    #[inline(always)]
    pub(crate) fn from_bits(bits: u32) -> Self {
        Self(bits)
    }

    /// Returns the index of the node. None: it is not a node.
    #[inline(always)]
    pub(crate) fn as_node(self) -> Option<usize> {
        (self.0 >> Self::KIND_SHIFT == 0).then_some(self.0 as usize)
    }

    /// Returns the first triangle block, and the number of blocks. None: it is not a leaf of triangles.
    #[inline(always)]
    pub(crate) fn as_triangles(self) -> Option<(usize, usize)> {
        (self.0 >> Self::KIND_SHIFT == 1).then_some(self.elements())
    }

    /// Returns the first element of a leaf, and the number of its elements.
    #[inline(always)]
    fn elements(self) -> (usize, usize) {
        let length = (self.0 >> Self::LENGTH_SHIFT) as usize % Self::MAX_LEAF + 1;
        (self.0 as usize % Self::MAX_ELEMENTS, length)
    }

    #[inline(always)]
    pub(crate) fn all_bits(children: &[Self; WIDTH]) -> &[u32; WIDTH] {
        // SAFETY: a child is a `u32` without any addition (`repr(transparent)`).
        unsafe { &*std::ptr::from_ref(children).cast() }
    }

    #[inline(always)]
    pub(crate) fn target(self) -> Target {
        let kind = self.0 >> Self::KIND_SHIFT;
        if kind == 0 {
            return Target::Node(self.0 as usize);
        }
        let (first, length) = self.elements();
        match kind {
            1 => Target::Triangles(first..first + length),
            2 => Target::Quadrics(first..first + length),
            _ if self == Self::NOTHING => Target::Nothing,
            _ => Target::Instance(first),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn child_round_trips() {
        let last = Child::MAX_ELEMENTS - 1;
        assert_eq!(Child::node(last).target(), Target::Node(last));
        assert_eq!(
            Child::triangles(&(5..13)).target(),
            Target::Triangles(5..13)
        );
        assert_eq!(
            Child::quadrics(&(last..last + 1)).target(),
            Target::Quadrics(last..last + 1)
        );
        assert_eq!(Child::instance(last).target(), Target::Instance(last));
        assert_eq!(Child::NOTHING.target(), Target::Nothing);
    }
}

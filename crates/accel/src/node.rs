//! Inner nodes: eight boxes side by side, tested conservatively.
//!
//! A ray is inside a slab between `(near - o)·(1/d)` and `(far - o)·(1/d)`, and inside a box where it
//! is inside all three. In units of `ε` (half of `f32::EPSILON`), the relative error of an entry is
//! at most 3 (difference, reciprocal, product) and so is that of an exit; multiplying the exit
//! by `1 + 8ε`, which rounds once more, makes up for both [Ize13].
//! Where the direction's component is zero, its reciprocal is infinite: the slab is then either
//! missed, or entered at `-∞` and left at `∞`, or the ray lies in one of its planes, and the NaN of
//! `0·∞` stands for "no limit" because of how [`F32x8::min`] and [`F32x8::max`] treat it.
//!
//! [Ize13]: https://jcgt.org/published/0002/02/02/

use std::ops::Range;

use glam::Vec3;

use crate::aabb::Aabb;
use crate::ray::Ray;
use crate::simd::F32x8;

/// Children of a [`Node`].
pub(crate) const WIDTH: usize = 8;

/// `1 + 8ε`: what an exit is multiplied by.
const WIDENING: f32 = 1.0 + 4.0 * f32::EPSILON;

/// The largest distance at which a box must still be entered to find all hits up to `t_max`.
pub(crate) fn widen(t_max: f32) -> f32 {
    t_max * WIDENING
}

/// An inner node.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct Node {
    /// `[2·axis + side][child]`, with side 0 the minimum; an empty box where there is no child.
    planes: [[f32; WIDTH]; 6],
    children: [Child; WIDTH],
}

impl Node {
    pub(crate) const EMPTY: Self = {
        const LOW: [f32; WIDTH] = [f32::INFINITY; WIDTH];
        const HIGH: [f32; WIDTH] = [f32::NEG_INFINITY; WIDTH];
        Self {
            planes: [LOW, HIGH, LOW, HIGH, LOW, HIGH],
            children: [Child::NOTHING; WIDTH],
        }
    };

    pub(crate) fn set(&mut self, slot: usize, bounds: &Aabb, child: Child) {
        for axis in 0..3 {
            self.planes[2 * axis][slot] = bounds.min[axis];
            self.planes[2 * axis + 1][slot] = bounds.max[axis];
        }
        self.children[slot] = child;
    }

    #[inline(always)]
    pub(crate) fn child(&self, slot: usize) -> Child {
        self.children[slot]
    }

    pub(crate) fn children_mut(&mut self) -> &mut [Child; WIDTH] {
        &mut self.children
    }

    pub(crate) fn bounds(&self, slot: usize) -> Aabb {
        let corner = |side: usize| Vec3::from_array([0, 2, 4].map(|i| self.planes[i + side][slot]));
        Aabb {
            min: corner(0),
            max: corner(1),
        }
    }

    /// Which boxes the ray meets at distances up to `t_max` (already [widened](widen)).
    ///
    /// A mask with the bit of each box, and per box a word: the bits of the distance at which it is
    /// entered, above those of the child.
    #[inline(always)]
    pub(crate) fn intersect<V: F32x8>(&self, ray: &BoxRay<V>, t_max: f32) -> (u32, [u64; WIDTH]) {
        let mut entry = ray.t_min;
        let mut exit = V::splat(t_max);
        for axis in 0..3 {
            let (near, far) = (ray.near[axis], ray.near[axis] ^ 1);
            let distance = |plane: usize| V::load(&self.planes[plane]) - ray.origin[axis];
            // The distance comes first: if it is NaN, the limit so far stays.
            entry = (distance(near) * ray.inverse[axis]).max(entry);
            exit = (distance(far) * ray.inverse_widened[axis]).min(exit);
        }
        (entry.le(exit), entry.over(Child::all_bits(&self.children)))
    }
}

/// A ray made ready for boxes.
pub(crate) struct BoxRay<V> {
    origin: [V; 3],
    inverse: [V; 3],
    inverse_widened: [V; 3],
    t_min: V,
    /// The row of [`Node::planes`] that the ray meets first, per axis.
    near: [usize; 3],
}

impl<V: F32x8> BoxRay<V> {
    pub(crate) fn new(ray: &Ray) -> Self {
        let inverse = ray.direction.recip().to_array();
        Self {
            origin: ray.origin.to_array().map(V::splat),
            inverse: inverse.map(V::splat),
            inverse_widened: inverse.map(|x| V::splat(x * WIDENING)),
            t_min: V::splat(ray.t_min),
            near: [0, 1, 2].map(|axis| 2 * axis + usize::from(inverse[axis].is_sign_negative())),
        }
    }
}

/// What a node's slot leads to, in 32 bits.
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
    /// Elements (triangle blocks or quadrics) of the largest leaf.
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

    /// A child from the word that holds it.
    #[inline(always)]
    pub(crate) fn from_bits(bits: u32) -> Self {
        Self(bits)
    }

    #[inline(always)]
    fn all_bits(children: &[Self; WIDTH]) -> &[u32; WIDTH] {
        // SAFETY: a child is a `u32` without any addition (`repr(transparent)`).
        unsafe { &*std::ptr::from_ref(children).cast() }
    }

    #[inline(always)]
    pub(crate) fn target(self) -> Target {
        let kind = self.0 >> Self::KIND_SHIFT;
        if kind == 0 {
            return Target::Node(self.0 as usize);
        }
        let first = self.0 as usize % Self::MAX_ELEMENTS;
        let length = (self.0 >> Self::LENGTH_SHIFT) as usize % Self::MAX_LEAF + 1;
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
    use crate::simd::{Pair, Scalar4};

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

    #[track_caller]
    fn check_met(bounds: Aabb, origin: [f32; 3], direction: [f32; 3], expected: u32) {
        let mut node = Node::EMPTY;
        node.set(5, &bounds, Child::node(0));
        let ray = Ray::new(Vec3::from_array(origin), Vec3::from_array(direction));
        let (mask, _) = node.intersect(&BoxRay::<Pair<Scalar4>>::new(&ray), f32::INFINITY);
        assert_eq!(mask, expected << 5);
    }

    #[test]
    fn rays_in_planes_and_along_axes() {
        let unit = Aabb {
            min: Vec3::ZERO,
            max: Vec3::ONE,
        };
        check_met(unit, [0.5, 0.5, -1.0], [0.0, 0.0, 1.0], 1);
        check_met(unit, [0.5, 0.5, -1.0], [-0.0, -0.0, 1.0], 1);
        check_met(unit, [0.5, 0.5, -1.0], [0.0, 0.0, -1.0], 0);
        check_met(unit, [1.5, 0.5, -1.0], [0.0, 0.0, 1.0], 0);
        // In the planes x = 0 and x = 1, along an edge, and through a corner.
        check_met(unit, [0.0, 0.5, -1.0], [0.0, 0.0, 1.0], 1);
        check_met(unit, [1.0, 0.5, -1.0], [-0.0, 0.0, 1.0], 1);
        check_met(unit, [1.0, 1.0, -1.0], [0.0, 0.0, 1.0], 1);
        check_met(unit, [-1.0, -1.0, -1.0], [1.0, 1.0, 1.0], 1);
        // A flat box, seen edge-on from inside its plane.
        let flat = Aabb {
            min: Vec3::ZERO,
            max: Vec3::new(1.0, 0.0, 1.0),
        };
        check_met(flat, [0.5, 0.0, -1.0], [0.0, 0.0, 1.0], 1);
        check_met(flat, [0.5, 1e-30, -1.0], [0.0, 0.0, 1.0], 0);
    }
}

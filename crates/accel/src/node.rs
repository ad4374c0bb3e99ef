//! Inner nodes: eight boxes side by side, tested conservatively.
//!
//! A ray is inside a slab between `(near - o)/d` and `(far - o)/d`, and inside a box if it is inside all three slabs.
//! With `r = 1/d` that is computed as `near·r - o·r`: one fused operation on many machines.
//!
//! **Rounding.** Let `ε` be half of `f32::EPSILON`. `o·r`, its sum with `e` below and the product `near·r`
//! lose at most `3ε|o·r|` together, which `e = 4ε|o·r|` makes up for: entries are computed with `o·r + e`,
//! exits with `o·r - e`. In space that widens a box by `4ε|o|`. Other errors are relative to the distance: an
//! entry is too late by at most `3ε` of it (reciprocal, product, difference), an exit too early by `4ε`;
//! multiplying the exit by `1 + 16ε` makes up for both [Ize13].
//!
//! **Rays parallel to a plane, or nearly.** All that can be hit lies within `s` of the origin, along each
//! axis, hence at `t ≤ T = (s + |o|)/max|d|`. If `|d| < δ/T`, the ray stays within `δ` of its
//! origin's plane all the while: such a component counts as `±δ/T`, entries are `T` earlier and exits `T`
//! later. Then a slab that the ray is in stays open until `T`, and one that is `2δ` away is missed. The
//! code takes `2⁻²³·(s + |o|)` for `δ`.
//!
//! An axis along which anything overflows has no limits. Then a number is NaN only for an empty box, and an exit is
//! zero only if the ray leaves before its origin.
//!
//! [Ize13]: https://jcgt.org/published/0002/02/02/

use glam::{Vec3, Vec3A};

use crate::aabb::Aabb;
use crate::child::Child;
use crate::ray::Ray;
use crate::simd::F32x8;

/// The number of children of a [`Node`].
pub(crate) const WIDTH: usize = 8;

/// `1 + 16ε`: the factor of an exit.
const WIDENING: f32 = 1.0 + 8.0 * f32::EPSILON;

/// Returns the largest distance at which a box must be entered to find all hits up to `t_max`. For `t_max` above a
/// tenth of the largest `f32` it is infinite, because products on the way to a distance could overflow.
#[inline(always)]
pub(crate) fn widen(t_max: f32) -> f32 {
    if t_max < 0.1 * f32::MAX {
        // Adding zero removes the sign of a negative zero, which would matter to comparisons of bits.
        t_max * WIDENING + 0.0
    } else {
        f32::INFINITY
    }
}

/// An inner node.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct Node {
    /// The planes of boxes, by `[2·axis + side][child]`; side 0 is the minimum. An unused slot has an empty box.
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
        self.children[slot % WIDTH]
    }

    #[inline(always)]
    pub(crate) fn children(&self) -> &[Child; WIDTH] {
        &self.children
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

    /// Returns the children in use, each with its box.
    pub(crate) fn boxes(&self) -> Vec<(Aabb, Child)> {
        let slots = (0..WIDTH).filter(|&slot| self.children[slot] != Child::NOTHING);
        slots
            .map(|slot| (self.bounds(slot), self.children[slot]))
            .collect()
    }

    /// Returns a mask of the boxes that the ray hits at distances up to `limit` (from [`widen`]), and the distances
    /// at which it enters them.
    #[inline(always)]
    pub(crate) fn intersect<V: F32x8>(&self, ray: &BoxLanes<V>, limit: f32) -> (u32, V) {
        let plane = |axis: usize, side: usize| {
            debug_assert!(side < 2, "side {side}");
            // SAFETY: there are two rows for each of three axes.
            V::load(unsafe { self.planes.get_unchecked(2 * axis + side) })
        };
        let entry = |axis: usize| {
            let ray = &ray.axes[axis];
            plane(axis, ray.near).mul_sub(ray.inverse, ray.entry_offset)
        };
        let exit = |axis: usize| {
            let ray = &ray.axes[axis];
            plane(axis, ray.near ^ 1).mul_sub(ray.inverse_widened, ray.exit_offset)
        };
        // Of two negative numbers, `max` and `min` may return either: `t_min` is not negative, and a negative exit is
        // a miss.
        let entry = entry(0).max(entry(1)).max(entry(2).max(ray.t_min));
        let exit = exit(0).min(exit(1)).min(exit(2).min(V::splat(limit)));
        (entry.le(exit), entry)
    }

    /// Returns a word for each box: the bits of its distance above the bits of its child.
    #[inline(always)]
    pub(crate) fn entries<V: F32x8>(&self, distances: V) -> [u64; WIDTH] {
        distances.over(Child::all_bits(&self.children))
    }
}

/// A ray prepared for tests against boxes.
#[derive(Clone, Copy)]
pub(crate) struct BoxRay {
    axes: [AxisRay<f32>; 3],
    t_min: f32,
}

impl BoxRay {
    /// Prepares a ray; `reach` is the largest absolute coordinate of anything that can be hit.
    #[inline(always)]
    pub(crate) fn new(ray: &Ray, reach: f32) -> Self {
        let (origin, direction) = (Vec3A::from(ray.origin), Vec3A::from(ray.direction));
        // The factor leaves room for the rounding below.
        let largest = direction.abs().max_element();
        let last = 1.001 * (reach + origin.abs().max_element()) / largest;
        let steepest = Vec3A::splat(STEEPEST / largest);
        let inverse = direction.recip();
        let is_parallel = inverse.abs().cmpgt(steepest);
        let early = Vec3A::select(is_parallel, Vec3A::splat(last), Vec3A::ZERO);
        let inverse = Vec3A::select(is_parallel, steepest.copysign(inverse), inverse);
        let widened = inverse * WIDENING;
        let least = Vec3A::splat(f32::MIN_POSITIVE) + early;
        let slack = |offset: Vec3A| 2.0 * f32::EPSILON * offset.abs() + least;
        let (entry, exit) = (origin * inverse, origin * widened);
        let (entry, exit) = (entry + slack(entry), exit - slack(exit));
        // It is not zero if a number is infinite or NaN.
        let zero = inverse * 0.0 + widened * 0.0 + entry * 0.0 + exit * 0.0;
        let is_finite = zero.cmpeq(Vec3A::ZERO);
        let or = |value: Vec3A, limitless: f32| {
            Vec3A::select(is_finite, value, Vec3A::splat(limitless)).to_array()
        };
        let (inverse, widened) = (or(inverse, 0.0), or(widened, 0.0));
        let (entry, exit) = (or(entry, f32::MAX), or(exit, f32::MIN));
        let negative = direction.is_negative_bitmask();
        let axis = |axis: usize| AxisRay {
            inverse: inverse[axis],
            entry_offset: entry[axis],
            inverse_widened: widened[axis],
            exit_offset: exit[axis],
            near: (negative >> axis & 1) as usize,
        };
        Self {
            // Written out, as `array::map` is not always inlined.
            axes: [axis(0), axis(1), axis(2)],
            t_min: ray.t_min,
        }
    }

    /// Returns the ray with its numbers in all lanes.
    #[inline(always)]
    pub(crate) fn lanes<V: F32x8>(&self) -> BoxLanes<V> {
        let axis = |axis: usize| {
            let ray = &self.axes[axis];
            AxisRay {
                inverse: V::splat(ray.inverse),
                entry_offset: V::splat(ray.entry_offset),
                inverse_widened: V::splat(ray.inverse_widened),
                exit_offset: V::splat(ray.exit_offset),
                near: ray.near,
            }
        };
        BoxLanes {
            axes: [axis(0), axis(1), axis(2)],
            t_min: V::splat(self.t_min),
        }
    }
}

/// `T/δ`, times the direction's largest component.
const STEEPEST: f32 = 1.001 * (1 << 23) as f32;

/// A [`BoxRay`] against eight boxes.
pub(crate) struct BoxLanes<V> {
    axes: [AxisRay<V>; 3],
    t_min: V,
}

/// The numbers of a [`BoxRay`] for slabs along one axis.
#[derive(Clone, Copy)]
struct AxisRay<V> {
    inverse: V,
    entry_offset: V,
    inverse_widened: V,
    exit_offset: V,
    /// The plane that the ray reaches first: 0 or 1.
    near: usize,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::{Pair, Scalar4};

    #[track_caller]
    fn check_met(bounds: Aabb, origin: [f32; 3], direction: [f32; 3], expected: u32) {
        let mut node = Node::EMPTY;
        node.set(5, &bounds, Child::node(0));
        let ray = Ray::new(Vec3::from_array(origin), Vec3::from_array(direction));
        let lanes = BoxRay::new(&ray, 2.0).lanes::<Pair<Scalar4>>();
        let (mask, _) = node.intersect(&lanes, f32::INFINITY);
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
        check_met(flat, [0.5, 1e-5, -1.0], [0.0, 0.0, 1.0], 0);
        check_met(flat, [0.5, 1e-5, -1.0], [0.0, 1e-30, 1.0], 0);
        check_met(flat, [0.5, -1e-5, -1.0], [0.0, 1e-5, 1.0], 1);
    }
}

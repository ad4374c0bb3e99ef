//! Sets of primitives that become a leaf or are split.

use glam::Vec3A;
use rayon::prelude::{ParallelIterator, ParallelSlice};

use super::bins::{self, Split};
use crate::aabb::Aabb;
use crate::child::Child;
use crate::primitive::Primitive;
use crate::triangle::LANES;

/// The kinds of primitives; a leaf holds one kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Triangle,
    Quadric,
    Instance,
}

/// A primitive, as the builder sees it.
///
/// The bounds come last: the word after the last three coordinates, which a vector load includes, must not be an
/// index. As an `f32`, an index is subnormal, which makes arithmetic slow.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub(super) struct Reference {
    /// Index of the primitive, or of the instance.
    pub(super) primitive: u32,
    kind: Kind,
    bounds: Aabb,
}

impl Reference {
    pub(super) fn instance(index: u32, bounds: Aabb) -> Self {
        Self {
            bounds,
            primitive: index,
            kind: Kind::Instance,
        }
    }

    pub(super) fn new(index: u32, primitive: &Primitive) -> Self {
        let kind = match primitive {
            Primitive::Triangle(_) => Kind::Triangle,
            Primitive::Sphere(_) | Primitive::Disk(_) | Primitive::Cylinder(_) => Kind::Quadric,
        };
        Self {
            bounds: primitive.bounds(),
            primitive: index,
            kind,
        }
    }

    /// Returns true if its box is valid, so that it can be in a tree.
    pub(super) fn is_valid(&self) -> bool {
        self.bounds.is_valid()
    }

    /// Returns the corners of its box, in vector registers.
    #[inline]
    pub(super) fn bounds(&self) -> [Vec3A; 2] {
        [self.bounds.min.into(), self.bounds.max.into()]
    }

    /// Returns the middle of its box. None of its intermediate results overflows.
    #[inline]
    pub(super) fn center(&self) -> Vec3A {
        let [min, max] = self.bounds();
        0.5 * min + 0.5 * max
    }

    /// Returns a coordinate of [`Self::center`] with the same rounding: both must put a reference into the same bin.
    #[inline]
    pub(super) fn center_on(&self, axis: usize) -> f32 {
        let [min, max]: [&[f32; 3]; 2] = [self.bounds.min.as_ref(), self.bounds.max.as_ref()];
        0.5 * min[axis] + 0.5 * max[axis]
    }

    /// Returns the work of intersecting it, in lanes: a quadric costs as much as a block of triangles, and an
    /// instance so much that nothing shares its leaf.
    #[inline]
    pub(super) fn lanes(&self) -> u32 {
        match self.kind {
            Kind::Triangle => 1,
            Kind::Quadric => LANES as u32,
            Kind::Instance => MAX_LEAF_LANES,
        }
    }
}

/// Sums over references.
#[derive(Clone, Copy)]
pub(super) struct Totals {
    bounds: [Vec3A; 2],
    centers: [Vec3A; 2],
    lanes: u32,
    /// A bit for each kind.
    kinds: u8,
}

impl Totals {
    const EMPTY: Self = Self {
        bounds: [Vec3A::INFINITY, Vec3A::NEG_INFINITY],
        centers: [Vec3A::INFINITY, Vec3A::NEG_INFINITY],
        lanes: 0,
        kinds: 0,
    };

    pub(super) fn of(references: &[Reference]) -> Self {
        let mut totals = Self::EMPTY;
        sum(references, &mut totals, Self::add_all, Self::add);
        totals
    }

    fn add_all(&mut self, references: &[Reference]) {
        for reference in references {
            self.add(&Self {
                bounds: reference.bounds(),
                centers: [reference.center(); 2],
                lanes: reference.lanes(),
                kinds: 1 << reference.kind as u8,
            });
        }
    }

    #[inline]
    fn add(&mut self, other: &Self) {
        let union = |a: [Vec3A; 2], b: [Vec3A; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        self.bounds = union(self.bounds, other.bounds);
        self.centers = union(self.centers, other.centers);
        self.lanes += other.lanes;
        self.kinds |= other.kinds;
    }

    /// Returns the corners of a box around all centers.
    pub(super) fn centers(&self) -> [Vec3A; 2] {
        self.centers
    }

    /// Returns the box around all references.
    pub(super) fn bounds(&self) -> Aabb {
        let [min, max] = self.bounds.map(Into::into);
        Aabb { min, max }
    }
}

/// Returns a power of two that scales coordinates of at most `reach` to about 1: areas then neither overflow nor
/// vanish, whatever the size of the scene.
pub(super) fn scale_of(reach: f32) -> f32 {
    let exponent_only = f32::from_bits(reach.to_bits() & f32::INFINITY.to_bits());
    exponent_only.max(f32::MIN_POSITIVE).recip()
}

/// A group of references, which are in no other group.
pub(super) struct Group<'a> {
    pub(super) references: &'a mut [Reference],
    /// The kind of all references. None: several kinds occur.
    pub(super) kind: Option<Kind>,
    totals: Totals,
    area: f32,
    split: Option<Split>,
}

/// The number of lanes of the largest leaf, and the number that an instance counts as. It is one block less than a
/// [`Child`] can express, so that 32 bits can count the lanes of any number of instances.
const MAX_LEAF_LANES: u32 = ((Child::MAX_LEAF - 1) * LANES) as u32;

const _: () = assert!(Child::MAX_ELEMENTS as u64 * MAX_LEAF_LANES as u64 <= u32::MAX as u64);

impl<'a> Group<'a> {
    /// Makes a group of at least one reference; `totals` are the sums over them.
    pub(super) fn new(references: &'a mut [Reference], totals: Totals, scale: f32) -> Self {
        let is_one_kind = totals.kinds.is_power_of_two();
        let mut group = Self {
            kind: is_one_kind.then_some(references[0].kind),
            area: bins::scaled_area(scale, totals.bounds),
            totals,
            split: None,
            references,
        };
        if !group.is_one_test() {
            group.split = bins::best_split(group.references, totals.centers(), scale);
        }
        group
    }

    pub(super) fn len(&self) -> usize {
        self.references.len()
    }

    pub(super) fn area(&self) -> f32 {
        self.area
    }

    pub(super) fn bounds(&self) -> Aabb {
        self.totals.bounds()
    }

    /// Returns true if the group becomes a leaf: always if it is one test, never if a leaf has no room for it, and
    /// otherwise if testing all is expected to cost no more than a node and its children. The test of a node counts
    /// as much as that of a block.
    pub(super) fn is_leaf(&self) -> bool {
        self.is_one_test() || self.has_room() && self.leaf_cost() <= self.area + self.split_cost()
    }

    /// Returns true if a split pays when the node that tests the parts exists anyway.
    pub(super) fn deserves_split(&self) -> bool {
        !(self.is_one_test() || self.has_room() && self.leaf_cost() <= self.split_cost())
    }

    /// Returns true if its leaf is a block of triangles, or one primitive.
    fn is_one_test(&self) -> bool {
        self.len() == 1 || self.has_room() && self.totals.lanes <= LANES as u32
    }

    /// Returns true if a leaf has room for all.
    fn has_room(&self) -> bool {
        self.kind.is_some() && self.totals.lanes <= MAX_LEAF_LANES
    }

    fn leaf_cost(&self) -> f32 {
        self.area * bins::blocks(self.totals.lanes)
    }

    fn split_cost(&self) -> f32 {
        self.split
            .as_ref()
            .map_or(f32::INFINITY, |split| split.cost)
    }

    /// Splits by the heuristic, or into halves if it finds no split.
    pub(super) fn split(self, scale: f32) -> [Self; 2] {
        let Some(split) = &self.split else {
            return self.halve(scale);
        };
        let middle = partition(self.references, split.is_left(self.totals.centers()));
        self.cut(middle, scale)
    }

    /// Splits into two halves of equal count, or nearly.
    pub(super) fn halve(self, scale: f32) -> [Self; 2] {
        let middle = self.len() / 2;
        self.cut(middle, scale)
    }

    fn cut(self, middle: usize, scale: f32) -> [Self; 2] {
        let (left, right) = self.references.split_at_mut(middle);
        [left, right].map(|half| {
            let totals = Totals::of(half);
            Self::new(half, totals, scale)
        })
    }
}

/// The number of references of a part. It is fixed, so that the result does not depend on the number of threads: sums
/// of boxes may differ in the sign of a zero.
const PART: usize = 1 << 15;

/// Adds to `total`, which is empty, the results of `look` on the references: on all at once, or on parts, whose
/// totals are added in order.
pub(super) fn sum<T: Clone + Send + Sync>(
    references: &[Reference],
    total: &mut T,
    look: impl Fn(&mut T, &[Reference]) + Sync + Send,
    add: impl Fn(&mut T, &T),
) {
    if references.len() <= PART {
        return look(total, references);
    }
    let empty = total.clone();
    let of_part = |part: &[Reference]| {
        let mut total = empty.clone();
        look(&mut total, part);
        total
    };
    let parts: Vec<T> = references.par_chunks(PART).map(of_part).collect();
    for part in &parts {
        add(total, part);
    }
}

/// Moves the references on the left to the front, and returns their number. It has no branch, because no processor
/// could predict the side.
fn partition(references: &mut [Reference], is_left: impl Fn(&Reference) -> bool) -> usize {
    let mut left = 0;
    for next in 0..references.len() {
        // Computed before the exchange, so that the exchange need not wait for it.
        let belongs_left = is_left(&references[next]);
        references.swap(left, next);
        left += usize::from(belongs_left);
    }
    left
}

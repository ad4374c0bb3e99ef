//! Sets of primitives that become a leaf or are split.

use glam::{Vec3, Vec3A};
use rayon::prelude::{ParallelIterator, ParallelSlice};

use super::bins::{self, Split};
use crate::aabb::{Aabb, half_area};
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
#[derive(Debug, Clone, Copy)]
pub(super) struct Reference {
    pub(super) bounds: Aabb,
    /// Index of the primitive, or of the instance.
    pub(super) primitive: u32,
    kind: Kind,
}

impl Reference {
    pub(super) fn instance(index: u32, bounds: Aabb) -> Self {
        Self {
            bounds,
            primitive: index,
            kind: Kind::Instance,
        }
    }

    pub(super) fn new(index: u32, primitive: &Primitive, bounds: Aabb) -> Self {
        let kind = match primitive {
            Primitive::Triangle(_) => Kind::Triangle,
            Primitive::Sphere(_) | Primitive::Disk(_) | Primitive::Cylinder(_) => Kind::Quadric,
        };
        Self {
            bounds,
            primitive: index,
            kind,
        }
    }

    /// The work of intersecting it, in lanes: a quadric costs what a block of triangles does, an
    /// instance so much that none shares a leaf.
    pub(super) fn lanes(&self) -> u32 {
        match self.kind {
            Kind::Triangle => 1,
            Kind::Quadric => LANES as u32,
            Kind::Instance => MAX_LEAF_LANES,
        }
    }
}

/// The power of two near the size of `total`, as the unit of length: areas neither overflow nor
/// vanish in it, whatever the scale of the scene.
pub(super) fn unit_of(total: &Aabb) -> f32 {
    let size = total.max.abs().max(total.min.abs()).max_element();
    let exponent_only = f32::from_bits(size.to_bits() & f32::INFINITY.to_bits());
    exponent_only.max(f32::MIN_POSITIVE)
}

/// References that are in no other group.
pub(super) struct Group<'a> {
    pub(super) references: &'a mut [Reference],
    pub(super) bounds: Aabb,
    /// None: several kinds occur.
    pub(super) kind: Option<Kind>,
    centers: Aabb,
    area: f32,
    split: Option<Split>,
}

/// Lanes of the largest leaf. One block less than a [`Child`] can say.
const MAX_LEAF_LANES: u32 = ((Child::MAX_LEAF - 1) * LANES) as u32;

impl<'a> Group<'a> {
    /// Groups at least one reference.
    pub(super) fn new(references: &'a mut [Reference], unit: f32) -> Self {
        let [bounds, centers] = summed(references, bounds_of, |[a, b], [c, d]| {
            [a.union(c), b.union(d)]
        });
        let first = references[0].kind;
        let kind = references.iter().all(|r| r.kind == first).then_some(first);
        let split = bins::best_split(references, &centers, unit);
        let area = area_in(unit, &bounds);
        Self {
            references,
            bounds,
            kind,
            centers,
            area,
            split,
        }
    }

    pub(super) fn len(&self) -> usize {
        self.references.len()
    }

    pub(super) fn area(&self) -> f32 {
        self.area
    }

    /// True if a leaf is to be made: always if it is one test, never if a leaf has no room for it, and
    /// otherwise if testing all is expected to cost no more than a node and its children.
    /// A node's test counts as much as a block's.
    pub(super) fn is_leaf(&self) -> bool {
        self.leaf_lanes().is_some_and(|lanes| {
            lanes <= LANES as u32
                || self.area * bins::blocks(lanes) <= self.area + self.split_cost()
        })
    }

    /// True if a split pays where the node that will test the parts is paid for already.
    pub(super) fn deserves_split(&self) -> bool {
        self.leaf_lanes().is_none_or(|lanes| {
            lanes > LANES as u32 && self.area * bins::blocks(lanes) > self.split_cost()
        })
    }

    /// The lanes of a leaf of all. None: there is no room for it.
    fn leaf_lanes(&self) -> Option<u32> {
        if self.kind.is_none() || self.len() > MAX_LEAF_LANES as usize {
            return None;
        }
        let lanes = self.references.iter().map(Reference::lanes).sum();
        (lanes <= MAX_LEAF_LANES || self.len() == 1).then_some(lanes)
    }

    fn split_cost(&self) -> f32 {
        self.split
            .as_ref()
            .map_or(f32::INFINITY, |split| split.cost)
    }

    /// Divides by the heuristic, or in two halves if it knows no way.
    pub(super) fn split(self, unit: f32) -> [Self; 2] {
        let Some(split) = &self.split else {
            return self.halve(unit);
        };
        let middle = partition(self.references, split.is_left(&self.centers));
        self.cut(middle, unit)
    }

    /// Divides in two halves of equal count, or nearly.
    pub(super) fn halve(self, unit: f32) -> [Self; 2] {
        let middle = self.len() / 2;
        self.cut(middle, unit)
    }

    fn cut(self, middle: usize, unit: f32) -> [Self; 2] {
        let (left, right) = self.references.split_at_mut(middle);
        [Self::new(left, unit), Self::new(right, unit)]
    }
}

/// References of a part that one thread looks at. Not a matter of threads: a sum of parts may
/// depend on how they are cut, in the sign of a zero.
const PART: usize = 1 << 15;

/// The result of `look` for the references: of all at once, or of parts that are merged in order.
pub(super) fn summed<T: Send>(
    references: &[Reference],
    look: impl Fn(&[Reference]) -> T + Sync + Send,
    merge: impl Fn(T, T) -> T,
) -> T {
    let (first, others) = references.split_at(references.len().min(PART));
    let (first, others): (T, Vec<T>) = if others.is_empty() {
        (look(first), Vec::new())
    } else {
        rayon::join(
            || look(first),
            || others.par_chunks(PART).map(&look).collect(),
        )
    };
    others.into_iter().fold(first, merge)
}

/// Bounds of references, and of their centers.
fn bounds_of(references: &[Reference]) -> [Aabb; 2] {
    let (inf, minus) = (Vec3A::INFINITY, Vec3A::NEG_INFINITY);
    let (mut min, mut max, mut first, mut last) = (inf, minus, inf, minus);
    for reference in references {
        let bounds: [Vec3A; 2] = [reference.bounds.min.into(), reference.bounds.max.into()];
        min = min.min(bounds[0]);
        max = max.max(bounds[1]);
        let center = 0.5 * bounds[0] + 0.5 * bounds[1];
        first = first.min(center);
        last = last.max(center);
    }
    let aabb = |min: Vec3A, max: Vec3A| Aabb {
        min: min.into(),
        max: max.into(),
    };
    [aabb(min, max), aabb(first, last)]
}

/// Half of the surface area in squares of `unit`.
pub(super) fn area_in(unit: f32, bounds: &Aabb) -> f32 {
    // Divided before subtracting, which could overflow.
    half_area((bounds.max / unit - bounds.min / unit).max(Vec3::ZERO))
}

/// Moves what is left to the front and returns how many these are.
fn partition(references: &mut [Reference], is_left: impl Fn(&Reference) -> bool) -> usize {
    let (mut begin, mut end) = (0, references.len());
    while begin < end {
        if is_left(&references[begin]) {
            begin += 1;
        } else {
            end -= 1;
            references.swap(begin, end);
        }
    }
    begin
}

//! Builds the tree: top-down, by the surface area heuristic, eight children at a time.
//!
//! A node's [`Group`] of references is split in two until there are eight groups. Each step splits the group with the
//! largest surface among those that are not leaves yet. The eight groups become the children of the node. The result
//! does not depend on the number of threads: each group of fewer than [`PARALLEL_MIN`] is built into a tree of its
//! own, and these trees are appended in order, which gives the layout that a single thread would give.
//!
//! A ray's stack has a fixed size, so depth is limited: a group of `n` with only [`balanced_height`] levels left is
//! halved by count instead, which needs no more levels.

use rayon::prelude::{IntoParallelIterator, ParallelIterator};

use crate::aabb::Aabb;
use crate::child::{Child, Target};
use crate::error::BuildError;
use crate::memory;
use crate::node::{Node, WIDTH};
use crate::primitive::{Primitive, Primitives};
use crate::quadric::Quadric;
use crate::triangle::{LANES, TriangleBlock};

mod bins;
mod group;

use group::{Group, Kind, Reference, Totals};

/// The largest number of nodes on the path from the root to a leaf.
pub(crate) const MAX_DEPTH: usize = 32;

/// The largest number of primitives and instances of a scene: every index of a leaf fits into a [`Child`], and the
/// height of a balanced tree leaves the heuristic more than half of [`MAX_DEPTH`].
pub(crate) const MAX_PRIMITIVES: usize = Child::MAX_ELEMENTS;

/// Groups smaller than this are built by one thread.
const PARALLEL_MIN: usize = 4096;

/// The number of levels from the root to the boxes of [`Tree::outline`].
const OUTLINE_LEVELS: usize = 3;

/// The message of a panic if [`Primitives`] break their promise.
const CHANGED: &str = "a primitive is the same each time";

/// The arrays that [`Child`] points into.
#[derive(Debug, Clone)]
pub(crate) struct Tree {
    /// The root comes first.
    pub(crate) nodes: Vec<Node>,
    pub(crate) blocks: Vec<TriangleBlock>,
    pub(crate) quadrics: Vec<Quadric>,
    /// A box around everything; [`Aabb::EMPTY`] for an empty tree.
    pub(crate) bounds: Aabb,
    /// The largest absolute coordinate of a box.
    pub(crate) reach: f32,
}

impl Tree {
    /// Builds the tree over the first `count` primitives, and over instances with these bounds if they are valid.
    pub(crate) fn build<P: Primitives + ?Sized>(
        primitives: &P,
        count: usize,
        instances: &[Aabb],
    ) -> Result<Self, BuildError> {
        let of_primitive =
            |index: usize| Reference::new(index as u32, &primitives.primitive(index));
        let indices = (0..count).into_par_iter();
        let mut references: Vec<Reference> = indices.map(of_primitive).collect();
        if let Some(primitive) = references.iter().position(|one| !one.is_valid()) {
            return Err(BuildError::NotFinite { primitive });
        }
        let of_instances = (0..)
            .zip(instances)
            .map(|(index, bounds)| Reference::instance(index, *bounds));
        references.extend(of_instances.filter(Reference::is_valid));
        if references.is_empty() {
            return Ok(Self::with_room(0));
        }
        Ok(Self::over(primitives, references))
    }

    /// Builds the tree over primitives, given at least one reference.
    fn over<P: Primitives + ?Sized>(primitives: &P, mut references: Vec<Reference>) -> Self {
        let totals = Totals::of(&references);
        let bounds = totals.bounds();
        let reach = bounds.min.abs().max(bounds.max.abs()).max_element();
        let builder = Builder {
            primitives,
            scale: group::scale_of(reach),
        };
        let root = Group::new(&mut references, totals, builder.scale);
        let part = if root.is_leaf() {
            Part::Node(vec![(bounds, builder.part(root, 1))])
        } else {
            builder.part(root, 0)
        };
        drop(references);
        let [nodes, blocks, quadrics] = part.counts();
        let mut tree = Self {
            nodes: memory::with_room(nodes),
            blocks: memory::with_room(blocks),
            quadrics: memory::with_room(quadrics),
            bounds,
            reach,
        };
        tree.append(part);
        tree
    }

    /// Returns the node with this index, which comes from a child.
    #[inline(always)]
    pub(crate) fn node(&self, index: usize) -> &Node {
        debug_assert!(index < self.nodes.len(), "node {index}");
        // SAFETY: the builder makes all children, and appends them together with what they point to; `validate`
        // checks it.
        unsafe { self.nodes.get_unchecked(index) }
    }

    /// Returns boxes that together contain the whole tree: those of the nodes or leaves at its third level.
    pub(crate) fn outline(&self) -> Vec<Aabb> {
        let mut boxes = vec![(self.bounds, Child::node(0))];
        for _ in 0..OUTLINE_LEVELS {
            let below = |(bounds, child): (Aabb, Child)| {
                let node = child.as_node().and_then(|index| self.nodes.get(index));
                node.map_or(vec![(bounds, child)], Node::boxes)
            };
            boxes = boxes.into_iter().flat_map(below).collect();
        }
        boxes.into_iter().map(|(bounds, _)| bounds).collect()
    }

    /// Begins to load the node or the triangles of `child`, which will be visited soon.
    #[inline(always)]
    pub(crate) fn prefetch(&self, child: Child) {
        let blocks: *const u8 = self.blocks.as_ptr().cast();
        let nodes: *const u8 = self.nodes.as_ptr().cast();
        let place = match (child.as_node(), child.as_triangles()) {
            (Some(index), _) => nodes.wrapping_add(index * size_of::<Node>()),
            (None, Some((first, _))) => blocks.wrapping_add(first * size_of::<TriangleBlock>()),
            (None, None) => return,
        };
        memory::prefetch::<{ size_of::<Node>() }>(place);
    }

    /// Returns the triangle blocks of a leaf.
    #[inline(always)]
    pub(crate) fn blocks(&self, first: usize, count: usize) -> &[TriangleBlock] {
        debug_assert!(first + count <= self.blocks.len(), "{count} from {first}");
        // SAFETY: as for nodes.
        unsafe { self.blocks.get_unchecked(first..first + count) }
    }

    /// Makes an empty tree, with the room that this number of triangles usually needs.
    fn with_room(triangles: usize) -> Self {
        Self {
            nodes: Vec::with_capacity(triangles / 12),
            blocks: Vec::with_capacity(triangles / 3),
            quadrics: Vec::new(),
            bounds: Aabb::EMPTY,
            reach: 0.0,
        }
    }

    /// Appends a part, and returns the child that leads to it.
    fn append(&mut self, part: Part) -> Child {
        match part {
            Part::Tree(tree, child) => self.append_tree(tree, child),
            Part::Node(parts) => {
                let index = self.nodes.len();
                self.nodes.push(Node::EMPTY);
                for (slot, (bounds, part)) in parts.into_iter().enumerate() {
                    let child = self.append(part);
                    self.nodes[index].set(slot, &bounds, child);
                }
                Child::node(index)
            }
        }
    }

    /// Appends `other`, and returns its child `child` with its new index.
    fn append_tree(&mut self, mut other: Self, child: Child) -> Child {
        let (nodes, blocks) = (self.nodes.len(), self.blocks.len());
        let quadrics = self.quadrics.len();
        let moved = |child: Child| match child.target() {
            Target::Node(index) => Child::node(index + nodes),
            Target::Triangles(leaf) => Child::triangles(&(leaf.start + blocks..leaf.end + blocks)),
            Target::Quadrics(leaf) => {
                Child::quadrics(&(leaf.start + quadrics..leaf.end + quadrics))
            }
            Target::Instance(_) | Target::Nothing => child,
        };
        for node in &mut other.nodes {
            for child in node.children_mut() {
                *child = moved(*child);
            }
        }
        self.nodes.append(&mut other.nodes);
        self.blocks.append(&mut other.blocks);
        self.quadrics.append(&mut other.quadrics);
        moved(child)
    }
}

/// Part of a tree.
enum Part {
    /// A tree of its own, and the child that is all of it.
    Tree(Tree, Child),
    /// A node: its children and their bounds.
    Node(Vec<(Aabb, Part)>),
}

impl Part {
    /// Counts nodes, blocks and quadrics.
    fn counts(&self) -> [usize; 3] {
        match self {
            Self::Tree(tree, _) => [tree.nodes.len(), tree.blocks.len(), tree.quadrics.len()],
            Self::Node(parts) => parts.iter().fold([1, 0, 0], |sum, (_, part)| {
                let counts = part.counts();
                [0, 1, 2].map(|i| sum[i] + counts[i])
            }),
        }
    }
}

/// Returns the number of levels of nodes that suffice for `count` primitives if groups are halved by count: three
/// halvings per level, down to at most eight primitives, for which a node has room.
fn balanced_height(count: usize) -> usize {
    if count <= WIDTH {
        1
    } else {
        1 + balanced_height(count.div_ceil(WIDTH))
    }
}

struct Builder<'a, P: ?Sized> {
    primitives: &'a P,
    /// The factor of all lengths from which areas are computed.
    scale: f32,
}

impl<P: Primitives + ?Sized> Builder<'_, P> {
    /// Appends the leaf or the nodes of `group`, and returns the child that refers to them.
    fn child(&self, group: Group, depth: usize, tree: &mut Tree) -> Child {
        if group.is_leaf() {
            self.leaf(&group, tree)
        } else {
            self.node(group, depth, tree)
        }
    }

    fn node(&self, group: Group, depth: usize, tree: &mut Tree) -> Child {
        let groups = self.collapse(group, depth);
        let index = tree.nodes.len();
        tree.nodes.push(Node::EMPTY);
        for (slot, group) in groups.into_iter().enumerate() {
            let bounds = group.bounds();
            let child = self.child(group, depth + 1, tree);
            tree.nodes[index].set(slot, &bounds, child);
        }
        Child::node(index)
    }

    /// Builds the part of the tree for `group`, on several threads if it is large.
    fn part(&self, group: Group, depth: usize) -> Part {
        if group.len() < PARALLEL_MIN {
            let mut tree = Tree::with_room(group.len());
            let child = self.child(group, depth, &mut tree);
            return Part::Tree(tree, child);
        }
        let groups = self.collapse(group, depth).into_par_iter();
        let parts = groups.map(|group| (group.bounds(), self.part(group, depth + 1)));
        Part::Node(parts.collect())
    }

    /// Splits the group into at most eight, as long as a split pays. Sorts them by area: an any-hit ray starts with
    /// the last, because the largest box stops it most often.
    fn collapse<'r>(&self, group: Group<'r>, depth: usize) -> Vec<Group<'r>> {
        let by_count = depth + balanced_height(group.len()) >= MAX_DEPTH;
        let mut groups = Vec::with_capacity(WIDTH);
        groups.push(group);
        while groups.len() < WIDTH {
            let size = |group: &Group| {
                if by_count {
                    group.len() as f32
                } else {
                    group.area()
                }
            };
            let open = (0..groups.len()).filter(|&i| groups[i].deserves_split());
            let Some(next) = open.max_by(|&i, &j| size(&groups[i]).total_cmp(&size(&groups[j])))
            else {
                break;
            };
            let group = groups.swap_remove(next);
            let halves = if by_count {
                group.halve(self.scale)
            } else {
                group.split(self.scale)
            };
            groups.extend(halves);
        }
        groups.sort_by(|a, b| a.area().total_cmp(&b.area()));
        groups
    }

    fn leaf(&self, group: &Group, tree: &mut Tree) -> Child {
        let primitive_of =
            |reference: &Reference| self.primitives.primitive(reference.primitive as usize);
        let triangle = |reference: &Reference| match primitive_of(reference) {
            Primitive::Triangle(vertices) => (reference.primitive, vertices),
            _ => panic!("{CHANGED}"),
        };
        let quadric = |reference: &Reference| {
            Quadric::new(reference.primitive, &primitive_of(reference)).expect(CHANGED)
        };
        match group.kind {
            Some(Kind::Triangle) => {
                let first = tree.blocks.len();
                let blocks = group.references.chunks(LANES);
                tree.blocks
                    .extend(blocks.map(|some| TriangleBlock::new(some.iter().map(triangle))));
                Child::triangles(&(first..tree.blocks.len()))
            }
            Some(Kind::Instance) => Child::instance(group.references[0].primitive as usize),
            Some(Kind::Quadric) | None => {
                let first = tree.quadrics.len();
                tree.quadrics.extend(group.references.iter().map(quadric));
                Child::quadrics(&(first..tree.quadrics.len()))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn half_of_the_depth_is_free() {
        assert!(balanced_height(MAX_PRIMITIVES) < MAX_DEPTH / 2);
        assert_eq!([1, 8, 9, 64, 65].map(balanced_height), [1, 1, 2, 2, 3]);
    }

    fn small_triangles(count: u32) -> Vec<Primitive> {
        let at = |i: u32| {
            let mixed = |k: u32| (i * 3 + k).wrapping_mul(2_654_435_769);
            let hash = |k| (mixed(k) ^ mixed(k) >> 15).wrapping_mul(2_246_822_519) as f32 * 1e-9;
            Vec3::new(hash(0), hash(1), hash(2))
        };
        let triangle = |i| [at(i), at(i) + Vec3::X * 0.01, at(i) + Vec3::Y * 0.01];
        (0..count).map(triangle).map(Primitive::Triangle).collect()
    }

    fn tree_of(primitives: &[Primitive]) -> Tree {
        Tree::build(primitives, primitives.len(), &[]).expect("finite")
    }

    #[test]
    fn threads_do_not_change_the_tree() {
        let primitives = small_triangles(40_000);
        let trees = [1, 4].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| format!("{:?}", tree_of(&primitives)))
        });
        assert!(trees[0] == trees[1]);
    }

    /// By the heuristic's assumption, a ray that meets the scene's box meets boxes with the ratio of areas as
    /// probability.
    #[test]
    fn rays_are_expected_to_meet_few_boxes() {
        let tree = tree_of(&small_triangles(40_000));
        let children = |node: &Node| -> f64 {
            let area = |slot| f64::from(node.bounds(slot).half_area());
            (0..WIDTH).map(area).sum()
        };
        let met = tree.nodes.iter().map(children).sum::<f64>() / f64::from(tree.bounds.half_area());
        // It is 31.30; without the second part of a sum, or without counts of blocks in the costs, 50 or more.
        assert!(met < 31.4, "{met} boxes");
    }
}

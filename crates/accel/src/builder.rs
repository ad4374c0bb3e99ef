//! Builds the tree: top-down, by the surface area heuristic, eight children at a time.
//!
//! A [`Group`] of references is split in two until there are eight groups, each time the one
//! with the largest surface that is no leaf yet; these become the children of a node.
//! Nothing depends on the number of threads: large groups are built into a [`Tree`] of their own
//! and appended in order, which gives the layout that building in order would give.
//!
//! A ray's stack is of fixed size, so depth is limited: a group of `n` that has just
//! [`balanced_height`] levels left is halved by count instead, which needs no more.

use rayon::prelude::{IntoParallelIterator, ParallelIterator};

use crate::aabb::Aabb;
use crate::child::{Child, Target};
use crate::memory::{self, settled};
use crate::node::{Node, WIDTH};
use crate::primitive::Primitive;
use crate::quadric::Quadric;
use crate::triangle::{LANES, TriangleBlock};

mod bins;
mod group;

use group::{Group, Kind, Reference};

/// Nodes on the longest way from the root to a leaf.
pub(crate) const MAX_DEPTH: usize = 32;

/// Primitives and instances of the largest scene: then every index of a leaf fits into a [`Child`], and
/// the height of a balanced tree leaves the heuristic more than half of [`MAX_DEPTH`].
pub(crate) const MAX_PRIMITIVES: usize = Child::MAX_ELEMENTS;

/// Groups smaller than this are built by one thread.
const PARALLEL_MIN: usize = 16384;

/// The arrays that [`Child`] points into.
#[derive(Debug, Clone, Default)]
pub(crate) struct Tree {
    /// The root comes first.
    pub(crate) nodes: Vec<Node>,
    pub(crate) blocks: Vec<TriangleBlock>,
    pub(crate) quadrics: Vec<Quadric>,
    /// The largest magnitude of a coordinate of a box.
    pub(crate) reach: f32,
}

impl Tree {
    /// The tree over primitives with these bounds, which are all valid, and over the instances of
    /// which the bounds are valid.
    pub(crate) fn build(primitives: &[Primitive], bounds: &[Aabb], instances: &[Aabb]) -> Self {
        let mut tree = Self::with_room(primitives.len());
        let of_primitive =
            |index: usize| Reference::new(index as u32, &primitives[index], bounds[index]);
        let of_instances = (0..)
            .zip(instances)
            .filter(|(_, bounds)| bounds.is_valid())
            .map(|(index, bounds)| Reference::instance(index, *bounds));
        let indices = (0..primitives.len()).into_par_iter();
        let mut references: Vec<Reference> = indices.map(of_primitive).collect();
        references.extend(of_instances);
        if references.is_empty() {
            return tree;
        }
        let total = references
            .iter()
            .fold(Aabb::EMPTY, |sum, reference| sum.union(reference.bounds));
        let builder = Builder {
            primitives,
            unit: group::unit_of(&total),
        };
        let root = Group::new(&mut references, builder.unit);
        if root.is_leaf() {
            tree.nodes.push(Node::EMPTY);
            let bounds = root.bounds;
            let leaf = builder.leaf(&root, &mut tree);
            tree.nodes[0].set(0, &bounds, leaf);
        } else {
            builder.node(root, 0, &mut tree);
        }
        Self {
            nodes: settled(tree.nodes),
            blocks: settled(tree.blocks),
            quadrics: settled(tree.quadrics),
            reach: total.min.abs().max(total.max.abs()).max_element(),
        }
    }

    /// The node of a child that is one.
    #[inline(always)]
    pub(crate) fn node(&self, index: usize) -> &Node {
        debug_assert!(index < self.nodes.len(), "node {index}");
        // SAFETY: all children are made by the builder, where they and what they point to are appended
        // together; `validate` checks it.
        unsafe { self.nodes.get_unchecked(index) }
    }

    /// Begins to load what `child` leads to: it will be visited soon.
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

    /// The triangle blocks of a child that is a leaf of them.
    #[inline(always)]
    pub(crate) fn blocks(&self, first: usize, count: usize) -> &[TriangleBlock] {
        debug_assert!(first + count <= self.blocks.len(), "{count} from {first}");
        // SAFETY: as for nodes.
        unsafe { self.blocks.get_unchecked(first..first + count) }
    }

    /// An empty tree with room for what so many triangles usually need.
    fn with_room(triangles: usize) -> Self {
        Self {
            nodes: Vec::with_capacity(triangles / 12),
            blocks: Vec::with_capacity(triangles / 3),
            ..Self::default()
        }
    }

    /// Appends `other` and returns where its child `child` is now.
    fn append(&mut self, mut other: Self, child: Child) -> Child {
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

/// Levels of nodes that suffice for `count` primitives if groups are halved by count: three
/// halvings a level, down to at most eight primitives, which a node has room for.
fn balanced_height(count: usize) -> usize {
    if count <= WIDTH {
        1
    } else {
        1 + balanced_height(count.div_ceil(WIDTH))
    }
}

struct Builder<'a> {
    primitives: &'a [Primitive],
    /// The length that areas are measured in.
    unit: f32,
}

impl Builder<'_> {
    /// Appends what leads to `group`, and returns the reference to it.
    fn child(&self, group: Group, depth: usize, tree: &mut Tree) -> Child {
        if group.is_leaf() {
            self.leaf(&group, tree)
        } else {
            self.node(group, depth, tree)
        }
    }

    fn node(&self, group: Group, depth: usize, tree: &mut Tree) -> Child {
        let count = group.len();
        let groups = self.collapse(group, depth);
        let index = tree.nodes.len();
        tree.nodes.push(Node::EMPTY);
        if count < PARALLEL_MIN {
            for (slot, group) in groups.into_iter().enumerate() {
                let bounds = group.bounds;
                let child = self.child(group, depth + 1, tree);
                tree.nodes[index].set(slot, &bounds, child);
            }
        } else {
            let build = |group: Group| {
                let (bounds, mut subtree) = (group.bounds, Tree::with_room(group.len()));
                let child = self.child(group, depth + 1, &mut subtree);
                (bounds, child, subtree)
            };
            let subtrees: Vec<_> = groups.into_par_iter().map(build).collect();
            for (slot, (bounds, child, subtree)) in subtrees.into_iter().enumerate() {
                let child = tree.append(subtree, child);
                tree.nodes[index].set(slot, &bounds, child);
            }
        }
        Child::node(index)
    }

    /// Splits until there are eight groups, or none that it would help. Larger boxes come last: an any-hit ray
    /// starts there, since they stop it most often.
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
                group.halve(self.unit)
            } else {
                group.split(self.unit)
            };
            groups.extend(halves);
        }
        groups.sort_by(|a, b| a.area().total_cmp(&b.area()));
        groups
    }

    fn leaf(&self, group: &Group, tree: &mut Tree) -> Child {
        let triangle = |reference: &Reference| match &self.primitives[reference.primitive as usize]
        {
            Primitive::Triangle(vertices) => Some((reference.primitive, *vertices)),
            _ => None,
        };
        let quadric = |reference: &Reference| {
            Quadric::new(
                reference.primitive,
                &self.primitives[reference.primitive as usize],
            )
        };
        match group.kind {
            Some(Kind::Triangle) => {
                let first = tree.blocks.len();
                let blocks = group.references.chunks(LANES);
                tree.blocks.extend(
                    blocks.map(|some| TriangleBlock::new(some.iter().filter_map(triangle))),
                );
                Child::triangles(&(first..tree.blocks.len()))
            }
            Some(Kind::Instance) => Child::instance(group.references[0].primitive as usize),
            Some(Kind::Quadric) | None => {
                let first = tree.quadrics.len();
                tree.quadrics
                    .extend(group.references.iter().filter_map(quadric));
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

    #[test]
    fn threads_do_not_change_the_tree() {
        let at = |i: u32| {
            let hash = |k: u32| (i * 3 + k).wrapping_mul(2_654_435_769) as f32 * 1e-9;
            Vec3::new(hash(0), hash(1), hash(2))
        };
        let primitives: Vec<_> = (0..20_000)
            .map(|i| Primitive::Triangle([at(i), at(i) + Vec3::X * 0.01, at(i) + Vec3::Y * 0.01]))
            .collect();
        let bounds: Vec<_> = primitives.iter().map(Primitive::bounds).collect();
        let trees = [1, 4].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| format!("{:?}", Tree::build(&primitives, &bounds, &[])))
        });
        assert!(trees[0] == trees[1]);
    }
}

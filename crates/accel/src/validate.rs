//! [`Bvh::validate`].

use crate::aabb::Aabb;
use crate::builder::MAX_DEPTH;
use crate::bvh::Bvh;
use crate::node::{Child, Target, WIDTH};

impl Bvh {
    /// Walks the whole tree and checks every invariant that queries rely on; `Err` describes the
    /// first violation. For tests and for suspicion: a tree that was built is valid.
    pub fn validate(&self) -> Result<(), String> {
        let mut walk = Walk {
            bvh: self,
            primitives: vec![false; self.primitive_count],
            nodes: vec![false; self.tree.nodes.len()],
            blocks: vec![false; self.tree.blocks.len()],
            quadrics: vec![false; self.tree.quadrics.len()],
        };
        if self.primitive_count > 0 {
            let contents = walk.node(0, 0)?;
            if contents != self.bounds {
                return Err(format!(
                    "the tree has bounds {contents:?}, not {:?}",
                    self.bounds
                ));
            }
        }
        all_visited("primitive", &walk.primitives)?;
        all_visited("node", &walk.nodes)?;
        all_visited("block", &walk.blocks)?;
        all_visited("quadric", &walk.quadrics)
    }
}

fn all_visited(what: &str, visited: &[bool]) -> Result<(), String> {
    visited
        .iter()
        .position(|&seen| !seen)
        .map_or(Ok(()), |index| Err(format!("{what} {index} is in no leaf")))
}

/// Marks `index`, which must exist and not be marked yet.
fn visit(what: &str, index: usize, visited: &mut [bool]) -> Result<(), String> {
    match visited.get_mut(index) {
        None => Err(format!("{what} {index} does not exist")),
        Some(true) => Err(format!("{what} {index} is reached twice")),
        Some(seen) => {
            *seen = true;
            Ok(())
        }
    }
}

/// What has been reached so far.
struct Walk<'a> {
    bvh: &'a Bvh,
    primitives: Vec<bool>,
    nodes: Vec<bool>,
    blocks: Vec<bool>,
    quadrics: Vec<bool>,
}

impl Walk<'_> {
    /// Checks a node and all below, and returns the bounds of the primitives found there.
    fn node(&mut self, index: usize, depth: usize) -> Result<Aabb, String> {
        visit("node", index, &mut self.nodes)?;
        if depth >= MAX_DEPTH {
            return Err(format!("node {index} is too deep"));
        }
        let node = &self.bvh.tree.nodes[index];
        let mut total = Aabb::EMPTY;
        for slot in 0..WIDTH {
            let bounds = node.bounds(slot);
            let contents = self.child(node.child(slot), depth + 1)?;
            // Equal, not only contained: a loose box is slow, and an unused one must be empty.
            if contents != bounds {
                return Err(format!(
                    "child {slot} of node {index} has bounds {bounds:?} around {contents:?}"
                ));
            }
            total = total.union(contents);
        }
        Ok(total)
    }

    fn child(&mut self, child: Child, depth: usize) -> Result<Aabb, String> {
        let tree = &self.bvh.tree;
        let mut bounds = Aabb::EMPTY;
        match child.target() {
            Target::Node(index) => bounds = self.node(index, depth)?,
            Target::Triangles(blocks) => {
                for index in blocks {
                    visit("block", index, &mut self.blocks)?;
                    for (primitive, vertices) in tree.blocks[index].triangles() {
                        visit("primitive", primitive as usize, &mut self.primitives)?;
                        bounds = bounds.union(Aabb::around(&vertices));
                    }
                }
            }
            Target::Quadrics(quadrics) => {
                for index in quadrics {
                    visit("quadric", index, &mut self.quadrics)?;
                    let quadric = &tree.quadrics[index];
                    visit(
                        "primitive",
                        quadric.primitive as usize,
                        &mut self.primitives,
                    )?;
                    bounds = bounds.union(quadric.bounds);
                }
            }
            Target::Nothing => {}
        }
        Ok(bounds)
    }
}

#[cfg(test)]
mod tests {
    use glam::{Affine3A, Vec3};

    use super::*;
    use crate::{BuildOptions, Disk, Primitive};

    fn mixed() -> Bvh {
        let mut primitives: Vec<_> = (0..50)
            .map(|i| Vec3::splat(i as f32))
            .map(|p| Primitive::Triangle([p, p + Vec3::X, p + Vec3::Y]))
            .collect();
        primitives.extend((0..20).map(|i| {
            let local_from_world = Affine3A::from_translation(Vec3::X * i as f32);
            let (radius, inner_radius) = (1.0, 0.0);
            Primitive::Disk(Disk {
                local_from_world,
                height: 0.0,
                radius,
                inner_radius,
                phi_max: 7.0,
            })
        }));
        Bvh::build(&primitives, &BuildOptions::default()).unwrap()
    }

    #[track_caller]
    fn check_refused(corrupt: impl Fn(&mut Bvh), message: &str) {
        let mut bvh = mixed();
        assert_eq!(bvh.validate(), Ok(()));
        corrupt(&mut bvh);
        let error = bvh.validate().unwrap_err();
        assert!(error.contains(message), "{error}");
    }

    #[test]
    fn corrupted_trees_are_refused() {
        check_refused(|bvh| bvh.bounds.max.x += 1.0, "the tree has bounds");
        check_refused(|bvh| bvh.primitive_count += 1, "primitive 70 is in no leaf");
        check_refused(
            |bvh| bvh.primitive_count -= 1,
            "primitive 69 does not exist",
        );
        check_refused(
            |bvh| bvh.tree.blocks.push(bvh.tree.blocks[0]),
            "is in no leaf",
        );
        check_refused(
            |bvh| bvh.tree.blocks[1] = bvh.tree.blocks[0],
            "is reached twice",
        );
        check_refused(
            |bvh| bvh.tree.quadrics[0].primitive = 0,
            "primitive 0 is reached twice",
        );
        check_refused(
            |bvh| {
                let node = &mut bvh.tree.nodes[0];
                let bounds = node.bounds(0);
                node.set(
                    0,
                    &Aabb {
                        min: bounds.min + 0.5,
                        ..bounds
                    },
                    node.child(0),
                );
            },
            "child 0 of node 0 has bounds",
        );
        check_refused(
            |bvh| {
                let node = &mut bvh.tree.nodes[0];
                node.set(0, &node.bounds(0), Child::node(0));
            },
            "node 0 is reached twice",
        );
        check_refused(
            |bvh| {
                let node = &mut bvh.tree.nodes[0];
                node.set(0, &node.bounds(0), Child::NOTHING);
            },
            "child 0 of node 0 has bounds",
        );
    }
}

//! [`Bvh::validate`].

use glam::Vec3;

use crate::aabb::Aabb;
use crate::builder::MAX_DEPTH;
use crate::bvh::Bvh;
use crate::child::{Child, Target};
use crate::node::WIDTH;

impl Bvh {
    /// Walks the whole tree and checks its nodes, boxes and leaves; `Err` describes the first violation. It is for
    /// tests: a tree that was built is valid.
    pub fn validate(&self) -> Result<(), String> {
        let mut walk = Walk {
            bvh: self,
            primitives: vec![false; self.primitive_count],
            nodes: vec![false; self.tree.nodes.len()],
            blocks: vec![false; self.tree.blocks.len()],
            quadrics: vec![false; self.tree.quadrics.len()],
            // Instances of empty objects are not in the tree.
            instances: (0..self.instance_count())
                .map(|i| self.object_of(i).tree.nodes.is_empty())
                .collect(),
        };
        for object in &self.objects {
            object.validate()?;
        }
        if !self.tree.nodes.is_empty() {
            let contents = walk.node(0, 0)?;
            if contents != self.bounds() {
                return Err(format!(
                    "the tree has bounds {contents:?}, not {:?}",
                    self.bounds()
                ));
            }
        }
        all_visited("primitive", &walk.primitives)?;
        all_visited("node", &walk.nodes)?;
        all_visited("block", &walk.blocks)?;
        all_visited("quadric", &walk.quadrics)?;
        all_visited("instance", &walk.instances)
    }

    fn object_of(&self, instance: usize) -> &Self {
        &self.objects[self.placements[instance].object as usize]
    }
}

fn all_visited(what: &str, visited: &[bool]) -> Result<(), String> {
    visited
        .iter()
        .position(|&seen| !seen)
        .map_or(Ok(()), |index| {
            Err(format!("{what} {index} is not reached"))
        })
}

/// Returns the eight corners of a box.
fn corners(part: &Aabb) -> impl Iterator<Item = Vec3> + use<> {
    let sides = [part.min, part.max];
    (0..8)
        .map(move |corner| Vec3::from_array([0, 1, 2].map(|axis| sides[corner >> axis & 1][axis])))
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

/// The parts of the tree reached so far.
struct Walk<'a> {
    bvh: &'a Bvh,
    primitives: Vec<bool>,
    nodes: Vec<bool>,
    blocks: Vec<bool>,
    quadrics: Vec<bool>,
    instances: Vec<bool>,
}

impl Walk<'_> {
    /// Checks a node and all nodes below it, and returns the bounds of the primitives there.
    fn node(&mut self, index: usize, depth: usize) -> Result<Aabb, String> {
        visit("node", index, &mut self.nodes)?;
        if depth >= MAX_DEPTH {
            return Err(format!("node {index} is too deep"));
        }
        let node = &self.bvh.tree.nodes[index];
        let mut total = Aabb::EMPTY;
        for slot in 0..WIDTH {
            let bounds = node.bounds(slot);
            if let Target::Instance(index) = node.child(slot).target() {
                self.instance(index, &bounds)?;
                total = total.union(bounds);
                continue;
            }
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

    /// Checks that an instance with these bounds contains the corners of its object's boxes.
    fn instance(&mut self, index: usize, bounds: &Aabb) -> Result<(), String> {
        visit("instance", index, &mut self.instances)?;
        let world_from_object = self.bvh.placements[index].object_from_world().inverse();
        let parts = self.bvh.object_of(index).tree.outline();
        let corners = parts.iter().flat_map(corners);
        let points = corners.map(|corner| world_from_object.transform_point3(corner.as_dvec3()));
        for point in points {
            let outside = point.cmplt(bounds.min.as_dvec3()) | point.cmpgt(bounds.max.as_dvec3());
            if outside.any() {
                return Err(format!(
                    "instance {index} has bounds {bounds:?} without {point}"
                ));
            }
        }
        Ok(())
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
            Target::Instance(_) | Target::Nothing => {}
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
        check_refused(|bvh| bvh.tree.bounds.max.x += 1.0, "the tree has bounds");
        check_refused(
            |bvh| bvh.primitive_count += 1,
            "primitive 70 is not reached",
        );
        check_refused(
            |bvh| bvh.primitive_count -= 1,
            "primitive 69 does not exist",
        );
        check_refused(
            |bvh| bvh.tree.blocks.push(bvh.tree.blocks[0]),
            "is not reached",
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

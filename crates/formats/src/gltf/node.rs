//! The nodes of the rendered scene, with their transforms to the render space.

use super::document::Document;
use super::json::{Node, Root};
use super::place::{GltfFault, Place};
use glam::{DAffine3, DMat4, DQuat, DVec3};

/// The nodes of a scene in the order of a walk from the roots, children after parents.
pub(super) struct Nodes {
    /// The indices of the nodes.
    pub(super) order: Vec<usize>,
    /// The transform of each node of the file to the render space. None: the node is not in the scene.
    pub(super) render_from_node: Vec<Option<DAffine3>>,
}

impl Nodes {
    /// Walks the nodes of the file's scene. Errors: a node is its own ancestor, or has two parents.
    pub(super) fn of(document: &Document, render_from_world: DAffine3) -> Result<Self, GltfFault> {
        let root = &document.root;
        let mut nodes = Self {
            order: Vec::new(),
            render_from_node: vec![None; root.nodes.len()],
        };
        // Nodes to visit, the next one last, each with its parent and the place that names it.
        let mut waiting = roots(root, render_from_world)?;
        waiting.reverse();
        while let Some((index, parent, named)) = waiting.pop() {
            let node = named.find(&root.nodes, index, "node")?;
            if nodes.render_from_node[index].is_some() {
                let message =
                    format!("node {index} is reached twice: nodes have one parent, and no cycles");
                return Err(named.scene(message));
            }
            let place = Place::of("nodes", index);
            let render_from_node = parent * local(node, &place)?;
            if !render_from_node.is_finite() {
                return Err(place.scene("its transformation is not finite"));
            }
            nodes.render_from_node[index] = Some(render_from_node);
            nodes.order.push(index);
            let children = place.key("children");
            let below = node.children.iter().enumerate().rev();
            waiting.extend(below.map(|(i, &child)| (child, render_from_node, children.index(i))));
        }
        Ok(nodes)
    }
}

/// Returns the roots of the rendered scene: the default scene, else the first, else all nodes without a
/// parent.
fn roots(
    root: &Root,
    render_from_world: DAffine3,
) -> Result<Vec<(usize, DAffine3, Place)>, GltfFault> {
    let index = root.scene.unwrap_or(0);
    let place = Place::of("scenes", index).key("nodes");
    let from_top = |nodes: &[usize]| {
        let named = |(i, &node)| (node, render_from_world, place.index(i));
        nodes.iter().enumerate().map(named).collect()
    };
    if root.scene.is_some() || !root.scenes.is_empty() {
        let scene = Place::TOP.key("scene").find(&root.scenes, index, "scene")?;
        return Ok(from_top(&scene.nodes));
    }
    let mut is_child = vec![false; root.nodes.len()];
    for &child in root.nodes.iter().flat_map(|node| &node.children) {
        if let Some(is_child) = is_child.get_mut(child) {
            *is_child = true;
        }
    }
    let tops: Vec<usize> = (0..root.nodes.len()).filter(|&i| !is_child[i]).collect();
    Ok(from_top(&tops))
}

/// Returns the map from a node to its parent.
fn local(node: &Node, place: &Place) -> Result<DAffine3, GltfFault> {
    let Some(numbers) = &node.matrix else {
        return Ok(from_parts(node.translation, node.rotation, node.scale));
    };
    let matrix = DMat4::from_cols_array(numbers);
    let bottom = matrix.row(3);
    if (bottom - glam::DVec4::W).abs().max_element() > 1e-6 {
        return Err(place
            .key("matrix")
            .scene("the last row of the matrix is not 0 0 0 1"));
    }
    Ok(DAffine3::from_mat4(matrix))
}

/// Returns translation · rotation · scale.
pub(super) fn from_parts(
    translation: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
) -> DAffine3 {
    let rotation = DQuat::from_array(rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]));
    let length = rotation.length();
    let rotation = if length > 0.0 {
        rotation / length
    } else {
        DQuat::IDENTITY
    };
    let [translation, scale] = [translation.unwrap_or_default(), scale.unwrap_or([1.0; 3])];
    DAffine3::from_scale_rotation_translation(
        DVec3::from(scale),
        rotation,
        DVec3::from(translation),
    )
}

//! The placement of meshes: the transforms of joints, and of a node's instances.

use crate::gltf::document::Document;
use crate::gltf::json::Node;
use crate::gltf::node::from_parts;
use crate::gltf::place::{GltfFault, Place};
use glam::DAffine3;

/// Returns the transforms from the mesh to the render space, one for each joint of `skin`.
pub(in crate::gltf) fn joints(
    document: &Document,
    render_from_node: &[Option<DAffine3>],
    skin: usize,
    user: &Place,
) -> Result<Vec<DAffine3>, GltfFault> {
    let of_skin = user.find(&document.root.skins, skin, "skin")?;
    let place = Place::of("skins", skin);
    let inverse = match of_skin.inverse_bind_matrices {
        Some(index) => {
            let place = place.key("inverseBindMatrices");
            let matrices = document.finite_vectors::<16>(index, &place)?;
            if matrices.len() < of_skin.joints.len() {
                return Err(place.scene("there are fewer matrices than joints"));
            }
            let affine = |matrix: [f32; 16]| {
                DAffine3::from_mat4(glam::DMat4::from_cols_array(&matrix.map(f64::from)))
            };
            matrices.into_iter().map(affine).collect()
        }
        None => vec![DAffine3::IDENTITY; of_skin.joints.len()],
    };
    let place = place.key("joints");
    let of_joint = |(i, &joint): (usize, &usize)| {
        let render_from_joint = render_from_node.get(joint).copied().flatten();
        let missing = || {
            place
                .index(i)
                .scene(format!("node {joint} is not in the scene"))
        };
        Ok(render_from_joint.ok_or_else(missing)? * inverse[i])
    };
    of_skin.joints.iter().enumerate().map(of_joint).collect()
}

/// Returns the transforms from a mesh to its node: the identity, or those of EXT_mesh_gpu_instancing.
pub(in crate::gltf) fn places(
    document: &Document,
    node: &Node,
    place: &Place,
) -> Result<Vec<DAffine3>, GltfFault> {
    let Some(instancing) = &node.extensions.instancing else {
        return Ok(vec![DAffine3::IDENTITY]);
    };
    let place = place.extension("EXT_mesh_gpu_instancing").key("attributes");
    let find = |name: &str| Some((*instancing.attributes.get(name)?, place.key(name)));
    let triples = |name| {
        let found = find(name).map(|(index, place)| document.finite_vectors::<3>(index, &place));
        found.transpose()
    };
    let (translations, scales) = (triples("TRANSLATION")?, triples("SCALE")?);
    let rotations =
        find("ROTATION").map(|(index, place)| document.finite_vectors::<4>(index, &place));
    let rotations = rotations.transpose()?;
    let counts = [
        translations.as_ref().map(Vec::len),
        rotations.as_ref().map(Vec::len),
        scales.as_ref().map(Vec::len),
    ];
    let mut given = counts.into_iter().flatten();
    let count = given.next().unwrap_or(1);
    if given.any(|other| other != count) {
        return Err(place.scene("the attributes have different counts"));
    }
    let at = |i: usize| {
        let of =
            |values: &Option<Vec<[f32; 3]>>| values.as_ref().map(|values| values[i].map(f64::from));
        let rotation = rotations.as_ref().map(|values| values[i].map(f64::from));
        from_parts(of(&translations), rotation, of(&scales))
    };
    Ok((0..count).map(at).collect())
}

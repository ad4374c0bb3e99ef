//! Places surfaces in the world, rigidly or by their joints.

use super::{Surface, UvMap};
use crate::gltf::place::{GltfFault, Place};
use crate::import::{Survey, mirrored, place_vertices, unit, vector};
use bidir::shape::{Mesh, Orientation};
use glam::DAffine3;

impl Surface {
    /// Returns the mesh transformed by `world_from_mesh`, and adds it to `survey`. Errors: it extends too far.
    pub(in crate::gltf) fn place(
        &self,
        world_from_mesh: &DAffine3,
        uv: &UvMap,
        survey: &mut Survey,
        place: &Place,
    ) -> Result<Mesh, GltfFault> {
        Ok(Mesh {
            orientation: mirrored(Orientation::Natural, world_from_mesh),
            ..self.mesh(|_| world_from_mesh, uv, survey, place)?
        })
    }

    /// Returns the mesh transformed by its joints; `joints` are their transforms from the mesh to the world.
    pub(in crate::gltf) fn skinned(
        &self,
        joints: &[DAffine3],
        uv: &UvMap,
        survey: &mut Survey,
        place: &Place,
    ) -> Result<Mesh, GltfFault> {
        let missing = || {
            let count = joints.len();
            place.scene(format!(
                "a vertex names a joint that its skin does not have: the skin has {count}"
            ))
        };
        let vertices = self.joints.iter();
        let blends = vertices.map(|vertex| blend(vertex, joints).ok_or_else(missing));
        let maps = blends.collect::<Result<Vec<_>, _>>()?;
        self.mesh(|vertex| &maps[vertex], uv, survey, place)
    }

    /// Returns the mesh transformed by the map of each vertex.
    fn mesh<'m>(
        &self,
        map: impl Fn(usize) -> &'m DAffine3,
        uv: &UvMap,
        survey: &mut Survey,
        place: &Place,
    ) -> Result<Mesh, GltfFault> {
        let point = |(i, &p): (usize, &[f32; 3])| map(i).transform_point3(vector(p));
        let normal = |(i, &n): (usize, &[f32; 3])| unit(normal_matrix(map(i)) * vector(n));
        let tangent = |(i, &t): (usize, &[f32; 3])| unit(map(i).transform_vector3(vector(t)));
        let positions = self.positions.iter().enumerate().map(point);
        let uvs = self.uvs[uv.set.min(1)].iter();
        Ok(Mesh {
            positions: place_vertices(positions, survey, place)?,
            normals: self.normals.iter().enumerate().map(normal).collect(),
            tangents: self.tangents.iter().enumerate().map(tangent).collect(),
            uvs: uvs.map(|&at| uv.apply(at)).collect(),
            triangles: self.triangles.clone(),
            ..Mesh::default()
        })
    }
}

/// Returns the transform of normals, up to a positive factor: the matrix of cofactors, which exists for singular
/// maps, too.
fn normal_matrix(map: &DAffine3) -> glam::DMat3 {
    let m = map.matrix3;
    let sign = if m.determinant() < 0.0 { -1.0 } else { 1.0 };
    let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis];
    glam::DMat3::from_cols(y.cross(z) * sign, z.cross(x) * sign, x.cross(y) * sign)
}

/// Returns the weighted mean of the transforms of a vertex's joints. None: a joint does not exist.
fn blend(vertex: &[(u32, f32); 4], joints: &[DAffine3]) -> Option<DAffine3> {
    let total: f64 = vertex.iter().map(|&(_, weight)| f64::from(weight)).sum();
    if total <= 0.0 {
        return joints.first().copied();
    }
    let mut sum = [0.0; 12];
    for &(joint, weight) in vertex {
        if weight == 0.0 {
            continue;
        }
        let map = joints.get(joint as usize)?.to_cols_array();
        for (sum, value) in sum.iter_mut().zip(map) {
            *sum += value * f64::from(weight) / total;
        }
    }
    Some(DAffine3::from_cols_array(&sum))
}

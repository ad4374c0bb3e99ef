//! Primitives of meshes: their attributes, made into triangles and put into place.

use super::document::{Context, Document};
use super::json::{Node, Primitive};
use super::place::{GltfFault, Place};
use crate::error::ErrorKind;
use bidir::math::{Vec2, Vec3};
use bidir::shape::{Mesh, Orientation};
use glam::{DAffine3, DVec3};
use std::collections::BTreeMap;

/// The farthest that anything is from the origin: squares of distances stay finite below it.
const FARTHEST: f64 = 1e12;

/// A primitive in the space of its mesh, with default morph weights applied.
#[derive(Clone, Debug, Default)]
pub(super) struct Surface {
    pub(super) positions: Vec<[f32; 3]>,
    /// Empty: the surface is flat.
    pub(super) normals: Vec<[f32; 3]>,
    /// Empty: along the texture coordinates' first axis.
    pub(super) tangents: Vec<[f32; 3]>,
    /// Two sets; empty where there are none.
    pub(super) uvs: [Vec<[f32; 2]>; 2],
    pub(super) triangles: Vec<[u32; 3]>,
    /// What all vertices multiply the base colour by: red, green, blue, alpha.
    pub(super) color: [f32; 4],
    /// Joints and their weights, by vertex. Empty: there are none.
    pub(super) joints: Vec<[(u32, f32); 4]>,
}

/// How texture coordinates become those of the built mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct UvMap {
    /// Which set.
    pub(super) set: usize,
    /// Rows of a matrix with an offset behind: (u', v') = rows · (u, v, 1).
    pub(super) rows: [[f32; 3]; 2],
}

impl UvMap {
    pub(super) const IDENTITY: Self = Self {
        set: 0,
        rows: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    };

    /// The parameters of the built mesh, whose v goes up where that of the file goes down.
    fn apply(&self, [u, v]: [f32; 2]) -> Vec2 {
        let [s, t] = self.rows.map(|[a, b, c]| a * u + b * v + c);
        Vec2::new(s, 1.0 - t)
    }
}

impl Surface {
    /// Reads a primitive. None: it has no triangles, of which a warning says why.
    pub(super) fn read(
        context: &mut Context<'_>,
        document: &Document,
        (primitive, place): (&Primitive, &Place),
        weights: &[f32],
    ) -> Result<Option<Self>, GltfFault> {
        let attributes = place.key("attributes");
        let Some(&position) = primitive.attributes.get("POSITION") else {
            context.warn(place, "the primitive has no POSITION and is left out");
            return Ok(None);
        };
        let mode = primitive.mode.unwrap_or(4);
        if mode < 4 {
            context.warn(place, "points and lines have no surface and are left out");
            return Ok(None);
        }
        let mut surface = Self {
            positions: document.finite_vectors(position, &attributes.key("POSITION"))?,
            color: [1.0; 4],
            ..Self::default()
        };
        surface.triangles = triangles(document, primitive, place, surface.positions.len())?;
        surface.read_attributes(context, document, (primitive, &attributes))?;
        surface.morph(document, (primitive, place), weights)?;
        Ok(Some(surface).filter(|surface| !surface.triangles.is_empty()))
    }

    fn read_attributes(
        &mut self,
        context: &mut Context<'_>,
        document: &Document,
        (primitive, place): (&Primitive, &Place),
    ) -> Result<(), GltfFault> {
        let find = |name: &str| {
            primitive
                .attributes
                .get(name)
                .map(|&index| (index, place.key(name)))
        };
        if let Some((index, place)) = find("NORMAL") {
            self.normals = self.per_vertex(document.finite_vectors(index, &place)?, &place)?;
        }
        // Where normals are missing the format wants tangents to be passed over.
        let is_smooth = !self.normals.is_empty();
        if let Some((index, place)) = find("TANGENT").filter(|_| is_smooth) {
            let tangents = document.finite_vectors::<4>(index, &place)?;
            let tangents = tangents.into_iter().map(|[x, y, z, _]| [x, y, z]);
            self.tangents = self.per_vertex(tangents.collect(), &place)?;
        }
        for (set, name) in ["TEXCOORD_0", "TEXCOORD_1"].into_iter().enumerate() {
            if let Some((index, place)) = find(name) {
                self.uvs[set] = self.per_vertex(document.finite_vectors(index, &place)?, &place)?;
            }
        }
        if let Some((index, place)) = find("COLOR_0") {
            self.read_color(context, document, index, &place)?;
        }
        if let (Some(joints), Some(weights)) = (find("JOINTS_0"), find("WEIGHTS_0")) {
            self.joints = self.read_joints(document, joints, weights)?;
            if find("JOINTS_1").is_some() {
                context.warn(
                    place,
                    "joints beyond the first four of a vertex have no effect",
                );
            }
        }
        Ok(())
    }

    /// Values of which there has to be one per vertex.
    fn per_vertex<T>(&self, values: Vec<T>, place: &Place) -> Result<Vec<T>, GltfFault> {
        let (vertices, count) = (self.positions.len(), values.len());
        if vertices == count {
            return Ok(values);
        }
        Err(place.scene(format!("there are {count} values for {vertices} positions")))
    }

    /// One colour for all vertices: theirs where it is the same, else the mean.
    fn read_color(
        &mut self,
        context: &mut Context<'_>,
        document: &Document,
        index: usize,
        place: &Place,
    ) -> Result<(), GltfFault> {
        let colors: Vec<[f32; 4]> = if document.components(index, place)? == 3 {
            let opaque = |[r, g, b]: [f32; 3]| [r, g, b, 1.0];
            document
                .finite_vectors(index, place)?
                .into_iter()
                .map(opaque)
                .collect()
        } else {
            document.finite_vectors(index, place)?
        };
        let colors = self.per_vertex(colors, place)?;
        let Some(&first) = colors.first() else {
            return Ok(());
        };
        let is_near = |color: &[f32; 4]| color.iter().zip(first).all(|(a, b)| (a - b).abs() < 4e-3);
        let mean = |k: usize| {
            let sum: f64 = colors
                .iter()
                .map(|color| f64::from(color[k].clamp(0.0, 1.0)))
                .sum();
            (sum / colors.len() as f64) as f32
        };
        if !colors.iter().all(is_near) {
            context.warn(
                place,
                "colours of vertices are not interpolated: their mean stands in",
            );
        }
        self.color = std::array::from_fn(mean);
        Ok(())
    }

    fn read_joints(
        &self,
        document: &Document,
        (joints, joints_place): (usize, Place),
        (weights, weights_place): (usize, Place),
    ) -> Result<Vec<[(u32, f32); 4]>, GltfFault> {
        let joints = document.finite_vectors::<4>(joints, &joints_place)?;
        let weights = document.finite_vectors::<4>(weights, &weights_place)?;
        let joints = self.per_vertex(joints, &joints_place)?;
        let weights = self.per_vertex(weights, &weights_place)?;
        let of_vertex = |(joints, weights): (&[f32; 4], &[f32; 4])| {
            std::array::from_fn(|k| (joints[k] as u32, weights[k]))
        };
        Ok(joints.iter().zip(&weights).map(of_vertex).collect())
    }

    /// Adds the targets' differences, each times its weight.
    fn morph(
        &mut self,
        document: &Document,
        (primitive, place): (&Primitive, &Place),
        weights: &[f32],
    ) -> Result<(), GltfFault> {
        for (i, target) in primitive.targets.iter().enumerate() {
            let weight = weights.get(i).copied().unwrap_or(0.0);
            if weight == 0.0 {
                continue;
            }
            let place = place.key("targets").index(i);
            for (name, values) in [
                ("POSITION", &mut self.positions),
                ("NORMAL", &mut self.normals),
                ("TANGENT", &mut self.tangents),
            ] {
                let Some(&accessor) = target.get(name) else {
                    continue;
                };
                let deltas = document.finite_vectors::<3>(accessor, &place.key(name))?;
                for (value, delta) in values.iter_mut().zip(deltas) {
                    *value = std::array::from_fn(|k| value[k] + weight * delta[k]);
                }
            }
        }
        Ok(())
    }

    /// The mesh where `world_from_mesh` puts it. Errors: it reaches too far.
    pub(super) fn place(
        &self,
        world_from_mesh: &DAffine3,
        uv: &UvMap,
        place: &Place,
    ) -> Result<Mesh, GltfFault> {
        let normal_matrix = normal_matrix(world_from_mesh);
        let positions = self.positions.iter();
        let positions = positions.map(|&p| world_from_mesh.transform_point3(vector(p)));
        let normals = self.normals.iter().map(|&n| normal_matrix * vector(n));
        let tangents = self.tangents.iter();
        let tangents = tangents.map(|&t| world_from_mesh.transform_vector3(vector(t)));
        let is_mirrored = world_from_mesh.matrix3.determinant() < 0.0;
        let orientation = if is_mirrored {
            Orientation::Reversed
        } else {
            Orientation::Natural
        };
        self.mesh((positions, normals, tangents), (orientation, uv), place)
    }

    /// The mesh as its joints move it, each by a map from the mesh to the world.
    pub(super) fn skinned(
        &self,
        joints: &[DAffine3],
        uv: &UvMap,
        place: &Place,
    ) -> Result<Mesh, GltfFault> {
        let mut maps = Vec::with_capacity(self.joints.len());
        for vertex in &self.joints {
            maps.push(blend(vertex, joints).ok_or_else(|| {
                place.scene(format!(
                    "a vertex names a joint that its skin has not: it has {}",
                    joints.len()
                ))
            })?);
        }
        let positions = self.positions.iter().zip(&maps);
        let positions = positions.map(|(&p, map)| map.transform_point3(vector(p)));
        let normals = self.normals.iter().zip(&maps);
        let normals = normals.map(|(&n, map)| normal_matrix(map) * vector(n));
        let tangents = self.tangents.iter().zip(&maps);
        let tangents = tangents.map(|(&t, map)| map.transform_vector3(vector(t)));
        let vertices = (positions, normals, tangents);
        self.mesh(vertices, (Orientation::Natural, uv), place)
    }

    fn mesh(
        &self,
        (positions, normals, tangents): (
            impl Iterator<Item = DVec3>,
            impl Iterator<Item = DVec3>,
            impl Iterator<Item = DVec3>,
        ),
        (orientation, uv): (Orientation, &UvMap),
        place: &Place,
    ) -> Result<Mesh, GltfFault> {
        let mut placed = Vec::with_capacity(self.positions.len());
        for position in positions {
            let is_near = position.abs().max_element() <= FARTHEST;
            if !is_near {
                let message = format!("a coordinate is beyond {FARTHEST:e}");
                return Err(place.fault(ErrorKind::Limit, message));
            }
            placed.push(position.as_vec3());
        }
        let uvs = self.uvs[uv.set.min(1)].iter();
        Ok(Mesh {
            positions: placed,
            normals: normals.map(unit).collect(),
            tangents: tangents.map(unit).collect(),
            uvs: uvs.map(|&at| uv.apply(at)).collect(),
            triangles: self.triangles.clone(),
            orientation,
        })
    }
}

fn vector(v: [f32; 3]) -> DVec3 {
    DVec3::from(v.map(f64::from))
}

fn unit(v: DVec3) -> Vec3 {
    v.normalize_or_zero().as_vec3()
}

/// What normals are mapped by, up to scale: the matrix of cofactors, which is there for flat maps too.
fn normal_matrix(map: &DAffine3) -> glam::DMat3 {
    let m = map.matrix3;
    let sign = if m.determinant() < 0.0 { -1.0 } else { 1.0 };
    let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis];
    glam::DMat3::from_cols(y.cross(z) * sign, z.cross(x) * sign, x.cross(y) * sign)
}

/// The weighted mean of joints' maps. None: there is no such joint.
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

/// The triangles of a primitive, from triangles, strips or fans.
fn triangles(
    document: &Document,
    primitive: &Primitive,
    place: &Place,
    vertices: usize,
) -> Result<Vec<[u32; 3]>, GltfFault> {
    let indices = match primitive.indices {
        Some(index) => {
            let place = place.key("indices");
            let indices = document.indices(index, &place)?;
            if let Some(index) = indices.iter().find(|&&index| index as usize >= vertices) {
                let message =
                    format!("index {index} is not that of a vertex: there are {vertices}");
                return Err(place.scene(message));
            }
            indices
        }
        None => (0..vertices as u32).collect(),
    };
    let count = indices.len();
    let triangle = |corners: [usize; 3]| corners.map(|corner| indices[corner]);
    Ok(match primitive.mode.unwrap_or(4) {
        4 => indices.as_chunks::<3>().0.to_vec(),
        5 => (0..count.saturating_sub(2))
            .map(|i| triangle([i, i + 1 + i % 2, i + 2 - i % 2]))
            .collect(),
        6 => (1..count.saturating_sub(1))
            .map(|i| triangle([i, i + 1, 0]))
            .collect(),
        mode => {
            let message = format!("{mode} is no mode of a primitive: they are 0 to 6");
            return Err(place.key("mode").scene(message));
        }
    })
}

/// The maps of a node's skin from the mesh to the world, by joint.
pub(super) fn joints(
    document: &Document,
    world_from_node: &[Option<DAffine3>],
    skin: usize,
    user: &Place,
) -> Result<Vec<DAffine3>, GltfFault> {
    let Some(of_skin) = document.root.skins.get(skin) else {
        let count = document.root.skins.len();
        return Err(user.scene(format!("there is no skin {skin}: the file has {count}")));
    };
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
        let world_from_joint = world_from_node.get(joint).copied().flatten();
        let missing = || {
            place
                .index(i)
                .scene(format!("node {joint} is not in the scene"))
        };
        Ok(world_from_joint.ok_or_else(missing)? * inverse[i])
    };
    of_skin.joints.iter().enumerate().map(of_joint).collect()
}

/// The places of a mesh in its node: one, or those that EXT_mesh_gpu_instancing names.
pub(super) fn places(
    document: &Document,
    node: &Node,
    place: &Place,
) -> Result<Vec<DAffine3>, GltfFault> {
    let Some(instancing) = &node.extensions.instancing else {
        return Ok(vec![DAffine3::IDENTITY]);
    };
    let place = place
        .key("extensions")
        .key("EXT_mesh_gpu_instancing")
        .key("attributes");
    let attributes: &BTreeMap<String, usize> = &instancing.attributes;
    let find = |name: &str| attributes.get(name).map(|&index| (index, place.key(name)));
    let translations =
        find("TRANSLATION").map(|(index, place)| document.finite_vectors::<3>(index, &place));
    let rotations =
        find("ROTATION").map(|(index, place)| document.finite_vectors::<4>(index, &place));
    let scales = find("SCALE").map(|(index, place)| document.finite_vectors::<3>(index, &place));
    let (translations, rotations, scales) = (
        translations.transpose()?,
        rotations.transpose()?,
        scales.transpose()?,
    );
    let counts = [
        translations.as_ref().map(Vec::len),
        rotations.as_ref().map(Vec::len),
        scales.as_ref().map(Vec::len),
    ];
    let count = counts.into_iter().flatten().max().unwrap_or(1);
    if counts.into_iter().flatten().any(|other| other != count) {
        return Err(place.scene("the attributes have different counts"));
    }
    let at = |i: usize| {
        let of =
            |values: &Option<Vec<[f32; 3]>>| values.as_ref().map(|values| values[i].map(f64::from));
        let rotation = rotations.as_ref().map(|values| values[i].map(f64::from));
        super::node::from_parts(of(&translations), rotation, of(&scales))
    };
    Ok((0..count).map(at).collect())
}

//! Reads the attributes and triangles of primitives.

mod places;
mod placing;

pub(super) use places::{joints, places};

use super::document::{Context, Document};
use super::json::Primitive;
use super::place::{GltfFault, Place};
use crate::repair::{self, Repairs};
use bidir::math::{Affine2, Vec2};
use bidir::texture::Mapping;

/// A primitive in the space of its mesh, with default morph weights applied.
#[derive(Clone, Debug, Default)]
pub(super) struct Surface {
    pub(super) positions: Vec<[f32; 3]>,
    /// The normals. Empty: faces are flat.
    pub(super) normals: Vec<[f32; 3]>,
    /// The tangents. Empty: they follow the first axis of the texture coordinates.
    pub(super) tangents: Vec<[f32; 3]>,
    /// Two sets of texture coordinates; empty if the file has none.
    pub(super) uvs: [Vec<[f32; 2]>; 2],
    pub(super) triangles: Vec<[u32; 3]>,
    /// The mean colour of the vertices, a factor on the base colour: red, green, blue, alpha.
    pub(super) color: [f32; 4],
    /// The joints of each vertex, with their weights. Empty: the surface has no skin.
    pub(super) joints: Vec<[(u32, f32); 4]>,
}

/// The map from texture coordinates to the parameters of the built mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct UvMap {
    /// The set of texture coordinates.
    pub(super) set: usize,
    /// The rows of an affine map: (u', v') = rows · (u, v, 1).
    pub(super) rows: [[f32; 3]; 2],
}

impl UvMap {
    pub(super) const IDENTITY: Self = Self {
        set: 0,
        rows: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    };

    fn affine(&self) -> Affine2 {
        let [[a, b, c], [d, e, f]] = self.rows;
        Affine2::from_cols(Vec2::new(a, d), Vec2::new(b, e), Vec2::new(c, f))
    }

    /// Returns the identity on the same set of texture coordinates.
    pub(super) fn untransformed(&self) -> Self {
        Self {
            set: self.set,
            ..Self::IDENTITY
        }
    }

    /// Returns true for a map that can be inverted.
    pub(super) fn is_regular(&self) -> bool {
        self.affine().matrix2.determinant().is_normal()
    }

    /// Returns the rest of this map for a mesh whose parameters contain the map `baked`: from these parameters to the
    /// coordinates of bidir's textures, whose v points up. `baked` has to be regular or equal to this map.
    pub(super) fn beyond(&self, baked: &Self) -> Mapping {
        if self == baked {
            return Mapping::IDENTITY;
        }
        let flip = Affine2::from_cols(Vec2::X, -Vec2::Y, Vec2::Y);
        let map = if baked.rows == Self::IDENTITY.rows {
            flip * self.affine() * flip
        } else {
            flip * self.affine() * baked.affine().inverse() * flip
        };
        let [x, y] = [map.matrix2.x_axis, map.matrix2.y_axis];
        if x.y == 0.0 && y.x == 0.0 {
            let (scale, offset) = (Vec2::new(x.x, y.y), map.translation);
            return Mapping::Parameters { scale, offset };
        }
        Mapping::Affine(map)
    }

    /// Maps texture coordinates of the file, whose v points down, to parameters of the built mesh, whose v points up.
    fn apply(&self, [u, v]: [f32; 2]) -> Vec2 {
        let [s, t] = self.rows.map(|[a, b, c]| a * u + b * v + c);
        Vec2::new(s, 1.0 - t)
    }
}

impl Surface {
    /// Reads a primitive. None: it has no triangles; a warning says why.
    pub(super) fn read(
        context: &mut Context<'_>,
        primitive: &Primitive,
        place: &Place,
        weights: &[f32],
    ) -> Result<Option<Self>, GltfFault> {
        let document = context.document;
        let attributes = place.key("attributes");
        let Some(&position) = primitive.attributes.get("POSITION") else {
            let message = "the primitive has no POSITION and is left out";
            context.warn(place.clone(), message);
            return Ok(None);
        };
        let mode = primitive.mode.unwrap_or(4);
        if mode < 4 {
            let message = "points and lines have no surface and are left out";
            context.warn(place.clone(), message);
            return Ok(None);
        }
        let mut surface = Self {
            positions: document.finite_vectors(position, &attributes.key("POSITION"))?,
            color: [1.0; 4],
            ..Self::default()
        };
        surface.triangles = triangles(document, primitive, place, surface.positions.len())?;
        surface.read_attributes(context, primitive, &attributes)?;
        surface.morph(document, primitive, place, weights)?;
        let mut repairs = surface.repair();
        // Strips repeat vertices where they turn.
        if mode != 4 {
            repairs.faces = 0;
        }
        for warning in repairs.warnings() {
            context.warn(place.clone(), warning);
        }
        Ok(Some(surface).filter(|surface| !surface.triangles.is_empty()))
    }

    /// Repairs attributes that cannot be used, and counts triangles without area.
    fn repair(&mut self) -> Repairs {
        let positions = &self.positions;
        let mut repairs = Repairs {
            faces: repair::count_flat(positions, &self.triangles),
            normals: repair::repair_normals(positions, &self.triangles, &mut self.normals),
            ..Repairs::default()
        };
        for uvs in &mut self.uvs {
            repairs.uvs += repair::replace_infinite(uvs, 0.0);
        }
        let tangents = self.tangents.iter();
        let broken = tangents.filter(|tangent| repair::has_no_direction(tangent));
        repairs.tangents = broken.count();
        if repairs.tangents > 0 {
            self.tangents.clear();
        }
        repairs
    }

    /// Sets weights to 0 that are not finite, negative, or of a joint beyond the first `count`. Returns the number
    /// of such weights, and the number of vertices whose weights are all 0.
    pub(super) fn repair_weights(&mut self, count: usize) -> Repairs {
        let mut repairs = Repairs::default();
        for vertex in &mut self.joints {
            for (joint, weight) in &mut *vertex {
                let is_weight = weight.is_finite() && *weight >= 0.0;
                if *weight != 0.0 && !(is_weight && (*joint as usize) < count) {
                    *weight = 0.0;
                    repairs.weights += 1;
                }
            }
            repairs.loose += usize::from(vertex.iter().all(|&(_, weight)| weight == 0.0));
        }
        repairs
    }

    fn read_attributes(
        &mut self,
        context: &mut Context<'_>,
        primitive: &Primitive,
        place: &Place,
    ) -> Result<(), GltfFault> {
        let document = context.document;
        let find = |name: &str| Some((*primitive.attributes.get(name)?, place.key(name)));
        if let Some((index, place)) = find("NORMAL") {
            self.normals = self.per_vertex(document.vectors(index, &place)?, &place)?;
        }
        // The format demands that tangents are ignored if there are no normals.
        let is_smooth = !self.normals.is_empty();
        if let Some((index, place)) = find("TANGENT").filter(|_| is_smooth) {
            let signed = document.vectors::<4>(index, &place)?.into_iter();
            let tangents = signed.map(|[x, y, z, _]| [x, y, z]).collect();
            self.tangents = self.per_vertex(tangents, &place)?;
        }
        for (set, name) in ["TEXCOORD_0", "TEXCOORD_1"].into_iter().enumerate() {
            if let Some((index, place)) = find(name) {
                self.uvs[set] = self.per_vertex(document.vectors(index, &place)?, &place)?;
            }
        }
        if let Some((index, place)) = find("COLOR_0") {
            self.read_color(context, index, &place)?;
        }
        self.joints = self.read_joints(document, find)?;
        if !self.joints.is_empty() && find("JOINTS_1").is_some() {
            let message = "joints beyond the first four of a vertex have no effect";
            context.warn(place.clone(), message);
        }
        Ok(())
    }

    /// Reads the joints of each vertex with their weights; `find` returns the accessor of an attribute, and its place.
    fn read_joints(
        &self,
        document: &Document,
        find: impl Fn(&str) -> Option<(usize, Place)>,
    ) -> Result<Vec<[(u32, f32); 4]>, GltfFault> {
        let (Some((joints, of_joints)), Some((weights, of_weights))) =
            (find("JOINTS_0"), find("WEIGHTS_0"))
        else {
            return Ok(Vec::new());
        };
        let numbers = document.finite_vectors::<4>(joints, &of_joints)?;
        let parts = document.vectors::<4>(weights, &of_weights)?;
        let numbers_and_parts = self
            .per_vertex(numbers, &of_joints)?
            .into_iter()
            .zip(self.per_vertex(parts, &of_weights)?);
        let of_vertex = |(numbers, parts): ([f32; 4], [f32; 4])| {
            std::array::from_fn(|k| (numbers[k] as u32, parts[k]))
        };
        Ok(numbers_and_parts.map(of_vertex).collect())
    }

    /// Checks that there is one value per vertex.
    fn per_vertex<T>(&self, values: Vec<T>, place: &Place) -> Result<Vec<T>, GltfFault> {
        let (vertices, count) = (self.positions.len(), values.len());
        if vertices == count {
            return Ok(values);
        }
        Err(place.scene(format!("there are {count} values for {vertices} positions")))
    }

    /// Reads one colour for all vertices: the mean of their colours.
    fn read_color(
        &mut self,
        context: &mut Context<'_>,
        index: usize,
        place: &Place,
    ) -> Result<(), GltfFault> {
        let document = context.document;
        let colors: Vec<[f32; 4]> = if document.components(index, place)? == 3 {
            let opaque = |[r, g, b]: [f32; 3]| [r, g, b, 1.0];
            let colors = document.vectors(index, place)?.into_iter();
            colors.map(opaque).collect()
        } else {
            document.vectors(index, place)?
        };
        let mut colors = self.per_vertex(colors, place)?;
        let repairs = Repairs {
            colors: repair::replace_infinite(&mut colors, 1.0),
            ..Repairs::default()
        };
        for warning in repairs.warnings() {
            context.warn(place.clone(), warning);
        }
        let Some(&first) = colors.first() else {
            return Ok(());
        };
        let is_near = |color: &[f32; 4]| color.iter().zip(first).all(|(a, b)| (a - b).abs() < 4e-3);
        let mean = |k: usize| {
            let channel = colors
                .iter()
                .map(|color| f64::from(color[k].clamp(0.0, 1.0)));
            (channel.sum::<f64>() / colors.len() as f64) as f32
        };
        if !colors.iter().all(is_near) {
            let message = "vertex colours are not interpolated: their mean is used";
            context.warn(place.clone(), message);
        }
        self.color = std::array::from_fn(mean);
        Ok(())
    }

    /// Adds the displacements of morph targets, each times its weight.
    fn morph(
        &mut self,
        document: &Document,
        primitive: &Primitive,
        place: &Place,
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
                let place = place.key(name);
                let deltas = if name == "POSITION" {
                    document.finite_vectors::<3>(accessor, &place)?
                } else {
                    document.vectors(accessor, &place)?
                };
                for (value, delta) in values.iter_mut().zip(deltas) {
                    *value = std::array::from_fn(|k| value[k] + weight * delta[k]);
                }
            }
        }
        Ok(())
    }
}

/// Reads the triangles of a primitive from triangles, strips or fans.
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
                let message = format!("there is no vertex {index}: the mesh has {vertices}");
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
            let message = format!("{mode} is not a primitive mode: modes are 0 to 6");
            return Err(place.key("mode").scene(message));
        }
    })
}

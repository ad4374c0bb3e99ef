//! Reads triangle meshes from PLY files: ASCII and binary of either byte order, packed or not.
//!
//! Reads `x y z`, `nx ny nz` and the first complete pair of `u v`, `s t`, `texture_u texture_v`,
//! `texture_s texture_t` of the `vertex` element, and the list `vertex_indices` of the `face` element.
//! Everything else is skipped. A quadrilateral a b c d becomes (a, b, c) and (a, c, d); faces with fewer
//! or more corners are skipped and counted.
//!
//! The crates `serde-ply` and `ply-rs-bw` are not used: they read a list of a million faces into a million
//! vectors, and do not report which element of a file is broken.

mod body;
mod header;

use crate::error::{Error, ErrorKind, Place, Result};
use crate::{bytes, limits};
use body::Body;
use header::{Element, Header, PropertyKind};
use std::path::Path;

/// A mesh of triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlyMesh {
    /// The vertices: finite, at least one.
    pub positions: Vec<[f32; 3]>,
    /// One normal per vertex, not normalised. Shape: empty if the file has none.
    pub normals: Vec<[f32; 3]>,
    /// One pair of texture coordinates per vertex. Shape: empty if the file has none.
    pub uvs: Vec<[f32; 2]>,
    /// Valid indices of vertices.
    pub triangles: Vec<[u32; 3]>,
    /// The number of faces that are neither triangles nor quadrilaterals.
    pub skipped_faces: usize,
}

/// An error within a file, whose name the caller knows.
struct Broken {
    message: String,
    /// Line and column, both counted from 1. None: the file is binary.
    place: Option<(usize, usize)>,
}

impl Broken {
    fn new(message: impl Into<String>) -> Self {
        Self {
            message: message.into(),
            place: None,
        }
    }

    /// Adds the name and number of the element to the message.
    fn of(self, element: &str, index: usize) -> Self {
        Self {
            message: format!("{element} {index}: {}", self.message),
            ..self
        }
    }
}

/// Reads the mesh of a file, which may be packed.
pub fn read(path: &Path) -> Result<PlyMesh> {
    let bytes = bytes::read(path, limits::LARGEST_MESH)?.bytes;
    parse(&bytes).map_err(|error| error.in_file(path))
}

/// Reads the mesh in `bytes`, which are not packed.
pub fn parse(bytes: &[u8]) -> Result<PlyMesh> {
    parse_mesh(bytes).map_err(|broken| {
        let error = Error::new(ErrorKind::Data, broken.message);
        match broken.place {
            Some((line, column)) => error.at(Place {
                line,
                column,
                excerpt: None,
            }),
            None => error,
        }
    })
}

fn parse_mesh(bytes: &[u8]) -> Result<PlyMesh, Broken> {
    let (header, rest) = Header::parse(bytes)?;
    let count_of = |name| {
        header
            .elements
            .iter()
            .find(|element| element.name == name)
            .map(|e| e.count)
    };
    let Some(vertices @ 1..) = count_of("vertex") else {
        return Err(Broken::new("no vertices"));
    };
    let Some(1..) = count_of("face") else {
        return Err(Broken::new("no faces"));
    };
    if u32::try_from(vertices).is_err() {
        return Err(Broken::new("more vertices than 32-bit indices can address"));
    }
    let mut body = Body::new(header.format, rest, header.lines);
    let mut mesh = PlyMesh::default();
    for element in &header.elements {
        body.check_room(element)?;
        match element.name.as_str() {
            "vertex" if mesh.positions.is_empty() => read_vertices(&mut body, element, &mut mesh)?,
            "face" if mesh.triangles.is_empty() => {
                read_faces(&mut body, element, vertices, &mut mesh)?;
            }
            _ => skip(&mut body, element)?,
        }
    }
    Ok(mesh)
}

/// The numbers of a vertex: position, normal, uv.
type VertexRow = [f32; 8];

/// The places of a vertex's properties in a [`VertexRow`].
struct Columns {
    slots: Vec<Option<usize>>,
    has_normal: bool,
    has_uv: bool,
}

impl Columns {
    fn find(vertex: &Element) -> Result<Self, Broken> {
        let mut slots = vec![None; vertex.properties.len()];
        let mut assign = |names: &[&str], first_slot: usize| {
            let column = |name: &&str| vertex.properties.iter().position(|p| p.name == **name);
            let columns: Option<Vec<usize>> = names.iter().map(column).collect();
            for (offset, &column) in columns.iter().flatten().enumerate() {
                slots[column] = Some(first_slot + offset);
            }
            columns.is_some()
        };
        if !assign(&["x", "y", "z"], 0) {
            return Err(Broken::new("the vertices have no `x`, `y` and `z`"));
        }
        let has_normal = assign(&["nx", "ny", "nz"], 3);
        let pairs = [
            ["u", "v"],
            ["s", "t"],
            ["texture_u", "texture_v"],
            ["texture_s", "texture_t"],
        ];
        let has_uv = pairs.iter().any(|pair| assign(pair, 6));
        Ok(Self {
            slots,
            has_normal,
            has_uv,
        })
    }
}

fn read_vertices(body: &mut Body<'_>, vertex: &Element, mesh: &mut PlyMesh) -> Result<(), Broken> {
    let columns = Columns::find(vertex)?;
    mesh.positions.reserve_exact(vertex.count);
    mesh.normals
        .reserve_exact(if columns.has_normal { vertex.count } else { 0 });
    mesh.uvs
        .reserve_exact(if columns.has_uv { vertex.count } else { 0 });
    for index in 0..vertex.count {
        let row =
            read_vertex(body, vertex, &columns).map_err(|broken| broken.of("vertex", index))?;
        let [x, y, z, nx, ny, nz, u, v] = row;
        mesh.positions.push([x, y, z]);
        if columns.has_normal {
            mesh.normals.push([nx, ny, nz]);
        }
        if columns.has_uv {
            mesh.uvs.push([u, v]);
        }
    }
    Ok(())
}

fn read_vertex(
    body: &mut Body<'_>,
    vertex: &Element,
    columns: &Columns,
) -> Result<VertexRow, Broken> {
    let mut row = VertexRow::default();
    for (property, slot) in vertex.properties.iter().zip(&columns.slots) {
        let (PropertyKind::Scalar(scalar), &Some(slot)) = (property.kind, slot) else {
            body.skip(property.kind)?;
            continue;
        };
        let value = body.scalar(scalar)? as f32;
        if !value.is_finite() {
            return Err(body.broken(format!("`{}` is not a finite number", property.name)));
        }
        row[slot] = value;
    }
    Ok(row)
}

fn read_faces(
    body: &mut Body<'_>,
    face: &Element,
    vertices: usize,
    mesh: &mut PlyMesh,
) -> Result<(), Broken> {
    let list = face.properties.iter().position(|property| {
        property.name == "vertex_indices" && matches!(property.kind, PropertyKind::List { .. })
    });
    let Some(list) = list else {
        return Err(Broken::new("the faces have no list `vertex_indices`"));
    };
    mesh.triangles.reserve(face.count);
    for index in 0..face.count {
        for (column, property) in face.properties.iter().enumerate() {
            let corners = if column == list {
                read_corners(body, property.kind, vertices)
            } else {
                body.skip(property.kind).map(|()| Corners::None)
            };
            match corners.map_err(|broken| broken.of("face", index))? {
                Corners::None => {}
                Corners::Triangle(corners) => mesh.triangles.push(corners),
                Corners::Quad([a, b, c, d]) => mesh.triangles.extend([[a, b, c], [a, c, d]]),
                Corners::Other => mesh.skipped_faces += 1,
            }
        }
    }
    Ok(())
}

/// The corners of a face.
enum Corners {
    None,
    Triangle([u32; 3]),
    Quad([u32; 4]),
    Other,
}

fn read_corners(
    body: &mut Body<'_>,
    kind: PropertyKind,
    vertices: usize,
) -> Result<Corners, Broken> {
    let PropertyKind::List { item, .. } = kind else {
        return Ok(Corners::None);
    };
    let count = body.list_length(kind)?;
    if count != 3 && count != 4 {
        body.skip_scalars(item, count)?;
        return Ok(Corners::Other);
    }
    let mut corners = [0; 4];
    for corner in &mut corners[..count] {
        let value = body.scalar(item)?;
        if !(value >= 0.0 && value < vertices as f64 && value.fract() == 0.0) {
            let message = format!("there is no vertex {value}: the mesh has {vertices}");
            return Err(body.broken(message));
        }
        *corner = value as u32;
    }
    let [a, b, c, _] = corners;
    Ok(if count == 3 {
        Corners::Triangle([a, b, c])
    } else {
        Corners::Quad(corners)
    })
}

fn skip(body: &mut Body<'_>, element: &Element) -> Result<(), Broken> {
    for index in 0..element.count {
        for property in &element.properties {
            body.skip(property.kind)
                .map_err(|broken| broken.of(&element.name, index))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;

//! Reads triangle meshes from PLY files: ASCII and binary of either byte order, packed or not.
//!
//! Reads `x y z`, `nx ny nz` and the first complete pair of `u v`, `s t`, `texture_u texture_v`,
//! `texture_s texture_t` of the `vertex` element, and the list `vertex_indices`, also called `vertex_index`, of
//! the `face` element. Everything else is skipped. A quadrilateral a b c d becomes (a, b, c) and (a, c, d)
//! if both lie within it; other polygons become triangles by `polygon`. Normals and texture coordinates that
//! cannot be used are repaired, and counted.
//!
//! The crates `serde-ply` and `ply-rs-bw` are not used: they allocate a vector for each face, and do not report
//! which element of a file is broken.

mod body;
mod header;
mod polygon;

use crate::error::{Error, ErrorKind, Place, Result};
use crate::repair::{self, Repairs};
use crate::{bytes, limits};
use body::Body;
use header::{Element, Header, Property, PropertyKind};
use polygon::Splitter;
use std::ops::Range;
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
    /// For each face, the index past its last triangle. Shape: empty if every triangle is a face.
    pub faces: Vec<u32>,
    /// The counts of repaired defects.
    pub repairs: Repairs,
}

impl PlyMesh {
    /// Repairs attributes that cannot be used, and counts faces without area.
    pub(crate) fn repair(&mut self) {
        let (positions, repairs) = (&self.positions, &mut self.repairs);
        repairs.faces += repair::count_flat(positions, &self.triangles);
        repairs.uvs += repair::replace_infinite(&mut self.uvs, 0.0);
        repairs.normals += repair::repair_normals(positions, &self.triangles, &mut self.normals);
    }

    /// Adds a face that was divided into triangles.
    pub(crate) fn add_face(&mut self, triangles: impl IntoIterator<Item = [u32; 3]>) {
        let first = self.triangles.len();
        self.triangles.extend(triangles);
        self.end_face(first);
    }

    /// Ends a face that has the triangles from index `first` on, if there are any.
    fn end_face(&mut self, first: usize) {
        let (first, end) = (first as u32, self.triangles.len() as u32);
        if end == first {
            return;
        }
        if self.faces.is_empty() {
            if end == first + 1 {
                return;
            }
            self.faces.extend(1..=first);
        }
        self.faces.push(end);
    }

    /// Returns the number of faces.
    pub(crate) fn face_count(&self) -> usize {
        if self.faces.is_empty() {
            self.triangles.len()
        } else {
            self.faces.len()
        }
    }

    /// Returns the range of triangles of each face.
    pub(crate) fn faces(&self) -> Vec<Range<usize>> {
        if self.faces.is_empty() {
            return (0..self.triangles.len()).map(|i| i..i + 1).collect();
        }
        let ends = self.faces.iter().map(|&end| end as usize);
        let starts = std::iter::once(0).chain(ends.clone());
        starts.zip(ends).map(|(start, end)| start..end).collect()
    }
}

/// Returns an error of a file without its name, which the caller adds.
fn broken(message: impl Into<String>) -> Error {
    Error::new(ErrorKind::Data, message)
}

/// Returns the place in a text after the bytes `before`.
fn place(before: &[u8]) -> Place {
    let lines = before.rsplit(|&byte| byte == b'\n');
    Place {
        line: lines.clone().count(),
        column: 1 + lines.take(1).map(<[u8]>::len).sum::<usize>(),
        excerpt: None,
    }
}

/// Reads the mesh of a file, which may be packed.
pub fn read(path: &Path) -> Result<PlyMesh> {
    let bytes = bytes::read(path, limits::LARGEST_MESH)?.bytes;
    parse(&bytes).map_err(|error| error.in_file(path))
}

/// Reads the mesh in `bytes`, which are not packed.
pub fn parse(bytes: &[u8]) -> Result<PlyMesh> {
    let (header, rest) = Header::parse(bytes)?;
    let count_of = |name| {
        header
            .elements
            .iter()
            .find(|element| element.name == name)
            .map(|e| e.count)
    };
    let Some(vertices @ 1..) = count_of("vertex") else {
        return Err(broken("no vertices"));
    };
    let Some(1..) = count_of("face") else {
        return Err(broken("no faces"));
    };
    if u32::try_from(vertices).is_err() {
        return Err(broken("more vertices than 32-bit indices can address"));
    }
    let mut body = Body::new(header.format, bytes, rest);
    let mut mesh = PlyMesh::default();
    let mut polygons = Vec::new();
    for element in &header.elements {
        body.check_room(element)?;
        match element.name.as_str() {
            "vertex" if mesh.positions.is_empty() => read_vertices(&mut body, element, &mut mesh)?,
            "face" if mesh.triangles.is_empty() => {
                polygons = read_faces(&mut body, element, vertices, &mut mesh)?;
            }
            _ => skip(&mut body, element)?,
        }
    }
    // Faces may stand before their vertices.
    let tests = limits::EARS.of(bytes.len() as u64);
    let mut splitter = Splitter::new(&mesh.positions, tests);
    for fan in polygons {
        splitter.split(&mut mesh.triangles[fan])?;
    }
    mesh.repairs.crossing = splitter.crossing;
    mesh.repair();
    Ok(mesh)
}

/// The numbers of a vertex: position, normal, uv.
type VertexRow = [f32; 8];
/// The number of columns of the position.
const POSITION: usize = 3;

/// The index of each vertex property in a [`VertexRow`].
struct Columns {
    slots: Vec<Option<usize>>,
    has_normal: bool,
    has_uv: bool,
}

impl Columns {
    fn find(vertex: &Element) -> Result<Self> {
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
            return Err(broken("the vertices have no `x`, `y` and `z`"));
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

fn read_vertices(body: &mut Body<'_>, vertex: &Element, mesh: &mut PlyMesh) -> Result<()> {
    let columns = Columns::find(vertex)?;
    mesh.positions.reserve_exact(vertex.count);
    mesh.normals
        .reserve_exact(if columns.has_normal { vertex.count } else { 0 });
    mesh.uvs
        .reserve_exact(if columns.has_uv { vertex.count } else { 0 });
    for index in 0..vertex.count {
        let row = read_vertex(body, vertex, &columns);
        let [x, y, z, nx, ny, nz, u, v] = row.map_err(|error| error.of("vertex", index))?;
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

fn read_vertex(body: &mut Body<'_>, vertex: &Element, columns: &Columns) -> Result<VertexRow> {
    let mut row = VertexRow::default();
    for (property, slot) in vertex.properties.iter().zip(&columns.slots) {
        let (PropertyKind::Scalar(scalar), &Some(slot)) = (property.kind, slot) else {
            body.skip(property.kind)?;
            continue;
        };
        let value = body.scalar(scalar)? as f32;
        if slot < POSITION && !value.is_finite() {
            return Err(body.broken(format!("`{}` is not a finite number", property.name)));
        }
        row[slot] = value;
    }
    Ok(row)
}

/// The names of the list of a face's corners.
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// Reads the faces as fans. Returns the range of triangles of each face with more than three corners.
fn read_faces(
    body: &mut Body<'_>,
    face: &Element,
    vertices: usize,
    mesh: &mut PlyMesh,
) -> Result<Vec<Range<usize>>> {
    let is_corners = |property: &Property| {
        let is_list = matches!(property.kind, PropertyKind::List { .. });
        is_list && CORNERS.contains(&property.name.as_str())
    };
    let Some(list) = face.properties.iter().position(is_corners) else {
        return Err(no_corners(face));
    };
    mesh.triangles.reserve(face.count);
    let mut polygons = Vec::new();
    for index in 0..face.count {
        for (column, property) in face.properties.iter().enumerate() {
            let read = if column == list {
                read_corners(body, property.kind, vertices, mesh)
            } else {
                body.skip(property.kind).map(|()| 0..0)
            };
            let fan = read.map_err(|error| error.of("face", index))?;
            mesh.end_face(fan.start);
            if fan.len() > 1 {
                polygons.push(fan);
            }
        }
    }
    Ok(polygons)
}

/// Returns the error of faces without a list of corners, which names the properties that they have.
fn no_corners(face: &Element) -> Error {
    let names = face.properties.iter().map(|p| format!("`{}`", p.name));
    let found = match names.collect::<Vec<_>>().join(", ") {
        nothing if nothing.is_empty() => "nothing".into(),
        found => found,
    };
    broken(format!(
        "the faces have no list `vertex_indices` or `vertex_index`, but {found}"
    ))
}

/// Reads the corners of a face into a fan of triangles about the first one. Returns the range of the triangles.
fn read_corners(
    body: &mut Body<'_>,
    kind: PropertyKind,
    vertices: usize,
    mesh: &mut PlyMesh,
) -> Result<Range<usize>> {
    let begin = mesh.triangles.len();
    let PropertyKind::List { item, .. } = kind else {
        return Ok(begin..begin);
    };
    let count = body.list_length(kind)?;
    let mut corner = || -> Result<u32> {
        let value = body.scalar(item)?;
        if value >= 0.0 && value < vertices as f64 && value.fract() == 0.0 {
            return Ok(value as u32);
        }
        let message = format!("there is no vertex {value}: the mesh has {vertices}");
        Err(body.broken(message))
    };
    if count < 3 {
        for _ in 0..count {
            corner()?;
        }
        mesh.repairs.faces += 1;
        return Ok(begin..begin);
    }
    let (first, mut last) = (corner()?, corner()?);
    for _ in 2..count {
        let next = corner()?;
        mesh.triangles.push([first, last, next]);
        last = next;
    }
    Ok(begin..mesh.triangles.len())
}

fn skip(body: &mut Body<'_>, element: &Element) -> Result<()> {
    for index in 0..element.count {
        for property in &element.properties {
            body.skip(property.kind)
                .map_err(|error| error.of(&element.name, index))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;

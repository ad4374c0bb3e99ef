//! Meshes of triangles, of patches, and subdivision surfaces.

use super::context::Context;
use super::patches::PatchMesh;
use super::reader::Reader;
use super::subdivision::ControlMesh;
use crate::error::ErrorKind;
use crate::import::vector;
use crate::limits::MOST_LEVELS;
use crate::pbrt::parameters::{Parameter, ParameterType};
use crate::ply::PlyMesh;
use crate::source::{Fault, Span};
use glam::DVec3;

pub(super) fn ply_mesh(reader: &mut Reader<'_, '_>) -> Result<PlyMesh, Fault> {
    let Some((name, span)) = reader.string("filename")? else {
        return Err(reader.missing("string filename"));
    };
    let flat = "the mesh stays as it is";
    reader.unsupported(ParameterType::Texture, "displacement", flat)?;
    reader.ignore(ParameterType::Float, "edgelength");
    let path = reader.context.document.resolve(name);
    let mesh = reader.context.read_mesh(&path, span)?;
    warn_of_repairs(reader, span, &mesh);
    Ok(mesh)
}

fn warn_of_repairs(reader: &mut Reader<'_, '_>, span: Span, mesh: &PlyMesh) {
    for warning in mesh.repairs.warnings() {
        reader.context.warn(span, warning);
    }
}

/// Reads the vertices of a mesh without faces.
fn vertices(reader: &mut Reader<'_, '_>) -> Result<PlyMesh, Fault> {
    let positions = positions(reader)?;
    Ok(PlyMesh {
        normals: attribute(reader, ParameterType::Normal, "N", positions.len()),
        uvs: attribute(reader, ParameterType::Point2, "uv", positions.len()),
        positions,
        ..PlyMesh::default()
    })
}

/// Reads an attribute of `vertices` vertices. If it does not have one value for each, it has no effect, as in pbrt-v4.
fn attribute<const N: usize>(
    reader: &mut Reader<'_, '_>,
    kind: ParameterType,
    name: &'static str,
    vertices: usize,
) -> Vec<[f32; N]> {
    let values = vectors(reader.floats(kind, name));
    let count = values.len();
    if count == 0 || count == vertices {
        return values;
    }
    let message = format!(
        "the mesh has {vertices} points, but {count} values of `{name}`, which have no effect"
    );
    reader.context.warn(reader.span(), message);
    Vec::new()
}

fn positions(reader: &mut Reader<'_, '_>) -> Result<Vec<[f32; 3]>, Fault> {
    let positions = vectors(reader.floats(ParameterType::Point3, "P"));
    if positions.is_empty() {
        return Err(reader.fault("the parameter `point3 P` is missing or empty"));
    }
    Ok(positions)
}

pub(super) fn triangle_mesh(reader: &mut Reader<'_, '_>) -> Result<PlyMesh, Fault> {
    let mut mesh = vertices(reader)?;
    mesh.triangles = faces(reader, mesh.positions.len())?;
    reader.ignore(ParameterType::Vector3, "S");
    reader.ignore(ParameterType::Integer, "faceIndices");
    mesh.repair();
    warn_of_repairs(reader, reader.span(), &mesh);
    Ok(mesh)
}

pub(super) fn patch_mesh(reader: &mut Reader<'_, '_>) -> Result<PlyMesh, Fault> {
    let vertices = vertices(reader)?;
    let patches = faces(reader, vertices.positions.len())?;
    reader.ignore(ParameterType::Integer, "faceIndices");
    // It guides sampling in the reference program, and does not change the emission.
    reader.ignore(ParameterType::String, "emissionfilename");
    let mesh = PatchMesh { vertices, patches };
    let count = mesh.vertex_count();
    reader.context.check_size(count, &reader.span())?;
    Ok(mesh.triangulated())
}

pub(super) fn subdivided_mesh(reader: &mut Reader<'_, '_>) -> Result<PlyMesh, Fault> {
    let positions = positions(reader)?;
    let triangles = faces::<3>(reader, positions.len())?;
    let levels = reader.integer("levels", 3, 0)?;
    reader.ignore(ParameterType::String, "scheme");
    if levels > MOST_LEVELS {
        let message = format!("{levels} steps of subdivision are too many: at most {MOST_LEVELS}");
        return Err(Fault::new(ErrorKind::Limit, reader.span(), message));
    }
    let count = (triangles.len() as u64) << (2 * levels);
    reader.context.check_size(count, &reader.span())?;
    let points = positions.iter().copied().map(vector);
    let control = ControlMesh {
        points: points.collect(),
        triangles,
    };
    let subdivided = control.subdivide(levels);
    let (mesh, normals) = subdivided.map_err(|reason| reader.fault(reason))?;
    let single = |p: &DVec3| p.as_vec3().to_array();
    Ok(PlyMesh {
        positions: mesh.points.iter().map(single).collect(),
        normals: normals.iter().map(single).collect(),
        triangles: mesh.triangles,
        ..PlyMesh::default()
    })
}

fn vectors<const N: usize>(values: Option<&[f32]>) -> Vec<[f32; N]> {
    values.unwrap_or_default().as_chunks::<N>().0.to_vec()
}

/// Reads faces of `N` corners. Without a list of indices, the `N` vertices are one face.
fn faces<const N: usize>(
    reader: &mut Reader<'_, '_>,
    vertices: usize,
) -> Result<Vec<[u32; N]>, Fault> {
    match reader.find(ParameterType::Integer, "indices") {
        Some(parameter) => listed_faces(reader.context, parameter, vertices),
        None if vertices == N => Ok(vec![std::array::from_fn(|corner| corner as u32)]),
        None => Err(reader.missing("integer indices")),
    }
}

fn listed_faces<const N: usize>(
    context: &mut Context<'_>,
    parameter: &Parameter,
    vertices: usize,
) -> Result<Vec<[u32; N]>, Fault> {
    let indices = parameter.values.integers();
    let is_vertex = |&index: &i32| usize::try_from(index).is_ok_and(|index| index < vertices);
    if let Some(index) = indices.iter().find(|index| !is_vertex(index)) {
        let message = format!("there is no point {index}: the mesh has {vertices}");
        return Err(Fault::scene(parameter.value_span, message));
    }
    let (faces, rest) = indices.as_chunks::<N>();
    if !rest.is_empty() {
        let what = if N == 3 { "triangles" } else { "patches" };
        let message =
            format!("the last indices do not make a whole number of {what} and are left out");
        context.warn(parameter.value_span, message);
    }
    let unsigned = |corners: &[i32; N]| corners.map(|corner| corner as u32);
    Ok(faces.iter().map(unsigned).collect())
}

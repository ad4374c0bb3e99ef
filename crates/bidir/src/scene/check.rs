//! The checks of the parts of a scene, before rays are traced in it.

use super::{Opacity, PrimitiveRef, SceneError, Surface};
use crate::shape::{Mesh, Shape};

/// Checks the shapes of these `numbers`, and appends their primitives.
pub(super) fn gather_primitives(
    shapes: &[Shape],
    surfaces: &[Surface],
    numbers: &[usize],
    primitives: &mut Vec<PrimitiveRef>,
) -> Result<(), SceneError> {
    for &number in numbers {
        let shape = &shapes[number];
        check_shape(number, shape)?;
        if surfaces[number].opacity == Opacity::Invisible {
            continue;
        }
        primitives.extend((0..shape.primitive_count()).map(|index| PrimitiveRef {
            shape: number as u32,
            index: index as u32,
        }));
    }
    Ok(())
}

pub(super) fn check_shape(number: usize, shape: &Shape) -> Result<(), SceneError> {
    let finite = match shape {
        Shape::Mesh(mesh) => {
            check_indices(number, mesh)?;
            mesh.positions
                .iter()
                .chain(&mesh.normals)
                .chain(&mesh.tangents)
                .all(|v| v.is_finite())
                && mesh.uvs.iter().all(|uv| uv.is_finite())
        }
        Shape::Sphere(_) | Shape::Disk(_) | Shape::Cylinder(_) => {
            let bounds = shape.primitive(0).bounds();
            bounds.min.is_finite() && bounds.max.is_finite() && shape.primitive_area(0).is_finite()
        }
    };
    if finite {
        Ok(())
    } else {
        Err(SceneError::NotFinite { shape: number })
    }
}

fn check_indices(shape: usize, mesh: &Mesh) -> Result<(), SceneError> {
    let vertices = mesh.positions.len();
    for (what, count) in [
        ("normals", mesh.normals.len()),
        ("tangents", mesh.tangents.len()),
        ("parameters", mesh.uvs.len()),
    ] {
        if count != 0 && count != vertices {
            return Err(SceneError::AttributeCount {
                shape,
                vertices,
                count,
                what,
            });
        }
    }
    for (triangle, indices) in mesh.triangles.iter().enumerate() {
        if let Some(&vertex) = indices.iter().find(|&&vertex| vertex as usize >= vertices) {
            return Err(SceneError::VertexIndex {
                shape,
                triangle,
                vertex,
                vertices,
            });
        }
    }
    Ok(())
}

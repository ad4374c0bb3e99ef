//! Shapes.

use super::context::Context;
use super::mesh;
use super::reader::Reader;
use super::texture::Textures;
use crate::error::ErrorKind;
use crate::import::{Survey, VertexError, box_corners};
use crate::pbrt::scene::ShapeDescription;
use crate::ply::PlyMesh;
use crate::source::{Fault, Span};
use bidir::math::{Vec2, Vec3};
use bidir::shape::{Cylinder, Disk, Mesh, Orientation, Shape, Sphere};
use bidir::texture::FloatTexture;
use glam::{DAffine3, DMat3, DVec3};

/// A shape in its own space, ready to be placed any number of times.
pub(super) enum Geometry {
    Mesh(PlyMesh),
    /// Radius, then lowest and highest z and largest azimuth (radians).
    Sphere(f32, Vec3),
    /// Height, inner and outer radius, largest azimuth (radians).
    Disk(f32, [f32; 2], f32),
    /// Radius, then lowest and highest z and largest azimuth (radians).
    Cylinder(f32, Vec3),
}

impl Geometry {
    /// Reads a shape with its alpha (None: it is opaque). None: its substitute is nothing.
    pub(super) fn read(
        context: &mut Context<'_>,
        textures: &mut Textures<'_>,
        shape: &ShapeDescription,
    ) -> Result<Option<(Self, Option<FloatTexture>)>, Fault> {
        let entity = &shape.entity;
        let mut reader = Reader::new(entity);
        let geometry = match entity.kind.as_str() {
            "trianglemesh" => Self::Mesh(mesh::triangle_mesh(context, &mut reader)?),
            "plymesh" => Self::Mesh(mesh::ply_mesh(context, &mut reader)?),
            "bilinearmesh" => Self::Mesh(mesh::patch_mesh(context, &mut reader)?),
            "loopsubdiv" => Self::Mesh(mesh::subdivided_mesh(context, &mut reader)?),
            "sphere" => {
                let radius = reader.float_within("radius", 1.0, [f32::MIN_POSITIVE, f32::MAX])?;
                let z = [
                    reader.float("zmin", -radius)?,
                    reader.float("zmax", radius)?,
                ];
                Self::Sphere(radius, Vec3::new(z[0], z[1], phi_max(&mut reader)?))
            }
            "cylinder" => {
                let radius = reader.float_within("radius", 1.0, [f32::MIN_POSITIVE, f32::MAX])?;
                let z = [reader.float("zmin", -1.0)?, reader.float("zmax", 1.0)?];
                Self::Cylinder(radius, Vec3::new(z[0], z[1], phi_max(&mut reader)?))
            }
            "disk" => {
                let height = reader.float("height", 0.0)?;
                let radius = reader.float_within("radius", 1.0, [f32::MIN_POSITIVE, f32::MAX])?;
                let inner = reader.float_within("innerradius", 0.0, [0.0, radius])?;
                Self::Disk(height, [inner, radius], phi_max(&mut reader)?)
            }
            kind => {
                context.unsupported(
                    entity.span,
                    &format!("the shape `{kind}`"),
                    "it is left out",
                )?;
                return Ok(None);
            }
        };
        let alpha = textures.float(context, &mut reader, "alpha")?;
        reader.finish()?;
        Ok(Some((geometry, alpha)))
    }

    /// The number of primitives.
    pub(super) fn primitives(&self) -> u64 {
        match self {
            Self::Mesh(mesh) => mesh.triangles.len() as u64,
            Self::Sphere(..) | Self::Disk(..) | Self::Cylinder(..) => 1,
        }
    }

    /// The number of vertices that are kept.
    pub(super) fn vertices(&self) -> u64 {
        match self {
            Self::Mesh(mesh) => mesh.positions.len() as u64,
            Self::Sphere(..) | Self::Disk(..) | Self::Cylinder(..) => 0,
        }
    }

    /// Two corners of a box around a quadric. None: it is a mesh.
    fn quadric_box(&self) -> Option<[DVec3; 2]> {
        let (radius, low, high) = match self {
            Self::Mesh(_) => return None,
            Self::Sphere(radius, z) | Self::Cylinder(radius, z) => (*radius, z.x, z.y),
            Self::Disk(height, [_, radius], _) => (*radius, *height, *height),
        };
        let corner = |sign: f32, z: f32| Vec3::new(sign * radius, sign * radius, z).as_dvec3();
        Some([corner(-1.0, low.min(high)), corner(1.0, low.max(high))])
    }

    /// The error of the vertices as the file holds them, of a shape that `linear` takes to the world.
    pub(super) fn vertex_error(&self, linear: &DMat3) -> Option<VertexError> {
        match self {
            Self::Mesh(mesh) => VertexError::of(&mesh.positions, linear),
            Self::Sphere(..) | Self::Disk(..) | Self::Cylinder(..) => None,
        }
    }

    /// The shape at a place, of which `survey` takes note. Mirroring does not change which side is the front: of a quadric it is
    /// the outside, of a mesh what its corners say in its own space.
    pub(super) fn place(
        &self,
        world_from_local: &DAffine3,
        orientation: Orientation,
        survey: &mut Survey,
    ) -> Shape {
        let affine = world_from_local.as_affine3a();
        if let Some(corners) = self.quadric_box() {
            survey.include_box(corners, world_from_local);
        }
        match self {
            Self::Sphere(radius, limits) => {
                Shape::Sphere(Sphere::partial(affine, *radius, *limits, orientation))
            }
            Self::Cylinder(radius, limits) => {
                Shape::Cylinder(Cylinder::new(affine, *radius, *limits, orientation))
            }
            Self::Disk(height, radii, phi_max) => {
                Shape::Disk(Disk::new(affine, *height, *radii, *phi_max, orientation))
            }
            Self::Mesh(mesh) => {
                Shape::Mesh(place_mesh(mesh, world_from_local, orientation, survey))
            }
        }
    }
}

/// The farthest that anything is from the origin: squares of distances stay finite below it.
const FARTHEST: f32 = 1e12;

fn too_far(span: Span) -> Fault {
    Fault::new(
        ErrorKind::Limit,
        span,
        format!("a coordinate is beyond {FARTHEST:e}"),
    )
}

/// Refuses points of the world that are too far away.
pub(super) fn check_point(span: Span, point: DVec3) -> Result<(), Fault> {
    // Also true for NaN.
    if point.abs().max_element() <= f64::from(FARTHEST) && point.is_finite() {
        Ok(())
    } else {
        Err(too_far(span))
    }
}

/// Refuses instances that reach too far, of an object between two corners.
pub(super) fn check_instance(
    span: Span,
    world_from_object: &DAffine3,
    corners: [DVec3; 2],
) -> Result<(), Fault> {
    let mut corners = box_corners(corners);
    corners.try_for_each(|corner| check_point(span, world_from_object.transform_point3(corner)))
}

/// Refuses shapes that reach too far to compute with.
pub(super) fn check_extent(span: Span, shape: &Shape) -> Result<(), Fault> {
    let is_near = |p: Vec3| p.is_finite() && p.abs().max_element() <= FARTHEST;
    let fits = match shape {
        Shape::Mesh(mesh) => mesh.positions.iter().all(|&p| is_near(p)),
        Shape::Sphere(_) | Shape::Disk(_) | Shape::Cylinder(_) => {
            let bounds = shape.primitive(0).bounds();
            is_near(bounds.min) && is_near(bounds.max)
        }
    };
    if fits { Ok(()) } else { Err(too_far(span)) }
}

fn place_mesh(
    mesh: &PlyMesh,
    world_from_local: &DAffine3,
    orientation: Orientation,
    survey: &mut Survey,
) -> Mesh {
    let normal_matrix = world_from_local.matrix3.inverse().transpose();
    let sign = f64::from(orientation.sign());
    let is_mirrored = world_from_local.matrix3.determinant() < 0.0;
    let vector = |v: &[f32; 3]| DVec3::from(v.map(f64::from));
    let point = |p| {
        let placed = world_from_local.transform_point3(vector(p));
        survey.include(placed);
        placed.as_vec3()
    };
    // Normalised, so that interpolation weighs the corners as the file means it.
    let normal = |n| ((normal_matrix * vector(n)).normalize_or_zero() * sign).as_vec3();
    Mesh {
        positions: mesh.positions.iter().map(point).collect(),
        normals: mesh.normals.iter().map(normal).collect(),
        uvs: mesh.uvs.iter().map(|&uv| Vec2::from(uv)).collect(),
        triangles: mesh.triangles.clone(),
        orientation: if is_mirrored {
            opposite(orientation)
        } else {
            orientation
        },
        ..Mesh::default()
    }
}

/// The front of a shape by the file, whatever its place.
pub(super) fn orientation(shape: &ShapeDescription) -> Orientation {
    if shape.reverse_orientation {
        Orientation::Reversed
    } else {
        Orientation::Natural
    }
}

fn opposite(orientation: Orientation) -> Orientation {
    match orientation {
        Orientation::Natural => Orientation::Reversed,
        Orientation::Reversed => Orientation::Natural,
    }
}

fn phi_max(reader: &mut Reader<'_>) -> Result<f32, Fault> {
    Ok(reader
        .float_within("phimax", 360.0, [0.0, 360.0])?
        .to_radians())
}

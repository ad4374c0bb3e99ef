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

/// A shape in its own space, which can be placed any number of times.
pub(super) enum Geometry {
    Mesh(PlyMesh),
    /// A sphere: radius, then lowest and highest z and largest azimuth (radians).
    Sphere(f32, Vec3),
    /// A disk: height, inner and outer radius, largest azimuth (radians).
    Disk(f32, [f32; 2], f32),
    /// A cylinder: radius, then lowest and highest z and largest azimuth (radians).
    Cylinder(f32, Vec3),
}

impl Geometry {
    /// Reads a shape and its coverage (None: it is opaque). None: the shape is not supported and left out.
    pub(super) fn read(
        context: &mut Context<'_>,
        textures: &mut Textures<'_>,
        shape: &ShapeDescription,
    ) -> Result<Option<(Self, Option<FloatTexture>)>, Fault> {
        let entity = &shape.entity;
        let mut reader = Reader::new(context, entity);
        let geometry = match entity.kind.as_str() {
            "trianglemesh" => Self::Mesh(mesh::triangle_mesh(&mut reader)?),
            "plymesh" => Self::Mesh(mesh::ply_mesh(&mut reader)?),
            "bilinearmesh" => Self::Mesh(mesh::patch_mesh(&mut reader)?),
            "loopsubdiv" => Self::Mesh(mesh::subdivided_mesh(&mut reader)?),
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
                let what = format!("the shape `{kind}`");
                (reader.context).unsupported(entity.span, &what, "it is left out")?;
                return Ok(None);
            }
        };
        let alpha = textures.float(&mut reader, "alpha")?;
        reader.finish()?;
        Ok(Some((geometry, alpha)))
    }

    /// Returns the number of primitives.
    pub(super) fn primitives(&self) -> u64 {
        match self {
            Self::Mesh(mesh) => mesh.triangles.len() as u64,
            Self::Sphere(..) | Self::Disk(..) | Self::Cylinder(..) => 1,
        }
    }

    /// Returns the number of stored vertices.
    pub(super) fn vertices(&self) -> u64 {
        match self {
            Self::Mesh(mesh) => mesh.positions.len() as u64,
            Self::Sphere(..) | Self::Disk(..) | Self::Cylinder(..) => 0,
        }
    }

    /// Returns two corners of a box around a quadric. None: the shape is a mesh.
    fn quadric_box(&self) -> Option<[DVec3; 2]> {
        let (radius, low, high) = match self {
            Self::Mesh(_) => return None,
            Self::Sphere(radius, z) | Self::Cylinder(radius, z) => (*radius, z.x, z.y),
            Self::Disk(height, [_, radius], _) => (*radius, *height, *height),
        };
        let corner = |sign: f32, z: f32| Vec3::new(sign * radius, sign * radius, z).as_dvec3();
        Some([corner(-1.0, low.min(high)), corner(1.0, low.max(high))])
    }

    /// Returns the rounding error of the file's vertices, for a shape that `linear` maps to the world.
    pub(super) fn vertex_error(&self, linear: &DMat3) -> Option<VertexError> {
        match self {
            Self::Mesh(mesh) => VertexError::of(&mesh.positions, linear),
            Self::Sphere(..) | Self::Disk(..) | Self::Cylinder(..) => None,
        }
    }

    /// Returns the shape at a place, and adds it to `survey`. A reflection does not change the front: of a
    /// quadric it is the outside, of a mesh it follows from the order of corners in its own space.
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

/// Maximum distance from the origin, below which squared distances stay finite.
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
    // NaN fails the comparison, too.
    if point.abs().max_element() <= f64::from(FARTHEST) && point.is_finite() {
        Ok(())
    } else {
        Err(too_far(span))
    }
}

/// Refuses an instance that extends too far, of an object between two corners.
pub(super) fn check_instance(
    span: Span,
    world_from_object: &DAffine3,
    corners: [DVec3; 2],
) -> Result<(), Fault> {
    let mut corners = box_corners(corners);
    corners.try_for_each(|corner| check_point(span, world_from_object.transform_point3(corner)))
}

/// Refuses a shape that extends too far to compute with.
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
    // Normals are normalised, so that interpolation weights the corners as in the file.
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

/// Returns the orientation in the file, which does not depend on the shape's place.
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

fn phi_max(reader: &mut Reader<'_, '_>) -> Result<f32, Fault> {
    Ok(reader
        .float_within("phimax", 360.0, [0.0, 360.0])?
        .to_radians())
}

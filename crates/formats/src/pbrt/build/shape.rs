//! Shapes.

use super::context::Context;
use super::mesh;
use super::reader::Reader;
use super::texture::Textures;
use crate::import::{self, Survey, VertexError, vector};
use crate::pbrt::scene::ShapeDescription;
use crate::ply::PlyMesh;
use crate::source::Fault;
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
    /// Reads a shape and its coverage (None: opaque). None: the shape is not supported and left out.
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

    /// Returns the mesh. None: the shape is a quadric.
    fn mesh(&self) -> Option<&PlyMesh> {
        match self {
            Self::Mesh(mesh) => Some(mesh),
            Self::Sphere(..) | Self::Disk(..) | Self::Cylinder(..) => None,
        }
    }

    /// Returns the number of primitives.
    pub(super) fn primitives(&self) -> u64 {
        self.mesh().map_or(1, |mesh| mesh.triangles.len() as u64)
    }

    /// Returns the number of stored vertices.
    pub(super) fn vertices(&self) -> u64 {
        self.mesh().map_or(0, |mesh| mesh.positions.len() as u64)
    }

    /// Returns the lowest and highest corner of a quadric's bounding box. None: the shape is a mesh.
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
        VertexError::of(&self.mesh()?.positions, linear)
    }

    /// Returns the shape mapped by `world_from_local`, and adds it to `survey`. A reflection does not change the
    /// front: the outside of a quadric; for a mesh, the side given by the order of corners in its own space. Errors:
    /// it extends too far.
    pub(super) fn place(
        &self,
        world_from_local: &DAffine3,
        described: &ShapeDescription,
        survey: &mut Survey,
    ) -> Result<Shape, Fault> {
        let span = described.entity.span;
        let affine = world_from_local.as_affine3a();
        let orientation = described.orientation;
        let shape = match self {
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
                let place = |&p| world_from_local.transform_point3(vector(p));
                let placed = mesh.positions.iter().map(place);
                let positions = import::place_vertices(placed, survey, &span)?;
                let mesh = with_vertices(mesh, positions, world_from_local, orientation);
                return Ok(Shape::Mesh(mesh));
            }
        };
        if let Some(corners) = self.quadric_box() {
            survey.include_box(corners, world_from_local);
        }
        let bounds = shape.primitive(0).bounds();
        for corner in [bounds.min, bounds.max] {
            import::check_point(corner.as_dvec3(), &span)?;
        }
        Ok(shape)
    }
}

/// Returns a mesh with the attributes of `mesh` under a map, and with these mapped positions.
fn with_vertices(
    mesh: &PlyMesh,
    positions: Vec<Vec3>,
    world_from_local: &DAffine3,
    orientation: Orientation,
) -> Mesh {
    let normal_matrix = world_from_local.matrix3.inverse().transpose();
    let sign = f64::from(orientation.sign());
    let normal = |&n| import::unit(normal_matrix * vector(n) * sign);
    Mesh {
        positions,
        normals: mesh.normals.iter().map(normal).collect(),
        uvs: mesh.uvs.iter().map(|&uv| Vec2::from(uv)).collect(),
        triangles: mesh.triangles.clone(),
        orientation: import::mirrored(orientation, world_from_local),
        ..Mesh::default()
    }
}

fn phi_max(reader: &mut Reader<'_, '_>) -> Result<f32, Fault> {
    Ok(reader
        .float_within("phimax", 360.0, [0.0, 360.0])?
        .to_radians())
}

//! Meshes of triangles. Points are drawn uniformly on each triangle, with density 1/area (1/m²), for any receiver.
//! The light chooses the triangle, not the mesh.
//!
//! Normals and parameters are interpolated linearly. Shading normals change the frame, but not the point.

use super::differentials::normal_derivative;
use super::{
    Differentials, Normals, Orientation, ShapeSample, SurfacePoint, WorldFromObject, position_error,
};
use crate::math::{Frame, Vec2, Vec3, warp};

/// Triangles that share vertices, in world space.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Vertex positions.
    pub positions: Vec<Vec3>,
    /// The shading normal of each vertex; empty: the surface is faceted.
    pub normals: Vec<Vec3>,
    /// The direction of the shading frame's x at each vertex; empty: along ∂p/∂u. Only the part perpendicular to the
    /// normal matters, at any length.
    pub tangents: Vec<Vec3>,
    /// The parameters of each vertex; empty: each triangle has (0,0), (1,0), (1,1).
    pub uvs: Vec<Vec2>,
    /// The indices of the three vertices of each triangle.
    pub triangles: Vec<[u32; 3]>,
    /// The side of the winding (p1 - p0) × (p2 - p0) that is the front. If there are normals, they decide.
    pub orientation: Orientation,
}

impl Mesh {
    /// Returns the number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// Returns the corners of triangle `i`.
    #[inline]
    pub fn triangle(&self, i: usize) -> [Vec3; 3] {
        self.triangles[i].map(|vertex| self.positions[vertex as usize])
    }

    /// Returns the barycentric weights of the second and third corner of triangle `i` at the point `p` of its plane.
    pub(super) fn barycentric(&self, i: usize, p: Vec3) -> Vec2 {
        let [a, b, c] = self.triangle(i);
        let n = (b - a).cross(c - a);
        let part = |from: Vec3, to: Vec3| n.dot((to - from).cross(p - from)) / n.length_squared();
        Vec2::new(part(c, a), part(a, b)).clamp(Vec2::ZERO, Vec2::ONE)
    }

    /// Returns the area of triangle `i`. Unit: m².
    pub fn triangle_area(&self, i: usize) -> f32 {
        self.corners(i).area()
    }

    /// Returns the geometric normals of triangle `i`, on the side of the shading normals.
    pub(super) fn triangle_normals(&self, i: usize) -> Normals {
        let corners = self.corners(i);
        let [p0, p1, p2] = corners.positions;
        let winding = (p1 - p0).cross(p2 - p0).normalize_or(Vec3::Z);
        let n_g = winding * corners.winding_sign;
        // Interpolated normals lie between those of the corners.
        let sides = corners.normals.map(|normals| normals.map(|n| n_g.dot(n)));
        match sides {
            Some(sides) if sides.iter().all(|&side| side < 0.0) => Normals::One(-n_g),
            Some(sides) if sides.iter().any(|&side| side <= 0.0) => Normals::Opposite(n_g),
            _ => Normals::One(n_g),
        }
    }

    /// Returns the normal of the front of triangle `i`, of any length, given only by its winding.
    #[inline]
    pub(crate) fn front(&self, to_world: Option<&WorldFromObject>, i: usize) -> Vec3 {
        let own = self.corners(i);
        let corners = match to_world {
            None => own,
            Some(to_world) => own.at(to_world),
        };
        let [a, b, c] = corners.positions;
        (b - a).cross(c - a) * corners.winding_sign
    }

    /// Returns the volume that a closed mesh encloses, negative if its front is inside. Unit: m³.
    pub(super) fn enclosed(&self) -> f64 {
        let corners = (0..self.triangle_count()).map(|i| self.triangle(i).map(Vec3::as_dvec3));
        let sum: f64 = corners.map(|[a, b, c]| a.dot(b.cross(c))).sum();
        sum / 6.0 * f64::from(self.orientation.sign())
    }

    #[inline]
    pub(super) fn sample(&self, i: usize, u: Vec2) -> ShapeSample {
        let corners = self.corners(i);
        let error = position_error(corners.magnitude());
        ShapeSample {
            // The tangent of a light point is not used.
            surface: corners.surface_point_in(warp::triangle(u), error, Frame::from_z),
            pdf: 1.0 / corners.area(),
        }
    }

    /// Returns the surface point at the barycentric coordinates `b` of vertices 1 and 2.
    #[inline]
    pub(super) fn surface_point(&self, i: usize, b: Vec2) -> SurfacePoint {
        let corners = self.corners(i);
        corners.surface_point(b, position_error(corners.magnitude()))
    }

    /// Returns the surface point of an object's mesh under `to_world`: the point of a mesh with mapped vertices, with
    /// the error of the map added.
    #[inline]
    pub(super) fn surface_point_at(
        &self,
        to_world: &WorldFromObject,
        i: usize,
        b: Vec2,
    ) -> SurfacePoint {
        let corners = self.corners(i);
        let moved = corners.at(to_world);
        let error = position_error(moved.magnitude()) + to_world.error(corners.magnitude());
        moved.surface_point(b, error)
    }

    /// Returns the derivatives along the parameters at barycentric coordinates `b`.
    pub(super) fn differentials(
        &self,
        to_world: Option<&WorldFromObject>,
        i: usize,
        b: Vec2,
    ) -> Differentials {
        let corners = self.corners(i);
        match to_world {
            None => corners.differentials(b),
            Some(to_world) => corners.at(to_world).differentials(b),
        }
    }

    #[inline]
    pub(super) fn uv(&self, i: usize, b: Vec2) -> Vec2 {
        interpolate(self.triangle_uvs(i), b)
    }

    #[inline]
    fn corners(&self, i: usize) -> Corners {
        let of_vertices = |values: &[Vec3]| self.triangles[i].map(|vertex| values[vertex as usize]);
        Corners {
            positions: self.triangle(i),
            normals: (!self.normals.is_empty()).then(|| of_vertices(&self.normals)),
            tangents: (!self.tangents.is_empty()).then(|| of_vertices(&self.tangents)),
            uvs: self.triangle_uvs(i),
            winding_sign: self.orientation.sign(),
        }
    }

    #[inline]
    fn triangle_uvs(&self, i: usize) -> [Vec2; 3] {
        if self.uvs.is_empty() {
            return [Vec2::ZERO, Vec2::X, Vec2::ONE];
        }
        self.triangles[i].map(|vertex| self.uvs[vertex as usize])
    }
}

/// The attributes of a triangle's corners.
struct Corners {
    positions: [Vec3; 3],
    normals: Option<[Vec3; 3]>,
    tangents: Option<[Vec3; 3]>,
    uvs: [Vec2; 3],
    /// -1 if the front is not on the side of the winding, else 1.
    winding_sign: f32,
}

impl Corners {
    /// Returns the largest absolute coordinate.
    #[inline]
    fn magnitude(&self) -> f32 {
        let [p0, p1, p2] = self.positions;
        p0.abs().max(p1.abs()).max(p2.abs()).max_element()
    }

    /// Returns the corners in the world. A mirroring map flips the winding, not the front.
    #[inline]
    fn at(&self, to_world: &WorldFromObject) -> Self {
        Self {
            positions: self.positions.map(|p| to_world.point(p)),
            normals: self
                .normals
                .map(|normals| normals.map(|n| to_world.normal(n))),
            tangents: self
                .tangents
                .map(|tangents| tangents.map(|t| to_world.vector(t))),
            uvs: self.uvs,
            winding_sign: self.winding_sign * to_world.sign(),
        }
    }

    /// Returns the area. Unit: m².
    #[inline]
    fn area(&self) -> f32 {
        let [a, b, c] = self.positions;
        let area = (b - a).cross(c - a).length() / 2.0;
        // Outside this range, the square of the area is not a normal `f32`.
        if area > 1e-18 && area < 1e18 {
            area
        } else {
            self.extreme_area()
        }
    }

    /// Returns the area of a triangle that is very large or small.
    #[cold]
    fn extreme_area(&self) -> f32 {
        let [a, b, c] = self.positions.map(Vec3::as_dvec3);
        ((b - a).cross(c - a).length() / 2.0) as f32
    }

    #[inline]
    fn surface_point(&self, b: Vec2, error: f32) -> SurfacePoint {
        let tangent = self.tangent(1.0 - b.x - b.y, b);
        self.surface_point_in(b, error, |n_s| Frame::from_z_and_tangent(n_s, tangent))
    }

    /// Returns the surface point; `frame` makes the shading frame from the shading normal.
    #[inline]
    fn surface_point_in(
        &self,
        b: Vec2,
        error: f32,
        frame: impl FnOnce(Vec3) -> Frame,
    ) -> SurfacePoint {
        let [p0, p1, p2] = self.positions;
        let b0 = 1.0 - b.x - b.y;
        let winding = (p1 - p0).cross(p2 - p0).normalize_or(Vec3::Z);
        let n_g = winding * self.winding_sign;
        let n_s = self.shading_normal(b0, b).unwrap_or(n_g);
        let n_g = if n_g.dot(n_s) < 0.0 { -n_g } else { n_g };
        SurfacePoint {
            point: p0 * b0 + p1 * b.x + p2 * b.y,
            error,
            n_g,
            shading: frame(n_s),
            uv: interpolate(self.uvs, b),
        }
    }

    /// Returns the derivatives along the parameters. Positions and normals change linearly over the triangle, and the
    /// unit normal follows from them.
    fn differentials(&self, b: Vec2) -> Differentials {
        let [uv0, uv1, uv2] = self.uvs;
        let (duv1, duv2) = (uv1 - uv0, uv2 - uv0);
        let determinant = duv1.x * duv2.y - duv1.y * duv2.x;
        let along = |[v0, v1, v2]: [Vec3; 3]| {
            let (d1, d2) = (v1 - v0, v2 - v0);
            [d1 * duv2.y - d2 * duv1.y, d2 * duv1.x - d1 * duv2.x].map(|d| d / determinant)
        };
        let n_g = {
            let [p0, p1, p2] = self.positions;
            (p1 - p0).cross(p2 - p0).normalize_or(Vec3::Z)
        };
        let flat = Differentials::flat(n_g, along(self.positions));
        let Some(normals) = self.normals.filter(|_| determinant != 0.0) else {
            return flat;
        };
        let [n0, n1, n2] = normals;
        let n = n0 * (1.0 - b.x - b.y) + n1 * b.x + n2 * b.y;
        let [dn_du, dn_dv] = along(normals).map(|change| normal_derivative(n, change));
        Differentials {
            dn_du,
            dn_dv,
            ..flat
        }
    }

    /// Returns the interpolated normal. None: there are none, or they cancel.
    #[inline]
    fn shading_normal(&self, b0: f32, b: Vec2) -> Option<Vec3> {
        let [n0, n1, n2] = self.normals?;
        (n0 * b0 + n1 * b.x + n2 * b.y).try_normalize()
    }

    /// Returns the interpolated tangent, or ∂p/∂u up to scale if there are no tangents.
    #[inline]
    fn tangent(&self, b0: f32, b: Vec2) -> Vec3 {
        match self.tangents {
            Some([t0, t1, t2]) => t0 * b0 + t1 * b.x + t2 * b.y,
            None => along_u(self.positions, self.uvs),
        }
    }
}

#[inline]
fn interpolate([uv0, uv1, uv2]: [Vec2; 3], b: Vec2) -> Vec2 {
    uv0 * (1.0 - b.x - b.y) + uv1 * b.x + uv2 * b.y
}

/// Returns ∂p/∂u, up to scale; zero where the parameters are degenerate.
#[inline]
fn along_u([p0, p1, p2]: [Vec3; 3], [uv0, uv1, uv2]: [Vec2; 3]) -> Vec3 {
    let (duv1, duv2) = (uv1 - uv0, uv2 - uv0);
    let determinant = duv1.x * duv2.y - duv1.y * duv2.x;
    ((p1 - p0) * duv2.y - (p2 - p0) * duv1.y) * determinant.signum() * f32::from(determinant != 0.0)
}

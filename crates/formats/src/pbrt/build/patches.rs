//! Converts bilinear patches to triangles: p(u, v) = (1-u)(1-v) p00 + u(1-v) p10 + (1-u)v p01 + uv p11.
//!
//! A parallelogram becomes two triangles, exactly. Any other patch becomes a grid of n² cells of two
//! triangles, with the normals of the patch. All patches of a mesh have the same n, and a point on an edge
//! is computed from the edge's ends in one order, so that there are no gaps between neighbours.

use crate::import::vector;
use crate::ply::PlyMesh;
use glam::DVec3;

/// Number of cells along each side of a patch that is not a parallelogram.
const CELLS: usize = 16;

/// Patches that share vertices.
pub(super) struct PatchMesh {
    /// The vertices. Without texture coordinates, they get the (u, v) of each patch.
    pub(super) vertices: PlyMesh,
    /// The corners 00, 10, 01 and 11 of each patch.
    pub(super) patches: Vec<[u32; 4]>,
}

impl PatchMesh {
    /// Returns the number of vertices that [`triangulated`](Self::triangulated) makes.
    pub(super) fn vertex_count(&self) -> u64 {
        let row = self.cells() as u64 + 1;
        self.patches.len() as u64 * row * row
    }

    /// Returns the number of cells along each side of every patch.
    fn cells(&self) -> usize {
        let mut patches = self.patches.iter();
        if patches.all(|patch| self.is_parallelogram(patch)) {
            1
        } else {
            CELLS
        }
    }

    /// Returns the triangles of all patches.
    pub(super) fn triangulated(&self) -> PlyMesh {
        let cells = self.cells();
        let mut mesh = PlyMesh::default();
        for patch in &self.patches {
            self.add(patch, cells, &mut mesh);
        }
        mesh
    }

    fn is_parallelogram(&self, patch: &[u32; 4]) -> bool {
        let [p00, p10, p01, p11] = patch.map(|corner| self.position(corner));
        let size = (p11 - p00).length() + (p10 - p01).length();
        (p00 + p11 - p10 - p01).length() <= 1e-6 * size
    }

    fn position(&self, corner: u32) -> DVec3 {
        vector(self.vertices.positions[corner as usize])
    }

    fn add(&self, patch: &[u32; 4], cells: usize, mesh: &mut PlyMesh) {
        let first = mesh.positions.len() as u32;
        for j in 0..=cells {
            for i in 0..=cells {
                let [u, v] = [i, j].map(|i| i as f64 / cells as f64);
                mesh.positions.push(self.point(patch, [i, j], cells));
                mesh.normals.extend(self.normal(patch, [u, v], cells));
                mesh.uvs.push(self.uv(patch, [u, v]));
            }
        }
        let (cells, row) = (cells as u32, cells as u32 + 1);
        mesh.add_face((0..cells * cells).flat_map(|cell| {
            let a = first + cell / cells * row + cell % cells;
            [[a, a + 1, a + row + 1], [a, a + row + 1, a + row]]
        }));
    }

    fn uv(&self, patch: &[u32; 4], [u, v]: [f64; 2]) -> [f32; 2] {
        let uvs = &self.vertices.uvs;
        if uvs.is_empty() {
            return [u as f32, v as f32];
        }
        blend(patch.map(|corner| uvs[corner as usize]), [u, v])
    }

    /// Returns the corner `[i, j]` of the grid. Interpolates an edge from its end with the lower index to the
    /// other, so that both patches get the same point.
    fn point(&self, patch: &[u32; 4], [i, j]: [usize; 2], cells: usize) -> [f32; 3] {
        let [c00, c10, c01, c11] = *patch;
        let [u, v] = [i, j].map(|i| i as f64 / cells as f64);
        let along = |a: u32, b: u32, t: f64| {
            let (a, b, t) = if a <= b { (a, b, t) } else { (b, a, 1.0 - t) };
            self.position(a) * (1.0 - t) + self.position(b) * t
        };
        let point = match (i, j) {
            (0, _) => along(c00, c01, v),
            (i, _) if i == cells => along(c10, c11, v),
            (_, 0) => along(c00, c10, u),
            (_, j) if j == cells => along(c01, c11, u),
            _ => along(c00, c10, u) * (1.0 - v) + along(c01, c11, u) * v,
        };
        point.as_vec3().to_array()
    }

    /// Returns the interpolated normal of the corners, or else the geometric normal of a curved patch. None: the
    /// patch is flat, and the triangle's geometric normal is right.
    fn normal(&self, patch: &[u32; 4], [u, v]: [f64; 2], cells: usize) -> Option<[f32; 3]> {
        let normals = &self.vertices.normals;
        if !normals.is_empty() {
            return Some(blend(patch.map(|corner| normals[corner as usize]), [u, v]));
        }
        if cells == 1 {
            return None;
        }
        let [p00, p10, p01, p11] = patch.map(|corner| self.position(corner));
        let du = (p10 - p00) * (1.0 - v) + (p11 - p01) * v;
        let dv = (p01 - p00) * (1.0 - u) + (p11 - p10) * u;
        Some(du.cross(dv).normalize_or_zero().as_vec3().to_array())
    }
}

/// Returns (1-u)(1-v) a + u(1-v) b + (1-u)v c + uv d.
fn blend<const N: usize>([a, b, c, d]: [[f32; N]; 4], [u, v]: [f64; 2]) -> [f32; N] {
    let weights = [(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v];
    std::array::from_fn(|i| {
        let values = [a[i], b[i], c[i], d[i]].map(f64::from);
        let terms = values.iter().zip(weights);
        terms.map(|(value, weight)| value * weight).sum::<f64>() as f32
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn saddle() -> PatchMesh {
        let positions = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.3],
            [0.0, 1.0, 0.1],
            [1.0, 1.2, -0.2],
            [2.1, 0.1, 0.4],
            [1.9, 1.0, 0.7],
        ];
        // The second patch is rotated: its left edge is the right edge of the first, reversed.
        patches(&positions, &[[0, 1, 2, 3], [5, 3, 4, 1]])
    }

    fn patches(positions: &[[f32; 3]], patches: &[[u32; 4]]) -> PatchMesh {
        PatchMesh {
            vertices: PlyMesh {
                positions: positions.to_vec(),
                ..PlyMesh::default()
            },
            patches: patches.to_vec(),
        }
    }

    #[test]
    fn a_parallelogram_is_two_triangles() {
        let positions = [[0.0; 3], [2.0, 0.0, 0.0], [0.5, 1.0, 0.0], [2.5, 1.0, 0.0]];
        let mesh = patches(&positions, &[[0, 1, 2, 3]]);
        let triangles = mesh.triangulated();
        assert_eq!(triangles.triangles, [[0, 1, 3], [0, 3, 2]]);
        assert!(triangles.normals.is_empty());
        assert_eq!(
            triangles.uvs,
            [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]
        );
    }

    #[test]
    fn neighbours_share_the_points_of_their_edge() {
        let mesh = saddle().triangulated();
        assert_eq!(mesh.triangles.len(), 2 * 2 * CELLS * CELLS);
        let row = CELLS + 1;
        let second = row * row;
        for k in 0..=CELLS {
            // The first patch has the edge from corner 1 to 3, the second from 3 to 1.
            let of_first = mesh.positions[k * row + CELLS];
            let of_second = mesh.positions[second + (CELLS - k) * row + CELLS];
            assert_eq!(
                of_first.map(f32::to_bits),
                of_second.map(f32::to_bits),
                "{k}"
            );
        }
    }

    #[test]
    fn points_and_normals_are_those_of_the_patch() {
        let mesh = saddle().triangulated();
        let row = CELLS + 1;
        let middle = (CELLS / 2) * row + CELLS / 2;
        let [x, y, z] = mesh.positions[middle];
        assert!((x - 0.5).abs() < 1e-6 && (y - 0.55).abs() < 1e-6 && (z - 0.05).abs() < 1e-6);
        let normal = DVec3::from(mesh.normals[middle].map(f64::from));
        let at = |i: usize| DVec3::from(mesh.positions[i].map(f64::from));
        let [du, dv] = [
            at(middle + 1) - at(middle - 1),
            at(middle + row) - at(middle - row),
        ];
        assert!((normal - du.cross(dv).normalize()).length() < 1e-6);
    }
}

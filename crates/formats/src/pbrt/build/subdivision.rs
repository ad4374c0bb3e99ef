//! Loop's subdivision of triangle meshes \[Loop87\]. Each step splits every triangle in four and smooths;
//! finally, points move to the limit surface of infinitely many steps and get its normals.
//!
//! With n neighbours p_j and the weight β(n), 3/16 for n = 3 and 3/8n else \[Warren95\]:
//!
//! - a vertex becomes (1 - nβ) v + β Σ p_j, on a border (3/4) v + (p_first + p_last)/8;
//! - an edge's middle is 3/8 of both ends and 1/8 of both opposite corners, on a border 1/2 of both
//!   ends;
//! - the limit is (1 - nγ) v + γ Σ p_j, γ = 1/(n + 3/8β), on a border (2/3) v + (p_first + p_last)/6.

use glam::DVec3;
use std::collections::HashMap;
use std::f64::consts::PI;

/// A mesh that can be subdivided.
pub(super) struct ControlMesh {
    pub(super) points: Vec<DVec3>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// The reason why a mesh cannot be subdivided.
type Reason = String;

/// The index that stands for no half-edge.
const NONE: u32 = u32::MAX;

/// The directed edges of a mesh: half-edge 3i + k begins at corner k of triangle i.
///
/// A step of subdivision splits each half-edge in two. The neighbours of the halves follow by arithmetic \[Vanhoey22\].
struct HalfEdges {
    /// The half-edges in the opposite direction, or [`NONE`] on a border.
    twins: Vec<u32>,
    /// A half-edge that begins at each vertex, on a border the first one counterclockwise, or [`NONE`].
    outgoing: Vec<u32>,
}

/// The neighbours of a vertex, counterclockwise; on a border the first and last lie along it.
#[derive(Default)]
struct Ring {
    neighbours: Vec<u32>,
    is_border: bool,
}

impl ControlMesh {
    /// Returns the mesh after `levels` steps, moved to the limit surface, with its normals.
    pub(super) fn subdivide(mut self, levels: u32) -> Result<(Self, Vec<DVec3>), Reason> {
        let mut edges = HalfEdges::of(&self)?;
        for _ in 0..levels {
            self = self.refined(&edges);
            edges = edges.refined(&self);
        }
        let normals = self.at_vertices(&edges, |v, ring| self.normal(v, ring));
        let points = self.at_vertices(&edges, |v, ring| {
            let n = ring.neighbours.len() as f64;
            self.mixed(v, ring, 1.0 / (n + 3.0 / (8.0 * smoothing(n))), 1.0 / 6.0)
        });
        Ok((Self { points, ..self }, normals))
    }

    /// Returns the mesh after one step.
    fn refined(&self, edges: &HalfEdges) -> Self {
        let mut points = self.at_vertices(edges, |v, ring| {
            self.mixed(v, ring, smoothing(ring.neighbours.len() as f64), 0.125)
        });
        let mut middles = vec![NONE; edges.twins.len()];
        for (h, &twin) in edges.twins.iter().enumerate() {
            middles[h] = match middles.get(twin as usize) {
                Some(&known) if known != NONE => known,
                _ => {
                    points.push(self.middle(h as u32, twin));
                    points.len() as u32 - 1
                }
            };
        }
        let split = |(&[a, b, c], &[ab, bc, ca]): (&[u32; 3], &[u32; 3])| {
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        let (middles, _) = middles.as_chunks::<3>();
        let triangles = self.triangles.iter().zip(middles).flat_map(split);
        Self {
            points,
            triangles: triangles.collect(),
        }
    }

    /// Computes a value for each vertex from its ring.
    fn at_vertices(
        &self,
        edges: &HalfEdges,
        mut value: impl FnMut(usize, &Ring) -> DVec3,
    ) -> Vec<DVec3> {
        let mut ring = Ring::default();
        let of_vertex = |v| {
            ring.walk(self, edges, v);
            value(v, &ring)
        };
        (0..self.points.len()).map(of_vertex).collect()
    }

    /// Returns the vertex at which a half-edge begins.
    fn origin(&self, h: u32) -> u32 {
        self.triangles[h as usize / 3][h as usize % 3]
    }

    /// Returns the weighted mean of a vertex and its ring. Each neighbour has the weight `weight`, or on a border,
    /// the two along it have `border`.
    fn mixed(&self, v: usize, ring: &Ring, weight: f64, border: f64) -> DVec3 {
        let point = |&v: &u32| self.points[v as usize];
        match (&*ring.neighbours, ring.is_border) {
            ([first, .., last], true) => {
                self.points[v] * (1.0 - 2.0 * border) + (point(first) + point(last)) * border
            }
            (ring, _) => {
                let sum: DVec3 = ring.iter().map(point).sum();
                self.points[v] * (1.0 - ring.len() as f64 * weight) + sum * weight
            }
        }
    }

    /// Returns the middle of the edge with the half-edges `h` and `twin`.
    fn middle(&self, h: u32, twin: u32) -> DVec3 {
        let point = |h: u32| self.points[self.origin(h) as usize];
        let ends = point(h) + point(next(h));
        if twin == NONE {
            return ends * 0.5;
        }
        ends * 0.375 + (point(previous(h)) + point(previous(twin))) * 0.125
    }

    /// Returns the normal of the limit surface, by two tangents from the ring \[Biermann00\].
    fn normal(&self, v: usize, ring: &Ring) -> DVec3 {
        let point = |&v: &u32| self.points[v as usize];
        let points: Vec<_> = ring.neighbours.iter().map(point).collect();
        let [along, across] = if ring.is_border {
            border_tangents(self.points[v], &points)
        } else {
            let step = 2.0 * PI / points.len() as f64;
            let weighted = |f: fn(f64) -> f64| {
                let terms = points.iter().enumerate();
                terms.map(|(j, &p)| p * f(step * j as f64)).sum()
            };
            [weighted(libm::cos), weighted(libm::sin)]
        };
        along.cross(across).normalize_or_zero()
    }
}

fn border_tangents(v: DVec3, ring: &[DVec3]) -> [DVec3; 2] {
    let [first, .., last] = ring else {
        return [DVec3::ZERO; 2];
    };
    let inwards = match ring {
        [a, b] => *a + *b - v * 2.0,
        [_, b, _] => *b - v,
        [a, b, c, d] => (*b + *c) * 2.0 - *a - *d - v * 2.0,
        _ => {
            let step = PI / (ring.len() - 1) as f64;
            let terms = (1..ring.len() - 1).map(|j| ring[j] * libm::sin(step * j as f64));
            let inner: DVec3 = terms.sum();
            inner * (2.0 - 2.0 * libm::cos(step)) - (*first + *last) * libm::sin(step)
        }
    };
    [*first - *last, inwards]
}

/// Returns β(n).
fn smoothing(n: f64) -> f64 {
    if n < 3.5 { 3.0 / 16.0 } else { 3.0 / (8.0 * n) }
}

/// Returns the next half-edge of the triangle.
fn next(h: u32) -> u32 {
    if h % 3 == 2 { h - 2 } else { h + 1 }
}

/// Returns the previous half-edge of the triangle.
fn previous(h: u32) -> u32 {
    if h.is_multiple_of(3) { h + 2 } else { h - 1 }
}

impl HalfEdges {
    /// Returns the half-edges of a mesh. Errors: it is not an oriented surface.
    fn of(mesh: &ControlMesh) -> Result<Self, Reason> {
        let mut known = HashMap::with_capacity(3 * mesh.triangles.len());
        for (i, &[a, b, c]) in mesh.triangles.iter().enumerate() {
            if a == b || b == c || c == a {
                return Err(format!("triangle {i} has a point twice"));
            }
            for (k, edge) in [[a, b], [b, c], [c, a]].into_iter().enumerate() {
                if known.insert(edge, (3 * i + k) as u32).is_some() {
                    let [from, to] = edge;
                    return Err(format!(
                        "two triangles go from point {from} to point {to}: the mesh is not oriented, \
                         or three triangles share the edge"
                    ));
                }
            }
        }
        let corners = mesh
            .triangles
            .iter()
            .flat_map(|&[a, b, c]| [[b, a], [c, b], [a, c]]);
        let twins = corners.map(|reversed| known.get(&reversed).copied().unwrap_or(NONE));
        let edges = Self::with_twins(mesh, twins.collect());
        edges.check_fans(mesh)?;
        Ok(edges)
    }

    fn with_twins(mesh: &ControlMesh, twins: Vec<u32>) -> Self {
        let mut outgoing = vec![NONE; mesh.points.len()];
        for h in 0..twins.len() as u32 {
            outgoing[mesh.origin(h) as usize] = h;
        }
        for (h, _) in (0..).zip(&twins).filter(|&(_, &twin)| twin == NONE) {
            outgoing[mesh.origin(h) as usize] = h;
        }
        Self { twins, outgoing }
    }

    /// Refuses vertices around which the triangles are not one fan.
    fn check_fans(&self, mesh: &ControlMesh) -> Result<(), Reason> {
        let mut triangles = vec![0; mesh.points.len()];
        for &corner in mesh.triangles.iter().flatten() {
            triangles[corner as usize] += 1;
        }
        let mut ring = Ring::default();
        for (v, &expected) in triangles.iter().enumerate() {
            ring.walk(mesh, self, v);
            if ring.neighbours.len() - usize::from(ring.is_border) != expected {
                return Err(format!(
                    "the triangles around point {v} are more than one fan"
                ));
            }
        }
        Ok(())
    }

    /// Returns the half-edges after one more subdivision step, whose mesh is `mesh`.
    ///
    /// Triangle i becomes 4i + k at its corner k, and 4i + 3 in the middle.
    fn refined(&self, mesh: &ControlMesh) -> Self {
        let first_half = |h: u32| 3 * (4 * (h / 3) + h % 3) + h % 3;
        let second_half = |h: u32| 3 * (4 * (h / 3) + (h + 1) % 3) + h % 3;
        let mut twins = vec![NONE; 4 * self.twins.len()];
        for (h, &twin) in (0..).zip(&self.twins) {
            if twin != NONE {
                twins[first_half(h) as usize] = second_half(twin);
                twins[second_half(h) as usize] = first_half(twin);
            }
            let (triangle, k) = (4 * (h / 3), h % 3);
            let inner = 3 * (triangle + 3) + k;
            let outer = 3 * (triangle + (k + 1) % 3) + (k + 2) % 3;
            twins[inner as usize] = outer;
            twins[outer as usize] = inner;
        }
        Self::with_twins(mesh, twins)
    }
}

impl Ring {
    /// Sets this to the ring of vertex `v`.
    fn walk(&mut self, mesh: &ControlMesh, edges: &HalfEdges, v: usize) {
        self.neighbours.clear();
        self.is_border = false;
        let start = edges.outgoing[v];
        let mut h = start;
        while h != NONE {
            self.neighbours.push(mesh.origin(next(h)));
            let incoming = previous(h);
            h = edges.twins[incoming as usize];
            if h == NONE {
                self.is_border = true;
                self.neighbours.push(mesh.origin(incoming));
            } else if h == start {
                break;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn octahedron() -> ControlMesh {
        let axes = [DVec3::X, DVec3::Y, -DVec3::X, -DVec3::Y];
        let mut points = vec![DVec3::Z, -DVec3::Z];
        points.extend(axes);
        let around = |i: u32| [2 + i % 4, 2 + (i + 1) % 4];
        let faces = (0..4).flat_map(|i| {
            let [a, b] = around(i);
            [[0, a, b], [1, b, a]]
        });
        ControlMesh {
            points,
            triangles: faces.collect(),
        }
    }

    /// Returns a plane of two by two squares, displaced by `height`.
    fn sheet(height: impl Fn(f64, f64) -> f64) -> ControlMesh {
        let n = 6;
        let at = |i: u32| f64::from(i) / f64::from(n);
        let points = (0..=n).flat_map(|j| (0..=n).map(move |i| (i, j)));
        let points = points.map(|(i, j)| DVec3::new(at(i), at(j), height(at(i), at(j))));
        let corner = |i, j| j * (n + 1) + i;
        let cells = (0..n).flat_map(|j| (0..n).map(move |i| (i, j)));
        let triangles = cells.flat_map(|(i, j)| {
            let [a, b] = [corner(i, j), corner(i + 1, j)];
            let [c, d] = [corner(i + 1, j + 1), corner(i, j + 1)];
            [[a, b, c], [a, c, d]]
        });
        ControlMesh {
            points: points.collect(),
            triangles: triangles.collect(),
        }
    }

    #[test]
    fn an_octahedron_becomes_round_with_normals_outwards() {
        let (mesh, normals) = octahedron().subdivide(4).unwrap();
        assert_eq!(mesh.triangles.len(), 8 << 8);
        let radii = mesh.points.iter().map(|p| p.length());
        let (low, high) = radii.fold((f64::MAX, 0.0f64), |(l, h), r| (l.min(r), h.max(r)));
        assert!(low > 0.4 && high / low < 1.25, "{low} to {high}");
        for (point, normal) in mesh.points.iter().zip(&normals) {
            assert!(point.normalize().dot(*normal) > 0.9, "{point} {normal}");
        }
    }

    /// Further steps do not move points of the limit surface.
    #[test]
    fn the_limit_does_not_depend_on_the_number_of_steps() {
        let bent = || sheet(|x, y| x * x - 0.5 * x * y + 0.2 * y);
        for mesh in [octahedron as fn() -> ControlMesh, || {
            sheet(|x, y| x * x * y)
        }] {
            let count = mesh().points.len();
            let [few, many] = [0, 3].map(|levels| mesh().subdivide(levels).unwrap());
            for v in 0..count {
                assert!((few.0.points[v] - many.0.points[v]).length() < 1e-12, "{v}");
                assert!((few.1[v] - many.1[v]).length() < 1e-12, "{v}");
            }
        }
        assert!(bent().subdivide(1).is_ok());
    }

    #[test]
    fn a_plane_stays_a_plane_and_its_border_a_border() {
        let (mesh, normals) = sheet(|x, y| 0.5 * x + 0.25 * y).subdivide(2).unwrap();
        let expected = DVec3::new(-0.5, -0.25, 1.0).normalize();
        for (point, normal) in mesh.points.iter().zip(&normals) {
            assert!((point.z - 0.5 * point.x - 0.25 * point.y).abs() < 1e-12);
            assert!((*normal - expected).length() < 1e-9, "{normal} at {point}");
        }
        let [least, most] =
            [f64::min, f64::max].map(|f| mesh.points.iter().map(|p| p.x).fold(0.5, f));
        assert!(least.abs() < 1e-12 && (most - 1.0).abs() < 1e-12);
    }

    #[test]
    fn meshes_that_are_no_surfaces_are_refused() {
        let refuse = |triangles: &[[u32; 3]], words: &str| {
            let mesh = ControlMesh {
                points: vec![DVec3::ZERO; 5],
                triangles: triangles.to_vec(),
            };
            let reason = mesh.subdivide(1).err().expect("it is no surface");
            assert!(reason.contains(words), "{reason}");
        };
        refuse(
            &[[0, 1, 2], [0, 1, 3]],
            "two triangles go from point 0 to point 1",
        );
        refuse(&[[0, 1, 1]], "triangle 0 has a point twice");
        refuse(&[[0, 1, 2], [0, 3, 4]], "around point 0");
    }
}

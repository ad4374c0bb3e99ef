//! Finds out whether meshes enclose a volume, and on which side the fronts of their faces are.
//!
//! Corners at one position are one corner. Faces that share an edge belong to one part, and must run along the edge
//! in opposite directions; faces that do not are turned to agree with most of their part's area. Edges without a
//! partner form the rims of openings; the vector area of an opening is ½ Σ a × b. A part whose rims have almost no
//! area encloses the signed volume ⅙ Σ a · (b × c), which is positive if fronts are outside.

use bidir::math::Vec3;
use bidir::shape::{Mesh, Orientation};
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};

/// The least area of an opening, relative to the area of its part. Rounding at seams opens less.
const OPEN: f64 = 1e-3;
/// The least volume, relative to area^1.5. A sheet with two sides has none.
const FLAT: f64 = 1e-7;
/// Maximum number of tests of triangles, to find out which parts are inside others.
const MOST_TESTS: usize = 1 << 26;

/// The findings about meshes that bound one volume together.
#[derive(Debug, Default)]
pub(super) struct Findings {
    /// For each mesh, true if one of its parts does not enclose a volume.
    pub(super) open: Vec<bool>,
    /// The faces of each mesh that have to be turned.
    pub(super) turned: Vec<Vec<u32>>,
    /// True if all closed parts have their fronts inside.
    pub(super) is_inside_out: bool,
}

/// A triangle of a mesh, with its corners as indices of [`Hull::places`].
#[derive(Clone, Copy)]
struct Face {
    mesh: u32,
    triangle: u32,
    corners: [u32; 3],
}

/// An edge of a face, from the corner with the lower index to the other.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Edge {
    ends: [u32; 2],
    /// True if the face runs along the edge from the higher index to the lower.
    is_reversed: bool,
    face: u32,
}

/// Disjoint sets of faces or corners. Each element has a parity: odd if it is turned relative to its root.
struct Sets {
    parents: Vec<(u32, bool)>,
}

/// A connected set of faces.
#[derive(Clone, Copy, Default)]
struct Part {
    area: f64,
    /// The area of faces of odd parity.
    odd_area: f64,
    volume: f64,
    is_open: bool,
}

/// The faces of all meshes, and the positions of their corners.
struct Hull {
    places: Vec<DVec3>,
    faces: Vec<Face>,
}

impl Sets {
    fn new(count: usize) -> Self {
        let parents = (0..count as u32).map(|i| (i, false));
        Self {
            parents: parents.collect(),
        }
    }

    /// Returns the root of `i`, and the parity of `i`. Halves the path to the root.
    fn find(&mut self, mut i: u32) -> (u32, bool) {
        let mut parity = false;
        loop {
            let (parent, step) = self.parents[i as usize];
            let (above, further) = self.parents[parent as usize];
            if parent == above {
                return (parent, parity ^ step);
            }
            self.parents[i as usize] = (above, step ^ further);
            parity ^= step ^ further;
            i = above;
        }
    }

    /// Joins the sets of `a` and `b`, unless they are one set. `differ` is true if their parities are to differ.
    fn join(&mut self, a: u32, b: u32, differ: bool) {
        let ((root_a, parity_a), (root_b, parity_b)) = (self.find(a), self.find(b));
        let (low, high) = (root_a.min(root_b), root_a.max(root_b));
        if low != high {
            self.parents[high as usize] = (low, parity_a ^ parity_b ^ differ);
        }
    }
}

impl Hull {
    fn of(meshes: &[&Mesh]) -> Self {
        let (places, numbers) = weld(meshes);
        let mut faces = Vec::new();
        let mut first = 0;
        for (mesh, number) in meshes.iter().zip(0..) {
            for (triangle, i) in mesh.triangles.iter().zip(0..) {
                let [a, b, c] = triangle.map(|vertex| numbers[first + vertex as usize]);
                let corners = match mesh.orientation {
                    Orientation::Natural => [a, b, c],
                    Orientation::Reversed => [a, c, b],
                };
                // Others have no area.
                if a != b && b != c && c != a {
                    faces.push(Face {
                        mesh: number,
                        triangle: i,
                        corners,
                    });
                }
            }
            first += mesh.positions.len();
        }
        Self { places, faces }
    }

    fn corners(&self, face: &Face) -> [DVec3; 3] {
        face.corners.map(|corner| self.places[corner as usize])
    }

    /// Returns the edges of all faces, sorted by their ends.
    fn edges(&self) -> Vec<Edge> {
        let of_face = |(face, number): (&Face, u32)| {
            let [a, b, c] = face.corners;
            [[a, b], [b, c], [c, a]].map(|[from, to]| Edge {
                ends: [from.min(to), from.max(to)],
                is_reversed: from > to,
                face: number,
            })
        };
        let mut edges: Vec<_> = self.faces.iter().zip(0..).flat_map(of_face).collect();
        edges.sort_unstable();
        edges
    }

    /// Returns the parts, as sets of faces.
    fn sets(&self, edges: &[Edge]) -> Sets {
        let mut sets = Sets::new(self.faces.len());
        for along in edges.chunk_by(|a, b| a.ends == b.ends) {
            if let [a, b] = along {
                sets.join(a.face, b.face, a.is_reversed == b.is_reversed);
                continue;
            }
            // Where more faces meet, each is joined to one that runs the other way.
            let turn = along.partition_point(|edge| !edge.is_reversed);
            let (ahead, back) = along.split_at(turn);
            for (a, b) in ahead.iter().zip(back) {
                sets.join(a.face, b.face, false);
            }
        }
        sets
    }

    /// Returns the parts by the number of their root face, and for each face its root, with true if it has to be
    /// turned.
    fn parts(&self, edges: &[Edge]) -> (Vec<Part>, Vec<(u32, bool)>) {
        let mut sets = self.sets(edges);
        let mut roots: Vec<_> = (0..self.faces.len() as u32).map(|i| sets.find(i)).collect();
        let mut parts = vec![Part::default(); self.faces.len()];
        for (face, &(root, is_odd)) in self.faces.iter().zip(&roots) {
            let [a, b, c] = self.corners(face);
            let area = 0.5 * (b - a).cross(c - a).length();
            let part = &mut parts[root as usize];
            part.area += area;
            part.odd_area += if is_odd { area } else { 0.0 };
        }
        // From here on, an odd face is one that is turned.
        for (root, is_odd) in &mut roots {
            let part = &parts[*root as usize];
            *is_odd ^= 2.0 * part.odd_area > part.area;
        }
        for (face, &(root, is_turned)) in self.faces.iter().zip(&roots) {
            let origin = self.places[self.faces[root as usize].corners[0] as usize];
            let [a, b, c] = self.corners(face).map(|corner| corner - origin);
            let sign = if is_turned { -1.0 } else { 1.0 };
            parts[root as usize].volume += sign * a.dot(b.cross(c)) / 6.0;
        }
        self.find_openings(edges, &roots, &mut parts);
        (parts, roots)
    }

    /// Marks the parts that have openings, and those that are flat, as open.
    fn find_openings(&self, edges: &[Edge], roots: &[(u32, bool)], parts: &mut [Part]) {
        let mut rims = Sets::new(self.places.len());
        let mut open = Vec::new();
        for along in edges.chunk_by(|a, b| a.ends == b.ends) {
            let runs = along.iter().map(|edge| {
                let is_back = edge.is_reversed ^ roots[edge.face as usize].1;
                if is_back { -1.0 } else { 1.0 }
            });
            let net: f64 = runs.sum();
            if net != 0.0 {
                let [a, b] = along[0].ends;
                rims.join(a, b, false);
                open.push((along[0], net));
            }
        }
        let mut areas = BTreeMap::<(u32, u32), DVec3>::new();
        for (edge, net) in open {
            let (rim, _) = rims.find(edge.ends[0]);
            let origin = self.places[rim as usize];
            let [a, b] = edge.ends.map(|end| self.places[end as usize] - origin);
            let root = roots[edge.face as usize].0;
            *areas.entry((root, rim)).or_default() += 0.5 * net * a.cross(b);
        }
        for ((root, _), area) in areas {
            let part = &mut parts[root as usize];
            part.is_open |= area.length() > OPEN * part.area;
        }
        for part in parts {
            part.is_open |= part.volume.abs() <= FLAT * part.area * part.area.sqrt();
        }
    }

    /// Returns the winding number of all other parts around a corner of part `own`.
    fn winding(&self, own: u32, roots: &[(u32, bool)]) -> i32 {
        let from = self.places[self.faces[own as usize].corners[0] as usize];
        let faces = self.faces.iter().zip(roots);
        let others = faces.filter(|(_, (root, _))| *root != own);
        others
            .map(|(face, (_, is_turned))| {
                let crossing = crossing(from, self.corners(face));
                if *is_turned { -crossing } else { crossing }
            })
            .sum()
    }
}

/// Returns the distinct positions of all vertices, and for each vertex the index of its position.
fn weld(meshes: &[&Mesh]) -> (Vec<DVec3>, Vec<u32>) {
    let all = meshes.iter().flat_map(|mesh| mesh.positions.iter());
    // Adding zero makes both zeros one.
    let key = |p: &Vec3| (*p + Vec3::ZERO).to_array().map(f32::to_bits);
    let mut order: Vec<_> = all.map(key).zip(0u32..).collect();
    order.sort_unstable();
    let mut numbers = vec![0; order.len()];
    let mut places: Vec<DVec3> = Vec::new();
    let mut last = None;
    for (bits, vertex) in order {
        if last != Some(bits) {
            places.push(Vec3::from_array(bits.map(f32::from_bits)).as_dvec3());
            last = Some(bits);
        }
        numbers[vertex as usize] = places.len() as u32 - 1;
    }
    (places, numbers)
}

/// Returns 1 if a ray from a point leaves through a triangle, -1 if it enters, 0 if it misses.
fn crossing(from: DVec3, corners: [DVec3; 3]) -> i32 {
    /// The direction of the ray, far from axes and diagonals, to which many edges are parallel.
    const ALONG: DVec3 = DVec3::new(0.3601, 0.4793, 0.8004);
    let [a, b, c] = corners.map(|corner| corner - from);
    let sides = [a.cross(b), b.cross(c), c.cross(a)].map(|normal| normal.dot(ALONG));
    let height = a.dot((b - a).cross(c - a));
    let is_beyond = |facing: f64| height * facing > 0.0;
    if sides.iter().all(|&side| side > 0.0) && is_beyond(1.0) {
        1
    } else if sides.iter().all(|&side| side < 0.0) && is_beyond(-1.0) {
        -1
    } else {
        0
    }
}

impl Findings {
    /// Examines the meshes that together bound one volume.
    pub(super) fn of(meshes: &[&Mesh]) -> Self {
        let hull = Hull::of(meshes);
        let edges = hull.edges();
        let (parts, mut roots) = hull.parts(&edges);
        let is_positive = |part: &Part| !part.is_open && part.volume > 0.0;
        let is_negative = |part: &Part| !part.is_open && part.volume < 0.0;
        let numbered = (0..).zip(&parts);
        let negative: Vec<u32> = numbered
            .filter_map(|(i, part)| is_negative(part).then_some(i))
            .collect();
        let is_inside_out = !negative.is_empty() && !parts.iter().any(is_positive);
        if !is_inside_out && negative.len() * hull.faces.len() <= MOST_TESTS {
            let is_wrong = |&i: &u32| hull.winding(i, &roots) <= 0;
            let wrong: BTreeSet<_> = negative.into_iter().filter(is_wrong).collect();
            for (root, is_turned) in &mut roots {
                *is_turned ^= wrong.contains(root);
            }
        }
        let mut findings = Self {
            // A mesh without faces encloses nothing.
            open: meshes
                .iter()
                .map(|mesh| mesh.triangles.is_empty())
                .collect(),
            turned: vec![Vec::new(); meshes.len()],
            is_inside_out,
        };
        for (face, (root, is_turned)) in hull.faces.iter().zip(roots) {
            let mesh = face.mesh as usize;
            findings.open[mesh] |= parts[root as usize].is_open;
            if is_turned {
                findings.turned[mesh].push(face.triangle);
            }
        }
        findings
    }

    /// Returns true if all parts of all meshes enclose a volume.
    pub(super) fn is_closed(&self) -> bool {
        !self.open.contains(&true)
    }
}

/// Turns these faces of a mesh, so that their fronts are on the other side.
pub(super) fn turn(mesh: &mut Mesh, faces: &[u32]) {
    for &face in faces {
        mesh.triangles[face as usize].swap(1, 2);
    }
}

/// Flips the normals of a mesh that point behind the faces around them. Returns their number.
pub(super) fn turn_normals(mesh: &mut Mesh) -> usize {
    if mesh.normals.is_empty() {
        return 0;
    }
    let mut fronts = vec![DVec3::ZERO; mesh.positions.len()];
    for i in 0..mesh.triangle_count() {
        let [a, b, c] = mesh.triangle(i).map(Vec3::as_dvec3);
        let front = (b - a).cross(c - a) * f64::from(mesh.orientation.sign());
        for vertex in mesh.triangles[i] {
            fronts[vertex as usize] += front;
        }
    }
    let mut turned = 0;
    for (normal, front) in mesh.normals.iter_mut().zip(fronts) {
        if normal.as_dvec3().dot(front) < 0.0 {
            *normal = -*normal;
            turned += 1;
        }
    }
    turned
}

#[cfg(test)]
mod tests;

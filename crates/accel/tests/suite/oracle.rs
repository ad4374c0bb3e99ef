//! Independent answers: one tree per primitive, and plain formulas in `f64`.

use bidir_accel::{Bvh, Hit, Primitive, Ray};
use glam::{DVec3, Vec3};

use crate::trees::build_one;

/// Every primitive in a tree of its own: no traversal, the same leaf test.
pub(crate) struct Single(Vec<Bvh>);

impl Single {
    pub(crate) fn new(primitives: &[Primitive]) -> Self {
        Self(
            primitives
                .iter()
                .map(|primitive| build_one(&[*primitive]))
                .collect(),
        )
    }

    /// The first hit by `(t, primitive)` of those accepted.
    pub(crate) fn closest(&self, ray: &Ray, accept: impl Fn(&Hit) -> bool) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        for (primitive, bvh) in (0..).zip(&self.0) {
            let hit = bvh.closest(ray, |hit| accept(&Hit { primitive, ..*hit }));
            // Strictly: the loop ascends, so the first of equals stays.
            if let Some(hit) = hit.filter(|hit| best.is_none_or(|best| hit.t < best.t)) {
                best = Some(Hit { primitive, ..hit });
            }
        }
        best
    }
}

/// The bits of everything in a hit.
pub(crate) fn hit_bits(hit: Option<Hit>) -> Option<[u32; 5]> {
    hit.map(|h| {
        [
            h.t.to_bits(),
            h.instance,
            h.primitive,
            h.u.to_bits(),
            h.v.to_bits(),
        ]
    })
}

/// `t`, `u`, `v` where the line meets the triangle's plane [Möller–Trumbore].
pub(crate) fn plane_passage(ray: &Ray, triangle: [Vec3; 3]) -> [f64; 3] {
    let [a, b, c] = triangle.map(Vec3::as_dvec3);
    let (o, d): (DVec3, DVec3) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let (e1, e2) = (b - a, c - a);
    let p = d.cross(e2);
    let determinant = e1.dot(p);
    let s = o - a;
    let q = s.cross(e1);
    [e2.dot(q), s.dot(p), d.dot(q)].map(|x| x / determinant)
}

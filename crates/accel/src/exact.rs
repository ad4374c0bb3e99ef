//! Ray against triangle, decided exactly.
//!
//! With `a` and `b` the ends of an edge as seen from the ray's origin and `d` the ray's direction,
//! the sign of `(a × b)·d` is the side of the edge on which the ray's line passes: it is the
//! permuted inner product of the two lines' Plücker coordinates.
//! The line passes the closed triangle if its three edge functions do not differ in sign.
//!
//! A mesh is watertight if triangles that share an edge agree on the side, *and* if all edges around
//! a vertex take sides that some real line can take. Rounded edge functions ensure the first only.
//! Here signs are exact for the given `a`, `b` and `d`: `f64` decides nearly always, and what its
//! error bound leaves open is summed without error [Shewchuk97].
//! The translation by the origin does round, but equally for all triangles at a vertex: it only
//! moves the vertices a little, and the moved mesh is as closed as the given one.
//! A line in the plane of a triangle misses it: the triangle is seen as a segment there, which its
//! neighbours cover.
//!
//! [Shewchuk97]: https://doi.org/10.1007/PL00009321

use glam::{DVec3, Vec3};

/// The point where a ray's line passes a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Passage {
    pub(crate) t: f32,
    pub(crate) u: f32,
    pub(crate) v: f32,
}

/// Intersects the line `t·direction` with the triangle of three points relative to its origin.
///
/// With edge functions `w_i` (edge `i` is opposite vertex `i`), the weights `w_i / Σw` give the
/// point. All three have one sign, so that nothing cancels: `t` lies between those of the vertices.
/// None: the line misses or is in the triangle's plane.
#[inline(always)]
pub(crate) fn pass_triangle(triangle: [Vec3; 3], direction: Vec3, axis: usize) -> Option<Passage> {
    let weights = weights(triangle, direction, edge);
    let one_sign = weights.iter().all(|&w| w >= 0.0) || weights.iter().all(|&w| w <= 0.0);
    let sum = weights[0] + weights[1] + weights[2];
    if !one_sign || sum.abs() <= 0.0 {
        return None;
    }
    Some(passage(weights, triangle, direction, axis))
}

/// Returns the result of [`pass_triangle`] if the line is known to pass so far from the edges that plain edge
/// functions exceed their error bound (see [`crate::triangle`]): the same bits, at less cost.
#[inline(always)]
pub(crate) fn pass_certain(triangle: [Vec3; 3], direction: Vec3, axis: usize) -> Passage {
    let plain = |a: DVec3, b: DVec3, d: DVec3| a.cross(b).dot(d);
    passage(
        weights(triangle, direction, plain),
        triangle,
        direction,
        axis,
    )
}

/// Returns the three edge functions.
#[inline(always)]
fn weights(
    [a, b, c]: [Vec3; 3],
    direction: Vec3,
    edge: impl Fn(DVec3, DVec3, DVec3) -> f64,
) -> [f64; 3] {
    let (a, b, c) = (a.as_dvec3(), b.as_dvec3(), c.as_dvec3());
    let d = direction.as_dvec3();
    [edge(b, c, d), edge(c, a, d), edge(a, b, d)]
}

#[inline(always)]
fn passage(weights: [f64; 3], [a, b, c]: [Vec3; 3], direction: Vec3, axis: usize) -> Passage {
    let [a, b, c, d] = [a, b, c, direction].map(|v| f64::from(v[axis]));
    let sum = weights[0] + weights[1] + weights[2];
    let depth = weights[0] * a + weights[1] * b + weights[2] * c;
    Passage {
        t: (depth / (sum * d)) as f32,
        u: (weights[1] / sum) as f32,
        v: (weights[2] / sum) as f32,
    }
}

/// Returns `(a × b)·d` with the sign it has in exact arithmetic, 0 included.
///
/// Assumes coordinates that are `f32` numbers: their products are exact, and products of three
/// neither overflow nor underflow.
#[inline(always)]
fn edge(a: DVec3, b: DVec3, d: DVec3) -> f64 {
    // Each term is rounded at most four times: in the cross product's difference, in the product
    // and in two sums. A rounding is half an epsilon.
    const ERROR: f64 = 2.5 * f64::EPSILON;
    let normal = a.cross(b);
    let value = normal.dot(d);
    if value.abs() > ERROR * normal.abs().dot(d.abs()) {
        value
    } else {
        edge_exact(a, b, d)
    }
}

/// Returns [`edge`] as the sum of its six triple products, rounded once.
#[cold]
#[inline(never)]
fn edge_exact(a: DVec3, b: DVec3, d: DVec3) -> f64 {
    let mut expansion = Expansion::default();
    for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
        expansion.add_product(a[i] * b[j], d[k]);
        expansion.add_product(-a[j] * b[i], d[k]);
    }
    expansion.estimate()
}

/// A sum kept as parts that do not overlap, smallest first [Shewchuk97, §2.4].
#[derive(Default)]
struct Expansion {
    parts: [f64; 12],
    len: usize,
}

impl Expansion {
    /// Adds `pair·factor`, where `pair` is a product of two `f32` and `factor` an `f32`.
    fn add_product(&mut self, pair: f64, factor: f64) {
        // The upper and the lower 24 of the 48 bits of a pair: the product of either with 24 bits is exact.
        let upper = f64::from_bits(pair.to_bits() & !((1 << 29) - 1));
        self.add((pair - upper) * factor);
        self.add(upper * factor);
    }

    fn add(&mut self, term: f64) {
        let mut carry = term;
        for part in &mut self.parts[..self.len] {
            (carry, *part) = two_sum(carry, *part);
        }
        self.parts[self.len] = carry;
        self.len += 1;
    }

    /// Returns the sum, rounded; its sign is exact, since the largest part outweighs all others together.
    fn estimate(&self) -> f64 {
        self.parts[..self.len].iter().sum()
    }
}

/// Returns the rounded sum of two numbers and what the rounding lost [Knuth97, §4.2.2].
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_seen = sum - a;
    let a_seen = sum - b_seen;
    (sum, (a - a_seen) + (b - b_seen))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Returns `(a × b)·d` of small integers, which neither overflows nor rounds.
    fn edge_of_integers(a: [i64; 3], b: [i64; 3], d: [i64; 3]) -> i64 {
        d[0] * (a[1] * b[2] - a[2] * b[1])
            + d[1] * (a[2] * b[0] - a[0] * b[2])
            + d[2] * (a[0] * b[1] - a[1] * b[0])
    }

    fn to_float(v: [i64; 3]) -> DVec3 {
        DVec3::from_array(v.map(|x| x as f64))
    }

    fn vector(limit: i64) -> impl Strategy<Value = [i64; 3]> {
        prop::array::uniform3(-limit..=limit)
    }

    proptest! {
        #[test]
        fn exact_sum_equals_integers(a in vector(1 << 19), b in vector(1 << 19), d in vector(1 << 19)) {
            let expected = edge_of_integers(a, b, d) as f64;
            let value = edge_exact(to_float(a), to_float(b), to_float(d));
            prop_assert_eq!(value.to_bits(), (expected + 0.0).to_bits());
        }

        #[test]
        fn sign_is_exact_for_24_bits(
            a in vector((1 << 24) - 1),
            b in vector((1 << 24) - 1),
            (i, j) in (-9i64..10, -9i64..10),
        ) {
            // A combination of `a` and `b`, so that the true value is zero, then one off in x.
            let on: [i64; 3] = std::array::from_fn(|k| (i * (a[k] >> 5) * 32 + j * (b[k] >> 5) * 32) / 32);
            let (p, q) = (a.map(|x| x >> 5), b.map(|x| x >> 5));
            let off = [on[0] + 1, on[1], on[2]];
            let exact = |d: [i64; 3]| {
                let wide = |v: [i64; 3]| v.map(i128::from);
                let (p, q, d) = (wide(p), wide(q), wide(d));
                d[0] * (p[1] * q[2] - p[2] * q[1])
                    + d[1] * (p[2] * q[0] - p[0] * q[2])
                    + d[2] * (p[0] * q[1] - p[1] * q[0])
            };
            for d in [on, off] {
                let value = edge(to_float(p), to_float(q), to_float(d));
                let sign = if value > 0.0 { 1 } else if value < 0.0 { -1 } else { 0 };
                prop_assert_eq!(sign, exact(d).signum());
            }
        }
    }

    #[test]
    fn line_through_a_vertex_or_an_edge_passes() {
        let triangle = [
            Vec3::new(-1.0, -1.0, 2.0),
            Vec3::new(1.0, -1.0, 2.0),
            Vec3::new(0.0, 1.0, 2.0),
        ];
        for (through, u, v) in [
            (triangle[0], 0.0, 0.0),
            (triangle[1], 1.0, 0.0),
            (triangle[2], 0.0, 1.0),
            (Vec3::new(0.0, -1.0, 2.0), 0.5, 0.0),
        ] {
            assert_eq!(
                pass_triangle(triangle, through, 2),
                Some(Passage { t: 1.0, u, v })
            );
            assert_eq!(
                pass_triangle(triangle, -through, 2),
                Some(Passage { t: -1.0, u, v })
            );
        }
    }

    #[test]
    fn flat_and_point_like_triangles_are_missed() {
        let p = Vec3::new(0.0, 0.0, 1.0);
        for triangle in [[p, p, p], [p, p, Vec3::ONE], [p, p + Vec3::X, p - Vec3::X]] {
            assert_eq!(
                pass_triangle(triangle.map(|q| q - Vec3::Y), Vec3::new(0.0, -1.0, 1.0), 2),
                None
            );
            assert_eq!(pass_triangle(triangle, Vec3::Z, 2), None);
        }
    }

    #[test]
    fn extreme_magnitudes_stay_exact() {
        for scale in [1e-38_f32, 1e-20, 1e18, 1e38] {
            let triangle = [
                Vec3::new(-1.0, -1.0, 2.0),
                Vec3::new(1.0, -1.0, 2.0),
                Vec3::new(0.0, 1.0, 2.0),
            ];
            let scaled = triangle.map(|p| p * scale);
            let passage = pass_triangle(scaled, scaled[1], 2).unwrap();
            assert_eq!(
                passage,
                Passage {
                    t: 1.0,
                    u: 1.0,
                    v: 0.0
                }
            );
        }
    }
}

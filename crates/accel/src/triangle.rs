//! Leaves of triangles: four at a time, discarded by SIMD, decided by [`crate::exact`].
//!
//! The filter looks along the ray [Woop13]: with the axes permuted so that the direction's largest
//! component is `z`, a vertex `p` (relative to the origin) is sheared onto the plane `z = 0`,
//! `x = p_x - (d_x/d_z)·p_z`, `y = p_y - (d_y/d_z)·p_z`, and the three edge functions become
//! `x_a·y_b - y_a·x_b`. A triangle is discarded when two of them have certainly different signs.
//!
//! *Certainly*: let `ε` be half of `f32::EPSILON`, `M` the largest `|p_z|` and `X` the largest computed
//! `|x|`, `|y|`. Shearing rounds three times: `|δx| ≤ 2.1εM + 1.1εX`, so true coordinates stay below
//! `R = X + 4εM`. The edge function inherits at most `4R|δx| + 2|δx|²` and adds `4εX²` of its own,
//! together less than `13ε·R·(X + M)`. The code uses `16ε`, and a constant that exceeds what underflow
//! adds. If anything overflows then so does the bound, and the triangle is kept. Fused products round less
//! often, which the bound covers.
//!
//! [Woop13]: https://jcgt.org/published/0002/01/05/

use glam::Vec3;

use crate::exact::{Passage, pass_triangle};
use crate::ray::Ray;
use crate::simd::F32x4;

/// Lanes of a [`TriangleBlock`].
pub(crate) const LANES: usize = 4;

/// Up to four triangles, transposed.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(crate) struct TriangleBlock {
    /// `[vertex][axis][lane]`; NaN in unused lanes, which come last.
    vertices: [[[f32; LANES]; 3]; 3],
    /// Indices of the primitives; [`Self::NONE`] in unused lanes.
    primitives: [u32; LANES],
}

impl TriangleBlock {
    pub(crate) const NONE: u32 = u32::MAX;

    /// Packs at most four triangles, each with its primitive's index.
    pub(crate) fn new(triangles: impl Iterator<Item = (u32, [Vec3; 3])>) -> Self {
        let mut block = Self {
            vertices: [[[f32::NAN; LANES]; 3]; 3],
            primitives: [Self::NONE; LANES],
        };
        for (lane, (primitive, triangle)) in triangles.enumerate() {
            block.primitives[lane] = primitive;
            for (rows, vertex) in block.vertices.iter_mut().zip(triangle) {
                for (row, coordinate) in rows.iter_mut().zip(vertex.to_array()) {
                    row[lane] = coordinate;
                }
            }
        }
        block
    }

    /// The used lanes: indices and vertices.
    pub(crate) fn triangles(&self) -> impl Iterator<Item = (u32, [Vec3; 3])> {
        let used = self
            .primitives
            .iter()
            .take_while(|&&primitive| primitive != Self::NONE);
        used.enumerate()
            .map(|(lane, &primitive)| (primitive, self.triangle(lane)))
    }

    pub(crate) fn primitive(&self, lane: usize) -> u32 {
        self.primitives[lane]
    }

    /// The vertices in `lane`. Written out, as `array::map` is not always inlined into the loop.
    #[inline(always)]
    fn triangle(&self, lane: usize) -> [Vec3; 3] {
        let vertex = |i: usize| {
            let [x, y, z] = &self.vertices[i];
            Vec3::new(x[lane], y[lane], z[lane])
        };
        [vertex(0), vertex(1), vertex(2)]
    }

    /// A mask that has the bit of every lane whose triangle the ray's line may pass.
    #[inline(always)]
    pub(crate) fn candidates<V: F32x4>(&self, ray: &TriangleRay<V>) -> u32 {
        let [x, y, z] = ray.axes;
        let sheared = |vertex: usize| {
            let rows = &self.vertices[vertex];
            let z = V::load(&rows[z]) - ray.origin_lanes[2];
            [
                z.sub_from(ray.shear[0], V::load(&rows[x]) - ray.origin_lanes[0]),
                z.sub_from(ray.shear[1], V::load(&rows[y]) - ray.origin_lanes[1]),
                z,
            ]
        };
        let [a, b, c] = [sheared(0), sheared(1), sheared(2)];
        let edge = |a: [V; 3], b: [V; 3]| a[0].mul_sub(b[1], a[1] * b[0]);
        let [ab, bc, ca] = [edge(a, b), edge(b, c), edge(c, a)];

        let largest = |p: V, q: V, r: V| p.abs().max(q.abs()).max(r.abs());
        let depth = largest(a[2], b[2], c[2]);
        let across = largest(a[0], b[0], c[0]).max(largest(a[1], b[1], c[1]));
        let reach = depth.mul_add(V::splat(2.0 * f32::EPSILON), across);
        // The small factor comes last, so that an overflow of an edge function is one of the bound.
        let bound = (reach * (across + depth))
            .mul_add(V::splat(8.0 * f32::EPSILON), V::splat(f32::MIN_POSITIVE));

        let below = ab.min(bc).min(ca).lt(V::splat(0.0) - bound);
        let above = bound.lt(ab.max(bc).max(ca));
        // Unused lanes are NaN, which is not even equal to itself.
        let used = a[2].le(a[2]);
        used & !(below & above)
    }

    /// Where the ray's line passes the triangle in `lane`.
    #[inline(always)]
    pub(crate) fn pass<V: F32x4>(&self, lane: usize, ray: &TriangleRay<V>) -> Option<Passage> {
        let [a, b, c] = self.triangle(lane);
        let seen = [a - ray.origin, b - ray.origin, c - ray.origin];
        pass_triangle(seen, ray.direction, ray.axes[2])
    }
}

/// A ray made ready for triangles.
pub(crate) struct TriangleRay<V> {
    origin: Vec3,
    direction: Vec3,
    /// The permutation of the axes: the last is that of the direction's largest component.
    axes: [usize; 3],
    /// The origin with its axes permuted.
    origin_lanes: [V; 3],
    /// The direction's two smaller components over the largest.
    shear: [V; 2],
}

impl<V: F32x4> TriangleRay<V> {
    pub(crate) fn new(ray: &Ray) -> Self {
        let d = ray.direction;
        let z = d.abs().max_position();
        let axes = [(z + 1) % 3, (z + 2) % 3, z];
        Self {
            origin: ray.origin,
            direction: d,
            axes,
            origin_lanes: axes.map(|axis| V::splat(ray.origin[axis])),
            shear: [V::splat(d[axes[0]] / d[z]), V::splat(d[axes[1]] / d[z])],
        }
    }
}

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
//! *Certainly passed*: all three edge functions exceed that bound with one sign. Then a true one exceeds
//! `3εR·(X + M)`, at least `12ε²(X + M)²`, as `R ≥ 4ε(X + M)`. Unsheared, over `d_z`, plain `f64` edge functions
//! err by less than `2.5·2⁻⁵²·6(X + M)² < ε²(X + M)²`: their signs need no second look, and the exact test
//! computes what it would have computed.
//!
//! A triangle is also discarded if `t` is certainly outside the limits: it lies between the vertices'
//! `p_z/d_z`. These are computed with two roundings, and what `f64` loses in the exact test when they
//! differ in sign is less; both are small against `8ε` of the largest.
//!
//! [Woop13]: https://jcgt.org/published/0002/01/05/

use glam::Vec3;

use crate::exact::{Passage, pass_certain, pass_triangle};
use crate::ray::Ray;
use crate::simd::F32x4;

/// Lanes of a [`TriangleBlock`].
pub(crate) const LANES: usize = 4;

/// The triangles of a block that the filter keeps, as masks of lanes.
#[derive(Clone, Copy)]
pub(crate) struct Candidates {
    /// Triangles that the ray may hit.
    pub(crate) possible: u32,
    /// Triangles that the ray's line certainly passes: by so much that `f64` needs no help to see it.
    pub(crate) certain: u32,
    /// Triangles whose `t`, if the line passes, is certainly within the limits.
    pub(crate) within: u32,
}

impl Candidates {
    const NONE: Self = Self {
        possible: 0,
        certain: 0,
        within: 0,
    };
}

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

    /// Which of its triangles the ray may hit; `sure`: limits of `t` for those that are surely within.
    #[inline(always)]
    pub(crate) fn candidates<V: F32x4>(
        &self,
        ray: &TriangleLanes<V>,
        limits: &Ray,
        sure: [f32; 2],
    ) -> Candidates {
        let relative = |vertex: usize, axis: usize| {
            let row = ray.ray.axes[axis];
            debug_assert!(row < 3, "axis {row}");
            // SAFETY: `axes` is a permutation of 0, 1 and 2.
            let row = unsafe { self.vertices[vertex].get_unchecked(row) };
            V::load(row) - ray.origin[axis]
        };
        let sheared = |vertex: usize| {
            let z = relative(vertex, 2);
            [
                z.sub_from(ray.shear[0], relative(vertex, 0)),
                z.sub_from(ray.shear[1], relative(vertex, 1)),
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

        let (low, high) = (ab.min(bc).min(ca), ab.max(bc).max(ca));
        let minus_bound = V::splat(0.0) - bound;
        // Unused lanes are NaN, which is not even equal to itself.
        let used = a[2].le(a[2]);
        let passed = used & !(low.lt(minus_bound) & bound.lt(high));
        if passed == 0 {
            return Candidates::NONE;
        }
        let (beyond, within) = ray.compare(limits, sure, [a[2], b[2], c[2]]);
        Candidates {
            possible: passed & !beyond,
            certain: bound.lt(low) | high.lt(minus_bound),
            within,
        }
    }

    /// The point where the ray's line passes the triangle in `lane`.
    /// `certain`: the lanes known to be passed.
    #[inline(always)]
    pub(crate) fn pass<V: F32x4>(
        &self,
        lane: usize,
        ray: &TriangleLanes<V>,
        certain: u32,
    ) -> Option<Passage> {
        let [a, b, c] = self.triangle(lane % LANES);
        let TriangleRay {
            origin,
            direction,
            axes,
            ..
        } = ray.ray;
        let seen = [a - origin, b - origin, c - origin];
        if certain >> lane & 1 == 1 {
            Some(pass_certain(seen, direction, axes[2] % 3))
        } else {
            pass_triangle(seen, direction, axes[2] % 3)
        }
    }
}

/// The axes in cyclic order, that of the direction's largest component last.
#[inline(always)]
fn axes_of(direction: Vec3) -> [usize; 3] {
    let [x, y, z] = direction.abs().to_array();
    if z > x.max(y) {
        [0, 1, 2]
    } else if y > x {
        [2, 0, 1]
    } else {
        [1, 2, 0]
    }
}

/// A ray made ready for triangles.
#[derive(Clone, Copy)]
pub(crate) struct TriangleRay {
    origin: Vec3,
    direction: Vec3,
    /// The permutation of the axes: the last is that of the direction's largest component.
    axes: [usize; 3],
    /// The direction's two smaller components over the largest.
    shear: [f32; 2],
    /// One over the direction's largest component; NaN where it would be subnormal.
    per_depth: f32,
}

impl TriangleRay {
    #[inline(always)]
    pub(crate) fn new(ray: &Ray) -> Self {
        let d = ray.direction.to_array();
        let axes = axes_of(ray.direction);
        let [x, y, z] = axes;
        let d = |axis: usize| d[axis % 3];
        let per_depth = 1.0 / d(z);
        Self {
            origin: ray.origin,
            direction: ray.direction,
            axes,
            shear: [d(x) / d(z), d(y) / d(z)],
            per_depth: if per_depth.is_normal() {
                per_depth
            } else {
                f32::NAN
            },
        }
    }

    /// The same in all lanes.
    #[inline(always)]
    pub(crate) fn lanes<V: F32x4>(&self) -> TriangleLanes<V> {
        let o = self.origin.to_array();
        let [x, y, z] = self.axes;
        let o = |axis: usize| V::splat(o[axis % 3]);
        TriangleLanes {
            ray: *self,
            origin: [o(x), o(y), o(z)],
            shear: [V::splat(self.shear[0]), V::splat(self.shear[1])],
            per_depth: V::splat(self.per_depth),
        }
    }
}

/// A [`TriangleRay`] against four triangles.
pub(crate) struct TriangleLanes<V> {
    ray: TriangleRay,
    /// The origin with its axes permuted.
    origin: [V; 3],
    shear: [V; 2],
    per_depth: V,
}

impl<V: F32x4> TriangleLanes<V> {
    /// Masks of the lanes whose triangles, with vertices at these depths, the line passes at a `t`
    /// certainly outside the limits, and certainly within those that are sure.
    #[inline(always)]
    fn compare(&self, limits: &Ray, sure: [f32; 2], depths: [V; 3]) -> (u32, u32) {
        let [a, b, c] = depths;
        let [a, b, c] = [a * self.per_depth, b * self.per_depth, c * self.per_depth];
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let slack = (low.abs() + high.abs())
            .mul_add(V::splat(4.0 * f32::EPSILON), V::splat(f32::MIN_POSITIVE));
        let (t_min, t_max) = (V::splat(limits.t_min), V::splat(limits.t_max));
        let beyond = (high + slack).lt(t_min) | t_max.lt(low - slack);
        let [first, last] = sure.map(V::splat);
        let within = first.le(low - slack) & (high + slack).le(last);
        (beyond, within)
    }
}

//! Leaves of triangles. SIMD discards triangles, four at a time; [`crate::exact`] decides about the others.
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
//! A triangle is also discarded if `t` is certainly outside the limits. If the line passes, `t` is the mean of the
//! vertices' `t_i = p_z/d_z`, weighted by the magnitudes `w_i` of the edge functions opposite to them. With `B` the bound
//! above, the computed mean errs by
//!
//! ```text
//!     Σ e_i (t_i - t) / Σ w_i + Σ w_i f_i / Σ w_i,    |e_i| ≤ B,  |f_i| ≤ f = 8ε·(|min t_i| + |max t_i|),
//! ```
//!
//! at most `3B·(max t_i - min t_i) / Σ w_i + f`: `t_i` are computed with two roundings. Half a `B` and another `f` exceed
//! what the sums and products lose, and what `f64` loses in the exact test when the `t_i` differ in sign.
//!
//! [Woop13]: https://jcgt.org/published/0002/01/05/

use glam::Vec3;

use crate::exact::{Passage, pass_certain, pass_triangle};
use crate::ray::Ray;
use crate::simd::F32x4;

/// The number of lanes of a [`TriangleBlock`].
pub(crate) const LANES: usize = 4;

/// The triangles of a block that the filter keeps, as masks of lanes.
#[derive(Clone, Copy)]
pub(crate) struct Candidates {
    /// Triangles that the ray may hit.
    pub(crate) possible: u32,
    /// Triangles that the ray's line passes with certainty: plain `f64` arithmetic finds the signs.
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
    /// The vertices, by `[vertex][axis][lane]`; NaN in unused lanes, which come last.
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

    /// Returns the indices and the vertices in the used lanes.
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

    /// Returns the vertices in `lane`. Written out, because `array::map` is not always inlined into the loop.
    #[inline(always)]
    fn triangle(&self, lane: usize) -> [Vec3; 3] {
        let vertex = |i: usize| {
            let [x, y, z] = &self.vertices[i];
            Vec3::new(x[lane], y[lane], z[lane])
        };
        [vertex(0), vertex(1), vertex(2)]
    }

    /// Returns the triangles that the ray may hit. `sure` are limits of `t` that are certainly within the ray's.
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
            let coordinates = unsafe { self.vertices[vertex].get_unchecked(row) };
            V::load(coordinates) - ray.origin[axis]
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
        let passage = ray.passage([a[2], b[2], c[2]], [bc, ca, ab], bound);
        Candidates {
            possible: passed & !passage.outside([limits.t_min, limits.t_max]),
            certain: bound.lt(low) | high.lt(minus_bound),
            within: passage.within(sure),
        }
    }

    /// Returns the point where the ray's line passes the triangle in `lane`. `certain` is the mask of lanes that the
    /// line passes with certainty. None: the line misses it.
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

/// Returns the axes in cyclic order, the axis of the direction's largest component last.
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

/// A ray prepared for triangles.
#[derive(Clone, Copy)]
pub(crate) struct TriangleRay {
    origin: Vec3,
    direction: Vec3,
    /// The permutation of the axes: the axis of the direction's largest component is last.
    axes: [usize; 3],
    /// The direction's two smaller components over the largest.
    shear: [f32; 2],
    /// One over the direction's largest component; NaN if it would be subnormal.
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

    /// Returns the ray with its numbers in all lanes.
    #[inline(always)]
    pub(crate) fn lanes<V: F32x4>(&self) -> TriangleLanes<V> {
        let origin = self.origin.to_array();
        let [x, y, z] = self.axes;
        let o = |axis: usize| V::splat(origin[axis % 3]);
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
    /// Returns the `t` at which the line passes triangles with vertices at `depths`. `edges` are the edge functions
    /// opposite to the vertices, with an error of at most `bound`.
    #[inline(always)]
    fn passage(&self, depths: [V; 3], edges: [V; 3], bound: V) -> PassageLanes<V> {
        let [a, b, c] = edges.map(F32x4::abs);
        let [p, q, r] = depths.map(|depth| depth * self.per_depth);
        let (low, high) = (p.min(q).min(r), p.max(q).max(r));
        let sum = a + b + c;
        // Twice as large as any of the sums below: if one of them overflows, so does the error.
        let largest = (sum + sum) * (low.abs() + high.abs() + V::splat(f32::MIN_POSITIVE));
        let error = (bound * (high - low)).mul_add(V::splat(3.5), V::splat(f32::MIN_POSITIVE));
        PassageLanes {
            sum,
            t: a.mul_add(p, b.mul_add(q, c * r)),
            error: largest.mul_add(V::splat(4.0 * f32::EPSILON), error),
        }
    }
}

/// The `t` at which a line passes triangles, if it passes them, and its error, both multiplied by `sum`.
struct PassageLanes<V> {
    sum: V,
    t: V,
    error: V,
}

impl<V: F32x4> PassageLanes<V> {
    /// Returns the mask of the lanes certainly outside the limits.
    #[inline(always)]
    fn outside(&self, limits: [f32; 2]) -> u32 {
        let [t_min, t_max] = limits.map(|t| V::splat(t) * self.sum);
        (self.t + self.error).lt(t_min) | t_max.lt(self.t - self.error)
    }

    /// Returns the mask of the lanes certainly within the limits.
    #[inline(always)]
    fn within(&self, limits: [f32; 2]) -> u32 {
        let [t_min, t_max] = limits.map(|t| V::splat(t) * self.sum);
        t_min.le(self.t - self.error) & (self.t + self.error).le(t_max)
    }
}

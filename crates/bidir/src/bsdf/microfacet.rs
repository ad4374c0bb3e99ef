//! The anisotropic GGX distribution of microfacet normals, with Smith's shadowing.
//!
//! With slopes α_x and α_y along the local axes [Heitz14, §5]:
//!
//! - D(m) = 1 / (π α_x α_y ((m_x/α_x)² + (m_y/α_y)² + m_z²)²) is the area of facets with normal m,
//!   so that ∫ D(m) m_z dm = 1;
//! - Λ(v) = (√(1 + (α_x² v_x² + α_y² v_y²)/v_z²) - 1) / 2, G₁(v) = 1/(1 + Λ(v)), and the
//!   height-correlated G₂(o, i) = 1/(1 + Λ(o) + Λ(i));
//! - D_v(m) = G₁(v) |v·m| D(m) / |v_z| is the density of the normals visible from v.

use crate::math::{INV_PI, PI, Vec2, Vec3, safe_sqrt, sin_cos, sqr};

/// The slope below which a surface counts as smooth: a Dirac distribution.
pub const SMOOTH_ALPHA: f32 = 1e-3;

/// GGX with slopes along local x and y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ggx {
    alpha_x: f32,
    alpha_y: f32,
}

/// Reflection by the facets with normal m halfway between two directions on one side.
#[derive(Clone, Copy, Debug)]
pub struct Mirror {
    /// D(m) G₂(wo, wi) / (4 |cosθ_o cosθ_i|): f without the facets' reflectance [Walter07, eq. 20]. Unit: 1/sr.
    pub facets: f32,
    /// wo·m = wi·m.
    pub cos: f32,
    /// The densities with which [`Ggx::sample_mirror`] draws wi for wo, and wo for wi: D_v(m) / (4 |v·m|)
    /// [Walter07, eq. 14]. Measure: solid angle, 1/sr.
    pub densities: [f32; 2],
}

impl Ggx {
    /// Makes facets of slopes α_x and α_y. The surface is smooth if both are below [`SMOOTH_ALPHA`]; otherwise each
    /// slope is at least 10⁻⁴, so that no term overflows.
    pub fn new(alpha_x: f32, alpha_y: f32) -> Self {
        if alpha_x.max(alpha_y) < SMOOTH_ALPHA {
            return Self {
                alpha_x: 0.0,
                alpha_y: 0.0,
            };
        }
        Self {
            alpha_x: alpha_x.max(1e-4),
            alpha_y: alpha_y.max(1e-4),
        }
    }

    /// Returns true where the surface has no facets: a Dirac distribution of normals.
    #[inline]
    pub fn is_smooth(self) -> bool {
        self.alpha_x <= 0.0
    }

    /// Returns D(m), the density of facet area. Unit: 1/sr.
    #[inline]
    pub fn d(self, m: Vec3) -> f32 {
        let slope = sqr(m.x / self.alpha_x) + sqr(m.y / self.alpha_y) + sqr(m.z);
        INV_PI / (self.alpha_x * self.alpha_y * sqr(slope))
    }

    #[inline]
    fn lambda(self, v: Vec3) -> f32 {
        let tan2 = (sqr(self.alpha_x * v.x) + sqr(self.alpha_y * v.y)) / sqr(v.z);
        // It is finite even if z² vanishes, so that quotients of two such terms are not NaN.
        ((1.0 + tan2.min(f32::MAX)).sqrt() - 1.0) / 2.0
    }

    /// Returns the slopes along x and y.
    #[inline]
    pub(super) fn alphas(self) -> [f32; 2] {
        [self.alpha_x, self.alpha_y]
    }

    /// Returns true if the slopes along x and y are equal.
    #[inline]
    pub(super) fn is_isotropic(self) -> bool {
        self.alpha_x.to_bits() == self.alpha_y.to_bits()
    }

    /// Returns 1 / (1 + 2Λ(v)): G₂ of a direction with itself. Range: `[0, 1]`.
    #[inline]
    pub(super) fn unshadowed(self, v: Vec3) -> f32 {
        1.0 / (1.0 + 2.0 * self.lambda(v))
    }

    /// Returns the fraction of facets facing `v` that are not shadowed.
    #[inline]
    pub fn g1(self, v: Vec3) -> f32 {
        1.0 / (1.0 + self.lambda(v))
    }

    /// Returns the fraction of facets facing `wo` and `wi` that are shadowed for neither.
    #[inline]
    pub fn g2(self, wo: Vec3, wi: Vec3) -> f32 {
        1.0 / (1.0 + self.lambda(wo) + self.lambda(wi))
    }

    /// Evaluates reflection between two directions on one side.
    #[inline]
    pub fn mirror(self, wo: Vec3, wi: Vec3) -> Mirror {
        let m = (wo + wi).normalize();
        let quarter = self.d(m) / 4.0;
        let [lambda_o, lambda_i] = [wo, wi].map(|w| self.lambda(w));
        Mirror {
            facets: quarter / ((1.0 + lambda_o + lambda_i) * (wo.z * wi.z)),
            cos: wo.dot(m),
            densities: [(lambda_o, wo), (lambda_i, wi)]
                .map(|(lambda, w)| quarter / ((1.0 + lambda) * w.z.abs())),
        }
    }

    /// Draws a facet visible from `wo`, and returns the direction to which it reflects `wo`. None: it is below the
    /// surface.
    #[inline]
    pub fn sample_mirror(self, wo: Vec3, u: Vec2) -> Option<Vec3> {
        let m = self.sample_visible(wo, u);
        let wi = m * (2.0 * wo.dot(m)) - wo;
        (wo.z * wi.z > 0.0).then_some(wi)
    }

    /// Returns the slope of an isotropic surface with the same variance.
    #[inline]
    pub fn mean_alpha(self) -> f32 {
        ((sqr(self.alpha_x) + sqr(self.alpha_y)) / 2.0).sqrt()
    }

    /// Returns the gloss: 1 for a mirror, 0 for slopes of 1 and above.
    #[inline]
    pub fn gloss(self) -> f32 {
        1.0 - self.mean_alpha().min(1.0)
    }

    /// Returns these facets, with the variance `scale`² α² of other facets added along each axis.
    #[inline]
    #[must_use]
    pub fn broadened(self, other: Self, scale: f32) -> Self {
        let add = |a: f32, b: f32| (sqr(a) + sqr(scale * b)).sqrt();
        Self::new(
            add(self.alpha_x, other.alpha_x),
            add(self.alpha_y, other.alpha_y),
        )
    }

    /// Draws a normal in the upper hemisphere by the visible area of its facets from `v`; for `v` below the surface,
    /// from beneath \[Heitz18\].
    #[inline]
    pub fn sample_visible(self, v: Vec3, u: Vec2) -> Vec3 {
        // Stretch to the hemisphere configuration, α = 1.
        let v = if v.z < 0.0 { -v } else { v };
        let stretched = Vec3::new(self.alpha_x * v.x, self.alpha_y * v.y, v.z).normalize();
        let (t1, t2) = tilt_axes(stretched);
        // A point of the projected hemisphere: half a disk, half an ellipse squeezed by v_z.
        let radius = u.x.sqrt();
        let (sin, cos) = sin_cos(2.0 * PI * u.y);
        let x = radius * cos;
        let squeeze = (1.0 + stretched.z) / 2.0;
        let y = (1.0 - squeeze) * safe_sqrt(1.0 - sqr(x)) + squeeze * radius * sin;
        let z = safe_sqrt(1.0 - sqr(x) - sqr(y));
        let m = t1 * x + t2 * y + stretched * z;
        Vec3::new(m.x * self.alpha_x, m.y * self.alpha_y, m.z.max(1e-6)).normalize()
    }
}

/// Returns axes perpendicular to `v`: the first horizontal, the second completing a right-handed frame.
#[inline]
fn tilt_axes(v: Vec3) -> (Vec3, Vec3) {
    let horizontal = sqr(v.x) + sqr(v.y);
    let t1 = if horizontal > 1e-12 {
        Vec3::new(-v.y, v.x, 0.0) / horizontal.sqrt()
    } else {
        Vec3::X
    };
    (t1, v.cross(t1))
}

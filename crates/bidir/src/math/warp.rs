//! Maps from the unit square to the shapes that samples are drawn on, with their densities.
//!
//! Every map is stratification-preserving: continuous but for null sets, with constant Jacobian
//! where the density is uniform.

use super::{INV_PI, PI, safe_sqrt, sin_cos};
use glam::{Vec2, Vec3};

/// Returns a uniform point of the unit disk \[Shirley97\]. Measure: area, density 1/π.
#[inline]
pub fn concentric_disk(u: Vec2) -> Vec2 {
    let offset = u * 2.0 - Vec2::ONE;
    if offset == Vec2::ZERO {
        return Vec2::ZERO;
    }
    let (radius, angle) = if offset.x.abs() > offset.y.abs() {
        (offset.x, PI / 4.0 * (offset.y / offset.x))
    } else {
        (offset.y, PI / 2.0 - PI / 4.0 * (offset.x / offset.y))
    };
    let (sin, cos) = sin_cos(angle);
    Vec2::new(cos, sin) * radius
}

/// Returns a cosine-distributed direction around +z. Measure: solid angle, density cosθ/π.
#[inline]
pub fn cosine_hemisphere(u: Vec2) -> Vec3 {
    let d = concentric_disk(u);
    d.extend(safe_sqrt(1.0 - d.length_squared()))
}

/// Returns the density of [`cosine_hemisphere`]. Measure: solid angle, 1/sr.
#[inline]
pub fn cosine_hemisphere_pdf(cos_theta: f32) -> f32 {
    cos_theta.max(0.0) * INV_PI
}

/// Returns a uniform direction. Measure: solid angle, density 1/(4π).
#[inline]
pub fn uniform_sphere(u: Vec2) -> Vec3 {
    uniform_cone(u, 2.0)
}

/// Returns a uniform direction within the cone around +z of `height = 1 - cosθ_max`; 2 is the sphere.
/// Measure: solid angle, density 1/(2π·height). The height is the argument because 1 - cosθ_max
/// keeps its digits for narrow cones.
#[inline]
pub fn uniform_cone(u: Vec2, height: f32) -> Vec3 {
    let drop = u.x * height;
    let (sin_phi, cos_phi) = sin_cos(2.0 * PI * u.y);
    let sin_theta = safe_sqrt(drop * (2.0 - drop));
    Vec3::new(sin_theta * cos_phi, sin_theta * sin_phi, 1.0 - drop)
}

/// Returns the barycentric coordinates `(b1, b2)` of a uniform point of a triangle \[Heitz19\].
/// Measure: area, density 1/area.
#[inline]
pub fn triangle(u: Vec2) -> Vec2 {
    if u.x < u.y {
        let b1 = u.x / 2.0;
        Vec2::new(b1, u.y - b1)
    } else {
        let b2 = u.y / 2.0;
        Vec2::new(u.x - b2, b2)
    }
}

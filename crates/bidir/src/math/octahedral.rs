//! The equal-area octahedral map between the unit square and the sphere \[Clarberg08\]: a density
//! over the square's area, divided by 4π, is one over solid angle, 1/sr.

use super::{PI, safe_sqrt, sin_cos};
use glam::{Vec2, Vec3};

/// Returns the direction of a point of the unit square under the equal-area octahedral map \[Clarberg08\].
///
/// The centre is +z, the corners are -z; equal areas go to equal solid angles (4π per unit area).
#[inline]
pub fn square_to_direction(p: Vec2) -> Vec3 {
    let signed = p * 2.0 - Vec2::ONE;
    let a = signed.abs();
    let signed_distance = 1.0 - (a.x + a.y);
    let radius = 1.0 - signed_distance.abs();
    let phi = PI / 4.0
        * if radius > 0.0 {
            (a.y - a.x) / radius + 1.0
        } else {
            1.0
        };
    let z = (1.0 - radius * radius).copysign(signed_distance);
    let (sin, cos) = sin_cos(phi);
    let rho = radius * safe_sqrt(2.0 - radius * radius);
    Vec3::new(
        cos.copysign(signed.x) * rho,
        sin.copysign(signed.y) * rho,
        z,
    )
}

/// Returns the point of the unit square whose direction is the unit vector `d`: the inverse of
/// [`square_to_direction`].
#[inline]
pub fn direction_to_square(d: Vec3) -> Vec2 {
    let a = d.abs();
    let radius = safe_sqrt(1.0 - a.z);
    let t = libm::atan2f(a.y, a.x) * (2.0 / PI);
    let mut v = t * radius;
    let mut u = radius - v;
    if d.z < 0.0 {
        (u, v) = (1.0 - v, 1.0 - u);
    }
    Vec2::new(u.copysign(d.x) + 1.0, v.copysign(d.y) + 1.0) * 0.5
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_map_is_inverted_and_has_the_documented_poles() {
        for i in 0..20 {
            for j in 0..20 {
                let p = Vec2::new((i as f32 + 0.4) / 20.0, (j as f32 + 0.7) / 20.0);
                let d = square_to_direction(p);
                assert!((d.length() - 1.0).abs() < 1e-5);
                assert!((direction_to_square(d) - p).length() < 1e-3, "{p} {d}");
            }
        }
        for (x, y, w) in [
            (0.5, 0.5, Vec3::Z),
            (0.0, 0.0, -Vec3::Z),
            (1.0, 0.5, Vec3::X),
            (0.5, 1.0, Vec3::Y),
        ] {
            assert!(square_to_direction(Vec2::new(x, y)).distance(w) < 1e-6);
        }
    }
}

//! Two vertices as they see each other: G = |cosθ cosθ'| / d², and what turns a density of directions
//! at one of them into that of the other, p(x') = p_ω |cosθ'| / d² [Veach97, §8.2.2.2].
//!
//! Cosines are geometric. Towards an end at infinity there is no distance, and no cosine there.

use crate::locus::Locus;
use crate::math::Vec3;
use crate::scene::Edge;

/// The line between two ends, the first of which is called a and the second b; at most one is at
/// infinity. All numbers are zero where both are the same point.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    /// The unit direction from a to b.
    pub w: Vec3,
    /// G. Visibility is no part of it. Unit: 1/m²; a cosine where an end is at infinity.
    pub geometry_term: f32,
    /// The factor that turns a density of the direction `w` at a into one of b.
    pub to_b: f32,
    /// The factor that turns a density of the direction -`w` at b into one of a.
    pub to_a: f32,
}

impl Segment {
    /// Returns the segment between two ends.
    #[inline]
    pub fn between(a: &Locus, b: &Locus) -> Self {
        if b.is_infinite() {
            return Self::along(a, b, b.point);
        }
        if a.is_infinite() {
            return Self::along(a, b, -a.point);
        }
        let across = b.point - a.point;
        let inverse2 = inverse(across.length_squared());
        Self::with(a, b, across * inverse2.sqrt(), inverse2)
    }

    /// The same where the unit direction `w` from a to b is known.
    #[inline]
    pub fn along(a: &Locus, b: &Locus, w: Vec3) -> Self {
        let inverse2 = if a.is_infinite() || b.is_infinite() {
            1.0
        } else {
            inverse(a.point.distance_squared(b.point))
        };
        Self::with(a, b, w, inverse2)
    }

    /// Lets it pass media: densities of points have a factor more. T is no part of G.
    #[inline]
    pub fn pass(&mut self, edge: &Edge) {
        self.to_b *= edge.to_b;
        self.to_a *= edge.to_a;
    }

    /// With one over the square of the distance, or 1 where there is none.
    #[inline]
    fn with(a: &Locus, b: &Locus, w: Vec3, inverse2: f32) -> Self {
        let [cos_a, cos_b] = [a, b].map(|end| end.abs_cos(w));
        let of = |end: &Locus, cos: f32| {
            if end.is_infinite() {
                1.0
            } else {
                cos * inverse2
            }
        };
        Self {
            w,
            geometry_term: cos_a * cos_b * inverse2,
            to_b: of(b, cos_b),
            to_a: of(a, cos_a),
        }
    }
}

/// Returns 1 / `x`; 0 where that is no number.
#[inline]
pub(super) fn inverse(x: f32) -> f32 {
    let inverse = 1.0 / x;
    if inverse < f32::INFINITY {
        inverse
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::check_close;

    fn on_surface(point: Vec3, n_g: Vec3) -> Locus {
        Locus::on_surface(point, n_g, 0.0)
    }

    #[track_caller]
    fn check(a: &Locus, b: &Locus, w: Vec3, expected: [f32; 3]) {
        for segment in [Segment::between(a, b), Segment::along(a, b, w)] {
            assert!((segment.w - w).length() < 1e-6, "{segment:?}");
            let found = [segment.geometry_term, segment.to_b, segment.to_a];
            for (a, b) in found.into_iter().zip(expected) {
                check_close(a, b, 1e-6, format!("{segment:?}"));
            }
        }
    }

    #[test]
    fn cosines_and_distance_are_where_the_ends_are() {
        // 2 m apart; the normals are at 60° and 0° to the segment.
        let slanted = on_surface(Vec3::ZERO, Vec3::new(0.5, 0.75f32.sqrt(), 0.0));
        let facing = on_surface(Vec3::X * 2.0, -Vec3::X);
        check(&slanted, &facing, Vec3::X, [0.125, 0.25, 0.125]);
        check(&facing, &slanted, -Vec3::X, [0.125, 0.125, 0.25]);
        let lens = Locus::in_space(Vec3::X * 2.0);
        check(&slanted, &lens, Vec3::X, [0.125, 0.25, 0.125]);
    }

    #[test]
    fn at_infinity_there_is_one_cosine() {
        let slanted = on_surface(Vec3::ZERO, Vec3::new(0.5, 0.75f32.sqrt(), 0.0));
        let sky = Locus::at_infinity(Vec3::X);
        check(&slanted, &sky, Vec3::X, [0.5, 1.0, 0.5]);
        check(&sky, &slanted, -Vec3::X, [0.5, 0.5, 1.0]);
    }

    #[test]
    fn a_point_does_not_see_itself() {
        let here = on_surface(Vec3::ONE, Vec3::X);
        let segment = Segment::between(&here, &here);
        assert_eq!(segment.w, Vec3::ZERO);
        let numbers = [segment.geometry_term, segment.to_b, segment.to_a];
        assert!(numbers.iter().all(|&x| x == 0.0));
    }
}

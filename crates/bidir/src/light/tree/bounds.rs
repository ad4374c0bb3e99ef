//! Bounds of emitters, of their directions and of their light: boxes (m), cones of directions (rad) and
//! peak intensities (W/sr, luminance).

use accel::Aabb;

use crate::math::{PI, Vec3};

/// Directions of emission: within `opening` of some normal, which is itself within `spread` of the
/// axis \[Conty18\].
#[derive(Clone, Copy, Debug)]
pub(in crate::light) struct Cone {
    /// The unit axis.
    pub(in crate::light) axis: Vec3,
    /// θ_o. Range: `[0, π]`, rad.
    pub(in crate::light) spread: f32,
    /// θ_e. Range: `[0, π]`, rad.
    pub(in crate::light) opening: f32,
    /// True if the other side of the surface emits the mirrored cone as well.
    pub(in crate::light) is_mirrored: bool,
}

impl Cone {
    /// All directions, evenly.
    pub(in crate::light) const EVERYWHERE: Self = Self {
        axis: Vec3::Z,
        spread: PI,
        opening: PI / 2.0,
        is_mirrored: false,
    };

    /// Makes the cone of a flat surface with the normal `n`.
    pub(in crate::light) fn flat(n: Vec3, is_mirrored: bool) -> Self {
        Self {
            axis: n,
            spread: 0.0,
            opening: PI / 2.0,
            is_mirrored,
        }
    }

    /// Makes a cone around both.
    fn union(&self, other: &Self) -> Self {
        let (wide, narrow) = if self.spread >= other.spread {
            (self, other)
        } else {
            (other, self)
        };
        let between = angle(wide.axis, narrow.axis);
        let both = Self {
            opening: wide.opening.max(narrow.opening),
            is_mirrored: wide.is_mirrored || narrow.is_mirrored,
            ..*wide
        };
        let reach = between + narrow.spread;
        if reach <= wide.spread {
            return both;
        }
        let spread = 0.5 * (wide.spread + reach);
        let across = narrow.axis - wide.axis * wide.axis.dot(narrow.axis);
        // Axes that are nearly on one line span no plane: the wider cone keeps its axis.
        if spread >= PI || across.length() < 1e-3 {
            let spread = reach.min(PI);
            return Self { spread, ..both };
        }
        let turn = spread - wide.spread;
        let axis = wide.axis * libm::cosf(turn) + across.normalize() * libm::sinf(turn);
        Self {
            axis,
            spread,
            ..both
        }
    }

    /// Returns the approximate mean direction of light; zero where no direction stands out.
    pub(super) fn mean(&self) -> Vec3 {
        if self.is_mirrored || self.spread >= PI {
            Vec3::ZERO
        } else {
            self.axis
        }
    }
}

/// Returns the angle between two unit vectors, exact also where it is small. Unit: rad.
fn angle(a: Vec3, b: Vec3) -> f32 {
    libm::atan2f(a.cross(b).length(), a.dot(b))
}

/// The bounds of an emitter, or of several.
#[derive(Clone, Copy, Debug)]
pub(in crate::light) struct EmitterBounds {
    /// A box around them.
    pub(in crate::light) bounds: Aabb,
    /// A cone around the directions of their light.
    pub(in crate::light) cone: Cone,
    /// The sum of their peak intensities. Unit: W/sr, luminance.
    pub(in crate::light) intensity: f32,
}

impl EmitterBounds {
    /// The bounds of no emitter.
    pub(in crate::light) const NOTHING: Self = Self {
        bounds: Aabb::EMPTY,
        cone: Cone::EVERYWHERE,
        intensity: 0.0,
    };

    /// Returns the bounds of both.
    pub(in crate::light) fn union(&self, other: &Self) -> Self {
        Self {
            bounds: self.bounds.union(other.bounds),
            cone: self.cone.union(&other.cone),
            intensity: self.intensity + other.intensity,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::check_property;
    use proptest::prelude::*;

    fn cone() -> impl Strategy<Value = Cone> {
        let axis = (-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0)
            .prop_map(|(x, y, z)| Vec3::new(x, y, z).normalize_or(Vec3::Z));
        let spread = prop_oneof![Just(0.0), 0.0f32..PI, Just(PI)];
        (axis, spread, 0.0..PI).prop_map(|(axis, spread, opening)| Cone {
            axis,
            spread,
            opening,
            is_mirrored: false,
        })
    }

    /// Returns true where `outer` has all normals that `inner` has.
    fn contains(outer: &Cone, inner: &Cone) -> bool {
        let reach = angle(outer.axis, inner.axis) + inner.spread;
        outer.spread >= PI || reach <= outer.spread + 1e-3
    }

    #[test]
    fn a_union_contains_both_cones() {
        let unlike = (cone(), cone());
        let opposite = cone().prop_map(|a| (a, Cone { axis: -a.axis, ..a }));
        check_property(&prop_oneof![9 => unlike, 1 => opposite], |(a, b)| {
            let both = a.union(&b);
            prop_assert!(contains(&both, &a) && contains(&both, &b));
            prop_assert!(both.opening >= a.opening.max(b.opening));
            prop_assert!((both.axis.length() - 1.0).abs() < 1e-4);
            prop_assert!(both.spread <= PI.min(a.spread + b.spread + angle(a.axis, b.axis)) + 1e-3);
            Ok(())
        });
    }
}

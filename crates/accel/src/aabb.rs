//! Axis-aligned boxes.

use glam::{Vec3, Vec3A, Vec3Swizzles};

/// The points with `min ≤ p ≤ max` on every axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    /// The smallest coordinates.
    pub min: Vec3,
    /// The largest coordinates.
    pub max: Vec3,
}

impl Aabb {
    /// The box without points: the neutral element of [`Aabb::union`].
    pub const EMPTY: Self = Self {
        min: Vec3::INFINITY,
        max: Vec3::NEG_INFINITY,
    };

    /// Returns the smallest box around `points`; [`Aabb::EMPTY`] if there are none.
    pub fn around(points: &[Vec3]) -> Self {
        points.iter().fold(Self::EMPTY, |bounds, &p| {
            bounds.union(Self { min: p, max: p })
        })
    }

    /// Returns the smallest box that contains both.
    #[inline]
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// Returns true if the box has at least one point (a flat box has) and only finite corners.
    pub fn is_valid(&self) -> bool {
        self.min.is_finite() && self.max.is_finite() && self.min.cmple(self.max).all()
    }

    /// Returns true if every point of `other` is in this box, and for an empty `other`.
    pub fn contains(&self, other: &Self) -> bool {
        other.min.cmpgt(other.max).any()
            || (self.min.cmple(other.min).all() && self.max.cmpge(other.max).all())
    }

    /// Returns the middle. None of its intermediate results overflows.
    #[inline]
    pub fn center(&self) -> Vec3 {
        0.5 * self.min + 0.5 * self.max
    }

    /// Returns the length along each axis.
    #[inline]
    pub fn extent(&self) -> Vec3 {
        self.max - self.min
    }

    /// Returns half of the surface area; 0 for an empty box.
    pub fn half_area(&self) -> f32 {
        half_area(self.extent().into())
    }
}

/// Returns half of the surface area of a box, xy + yz + zx for the edge lengths `extent`; negative lengths count as
/// 0.
#[inline]
pub(crate) fn half_area(extent: Vec3A) -> f32 {
    let extent = extent.max(Vec3A::ZERO);
    extent.dot(extent.yzx())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn empty_is_neutral_and_invalid() {
        let unit = Aabb {
            min: Vec3::ZERO,
            max: Vec3::ONE,
        };
        assert_eq!(Aabb::EMPTY.union(unit), unit);
        assert_eq!(Aabb::around(&[]), Aabb::EMPTY);
        assert!(!Aabb::EMPTY.is_valid());
        assert!(unit.contains(&Aabb::EMPTY));
        assert!(!Aabb::EMPTY.contains(&unit));
        assert!(Aabb::EMPTY.half_area().abs() <= 0.0);
    }

    #[test]
    fn measures() {
        let bounds = Aabb::around(&[Vec3::new(1.0, 2.0, 3.0), Vec3::new(0.0, 4.0, 6.0)]);
        assert_eq!(bounds.extent(), Vec3::new(1.0, 2.0, 3.0));
        assert_eq!(bounds.center(), Vec3::new(0.5, 3.0, 4.5));
        assert!((bounds.half_area() - 11.0).abs() <= 0.0);
        let flat = Aabb::around(&[Vec3::ONE]);
        assert!(flat.is_valid());
        let huge = Aabb {
            min: Vec3::splat(f32::MIN),
            max: Vec3::splat(f32::MAX),
        };
        assert!(huge.center().is_finite());
    }
}

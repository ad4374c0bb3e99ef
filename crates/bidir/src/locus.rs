//! Places that paths go through: points of surfaces and in space, and directions to infinity.

use crate::math::Vec3;
use crate::medium::{MediumId, MediumSides};

/// The kind of a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LocusKind {
    /// A point of a surface or of a lens, which has a normal.
    Surface,
    /// A point in space.
    Space,
    /// A point in space where a medium scatters or glows.
    Medium,
    /// A place at infinity.
    Infinity,
}

/// A place that a path goes through.
#[derive(Clone, Copy, Debug)]
pub struct Locus {
    /// The point; for a place at infinity the unit direction towards it.
    pub point: Vec3,
    /// The geometric normal, unit; zero where there is no surface.
    pub n_g: Vec3,
    /// A bound of the distance between `point` and the surface that the intersector sees.
    pub error: f32,
    /// The kind.
    pub kind: LocusKind,
    /// The media on both sides.
    pub media: MediumSides,
}

impl Locus {
    /// Makes a point of a surface.
    #[inline]
    pub fn on_surface(point: Vec3, n_g: Vec3, error: f32) -> Self {
        Self {
            point,
            n_g,
            error,
            kind: LocusKind::Surface,
            media: MediumSides::VACUUM,
        }
    }

    /// Makes a point in space.
    #[inline]
    pub fn in_space(point: Vec3) -> Self {
        Self {
            point,
            n_g: Vec3::ZERO,
            error: 0.0,
            kind: LocusKind::Space,
            media: MediumSides::VACUUM,
        }
    }

    /// Makes a point where `medium` scatters or glows.
    #[inline]
    pub fn in_medium(point: Vec3, medium: MediumId) -> Self {
        Self {
            kind: LocusKind::Medium,
            ..Self::in_space(point).within(MediumSides::all(medium))
        }
    }

    /// Puts the place between these media.
    #[inline]
    #[must_use]
    pub fn within(self, media: MediumSides) -> Self {
        Self { media, ..self }
    }

    /// Returns the medium that a ray along `w` leaves through.
    #[inline]
    pub fn medium_toward(&self, w: Vec3) -> MediumId {
        self.media.toward(self.n_g.dot(w))
    }

    /// Returns the place at infinity that the unit `direction` points to.
    #[inline]
    pub fn at_infinity(direction: Vec3) -> Self {
        Self {
            kind: LocusKind::Infinity,
            ..Self::in_space(direction)
        }
    }

    /// Returns true for a place at infinity.
    #[inline]
    pub fn is_infinite(&self) -> bool {
        self.kind == LocusKind::Infinity
    }

    /// Returns |cosθ| between the normal and `w`; 1 where there is no surface.
    #[inline]
    pub fn abs_cos(&self, w: Vec3) -> f32 {
        match self.kind {
            LocusKind::Surface => self.n_g.dot(w).abs(),
            LocusKind::Space | LocusKind::Medium | LocusKind::Infinity => 1.0,
        }
    }

    /// Returns the origin of a ray along `w` that does not meet the surface of this place: pushed off by the error
    /// to the side that `w` leaves to.
    #[inline]
    pub fn ray_origin(&self, w: Vec3) -> Vec3 {
        self.pushed_off(w, Vec3::splat(self.error))
    }

    /// Returns the end of a ray from the point `from` that does not meet the surface of this place: pushed off by the
    /// error and by what a ray of that length adds. Its direction, the corners as its origin sees them and the `t` of a
    /// hit are rounded, each by at most half an epsilon of the way; another half is room.
    #[inline]
    pub fn ray_end(&self, from: Vec3) -> Vec3 {
        let back = from - self.point;
        self.pushed_off(
            back,
            Vec3::splat(self.error) + 2.0 * f32::EPSILON * back.abs(),
        )
    }

    /// Returns the point on the side that `w` leaves to, off the surface by errors up to these in its coordinates.
    #[inline]
    fn pushed_off(&self, w: Vec3, errors: Vec3) -> Vec3 {
        let distance = self.n_g.abs().dot(errors);
        self.point + self.n_g * distance.copysign(self.n_g.dot(w))
    }

    /// Returns the direction to this place from the point `from`, of any length.
    #[inline]
    pub fn direction_from(&self, from: Vec3) -> Vec3 {
        if self.is_infinite() {
            self.point
        } else {
            self.point - from
        }
    }
}

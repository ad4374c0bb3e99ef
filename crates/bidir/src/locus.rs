//! Loci: the points that paths go through, on surfaces, in space, or at infinity.

use crate::math::Vec3;
use crate::medium::{MediumId, MediumSides};

/// The kind of a locus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LocusKind {
    /// A point of a surface or of a lens, which has a normal.
    Surface,
    /// A point in space.
    Space,
    /// A point in space at which a medium scatters or emits.
    Medium,
    /// A direction to infinity.
    Infinity,
}

/// A point that a path goes through.
#[derive(Clone, Copy, Debug)]
pub struct Locus {
    /// The point; at infinity, the unit direction towards it.
    pub point: Vec3,
    /// The geometric normal, unit; zero without a surface.
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

    /// Makes a point at which `medium` scatters or emits.
    #[inline]
    pub fn in_medium(point: Vec3, medium: MediumId) -> Self {
        Self {
            kind: LocusKind::Medium,
            ..Self::in_space(point).within(MediumSides::all(medium))
        }
    }

    /// Returns the locus with these media on its sides.
    #[inline]
    #[must_use]
    pub fn within(self, media: MediumSides) -> Self {
        Self { media, ..self }
    }

    /// Returns the medium on the side to which a ray along `w` leaves.
    #[inline]
    pub fn medium_toward(&self, w: Vec3) -> MediumId {
        self.media.toward(self.n_g.dot(w))
    }

    /// Makes the locus at infinity in the unit `direction`.
    #[inline]
    pub fn at_infinity(direction: Vec3) -> Self {
        Self {
            kind: LocusKind::Infinity,
            ..Self::in_space(direction)
        }
    }

    /// Returns true for a locus at infinity.
    #[inline]
    pub fn is_infinite(&self) -> bool {
        self.kind == LocusKind::Infinity
    }

    /// Returns |cosθ| between the normal and `w`; 1 without a surface.
    #[inline]
    pub fn abs_cos(&self, w: Vec3) -> f32 {
        match self.kind {
            LocusKind::Surface => self.n_g.dot(w).abs(),
            LocusKind::Space | LocusKind::Medium | LocusKind::Infinity => 1.0,
        }
    }

    /// Returns the origin of a ray along `w` that does not hit the surface of this locus: the point, offset by its
    /// error to the side to which `w` leaves.
    #[inline]
    pub fn ray_origin(&self, w: Vec3) -> Vec3 {
        self.pushed_off(w, Vec3::splat(self.error))
    }

    /// Returns the end of a ray from the point `from` that does not hit the surface of this locus: the point, offset
    /// by its error and by the error of a ray of this length. The ray's direction, the corners as seen from its
    /// origin and the `t` of a hit are rounded, each by at most half an epsilon of the length; another half is
    /// reserve.
    #[inline]
    pub fn ray_end(&self, from: Vec3) -> Vec3 {
        let back = from - self.point;
        self.pushed_off(
            back,
            Vec3::splat(self.error) + 2.0 * f32::EPSILON * back.abs(),
        )
    }

    /// Returns the point offset from the surface, to the side to which `w` leaves, by errors up to these in its
    /// coordinates.
    #[inline]
    fn pushed_off(&self, w: Vec3, errors: Vec3) -> Vec3 {
        let distance = self.n_g.abs().dot(errors);
        self.point + self.n_g * distance.copysign(self.n_g.dot(w))
    }

    /// Returns the direction to this locus from the point `from`, of any length.
    #[inline]
    pub fn direction_from(&self, from: Vec3) -> Vec3 {
        if self.is_infinite() {
            self.point
        } else {
            self.point - from
        }
    }
}

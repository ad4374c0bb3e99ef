//! v(a, b): how much of a shadow ray gets from one end to the other. Surfaces are as opaque to it as
//! they are there (`coverage`), glass too: light through a smooth interface is found by walks.
//!
//! Both ends are pushed off their surface by the error of their point, so that none shadows itself.

use super::Scene;
use crate::math::Vec3;

/// An end of a shadow ray.
#[derive(Clone, Copy, Debug)]
pub struct SegmentEnd {
    /// The point; for an end at infinity the unit direction towards it.
    pub point: Vec3,
    /// The geometric normal; zero for a point in space.
    pub n_g: Vec3,
    /// What the end is pushed off its surface by.
    pub error: f32,
    /// True for an end at infinity.
    pub is_infinite: bool,
}

/// `point` pushed off its surface to the side that `w` leaves to.
#[inline]
pub fn offset_origin(point: Vec3, n_g: Vec3, error: f32, w: Vec3) -> Vec3 {
    let distance = error * (n_g.x.abs() + n_g.y.abs() + n_g.z.abs());
    point + n_g * distance.copysign(n_g.dot(w))
}

impl Scene {
    /// How much of the light from one end to the other arrives, in `[0, 1]`: 0 where something opaque
    /// lies between, 1 where nothing does. At most one end is at infinity.
    #[inline]
    pub fn transmittance(&self, a: &SegmentEnd, b: &SegmentEnd) -> f32 {
        if a.is_infinite {
            return self.transmittance(b, a);
        }
        let ray = if b.is_infinite {
            accel::Ray::new(offset_origin(a.point, a.n_g, a.error, b.point), b.point)
        } else {
            let across = b.point - a.point;
            let from = offset_origin(a.point, a.n_g, a.error, across);
            let to = offset_origin(b.point, b.n_g, b.error, -across);
            accel::Ray {
                t_max: 1.0,
                ..accel::Ray::new(from, to - from)
            }
        };
        self.transmittance_along(&ray)
    }
}

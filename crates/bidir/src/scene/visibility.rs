//! v(a, b): how much of a shadow ray gets from one end to the other. Surfaces are as opaque to it as
//! they are there (`coverage`), glass too: light through a smooth interface is found by walks.
//!
//! Both ends are pushed off their surface by the error of their point, so that none shadows itself.

use super::Scene;
use crate::locus::Locus;

impl Scene {
    /// How much of the light from one end to the other arrives, in `[0, 1]`: 0 where something opaque
    /// lies between, 1 where nothing does. At most one end is at infinity.
    #[inline]
    pub fn transmittance(&self, a: &Locus, b: &Locus) -> f32 {
        if a.is_infinite() {
            return self.transmittance(b, a);
        }
        let ray = if b.is_infinite() {
            accel::Ray::new(a.ray_origin(b.point), b.point)
        } else {
            let across = b.point - a.point;
            let from = a.ray_origin(across);
            let to = b.ray_origin(-across);
            accel::Ray {
                t_max: 1.0,
                ..accel::Ray::new(from, to - from)
            }
        };
        self.transmittance_along(&ray)
    }
}

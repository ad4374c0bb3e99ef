//! v(a, b), the fraction of light that a shadow ray carries from one end to the other. Surfaces have their coverage
//! α, even glass: walks find light through smooth interfaces.
//!
//! Both ends are offset from their surface by the error of their point, the far one also by the error of the ray, so
//! that they do not shadow themselves.

use super::Scene;
use super::passage::Crossings;
use crate::locus::Locus;
use accel::Stop;

/// Memory for shadow rays that are traced together.
#[derive(Debug, Default)]
pub(crate) struct ShadowRayBuffers {
    rays: Vec<accel::Ray>,
    blocked: Vec<bool>,
    transmittances: Vec<f32>,
}

impl Scene {
    /// Returns the fraction of light that surfaces let through from one end to the other: 0 if something opaque is
    /// between, 1 if nothing is. At most one end is at infinity. Range: `[0, 1]`.
    #[inline]
    pub fn transmittance(&self, a: &Locus, b: &Locus) -> f32 {
        self.visible(&shadow_ray(a, b), Stop::NEVER, &mut Crossings::new())
    }

    /// Returns the [transmittance](Self::transmittance) between each pair of ends, in order; this is faster than one
    /// at a time. The results are arbitrary once `stop` is asked for.
    pub(crate) fn transmittances<'a, 'm>(
        &self,
        ends: impl Iterator<Item = &'a [Locus; 2]>,
        stop: Stop<'_>,
        memory: &'m mut ShadowRayBuffers,
    ) -> &'m [f32] {
        let ShadowRayBuffers {
            rays,
            blocked,
            transmittances,
        } = memory;
        rays.clear();
        rays.extend(ends.map(|[a, b]| shadow_ray(a, b)));
        transmittances.clear();
        if self.is_opaque {
            self.bvh.until(stop).are_blocked(rays, blocked);
            transmittances.extend(blocked.iter().map(|&is_blocked| f32::from(!is_blocked)));
        } else {
            let visible = |ray| self.visible(ray, stop, &mut Crossings::new());
            transmittances.extend(rays.iter().map(visible));
        }
        transmittances
    }
}

/// Returns the ray from one end to the other, of which at most one is at infinity.
#[inline]
pub(super) fn shadow_ray(a: &Locus, b: &Locus) -> accel::Ray {
    if a.is_infinite() {
        return shadow_ray(b, a);
    }
    if b.is_infinite() {
        return accel::Ray::new(a.ray_origin(b.point), b.point);
    }
    let from = a.ray_origin(b.point - a.point);
    let to = b.ray_end(from);
    accel::Ray {
        t_max: 1.0,
        ..accel::Ray::new(from, to - from)
    }
}

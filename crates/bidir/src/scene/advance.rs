//! Rays of walks: the surface, or the point in a medium, that each reaches, and the light that is left there.

use super::edge::{Depth, Transmittance};
use super::nesting::Interface;
use super::passage::{Crossings, Passage};
use super::{RayDraws, Scene, SurfaceHit};
use crate::locus::Locus;
use crate::medium::{Drawn, MediumId, MediumScattering, MediumSides};
use crate::spectrum::Lanes;
use accel::{Hit, Ray};
use std::cell::RefCell;

/// The end of a ray of a walk.
#[derive(Clone, Copy, Debug)]
pub enum Interaction {
    /// A point of a surface, and the media on its sides.
    Surface(SurfaceHit, MediumSides),
    /// A point at which a medium scatters or emits.
    Medium(Locus, MediumScattering),
    /// Infinity.
    Escape,
}

/// A ray of a walk.
#[derive(Clone, Copy, Debug)]
pub struct Advance {
    /// Its end.
    pub interaction: Interaction,
    /// T from its origin to its end.
    pub transmittance: Transmittance,
}

/// Draws the lane and the optical depth at which a walk stops.
fn draw(chances: RayDraws<'_>, lanes: Lanes) -> Drawn {
    let [u_lane, u_depth] = chances.flight();
    Drawn {
        lane: lanes.pick_lane(u_lane),
        depth: -libm::log1pf(-u_depth),
    }
}

impl Scene {
    /// Follows a ray of a walk that starts in `medium`. `chances` decide which surfaces it passes, and how far it
    /// gets in media.
    #[inline(never)]
    pub(crate) fn advance(
        &self,
        ray: &Ray,
        medium: MediumId,
        chances: RayDraws<'_>,
        lanes: Lanes,
    ) -> Advance {
        let mut crossings = Crossings::new();
        let (hit, interface) = self.first(ray, chances, &mut crossings);
        let end = hit.map_or(f32::INFINITY, |hit| hit.t);
        let passage = Passage::new(medium, &mut crossings, end);
        let unbounded = |rgb| lanes.unbounded(rgb);
        let mut drawn = None;
        let mut depth = Depth::ZERO;
        for span in passage.spans(end) {
            let Some(index) = span.medium.index() else {
                continue;
            };
            let drawn = drawn.get_or_insert_with(|| draw(chances, lanes));
            let medium = &self.media[index];
            let flight = medium.fly(&span.of(ray, 1.0), *drawn, unbounded);
            let part = Depth::of(medium, flight.depth);
            depth = depth.and(part);
            if let Some(t) = flight.reached {
                return Advance {
                    interaction: self.collide(ray, t, index, lanes),
                    transmittance: depth.transmittance(),
                };
            }
            drawn.depth -= part.drawn[drawn.lane];
        }
        let surface = |hit: Hit| {
            let (_, primitive) = self.resolve(&hit);
            let sides = self.surfaces[primitive.shape as usize].sides;
            let mut at = self.surface_hit(ray, &hit);
            let Some(interface) = interface else {
                return Interaction::Surface(at, sides.unwrap_or(MediumSides::all(passage.last())));
            };
            at.around = interface.around;
            Interaction::Surface(at, interface.sides(at.surface.n_g, ray.direction))
        };
        Advance {
            interaction: hit.map_or(Interaction::Escape, surface),
            transmittance: depth.transmittance(),
        }
    }

    /// Returns the nearest surface that a ray of a walk does not pass, and its interface if it belongs to nested
    /// volumes. Adds the boundaries on the way to `crossings`; some may be behind the surface.
    fn first(
        &self,
        ray: &Ray,
        chances: RayDraws<'_>,
        crossings: &mut Crossings,
    ) -> (Option<Hit>, Option<Interface>) {
        if self.nests() {
            return self.closest_of_nested(ray, chances, crossings);
        }
        let passed = RefCell::new(crossings);
        let cross = |hit: &Hit| passed.borrow_mut().extend(self.crossing(ray, hit));
        (self.closest(ray, chances, cross), None)
    }

    /// Returns the interaction with medium number `index` at `t` of a ray.
    fn collide(&self, ray: &Ray, t: f32, index: usize, lanes: Lanes) -> Interaction {
        let point = ray.origin + ray.direction * t;
        let medium = MediumId::new(index).unwrap_or_default();
        let scattering = self.media[index].scattering(point, lanes);
        Interaction::Medium(Locus::in_medium(point, medium), scattering)
    }
}

#[cfg(test)]
mod tests;

//! Light that the facets of the base scatter more than once, as in [`multiple`]. It leaves metal and other strong
//! reflectors on the side it comes from, a transparent solid on both sides, and a thin wall, whose facets mirror
//! either way, in proportion to Fresnel's mean reflectance. Light that crosses takes the base colour once.

use super::value::LobeValue;
use super::{Principled, Thickness};
use crate::bsdf::multiple::{self, Spread};
use crate::bsdf::{TransportMode, same_hemisphere};
use crate::math::{INV_PI, Vec3};
use crate::spectrum::Spectrum;

/// The least reflectance along the normal of opaque dielectrics with multiple scattering: below it they reflect next
/// to nothing twice.
pub(super) const LEAST_REFLECTANCE: f32 = 0.2;

/// The fractions of the light along one direction that facets lose.
#[derive(Clone, Copy)]
struct Lost {
    /// The fraction that mirroring facets lose.
    mirrors: f32,
    /// The fraction that the interface of a solid loses.
    through: f32,
}

impl Principled {
    /// Returns false if light between facets is lost.
    #[inline]
    pub(super) fn is_multiple(&self) -> bool {
        self.lost > 0.0 || !self.lost_through.is_none()
    }

    #[inline]
    fn lost_of(&self, w: Vec3) -> Lost {
        Lost {
            mirrors: if self.lost > 0.0 {
                multiple::of_mirrors(self.ggx, w)
            } else {
                0.0
            },
            through: if self.lost_through.is_none() {
                0.0
            } else {
                self.interface().lost_of(w)
            },
        }
    }

    /// Returns the fraction of light lost by one opaque facet that leaves after more reflections.
    #[inline]
    fn opaque_remaining(&self) -> Spectrum {
        let mean = |f0: Spectrum, f90: f32| f0.map(|f0| f0 + (f90 - f0) / 21.0);
        let metal = multiple::remaining(mean(self.tint, 1.0), self.lost) * self.metal;
        metal + multiple::remaining(mean(self.f0, self.f90 - self.metal), self.lost)
    }

    /// Returns the share of a thin wall's light that leaves on the other side.
    #[inline]
    fn pane_crossing(&self) -> f32 {
        multiple::mean_transmittance(self.eta.max(1.0 / self.eta))
    }

    /// Returns the share of the surface that is a transparent thin wall.
    #[inline]
    fn pane(&self) -> f32 {
        if self.thickness == Thickness::ThinWalled {
            self.glass
        } else {
            0.0
        }
    }

    /// Returns the share of the surface that is a transparent solid, with facets that reflect by Fresnel's equations.
    /// The loss of refraction alone is unknown, so that the rest keeps its loss.
    #[inline]
    fn solid(&self) -> f32 {
        (self.glass - self.pane()) * self.specular
    }

    /// Returns the fractions of the light lost by mirroring facets that leave on their side, and on the other.
    #[inline]
    fn mirrored_parts(&self) -> [Spectrum; 2] {
        let (pane, crossing) = (self.pane(), self.pane_crossing());
        let stays = self.opaque_remaining() + Spectrum::splat(pane * (1.0 - crossing));
        [stays, self.tint * (pane * crossing)]
    }

    /// Returns the probabilities, if facets are drawn, that light along `w` leaves after more than one of them, on
    /// its side and on the other.
    #[inline]
    pub(super) fn multiple_probs(&self, w: Vec3) -> [f32; 2] {
        let lost = self.lost_of(w);
        let solid = self.solid();
        let interface = self.interface();
        let crossing = if lost.through > 0.0 {
            interface.lost.crossing(w, interface.eta_across(w))
        } else {
            0.0
        };
        let through = solid * lost.through * self.tint.max_lane();
        let [stays, crosses] = self.mirrored_parts().map(Spectrum::max_lane);
        let often = [
            stays * lost.mirrors + through * (1.0 - crossing),
            crosses * lost.mirrors + through * crossing,
        ];
        let opaque = self.normal_reflectance().max_lane() + self.pane();
        let once = opaque * (1.0 - lost.mirrors) + solid * (1.0 - lost.through);
        let sum = (often[0] + often[1] + once).max(f32::MIN_POSITIVE);
        often.map(|share| share / sum)
    }

    /// Returns `once`, and light that more than one facet scatters between the two directions.
    #[inline]
    pub(super) fn with_multiple(
        &self,
        once: LobeValue,
        pair: [Vec3; 2],
        mode: TransportMode,
    ) -> LobeValue {
        let [wo, wi] = pair;
        let side = usize::from(!same_hemisphere(wo, wi));
        let spread = Spread::new(self.ggx);
        let density = |i: usize| {
            let probs = self.multiple_probs(pair[i]);
            let once = (1.0 - probs[0] - probs[1]) * once.densities[i];
            once + probs[side] * spread.pdf(pair[1 - i].z)
        };
        let mut f = once.f;
        if self.lost > 0.0 {
            let [o, i] = pair.map(|w| multiple::of_mirrors(self.ggx, w));
            f += self.mirrored_parts()[side] * (o * i * INV_PI / self.lost);
        }
        if !self.lost_through.is_none() {
            let interface = self.interface();
            let scale = if side == 0 {
                1.0
            } else {
                interface.crossing_scale(wo, mode)
            };
            f += self.tint * (interface.multiple(pair).f * self.solid() * scale);
        }
        LobeValue {
            f,
            densities: [density(0), density(1)],
        }
    }
}

//! T = exp(-τ) of media along segments, and the factor of media in the densities of their ends: traced along a ray,
//! or guessed before.

use super::Scene;
use super::passage::{Crossings, Passage};
use super::visibility::shadow_ray;
use crate::locus::{Locus, LocusKind};
use crate::medium::{Detail, Medium, MediumId, MediumSides, Stretch};
use crate::spectrum::{Lanes, Spectrum};
use accel::{Ray, Stop};

/// The least guessed transmittance: an unknown boundary may lie between the ends.
const LEAST_GUESS: f32 = 1e-3;

/// T = exp(-τ) of the media along a segment, or along a part of it.
#[derive(Clone, Copy, Debug)]
pub struct Transmittance {
    /// T of all media.
    pub all: Spectrum,
    /// T of the media with vertices only: walks draw their distances by it.
    pub drawn: Spectrum,
}

impl Transmittance {
    /// Returns true if no lane is so small that a guess would raise it.
    #[inline]
    fn is_guessable(&self) -> bool {
        self.drawn.min_lane().min(self.all.min_lane()) >= LEAST_GUESS
    }
}

/// τ of the media along a segment, or along a part of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Depth {
    all: Spectrum,
    pub(super) drawn: Spectrum,
}

/// The media between two ends of a segment, a and b.
#[derive(Clone, Copy, Debug)]
pub struct Edge {
    /// The fraction of light that arrives: T, times 1 - α of the surfaces passed. Range: `[0, 1]`.
    pub transmittance: Spectrum,
    /// The factor of media in the density of b drawn from a, with T only of media with vertices: mean(T) on a
    /// surface; mean(σ_t T) in a medium, 1/m.
    pub to_b: f32,
    /// The factor of media in the density of a drawn from b.
    pub to_a: f32,
    /// True if a guess before the ray is traced gives the same edge.
    pub is_guessed: bool,
}

impl Edge {
    /// Returns T / p, with p the factor of media in the density of b: the factor in the throughput of a walk from a
    /// that drew its distance. Zero if a walk cannot reach b.
    #[inline]
    pub(crate) fn throughput(&self) -> Spectrum {
        if self.to_b > 0.0 {
            self.transmittance * (1.0 / self.to_b)
        } else {
            Spectrum::ZERO
        }
    }
}

impl Depth {
    pub(super) const ZERO: Self = Self {
        all: Spectrum::ZERO,
        drawn: Spectrum::ZERO,
    };

    /// Returns the depth of a part in `medium`, given its τ.
    #[inline]
    pub(super) fn of(medium: &Medium, depth: Spectrum) -> Self {
        let drawn = if medium.stops_walks() {
            depth
        } else {
            Spectrum::ZERO
        };
        Self { all: depth, drawn }
    }

    /// Returns the depth of two parts together.
    pub(super) fn and(self, other: Self) -> Self {
        Self {
            all: self.all + other.all,
            drawn: self.drawn + other.drawn,
        }
    }

    /// Returns the smaller of both, lane by lane.
    fn min(self, other: Self) -> Self {
        Self {
            all: self.all.zip(other.all, f32::min),
            drawn: self.drawn.zip(other.drawn, f32::min),
        }
    }

    /// Returns exp(-τ).
    #[inline]
    pub(super) fn transmittance(self) -> Transmittance {
        if self.all.is_black() {
            return Transmittance {
                all: Spectrum::ONE,
                drawn: Spectrum::ONE,
            };
        }
        let arriving = |depth: Spectrum| depth.map(|depth| libm::expf(-depth));
        let drawn = arriving(self.drawn);
        let all = if self.all == self.drawn {
            drawn
        } else {
            arriving(self.all)
        };
        Transmittance { all, drawn }
    }
}

impl Scene {
    /// Returns true if no ray from a point passes through a medium before it hits a surface.
    #[inline]
    pub(crate) fn is_clear_around(&self, place: &Locus) -> bool {
        !self.has_media() || self.is_opaque && place.media == MediumSides::VACUUM
    }

    /// Returns true if it is known, before a ray is traced, that there is no medium between two ends if they are
    /// visible to each other.
    #[inline]
    pub(crate) fn is_clear(&self, a: &Locus, b: &Locus) -> bool {
        let (start, end) = if a.is_infinite() { (b, a) } else { (a, b) };
        self.is_clear_around(start) && end.kind != LocusKind::Medium
    }

    /// Returns true if the media between visible ends are known before a ray is traced: no ray passes a boundary, and
    /// each medium is the same everywhere.
    #[inline]
    pub(crate) fn foresees_media(&self) -> bool {
        self.foresees_media
    }

    /// Returns τ of a stretch in a medium, in this detail.
    fn depth(
        &self,
        medium: MediumId,
        stretch: &Stretch<'_>,
        detail: Detail,
        lanes: Lanes,
    ) -> Depth {
        let unbounded = |rgb| lanes.unbounded(rgb);
        let medium = self.medium(medium);
        medium.map_or(Depth::ZERO, |medium| {
            Depth::of(medium, medium.depth(stretch, detail, unbounded))
        })
    }

    /// Returns the media between two ends, of which at most one is at infinity. None: they are not visible to each
    /// other, nothing arrives, or `stop` was asked for.
    #[inline(never)]
    pub fn edge(&self, [a, b]: [&Locus; 2], lanes: Lanes, stop: Stop<'_>) -> Option<Edge> {
        let ray = shadow_ray(a, b);
        let mut crossings = Crossings::new();
        let visible = self.visible(&ray, stop, &mut crossings);
        if visible <= 0.0 || stop.is_asked() {
            return None;
        }
        let edge = self.edge_across(&ray, &mut crossings, [a, b], lanes);
        let arrives = edge.transmittance * visible;
        (!arrives.is_black()).then_some(Edge {
            transmittance: arrives,
            ..edge
        })
    }

    /// Returns the media between two ends, assuming that they are visible to each other, in a scene that
    /// [foresees](Self::foresees_media) its media. None: nothing arrives.
    pub(crate) fn foreseen_edge(&self, a: &Locus, b: &Locus, lanes: Lanes) -> Option<Edge> {
        let ray = shadow_ray(a, b);
        let edge = self.edge_across(&ray, &mut Crossings::new(), [a, b], lanes);
        (!edge.transmittance.is_black()).then_some(edge)
    }

    /// Returns the media along `ray` from one end to the other, given the boundaries that it crosses.
    #[inline]
    fn edge_across(
        &self,
        ray: &Ray,
        crossings: &mut Crossings,
        [a, b]: [&Locus; 2],
        lanes: Lanes,
    ) -> Edge {
        let (start, end) = if a.is_infinite() { (b, a) } else { (a, b) };
        let unit = ray.direction.length();
        let passage = Passage::new(start.medium_toward(ray.direction), crossings, ray.t_max);
        let depths = passage
            .spans(ray.t_max)
            .map(|span| self.depth(span.medium, &span.of(ray, unit), Detail::Full, lanes));
        let depth = depths.fold(Depth::ZERO, Depth::and);
        let transmittance = depth.transmittance();
        let is_even = self.medium(passage.start).is_none_or(Medium::is_even);
        let is_one = end.medium_toward(-ray.direction) == passage.start;
        Edge {
            is_guessed: passage.crossings.is_empty()
                && is_even
                && is_one
                && transmittance.is_guessable(),
            ..self.edge_of(transmittance, [a, b], lanes)
        }
    }

    /// Returns a guess of the media between two ends from the media at the ends: the thinner of both, all the way.
    /// The guess is never 0.
    #[inline(never)]
    pub(crate) fn guessed_edge(&self, a: &Locus, b: &Locus, lanes: Lanes) -> Edge {
        let ray = shadow_ray(a, b);
        let stretch = Stretch {
            ray: &ray,
            range: [ray.t_min, ray.t_max],
            unit: ray.direction.length(),
        };
        let (from, to) = if a.is_infinite() { (b, a) } else { (a, b) };
        let media = [
            from.medium_toward(ray.direction),
            to.medium_toward(-ray.direction),
        ];
        let through = |medium| self.depth(medium, &stretch, Detail::Means, lanes);
        let near = through(media[0]);
        let depth = if media[0] == media[1] {
            near
        } else {
            near.min(through(media[1]))
        };
        let Transmittance { all, drawn } = depth.transmittance();
        let [all, drawn] = [all, drawn].map(|t| t.map(|lane| lane.max(LEAST_GUESS)));
        self.edge_of(Transmittance { all, drawn }, [a, b], lanes)
    }

    /// Returns the edge with this T. Its densities are 0 if nothing arrives.
    #[inline(never)]
    pub(crate) fn edge_of(
        &self,
        Transmittance { all, drawn }: Transmittance,
        [a, b]: [&Locus; 2],
        lanes: Lanes,
    ) -> Edge {
        let density = |end: &Locus| match end.kind {
            _ if all.is_black() => 0.0,
            LocusKind::Medium => {
                let medium = self.medium(end.media.outside);
                let extinction =
                    medium.map_or(Spectrum::ZERO, |medium| medium.extinction(end.point, lanes));
                lanes.mean(extinction * drawn)
            }
            LocusKind::Surface | LocusKind::Space | LocusKind::Infinity => lanes.mean(drawn),
        };
        Edge {
            transmittance: all,
            to_b: density(b),
            to_a: density(a),
            is_guessed: false,
        }
    }
}

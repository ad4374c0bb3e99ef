//! Media along rays: the boundaries that a ray crosses, the light that is left, and the places where it scatters.
//!
//! A ray begins in the medium of its origin, and the last boundary that it crossed decides. Surfaces that are nothing
//! but boundaries (`Presence::Boundary`) stop no ray; surfaces with holes let some rays through.

use super::nesting::Interface;
use super::{Chances, Presence, Scene, SurfaceHit};
use crate::locus::{Locus, LocusKind};
use crate::math::Vec3;
use crate::medium::{Detail, Drawn, Medium, MediumId, MediumScattering, MediumSides, Stretch};
use crate::spectrum::{Lanes, Spectrum};
use accel::{Hit, Ray, Stop};
use smallvec::SmallVec;
use std::cell::RefCell;

/// The least transmittance that is guessed: an unknown boundary may lie between.
const LEAST_GUESS: f32 = 1e-3;

/// The place that a ray of a walk comes to.
#[derive(Clone, Copy, Debug)]
pub enum Interaction {
    /// A point of a surface, and the media on its sides.
    Surface(SurfaceHit, MediumSides),
    /// A point where a medium scatters or glows.
    Medium(Locus, MediumScattering),
    /// Infinity.
    Escape,
}

/// A ray of a walk.
#[derive(Clone, Copy, Debug)]
pub struct Advance {
    /// Its end.
    pub interaction: Interaction,
    /// T on the way there.
    pub transmittance: Transmittance,
}

/// T = exp(-τ) of the media along a segment, or along a part of it.
#[derive(Clone, Copy, Debug)]
pub struct Transmittance {
    /// T of all media.
    pub all: Spectrum,
    /// T of the media with vertices. Walks draw their distances by it.
    pub drawn: Spectrum,
}

impl Transmittance {
    /// Returns true where no lane is so small that a guess raises it.
    #[inline]
    fn is_guessable(&self) -> bool {
        self.drawn.min_lane().min(self.all.min_lane()) >= LEAST_GUESS
    }
}

/// τ of the same.
#[derive(Clone, Copy, Debug)]
struct Depth {
    all: Spectrum,
    drawn: Spectrum,
}

/// The media between two ends of a segment, a and b.
#[derive(Clone, Copy, Debug)]
pub struct Edge {
    /// The part of light that arrives, in `[0, 1]`: T, times the part of surfaces that is not there.
    pub transmittance: Spectrum,
    /// The factor of media in the density of b drawn from a, with T of those that have vertices: mean(T) on a surface;
    /// mean(σ_t T) in a medium, 1/m.
    pub to_b: f32,
    /// The same for a drawn from b.
    pub to_a: f32,
    /// True where a guess before the ray is traced finds the same.
    pub is_guessed: bool,
}

/// A boundary of media that a ray crosses.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    /// The distance along the ray.
    pub(super) t: f32,
    /// True where the ray leaves the inside of the shape.
    pub(super) leaves: bool,
    /// The boundary, by instance and primitive.
    pub(super) surface: (u32, u32),
    pub(super) from: MediumId,
    pub(super) into: MediumId,
}

/// The boundaries that a ray crosses, in any order.
pub(super) type Crossings = SmallVec<[Crossing; 8]>;

/// The boundaries that a ray crosses, in order.
#[derive(Debug)]
pub(super) struct Passage<'a> {
    start: MediumId,
    crossings: &'a [Crossing],
}

/// A part of a ray in one medium.
#[derive(Clone, Copy, Debug)]
struct Span {
    medium: MediumId,
    begin: f32,
    end: f32,
}

impl Edge {
    /// Returns T / p, with p the factor of media in the density of b: the factor in the throughput of a walk from a
    /// that drew the distance, and that met no surface on its way. Zero where it cannot come there.
    #[inline]
    pub(crate) fn walked(&self) -> Spectrum {
        if self.to_b > 0.0 {
            self.transmittance * (1.0 / self.to_b)
        } else {
            Spectrum::ZERO
        }
    }
}

impl Depth {
    const ZERO: Self = Self {
        all: Spectrum::ZERO,
        drawn: Spectrum::ZERO,
    };

    /// That of a part in `medium`.
    #[inline]
    fn of(medium: &Medium, depth: Spectrum) -> Self {
        let drawn = if medium.stops_walks() {
            depth
        } else {
            Spectrum::ZERO
        };
        Self { all: depth, drawn }
    }

    /// That of both, one behind the other.
    fn and(self, other: Self) -> Self {
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
    fn transmittance(self) -> Transmittance {
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

impl<'a> Passage<'a> {
    /// Returns the passage of a ray that begins in `start` and ends at `end`. Sorts the crossings, and leaves out those
    /// behind its end.
    #[inline]
    pub(super) fn new(start: MediumId, crossings: &'a mut Crossings, end: f32) -> Self {
        if !crossings.is_empty() {
            Self::order(crossings, end);
        }
        Self { start, crossings }
    }

    /// Keeps the crossings before `end`, in the order in which the ray comes to them.
    #[inline(never)]
    fn order(crossings: &mut Crossings, end: f32) {
        crossings.retain(|crossing| crossing.t < end);
        // Where two shapes touch, the one is left before the other is entered. Hits arrive in any order.
        let order = |a: &Crossing, b: &Crossing| {
            let by_side = b.leaves.cmp(&a.leaves);
            let by_place = a.t.total_cmp(&b.t).then(by_side);
            by_place.then(a.surface.cmp(&b.surface))
        };
        crossings.sort_unstable_by(order);
    }

    /// Returns the parts up to `end`.
    fn spans(&self, end: f32) -> impl Iterator<Item = Span> + '_ {
        let begins = self.crossings.iter().map(|crossing| crossing.t);
        let ends = begins.clone().chain([end]);
        let media = self.crossings.iter().map(|crossing| crossing.into);
        let parts = [0.0].into_iter().chain(begins).zip(ends);
        let media = [self.start].into_iter().chain(media);
        parts
            .zip(media)
            .map(|((begin, end), medium)| Span { medium, begin, end })
    }

    /// Returns the medium at the start, as the first boundary has it.
    pub(super) fn first(&self) -> MediumId {
        self.crossings
            .first()
            .map_or(self.start, |first| first.from)
    }

    /// Returns the medium at the end.
    fn last(&self) -> MediumId {
        self.crossings.last().map_or(self.start, |last| last.into)
    }
}

impl Span {
    /// Returns the span as a part of `ray`, whose unit has the length `unit`.
    fn of(self, ray: &Ray, unit: f32) -> Stretch<'_> {
        let range = [self.begin, self.end];
        Stretch { ray, range, unit }
    }
}

/// Draws the lane and the optical depth at which a walk stops.
fn draw(chances: Chances<'_>, lanes: Lanes) -> Drawn {
    let [u_lane, u_depth] = chances.flight();
    Drawn {
        lane: lanes.pick_lane(u_lane),
        depth: -libm::log1pf(-u_depth),
    }
}

impl Scene {
    /// Returns true where rays may go through media.
    #[inline]
    pub fn has_media(&self) -> bool {
        !self.media.is_empty() || self.nests()
    }

    /// Returns all media.
    pub fn media(&self) -> &[Medium] {
        &self.media
    }

    /// Returns the medium around everything.
    pub fn around(&self) -> MediumId {
        self.around
    }

    /// Returns a medium. None: the vacuum.
    fn medium(&self, id: MediumId) -> Option<&Medium> {
        id.index().map(|index| &self.media[index])
    }

    /// Returns true where no ray from a place goes through a medium before it meets a surface.
    #[inline]
    pub(crate) fn is_clear_around(&self, place: &Locus) -> bool {
        !self.has_media() || self.is_opaque && place.media == MediumSides::VACUUM
    }

    /// Returns true where it is known, before any ray is traced, that no medium lies between two ends that see each
    /// other.
    #[inline]
    pub(crate) fn is_clear(&self, a: &Locus, b: &Locus) -> bool {
        let (start, end) = if a.is_infinite() { (b, a) } else { (a, b) };
        self.is_clear_around(start) && end.kind != LocusKind::Medium
    }

    /// Returns true where the media between ends that see each other are known before any ray is traced: no ray passes
    /// a boundary, and each medium is the same everywhere.
    #[inline]
    pub(crate) fn foresees_media(&self) -> bool {
        self.foresees_media
    }

    /// Returns true where light from infinity arrives through the medium around everything.
    pub fn is_open(&self) -> bool {
        let around = self.medium(self.around);
        around.is_none_or(|medium| medium.bounds().is_some())
    }

    /// Returns τ of a stretch in a medium, in the detail asked for.
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

    /// Follows a ray of a walk from `medium`, past some surfaces and through media by `chances`.
    #[inline(never)]
    pub(crate) fn advance(
        &self,
        ray: &Ray,
        medium: MediumId,
        chances: Chances<'_>,
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

    /// Returns the nearest surface that a ray of a walk does not pass; of a volume among others, what is around it.
    /// Adds the boundaries on the way, some behind it perhaps among them.
    fn first(
        &self,
        ray: &Ray,
        chances: Chances<'_>,
        crossings: &mut Crossings,
    ) -> (Option<Hit>, Option<Interface>) {
        if self.nests() {
            return self.closest_of_nested(ray, chances, crossings);
        }
        let passed = RefCell::new(crossings);
        let cross = |hit: &Hit| passed.borrow_mut().extend(self.crossing(ray, hit));
        (self.closest(ray, chances, cross), None)
    }

    /// Returns Π (1 - α) over everything that a shadow ray meets. Adds the boundaries that it crosses.
    pub(super) fn visible(&self, ray: &Ray, stop: Stop<'_>, crossings: &mut Crossings) -> f32 {
        let cross = |hit: &Hit| crossings.extend(self.crossing(ray, hit));
        let visible = self.visible_part(ray, stop, cross);
        if visible > 0.0 && self.nests() {
            visible * self.visible_past_nested(ray, stop, crossings)
        } else {
            visible
        }
    }

    /// Returns the interaction with medium number `index` at `t` of a ray.
    fn collide(&self, ray: &Ray, t: f32, index: usize, lanes: Lanes) -> Interaction {
        let point = ray.origin + ray.direction * t;
        let medium = MediumId::new(index).unwrap_or_default();
        let scattering = self.media[index].scattering(point, lanes);
        Interaction::Medium(Locus::in_medium(point, medium), scattering)
    }

    /// Returns the media between two ends, of which at most one is at infinity. None: something opaque is there,
    /// nothing arrives, or nobody waits for it, because `stop` was asked for.
    #[inline(never)]
    pub fn edge(&self, [a, b]: [&Locus; 2], lanes: Lanes, stop: Stop<'_>) -> Option<Edge> {
        let ray = super::visibility::shadow_ray(a, b);
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

    /// Returns the media between two ends if they see each other, where the scene [foresees](Self::foresees_media)
    /// them. None: nothing arrives.
    pub(crate) fn foreseen_edge(&self, a: &Locus, b: &Locus, lanes: Lanes) -> Option<Edge> {
        let ray = super::visibility::shadow_ray(a, b);
        let edge = self.edge_across(&ray, &mut Crossings::new(), [a, b], lanes);
        (!edge.transmittance.is_black()).then_some(edge)
    }

    /// Returns the media along `ray` from one end to the other, which crosses these boundaries.
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

    /// Returns a guess at the media between two ends from those next to them: the thinner of both, all the way.
    /// Something always arrives.
    #[inline(never)]
    pub(crate) fn guessed_edge(&self, a: &Locus, b: &Locus, lanes: Lanes) -> Edge {
        let ray = super::visibility::shadow_ray(a, b);
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

    /// Returns the edge of which T is known. Its densities are 0 where nothing arrives.
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

    /// Returns the boundary that a ray crosses at `hit`. None: the surface is none.
    pub(super) fn crossing(&self, ray: &Ray, hit: &Hit) -> Option<Crossing> {
        let sides = self.parted(hit)?;
        let leaves = self.surface_at(ray, hit).n_g.dot(ray.direction) > 0.0;
        Some(Crossing {
            t: hit.t,
            leaves,
            surface: (hit.instance, hit.primitive),
            from: sides.toward(if leaves { -1.0 } else { 1.0 }),
            into: sides.toward(if leaves { 1.0 } else { -1.0 }),
        })
    }

    /// Returns the medium at a point in space: most of some rays say so by the nearest boundary on their way, or else
    /// it is the one around everything.
    pub fn medium_at(&self, point: Vec3) -> MediumId {
        let is_boundary = |hit: &Hit| self.crosses(hit);
        by_most(|direction| {
            let ray = Ray::new(point, direction);
            if self.nests() {
                let crossings = &mut self.boundaries(&ray);
                return Passage::new(self.around, crossings, f32::INFINITY).first();
            }
            let hit = self.bvh.closest(&ray, is_boundary);
            let crossing = hit.and_then(|hit| self.crossing(&ray, &hit));
            crossing.map_or(self.around, |crossing| crossing.from)
        })
    }

    /// Returns the medium around everything, where most of some rays from `medium` at a point come to.
    pub(super) fn medium_beyond(&self, point: Vec3, medium: MediumId) -> MediumId {
        by_most(|direction| {
            let ray = Ray::new(point, direction);
            Passage::new(medium, &mut self.boundaries(&ray), f32::INFINITY).last()
        })
    }

    fn crosses(&self, hit: &Hit) -> bool {
        self.parted(hit).is_some()
    }

    /// Returns the media that the surface at `hit` parts, wherever some of it is there. None: it parts none.
    fn parted(&self, hit: &Hit) -> Option<MediumSides> {
        let (_, primitive) = self.resolve(hit);
        let surface = &self.surfaces[primitive.shape as usize];
        surface
            .sides
            .filter(|_| surface.presence != Presence::Absent)
    }

    /// Returns a point on shape number `shape`, one of the world, or near it where rays do not meet it.
    pub(super) fn point_on(&self, shape: usize) -> Vec3 {
        let bounds = self.shapes[shape].primitive(0).bounds();
        let (centre, corner) = (bounds.center(), bounds.max + bounds.max - bounds.min);
        let ray = Ray::new(corner, centre - corner);
        let is_of_shape = |hit: &Hit| {
            let (placed, primitive) = self.resolve(hit);
            placed.is_none() && primitive.shape as usize == shape
        };
        let hit = self.bvh.closest(&ray, is_of_shape);
        hit.map_or(centre, |hit| ray.origin + ray.direction * hit.t)
    }
}

/// Returns the answer of most of three rays, of the second where they differ.
fn by_most(answer: impl Fn(Vec3) -> MediumId) -> MediumId {
    /// Far from axes and diagonals, along which people build.
    const RAYS: [Vec3; 3] = [
        Vec3::new(0.36, 0.48, 0.8),
        Vec3::new(-0.6, 0.64, -0.48),
        Vec3::new(0.28, -0.96, 0.0),
    ];
    let [a, b] = [RAYS[0], RAYS[1]].map(&answer);
    if a == b || answer(RAYS[2]) == a { a } else { b }
}

#[cfg(test)]
mod tests;

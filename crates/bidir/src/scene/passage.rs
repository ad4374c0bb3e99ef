//! Boundaries of media along rays.
//!
//! A ray begins in the medium of its origin; after that, the last crossed boundary determines the medium. A surface
//! that is only a boundary (`Opacity::Boundary`) stops no ray; a surface with coverage below 1 lets some rays
//! through.

use super::{Opacity, Scene};
use crate::math::Vec3;
use crate::medium::{Medium, MediumId, MediumSides, Stretch};
use accel::{Hit, Ray, Stop};
use smallvec::SmallVec;

/// A boundary of media that a ray crosses.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    /// The distance along the ray.
    pub(super) t: f32,
    /// True if the ray leaves the inside of the shape.
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
    pub(super) start: MediumId,
    pub(super) crossings: &'a [Crossing],
}

/// A part of a ray in one medium.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    pub(super) medium: MediumId,
    begin: f32,
    end: f32,
}

impl<'a> Passage<'a> {
    /// Makes the passage of a ray from the medium `start` to the distance `end`. Sorts the crossings, and removes
    /// those behind `end`.
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
        // Where two shapes touch, one is left before the other is entered. Hits come in any order.
        let order = |a: &Crossing, b: &Crossing| {
            let by_side = b.leaves.cmp(&a.leaves);
            let by_place = a.t.total_cmp(&b.t).then(by_side);
            by_place.then(a.surface.cmp(&b.surface))
        };
        crossings.sort_unstable_by(order);
    }

    /// Returns the parts of the ray, up to `end`, each in one medium.
    pub(super) fn spans(&self, end: f32) -> impl Iterator<Item = Span> + '_ {
        let begins = self.crossings.iter().map(|crossing| crossing.t);
        let ends = begins.clone().chain([end]);
        let media = self.crossings.iter().map(|crossing| crossing.into);
        let parts = [0.0].into_iter().chain(begins).zip(ends);
        let media = [self.start].into_iter().chain(media);
        parts
            .zip(media)
            .map(|((begin, end), medium)| Span { medium, begin, end })
    }

    /// Returns the medium at the start, according to the first boundary.
    pub(super) fn first(&self) -> MediumId {
        self.crossings
            .first()
            .map_or(self.start, |first| first.from)
    }

    /// Returns the medium at the end.
    pub(super) fn last(&self) -> MediumId {
        self.crossings.last().map_or(self.start, |last| last.into)
    }
}

impl Span {
    /// Returns the span as a part of `ray`, whose unit has the length `unit`.
    pub(super) fn of(self, ray: &Ray, unit: f32) -> Stretch<'_> {
        let range = [self.begin, self.end];
        Stretch { ray, range, unit }
    }
}

impl Scene {
    /// Returns true if rays may pass through media.
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
    pub(super) fn medium(&self, id: MediumId) -> Option<&Medium> {
        id.index().map(|index| &self.media[index])
    }

    /// Returns true if light from infinity arrives through the medium around everything.
    pub fn is_open(&self) -> bool {
        let around = self.medium(self.around);
        around.is_none_or(|medium| medium.bounds().is_some())
    }

    /// Returns Π (1 - α) over all surfaces that a shadow ray hits. Adds the boundaries that it crosses.
    pub(super) fn visible(&self, ray: &Ray, stop: Stop<'_>, crossings: &mut Crossings) -> f32 {
        let cross = |hit: &Hit| crossings.extend(self.crossing(ray, hit));
        let visible = self.visible_part(ray, stop, cross);
        if visible > 0.0 && self.nests() {
            visible * self.visible_past_nested(ray, stop, crossings)
        } else {
            visible
        }
    }

    /// Returns the boundary that a ray crosses at `hit`. None: the surface is not a boundary.
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

    /// Returns the medium at a point in space, by the majority of three rays: the medium before the first boundary on
    /// their way, or else the medium around everything.
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

    /// Returns the medium around everything, by the majority of three rays that start in `medium` at a point.
    pub(super) fn medium_beyond(&self, point: Vec3, medium: MediumId) -> MediumId {
        by_most(|direction| {
            let ray = Ray::new(point, direction);
            Passage::new(medium, &mut self.boundaries(&ray), f32::INFINITY).last()
        })
    }

    fn crosses(&self, hit: &Hit) -> bool {
        self.parted(hit).is_some()
    }

    /// Returns the media on the sides of the surface at `hit`. None: they are equal, or the surface is invisible.
    fn parted(&self, hit: &Hit) -> Option<MediumSides> {
        let (_, primitive) = self.resolve(hit);
        let surface = &self.surfaces[primitive.shape as usize];
        surface
            .sides
            .filter(|_| surface.opacity != Opacity::Invisible)
    }

    /// Returns a point on shape number `shape` of the world, or near it if rays do not hit it.
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

/// Returns the majority of the answers of three rays, or the second if all differ.
fn by_most(answer: impl Fn(Vec3) -> MediumId) -> MediumId {
    /// Directions far from axes and diagonals, along which people build.
    const RAYS: [Vec3; 3] = [
        Vec3::new(0.36, 0.48, 0.8),
        Vec3::new(-0.6, 0.64, -0.48),
        Vec3::new(0.28, -0.96, 0.0),
    ];
    let [a, b] = [RAYS[0], RAYS[1]].map(&answer);
    if a == b || answer(RAYS[2]) == a { a } else { b }
}

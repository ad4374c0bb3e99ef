//! Nested volumes: of all closed surfaces around a point, one fills it \[Schmidt02\].
//!
//! Along a ray, volume v has the winding number
//!
//! n_v(t) = Σ ±1 over the crossings of v beyond t, + where the ray leaves v,
//!
//! and v is around the point at t if n_v(t) > 0. Surfaces of volumes are closed, so that this is a function of the
//! point: walks carry no list of volumes, and both ends of a path find the same one. Of the volumes around a point,
//! the one of the highest rank fills it. A surface exists if different substances fill its sides; rays pass the
//! others. Boundaries within a volume are ignored.
//!
//! Volumes whose boxes touch no other box need none of this: their surfaces exist, with air around them.

use super::object::{Objects, Placed};
use super::passage::{Crossing, Crossings};
use super::{PrimitiveRef, RayDraws, Scene, Surface};
use crate::math::Vec3;
use crate::medium::{MediumId, MediumSides};
use crate::shape::{Shape, position_error};
use accel::{Aabb, Hit, Ray, Stop};
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::ControlFlow;

/// The substance within a closed surface. Of the volumes around a point, the one of the highest priority fills it; of
/// equal ones, the one that encloses least.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Volume {
    /// The index of refraction, that of air being 1.
    pub index: f32,
    /// The medium.
    pub medium: MediumId,
    /// Its priority at points that it shares with other volumes.
    pub priority: i32,
}

/// A volume of a scene.
#[derive(Clone, Copy, Debug)]
pub(super) struct Enclosed {
    pub(super) volume: Volume,
    /// The space that it encloses. Unit: m³, in the space of its shapes.
    pub(super) size: f64,
    /// The largest absolute coordinate of its boxes in the world.
    pub(super) reach: f32,
}

/// The volume of an instance. Volumes are ordered by priority: of two around a point, the greater fills it.
#[derive(Clone, Copy, Debug)]
struct PlacedVolume {
    volume: Volume,
    size: f64,
    /// The largest absolute coordinate of its boxes.
    reach: f32,
    /// The indices of the volume and of the instance.
    number: (u32, u32),
    /// The material: a substance includes it.
    material: u32,
}

/// The volumes around a point of a ray, each with its winding number.
#[derive(Debug, Default)]
struct Around(BTreeMap<PlacedVolume, i32>);

/// A crossing, with the hit and the volume of the crossed surface. None: it is only a boundary between media.
#[derive(Clone, Copy, Debug)]
struct Event {
    crossing: Crossing,
    of: Option<(Hit, PlacedVolume)>,
}

/// The surface of a volume that stops a ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct Interface {
    pub(super) hit: Hit,
    /// The media before it and behind it.
    media: [MediumId; 2],
    /// The index of refraction around the volume.
    pub(super) around: f32,
}

impl PartialEq for PlacedVolume {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for PlacedVolume {}

impl PartialOrd for PlacedVolume {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for PlacedVolume {
    fn cmp(&self, other: &Self) -> Ordering {
        (self.volume.priority.cmp(&other.volume.priority))
            .then(other.size.total_cmp(&self.size))
            .then(self.number.cmp(&other.number))
    }
}

impl Around {
    /// Returns the volumes around the start of a ray with these events.
    fn start(events: &[Event]) -> Self {
        let mut around = Self::default();
        for event in events {
            if let Some((_, volume)) = event.of {
                around.add(volume, -step(&event.crossing));
            }
        }
        around
    }

    fn add(&mut self, volume: PlacedVolume, step: i32) {
        let count = self.0.entry(volume).or_default();
        *count += step;
        if *count == 0 {
            self.0.remove(&volume);
        }
    }

    /// Returns the volume that fills the point.
    fn dominant(&self) -> Option<PlacedVolume> {
        let mut around = self.0.iter().rev();
        around.find_map(|(volume, &count)| (count > 0).then_some(*volume))
    }
}

/// Returns the change of the winding number at a crossing.
fn step(crossing: &Crossing) -> i32 {
    if crossing.leaves { -1 } else { 1 }
}

/// Returns true if two sides are filled with the same substance, so that no surface is between them.
fn are_one(a: Option<PlacedVolume>, b: Option<PlacedVolume>) -> bool {
    let substance = |of: PlacedVolume| (of.material, of.volume.medium, of.volume.index.to_bits());
    a == b || a.map(substance) == b.map(substance)
}

impl Interface {
    /// Returns the media on the sides of the surface with normal `n_g`, hit by a ray along `direction`.
    pub(super) fn sides(&self, n_g: Vec3, direction: Vec3) -> MediumSides {
        let [before, behind] = self.media;
        if n_g.dot(direction) > 0.0 {
            MediumSides {
                outside: behind,
                inside: before,
            }
        } else {
            MediumSides {
                outside: before,
                inside: behind,
            }
        }
    }
}

impl Scene {
    /// Returns the nearest surface that a ray of a walk does not pass, in a scene with nested volumes. Sets
    /// `crossings` to the boundaries on the way.
    pub(super) fn closest_of_nested(
        &self,
        ray: &Ray,
        draws: RayDraws<'_>,
        crossings: &mut Crossings,
    ) -> (Option<Hit>, Option<Interface>) {
        let is_near = std::cell::Cell::new(false);
        let passed = std::cell::RefCell::new(Crossings::new());
        let hit = self.bvh.until(draws.stop).closest(ray, |hit| {
            if self.volume_of(hit).is_some() {
                is_near.set(true);
                return false;
            }
            let stops = self.stops(ray, hit, draws);
            if !stops {
                passed.borrow_mut().extend(self.crossing(ray, hit));
            }
            stops
        });
        let end = hit.map_or(f32::INFINITY, |hit| hit.t);
        *crossings = passed.into_inner();
        if !is_near.get() {
            return (hit, None);
        }
        let stops = |hit: &Hit| self.stops(ray, hit, draws);
        let interface = self.settle(ray, draws.stop, end, crossings, stops);
        (interface.map(|interface| interface.hit).or(hit), interface)
    }

    /// Returns Π (1 - α) of the surfaces of nested volumes that a shadow ray hits. Updates the boundaries on its way.
    pub(super) fn visible_past_nested(
        &self,
        ray: &Ray,
        stop: Stop<'_>,
        crossings: &mut Crossings,
    ) -> f32 {
        let mut visible = 1.0;
        let interface = self.settle(ray, stop, ray.t_max, crossings, |hit| {
            let alpha = self.alpha(ray, hit);
            visible *= 1.0 - alpha;
            alpha >= 1.0
        });
        if interface.is_some() { 0.0 } else { visible }
    }

    /// Updates the boundaries that a ray crosses before `end`: adds the surfaces of volumes that exist, and removes
    /// boundaries within volumes. Returns the surface that stops the ray, and ends there.
    fn settle(
        &self,
        ray: &Ray,
        stop: Stop<'_>,
        end: f32,
        crossings: &mut Crossings,
        mut stops: impl FnMut(&Hit) -> bool,
    ) -> Option<Interface> {
        let events = self.events(ray, stop, std::mem::take(crossings));
        let mut around = Around::start(&events);
        for Event { crossing, of } in events {
            if crossing.t >= end {
                break;
            }
            let before = around.dominant();
            let Some((hit, volume)) = of else {
                if before.is_none() {
                    crossings.push(crossing);
                }
                continue;
            };
            around.add(volume, step(&crossing));
            let behind = around.dominant();
            if are_one(before, behind) {
                continue;
            }
            let medium = |of: Option<PlacedVolume>| of.map_or(crossing.from, |of| of.volume.medium);
            let media = [medium(before), medium(behind)];
            if stops(&hit) {
                let other = if crossing.leaves { behind } else { before };
                let around = other.map_or(1.0, |other| other.volume.index);
                return Some(Interface { hit, media, around });
            }
            crossings.push(Crossing {
                from: media[0],
                into: media[1],
                ..crossing
            });
        }
        None
    }

    /// Returns `boundaries` and all surfaces of volumes, from the start of a ray to infinity, in order.
    fn events(&self, ray: &Ray, stop: Stop<'_>, boundaries: Crossings) -> Vec<Event> {
        let boundary = |crossing| Event { crossing, of: None };
        let mut events: Vec<_> = boundaries.into_iter().map(boundary).collect();
        let line = Ray {
            t_max: f32::INFINITY,
            ..*ray
        };
        let _ = self.bvh.until(stop).each_hit(&line, |hit| {
            events.extend(self.event(ray, hit));
            if stop.is_asked() {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        // Where two volumes touch, one is entered before the other is left, so that no gap is between them.
        let leaves_late = |event: &Event| event.of.is_some() == event.crossing.leaves;
        let order = |a: &Event, b: &Event| {
            let by_place = a.crossing.t.total_cmp(&b.crossing.t);
            let by_kind = a.of.is_some().cmp(&b.of.is_some());
            let by_side = leaves_late(a).cmp(&leaves_late(b));
            let by_surface = a.crossing.surface.cmp(&b.crossing.surface);
            by_place.then(by_kind).then(by_side).then(by_surface)
        };
        events.sort_unstable_by(order);
        close_gaps(ray, &mut events);
        events
    }

    /// Returns the crossing of a volume's surface. Its media are those around the volume, if no other volume is
    /// there.
    fn event(&self, ray: &Ray, hit: &Hit) -> Option<Event> {
        let volume = self.volume_of(hit)?;
        let (placed, primitive) = self.resolve(hit);
        let surface = &self.surfaces[primitive.shape as usize];
        let outside = surface
            .sides
            .map_or(MediumId::VACUUM, |sides| sides.outside);
        let crossing = Crossing {
            t: hit.t,
            leaves: self.front(ray, hit, placed, primitive).dot(ray.direction) > 0.0,
            surface: (hit.instance, hit.primitive),
            from: outside,
            into: outside,
        };
        Some(Event {
            crossing,
            of: Some((*hit, volume)),
        })
    }

    /// Returns the normal of a closed surface that points out of it, whatever the shading normals are.
    fn front(
        &self,
        ray: &Ray,
        hit: &Hit,
        placed: Option<&Placed>,
        primitive: PrimitiveRef,
    ) -> Vec3 {
        match &self.shapes[primitive.shape as usize] {
            Shape::Mesh(mesh) => {
                let world_from_object = placed.map(|placed| &placed.world_from_object);
                mesh.front(world_from_object, primitive.index as usize)
            }
            Shape::Sphere(_) | Shape::Disk(_) | Shape::Cylinder(_) => self.surface_at(ray, hit).n_g,
        }
    }

    /// Returns the volume whose surface is hit. None: the surface bounds none, or one that touches no other.
    #[inline]
    fn volume_of(&self, hit: &Hit) -> Option<PlacedVolume> {
        let (placed, primitive) = self.resolve(hit);
        let surface = &self.surfaces[primitive.shape as usize];
        let number = surface.volume?;
        let Enclosed {
            volume,
            size,
            reach,
        } = self.volumes[number as usize];
        let scale = placed.map_or(1.0, |placed| placed.world_from_object.volume_scale());
        Some(PlacedVolume {
            volume,
            size: size * scale,
            reach,
            number: (number, hit.instance),
            material: surface.material,
        })
    }

    /// Returns true if the hit surface bounds a nested volume.
    #[inline]
    pub(super) fn is_of_nested(&self, hit: &Hit) -> bool {
        self.nests() && self.volume_of(hit).is_some()
    }

    /// Returns true if the scene has volumes that touch each other.
    #[inline]
    pub(super) fn nests(&self) -> bool {
        !self.volumes.is_empty()
    }

    /// Returns the boundaries that a ray crosses, including all surfaces of volumes.
    pub(super) fn boundaries(&self, ray: &Ray) -> Crossings {
        let mut crossings = Crossings::new();
        let _ = self.bvh.each_hit(ray, |hit| {
            if self.volume_of(hit).is_none() {
                crossings.extend(self.crossing(ray, hit));
            }
            ControlFlow::Continue(())
        });
        if self.nests() {
            self.settle(ray, Stop::NEVER, f32::INFINITY, &mut crossings, |_| false);
        }
        crossings
    }

    /// Returns the media on the sides of a volume's surface at a point. None: the volume touches no other.
    pub(super) fn sides_of_nested(&self, volume: Option<u32>, point: Vec3) -> Option<MediumSides> {
        let inside = self.volumes.get(volume? as usize)?.volume.medium;
        let outside = self.medium_at(point);
        Some(MediumSides { outside, inside })
    }
}

/// Swaps crossings so that one volume is entered before another is left if only rounding separates their surfaces.
fn close_gaps(ray: &Ray, events: &mut [Event]) {
    let unit = ray.direction.length();
    // The rounding of distances grows with the origin.
    let error = 8.0 * f32::EPSILON * ray.origin.abs().max_element();
    for i in 1..events.len() {
        let [left, entered] = [events[i - 1], events[i]];
        let (Some((_, a)), Some((_, b))) = (left.of, entered.of) else {
            continue;
        };
        let gap = (entered.crossing.t - left.crossing.t) * unit;
        let is_gap = left.crossing.leaves && !entered.crossing.leaves;
        if is_gap && gap <= least_gap(a.reach.max(b.reach)) + error {
            events.swap(i - 1, i);
        }
    }
}

/// Returns the largest gap between surfaces, with coordinates up to `reach`, that the offset of a ray's origin from
/// one surface may cross.
fn least_gap(reach: f32) -> f32 {
    2.0 * position_error(reach)
}

/// Returns the largest absolute coordinate of a box.
pub(super) fn reach(of: &Aabb) -> f32 {
    of.min.abs().max(of.max.abs()).max_element()
}

/// Returns the boxes of the shapes of volumes in the world; shapes of objects have one for each instance.
pub(super) fn boxes(shapes: &[Shape], surfaces: &[Surface], objects: &Objects) -> Vec<(u32, Aabb)> {
    let bounds_of = |shape: usize| {
        let volume = surfaces[shape].volume?;
        let [min, max] = shapes[shape].corners();
        Some((volume, Aabb { min, max }))
    };
    let mut is_in_world = vec![true; shapes.len()];
    for &shape in objects.shapes.iter().flatten() {
        is_in_world[shape] = false;
    }
    let in_world = (0..shapes.len()).filter(|&shape| is_in_world[shape]);
    let mut boxes: Vec<_> = in_world.filter_map(bounds_of).collect();
    let of_object =
        |shapes: &Vec<usize>| -> Vec<_> { shapes.iter().copied().filter_map(bounds_of).collect() };
    let own: Vec<_> = objects.shapes.iter().map(of_object).collect();
    for (object, world_from_object) in &objects.instances {
        let own = own[object.index()].iter();
        boxes.extend(own.map(|&(volume, bounds)| (volume, world_from_object.bounds(bounds))));
    }
    boxes
}

/// Removes the volumes that touch no other, up to rounding, from their surfaces. `boxes` are the boxes of their
/// shapes in the world.
///
/// Returns true if any volume is left.
pub(super) fn keep_touching(surfaces: &mut [Surface], mut boxes: Vec<(u32, Aabb)>) -> bool {
    for (_, bounds) in &mut boxes {
        let gap = least_gap(reach(bounds));
        bounds.min -= gap;
        bounds.max += gap;
    }
    boxes.sort_by(|(_, a), (_, b)| a.min.x.total_cmp(&b.min.x));
    let touching = touching(&boxes);
    for surface in surfaces {
        surface.volume = surface.volume.filter(|volume| touching.contains(volume));
    }
    !touching.is_empty()
}

/// Returns the volumes whose boxes touch another; `boxes` are sorted by their smallest x.
fn touching(boxes: &[(u32, Aabb)]) -> BTreeSet<u32> {
    /// The most boxes that each is compared with; if more are near, all count as touching.
    const MOST: usize = 256;
    let mut touching = BTreeSet::new();
    for (i, (a, of_a)) in boxes.iter().enumerate() {
        let others = boxes[i + 1..].iter();
        let near = others.take_while(|(_, of_b)| of_b.min.x <= of_a.max.x);
        for (n, (b, of_b)) in near.enumerate() {
            if n == MOST {
                return boxes.iter().map(|(volume, _)| *volume).collect();
            }
            let apart = of_a.min.cmpgt(of_b.max) | of_b.min.cmpgt(of_a.max);
            if !apart.any() {
                touching.extend([*a, *b]);
            }
        }
    }
    touching
}

//! Instances: an object's tree, shared by all its instances, and an affine map for each.
//!
//! A ray is mapped to the object's space, and intersects the object's tree there. All triangles of an instance see
//! the same local ray, so that edges between them stay as tight as without the map. With `M` the map to the object's
//! space, the local ray is
//!
//! ```text
//!     d' = M d   (no translation),   o' = M o + t₀·d',   t = t₀ + t'
//! ```
//!
//! `t₀ ≥ 0` is where the ray enters a ball around the instance, or 0 if it starts inside. Starting there avoids the
//! loss of digits by a distant origin. The direction is not normalised, so that `t'` has the unit of `t`. All of it
//! is computed in `f64`, in one order, without FMA; `o'` and `d'` are then rounded to `f32` numbers, which the exact
//! test of edges needs.
//!
//! **Boxes.** Rounding moves the local line. Let `ε` be half of `f32::EPSILON`, `R` the radius of the ball
//! and `c'` its local center. Per local axis, `ρ = R·|row of M|` bounds the distance from `c'` in the
//! ball, and `m = |c'| + ρ` all coordinates there. Within the ball the line is moved by at most `εm`
//! (origin) and `2ερ` (direction); a leaf moves its vertices by `2ερ` (translation) and rounds
//! `t'`, which is another `2ερ` along the line. That is less than `e = 2ε(m + 8ρ)`, of which the
//! second half is room for the `f64` arithmetic, for origins up to 2²⁶ radii away.
//! The world box of an instance is that of the mapped local boxes, widened by `|M⁻¹|·e`: whatever the
//! local line hits is in a box that the world ray meets. Local boxes are those at the third level of the object's tree:
//! mapped together they leave less room around what is round or turned than the object's own box.
//!
//! **Limits.** `t` is rounded once, from `t₀ + t'`. The local limits are those of the world minus `t₀`, moved outward
//! by `4ε` of themselves, so that no hit at an equal distance is culled.

use glam::{DAffine3, DVec3};

use crate::aabb::Aabb;
use crate::primitive::{abs_times, outward};
use crate::ray::{Hit, Ray};

/// An object, and its map to the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instance {
    /// Index of the object.
    pub object: u32,
    /// Any invertible affine map, mirroring ones included.
    pub world_from_object: DAffine3,
}

/// An [`Instance`] made ready for rays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Placement {
    object_from_world: DAffine3,
    /// A ball around the instance, in world space.
    center: DVec3,
    radius: f32,
    pub(crate) object: u32,
}

/// The largest factor by which a map may stretch, in either direction: directions stay in the range of `f32`.
const MOST_SCALE: f64 = 1e18;

/// The error of a sum of two lengths, relative to them: 2⁻⁴⁸, some roundings of an `f64`.
const CANCELLED: f64 = 1.0 / (1u64 << 48) as f64;

// Memory estimates rely on this.
const _: () = assert!(size_of::<Placement>() <= 128);

impl Placement {
    /// Places an object with these bounds, and returns the bounds of the instance. `parts` are boxes that together
    /// contain the object; small ones make the bounds tight.
    ///
    /// None: the map has no inverse, or is so close to having none that the rounding of rays exceeds
    /// the instance, or something overflows.
    pub(crate) fn new(instance: &Instance, object: &Aabb, parts: &[Aabb]) -> Option<(Self, Aabb)> {
        let world_from_object = instance.world_from_object;
        let object_from_world = world_from_object.inverse();
        let (low, high) = (object.min.as_dvec3(), object.max.as_dvec3());
        let local_center = 0.5 * (low + high);
        let center = world_from_object.transform_point3(local_center);
        let half = abs_times(&world_from_object, 0.5 * (high - low));
        // The rounding error depends on the ball, and the ball on the error: the first ball is larger.
        let offset = abs_times(&world_from_object, local_center.abs());
        let cancelled = CANCELLED * (center.abs() + offset + half);
        let radius = 2.0 * half.length() + 1e-5 * offset.length() + 1e3 * cancelled.length();
        let error = local_error(&object_from_world, local_center, radius);
        let margin = abs_times(&world_from_object, error) + cancelled;
        let reach = half + margin;
        let is_moderate = |map: &DAffine3| {
            let columns = [map.matrix3.x_axis, map.matrix3.y_axis, map.matrix3.z_axis];
            columns.iter().all(|column| column.length() <= MOST_SCALE)
        };
        // Also false for the NaN and the infinities of a singular map.
        if !(reach.length() <= radius
            && is_moderate(&world_from_object)
            && is_moderate(&object_from_world))
        {
            return None;
        }
        let (low, high) = mapped(&world_from_object, parts);
        let bounds = Aabb {
            min: (low - margin).to_array().map(|x| outward(x, -1.0)).into(),
            max: (high + margin).to_array().map(|x| outward(x, 1.0)).into(),
        };
        let placement = Self {
            object_from_world,
            center,
            radius: outward(reach.length(), 1.0),
            object: instance.object,
        };
        bounds.is_valid().then_some((placement, bounds))
    }

    pub(crate) fn object_from_world(&self) -> &DAffine3 {
        &self.object_from_world
    }

    /// Returns the ray in the object's space, and its relation to the world. `instance` is the index that hits get.
    #[inline(always)]
    pub(crate) fn view(&self, ray: &Ray, approach: &Approach, instance: u32) -> (Ray, Object) {
        let start = approach.entry(self);
        let object = Object::new(instance, start, ray);
        let origin = self.object_from_world.transform_point3(approach.origin);
        let direction = self.object_from_world.transform_vector3(approach.direction);
        let local = Ray {
            origin: (origin + start * direction).as_vec3(),
            direction: direction.as_vec3(),
            t_min: moved(ray.t_min, start, -OUTWARD),
            t_max: object.local_t_max(),
        };
        (local, object)
    }
}

/// A ray of the world, with the terms that are the same for all instances.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Approach {
    origin: DVec3,
    direction: DVec3,
    /// `d / |d|²`.
    along: DVec3,
    /// `1.001 / |d|`.
    slowness: f64,
}

impl Approach {
    /// Prepares a ray that is already cleaned.
    #[inline(always)]
    pub(crate) fn new(ray: &Ray) -> Self {
        let direction = ray.direction.as_dvec3();
        let inverse2 = 1.0 / direction.length_squared();
        Self {
            origin: ray.origin.as_dvec3(),
            direction,
            along: direction * inverse2,
            slowness: 1.001 * inverse2.sqrt(),
        }
    }

    /// Returns the `t₀` at which the ray enters the ball.
    #[inline(always)]
    fn entry(&self, placement: &Placement) -> f64 {
        let nearest = (placement.center - self.origin).dot(self.along);
        (nearest - self.slowness * f64::from(placement.radius)).max(0.0)
    }
}

/// Returns the corners of a box around all `parts` after `map`.
fn mapped(map: &DAffine3, parts: &[Aabb]) -> (DVec3, DVec3) {
    let none = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    parts.iter().fold(none, |(min, max), part| {
        let (low, high) = (part.min.as_dvec3(), part.max.as_dvec3());
        let center = map.transform_point3(0.5 * (low + high));
        let half = abs_times(map, 0.5 * (high - low));
        (min.min(center - half), max.max(center + half))
    })
}

/// Returns the distance that rounding moves a local line within the ball: `e` of the module's page.
fn local_error(object_from_world: &DAffine3, local_center: DVec3, radius: f64) -> DVec3 {
    let rows = object_from_world.matrix3.transpose();
    let lengths = DVec3::new(
        rows.x_axis.length(),
        rows.y_axis.length(),
        rows.z_axis.length(),
    );
    let rho = radius * lengths;
    f64::from(f32::EPSILON) * (local_center.abs() + rho + 8.0 * rho)
}

/// The relation of hits in the space of a tree to hits in the world.
pub(crate) trait Space {
    /// Returns the limits of local hits that are certainly within the world's.
    fn sure_limits(&self, ray: &Ray) -> [f32; 2];

    /// Returns the world's hit for a local one. None: it is beyond the limits.
    fn world_hit(&self, local: Hit) -> Option<Hit>;

    /// Calls `shorten` to lower the limit of world hits, and lowers the limit of local hits to match.
    fn limit<R>(&mut self, ray: &mut Ray, shorten: impl FnOnce(&mut f32) -> R) -> R;
}

/// The space of the tree's own primitives: hits are not changed.
pub(crate) struct World;

impl Space for World {
    #[inline(always)]
    fn sure_limits(&self, ray: &Ray) -> [f32; 2] {
        [ray.t_min, ray.t_max]
    }

    #[inline(always)]
    fn world_hit(&self, local: Hit) -> Option<Hit> {
        Some(local)
    }

    #[inline(always)]
    fn limit<R>(&mut self, ray: &mut Ray, shorten: impl FnOnce(&mut f32) -> R) -> R {
        shorten(&mut ray.t_max)
    }
}

/// The space of the primitives of one instance.
pub(crate) struct Object {
    instance: u32,
    /// `t₀`.
    start: f64,
    /// The limits in the world. Hits before `t_min` do not count.
    t_min: f32,
    pub(crate) t_max: f32,
    /// The limits of local hits that are certainly within the ray's initial limits.
    sure: [f32; 2],
}

/// The relative distance by which limits are moved outward: `4ε`, with ε half of [`f32::EPSILON`].
const OUTWARD: f64 = 2.0 * f32::EPSILON as f64;

/// Returns `world` - `t₀`, with `world` moved by `outward` times itself.
#[inline(always)]
fn moved(world: f32, start: f64, outward: f64) -> f32 {
    let world = f64::from(world);
    let least = f64::from(f32::MIN_POSITIVE).copysign(outward);
    (world - start + (world * outward + least)) as f32
}

impl Object {
    #[inline(always)]
    fn new(instance: u32, start: f64, ray: &Ray) -> Self {
        let inward = |t: f32| 8.0 * f32::EPSILON * t.abs() + f32::MIN_POSITIVE;
        let [first, last] = [ray.t_min, ray.t_max].map(|t| (f64::from(t) - start) as f32);
        Self {
            instance,
            start,
            t_min: ray.t_min,
            t_max: ray.t_max,
            sure: [first + inward(first), last - inward(last)],
        }
    }

    #[inline(always)]
    fn local_t_max(&self) -> f32 {
        moved(self.t_max, self.start, OUTWARD).min(f32::MAX)
    }
}

impl Space for Object {
    #[inline(always)]
    fn sure_limits(&self, _: &Ray) -> [f32; 2] {
        self.sure
    }

    #[inline(always)]
    fn world_hit(&self, local: Hit) -> Option<Hit> {
        let t = (self.start + f64::from(local.t)) as f32;
        (t >= self.t_min && t <= self.t_max).then_some(Hit {
            t,
            instance: self.instance,
            ..local
        })
    }

    #[inline(always)]
    fn limit<R>(&mut self, ray: &mut Ray, shorten: impl FnOnce(&mut f32) -> R) -> R {
        let result = shorten(&mut self.t_max);
        ray.t_max = self.local_t_max();
        result
    }
}

#[cfg(test)]
mod tests;
